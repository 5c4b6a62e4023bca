"""Names and sentences use the words of the field. A name says what a thing is; a program declares, reports and requests.

Barred are the words of `NAMES` as a whole part of an identifier (`found_rows`, `FoundRow`), in every language of the tree, and the words of
`PROSE` in comments, docstrings, messages and pages. Ordinary English stays: "a risk given in the file" and "no file was found" are
sentences, not names.
"""

from __future__ import annotations

import ast
import io
import re
import tokenize
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

NAMES = {
    "found": "the name of the thing: levels, positions, verdict",
    "held": "provenance, guaranteed, coverage, in_force",
    "told": "declared, reported",
    "said": "reported, sentence",
    "asked": "requested, required",
    "wanted": "requested, required, expected",
    "given": "declared, input",
    "chosen": "selected",
    "honest": "consistent",
    "honesty": "consistency",
    "dishonest": "overconfident, mismodelled",
    "misled": "misleading",
    "adrift": "after_gap",
    "staying": "correlated_error",
}
"""Parts of identifiers that say nothing, with what to write in their place."""

PROSE = {
    "told": "declared, reported, distinguished, recognised",
    "asked": "requested, required",
    "wanted": "requested, required",
    "honest": "consistent",
    "honesty": "consistency of the covariance",
    "dishonest": "overconfident, biased, mismodelled",
    "adrift": "after a gap",
    "wrong about itself": "overconfident",
    "the way to the stand": "taxi-in",
}
"""Words and phrases that are barred in sentences too."""

_LAST_WORD = re.compile(rf"\b(?:{'|'.join(phrase.split()[-1] for phrase in PROSE)})\b", re.I)

KEY = "a key of a file or a public parameter; its spelling does not change"
ALLOWED = {
    "FileNotFoundError": "of Python",
    "NotFoundError": "the pattern of an error",
    "NOT_FOUND": "of Python: a status of HTTP",
    "PositionHeld": "the id of a reason, position_held",
    "honesty": KEY + ": Summary.honesty",
    "hal_held": KEY + ": ProtectionSummary.hal_held",
    "limits_held": "the same fact before it is written",
}
"""Identifiers that stay, with the reason."""

ALLOWED_IN = {
    "held": (
        KEY,
        ("gbas/models.py", "run/ground.py", "studies/error_extraction/", "studies/surface_movement/", "test_gbas.py", "test_study_"),
    ),
    "held_laws": (KEY, ("studies/error_extraction/", "test_study_error_extraction.py")),
    "held_small": (KEY, ("studies/error_extraction/", "test_study_error_extraction.py")),
    "found": (KEY, ("studies/error_extraction/", "studies/surface_movement/", "test_study_")),
    "given": (KEY, ("studies/surface_movement/grid.py", "studies/surface_movement/scenario.py")),
    "wanted": (KEY, ("kpi/catalogue.py",)),
    "chosen": ("a field of a class in the bundle of the page", ("web/src/panel/performance.ts",)),
}
"""Identifiers that stay in the files whose path holds one of these parts."""

LIBRARY = {"given": "of hypothesis"}
"""Names of libraries, where the file imports them."""

CODE = {".py": ("python", "tests", "docs", "bench", "oracle", "examples"), ".pyi": ("python",), ".rs": ("crates",), ".ts": ("web/src",)}
PAGES = ("docs", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")
BUILT = ("python/navbound/_web", "node_modules")

_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_TOKENS = re.compile(
    r"""//[^\n]*|/\*.*?\*/|b?r(?P<hash>#*)".*?"(?P=hash)|b?"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\\n])'|(?P<template>`(?:\\.|[^`\\])*`)|(?P<name>[A-Za-z_]\w*)""",
    re.DOTALL,
)


def files(suffix: str, folders: tuple[str, ...]) -> list[Path]:
    """Files of a kind that people write."""
    every = [path for folder in folders for path in sorted((ROOT / folder).rglob(f"*{suffix}"))]
    return [p for p in every if not str(p.relative_to(ROOT)).startswith(BUILT) and p != Path(__file__)]


@cache
def python_names(text: str) -> list[tuple[int, str]]:
    """Identifiers of Python with their lines, those in formatted strings too."""
    names = []
    for node in ast.walk(ast.parse(text)):
        fields = [getattr(node, field, None) for field in ("id", "attr", "arg", "name", "asname")]
        names += [(getattr(node, "lineno", 0), name) for name in fields if isinstance(name, str)]
    return sorted(set(names))


@cache
def other_names(text: str) -> list[tuple[int, str]]:
    """Identifiers of Rust or TypeScript with their lines: comments and texts are passed over, expressions in templates are not."""
    names, line, at = [], 1, 0
    for token in _TOKENS.finditer(text):
        line, at = line + text.count("\n", at, token.start()), token.start()
        if token["name"]:
            names.append((line, token["name"]))
        elif token["template"]:
            names += [(line, n) for part in re.findall(r"\$\{([^{}]*)\}", token["template"]) for n in re.findall(r"[A-Za-z_]\w*", part)]
    return names


def barred(name: str) -> str | None:
    """The barred part of an identifier."""
    return next((part for part in _CAMEL.sub("_", name).lower().split("_") if part in NAMES), None)


def allowed(name: str, path: str, text: str) -> bool:
    """Whether an identifier with a barred part stays in a file."""
    if name in ALLOWED or (name in LIBRARY and "from hypothesis import" in text):
        return True
    _, places = ALLOWED_IN.get(name, ("", ()))
    return any(place in path for place in places)


def refused_names(suffix: str, path: str, text: str) -> list[str]:
    """Identifiers of a file that are barred."""
    names = python_names(text) if suffix.startswith(".py") else other_names(text)
    listed = [(line, name, barred(name)) for line, name in names]
    return [f"{path}:{line}: {name}; write {NAMES[word]}" for line, name, word in listed if word and not allowed(name, path, text)]


def sentences(path: str, text: str) -> list[tuple[int, str]]:
    """Lines of comments and of texts with more than one word; all lines of a page."""
    if path.endswith(".md"):
        return list(enumerate(text.splitlines(), 1))
    if path.endswith(".py"):
        tree = ast.parse(text)
        parts = [(n.lineno, n.value) for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        comments = [(t.start[0], t.string) for t in tokenize.generate_tokens(io.StringIO(text).readline) if t.type == tokenize.COMMENT]
    else:
        parts, line, at, comments = [], 1, 0, []
        for token in _TOKENS.finditer(text):
            line, at = line + text.count("\n", at, token.start()), token.start()
            if token["name"] is None:
                parts.append((line, token[0]))
    every = [(start + k, line) for start, part in parts + comments for k, line in enumerate(part.splitlines())]
    return [(number, line) for number, line in every if " " in line.strip()]


def refused_prose(path: str, text: str) -> list[str]:
    """Sentences of a file with a barred word. A name in backquotes or quotes and a part of an identifier are none."""
    refused = []
    # To take a file apart is slow; one without the last word of any phrase has none.
    for number, sentence in sentences(path, text) if _LAST_WORD.search(text) else []:
        words = re.sub(r"`[^`]*`|\"\w+\"|[#.]\w+", " ", sentence)
        refused += [f"{path}:{number}: {word}; write {better}" for word, better in PROSE.items() if re.search(rf"\b{word}\b", words, re.I)]
    return refused


@pytest.mark.parametrize("suffix", CODE)
def test_names_say_what_a_thing_is(suffix: str) -> None:
    paths = files(suffix, CODE[suffix])
    assert len(paths) >= 1, "nothing was read"
    refused = [line for p in paths for line in refused_names(suffix, str(p.relative_to(ROOT)), p.read_text(encoding="utf-8"))]
    assert refused == []


def test_sentences_use_the_words_of_the_field() -> None:
    paths = [p for suffix in (".py", ".rs") for p in files(suffix, CODE[suffix])]
    paths += [p for page in PAGES for p in ([ROOT / page] if page.endswith(".md") else files(".md", (page,)))]
    assert len(paths) > 300, "nothing was read"
    refused = [line for p in paths for line in refused_prose(str(p.relative_to(ROOT)), p.read_text(encoding="utf-8"))]
    assert refused == []


@pytest.mark.parametrize(
    ("suffix", "text", "names"),
    [
        (".py", "found_rows = 1  # found", ["found_rows"]),
        (".py", "def f(given): return g(held=given)", ["given", "held"]),
        (".py", "x = f'{asked} found'", ["asked"]),
        (".py", "foundation = background = 1", []),
        (".py", "def test_a_fault_is_told(): 'told'", ["test_a_fault_is_told"]),
        (".rs", 'let n_found = "found"; // found\nstruct FoundRow;', ["n_found", "FoundRow"]),
        (".rs", "let c = 'a'; fn f<'a>(told: &'a str) {}", ["told"]),
        (".rs", 'let q = r#"said "asked""#; let wanted = 1;', ["wanted"]),
        (".ts", "const a = `found ${held.length} said`; // told", ["held"]),
    ],
)
def test_the_reader_of_names_sees_code_and_nothing_else(suffix: str, text: str, names: list[str]) -> None:
    assert [line.split(": ")[1].split(";")[0] for line in refused_names(suffix, "a", text)] == names


def test_every_exception_is_needed() -> None:
    used: set[str | tuple[str, str]] = set()
    for suffix, folders in CODE.items():
        for path in files(suffix, folders):
            text = path.read_text(encoding="utf-8")
            names = {n for _, n in (python_names(text) if suffix.startswith(".py") else other_names(text))}
            place = str(path.relative_to(ROOT))
            used |= names & ALLOWED.keys()
            used |= {(n, part) for n in names & ALLOWED_IN.keys() for part in ALLOWED_IN[n][1] if part in place}
    assert set(ALLOWED) - used == set()
    assert {(n, part) for n, (_, parts) in ALLOWED_IN.items() for part in parts} - used == set()


def test_sentences_are_read_and_quoted_names_are_not() -> None:
    assert len(refused_prose("a.md", "The filter is told its statistics.")) == 1
    assert len(refused_prose("a.py", "honesty = 1  # The filter is told its statistics.")) == 1
    assert len(refused_prose("a.py", 'raise Error(f"{n} levels were asked for")')) == 1
    assert len(refused_prose("a.rs", "/// The filter is told its statistics.\nlet told = 1;")) == 1
    assert refused_prose("a.md", 'The key `adrift`, of summary.honesty, in #honesty, beside "asked".') == []
