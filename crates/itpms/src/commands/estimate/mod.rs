//! `itpms estimate`: a drive log and a vehicle in, pressures, road and report out.
//!
//! The work is that of `itpms-drive`; here are its arguments, and in `summary` what is reported at the end.

mod summary;

use itpms_console::{Failure, Interrupt, Screen, names, threads};
use itpms_core::model::Corner;
use itpms_data::{LogReader, Vehicle};
use itpms_drive::tire_sensors::sent_pressures;
use itpms_drive::{Done, EstimatorKind, FilePaths, Files, Job, Settings, common_corners, wheel_speed_use};

use super::reference;
use crate::args::EstimateArgs;
pub(crate) use summary::corner_lines;

pub(crate) fn run(args: &EstimateArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let estimated = perform(args, screen, interrupt)?;
    summary::print(args, screen, &estimated);
    Ok(())
}

/// A drive that was estimated, its files in place.
pub(crate) struct Estimated {
    pub(crate) log: LogReader,
    pub(crate) done: Done,
}

/// Everything but the summary.
pub(crate) fn perform(
    args: &EstimateArgs,
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<Estimated, Failure> {
    check_names(args)?;
    let vehicle = Vehicle::read(&args.vehicle)?;
    // Before the drive is opened: here both files have names.
    if let Some(path) = args.reference.as_ref().filter(|_| args.estimator == EstimatorKind::Informed) {
        reference::of(path, &vehicle, &args.vehicle)?;
    }
    let reading = args.reading.options();
    let mut log = LogReader::open_with(&args.log, &reading)?;
    let (corners, mut settings, paths) = (common_corners(&log, &vehicle)?, settings(args)?, paths(args));
    if corners.is_empty() {
        ask_sensors(args, &log, &vehicle, &mut settings, screen, interrupt)?;
    }
    let (road, report) = (paths.heights(), paths.report.is_some());
    let job =
        Job { vehicle: &vehicle, corners: &corners, settings: &settings, reading: &reading, road, report };
    let wheel_speeds = wheel_speed_use(log.columns(), &vehicle, &corners).unwrap_or_default();
    let mut files = Files::create(&paths, &settings, &vehicle, &log, &corners, wheel_speeds)?;
    let progress = screen.progress("estimating");
    let mut watch = |share| {
        progress.set(share);
        interrupt.flow()
    };
    let done = if threads::at_a_time(args.jobs) > 1 {
        itpms_drive::estimate_in_pipeline(&mut log, &job, &mut files, &mut watch)?
    } else {
        itpms_drive::estimate(&mut log, &job, &mut files, &mut watch)?
    };
    drop(progress);
    let completed = files.complete(&done);
    remarks(screen, &log, &done.concerns);
    completed?;
    if let Some(path) = &args.save_reference {
        let holds = match &args.reference {
            Some(_) => "the reference with what this day has shown of the wheel speeds",
            None => {
                "what the calibration taught of this car; valid until tires, springs, dampers or sensors are changed"
            }
        };
        screen.remark(format!("{}: holds {holds}", path.display()));
    }
    Ok(Estimated { log, done })
}

fn settings(args: &EstimateArgs) -> Result<Settings, Failure> {
    let tuning = args.tuning.as_deref().map(itpms_data::tuning::read).transpose()?;
    Ok(Settings {
        estimator: args.estimator,
        regulation: args.regulation,
        tuning: tuning.unwrap_or_default(),
        road_repeats: args.road_repeats,
        calibrate_s: args.calibrate_s,
        reference: args.reference.clone(),
        pulses: args.pulses.clone(),
        calibration_kpa: args.pressure_kpa.map_or([None; 4], |pressures| pressures.0),
        rate_hz: args.rate,
        pressure_unit: args.unit.pressure_unit,
        program: concat!("itpms ", env!("ITPMS_VERSION")).to_owned(),
        command: command(),
    })
}

/// The command as it was given, as a shell takes it.
fn command() -> String {
    let quoted = |word: String| {
        let is_plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
        if !word.is_empty() && word.chars().all(is_plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("itpms".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// In a calibration of wheel speeds the tires' own sensors tell the pressures that are not given.
fn ask_sensors(
    args: &EstimateArgs,
    log: &LogReader,
    vehicle: &Vehicle,
    settings: &mut Settings,
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let sensors = log.columns().motion.tire_sensors.contains(&true);
    let Some(seconds) = settings.calibrate_s.filter(|_| sensors) else { return Ok(()) };
    // Read beforehand: the calibration begins with the first row.
    let mut ahead = LogReader::open_with(&args.log, &args.reading.options())?;
    let given_kpa = settings.calibration_kpa.map(|kpa| kpa.unwrap_or(f64::NAN));
    let sent = sent_pressures(&mut ahead, vehicle, given_kpa, seconds, &mut |_| interrupt.flow())?;
    for remark in sent.remarks {
        screen.warn(remark);
    }
    if args.pressure_kpa.is_some() {
        return Ok(());
    }
    settings.calibration_kpa = sent.kpa;
    let each = |sends: bool| {
        let of = Corner::ALL.iter().zip(sent.kpa).filter(move |(_, kpa)| kpa.is_some() == sends);
        of.map(|(corner, kpa)| {
            corner.label().to_owned() + &kpa.map_or(String::new(), |kpa| format!(" {kpa}"))
        })
        .collect::<Vec<_>>()
        .join(", ")
    };
    let (sending, silent, path) = (each(true), each(false), args.log.display());
    if !sending.is_empty() {
        screen.remark(format!("{path}: calibrated at what the tires' own sensors send: {sending} kPa"));
    }
    if !silent.is_empty() {
        screen.warn(format!(
            "{path}: no tire sensor sends a plausible pressure of {silent}: calibrated at the placard's"
        ));
    }
    Ok(())
}

fn paths(args: &EstimateArgs) -> FilePaths {
    FilePaths {
        estimates: args.output.clone(),
        road: args.road_out.clone(),
        report: args.report.clone(),
        events: args.events.clone(),
        #[cfg(feature = "mcap")]
        mcap: args.mcap.clone(),
        reference: args.save_reference.clone(),
    }
}

/// Refuses an output that is one of the inputs, or two outputs of one name.
fn check_names(args: &EstimateArgs) -> Result<(), Failure> {
    let [dbc, signals] = args.reading.inputs();
    let inputs = [
        (Some(args.log.as_path()), "the drive log"),
        (Some(&args.vehicle), "the vehicle file"),
        (
            args.reference.as_deref().filter(|path| args.save_reference.as_deref() != Some(path)),
            "the learned reference",
        ),
        (args.pulses.as_deref(), "the tooth pulses"),
        dbc,
        signals,
    ];
    let outputs = [
        &args.output,
        &args.road_out,
        &args.report,
        &args.save_reference,
        &args.events,
        #[cfg(feature = "mcap")]
        &args.mcap,
    ];
    names::check(&inputs, &outputs.map(|path| path.as_deref()))
}

/// Repairs, and reservations about the result.
fn remarks(screen: &Screen, log: &LogReader, concerns: &[String]) {
    let path = log.path().display();
    for remark in log.mapping().iter().chain(&log.remarks()) {
        screen.remark(format!("{path}: {remark}"));
    }
    for concern in concerns {
        screen.warn(format!("{path}: {concern}"));
    }
    if !log.columns().speed && !log.columns().motion.wheel_speeds() {
        screen.remark(format!("{path}: no speed_m_s, so no distance and no roughness"));
    }
}
