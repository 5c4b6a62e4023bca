"""Pictures: each shows the numbers of its table, what is not available is not drawn as within, and every script of the gallery draws."""

from __future__ import annotations

import ast
import runpy
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest

mpl.use("Agg")

from matplotlib import pyplot
from matplotlib.patches import Rectangle

import navbound
from navbound import maps, plot
from navbound.errors import InputError
from navbound.plot.parts import colours, table, track_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes

    from navbound.run.directory import Run

ROOT = Path(__file__).parents[1]
GALLERY = sorted((ROOT / "examples" / "gallery").glob("*.py"))


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def misleading() -> Run:
    return navbound.fly("beijing-shanghai-misled")


def line(ax: Axes, label: str) -> np.ndarray:
    """Numbers of the line with a label."""
    (one,) = [each for each in ax.get_lines() if each.get_label() == label]
    return np.asarray(one.get_ydata(), dtype=np.float64)


def test_a_deviation_shows_the_columns_and_the_alerts(misleading: Run) -> None:
    epochs = misleading.epochs
    ax = plot.deviation(misleading)
    np.testing.assert_array_equal(line(ax, "flight technical error"), epochs["fte_m"].to_numpy())
    np.testing.assert_array_equal(line(ax, "RNP"), epochs["rnp_m"].to_numpy())
    # As many coloured times as runs of alerts.
    for kind in ("caution", "warning"):
        here = np.concatenate([[False], (epochs["alert"] == kind).to_numpy()])
        n_runs = int((np.diff(here.astype(int)) == 1).sum())
        coloured = [p for p in ax.patches if mpl.colors.same_color(p.get_facecolor()[:3], colours()[kind])]
        assert len(coloured) == n_runs
    assert (epochs["alert"] != "normal").any()
    assert ax.get_xlabel().startswith("time [min] since 2022-07-31 23:59:42 UTC")


def test_what_is_not_usable_is_hatched_and_not_drawn(misleading: Run) -> None:
    epochs = misleading.epochs.head(100).with_columns(
        pl.when(pl.int_range(pl.len()).is_between(20, 39)).then(pl.lit("not_available")).otherwise("status").alias("status")
    )
    ax = plot.bounds(epochs, methods=["tse-exact"])
    drawn = line(ax, "tse-exact")
    assert np.isnan(drawn[20:40]).all()
    assert np.isfinite(np.delete(drawn, slice(20, 40))).all()
    (hatched,) = [p for p in ax.patches if p.get_hatch()]
    assert isinstance(hatched, Rectangle)
    assert (hatched.get_x(), hatched.get_x() + hatched.get_width()) == pytest.approx((20 / 60, 40 / 60), abs=1e-9)


def test_tables_of_any_kind_are_taken_and_others_refused(misleading: Run) -> None:
    class Foreign:
        def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
            return misleading.epochs.__arrow_c_stream__(requested_schema)

    few = {"fte_m": [1.0, 2.0], "rnp_m": [50.0, 50.0]}
    assert table(few).height == 2
    assert table(Foreign()).height == misleading.epochs.height
    assert len(line(plot.deviation(few, bound=None), "flight technical error")) == 2
    with pytest.raises(InputError, match="a Run, a data frame, or columns by name"):
        table(5)
    with pytest.raises(InputError, match="fte_m"):
        plot.deviation({"rnp_m": [1.0]}, bound=None)
    with pytest.raises(InputError, match="epochs without a flight technical error"):
        plot.deviation(few | {"fte_m": [None, None]}, bound=None)
    with pytest.raises(InputError, match="one epoch or more"):
        track_of({"fte_m": []}, None)


def test_of_several_tracks_one_is_named() -> None:
    epochs = pl.DataFrame({"track": ["A", "B"], "time_ns": [10**18, 10**18], "fte_m": [1.0, 2.0], "rnp_m": [9.0, 9.0]})
    assert line(plot.deviation(epochs, track="B", bound=None), "flight technical error").tolist() == [2.0]
    for track in (None, "C"):
        with pytest.raises(InputError, match="A"):
            plot.deviation(epochs, track=track, bound=None)


def test_the_circle_is_that_of_anp_and_the_ellipse_holds_its_share() -> None:
    covariance = np.array([[60.0, 12.0], [12.0, 110.0]])
    ax = plot.ellipse(covariance, risk=0.05)
    ring, circle = (np.asarray(each.get_xydata()) for each in ax.get_lines()[:2])
    assert np.hypot(*circle.T) == pytest.approx(float(navbound.anp.circle(covariance, 0.05)), rel=1e-12)
    # By the definition: the squared distance in deviations is that of a chi-square of two, exceeded with 5 %.
    squared = np.einsum("ki,ij,kj->k", ring, np.linalg.inv(covariance), ring)
    assert squared == pytest.approx(5.991464547107979, rel=1e-9)


def test_a_stanford_diagram_counts_every_epoch_once() -> None:
    error = np.array([1.0, 45.0, 12.0, 3.0, 80.0, np.nan, 5.0])
    level = np.array([10.0, 20.0, 10.0, 60.0, 70.0, 10.0, np.nan])
    ax = plot.stanford(error, level, 40.0)
    shown = {" ".join(name.split()): int(n) for name, n in (t.get_text().rsplit("\n", 1) for t in ax.texts)}
    assert shown == {"nominal": 1, "hazardous": 1, "misleading": 1, "unavailable": 1, "unavailable, misleading": 1}
    assert ax.get_title() == "7 epochs, 2 without a level or an error"
    drawn = np.asarray(ax.collections[0].get_array()).sum()
    assert drawn == 5


def test_survival_is_the_share_that_is_larger_and_marks_a_lie() -> None:
    error, bound = np.arange(1.0, 101.0), np.full(100, 95.0)
    for scale, colour in ((1.0, "normal"), (0.5, "warning")):
        ax = plot.survival(error, scale * bound, 0.05)
        curve = ax.get_lines()[0]
        x, y = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        np.testing.assert_allclose(x, np.sort(error / (scale * bound)))
        np.testing.assert_allclose(y[0], 1.0)
        assert ax.get_lines()[-1].get_color() == colours()[colour]


def test_a_map_is_its_points_and_what_has_no_number_is_empty() -> None:
    made = maps.make("dop", grid=maps.Grid.degrees(45.0))
    points = made.points.with_columns(
        pl.when(pl.int_range(pl.len()) == 0).then(None).otherwise("pdop_p95").alias("pdop_p95"),
    )
    holed = type(made)(made.summary, made.record, points)
    ax = plot.availability(holed, name="pdop_p95")
    drawn: np.ma.MaskedArray[tuple[int, ...], np.dtype[np.float64]] = np.ma.asarray(ax.collections[0].get_array())
    assert drawn.mask.sum() == 1
    np.testing.assert_array_equal(np.sort(drawn.compressed()), np.sort(points["pdop_p95"].drop_nulls().to_numpy()))
    with pytest.raises(InputError, match="column of the map"):
        plot.availability(made, name="none")


def test_satellites_are_where_they_stand() -> None:
    ax = plot.sky([0.0, np.pi / 2], [np.pi / 4, -0.1], names=["G01", "G02"], used=[False, True])
    offsets = np.concatenate([np.asarray(c.get_offsets()) for c in ax.collections])
    # Below the horizon nothing is drawn; halfway to the zenith is half the radius.
    np.testing.assert_allclose(offsets, [[0.0, 45.0]], atol=1e-12)
    assert [t.get_text() for t in ax.texts] == ["G01"]
    with pytest.raises(InputError, match="as many"):
        plot.sky([0.0], [0.1, 0.2])


@pytest.mark.parametrize("script", GALLERY, ids=lambda path: path.stem)
def test_every_script_of_the_gallery_draws(script: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(ROOT)
    words = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8")))
    assert words is not None
    ax = runpy.run_path(str(script))["ax"]
    assert ax.get_title()
    assert ax.get_lines() or ax.collections or ax.patches
    if ax.name != "polar":
        assert ax.get_xlabel()
    ax.figure.savefig(tmp_path / "picture.png", dpi=40)
    pixels = pyplot.imread(tmp_path / "picture.png")
    assert pixels[..., :3].std() > 0.02


def test_the_gallery_has_its_pictures_in_the_index() -> None:
    assert len(GALLERY) >= 24
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    for script in GALLERY:
        assert f"../examples/gallery/{script.name}" in page
        assert str(ast.get_docstring(ast.parse(script.read_text(encoding="utf-8")))) in page


def test_without_matplotlib_the_extra_is_named_and_the_rest_works() -> None:
    program = (
        "import sys; sys.modules['matplotlib'] = None\nimport navbound\nfrom navbound import plot, tse\nprint(tse.exact(30.0, 8.5, 1e-5))\n"
        "try:\n    plot.ellipse([[1.0, 0.0], [0.0, 1.0]])\nexcept ImportError as e:\n    print(e)\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    number, words = ended.stdout.splitlines()
    assert float(number) == pytest.approx(66.25, abs=0.005)
    assert words == "pictures need matplotlib: pip install 'navbound[plot]'"


def test_a_run_shows_itself(misleading: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert repr(misleading).startswith("<Run: ")
    assert f"{misleading.epochs.height} epochs" in repr(misleading)
    html = misleading._repr_html_()
    assert misleading.summary.verdict.words[:40].replace("&", "&amp;") in html.replace("&#x27;", "'")
    saved = misleading.save(tmp_path / "run")
    assert saved.report.is_file()
    assert str(tmp_path / "run") in repr(saved)
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    assert saved.show() == saved.report
    assert opened == [saved.report.resolve().as_uri()]


def test_html_of_a_run_holds_no_markup_of_its_title(misleading: Run) -> None:
    from dataclasses import replace  # noqa: PLC0415

    hostile = replace(misleading, summary=misleading.summary.model_copy(update={"title": "<script>x</script>"}))
    assert "<script>" not in hostile._repr_html_()
