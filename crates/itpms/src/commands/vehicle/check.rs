//! `itpms vehicle check`: a drive and a vehicle file in; whether the suspension in the drive is the file's. The work is that of
//! `itpms-drive`.

use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::out::AtomicFile;
use itpms_data::{LogReader, Vehicle};
use itpms_drive::check;

use crate::args::CheckArgs;

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
    let progress = screen.progress("reading");
    let checked = check(&vehicle, &mut log, &mut |share| {
        progress.set(share);
        interrupt.flow()
    })?;
    drop(progress);
    for concern in &checked.concerns {
        screen.warn(format!("{}: {concern}", args.log.display()));
    }
    if let Some(path) = &args.report {
        let mut file = AtomicFile::create(path)?;
        file.append(checked.page().as_bytes())?;
        file.commit()?;
    }
    if args.json {
        let text = serde_json::to_string_pretty(&checked.document())
            .map_err(|error| Failure::Usage(format!("the result is no JSON: {error}")))?;
        screen.print_lines(text);
    } else {
        for corner in &checked.corners {
            screen.print(format!("{}: {}", corner.label, corner.sentence()));
            if let Some(misfit) = corner.misfit() {
                screen.print(format!("{}: {misfit}", corner.label));
            }
        }
        checked.damper_lines().into_iter().for_each(|line| screen.print(line));
    }
    Ok(())
}
