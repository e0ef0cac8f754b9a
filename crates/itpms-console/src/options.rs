//! Options and values that several commands take.

use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::exit::Failure;

/// How many at a time.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Jobs {
    /// Drives at a time; as many as there are processors unless given. The result is the same.
    #[arg(long = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub at_a_time: Option<u16>,
}

/// What every program of itpms takes.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Speaking {
    /// No progress bars and no remarks on standard error; errors and warnings stay.
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Whether errors and warnings are colored: auto, where standard error is a terminal and NO_COLOR is not set.
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub color: clap::ColorChoice,
}

/// A value that must be a positive number. Errors: it is none.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("expected a positive, finite number".to_owned()),
    }
}

/// One of `all` by its label, which help and completion list.
pub fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    all: [T; N],
    label: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.map(label)).try_map(move |given| {
        all.into_iter().find(|value| label(*value) == given).ok_or("expected a listed value")
    })
}

/// `--strict` of the studies that judge.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Strict {
    /// Exit code 1 if anything is marked.
    #[arg(long)]
    strict: bool,
}

impl Strict {
    /// The end of a study with so many of `what`. Errors: there are some, and it is strict.
    pub fn judge(self, marked: usize, what: &str) -> Result<(), Failure> {
        if self.strict && marked > 0 {
            return Err(Failure::Missed(format!("--strict: {what}: {marked}")));
        }
        Ok(())
    }
}
