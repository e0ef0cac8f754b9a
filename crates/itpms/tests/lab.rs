//! `itpms lab`: what this program does itself, with and without the word, and studies that it hands on.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use common::Bench;

const TOOLS: [&str; 3] = ["simulate", "identify", "calibrate"];
const STUDIES: [&str; 7] =
    ["score", "soak", "certify", "malfunctions", "observability", "reproduce", "faults"];

fn listed(help: &str) -> Vec<String> {
    let commands =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = commands.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

#[test]
fn tools_and_studies_are_listed_under_lab_alone() {
    let bench = Bench::new();
    let top = listed(bench.run("--help").success());
    let lab = listed(bench.run("lab --help").success());
    assert!(top.contains(&"estimate".to_owned()) && top.contains(&"lab".to_owned()), "{top:?}");
    for name in TOOLS.iter().chain(&STUDIES).map(|name| (*name).to_owned()) {
        assert!(!top.contains(&name) && lab.contains(&name), "{name}: {top:?} {lab:?}");
    }
    for shell in ["bash", "zsh", "fish"] {
        let script = bench.run(&format!("completions {shell}"));
        let all = |names: &[&str]| names.iter().all(|name| script.success().contains(name));
        assert!(all(&TOOLS) && all(&STUDIES), "{shell}");
    }
}

#[test]
fn tools_go_on_without_the_word() {
    let bench = Bench::new();
    for tool in TOOLS {
        let [old, new] =
            [format!("{tool} --help"), format!("lab {tool} --help")].map(|line| bench.run(&line));
        let body = |help: &str| help.split_once("Usage:").unwrap().0.to_owned();
        assert_eq!(body(old.success()), body(new.success()));
    }
    bench.run("simulate paper-drop --seed 3 -o old.csv").success();
    bench.run("lab simulate paper-drop --seed 3 -o new.csv").success();
    assert_eq!(bench.read("old.csv"), bench.read("new.csv"));
}

/// Handing on, tried with a program of that name which prints its arguments.
#[cfg(unix)]
mod handing_on {
    use std::fs;
    use std::io::ErrorKind;
    use std::os::unix::fs::PermissionsExt as _;
    use std::process::Command;

    use super::{Bench, STUDIES};

    fn alone(bench: &Bench, line: &str) -> std::process::Output {
        let program = bench.path("itpms");
        if !program.exists() {
            fs::copy(crate::PROGRAM, &program).unwrap();
        }
        let mut command = Command::new(program);
        command.env("PATH", bench.path("elsewhere")).args(line.split_whitespace());
        loop {
            match command.output() {
                // Another test's child still holds the copy that was being written when it was forked.
                Err(error) if error.kind() == ErrorKind::ExecutableFileBusy => std::thread::yield_now(),
                outcome => break outcome.unwrap(),
            }
        }
    }

    fn place(bench: &Bench, name: &str, script: &str) {
        bench.write(name, script);
        fs::set_permissions(bench.path(name), fs::Permissions::from_mode(0o755)).unwrap();
    }

    #[test]
    fn a_study_gets_its_words_as_they_were_typed_and_its_exit_code_is_the_program_s() {
        let bench = Bench::new();
        place(&bench, "itpms-lab", "#!/bin/sh\nfor word; do echo \"<$word>\"; done\nexit 7\n");
        for study in STUDIES {
            for line in [format!("lab {study} --seeds 3 -x --help"), format!("{study} --seeds 3 -x --help")] {
                let output = alone(&bench, &line);
                assert_eq!(output.status.code(), Some(7), "{line}: {output:?}");
                let words = String::from_utf8(output.stdout).unwrap();
                assert_eq!(words, format!("<{study}>\n<--seeds>\n<3>\n<-x>\n<--help>\n"), "{line}");
            }
        }
        let quiet = alone(&bench, "--quiet lab score");
        assert_eq!(quiet.stdout, b"<--quiet>\n<score>\n");
    }

    #[test]
    fn one_on_the_path_is_found_too() {
        let bench = Bench::new();
        fs::create_dir(bench.path("elsewhere")).unwrap();
        place(&bench, "elsewhere/itpms-lab", "#!/bin/sh\necho found\n");
        assert_eq!(alone(&bench, "lab score").stdout, b"found\n");
    }

    #[test]
    fn without_the_program_the_message_names_the_way_out() {
        let output = alone(&Bench::new(), "lab score --quick");
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.starts_with("error: lab score: the program itpms-lab is neither"), "{message}");
        assert!(
            message.contains("cargo build --release -p itpms-lab") && message.lines().count() == 1,
            "{message}"
        );
    }
}
