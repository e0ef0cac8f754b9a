//! `itpms lab reproduce`: the paper's study made again, as a page and its files.

use itpms_console::{Failure, Folder, Interrupt, Screen, threads};
use itpms_lab::paper::{Request, reproduce};

use super::driven;
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
    let (summary, files) = driven(screen, interrupt, |look| {
        let study = reproduce(&request, look)?;
        Ok((study.summary(), study.files()?))
    })?;
    folder.fill(files.into_iter().map(|file| (file.name, file.content)), screen)?;
    screen.print_lines(summary.trim_end());
    screen.print(format!("See {} for every figure and table.", folder.at("index.html").display()));
    Ok(())
}
