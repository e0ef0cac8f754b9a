//! `itpms lab certify` from outside. What the tests themselves give is tested in `itpms-analysis`, shortened; here are the words
//! around them.

use std::process::Stdio;
use std::time::Duration;

use crate::common::{Bench, interrupt};

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
