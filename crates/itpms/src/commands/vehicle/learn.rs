//! `itpms vehicle learn`: drives at known pressures and a vehicle file in, a vehicle file out. The work is that of `itpms-drive`.

use std::path::Path;

use itpms_analysis::learn::{LearnedCorner, Parameter};
use itpms_console::{Failure, Interrupt, Screen, former, names};
use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_data::out::AtomicFile;
use itpms_drive::{KnownDrive, LearnedRadius, LearnedVehicle, learn, learn_radius};
use serde_json::json;

use crate::args::LearnArgs;

/// Width of the first column, and of a value with its deviation.
const NAME: usize = 34;
const CELL: usize = 20;

pub(super) fn run(args: &LearnArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let [dbc, signals] = args.reading.inputs();
    let mut inputs = vec![dbc, signals];
    inputs.extend(args.logs.iter().map(|log| (Some(log.as_path()), "a drive log")));
    names::check(&inputs, &[Some(&args.output)])?;
    let from = args.from.as_deref().unwrap_or(&args.output);
    if args.from.is_none() && !from.exists() {
        return Err(Failure::Usage(format!(
            "{}: is not there to begin with; give a vehicle file with --from, such as one by itpms vehicle init",
            from.display()
        )));
    }
    let vehicle = Vehicle::read(from)?;
    let drives = drives(args, &vehicle)?;
    if vehicle.corners.iter().all(Option::is_none) {
        return radius(args, (&vehicle, from), &drives, screen, interrupt);
    }
    let progress = screen.progress("learning");
    let learned = learn(&vehicle, &drives, &mut |share| {
        progress.set(share);
        interrupt.flow()
    })?;
    drop(progress);
    let name = from.file_name().unwrap_or(from.as_os_str()).to_string_lossy().into_owned();
    write(&args.output, &learned.to_toml(&name), screen)?;
    for concern in &learned.concerns {
        screen.warn(concern);
    }
    if args.json {
        let text = serde_json::to_string_pretty(&learned.document())
            .map_err(|error| Failure::Usage(format!("the result is no JSON: {error}")))?;
        screen.print_lines(text);
    } else {
        screen.print_lines(table(&vehicle, &learned));
    }
    screen.remark(format!(
        "{}: the car as these drives show it; a reference of another file does not fit it: calibrate anew",
        args.output.display()
    ));
    Ok(())
}

/// Of wheel speeds alone: how the radii follow the pressure.
fn radius(
    args: &LearnArgs,
    (vehicle, from): (&Vehicle, &Path),
    drives: &[KnownDrive],
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let progress = screen.progress("learning");
    let learned = learn_radius(vehicle, drives, &mut |share| {
        progress.set(share);
        interrupt.flow()
    })?;
    drop(progress);
    write(&args.output, &learned.vehicle.to_toml(), screen)?;
    for concern in &learned.concerns {
        screen.warn(concern);
    }
    let LearnedRadius { before, after, .. } = &learned;
    if args.json {
        let of = |[value, sd]: &[f64; 2]| json!({ "value": value, "sd": sd });
        let text = json!({ "radius_per_ln_pressure": { "before": of(before), "after": of(after) } });
        screen.print_lines(format!("{text:#}"));
    } else {
        screen.print(format!(
            "radius_per_ln_pressure {:.4} ± {:.4}, before {:.4} ± {:.4} ({})",
            after[0],
            after[1],
            before[0],
            before[1],
            from.display()
        ));
    }
    screen.remark(format!(
        "{}: how the radii follow the pressure, as these drives show it",
        args.output.display()
    ));
    Ok(())
}

fn write(path: &Path, text: &str, screen: &Screen) -> Result<(), Failure> {
    let mut file = AtomicFile::create(path)?;
    former::keep(path, text, screen)?;
    file.append(text.as_bytes())?;
    file.commit()?;
    Ok(())
}

/// A pressure for every wheel of every drive, but those that the tires' own sensors are to tell.
fn drives(args: &LearnArgs, vehicle: &Vehicle) -> Result<Vec<KnownDrive>, Failure> {
    let (logs, pressures) = (args.logs.len(), args.pressure_kpa.len());
    if pressures > 1 && pressures != logs {
        return Err(Failure::Usage(format!(
            "{pressures} times --pressure-kpa for {logs} logs, expected one for all or one for each, in the same order"
        )));
    }
    let mut drives = vec![];
    for (i, log) in args.logs.iter().enumerate() {
        let mut pressures_kpa = [f64::NAN; 4];
        let given = if pressures == 1 { args.pressure_kpa.first() } else { args.pressure_kpa.get(i) };
        let known = given.map_or([None; 4], |given| given.0);
        for corner in Corner::ALL {
            pressures_kpa[corner.index()] = match (known[corner.index()], vehicle.corner(corner)) {
                (Some(kpa), _) => kpa,
                (None, _) if given.is_none() => continue,
                (None, None) => continue,
                (None, Some(_)) => {
                    let (log, label) = (log.display(), corner.label());
                    return Err(Failure::Usage(format!(
                        "{log}: --pressure-kpa says nothing of {label}, expected a pressure for every wheel"
                    )));
                }
            };
        }
        drives.push(KnownDrive { log: log.clone(), options: args.reading.options(), pressures_kpa });
    }
    Ok(drives)
}

type Line = (&'static str, fn(&LearnedCorner) -> Parameter);

const LINES: [Line; 6] = [
    ("unsprung mass (kg)", |corner| corner.unsprung_mass_kg),
    ("tire stiffness at placard (N/m)", |corner| corner.tire_n_per_m),
    ("tire over unsprung mass (1/s2)", |corner| corner.stiffness_over_mass),
    ("damping (N s/m)", |corner| corner.damping_n_s_per_m),
    ("spring (N/m)", |corner| corner.spring_n_per_m),
    ("friction (N)", |corner| corner.friction_n),
];

fn table(file: &Vehicle, learned: &LearnedVehicle) -> String {
    let corners: Vec<(Corner, &LearnedCorner)> = Corner::ALL
        .into_iter()
        .filter_map(|corner| Some((corner, learned.learned.corners[corner.index()].as_ref()?)))
        .collect();
    let row = |name: &str, cells: &mut dyn Iterator<Item = String>| {
        let cells: String = cells.map(|cell| format!("{cell:>CELL$}")).collect();
        format!("{name:<NAME$}{cells}").trim_end().to_owned()
    };
    let mut out = vec![row("", &mut corners.iter().map(|(corner, _)| corner.label().to_owned()))];
    for (name, of) in LINES {
        let all = || corners.iter().map(|(_, corner)| of(corner));
        out.push(row(name, &mut all().map(|p| shown(p.before, p.before_sd, ' '))));
        let mark = |p: &Parameter| if p.is_learned() { '*' } else { ' ' };
        out.push(row("  learned", &mut all().map(|p| shown(p.after, p.after_sd, mark(&p)))));
    }
    let kpa = |vehicle: &Vehicle| {
        let vehicle = vehicle.clone();
        corners.iter().map(move |(corner, _)| format!("{:.0} ", vehicle.level_sd_kpa(&[*corner])))
    };
    out.push(row("pressure, uncalibrated (sd, kPa)", &mut kpa(file)));
    out.push(row("  learned", &mut kpa(&learned.vehicle)));
    let slope = &learned.learned.slope;
    out.push(String::new());
    out.push(format!(
        "slope of stiffness over pressure: {:.3} ± {:.3} of the file's",
        slope.after, slope.after_sd
    ));
    if let Some(found) = &learned.wheelbase {
        let used = if learned.wheelbase_is_learned() { "learned" } else { "the file's stays" };
        out.push(format!("wheelbase: {:.2} ± {:.2} m by the drives; {used}", found.wheelbase_m, found.sd_m));
    }
    out.push("* learned from the drives; the others are hardly better known than before".to_owned());
    out.push(String::new());
    out.push("unknown as before:".to_owned());
    out.extend(learned.unknown().into_iter().map(|text| format!("- {text}")));
    out.join("\n")
}

fn shown(value: f64, sd: f64, mark: char) -> String {
    let decimals = usize::from(value < 1_000.0);
    format!("{value:.decimals$} ± {sd:.decimals$}{mark}")
}
