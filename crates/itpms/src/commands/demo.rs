//! `itpms demo`: a drive with a puncture, simulated and estimated, so that a person sees in seconds what this is.
//!
//! Nothing of its own: the built-in `drive-puncture`, `itpms lab simulate` and `itpms estimate` one after the other, in a directory that gets its name
//! when both are done.

use std::path::{Path, PathBuf};
use std::{fs, io};

use itpms_console::{Failure, Interrupt, Screen};
use itpms_core::warning::Regulation;
use itpms_drive::EstimatorKind;
use itpms_road::RoadRepetition;
use itpms_sim::scenario::Scenario;

use super::{estimate, simulate};
use crate::args::{DemoArgs, EstimateArgs, LogArgs};

/// The built-in drive that is shown.
const SCENARIO: &str = "drive-puncture";

pub(crate) fn run(args: &DemoArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let workshop = Workshop::open(&args.out)?;
    let at = |name: &str| workshop.path.join(name);
    let scenario = Scenario::builtin(SCENARIO)?;
    simulate::write_drive(&scenario, args.seed, &at("drive.csv"), Some(&at("car.toml")), screen, interrupt)?;
    let estimate_args = EstimateArgs {
        log: at("drive.csv"),
        vehicle: at("car.toml"),
        output: Some(at("est.csv")),
        road_out: Some(at("road.csv")),
        report: Some(at("report.html")),
        estimator: EstimatorKind::default(),
        rate: 10.0,
        unit: args.unit,
        jobs: None,
        reading: LogArgs::default(),
        json: false,
        calibrate_s: None,
        pressure_kpa: None,
        save_reference: None,
        reference: None,
        pulses: None,
        events: Some(at("events.jsonl")),
        #[cfg(feature = "mcap")]
        mcap: None,
        regulation: Regulation::default(),
        tuning: None,
        road_repeats: RoadRepetition::default(),
    };
    let done = estimate::perform(&estimate_args, screen, interrupt)?;
    workshop.hand_over()?;

    let story = scenario.description.lines().map(str::to_owned).chain(estimate::corner_lines(&done));
    story.for_each(|line| screen.print_wrapped(line));
    screen.print(format!("See {} for the whole story.", args.out.join("report.html").display()));
    Ok(())
}

/// A directory under a temporary name beside the one it will become.
struct Workshop {
    path: PathBuf,
    target: PathBuf,
}

impl Workshop {
    fn open(target: &Path) -> Result<Self, Failure> {
        let fail = |error: io::Error| Failure::Directory(target.to_owned(), error);
        if target.exists() && !target.is_dir() {
            return Err(fail(io::Error::new(
                io::ErrorKind::NotADirectory,
                "it is a file, expected a directory",
            )));
        }
        let parent = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let path = parent.join(format!(".itpms-demo.{}.tmp", std::process::id()));
        fs::create_dir(&path).map_err(fail)?;
        Ok(Self { path, target: target.to_owned() })
    }

    /// Everything under its name: the whole directory where there is none, else file by file.
    fn hand_over(&self) -> Result<(), Failure> {
        let fail = |error: io::Error| Failure::Directory(self.target.clone(), error);
        if !self.target.exists() {
            return fs::rename(&self.path, &self.target).map_err(fail);
        }
        for entry in fs::read_dir(&self.path).map_err(fail)? {
            let entry = entry.map_err(fail)?;
            fs::rename(entry.path(), self.target.join(entry.file_name())).map_err(fail)?;
        }
        Ok(())
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        // After a hand-over it is gone or empty.
        let _ = fs::remove_dir_all(&self.path);
    }
}
