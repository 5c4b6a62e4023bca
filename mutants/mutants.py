"""Mutation testing of bound, monitor and judge: a random sample of the mutants that cargo-mutants lists, all compiled into one test build.

./dev mutants [N] [--seed S]

Compiling each of 6500 mutants takes minutes each; here a copy of the sources holds every mutant of the sample behind a switch
(``if mutant::is(17) { a - b } else { a + b }``), is compiled once, and the tests run once a mutant with the environment naming it. A first
run without a mutant notes which mutants each test reaches, so that only those tests run. A mutant that does not compile in place is left
out of the sample and counted, as is one in a ``const fn``, where there is no switch.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tree_sitter
import tree_sitter_rust

ROOT = Path(__file__).parents[1]
SCOPE = ("crates/core/src/bound/**", "crates/core/src/monitor/**", "crates/core/src/judge/**", "crates/assess/src/judge*.rs")
PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))
SWITCH = """
/// Which mutant is active.
#[allow(missing_docs)]
pub mod mutant {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{LazyLock, Mutex};
    static ACTIVE: LazyLock<u32> = LazyLock::new(|| std::env::var("MUTANT").ok().and_then(|v| v.parse().ok()).unwrap_or(0));
    static TRACE: LazyLock<Option<String>> = LazyLock::new(|| std::env::var("MUTANT_TRACE").ok());
    static SEEN: [AtomicBool; 8192] = [const { AtomicBool::new(false) }; 8192];
    static FILE: Mutex<()> = Mutex::new(());
    pub fn is(n: u32) -> bool {
        if let Some(path) = TRACE.as_ref() {
            if !SEEN[n as usize].swap(true, Ordering::Relaxed) {
                let _guard = FILE.lock();
                let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
                std::io::Write::write_all(&mut file, format!("{n}\\n").as_bytes()).unwrap();
            }
        }
        *ACTIVE == n
    }
}
"""


@dataclass(frozen=True)
class Mutant:
    """One mutant of cargo-mutants' list, with its number in the sample."""

    number: int
    name: str
    file: str
    genre: str
    replacement: str
    begin: tuple[int, int]
    end: tuple[int, int]
    function: str


def listed() -> list[dict[str, Any]]:
    """All mutants of the scope."""
    command = ["cargo", "mutants", "--list", "--json", "--no-config", "--dir", str(ROOT)]
    for scope in SCOPE:
        command += ["-f", scope]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def sample(every: list[dict[str, Any]], n: int, seed: int) -> list[Mutant]:
    """`n` of them, each as likely as any other."""
    chosen = random.Random(seed).sample(every, min(n, len(every)))
    point = lambda p: (p["line"] - 1, p["column"] - 1)  # noqa: E731
    return [
        Mutant(k, m["name"], m["file"], m["genre"], m["replacement"], point(m["span"]["start"]), point(m["span"]["end"]),
               (m["function"] or {}).get("function_name", ""))
        for k, m in enumerate(chosen, 1)
    ]  # fmt: skip


def enclosing(node: tree_sitter.Node, kind: str) -> tree_sitter.Node | None:
    """The innermost node of a kind around another."""
    while node is not None and node.type != kind:
        node = node.parent
    return node


class Source:
    """A file with switches around its mutants."""

    def __init__(self, path: Path, crate: str) -> None:
        self.text = path.read_bytes()
        self.tree = PARSER.parse(self.text)
        self.crate = crate
        self.wrapped: dict[int, list[tuple[Mutant, str]]] = {}
        self.inserted: dict[int, list[str]] = {}

    def byte(self, point: tuple[int, int]) -> int:
        """Offset of a line and a column, which counts characters."""
        lines = self.text.split(b"\n")
        before = sum(len(line) + 1 for line in lines[: point[0]])
        return before + len(lines[point[0]].decode()[: point[1]].encode())

    def add(self, m: Mutant) -> str:
        """Put a mutant in; why not, where it cannot be."""
        at, end = self.byte(m.begin), self.byte(m.end)
        node = self.tree.root_node.descendant_for_byte_range(at, max(at, end - 1))
        if node is None:
            return "no such place"
        function = enclosing(node, "function_item")
        if function is None or enclosing(node, "const_item") is not None or enclosing(node, "static_item") is not None:
            return "outside a function"
        head = self.text[function.start_byte : function.child_by_field_name("body").start_byte]
        if re.search(rb"\bconst\b[^(]*\bfn\b", head.split(b"(")[0]):
            return "const fn"
        switch = f"{self.crate}::mutant::is({m.number})"
        if m.genre == "FnValue":
            value = "" if m.replacement == "()" else m.replacement
            self.inserted.setdefault(function.child_by_field_name("body").start_byte + 1, []).append(f" if {switch} {{ return {value}; }} ")
            return ""
        if m.genre in {"BinaryOperator", "UnaryOperator"}:
            around = node.parent
            if around.type not in {"binary_expression", "compound_assignment_expr", "unary_expression"}:
                return f"in a {around.type}"
            if b"let " in self.text[around.start_byte : around.end_byte] and around.type == "binary_expression":
                return "in a chain of lets"
            self.wrapped.setdefault(around.id, []).append((m, "operator"))
            return ""
        if m.genre == "MatchArmGuard":
            self.wrapped.setdefault(node.id if node.start_byte == at and node.end_byte == end else node.id, []).append((m, "guard"))
            return ""
        return f"genre {m.genre}"

    def rendered(self) -> bytes:
        """The file."""
        return self._render(self.tree.root_node)

    def _plain(self, node: tree_sitter.Node, change: tuple[int, int, str] | None = None) -> bytes:
        out, at = bytearray(), node.start_byte
        for child in node.children:
            out += self._between(at, child.start_byte)
            if change is not None and change[:2] == (child.start_byte, child.end_byte):
                out += change[2].encode()
            else:
                out += self._render(child)
            at = child.end_byte
        out += self._between(at, node.end_byte)
        return bytes(out)

    def _between(self, begin: int, end: int) -> bytes:
        out = bytearray()
        for at in range(begin, end):
            out += self.text[at : at + 1]
        return bytes(out)

    def _render(self, node: tree_sitter.Node) -> bytes:
        if not node.children:
            text = self.text[node.start_byte : node.end_byte]
            for what in self.inserted.get(node.end_byte, []) if text == b"{" else []:
                text += what.encode()
        else:
            text = self._plain(node)
        for m, how in self.wrapped.get(node.id, []):
            switch = f"{self.crate}::mutant::is({m.number})".encode()
            if how == "guard":
                text = b"(if " + switch + b" { " + m.replacement.encode() + b" } else { " + text + b" })"
                continue
            operator = next(c for c in node.children if (c.start_point[0], c.start_point[1]) == self._point(m))
            other = self._plain(node, (operator.start_byte, operator.end_byte, m.replacement))
            statement = node.type == "compound_assignment_expr"
            form = (b"if %b { %b } else { %b }", b"(if %b { %b } else { %b })")[not statement]
            text = form % (switch, other, text)
        return text

    def _point(self, m: Mutant) -> tuple[int, int]:
        at = self.byte(m.begin)
        line = self.text.rfind(b"\n", 0, at)
        return (m.begin[0], at - line - 1)


def written(mutants: list[Mutant], copy: Path) -> dict[int, str]:
    """Write the copy with every mutant that can be in it; the others with their reasons."""
    for name in ("crates", "vectors", "Cargo.toml", "Cargo.lock", "docs/notation.md", "CONTRIBUTING.md"):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, copy / name, dirs_exist_ok=True)
        else:
            shutil.copy2(source, copy / name)
    files: dict[str, Source] = {}
    left_out = {}
    for m in mutants:
        crate = "crate" if "crates/core/" in m.file else "navbound_core"
        source = files.setdefault(m.file, Source(ROOT / m.file, crate))
        if reason := source.add(m):
            left_out[m.number] = reason
    for name, source in files.items():
        (copy / name).write_bytes(source.rendered())
    lib = copy / "crates/core/src/lib.rs"
    text = re.sub(r"#!\[cfg_attr\(not.*\n", "", lib.read_text())
    lib.write_text(text.replace("#![forbid(unsafe_code)]", "#![allow(warnings)]\n#![forbid(unsafe_code)]") + SWITCH)
    return left_out


def built(copy: Path, packages: list[str], target: Path) -> tuple[list[Path], set[int], str]:
    """Test programs; or the mutants that do not compile."""
    command = [
        "cargo",
        "test",
        "--no-run",
        "--message-format=json",
        "--offline",
        "--config",
        "profile.dev.package.navbound-core.opt-level=1",
    ]
    command += [a for p in packages for a in ("-p", p)]
    done = subprocess.run(
        command, cwd=copy, capture_output=True, text=True, check=False, env=os.environ | {"CARGO_TARGET_DIR": str(target)}
    )
    programs, wrong, words = [], set(), ""
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message.get("executable") and message.get("profile", {}).get("test"):
            programs.append(Path(message["executable"]))
        error = message.get("message") or {}
        if error.get("level") == "error":
            words += error.get("rendered", "")
            for span in error.get("spans", []):
                text = (copy / span["file_name"]).read_text().splitlines()[span["line_start"] - 1 : span["line_end"]]
                near = re.findall(r"mutant::is\((\d+)\)", "\n".join(text))
                wrong |= {int(n) for n in near}
    return ([] if done.returncode else programs), wrong, words or done.stderr[-3000:]


def tests_of(program: Path, folder: Path) -> list[str]:
    """Names of a program's tests; those that read the sources themselves are not run."""
    listing = subprocess.run([program, "--list", "--format", "terse"], cwd=folder, capture_output=True, text=True, check=True).stdout
    return [line.removesuffix(": test") for line in listing.splitlines() if line.endswith(": test")]


def main() -> int:
    """Sample, build, run, and print the figures and the survivors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("n", type=int, nargs="?", default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--list", type=Path, help="a list made before by cargo mutants --list --json")
    parser.add_argument("--work", type=Path, default=ROOT / "target" / "mutants")
    parser.add_argument("--target", type=Path, default=ROOT / "target")
    parser.add_argument("--packages", default="navbound-core")
    parser.add_argument("--prepare", action="store_true", help="build and stop")
    a = parser.parse_args()
    every = json.loads(a.list.read_text()) if a.list else listed()
    chosen = sample(every, a.n, a.seed)
    copy, left_out = a.work / "copy", dict[int, str]()
    while True:
        stay = [m for m in chosen if m.number not in left_out]
        left_out |= written(stay, copy)
        programs, wrong, words = built(copy, a.packages.split(","), a.target)
        print(f"{len(stay)} mutants, {len(wrong)} do not compile, {len(programs)} programs", flush=True)
        if programs:
            break
        if not wrong:
            print(words[:6000])
            return 1
        left_out |= dict.fromkeys(wrong, "does not compile")
    stay = [m for m in chosen if m.number not in left_out]
    print(Counter(left_out.values()))
    return 0 if a.prepare else judged(stay, programs, copy, a.work, len(every))


def judged(stay: list[Mutant], programs: list[Path], copy: Path, work: Path, n_all: int) -> int:
    """Run the tests that reach each mutant until one fails."""
    reach: dict[int, list[tuple[float, Path, str]]] = {}
    folder = copy / "crates" / "core"
    for program in programs:
        if program.name.startswith("architecture"):
            continue
        for test in tests_of(program, folder):
            trace = work / "trace"
            trace.unlink(missing_ok=True)
            begin = time.monotonic()
            done = run(program, test, folder, {"MUTANT_TRACE": str(trace)}, 600)
            if done != 0:
                print(f"fails without a mutant: {program.name} {test}")
                continue
            took = time.monotonic() - begin
            for n in set(trace.read_text().split()) if trace.exists() else ():
                reach.setdefault(int(n), []).append((took, program, test))
    killed, survivors = 0, []
    for m in stay:
        tests = sorted(reach.get(m.number, []), key=lambda t: t[0])
        dead = next(
            (test for took, program, test in tests if run(program, test, folder, {"MUTANT": str(m.number)}, 60 + 10 * took) != 0), None
        )
        killed += dead is not None
        print(f"{'killed' if dead else 'SURVIVES' if tests else 'UNREACHED'} {m.name}" + (f" ({dead})" if dead else ""), flush=True)
        if dead is None:
            survivors.append(m)
    n = len(stay)
    share = killed / max(n, 1)
    half = 1.96 * (share * (1 - share) / max(n, 1)) ** 0.5
    print(f"{killed} of {n} killed: {share:.1%} +- {half:.1%} (95 %), of {n_all} mutants in all")
    return 0


def run(program: Path, test: str, folder: Path, variables: dict[str, str], seconds: float) -> int:
    """Exit status of one test; a test that does not end has failed."""
    environment = os.environ | variables | {"CARGO_MANIFEST_DIR": str(folder), "PROPTEST_CASES": "64"}
    try:
        done = subprocess.run(
            [program, "--exact", test, "--test-threads", "1", "-q"],
            cwd=folder,
            env=environment,
            capture_output=True,
            timeout=seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return -1
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
