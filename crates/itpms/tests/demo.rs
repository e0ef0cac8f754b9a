//! `itpms demo` from outside.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use common::{Bench, interrupt};

#[test]
fn the_demo_finds_the_punctured_tire_and_no_other() {
    let bench = Bench::new();
    let outcome = bench.run("demo --out here");
    let lines: Vec<&str> = outcome.success().lines().collect();
    let line = |corner: &str| lines.iter().find(|line| line.starts_with(corner)).unwrap();
    // The drop begins at 20 s and ends at 22.5 s.
    assert!(line("fl").contains("LOW, warned of at 2"), "{outcome:?}");
    for other in ["fr", "rl", "rr"] {
        assert!(!line(other).contains("LOW"), "{outcome:?}");
    }
    assert!(lines.last().unwrap().contains("here/report.html"));
    let mut names: Vec<_> = std::fs::read_dir(bench.path("here"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["car.toml", "drive.csv", "est.csv", "events.jsonl", "report.html", "road.csv"]);
    // Again into the same directory, beside what else is there.
    bench.write("here/mine.txt", "keep");
    bench.run("demo --out here --seed 2").success();
    assert_eq!(bench.read("here/mine.txt"), "keep");
    assert_eq!(bench.names(), ["here"]);
}

#[cfg(unix)]
#[test]
fn the_demo_needs_no_environment_and_speaks_the_unit_that_is_asked_for() {
    let bench = Bench::new();
    let done = bench.command(["--quiet", "demo", "--pressure-unit", "psi"]).env_clear().output().unwrap();
    assert!(done.status.success() && done.stderr.is_empty(), "{done:?}");
    let said = String::from_utf8(done.stdout).unwrap();
    let low: Vec<&str> = said.lines().filter(|line| line.contains("LOW")).collect();
    assert!(low.len() == 1 && low[0].starts_with("fl") && low[0].contains(" psi"), "{said}");
    assert!(said.ends_with("See itpms-demo/report.html for the whole story.\n"), "{said}");
    assert_eq!(bench.names(), ["itpms-demo"]);
}

#[cfg(unix)]
#[test]
fn an_interrupted_demo_leaves_nothing() {
    let bench = Bench::new();
    let mut command = bench.command(["demo"]);
    let mut child =
        command.stderr(std::process::Stdio::piped()).stdout(std::process::Stdio::null()).spawn().unwrap();
    while bench.names().is_empty() {
        assert!(child.try_wait().unwrap().is_none());
    }
    let outcome = interrupt(child, "INT");
    assert_eq!(outcome.code, Some(130), "{outcome:?}");
    assert_eq!(bench.names(), Vec::<String>::new());
}
