//! Who may use whom: inside core in the order of the flow, and between the crates. For the Python package: tests/test_layers.py.
#![allow(clippy::unwrap_used, clippy::panic)] // A test may stop at the first surprise, in its helpers too.

use std::fs;
use std::path::{Path, PathBuf};

/// The stages in the order of the flow; each may use those before it.
const FLOW: [&str; 10] = ["quantity", "special", "frame", "signal", "geometry", "solution", "spec", "bound", "monitor", "judge"];
/// Each crate and those of ours it may depend on.
const CRATES: [(&str, &[&str]); 7] = [
    ("core", &[]),
    ("path", &["core"]),
    ("formats", &["core", "path"]),
    ("simulate", &["core", "path", "formats"]),
    ("assess", &["core", "path", "formats", "simulate"]),
    ("live", &["core", "path", "formats"]),
    ("python", &["core", "path", "formats", "simulate", "assess", "live"]),
];
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            paths.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            paths.push(path);
        }
    }
    paths
}

/// The stages of core that a source text names after `crate::`, one by one or in braces.
fn stages_used(text: &str) -> Vec<String> {
    let mut used = Vec::new();
    for line in text.lines().map(|l| l.split("//").next().unwrap_or("")) {
        for after in line.split("crate::").skip(1) {
            let names: String = match after.strip_prefix('{') {
                Some(list) => list.split('}').next().unwrap_or("").to_owned(),
                None => after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect(),
            };
            used.extend(names.split(',').map(|n| n.trim().split("::").next().unwrap_or("").to_owned()));
        }
    }
    used
}

#[test]
fn stages_use_only_earlier_stages() {
    let mut uses = 0;
    for (place, stage) in FLOW.iter().enumerate() {
        let folder = root().join("crates/core/src").join(stage);
        for file in files(&folder, "rs") {
            for used in stages_used(&fs::read_to_string(&file).unwrap()) {
                let Some(target) = FLOW.iter().position(|s| *s == used) else { continue };
                uses += 1;
                assert!(target <= place, "{stage} uses {used}, a later stage: {}", file.display());
            }
        }
    }
    assert!(uses > 20, "only {uses} uses found: the search is broken");
}

#[test]
fn every_stage_is_declared_and_every_module_is_a_stage() {
    let text = fs::read_to_string(root().join("crates/core/src/lib.rs")).unwrap();
    let mut declared: Vec<_> = text.lines().filter_map(|l| l.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    let mut flow = FLOW.to_vec();
    declared.sort_unstable();
    flow.sort_unstable();
    assert_eq!(declared, flow);
}

#[test]
fn crates_depend_one_way() {
    let mut edges = 0;
    for (name, allowed) in CRATES {
        let manifest = fs::read_to_string(root().join("crates").join(name).join("Cargo.toml")).unwrap();
        let dependencies = manifest.lines().filter_map(|l| l.trim().strip_prefix("navbound-"));
        for used in dependencies.map(|d| d.split(['.', ' ', '=']).next().unwrap()) {
            edges += 1;
            assert!(allowed.contains(&used), "{name} depends on {used}");
        }
    }
    assert!(edges >= 5, "only {edges} dependencies found: the search is broken");
    let mut members: Vec<_> = fs::read_dir(root().join("crates")).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    let mut known: Vec<_> = CRATES.iter().map(|c| c.0.to_owned()).collect();
    members.sort();
    known.sort();
    assert_eq!(members, known, "a crate without a place in the order");
}

/// What is beside the program `all.rs` in a folder of tests, as far as it can hold tests: files and folders of Rust.
fn beside(folder: &Path) -> Vec<String> {
    let paths = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let rust = paths.filter(|p| p.is_dir() || p.extension().is_some_and(|e| e == "rs"));
    rust.map(|p| p.file_stem().unwrap().to_str().unwrap().to_owned()).filter(|name| name != "all").collect()
}

#[test]
fn every_file_of_tests_is_run() {
    let mut run = 0;
    for (name, _) in CRATES {
        let folder = root().join("crates").join(name).join("tests");
        if !folder.is_dir() {
            continue;
        }
        let program = fs::read_to_string(folder.join("all.rs")).unwrap();
        let named: Vec<_> = program.lines().filter_map(|l| l.strip_prefix("mod ")?.strip_suffix(';')).collect();
        for file in beside(&folder) {
            run += 1;
            assert!(named.contains(&file.as_str()), "crates/{name}/tests/all.rs does not name {file}: its tests do not run");
        }
    }
    assert!(run > 20, "only {run} files found: the search is broken");
}

#[test]
fn the_search_sees_a_use_in_braces_and_ignores_comments() {
    assert_eq!(
        stages_used("use crate::{frame::Enu, bound};\n// crate::monitor\nlet x = crate::special::tail(1.0);"),
        ["frame", "bound", "special"]
    );
}

/// What is mathematics in a source text: a call by method or by path.
fn mathematics(text: &str) -> Vec<String> {
    const FUNCTIONS: [&str; 27] = [
        "sin",
        "cos",
        "tan",
        "asin",
        "acos",
        "atan",
        "atan2",
        "sin_cos",
        "sinh",
        "cosh",
        "tanh",
        "sqrt",
        "cbrt",
        "hypot",
        "exp",
        "exp2",
        "exp_m1",
        "ln",
        "ln_1p",
        "log",
        "log2",
        "log10",
        "powi",
        "powf",
        "to_degrees",
        "to_radians",
        "mul_add",
    ];
    let code = text.lines().map(|l| l.split("//").next().unwrap_or(""));
    let calls = code.flat_map(|line| {
        FUNCTIONS.iter().filter(move |f| {
            [format!(".{f}("), format!("::{f}("), format!("f64::{f})"), format!("f64::{f},")].iter().any(|call| line.contains(call))
        })
    });
    calls.map(|f| (*f).to_owned()).collect()
}

#[test]
fn the_binding_makes_no_mathematics() {
    for (line, function) in [("let x = y.sqrt();", "sqrt"), ("a.map(f64::sqrt)", "sqrt"), ("f64::atan2(y, x)", "atan2")] {
        assert_eq!(mathematics(line), [function]);
    }
    assert!(mathematics("// y.sqrt() in a comment, and core.cosine(x), expect(x)").is_empty());
    let sources = files(&root().join("crates/python/src"), "rs");
    assert!(sources.len() > 20, "only {} files found: the search is broken", sources.len());
    for file in sources {
        let calls = mathematics(&fs::read_to_string(&file).unwrap());
        assert!(calls.is_empty(), "{} calls {calls:?}: that belongs into assess or core", file.display());
    }
}
