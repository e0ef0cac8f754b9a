//! Arguments of `itpms-lab`, or of `itpms lab`, which hands it on. Names are part of the contract with scripts.

mod certify;
mod faults;
mod malfunctions;
mod observability;
mod reproduce;
mod score;
mod soak;

use std::path::PathBuf;

use clap::{CommandFactory as _, Parser, Subcommand};
use clap_complete::Shell;
use itpms_console::options::Speaking;

pub(crate) use certify::CertifyArgs;
pub(crate) use faults::FaultsArgs;
pub(crate) use malfunctions::MalfunctionsArgs;
pub(crate) use observability::ObservabilityArgs;
pub(crate) use reproduce::ReproduceArgs;
pub(crate) use score::ScoreArgs;
pub(crate) use soak::SoakArgs;

/// Studies of itpms on simulated drives: the accuracy table, false warnings, test procedures, malfunctions, faults.
#[derive(Debug, Parser)]
#[command(name = "itpms-lab", version, max_term_width = 100)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) speaking: Speaking,
    /// Numbers of the monitor that are not to have their defaults (TOML); `itpms lab tuning` prints all of them.
    #[arg(long, value_name = "FILE", global = true)]
    pub(crate) tuning: Option<PathBuf>,
    #[command(subcommand)]
    pub(crate) study: Study,
}

impl Args {
    /// The command as it is typed.
    pub(crate) fn shown() -> clap::Command {
        Self::command()
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Study {
    Score(ScoreArgs),
    Soak(SoakArgs),
    Certify(CertifyArgs),
    Malfunctions(MalfunctionsArgs),
    Observability(ObservabilityArgs),
    Reproduce(ReproduceArgs),
    Faults(FaultsArgs),
    Completions(CompletionsArgs),
}

/// Print a completion script for a shell.
#[derive(Debug, clap::Args)]
pub(crate) struct CompletionsArgs {
    /// Which shell.
    pub(crate) shell: Shell,
}
