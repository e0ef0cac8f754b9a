//! Sessions with a program as a terminal shows them: `transcripts/*.txt` beside a crate's tests.
//!
//! A line after `$ ` is run by a shell in a folder of the transcript's own; after `> ` it goes on. Below stands what was written to both
//! streams: `[..]` is anything within a line, `...` any number of lines. `? 2` is the exit code; without it, 0. A line that begins with `itpms`
//! and is refused (2) has to leave every file as it was. On Linux, whose `sed` and `grep` they are written for.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use super::Bench;

/// Whether a text is the pattern, whose gaps take anything.
fn fits(pattern: &str, text: &str) -> bool {
    let mut parts = pattern.split("[..]");
    let Some(mut rest) = text.strip_prefix(parts.next().unwrap_or_default()) else { return false };
    let mut parts = parts.peekable();
    if parts.peek().is_none() {
        return rest.is_empty();
    }
    while let Some(part) = parts.next() {
        let found =
            if parts.peek().is_none() { rest.strip_suffix(part).map(|_| "") } else { after(rest, part) };
        let Some(after) = found else { return false };
        rest = after;
    }
    true
}

fn after<'a>(text: &'a str, part: &str) -> Option<&'a str> {
    text.split_once(part).map(|(_, after)| after)
}

fn all_fit(patterns: &[&str], lines: &[&str]) -> bool {
    match patterns {
        [] => lines.is_empty(),
        ["...", rest @ ..] => (0..=lines.len()).any(|skipped| all_fit(rest, &lines[skipped..])),
        [pattern, rest @ ..] => {
            lines.split_first().is_some_and(|(line, lines)| fits(pattern, line) && all_fit(rest, lines))
        }
    }
}

/// Names and sizes of the files there.
fn files(bench: &Bench) -> BTreeMap<String, u64> {
    let size = |name: String| {
        let size = std::fs::symlink_metadata(bench.path(&name)).map_or(0, |found| found.len());
        (name, size)
    };
    bench.names().into_iter().map(size).collect()
}

/// Replays a transcript of the crate in `folder`, in the bench's folder.
pub(crate) fn replay(folder: &Path, name: &str, bench: &Bench) {
    let transcript = std::fs::read_to_string(folder.join(format!("tests/transcripts/{name}.txt"))).unwrap();
    let programs = Path::new(crate::PROGRAM).parent().unwrap();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap());
    let examples = folder.join("../../examples");
    for session in format!("\n{transcript}").split("\n$ ").skip(1) {
        let mut lines = session.lines().peekable();
        let mut command = lines.next().unwrap().to_owned();
        while let Some(more) = lines.next_if(|line| line.starts_with('>')) {
            command += &format!("\n{}", more[1..].strip_prefix(' ').unwrap_or(&more[1..]));
        }
        let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
        let (codes, expected): (Vec<&str>, Vec<&str>) = lines.partition(|line| line.starts_with("? "));
        let code = codes.first().map_or(0, |code| code[2..].parse().unwrap());
        let before = files(bench);
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("exec 2>&1\n{command}")]).current_dir(bench.path(""));
        shell.env("PATH", &path).env("EXAMPLES", &examples).env("LC_ALL", "C.UTF-8").stdin(Stdio::null());
        let output = shell.output().unwrap();
        let found = String::from_utf8_lossy(&output.stdout);
        let found: Vec<&str> = found.lines().filter(|line| !line.is_empty()).collect();
        assert!(
            all_fit(&expected, &found) && output.status.code() == Some(code),
            "$ {command}\nexpected, with code {code}:\n{}\nfound, with {:?}:\n{}",
            expected.join("\n"),
            output.status.code(),
            found.join("\n")
        );
        if code == 2 && command.starts_with("itpms") {
            assert_eq!(files(bench), before, "$ {command}");
        }
    }
}

#[test]
fn a_pattern_fits_what_it_says_and_nothing_else() {
    assert!(fits("a[..]c", "abbc") && fits("a[..]", "a") && fits("abc", "abc"));
    assert!(!fits("a[..]c", "abcd") && !fits("abc", "abcd") && !fits("b[..]", "abc"));
    assert!(all_fit(&["a", "...", "d"], &["a", "b", "c", "d"]) && all_fit(&["...", "a"], &["a"]));
    assert!(
        !all_fit(&["a", "...", "d"], &["a", "b"]) && !all_fit(&["a"], &["a", "b"]) && !all_fit(&["a"], &[])
    );
}
