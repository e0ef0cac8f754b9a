//! `itpms lab simulate`: a scenario and a seed in, a drive log out.

use std::path::Path;

use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_data::log::{CornerColumns, LogColumns};
use itpms_data::out::{AtomicFile, LogWriter};
use itpms_data::pulses::{Pulse, PulseWriter};
use itpms_drive::simulated;
use itpms_sim::pulses::PulseCar;
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
    let outputs = [Some(args.output.as_path()), args.vehicle_out.as_deref(), args.pulses_out.as_deref()];
    names::check(&inputs, &outputs)?;
    let mut scenario = Scenario::load(&args.scenario)?;
    simulated::take_crg(&mut scenario)?;
    if let Some(path) = &args.vehicle {
        simulated::take_vehicle(&mut scenario, &Vehicle::read(path)?)?;
    }
    let columns = simulated::columns(&scenario, truth(args.no_truth));
    write(&scenario, args.seed, columns, &outputs_of(args), screen, interrupt)?;
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
    let outputs = Outputs { log, vehicle, pulses: None };
    write(scenario, seed, simulated::columns(scenario, truth(false)), &outputs, screen, interrupt)
}

struct Outputs<'a> {
    log: &'a Path,
    vehicle: Option<&'a Path>,
    pulses: Option<&'a Path>,
}

fn outputs_of(args: &SimulateArgs) -> Outputs<'_> {
    Outputs { log: &args.output, vehicle: args.vehicle_out.as_deref(), pulses: args.pulses_out.as_deref() }
}

fn write(
    scenario: &Scenario,
    seed: u64,
    columns: LogColumns,
    outputs: &Outputs<'_>,
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let mut simulation = Simulation::new(scenario, seed)?;
    let rows = scenario.rows();
    let mut log = LogWriter::create(outputs.log, columns)?;
    let mut pulses = outputs.pulses.map(|path| Pulses::create(path, scenario, seed)).transpose()?;
    let written = |path| -> Result<_, Failure> {
        Ok(AtomicFile::settled(path, simulated::vehicle_of(scenario)?.to_toml().as_bytes())?)
    };
    let vehicle_file = outputs.vehicle.map(written).transpose()?;

    let progress = screen.progress(&format!("simulating {}", scenario.name));
    for (row, count) in simulation.by_ref().zip(0u64..) {
        if count.is_multiple_of(ROWS_PER_LOOK) {
            interrupt.check()?;
            progress.set(count as f64 / rows as f64);
        }
        log.write(&simulated::log_row(&row))?;
        if let Some(pulses) = &mut pulses {
            pulses.until(row.time_s)?;
        }
    }
    drop(progress);

    simulated::check(scenario, &simulation)?;
    let log = log.finish()?;
    let pulses = pulses.map(|pulses| pulses.file.finish()).transpose()?;
    interrupt.check()?;
    for file in [Some(log), pulses, vehicle_file].into_iter().flatten() {
        file.commit()?;
    }
    Ok(())
}

/// The tooth pulses of a drive on their way into a file.
struct Pulses {
    car: PulseCar,
    file: PulseWriter,
}

impl Pulses {
    fn create(path: &Path, scenario: &Scenario, seed: u64) -> Result<Self, Failure> {
        let car_seed = scenario.wheel_speeds.and_then(|wheels| wheels.car_seed).unwrap_or(seed);
        Ok(Self { car: PulseCar::new(scenario, car_seed, seed)?, file: PulseWriter::create(path)? })
    }

    /// Those that pass up to a time.
    fn until(&mut self, time_s: f64) -> Result<(), Failure> {
        let mut written = Ok(());
        let Self { car, file } = self;
        car.until(time_s, |wheel, time_s| {
            if let (Ok(()), Some(wheel)) = (&written, Corner::ALL.get(wheel)) {
                written = file.write(&Pulse { time_s, wheel: *wheel });
            }
        });
        Ok(written?)
    }
}

fn truth(no_truth: bool) -> CornerColumns {
    CornerColumns { pressure: !no_truth, road: !no_truth }
}

fn report(args: &SimulateArgs, screen: &Screen, scenario: &Scenario) {
    let corners: Vec<&str> = scenario.corner.iter().map(|(corner, _)| corner.label()).collect();
    if args.json {
        screen.print_lines(json!({
            "scenario": scenario.name,
            "seed": args.seed,
            "log": args.output.display().to_string(),
            "pulses": args.pulses_out.as_ref().map(|path| path.display().to_string()),
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
