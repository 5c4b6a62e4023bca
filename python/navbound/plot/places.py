"""Pictures in space: tracks, approaches over each other, ellipses, the scatter of errors, the sky, maps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import anp
from navbound.errors import InputError, NotFoundError
from navbound.plot.parts import ALERTS, axes, colours, column, finish, table, track_of
from navbound.records.maps import Map
from navbound.units import EARTH_RADIUS_M, METRES_PER_NM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

ELLIPSE_POINTS = 181


def ground_track(of: Any, *, track: str | None = None, ax: Axes | None = None) -> Axes:
    """Positions east and north of the first one, the path beneath, coloured where the monitor alerts."""
    one = track_of(of, track)
    ax, palette = axes(ax), colours()
    lat, lon = column(one.epochs, "est_lat_rad"), column(one.epochs, "est_lon_rad")
    first = int(np.flatnonzero(np.isfinite(lat) & np.isfinite(lon))[0])
    lat0, lon0 = lat[first], lon[first]

    def plane(lat_rad: Floats, lon_rad: Floats) -> tuple[Floats, Floats]:
        east = (lon_rad - lon0 + math.pi) % math.tau - math.pi
        return EARTH_RADIUS_M * math.cos(lat0) * east / 1e3, EARTH_RADIUS_M * (lat_rad - lat0) / 1e3

    if "path_lat_rad" in one.epochs.columns:
        ax.plot(
            *plane(column(one.epochs, "path_lat_rad"), column(one.epochs, "path_lon_rad")),
            color=palette["muted"],
            linewidth=3,
            alpha=0.5,
            label="path",
        )
    east, north = plane(lat, lon)
    ax.plot(
        np.where(one.usable, east, np.nan), np.where(one.usable, north, np.nan), color=palette["path"], linewidth=1.2, label="positions"
    )
    alerts = one.epochs["alert"].to_numpy() if "alert" in one.epochs.columns else np.full(len(east), "normal")
    for kind in ALERTS:
        here = alerts == kind
        if here.any():
            ax.plot(east[here], north[here], ".", markersize=4, color=palette["muted" if kind == "unavailable" else kind], label=kind)
    ax.set_aspect("equal", adjustable="datalim")
    return finish(ax, f"Track, {one.name}", "east [km]", "north [km]")


def approaches(of: Any, *, share: float = 0.95, ax: Axes | None = None) -> Axes:
    """Deviations of all tracks by distance to the end of the path, with the share of them that is within a band.

    Parameters
    ----------
    of : Run or data frame or mapping
        Epochs with ``track``, ``along_m`` and ``fte_m`` of several tracks along paths that end at the threshold.
    share : float
        Of the deviations within the band, in classes of half a nautical mile with at least 20 of them. [1]
    """
    if not 0 < share < 1:
        raise InputError("share", share, "1", "(0, 1)")
    epochs = table(of)
    ax, palette = axes(ax), colours()
    to_go: list[Floats] = []
    deviation: list[Floats] = []
    for part in epochs.partition_by("track", maintain_order=True):
        along, fte = column(part, "along_m"), column(part, "fte_m")
        if not np.isfinite(along).any():
            continue
        left = (np.nanmax(along) - along) / METRES_PER_NM
        ax.plot(left, fte, color=palette["path"], linewidth=0.7, alpha=0.5)
        to_go.append(left)
        deviation.append(fte)
    if not to_go:
        raise InputError("of", "epochs without a distance along a path", domain="tracks with a path")
    x, y = np.concatenate(to_go), np.concatenate(deviation)
    known = np.isfinite(x) & np.isfinite(y)
    classes = np.floor(x[known] * 2).astype(int)
    ends = [k for k in range(classes.max() + 1) if (classes == k).sum() >= 20]
    band = [np.quantile(y[known][classes == k], [(1 - share) / 2, (1 + share) / 2]) for k in ends]
    if band:
        low, high = np.array(band).T
        at = (np.array(ends) + 0.5) / 2
        ax.fill_between(at, low, high, color=palette["limit"], alpha=0.25, linewidth=0, label=f"{100 * share:g} % of the deviations")
    rnp = column(epochs, "rnp_m")
    for sign in (1, -1):
        ax.axhline(sign * float(np.nanmin(rnp)), color=palette["limit"], linestyle="--", label="RNP" if sign > 0 else None)
    ax.invert_xaxis()
    return finish(ax, f"{len(to_go)} tracks over each other", "distance to the end of the path [NM]", "right of the path [m]")


def ellipse(covariance: ArrayLike, *, risk: float = 0.05, mean_m: ArrayLike = (0.0, 0.0), ax: Axes | None = None) -> Axes:
    """The ellipse that holds an error with probability 1 - risk, and the circle that does.

    Parameters
    ----------
    covariance : array_like, shape (2, 2)
        East and north. [m²]
    risk : float
        Of an error outside. [1]
    mean_m : array_like, shape (2,)
        Mean error, east and north; the circle is around zero. [m]
    """
    c, mean = np.asarray(covariance, dtype=np.float64), np.asarray(mean_m, dtype=np.float64)
    if c.shape != (2, 2):
        raise InputError("covariance", f"shape {c.shape}", domain="shape (2, 2)")
    radius = float(anp.circle(c, risk, mean_en_m=mean))
    ax, palette = axes(ax), colours()
    angle = np.linspace(0, math.tau, ELLIPSE_POINTS)
    turn = np.stack([np.cos(angle), np.sin(angle)])
    values, vectors = np.linalg.eigh(c)
    # Two normal errors: the squared distance in deviations is beyond -2 ln(risk) with this risk.
    points = mean[:, None] + vectors @ (np.sqrt(np.maximum(values, 0) * -2 * math.log(risk))[:, None] * turn)
    ax.plot(*points, color=palette["path"], label=f"ellipse, {100 * (1 - risk):g} %")
    ax.plot(*(radius * turn), color=palette["limit"], label=f"circle, {radius:.3g} m")
    ax.plot(*mean, "+", color=palette["ink"])
    ax.set_aspect("equal", adjustable="datalim")
    return finish(ax, "Where the error is", "east [m]", "north [m]")


def scatter(of: Any, *, track: str | None = None, risk: float = 0.05, ax: Axes | None = None) -> Axes:
    """Errors east and north, with the circle of the errors' own covariance at a risk, and that of the mean stated one.

    Parameters
    ----------
    of : Run or data frame or mapping
        Epochs with ``nse_e_m`` and ``nse_n_m``, where the truth is known; and their covariance.
    """
    one = track_of(of, track)
    east, north = one.numbers("nse_e_m"), one.numbers("nse_n_m")
    known = np.isfinite(east) & np.isfinite(north)
    if not known.any():
        raise InputError("of", "epochs without errors", domain="epochs with nse_e_m and nse_n_m: a truth")
    ax, palette = axes(ax), colours()
    ax.plot(east[known], north[known], ".", markersize=2, alpha=0.4, color=palette["path"], label=f"{known.sum()} errors")
    angle = np.linspace(0, math.tau, ELLIPSE_POINTS)
    circles = [("of the errors", np.cov(east[known], north[known]), palette["ink"])]
    if "cov_ee_m2" in one.epochs.columns:
        ee, en, nn = (float(np.nanmean(one.numbers(f"cov_{name}_m2"))) for name in ("ee", "en", "nn"))
        circles.append(("stated, mean", np.array([[ee, en], [en, nn]]), palette["limit"]))
    for label, matrix, colour in circles:
        if np.isfinite(matrix).all():
            radius = float(anp.circle(matrix, risk))
            ax.plot(
                radius * np.cos(angle), radius * np.sin(angle), color=colour, label=f"{100 * (1 - risk):g} % circle {label}, {radius:.3g} m"
            )
    ax.set_aspect("equal", adjustable="datalim")
    return finish(ax, f"Errors of the position, {one.name}", "east [m]", "north [m]")


def sky(
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    *,
    names: list[str] | None = None,
    used: ArrayLike | None = None,
    mask_rad: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Satellites by azimuth and elevation, the zenith in the middle and north up.

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (n,)
        Directions; satellites below the horizon are left out. [rad]
    names : list of str, optional
        Of each.
    used : array_like of bool, optional
        Which are used; the others are hollow.
    mask_rad : float, optional
        Lowest elevation used, drawn as a circle. [rad]
    """
    az, el = (np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in (az_rad, el_rad))
    filled = np.ones(len(az), dtype=bool) if used is None else np.atleast_1d(np.asarray(used, dtype=bool))
    if not az.shape == el.shape == filled.shape or (names is not None and len(names) != len(az)):
        raise InputError("az_rad", f"{len(az)} directions", domain=f"as many azimuths, elevations ({len(el)}), names and marks")
    ax, palette = axes(ax, polar=True), colours()
    ax.set_theta_zero_location("N")  # type: ignore[attr-defined]
    ax.set_theta_direction(-1)  # type: ignore[attr-defined]
    above = el > 0
    for mark, label in ((True, "used"), (False, "not used")):
        here = above & (filled == mark)
        if here.any():
            face = palette["normal"] if mark else "none"
            ax.scatter(az[here], 90 - np.degrees(el[here]), s=60, facecolors=face, edgecolors=palette["ink"], label=label)
    for k in np.flatnonzero(above) if names is not None else ():
        ax.annotate(
            names[k] if names else "", (az[k], 90 - math.degrees(el[k])), xytext=(5, 4), textcoords="offset points", fontsize="x-small"
        )
    if mask_rad is not None:
        around = np.linspace(0, math.tau, ELLIPSE_POINTS)
        ax.plot(around, np.full(ELLIPSE_POINTS, 90 - math.degrees(mask_rad)), color=palette["muted"], linestyle="--", label="mask")
    ax.set_rlim(0, 90)  # type: ignore[attr-defined]
    ax.set_rgrids([0, 30, 60, 90], ["90°", "60°", "30°", "0°"])  # type: ignore[attr-defined]
    ax.legend(frameon=False, fontsize="small", loc="lower left", bbox_to_anchor=(-0.15, -0.1))
    ax.set_title("Sky")
    return ax


def availability(of: Map, *, name: str = "p_available", ax: Axes | None = None) -> Axes:
    """A column of a map over its grid; by default the share of the time within the limits.

    Parameters
    ----------
    of : Map
        From :func:`navbound.maps.make`.
    name : str
        A column of its points.
    """
    if not isinstance(of, Map):
        raise InputError("of", type(of).__name__, domain="a Map of navbound.maps.make")
    if name not in of.points.columns:
        raise NotFoundError("name", name, "column of the map", of.points.columns)
    points = of.points.select("lat_rad", "lon_rad", pl.col(name).cast(pl.Float64))
    lat, lon = (np.degrees(np.unique(points[axis].to_numpy())) for axis in ("lat_rad", "lon_rad"))
    values = points.sort("lat_rad", "lon_rad")[name].to_numpy().reshape(len(lat), len(lon))
    ax = axes(ax)
    # What has no number stays empty.
    mesh = ax.pcolormesh(lon, lat, np.ma.masked_invalid(values), shading="nearest", cmap="viridis")
    ax.figure.colorbar(mesh, ax=ax, label=name)
    return finish(ax, of.summary.title, "longitude [°]", "latitude [°]", legend=False)
