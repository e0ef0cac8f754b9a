//! Arguments of `itpms lab score`.

use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use itpms_console::options::{Jobs, Strict, one_of};
use itpms_drive::EstimatorKind;
use itpms_lab::score::Part;

/// Recompute the accuracy table: the standard scenarios over many seeds, held against the goals.
///
/// The same seeds give the same figures. A goal that is missed is marked; the exit code is 0 unless --strict is given.
#[derive(Debug, clap::Args)]
#[command(after_help = SCORE_EXAMPLES)]
pub(crate) struct ScoreArgs {
    /// Drives per row; cars of the row own.
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) seeds: u32,
    /// Three drives per row, five cars of the row own: minutes in place of hours.
    #[arg(long, conflicts_with = "seeds")]
    pub(crate) quick: bool,
    /// Seed of the first drive; the others follow.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) first_seed: u64,
    /// Which estimator; `all` compares them in the paper's scenarios.
    #[arg(long, value_name = "NAME", default_value = EstimatorKind::default().label(), value_parser = scored_names())]
    pub(crate) estimator: Scored,
    /// One part of the table instead of all.
    #[arg(long, value_name = "NAME", value_parser = one_of(Part::ALL, Part::label))]
    pub(crate) row: Option<Part>,
    /// Of the four-wheel parts, only rows whose names contain TEXT, such as "quarters, 80".
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    /// Cars with four wheels have wheel speeds beside their accelerations: rows drive, car and own.
    #[arg(long)]
    pub(crate) wheel_speeds: bool,
    #[command(flatten)]
    pub(crate) strict: Strict,
    #[command(flatten)]
    pub(crate) jobs: Jobs,
    /// Print JSON: version, estimators, seeds, first_seed and rows of part, name, drives, cells (name, value, goal,
    /// verdict), verdict.
    #[arg(long)]
    pub(crate) json: bool,
}

const SCORE_EXAMPLES: &str = "\
Examples:
  itpms lab score
  itpms lab score --row paper-drop --seeds 100 --first-seed 1000 --json
  itpms lab score --row car --quick
  itpms lab score --row own --seeds 10
  itpms lab score --row car --wheel-speeds
  itpms lab score --estimator all";

/// Whom to score.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Scored {
    One(EstimatorKind),
    All,
}

impl Scored {
    pub(crate) fn kinds(self) -> Vec<EstimatorKind> {
        match self {
            Scored::One(kind) => vec![kind],
            Scored::All => EstimatorKind::ALL.to_vec(),
        }
    }
}

fn scored_names() -> impl clap::builder::TypedValueParser<Value = Scored> {
    PossibleValuesParser::new(EstimatorKind::ALL.map(EstimatorKind::label).into_iter().chain(["all"]))
        .map(|label| EstimatorKind::from_label(&label).map_or(Scored::All, Scored::One))
}
