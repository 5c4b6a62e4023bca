//! What makes core fit for an aircraft and can be seen in its text: states of one layout on every machine, loops that end, no `clamp` that
//! stops the program.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use std::fs;
use std::path::{Path, PathBuf};

/// Files whose `usize` fields live for one epoch, or for one call: counts of what came, places in a list of the caller, room that is filled
/// anew. A file that keeps something from epoch to epoch is not among them: its fields have a width of their own.
const OF_ONE_EPOCH: [&str; 35] = [
    "bound/araim/ceiling.rs",
    "bound/araim/exclusion.rs",
    "bound/araim/mod.rs",
    "bound/araim/subset.rs",
    "bound/faults.rs",
    "bound/gbas/aided.rs",
    "bound/gbas/snapshot.rs",
    "bound/level_equation.rs",
    "bound/raim/exclusion.rs",
    "bound/raim/mod.rs",
    "bound/rraim/coast.rs",
    "bound/rraim/multiple.rs",
    "bound/rraim/single.rs",
    "bound/sbas/mod.rs",
    "bound/sbas/position.rs",
    "bound/sbas/service.rs",
    "monitor/altimeter.rs",
    "quantity/encoding.rs",
    "quantity/refusal.rs",
    "solution/dme/fix.rs",
    "solution/dme/select.rs",
    "solution/ins/aid.rs",
    "solution/ins/covariance.rs",
    "solution/ins/loose.rs",
    "solution/ins/together.rs",
    "solution/mixture.rs",
    "solution/point.rs",
    "solution/point_offsets.rs",
    "solution/point_records.rs",
    "solution/point_residuals.rs",
    "solution/range_error.rs",
    "solution/snapshot.rs",
    "solution/wls.rs",
    "special/radius/lanes.rs",
    "special/radius/mod.rs",
];

fn core() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Every source file by its name below `src`, its tests left out.
fn sources() -> Vec<(String, String)> {
    fn collect(folder: &Path, all: &mut Vec<(String, String)>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, all);
            } else if !path.file_name().unwrap().to_str().unwrap().contains("tests") {
                let text = fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap().to_owned();
                all.push((path.strip_prefix(core()).unwrap().to_str().unwrap().to_owned(), code));
            }
        }
    }
    let mut all = Vec::new();
    collect(&core(), &mut all);
    assert!(all.len() > 100, "only {} files found: the search is broken", all.len());
    all
}

/// A field whose size is the machine's: `name: usize,` at the end of a line, alone or inside of a type.
fn machine_sized(line: &str) -> bool {
    let line = line.split("//").next().unwrap_or("").trim();
    let field = line.strip_prefix("pub ").or_else(|| line.split_once(") ").filter(|(before, _)| before.starts_with("pub(")).map(|x| x.1));
    let field = field.unwrap_or(line);
    let Some((name, kind)) = field.split_once(": ") else { return false };
    let named = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    let is_type = !kind.contains('(') || kind.starts_with('(') || kind.starts_with('[') || kind.starts_with("Option<");
    named && is_type && kind.ends_with(',') && kind.contains("usize") && !kind.contains("usize::")
}

/// A loop that does not count to a constant.
fn endless(line: &str) -> bool {
    let line = line.split("//").next().unwrap_or("").trim();
    let counted = line.strip_prefix("while ").and_then(|c| c.split_once(" < ")).is_some_and(|(name, to)| {
        name.chars().all(|c| c.is_ascii_lowercase()) && to.split(' ').next().unwrap().chars().all(|c| c.is_ascii_digit())
    });
    (line.starts_with("while ") || line == "loop {" || line.contains("= loop {")) && !counted
}

#[test]
fn what_is_kept_from_epoch_to_epoch_has_one_size_on_every_machine() {
    for line in ["    n: usize,", "pub stations: [usize; 2],", "pub(super) index: Option<usize>, // place"] {
        assert!(machine_sized(line), "{line}");
    }
    for line in ["    n: u8,", "// n: usize,", "let n: usize = 3;", "fn at(k: usize) -> f64 {", "most: usize::MAX,"] {
        assert!(!machine_sized(line), "{line}");
    }
    let with_fields: Vec<String> =
        sources().into_iter().filter(|(_, text)| text.lines().any(machine_sized)).map(|(name, _)| name).collect();
    for name in &with_fields {
        assert!(OF_ONE_EPOCH.contains(&name.as_str()), "{name} has a field of type usize: a state takes u8, u16, u32 or u64");
    }
    for name in OF_ONE_EPOCH {
        assert!(with_fields.iter().any(|f| f == name), "{name} has no such field any more: strike it off the list");
    }
}

#[test]
fn every_loop_says_when_it_ends() {
    assert!(endless("while rest != 0 {") && endless("loop {") && endless("let x = loop {") && endless("while i < self.n {"));
    assert!(!endless("while i < 24 {") && !endless("// while it lasts") && !endless("for k in 0..3 {"));
    let mut loops = 0;
    for (name, text) in sources() {
        let lines: Vec<&str> = text.lines().collect();
        for (k, line) in lines.iter().enumerate().filter(|(_, l)| endless(l)) {
            loops += 1;
            assert!(k > 0 && lines[k - 1].trim().starts_with("// At most "), "{name}:{}: `{}` does not say its bound", k + 1, line.trim());
        }
    }
    assert!(loops >= 8, "only {loops} loops found: the search is broken");
}

/// The limits of a call of `clamp` in this line.
fn limits(line: &str) -> Option<&str> {
    let (_, after) = line.split("//").next()?.split_once(".clamp(")?;
    after.split(')').next()
}

#[test]
fn clamp_has_limits_that_are_known_when_it_is_compiled() {
    let constant = |limit: &str| {
        let number = limit.replace(['_', ' ', '-', '.', 'e'], "");
        let upper = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
        number.chars().all(|c| c.is_ascii_digit()) || limit.trim().chars().all(upper)
    };
    let known = |line: &str| limits(line).is_none_or(|l| l.split(',').all(constant));
    assert!(known("x.clamp(-1.0, 1.0)") && known("x.clamp(0.0, PIECES_MOST)") && known("x.clamp(1e-9, 1.0 - 1e-6)") && known("x.max(y)"));
    assert!(!known("x.clamp(low, 1.0)") && !known("x.clamp(0.0, limits.latency_s)"));
    let mut calls = 0;
    for (name, text) in sources() {
        for line in text.lines() {
            calls += usize::from(limits(line).is_some());
            assert!(known(line), "{name}: `{}` may panic: use special::float::within", line.trim());
        }
    }
    assert!(calls > 5, "only {calls} calls found: the search is broken");
}
