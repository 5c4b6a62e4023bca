"""What a table's columns may hold: quantities with their units, limits and known names."""

from __future__ import annotations

import math
from dataclasses import dataclass

from navbound.table.columns import COVARIANCE, EPOCHS, READ, VARIANCES
from navbound.units import METRES_PER_FT, METRES_PER_NM, MPS_PER_KT

_DEG = math.pi / 180.0

UNITS: dict[str, dict[str, float]] = {
    "rad": {
        **dict.fromkeys(("rad", "radian", "radians"), 1.0),
        **dict.fromkeys(("deg", "°", "degree", "degrees"), _DEG),
        **dict.fromkeys(("deg_e7", "1e-7 deg", "dege7"), 1e-7 * _DEG),
    },
    "m": {
        **dict.fromkeys(("m", "metre", "metres", "meter", "meters"), 1.0),
        **dict.fromkeys(("ft", "foot", "feet"), METRES_PER_FT),
        **dict.fromkeys(("km", "kilometre", "kilometres", "kilometer", "kilometers"), 1000.0),
        **dict.fromkeys(("nm", "nmi", "nautical mile", "nautical miles"), METRES_PER_NM),
        **dict.fromkeys(("cm", "centimetre", "centimetres"), 0.01),
        **dict.fromkeys(("mm", "millimetre", "millimetres"), 0.001),
    },
    "m2": {"m2": 1.0, "m^2": 1.0, "m²": 1.0},
    "mps": {
        "mps": 1.0,
        "m/s": 1.0,
        "kt": MPS_PER_KT,
        "kts": MPS_PER_KT,
        **dict.fromkeys(("kn", "knot", "knots"), MPS_PER_KT),
        **dict.fromkeys(("km/h", "kmh", "kph"), 1 / 3.6),
        "ft/min": METRES_PER_FT / 60,
        "fpm": METRES_PER_FT / 60,
        "mph": 0.44704,
    },
    "hpa": {**dict.fromkeys(("hpa", "mbar", "mb"), 1.0), "inhg": 33.863886},
    "1": {"1": 1.0, "": 1.0},
    "time": {},
    "text": {},
}
"""Units a column may be written in, by SI unit: factor to SI."""

TIME_UNITS = ("gps_ns", "gps_us", "gps_ms", "gps_s", "gps_week", "gps_tow_s", "utc", "utc_s", "utc_ms", "utc_us", "utc_ns", "utc_text")
"""Ways to write a time; `utc` tells Unix seconds, milli-, micro- and nanoseconds apart by their size, and ISO 8601 text by its looks."""


@dataclass(frozen=True)
class Quantity:
    """A column of the epoch table that a file may hold.

    Attributes
    ----------
    name : str
        Its name in docs/notation.md.
    si : str
        Its SI unit as the list of columns declares it, a key of `UNITS`.
    low, high : float
        What is possible, in SI.
    aliases : dict
        Known names, in lower case, to the unit they are in.
    """

    name: str
    si: str
    low: float
    high: float
    aliases: dict[str, str]


_DECLARED = {column.name: column.unit for column in (*EPOCHS, *READ)}


WRITTEN = "written"
"""In the place of a unit: the name is known where its unit is written beside it."""


def _q(name: str, low: float, high: float, **aliases: str) -> Quantity:
    si = _DECLARED[name]
    return Quantity(
        name, si, low, high, {name: si} | {k: v for unit, names in aliases.items() for k, v in ((n, unit) for n in names.split())}
    )


_INF = math.inf

_WHO = (
    "icao24 icao mmsi track_id flight_id aircraft_id vehicle_id hex icao_address icao_addr icaoaddress mode_s modes address registration "
    "reg tail tail_number"
)
_SATELLITES = (
    "ns nsv nsat num_sv numsv n_sats nsats numsat num_sat numsats num_sats satellites n_satellites num_satellites sats svs n_used "
    "sats_used svs_used sv_used satellites_used used_sats used_svs used_satellites n_sats_used n_sv_used num_sats_used num_sv_used "
    "num_satellites_used gpsnum osd_gpsnum gps_num num_gps gps_sats gps_satellites gps_nsats gps_num_sats gps_sats_used gnss_sats "
    "gnss_satellites gnss_sats_used"
)
"""Names of the number of satellites of a position; one of those in view is none the smaller."""

QUANTITIES: tuple[Quantity, ...] = (
    _q(
        "est_lat_rad",
        -math.pi / 2,
        math.pi / 2,
        deg="latitude lat lat_deg latitude_deg est_lat_deg position_latitude location_lat gpslatitude",
        rad="lat_rad latitude_rad",
    ),
    _q(
        "est_lon_rad",
        -math.pi,
        2 * math.pi,
        deg="longitude lon lng long lon_deg longitude_deg est_lon_deg position_longitude location_long location_lon gpslongitude",
        rad="lon_rad longitude_rad",
    ),
    _q(
        "est_h_m",
        -2e4,
        1e8,
        # What it is above goes before a height of which nothing states it.
        m="h_m ellipsoid_height ellipsoidal_height height_above_ellipsoid ellipsoid_altitude ellipsoidal_altitude altitude_ellipsoid "
        "altitude_ellipsoidal altitude_hae height height_m",
        ft="geoaltitude geoaltitude_ft alt_geom height_ft",
        # Autopilots write it in metres and in millimetres.
        written="alt_ellipsoid alt_hae",
    ),
    _q("altitude_m", -2e3, 1e5, m="alt_m", ft="altitude altitude_ft alt_baro pressure_altitude"),
    _q(
        "ground_track_rad",
        -2 * math.pi,
        2 * math.pi,
        deg="track track_deg ground_track true_track cog course course_over_ground true_course track_true trk track_angle",
    ),
    _q(
        "ground_speed_mps",
        0.0,
        2e4,
        kt="groundspeed ground_speed gs ground_speed_kt velocity_kt sog",
        mps="speed_mps vel_m_s",
        kmh="speed_kmh speed_km_h speed_kph ground_speed_kmh gs_kmh",
        # Names that are in use for several units: with their unit alone.
        written="speed velocity spd speed_over_ground gnd_spd gndspd groundspd gspeed vg hspeed hspd horizontal_speed speed_2d speed2d "
        "vel horizontal_velocity velocity_horizontal h_speed track_speed calc_speed",
    ),
    _q("vel_n_mps", -2e4, 2e4, mps="vel_n_m_s vn_mps vn_m_s vn velocity_n velocity_north vel_north north_velocity v_north"),
    _q("vel_e_mps", -2e4, 2e4, mps="vel_e_m_s ve_mps ve_m_s ve velocity_e velocity_east vel_east east_velocity v_east"),
    _q(
        "vertical_rate_mps",
        -2e3,
        2e3,
        **{"ft/min": "vertical_rate vertrate baro_rate geom_rate vertical_rate_fpm"},
        mps="climb_rate_mps",
    ),
    _q("truth_lat_rad", -math.pi / 2, math.pi / 2, deg="truth_lat_deg truth_lat truth_latitude"),
    _q("truth_lon_rad", -math.pi, 2 * math.pi, deg="truth_lon_deg truth_lon truth_lng truth_longitude"),
    _q("truth_h_m", -2e4, 1e8, m="truth_h truth_height truth_height_m"),
    *(_q(name, 0.0 if name in VARIANCES else -_INF, _INF) for name in COVARIANCE),
    _q("sigma_e_m", 0.0, _INF, m="sde sde_m sd_e sd_e_m std_e std_e_m std_east std_east_m sigma_e sigma_east_m"),
    _q("sigma_n_m", 0.0, _INF, m="sdn sdn_m sd_n sd_n_m std_n std_n_m std_north std_north_m sigma_n sigma_north_m"),
    _q("sigma_u_m", 0.0, _INF, m="sdu sdu_m sd_u sd_u_m std_u std_u_m std_up std_up_m sigma_u sigma_up_m"),
    _q("epu_m", 0.0, _INF, m="epu anp_m", nm="epu_nm anp_nm", written="anp actual_navigation_performance"),
    _q("rc_m", 0.0, _INF, m="rc", nm="rc_nm"),
    _q("nac_p", 0.0, 15.0, **{"1": "nacp nac_p"}),
    _q("nic", 0.0, 15.0, **{"1": "nic"}),
    _q("nuc_p", 0.0, 9.0, **{"1": "nucp nuc_p nuc"}),
    _q("pic", 0.0, 14.0, **{"1": "pic position_integrity_category"}),
    # What cannot be a setting is judged where it is used: the position beside it is none the worse.
    _q("setting_hpa", -_INF, _INF, hpa="nav_qnh qnh qnh_hpa altimeter_setting_hpa"),
    _q("n_sv", 0.0, 255.0, **{"1": _SATELLITES}),
    _q("track", 0.0, 0.0, text=_WHO),
    _q("callsign", 0.0, 0.0, text="callsign flight"),
    _q("hpl_m", 0.0, 1e9, m="hpl horizontal_protection_level"),
    _q("vpl_m", 0.0, 1e9, m="vpl vertical_protection_level"),
    _q("status", 0.0, 0.0),
    _q("reason_id", 0.0, 0.0),
    _q("reason", 0.0, 0.0),
)

LEVEL_QUANTITIES: tuple[Quantity, ...] = (
    _q("nse_e_m", -1e8, 1e8, m="eerr e_err east_error_m"),
    _q("nse_n_m", -1e8, 1e8, m="nerr n_err north_error_m"),
    _q("nse_u_m", -1e8, 1e8, m="uerr u_err up_error_m"),
    _q("hpe_m", 0.0, 1e8, m="hpe"),
    _q("vpe_m", -1e8, 1e8, m="vpe"),
    _q("hdop", 0.0, 1e6, **{"1": "hdop"}),
    _q("vdop", 0.0, 1e6, **{"1": "vdop"}),
    _q("mode", 0.0, 0.0),
)
"""What a table of errors and protection levels may hold beyond a recorded track."""

STATED_QUANTITIES: tuple[Quantity, ...] = (
    *(q for q in LEVEL_QUANTITIES if q.name in {"nse_e_m", "nse_n_m"}),
    _q("nse_h_m", 0.0, 1e8, m="hpe_m hpe horizontal_error_m"),
    _q("nse_cross_m", -1e8, 1e8),
    _q("nse_along_m", -1e8, 1e8),
    _q("tse_m", -1e8, 1e8, m="tse"),
    _q(
        "fte_m",
        -1e8,
        1e8,
        m="fte xtk xte xtd xtrack cross_track cross_track_error cross_track_deviation lateral_deviation lateral_error "
        "off_track offtrack off_track_distance off_track_error crosstrack crosstrack_error xtrk",
        nm="xtk_nm xte_nm xtd_nm cross_track_nm cross_track_error_nm lateral_deviation_nm",
    ),
    _q("alert", 0.0, 0.0),
)
"""What a recorded track may state against its own positions. It bounds nothing; the verdict weighs it."""

QUANTITY = {q.name: q for q in STATED_QUANTITIES + QUANTITIES + LEVEL_QUANTITIES}
"""Every quantity by its name."""

TRANSPONDER = frozenset({"squawk", "spi"})
"""Columns beside which `alert` is the transponder's: a change of its code."""

TIME_NAMES: dict[str, str] = {
    "time_ns": "gps_ns", "gps_time_ns": "gps_ns", "gps_time_s": "gps_s", "gps_s": "gps_s",
    "gps_week": "gps_week", "week": "gps_week", "gps_tow": "gps_tow_s", "gps_tow_s": "gps_tow_s", "tow_s": "gps_tow_s", "tow": "gps_tow_s",
    "timestamp": "utc", "time": "utc", "utc": "utc", "datetime": "utc", "utc_datetime": "utc", "datetime_utc": "utc", "time_utc": "utc",
    "utc_time": "utc", "time_of_day": "utc", "gmt_time": "utc", "basedatetime": "utc", "base_date_time": "utc",
    "now": "utc_s", "unix_time": "utc_s", "unix_time_s": "utc_s", "time_s": "utc_s", "timestamp_ms": "utc_ms",
    "unixtimemillis": "utc_ms", "unix_time_millis": "utc_ms", "utctimemillis": "utc_ms", "time_ms": "utc_ms",
    "time_utc_usec": "utc_us", "utc_us": "utc_us", "timestamp_us": "utc_us", "time_us": "utc_us", "timeus": "utc_us",
}  # fmt: skip
"""Known names of time columns to the way they are written."""

WEEK = {"gps_week": "a GPS week", "gps_tow_s": "a time of week"}
DAY = {"utc_date": "a date", "utc_time_of_day": "a time of day", "utc_offset": "an offset from UTC"}
"""Two columns that make a time together, either way, and by how much both are ahead of UTC; each is declared by its own key."""

DATE_NAMES = ("utc_date", "date_utc", "date", "gmt_date", "date_gmt")
"""Known names of a date whose time of day stands in another column."""

LOCAL_NAMES = (("lcl_date", "local_date"), ("lcl_time", "local_time"), ("utcofst", "utc_ofst", "utc_offset"))
"""Known names of a local date, of its time of day, and of their offset from UTC. Provenance: from headers of Garmin's flight decks."""

DATE_ORDERS = ("ymd", "dmy", "mdy")
"""Orders of year, month and day in a date of numbers."""

POSITION_TIME = "position_time_ns"
"""When a position was valid, GPS time [ns]; the row's own time is that of the report."""

POSITION_TIME_NAMES = (
    *("position_time_ns", "last_position", "lastposupdate", "last_pos_update", "time_position", "position_time", "lastposition"),
    *("pos_time", "postime", "time_of_position", "timestamp_position", "position_timestamp", "pos_timestamp", "position_epoch"),
    *("time_of_applicability", "time_of_fix", "fix_time", "fixtime", "time_of_validity", "position_utc", "pos_utc"),
)
"""Columns that say when a row's position was valid, where its time is that of the report."""


OPENSKY_STATES: dict[str, tuple[str, str]] = {
    "est_h_m": ("geoaltitude", "m"),
    "altitude_m": ("baroaltitude", "m"),
    "ground_track_rad": ("heading", "deg"),
    "ground_speed_mps": ("velocity", "mps"),
    "vertical_rate_mps": ("vertrate", "mps"),
}
"""State vectors as the OpenSky Network stores them, in SI; its ``heading`` is the track. A table is one when it has all these names,
some of which mean something else elsewhere."""

OPENSKY_VELOCITY: dict[str, tuple[str, str]] = {"track": ("icao24", "text"), "ground_speed_mps": ("velocity", "mps")}
"""Some columns of the same, under its own names: who flies, and its speed."""

GARMIN = frozenset({"Lcl Date", "Lcl Time", "UTCOfst", "Latitude", "Longitude"})
GARMIN_COLUMNS: dict[str, tuple[str, str]] = {
    "est_h_m": ("AltGPS", "ft"),
    "ground_speed_mps": ("GndSpd", "kt"),
    "hpl_m": ("HPLwas", "m"),
    "vpl_m": ("VPLwas", "m"),
}
GARMIN_UNITS = {
    **{"Latitude": "degrees", "Longitude": "degrees", "AltGPS": "ft wgs", "GndSpd": "kt", "TRK": "deg", "MagVar": "deg"},
    **{"HPLwas": "mt", "HPLfd": "mt", "VPLwas": "mt"},
}
GARMIN_TRACK = ("TRK", "MagVar")
"""Logs of Garmin's flight decks (G1000 and its kin), what columns that one of them may lack hold, and their usual units.
The levels are those of SBAS, which stand beside a differential fix alone. The course is magnetic, the variation positive to the east.
Provenance: inferred from headers and from two flights, of which one has a variation of 3.3 degrees and moves 3.4 degrees off its course."""

DUMP1090_SPEED, DUMP1090 = ("speed", "kt"), frozenset({"hex", "seen_pos", "speed"})
"""The speed of dump1090's aircraft, and the names by which they are known. Provenance: standard, from knowledge of the format."""

FLIGHTRADAR24: dict[str, tuple[str, str]] = {
    "est_lat_rad": ("position latitude", "deg"),
    "est_lon_rad": ("position longitude", "deg"),
    "callsign": ("Callsign", "text"),
    "altitude_m": ("Altitude", "ft"),
    "ground_speed_mps": ("Speed", "kt"),
    "ground_track_rad": ("Direction", "deg"),
}
"""The export of a flight by Flightradar24, its `Position` taken apart. Provenance: standard, from knowledge of the format."""
