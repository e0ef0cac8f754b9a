//! `itpms lab reproduce`: the paper's study made again, as a page and its files.

use itpms_console::{Failure, Folder, Interrupt, Screen, threads};
use itpms_lab::paper::{PaperError, Request, reproduce};

use crate::args::ReproduceArgs;

pub(crate) fn run(args: &ReproduceArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    threads::set(args.jobs)?;
    let request = Request {
        seeds: args.drives(),
        first_seed: args.first_seed,
        rate_hz: args.rate,
        noise_m_s2: args.noise,
        road_gd_n0_m3: args.road,
        bench_rate_hz: args.bench_rate,
        bench_unsprung_mass_kg: args.bench_unsprung_mass,
        bench_actuator_hz: args.bench_actuator,
    };
    let folder = Folder::open(&args.out)?;
    let progress = screen.progress("driving");
    let look = |done: u64, total: u64| {
        progress.set(done as f64 / total as f64);
        interrupt.flow()
    };
    let result = reproduce(&request, &look);
    drop(progress);
    let study = result.map_err(failure)?;
    let files = study.files().map_err(failure)?;
    folder.fill(files.into_iter().map(|file| (file.name, file.content)), screen)?;
    screen.print_lines(study.summary().trim_end());
    screen.print(format!("See {} for every figure and table.", folder.at("index.html").display()));
    Ok(())
}

fn failure(error: PaperError) -> Failure {
    match error {
        PaperError::Stopped => Failure::Interrupted,
        PaperError::Scenario(scenario) => Failure::Scenario(scenario),
        other => Failure::Usage(other.to_string()),
    }
}
