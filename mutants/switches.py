"""A copy of the Rust sources in which every mutant of a sample stands behind a switch."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import tree_sitter
import tree_sitter_rust

ROOT = Path(__file__).parents[1]
PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))
SWITCH = """
/// Which mutant is active: the environment names it, or a caller of the library sets it.
#[allow(missing_docs)]
pub mod mutant {
    use std::sync::LazyLock;
    use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
    use std::sync::Mutex;
    const SIZE: usize = 8192;
    static ACTIVE: LazyLock<AtomicU32> =
        LazyLock::new(|| AtomicU32::new(std::env::var("MUTANT").ok().and_then(|v| v.parse().ok()).unwrap_or(0)));
    static TRACE: LazyLock<Option<String>> = LazyLock::new(|| std::env::var("MUTANT_TRACE").ok());
    static TRACING: LazyLock<AtomicBool> = LazyLock::new(|| AtomicBool::new(TRACE.is_some()));
    static SEEN: [AtomicBool; SIZE] = [const { AtomicBool::new(false) }; SIZE];
    static FILE: Mutex<()> = Mutex::new(());
    pub fn is(n: u32) -> bool {
        if TRACING.load(Relaxed) && !SEEN[n as usize].swap(true, Relaxed) {
            if let Some(path) = TRACE.as_ref() {
                let _guard = FILE.lock();
                let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
                std::io::Write::write_all(&mut file, format!("{n}\\n").as_bytes()).unwrap();
            }
        }
        ACTIVE.load(Relaxed) == n
    }
    #[unsafe(no_mangle)]
    pub extern "C" fn navbound_mutant(n: u32) {
        ACTIVE.store(n, Relaxed);
    }
    #[unsafe(no_mangle)]
    pub extern "C" fn navbound_reached(n: u32) -> bool {
        TRACING.store(true, Relaxed);
        SEEN[n as usize].swap(false, Relaxed)
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
        if m.genre == "FnValue" and b"impl " in head.rpartition(b"->")[2]:
            return "returns an impl, which has one type"
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
    workspace = copy / "Cargo.toml"
    workspace.write_text(workspace.read_text().replace('unsafe_code = "forbid"', 'unsafe_code = "allow"'))
    lib = copy / "crates/core/src/lib.rs"
    text = re.sub(r"#!\[cfg_attr\(not.*\n", "", lib.read_text())
    lib.write_text(text.replace("#![forbid(unsafe_code)]", "#![allow(warnings)]") + SWITCH)
    return left_out
