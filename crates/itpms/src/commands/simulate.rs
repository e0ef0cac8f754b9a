//! `itpms lab simulate`: a scenario and a seed in, a drive log out.

use std::path::Path;

use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::Vehicle;
use itpms_data::log::{CornerColumns, LogColumns};
use itpms_data::out::{AtomicFile, LogWriter};
use itpms_drive::simulated;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use serde_json::json;

use super::ROWS_PER_LOOK;
use crate::args::SimulateArgs;

pub(crate) fn run(args: &SimulateArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let inputs = [
        (Some(Path::new(&args.scenario)), "the scenario"),
        (args.vehicle.as_deref(), "the vehicle file that is read"),
    ];
    names::check(&inputs, &[Some(&args.output), args.vehicle_out.as_deref()])?;
    let mut scenario = Scenario::load(&args.scenario)?;
    simulated::take_crg(&mut scenario)?;
    if let Some(path) = &args.vehicle {
        simulated::take_vehicle(&mut scenario, &Vehicle::read(path)?)?;
    }
    let columns = simulated::columns(&scenario, truth(args.no_truth));
    write(&scenario, args.seed, columns, &args.output, args.vehicle_out.as_deref(), screen, interrupt)?;
    report(args, screen, &scenario);
    Ok(())
}

/// Drives a scenario into a log with its truth, and writes the vehicle file that belongs to it.
pub(crate) fn write_drive(
    scenario: &Scenario,
    seed: u64,
    log: &Path,
    vehicle: Option<&Path>,
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    write(scenario, seed, simulated::columns(scenario, truth(false)), log, vehicle, screen, interrupt)
}

fn write(
    scenario: &Scenario,
    seed: u64,
    columns: LogColumns,
    log: &Path,
    vehicle: Option<&Path>,
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let mut simulation = Simulation::new(scenario, seed)?;
    let rows = scenario.rows();
    let mut log = LogWriter::create(log, columns)?;
    let vehicle_file = vehicle.map(|path| written_vehicle(path, scenario)).transpose()?;

    let progress = screen.progress(&format!("simulating {}", scenario.name));
    for (row, count) in simulation.by_ref().zip(0u64..) {
        if count.is_multiple_of(ROWS_PER_LOOK) {
            interrupt.check()?;
            progress.set(count as f64 / rows as f64);
        }
        log.write(&simulated::log_row(&row))?;
    }
    drop(progress);

    simulated::check(scenario, &simulation)?;
    let log = log.finish()?;
    interrupt.check()?;
    for file in [Some(log), vehicle_file].into_iter().flatten() {
        file.commit()?;
    }
    Ok(())
}

/// The truth beside each corner.
fn truth(no_truth: bool) -> CornerColumns {
    CornerColumns { pressure: !no_truth, road: !no_truth }
}

/// The vehicle file that belongs to the log, complete but for its name.
fn written_vehicle(path: &Path, scenario: &Scenario) -> Result<AtomicFile, Failure> {
    let mut file = AtomicFile::create(path)?;
    file.append(simulated::vehicle_of(scenario)?.to_toml().as_bytes())?;
    file.settle()?;
    Ok(file)
}

fn report(args: &SimulateArgs, screen: &Screen, scenario: &Scenario) {
    let corners: Vec<&str> = scenario.corner.iter().map(|(corner, _)| corner.label()).collect();
    if args.json {
        screen.print_lines(json!({
            "scenario": scenario.name,
            "seed": args.seed,
            "log": args.output.display().to_string(),
            "vehicle": args.vehicle_out.as_ref().map(|path| path.display().to_string()),
            "rows": scenario.rows(),
            "rate_hz": scenario.rate_hz,
            "duration_s": scenario.duration_s,
            "corners": corners,
        }));
    } else {
        screen.remark(format!(
            "{}: {} s at {} Hz, {} rows, corners {}, seed {}",
            args.output.display(),
            scenario.duration_s,
            scenario.rate_hz,
            scenario.rows(),
            corners.join(" "),
            args.seed
        ));
    }
}
