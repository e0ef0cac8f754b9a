//! What the program says of itself, and options that all commands have.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use common::Bench;

#[test]
fn the_version_has_its_commit_where_it_was_built_from_a_clone() {
    let version = Bench::new().run("--version").success().trim_end().to_owned();
    let rest = version.strip_prefix(concat!("itpms ", env!("CARGO_PKG_VERSION"))).unwrap();
    let commit = rest.strip_prefix(" (").and_then(|rest| rest.strip_suffix(')'));
    // A package from a registry has none.
    assert!(rest.is_empty() || commit.is_some_and(|commit| !commit.is_empty()), "{version}");
}

#[test]
fn every_command_that_is_listed_has_a_manual_page() {
    let bench = Bench::new();
    bench.run("man --out pages").success();
    let names: Vec<String> = std::fs::read_dir(bench.path("pages"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    for name in ["itpms", "itpms-estimate", "itpms-vehicle-learn", "itpms-lab-simulate", "itpms-lab-score"] {
        assert!(names.contains(&format!("{name}.1")), "{name}: {names:?}");
    }
    // The older spelling has no page of its own.
    assert!(!names.contains(&"itpms-simulate.1".to_owned()), "{names:?}");
    let page = bench.read("pages/itpms-lab-simulate.1");
    assert!(page.contains(".TH itpms-lab-simulate 1") && page.contains("itpms lab simulate"), "{page}");
}

#[test]
fn errors_are_colored_where_that_is_asked_for_and_not_in_a_pipe() {
    let bench = Bench::new();
    let said = |line: &str| bench.run(line).stderr;
    assert!(said("vehicle show nothing.toml").starts_with("error: nothing.toml"));
    assert!(said("--color never vehicle show nothing.toml").starts_with("error: nothing.toml"));
    let colored = said("--color always vehicle show nothing.toml");
    assert!(colored.starts_with("\x1b[1m\x1b[31merror:\x1b[0m nothing.toml"), "{colored:?}");
    // A name is another's: what is in it is never obeyed.
    let mut command = bench.command(["--color", "always", "vehicle", "show", "a\x1b[32mb.toml"]);
    let stderr = String::from_utf8(command.output().unwrap().stderr).unwrap();
    assert!(stderr.contains("a\\u001b[32mb.toml"), "{stderr:?}");
}
