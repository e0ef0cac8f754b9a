//! Runs the program as a user does: arguments in; exit code, two streams and files out.
#![allow(dead_code, reason = "every test file uses its own part")]

#[cfg(target_os = "linux")]
pub(crate) mod session;

use std::ffi::OsStr;
use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;

use serde_json::Value;
use tempfile::TempDir;

/// A directory of one test, gone at its end. Programs run in it, so that messages hold no random path.
pub(crate) struct Bench(TempDir);

/// A run's exit code and output.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Outcome {
    /// Exit code 2 and exactly one message, which is returned without its `error: `.
    pub(crate) fn refusal(&self) -> &str {
        assert_eq!(self.code, Some(2), "{self:?}");
        assert_eq!(self.stdout, "", "{self:?}");
        let text = self.stderr.strip_prefix("error: ").unwrap_or_else(|| panic!("{self:?}"));
        assert_eq!(text.trim_end().lines().count(), 1, "{self:?}");
        text.trim_end()
    }

    pub(crate) fn success(&self) -> &str {
        assert_eq!(self.code, Some(0), "{self:?}");
        &self.stdout
    }
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Everything in the directory, hidden files included, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub(crate) fn command<A: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = A>) -> Command {
        let mut command = Command::new(crate::PROGRAM);
        command.current_dir(self.0.path()).args(arguments).stdin(Stdio::null());
        command
    }

    pub(crate) fn run(&self, line: &str) -> Outcome {
        outcome(self.command(line.split_whitespace()))
    }

    /// What a successful run prints as JSON.
    pub(crate) fn json(&self, line: &str) -> Value {
        serde_json::from_str(self.run(line).success()).unwrap()
    }

    /// The objects of a file, one a line.
    pub(crate) fn json_lines(&self, name: &str) -> Vec<Value> {
        self.read(name).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// The paper's drive and its vehicle: `drive.csv` and `car.toml`, simulated once for all tests.
    pub(crate) fn with_drive() -> Self {
        static MADE: LazyLock<Bench> = LazyLock::new(|| {
            let bench = Bench::new();
            bench.run("simulate paper-drop --seed 3 -o drive.csv --vehicle-out car.toml").success();
            bench
        });
        let bench = Self::new();
        for name in MADE.names() {
            fs::copy(MADE.path(&name), bench.path(&name)).unwrap();
        }
        bench
    }

    /// Rewrites `drive.csv`: `edit` gets the number of each line (the header is 1) and its cells.
    pub(crate) fn edit_drive(&self, edit: impl Fn(usize, &mut Vec<String>)) {
        let mut out = String::new();
        for (i, line) in self.read("drive.csv").lines().enumerate() {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            edit(i + 1, &mut cells);
            out += &cells.join(",");
            out.push('\n');
        }
        self.write("drive.csv", out);
    }

    /// Starts the program with these words and waits until it has begun to write beside `output`.
    pub(crate) fn start(&self, line: &str, output: &str) -> Child {
        let mut command = self.command(line.split_whitespace());
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let begun = |bench: &Bench| {
            let prefix = format!(".{output}.");
            bench.names().into_iter().find(|name| name.starts_with(&prefix))
        };
        for _ in 0..6000 {
            if let Some(name) = begun(self)
                && fs::metadata(self.path(&name)).is_ok_and(|m| m.len() > 0)
            {
                return child;
            }
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        panic!("{line} has not begun to write {output} within half a minute");
    }
}

/// Ends a program as Ctrl-C (`INT`) or a polite kill (`TERM`) would, and waits for it.
pub(crate) fn interrupt(child: Child, signal: &str) -> Outcome {
    let kill = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    let output = child.wait_with_output().unwrap();
    Outcome {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

fn outcome(mut command: Command) -> Outcome {
    let output = command.output().unwrap();
    Outcome {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Cells of a CSV file: the header, then the rows.
pub(crate) fn table(text: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    (lines.next().unwrap(), lines.collect())
}
