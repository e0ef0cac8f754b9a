//! Options and values that several commands take.

/// How many at a time.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Jobs {
    /// Drives at a time; as many as there are processors unless said. The result is the same.
    #[arg(long = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub at_a_time: Option<u16>,
}

/// A value that must be a positive number.
///
/// # Errors
/// It is none.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("expected a positive, finite number".to_owned()),
    }
}
