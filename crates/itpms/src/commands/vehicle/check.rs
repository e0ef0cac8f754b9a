//! `itpms vehicle check`: a drive and a vehicle file in; whether the suspension in the drive is the file's. The work is that of
//! `itpms-drive`.

use itpms_console::{Failure, Interrupt, Screen};
use itpms_data::out::AtomicFile;
use itpms_drive::check;

use super::opened;
use crate::args::CheckArgs;

pub(super) fn run(args: &CheckArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let (vehicle, mut log) = opened(args, args.report.as_deref())?;
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
        AtomicFile::save(path, checked.page().as_bytes())?;
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
