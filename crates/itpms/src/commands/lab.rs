//! `itpms lab STUDY`: handed to the program `itpms-lab`, which is built with the workspace and not published with this one.

use std::env::{self, consts::EXE_SUFFIX};
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use itpms_console::{Failure, Screen};

use crate::args::Study;

const MANIFEST: &str = "lab/itpms-lab/Cargo.toml";

/// Becomes `itpms-lab`; returns only if that cannot be.
pub(crate) fn run(study: &Study, screen: &Screen) -> Result<(), Failure> {
    let (study, words) = study.call();
    let mut command = Command::new(program(screen));
    if screen.is_quiet() {
        command.arg("--quiet");
    }
    command.arg(study).args(words);
    let error = become_it(&mut command);
    let program = command.get_program().display();
    Err(Failure::Usage(if error.kind() == ErrorKind::NotFound {
        format!(
            "lab {study}: the program itpms-lab is neither beside this one nor on the PATH; in a clone of the project: cargo build --release -p itpms-lab"
        )
    } else {
        format!("lab {study}: {program}: {error}")
    }))
}

/// The one beside this program, else, where this one was built in a clone of the project, one that is built there now, else that of the
/// PATH.
fn program(screen: &Screen) -> PathBuf {
    let name = format!("itpms-lab{EXE_SUFFIX}");
    let beside = env::current_exe().ok().map(|own| own.with_file_name(&name));
    let there = beside.filter(|path| path.is_file() || build(path, screen).is_some());
    there.unwrap_or_else(|| OsStr::new(&name).into())
}

/// Builds it beside this program, as `cargo run` does not, if cargo built this one and the clone is at hand.
fn build(program: &Path, screen: &Screen) -> Option<()> {
    let built = program.parent()?;
    built.join(".fingerprint").is_dir().then_some(())?;
    let here = env::current_dir().ok()?;
    let clone = built.ancestors().chain(here.ancestors()).find(|path| path.join(MANIFEST).is_file())?;
    screen.remark("itpms-lab, the program of the studies, is built first");
    // The folder of profile `dev` is called otherwise.
    let profile = built.file_name().filter(|name| *name != "debug").unwrap_or(OsStr::new("dev"));
    let mut cargo = Command::new("cargo");
    cargo.args(["build", "--locked", "--package", "itpms-lab", "--profile"]).arg(profile);
    cargo.arg("--target-dir").arg(built.parent()?).current_dir(clone);
    cargo.status().ok()?.success().then_some(())
}

/// In the same process, so that signals and exit codes are the study's.
#[cfg(unix)]
fn become_it(command: &mut Command) -> std::io::Error {
    use std::os::unix::process::CommandExt as _;
    command.exec()
}

#[cfg(not(unix))]
fn become_it(command: &mut Command) -> std::io::Error {
    match command.status() {
        Ok(status) => std::process::exit(status.code().unwrap_or(2)),
        Err(error) => error,
    }
}
