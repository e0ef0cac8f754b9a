//! How many threads compute. The studies compute on as many as the pool of the process has.

use std::thread;

use crate::exit::Failure;
use crate::options::Jobs;

/// As many as there are processors, unless given.
pub fn at_a_time(jobs: Option<u16>) -> usize {
    jobs.map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from)
}

/// Tells the studies. Once in a process, before they begin.
pub fn set(jobs: Jobs) -> Result<(), Failure> {
    let Some(count) = jobs.at_a_time else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(count))
        .build_global()
        .map_err(|error| Failure::Usage(format!("no threads to compute with: {error}")))
}
