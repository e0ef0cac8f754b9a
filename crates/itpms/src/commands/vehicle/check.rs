//! `itpms vehicle check`: a drive and a vehicle file in; whether the suspension in the drive is the file's.

use itpms_core::model::Corner;
use itpms_data::out::AtomicFile;
use itpms_data::{LogReader, Vehicle};
use itpms_study::transfer::{CornerCheck, CrossSpectra, Suspension, Verdict, page};
use serde_json::{Map, Value, json};

use crate::args::CheckArgs;
use crate::commands::{ROWS_PER_LOOK, names};
use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::screen::Screen;

/// Steps of time that are a gap.
const GAP_STEPS: f64 = 1.5;

pub(super) fn run(args: &CheckArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let [dbc, signals] = args.reading.inputs();
    let inputs = [
        (Some(args.log.as_path()), "the log"),
        (Some(args.vehicle.as_path()), "the vehicle file"),
        dbc,
        signals,
    ];
    names::check(&inputs, &[args.report.as_deref()])?;
    let vehicle = Vehicle::read(&args.vehicle)?;
    let mut log = LogReader::open_with(&args.log, &args.reading.options())?;
    let corners: Vec<Corner> =
        log.columns().present().into_iter().filter(|corner| vehicle.corner(*corner).is_some()).collect();
    if corners.is_empty() {
        let log = args.log.display();
        return Err(Failure::Usage(format!(
            "{log}: has no corner that {} describes",
            args.vehicle.display()
        )));
    }
    let spectra = spectra(&mut log, &corners, screen, interrupt)?;
    for warning in log.repairs().warnings() {
        screen.warn(format!("{}: {warning}", args.log.display()));
    }
    let checks: Vec<CornerCheck> = corners
        .iter()
        .zip(&spectra)
        .filter_map(|(corner, spectra)| {
            Some(CornerCheck::of(corner.label(), spectra, suspension(&vehicle, *corner)?))
        })
        .collect();
    if let Some(path) = &args.report {
        let name = args.log.file_name().unwrap_or(args.log.as_os_str()).to_string_lossy();
        let mut file = AtomicFile::create(path)?;
        file.append(page(&vehicle.name, &name, &checks).as_bytes())?;
        file.commit()?;
    }
    if args.json {
        let text = serde_json::to_string_pretty(&document(&checks))
            .map_err(|error| Failure::Usage(format!("the result is no JSON: {error}")))?;
        screen.print_lines(text);
    } else {
        for check in &checks {
            screen.print(format!("{}: {}", check.label, check.sentence()));
        }
    }
    Ok(())
}

/// The spectra of all rows, corner by corner.
fn spectra(
    log: &mut LogReader,
    corners: &[Corner],
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<Vec<CrossSpectra>, Failure> {
    let step_s = log.survey().sample_period_s;
    let mut spectra: Vec<CrossSpectra> = corners.iter().map(|_| CrossSpectra::new(step_s)).collect();
    let progress = screen.progress("reading");
    let (mut rows, mut before_s) = (0u64, f64::NAN);
    while let Some(row) = log.next_row()? {
        let lost = row.time_s - before_s > GAP_STEPS * step_s;
        before_s = row.time_s;
        for (corner, spectra) in corners.iter().zip(&mut spectra) {
            if lost {
                spectra.gap();
            }
            match &row.corners[corner.index()] {
                Some(signals) => spectra.push(signals.wheel_accel_m_s2, signals.body_accel_m_s2),
                None => spectra.gap(),
            }
        }
        rows += 1;
        if rows.is_multiple_of(ROWS_PER_LOOK) {
            interrupt.check()?;
            progress.set(log.progress());
        }
    }
    Ok(spectra)
}

fn suspension(vehicle: &Vehicle, corner: Corner) -> Option<Suspension> {
    let (car, sd) = (vehicle.corner(corner)?.quarter_car, vehicle.uncertainty(corner));
    Some(Suspension {
        sprung_mass_kg: car.sprung_mass_kg(),
        damping_n_s_per_m: car.damping_n_s_per_m(),
        spring_n_per_m: car.spring_n_per_m(),
        sprung_mass_relative_sd: sd.sprung_mass_relative_sd,
        damping_relative_sd: sd.damping_relative_sd,
        spring_relative_sd: sd.spring_relative_sd,
    })
}

fn document(checks: &[CornerCheck]) -> Value {
    let corner = |check: &CornerCheck| {
        let (damping, spring) = match &check.verdict {
            Verdict::Compared { damping, spring } => (Some(*damping), Some(*spring)),
            Verdict::TooShort | Verdict::Incoherent(_) => (None, None),
        };
        let value = json!({
            "coherence": check.coherence,
            "damping_over_file": damping.map(|(ratio, _)| ratio),
            "damping_over_file_se": damping.map(|(_, error)| error),
            "spring_over_file": spring.map(|(ratio, _)| ratio),
            "spring_over_file_se": spring.map(|(_, error)| error),
            "asks_for_change": check.asks_for_change(),
            "sentence": check.sentence(),
        });
        (check.label.clone(), value)
    };
    json!({ "corners": checks.iter().map(corner).collect::<Map<String, Value>>() })
}
