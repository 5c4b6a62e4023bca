"""What goes wrong with a sensor: the shape of ``[[sensors.faults]]``, in SI units.

What the numbers mean and which are allowed is declared once, where they are used (``crates/simulate/src/sensors/faults.rs``).
"""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field

from navbound.scenario.part import Part


class SatelliteStep(Part):
    """A satellite's ranges jump."""

    kind: Literal["satellite-step"]
    start_s: float
    duration_s: float
    satellite: str
    step_m: float


class SatelliteRamp(Part):
    """A satellite's ranges drift away."""

    kind: Literal["satellite-ramp"]
    start_s: float
    duration_s: float
    satellite: str
    rate_mps: float


class Interference(Part):
    """No satellite can be received."""

    kind: Literal["interference"]
    start_s: float
    duration_s: float


class Spoofing(Part):
    """All satellites' signals are replaced by those of a place that moves away."""

    kind: Literal["spoofing"]
    start_s: float
    duration_s: float
    right_mps: float
    up_mps: float
    rates: bool = True


class DmeBias(Part):
    """A station's ranges are wrong by a constant."""

    kind: Literal["dme-bias"]
    start_s: float
    duration_s: float
    station: str
    bias_m: float


class ImuBiasJump(Part):
    """Biases of the inertial unit jump, and stay."""

    kind: Literal["imu-bias-jump"]
    start_s: float
    gyro_radps: list[float] = Field(min_length=3, max_length=3)
    accelerometer_mps2: list[float] = Field(min_length=3, max_length=3)


class ImuTrouble(Part):
    """The inertial unit's samples cannot be used."""

    kind: Literal["imu-trouble"]
    start_s: float
    duration_s: float
    what: Literal[
        "silent",
        "not-a-number",
        "late",
        "zeros",
        "frozen-accelerometers",
        "frozen-gyroscopes",
        "frozen",
        "swapped-axes",
        "repeated",
        "lost",
        "reversed",
    ]


class BaroBlockage(Part):
    """The static port is blocked: the altimeter stays where it was."""

    kind: Literal["baro-blockage"]
    start_s: float
    duration_s: float


class SatellitesStep(Part):
    """Ranges of several satellites jump by the same; a letter stands for a whole constellation."""

    kind: Literal["satellites-step"]
    start_s: float
    duration_s: float
    satellites: list[str] = Field(min_length=1)
    step_m: float


class SatellitesRamp(Part):
    """Ranges of several satellites drift away at the same rate; a letter stands for a whole constellation."""

    kind: Literal["satellites-ramp"]
    start_s: float
    duration_s: float
    satellites: list[str] = Field(min_length=1)
    rate_mps: float


class ReceiverTrouble(Part):
    """The receiver repeats its last measurement, or each row twenty times, or names all satellites alike, or turns the sign of rates."""

    kind: Literal["receiver-trouble"]
    start_s: float
    duration_s: float
    what: Literal["frozen", "repeated", "one-name", "rates-reversed"]


class ReceiverDelay(Part):
    """The receiver's measurements are of an earlier time than their tags say."""

    kind: Literal["receiver-delay"]
    start_s: float
    duration_s: float
    delay_s: float


class ReceiverSigma(Part):
    """The deviations declared with the ranges are a multiple of the true ones."""

    kind: Literal["receiver-sigma"]
    start_s: float
    duration_s: float
    factor: float


class DmeBiases(Part):
    """The bias of every station is a multiple of itself."""

    kind: Literal["dme-biases"]
    start_s: float
    duration_s: float
    factor: float


class ImuPulse(Part):
    """Biases of the inertial unit jump, and jump back."""

    kind: Literal["imu-pulse"]
    start_s: float
    duration_s: float
    gyro_radps: list[float] = Field(min_length=3, max_length=3)
    accelerometer_mps2: list[float] = Field(min_length=3, max_length=3)


class ImuRamp(Part):
    """Biases of the inertial unit grow."""

    kind: Literal["imu-ramp"]
    start_s: float
    duration_s: float
    gyro_radps2: list[float] = Field(min_length=3, max_length=3)
    accelerometer_mps3: list[float] = Field(min_length=3, max_length=3)


class ImuScale(Part):
    """Scale factors of the inertial unit change by a share."""

    kind: Literal["imu-scale"]
    start_s: float
    duration_s: float
    gyro: float
    accelerometer: float


class ImuNoise(Part):
    """The white noise of the inertial unit is a multiple of its own."""

    kind: Literal["imu-noise"]
    start_s: float
    duration_s: float
    factor: float


class ImuClip(Part):
    """The inertial unit says no more than its range."""

    kind: Literal["imu-clip"]
    start_s: float
    duration_s: float
    gyro_radps: float
    accelerometer_mps2: float


class ImuClock(Part):
    """The clock of the inertial unit jumps, or runs fast or slow."""

    kind: Literal["imu-clock"]
    start_s: float
    duration_s: float
    offset_s: float
    drift: float


class BaroFrozen(Part):
    """The altimeter repeats its last word."""

    kind: Literal["baro-frozen"]
    start_s: float
    duration_s: float


SENSOR_FAULTS: tuple[type[Part], ...] = (
    SatelliteStep,
    SatelliteRamp,
    SatellitesStep,
    SatellitesRamp,
    Interference,
    Spoofing,
    ReceiverTrouble,
    ReceiverDelay,
    ReceiverSigma,
    DmeBias,
    DmeBiases,
    ImuBiasJump,
    ImuPulse,
    ImuRamp,
    ImuScale,
    ImuNoise,
    ImuClip,
    ImuClock,
    ImuTrouble,
    BaroBlockage,
    BaroFrozen,
)
"""Every kind of fault of a sensor: the one list that the scenario reader, the documentation and the fault campaign read."""


class SatelliteOutage(Part):
    """Satellites are out of service, as a notice announces it; a letter stands for a whole constellation."""

    kind: Literal["satellite-outage"]
    start_s: float
    duration_s: float
    satellites: list[str] = Field(min_length=1)


class StationOutage(Part):
    """Stations are out of service, ranges and bearings."""

    kind: Literal["station-outage"]
    start_s: float
    duration_s: float
    stations: list[str] = Field(min_length=1)


OUTAGES: tuple[type[Part], ...] = (SatelliteOutage, StationOutage)
"""What a notice announces: nothing wrong is measured, so no campaign has to find it."""

SensorFault = Annotated[
    SatelliteStep
    | SatelliteRamp
    | SatellitesStep
    | SatellitesRamp
    | Interference
    | Spoofing
    | ReceiverTrouble
    | ReceiverDelay
    | ReceiverSigma
    | DmeBias
    | DmeBiases
    | ImuBiasJump
    | ImuPulse
    | ImuRamp
    | ImuScale
    | ImuNoise
    | ImuClip
    | ImuClock
    | ImuTrouble
    | BaroBlockage
    | BaroFrozen
    | SatelliteOutage
    | StationOutage,
    Field(discriminator="kind"),
]


def kinds() -> list[str]:
    """The words of :data:`SENSOR_FAULTS`, in its order."""
    return [get_args(fault.model_fields["kind"].annotation)[0] for fault in SENSOR_FAULTS]
