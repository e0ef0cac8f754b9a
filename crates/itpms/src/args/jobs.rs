//! `--jobs` of the tools that drive many drives.

/// How many at a time.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct Jobs {
    /// Drives at a time; as many as there are processors unless said. The result is the same.
    #[arg(long = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) at_a_time: Option<u16>,
}
