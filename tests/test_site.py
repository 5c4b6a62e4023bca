"""The documentation site as a reader meets it: commands run, links lead somewhere, search works from disk, nothing is too wide."""

from __future__ import annotations

import doctest
import html
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

import pytest

import navbound

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
CHROMIUM = shutil.which("chromium")
needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the site was NOT opened in a browser")
WITHOUT_GALLERY = (
    "-D",
    "exclude_patterns=_static,gallery.md",
    "-D",
    "suppress_warnings=myst.xref_missing,ref.python,toc.excluded,toc.not_readable",
)
"""The scripts of the gallery are run by tests/test_plot.py."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built with every warning an error: an unexpected exit status of a command and a picture that fails are warnings."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "--quiet", "--fresh-env", "--fail-on-warning", *WITHOUT_GALLERY, str(DOCS), str(folder)]
    ended = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert ended.returncode == 0, ended.stderr
    return folder


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


def pages(site: Path) -> list[Path]:
    return [page for page in sorted(site.rglob("*.html")) if "_static" not in page.parts]


def test_commands_of_the_tutorials_ran_and_print_what_the_text_states(site: Path) -> None:
    words = {
        page.stem: html.unescape(re.sub(r"<[^>]+>", "", page.read_text(encoding="utf-8"))) for page in (site / "tutorials").glob("*.html")
    }
    assert len(words) == 4
    for name, text in words.items():
        assert "Traceback (most recent call last)" not in text or name == "doctoral-student", name
        assert "no such file" not in text, name
    flat = {name: " ".join(text.split()) for name, text in words.items()}
    assert "0 failures." in flat["first-ten-minutes"]
    assert "typed by the user: inside RNP 0.3" in flat["first-ten-minutes"]
    assert "not believable, margins to RNP 0.3 mean nothing" in flat["first-ten-minutes"]
    assert "mostly dme_dme" in flat["pbn-engineer"]
    assert "not shown to be inside RNP 0.3" in flat["gnss-analyst"]
    assert "excluded at 30 (G10 at 30)" in flat["gnss-analyst"]
    assert len(list((site / "_images").glob("*.png"))) >= 3


def test_every_link_of_the_site_leads_to_a_page_and_a_place_in_it(site: Path) -> None:
    texts = {page: page.read_text(encoding="utf-8") for page in pages(site)}
    places = {page: set(re.findall(r'\bid="([^"]+)"', text)) for page, text in texts.items()}
    links = 0
    for page, text in texts.items():
        for link in re.findall(r'\b(?:href|src)="([^"]*)"', text):
            if re.match(r"[a-z]+:", link) or link in {"", "#"} or (page.name == "gallery.html"):
                continue
            name, _, place = html.unescape(link).partition("#")
            target = (page.parent / unquote(name.partition("?")[0])).resolve() if name else page
            if target.name == "gallery.html":
                continue
            assert target.exists(), f"{page.relative_to(site)}: {link}"
            if place and target in places:
                assert unquote(place) in places[target], f"{page.relative_to(site)}: {link}"
            links += 1
    assert links > 1000


def test_every_link_of_the_documents_leads_to_a_file_of_the_repository() -> None:
    links = 0
    for page in (*DOCS.rglob("*.md"), *(ROOT / "examples").rglob("*.md"), ROOT / "CONTRIBUTING.md"):
        text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            if not re.match(r"[a-z]+:", link):
                assert (page.parent / link.partition("#")[0]).exists(), f"{page.relative_to(ROOT)}: {link}"
                links += 1
    assert links > 80


@pytest.mark.parametrize("page", sorted((DOCS / "tutorials").glob("*.md")), ids=lambda page: page.stem)
def test_python_sessions_of_the_tutorials_print_what_they_state(page: Path) -> None:
    failed, tried = doctest.testfile(str(page), module_relative=False, optionflags=doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL)
    assert failed == 0
    assert tried > 0 or ">>>" not in page.read_text(encoding="utf-8")


def test_every_public_name_and_command_is_in_the_reference(site: Path) -> None:
    for subject in navbound.SUBJECTS:
        python = (site / "reference" / "python" / f"{subject}.html").read_text(encoding="utf-8")
        for name in getattr(getattr(navbound, subject), "__all__", ()):
            assert re.search(rf'id="navbound\.(?:\w+\.)*{name}"|<span class="pre">{name}</span>', python), f"{subject}.{name}"
    commands = html.unescape(re.sub(r"<[^>]+>", "", (site / "reference" / "commands.html").read_text(encoding="utf-8")))
    assert "navbound live counts" in commands
    assert commands.count("Usage: navbound") > 20


@needs_browser
def test_search_works_from_the_disk_without_a_network(site: Path, browser: Browser) -> None:
    context = browser.new_context(offline=True)
    page = context.new_page()
    page.goto(f"{(site / 'search.html').as_uri()}?q=araim")
    page.wait_for_selector("#search-results li a")
    assert "ARAIM" in page.locator("#search-results").inner_text()
    context.close()


@needs_browser
def test_no_page_is_wider_than_a_telephone_and_none_requests_the_network(site: Path, browser: Browser) -> None:
    context = browser.new_context(viewport={"width": 420, "height": 900})
    page = context.new_page()
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    records = [each for each in pages(site) if each.parent.name == "decisions"]
    # Decision records are text alone: some of them stand for all.
    for each in (each for each in pages(site) if each not in records[5:]):
        page.goto(each.as_uri())
        assert page.evaluate("document.documentElement.scrollWidth") <= 420, each.relative_to(site)
    assert not [url for url in requests if not url.startswith(("file:", "data:"))]
    context.close()


@needs_browser
def test_the_dark_is_dark(site: Path, browser: Browser) -> None:
    shade = {}
    for scheme in ("light", "dark"):
        context = browser.new_context(color_scheme="dark" if scheme == "dark" else "light")
        page = context.new_page()
        page.goto((site / "index.html").as_uri())
        colour = page.evaluate("getComputedStyle(document.body).backgroundColor")
        shade[scheme] = sum(int(part) for part in re.findall(r"\d+", colour)[:3])
        context.close()
    assert shade["dark"] < 150
    assert shade["light"] > 600
