//! `itpms simulate`: a scenario and a seed in, a drive log out.

use std::path::{Path, PathBuf};

use itpms_core::sample::Corner;
use itpms_data::crg::CrgRoad;
use itpms_data::log::{CornerColumns, LogColumns, LogCorner};
use itpms_data::out::{AtomicFile, LogWriter};
use itpms_data::{LogRow, Vehicle};
use itpms_sim::road::Surface;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_study::roughness::EvenProfile;
use serde_json::json;

use super::{ROWS_PER_LOOK, names};
use crate::args::SimulateArgs;
use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::screen::Screen;

pub(crate) fn run(args: &SimulateArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let inputs = [
        (Some(Path::new(&args.scenario)), "the scenario"),
        (args.vehicle.as_deref(), "the vehicle file that is read"),
    ];
    names::check(&inputs, &[Some(&args.output), args.vehicle_out.as_deref()])?;
    let mut scenario = Scenario::load(&args.scenario)?;
    take_crg(&mut scenario)?;
    if let Some(path) = &args.vehicle {
        take_vehicle(&mut scenario, &Vehicle::read(path)?)?;
    }
    let columns = columns(&scenario, args.no_truth);
    write(&scenario, args.seed, columns, &args.output, args.vehicle_out.as_deref(), screen, interrupt)?;
    report(args, screen, &scenario);
    Ok(())
}

/// Puts the points of an OpenCRG road in the place of its file: the simulation reads text only. The road is that along
/// the reference line, holes up to 0.25 m bridged.
fn take_crg(scenario: &mut Scenario) -> Result<(), Failure> {
    let Surface::Profile(profile) = &mut scenario.road.surface else { return Ok(()) };
    let is_crg =
        |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("crg"));
    let Some(path) = profile.file.take_if(|path| is_crg(path)) else { return Ok(()) };
    let road = CrgRoad::read(&path)?;
    let refuse = |why: String| Failure::Usage(format!("{}: {why}", path.display()));
    let line_m = road.line_m(0.0).map_err(|error| refuse(error.to_string()))?;
    let even = EvenProfile::of_even(road.start_m(), road.increment_m(), line_m);
    if even.heights_m.iter().any(|height_m| !height_m.is_finite()) {
        return Err(refuse(
            "the reference line has holes of more than 0.25 m, expected a height in every row".to_owned(),
        ));
    }
    let station = |i: usize| even.start_m + i as f64 * even.spacing_m;
    profile.points_m =
        even.heights_m.iter().enumerate().map(|(i, height_m)| [station(i), *height_m]).collect();
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
    write(scenario, seed, columns(scenario, false), log, vehicle, screen, interrupt)
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
        log.write(&log_row(&row))?;
    }
    drop(progress);

    if let Some(time_s) = simulation.diverged_s() {
        return Err(Failure::Usage(format!(
            "{}: from {time_s:.3} s on the car's accelerations are no numbers, or absurd: expected masses, springs, dampers and tires of a car",
            scenario.name
        )));
    }
    let log = log.finish()?;
    interrupt.check()?;
    for file in [Some(log), vehicle_file].into_iter().flatten() {
        file.commit()?;
    }
    Ok(())
}

fn columns(scenario: &Scenario, no_truth: bool) -> LogColumns {
    let truth = CornerColumns { pressure: !no_truth, road: !no_truth };
    LogColumns { speed: true, corners: Corner::ALL.map(|corner| scenario.corner.get(corner).map(|_| truth)) }
}

/// A simulated row as a log holds it: the pressure is the reference sensor's where the scenario has one, the road's
/// truth the profile under the axle.
fn log_row(row: &SimRow) -> LogRow {
    LogRow {
        time_s: row.time_s,
        speed_m_s: row.speed_m_s,
        corners: row.corners.map(|corner| {
            corner.map(|c| LogCorner {
                body_accel_m_s2: c.body_accel_m_s2,
                wheel_accel_m_s2: c.wheel_accel_m_s2,
                pressure_kpa: c.pressure_reading_kpa,
                road_m: c.road_m,
            })
        }),
    }
}

/// The scenario driven with another vehicle.
fn take_vehicle(scenario: &mut Scenario, vehicle: &Vehicle) -> Result<(), Failure> {
    for corner in Corner::ALL {
        let Some(spec) = scenario.corner.get_mut(corner) else { continue };
        let config = vehicle.corner(corner).ok_or_else(|| {
            Failure::Usage(format!(
                "the vehicle {:?} has no corner {}, which the scenario {} drives",
                vehicle.name,
                corner.label(),
                scenario.name
            ))
        })?;
        spec.set_vehicle(config);
    }
    if let Some(wheelbase_m) = vehicle.wheelbase_m {
        scenario.wheelbase_m = wheelbase_m;
    }
    Ok(())
}

/// The vehicle file that belongs to the log, complete but for its name.
fn written_vehicle(path: &Path, scenario: &Scenario) -> Result<AtomicFile, Failure> {
    let mut file = AtomicFile::create(path)?;
    file.append(vehicle_of(scenario)?.to_toml().as_bytes())?;
    file.settle()?;
    Ok(file)
}

/// What an estimator is to be told about the scenario's vehicle.
fn vehicle_of(scenario: &Scenario) -> Result<Vehicle, Failure> {
    let mut corners = [None; 4];
    for (corner, _) in scenario.corner.iter() {
        corners[corner.index()] = Some(scenario.corner_config(corner)?);
    }
    Ok(Vehicle {
        name: format!("vehicle of {}", scenario.name),
        id: None,
        wheelbase_m: Some(scenario.wheelbase_m),
        corners,
    })
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
