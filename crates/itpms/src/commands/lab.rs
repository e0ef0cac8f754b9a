//! `itpms lab STUDY`: handed to the program `itpms-lab`, which is built with the workspace and not published with this one.

use std::env::{self, consts::EXE_SUFFIX};
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

use itpms_console::{Failure, Screen};

use crate::args::Study;

/// Becomes `itpms-lab`; returns only if that cannot be.
pub(crate) fn run(study: &Study, screen: &Screen) -> Result<(), Failure> {
    let (study, words) = study.call();
    let mut command = Command::new(program());
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

/// The one beside this program, else that of the PATH.
fn program() -> PathBuf {
    let name = format!("itpms-lab{EXE_SUFFIX}");
    let beside = env::current_exe().ok().map(|own| own.with_file_name(&name));
    beside.filter(|path| path.is_file()).unwrap_or_else(|| OsStr::new(&name).into())
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
