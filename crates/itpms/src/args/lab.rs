//! Arguments of `itpms lab`: the tools of this program itself, and studies that it hands to `itpms-lab`.

use std::ffi::OsString;

use clap::Subcommand;

use super::{CalibrateArgs, IdentifyArgs, SimulateArgs};

/// Simulations, bench tests and studies: the accuracy table, test procedures, faults.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Studies are done by the program itpms-lab, which lies beside this one or on the PATH."
)]
pub(crate) struct LabArgs {
    #[command(subcommand)]
    pub(crate) tool: Lab,
}

/// Everything under `lab`.
#[derive(Debug, Subcommand)]
pub(crate) enum Lab {
    #[command(flatten)]
    Tool(Tool),
    #[command(flatten)]
    Study(Study),
}

/// What this program does itself; has been there before `lab` was, and goes on without the word.
#[derive(Debug, Subcommand)]
pub(crate) enum Tool {
    Simulate(SimulateArgs),
    Identify(IdentifyArgs),
    Calibrate(CalibrateArgs),
    /// Print the numbers of the monitor that can be set, with what they mean: a file for --tuning.
    Tuning,
}

/// Studies of `itpms-lab`; `itpms score` is the older spelling of `itpms lab score`.
#[derive(Debug, Subcommand)]
pub(crate) enum Study {
    /// Recompute the accuracy table: the standard scenarios over many seeds, held against the goals.
    Score(Words),
    /// Count false warnings over many simulated hours.
    Soak(Words),
    /// Drive the test procedures of UN R141 Annex 3 and FMVSS 138 S6 in simulation.
    Certify(Words),
    /// Put every malfunction of the sensors into many everyday drives.
    Malfunctions(Words),
    /// What the accelerations of a corner can tell of its tire, and what they cannot.
    Observability(Words),
    /// Make the paper's study again.
    Reproduce(Words),
    /// Make things go wrong around a monitor and a calibration, and count what is lost.
    Faults(Words),
}

impl Study {
    /// Its name and what follows it.
    pub(crate) fn call(&self) -> (&'static str, &[OsString]) {
        match self {
            Study::Score(words) => ("score", &words.words),
            Study::Soak(words) => ("soak", &words.words),
            Study::Certify(words) => ("certify", &words.words),
            Study::Malfunctions(words) => ("malfunctions", &words.words),
            Study::Observability(words) => ("observability", &words.words),
            Study::Reproduce(words) => ("reproduce", &words.words),
            Study::Faults(words) => ("faults", &words.words),
        }
    }
}

/// The arguments after a study's name, as typed.
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Words {
    /// Options of the study: `itpms lab STUDY --help`.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    pub(crate) words: Vec<OsString>,
}

/// Leaves tools and studies out of the list of commands: they are under `lab`.
pub(super) fn without_studies(command: clap::Command) -> clap::Command {
    let under_lab = Study::augment_subcommands(Tool::augment_subcommands(clap::Command::new("lab")));
    let names: Vec<String> = under_lab.get_subcommands().map(|study| study.get_name().to_owned()).collect();
    names.into_iter().fold(command, |command, name| command.mut_subcommand(name, |study| study.hide(true)))
}
