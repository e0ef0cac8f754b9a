//! What can be typed after `itpms lab`: studies, for those who work on the estimator.

use clap::Subcommand;

#[cfg(feature = "live")]
use super::FaultsArgs;
use super::{
    CalibrateArgs, CertifyArgs, IdentifyArgs, MalfunctionsArgs, ObservabilityArgs, ReproduceArgs, ScoreArgs,
    SimulateArgs, SoakArgs,
};

/// Study tools: simulations, the accuracy table, test procedures, faults.
#[derive(Debug, clap::Args)]
pub(crate) struct LabArgs {
    #[command(subcommand)]
    pub(crate) tool: Lab,
}

/// Everything under `lab`.
#[derive(Debug, Subcommand)]
pub(crate) enum Lab {
    #[command(flatten)]
    Study(Study),
    #[cfg(feature = "live")]
    Faults(FaultsArgs),
}

/// What has been there before `lab` was, and goes on without the word.
#[derive(Debug, Subcommand)]
pub(crate) enum Study {
    Simulate(SimulateArgs),
    Score(ScoreArgs),
    Soak(SoakArgs),
    Certify(CertifyArgs),
    Malfunctions(MalfunctionsArgs),
    Identify(IdentifyArgs),
    Calibrate(CalibrateArgs),
    Observability(ObservabilityArgs),
    Reproduce(ReproduceArgs),
}

/// Leaves the studies out of the list of commands: they are under `lab`.
pub(super) fn without_studies(command: clap::Command) -> clap::Command {
    let studies = Study::augment_subcommands(clap::Command::new("studies"));
    let names: Vec<String> = studies.get_subcommands().map(|study| study.get_name().to_owned()).collect();
    names.into_iter().fold(command, |command, name| command.mut_subcommand(name, |study| study.hide(true)))
}
