"""How a position came to be, in the words of a recording: from the aircraft itself, or computed or repeated by others.

Categories of accuracy and integrity are claims about the position that the aircraft sends. A position that others computed or repeat has
none of them, whatever stands beside it. FLARM sends the position of the aircraft's own receiver.
Words and numbers as readsb, dump1090 and OpenSky write them (provenance: standard, from knowledge of the formats; lists of values: the
README of readsb's JSON).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.read.columns.naming import words

if TYPE_CHECKING:
    from collections.abc import Mapping


OWN_BEGINS = "adsb_"
"""Sources of readsb that begin so are the aircraft's own, whatever follows; the decoder of live lines has the same rule."""

COMPUTED = words(
    "mlat multilateration multilaterated wam wide_area_multilateration lam tdoa "
    "tisb tis_b tisb_icao tisb_trackfile tisb_other adsr adsr_icao adsr_other ads_r rebroadcast "
    "radar psr ssr mssr primary_radar secondary_radar surveillance_radar primary_surveillance_radar secondary_surveillance_radar "
    "surface_movement_radar asterix estimated interpolated extrapolated predicted propagated coasted coasting dead_reckoning synthetic "
    "simulated projected"
)
"""Words of positions that others computed or repeat, or that nothing measured."""

FOREIGN = COMPUTED | words("adsc ads_c mode_s modes mode_ac mode_a_c network network_provider cell cellular wifi wi_fi nlp")
"""Words of sources whose positions are none that the aircraft claims a category of, and of a telephone's that no satellite gives."""

NAMED_COMPUTED = rf"(?:^|[^a-z0-9])(?:multilat[a-z]*|mlat[0-9]+|{'|'.join(sorted(COMPUTED))})(?:[^a-z0-9]|$)"
"""In lower case with `_` for blanks and hyphens: a name of several words, one of which is such a word, as `ads_b/mlat`."""

OWN = words(
    "adsb ads_b adsb_icao adsb_icao_nt adsb_other adsb_1090 ads_b_1090 ads_b_1090es 1090es adsb_uat ads_b_uat uat flarm ais "
    "gps gnss glonass galileo beidou sbas waas egnos gbas dgps dgnss rtk rtk_fixed rtk_float ppp gps_ins gnss_ins"
)
"""Words of positions of the aircraft's own receiver."""

OF_POSITION = words(
    "position_source pos_source position_src pos_src position_source_type position_source_id position_source_name position_origin "
    "pos_origin source_of_position location_source location_provider fix_source "
    "position_method positioning_method positioning_source positioning_type"
)
"""Columns that say nothing but how the position came: a word that nobody knows is none of the aircraft's own."""
OPENSKY_FOREIGN, OPENSKY_OWN = words("1 2"), words("0 3")
"""Numbers of OpenSky in them: 1 ASTERIX, 2 MLAT; 0 ADS-B, 3 FLARM."""

OF_ANYTHING = words("type source source_type src data_source track_source surveillance_source surveillance_type provider")
"""Columns that may say that, or what kind of aircraft, of message or of receiver: a word that is not known is named."""

OF_NAVIGATION = words("nav_source navigation_source nav_src navigation_sensor nav_sensor gps_source gnss_source")
"""Columns that say what keeps the position."""
INERTIAL = words("irs ins iru inertial imu irs_only ins_only inertial_only dr")
"""Words in them of inertial sensors alone."""

LISTS = words(
    "mlat is_mlat by_mlat from_mlat mlat_position position_mlat multilateration multilaterated is_multilaterated "
    "tisb is_tisb by_tisb from_tisb tisb_position position_tisb"
)
"""Columns that say whether others computed a position: a truth value, or the names of the values that are theirs."""

UPDATE_TYPE = words("update_type updatetype")
UPDATE_FOREIGN, UPDATE_OWN = words("p o z m d x v"), words("a s")
"""Letters of FlightAware in them: projected, oceanic, radar, multilateration, datalink, surface, virtual; ADS-B from ground or space.
Provenance: standard, from knowledge of the interface."""

READSB = words("hex seen_pos")
"""A table with both is one of readsb's aircraft: its `type` is how the position came, and a row without one claims nothing."""

HEARD = words("hex seen")
"""A table with both is one of dump1090's or readsb's aircraft: `seen` is how long ago the aircraft was heard last, and no position of it is
newer. [s]"""

OF_PLACE = ("lat", "lon")
"""Names in the lists of a position."""
CLAIMS = ("nac_p", "nic", "rc", "sil")
"""Names in the lists of accuracies and integrities."""


_OF_READSB = ("mlat", "tisb")
"""Lists of readsb."""


def names_position(values: object) -> bool:
    """Whether a list of values that others computed has the position, or is no list."""
    if not values:
        return False
    return not isinstance(values, list) or any(name in values for name in OF_PLACE)


def is_of_others(claim: str, beside: Mapping[str, object]) -> bool:
    """Whether a list of values that others gave has an accuracy or an integrity of an aircraft."""
    lists = (beside.get(name) for name in _OF_READSB)
    return any(isinstance(values, list) and claim in values for values in lists)


class OfTrace:
    """The source of each position of a readsb trace: that of the row itself, otherwise of the last details.

    A list of the last details that has the position counts until the next details, or until a row states another source.
    """

    def __init__(self) -> None:
        self._kind: object = None
        self._beside: object = None
        self._computed = ""

    def of(self, stated: object, details: Mapping[str, object] | None) -> str:
        """The word of the next row."""
        if details is not None:
            self._kind = details.get("type", self._kind)
            self._computed = next((name for name in _OF_READSB if names_position(details.get(name))), "")
            self._beside = stated
        elif stated is not None and stated != self._beside:
            self._computed = ""
        if self._computed:
            return self._computed
        # Of a row and its own details that contradict each other the one counts that is not the aircraft's.
        contradicted = details is not None and isinstance(self._kind, str) and self._kind in FOREIGN
        kind = self._kind if stated is None or contradicted else stated
        return kind if isinstance(kind, str) and kind.strip() else "unknown"
