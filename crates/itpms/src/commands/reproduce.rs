//! `itpms reproduce`: the paper's study made again, as a page and its files.

use std::fs;
use std::io;
use std::ops::ControlFlow;
use std::path::Path;

use itpms_data::out::AtomicFile;
use itpms_study::paper::{PaperError, Request, Study, reproduce};

use crate::args::ReproduceArgs;
use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::screen::Screen;

pub(crate) fn run(args: &ReproduceArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
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
    if args.out.exists() && !args.out.is_dir() {
        let error = io::Error::new(io::ErrorKind::NotADirectory, "it is a file, expected a directory");
        return Err(Failure::Directory(args.out.clone(), error));
    }
    let progress = screen.progress("driving");
    let look = |done: u64, total: u64| match interrupt.check() {
        Ok(()) => {
            progress.set(done as f64 / total as f64);
            ControlFlow::Continue(())
        }
        Err(_) => ControlFlow::Break(()),
    };
    let result = reproduce(&request, &look);
    drop(progress);
    let study = result.map_err(failure)?;
    write(&args.out, &study)?;
    screen.print(study.summary().trim_end());
    screen.print(format!("See {} for every figure and table.", args.out.join("index.html").display()));
    Ok(())
}

/// Everything into a directory; the files get their names when all are complete.
fn write(directory: &Path, study: &Study) -> Result<(), Failure> {
    let contents = study.files().map_err(failure)?;
    fs::create_dir_all(directory).map_err(|error| Failure::Directory(directory.to_owned(), error))?;
    let mut files = Vec::new();
    for content in contents {
        let mut file = AtomicFile::create(&directory.join(content.name))?;
        file.append(content.content.as_bytes())?;
        file.settle()?;
        files.push(file);
    }
    for file in files {
        file.commit()?;
    }
    Ok(())
}

fn failure(error: PaperError) -> Failure {
    match error {
        PaperError::Stopped => Failure::Interrupted,
        PaperError::Scenario(scenario) => Failure::Scenario(scenario),
        other => Failure::Usage(other.to_string()),
    }
}
