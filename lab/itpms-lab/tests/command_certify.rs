//! `itpms lab certify` from outside. What the tests themselves give is tested in `itpms-analysis`, shortened; here are the words
//! around them.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use std::process::Stdio;
use std::time::Duration;

use common::{Bench, interrupt};

#[test]
fn the_list_names_every_test_with_its_limit_and_drives_none() {
    let bench = Bench::new();
    let outcome = bench.run("certify --list");
    let lines: Vec<&str> = outcome.success().lines().collect();
    // R141: 4 wheels, all four, 8 unplugged, 2 stuck, 1 exchanged; FMVSS: 15 combinations and the same 11.
    assert_eq!(lines.len(), 16 + 26);
    assert!(
        lines.iter().any(|line| line.starts_with("un-r141-puncture-fl ") && line.ends_with("within 10:00"))
    );
    assert!(
        lines.iter().any(|line| line.starts_with("fmvss-138-low-all ") && line.ends_with("within 20:00"))
    );
    assert_eq!(bench.run("certify --quick --list").success().lines().count(), 6);
    assert_eq!(bench.run("certify --list --only puncture").success().lines().count(), 4);
    assert!(bench.names().is_empty());
}

#[test]
fn what_cannot_be_driven_or_written_is_said_before_anything_is_driven() {
    let bench = Bench::new();
    assert!(bench.run("certify --only brakes").refusal().starts_with("no test's name contains \"brakes\""));
    assert!(bench.run("certify --report no/page.html").refusal().contains("does not exist"));
    bench.write("file", "");
    assert!(bench.run("certify --out file").refusal().contains("expected a directory"));
    assert_eq!(bench.run("certify --list --json").code, Some(2));
    assert_eq!(bench.names(), ["file"]);
}

/// Asked once it ends as soon as it looks; asked twice it is ended without.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_and_leaves_nothing() {
    for twice in [false, true] {
        let bench = Bench::new();
        let mut command = bench.command(["certify", "--report", "page.html", "--out", "results"]);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        while !bench.names().iter().any(|name| name == "results") {
            std::thread::sleep(Duration::from_millis(5));
        }
        if twice {
            let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
            assert!(kill.unwrap().success());
        }
        let outcome = interrupt(child, "INT");
        assert_eq!((outcome.code, outcome.stdout.as_str()), (Some(130), ""), "{outcome:?}");
        assert!(bench.names().is_empty(), "{:?}", bench.names());
    }
}
