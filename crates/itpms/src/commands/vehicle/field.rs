//! `itpms vehicle check --field`: whether an owner's log with known pressures is good enough, and the archive to hand on. The work is that of
//! `itpms-drive`.

use itpms_console::{Failure, Interrupt, Screen};
use itpms_data::out::AtomicFile;
use itpms_drive::{FieldCheck, FieldNotes, check_field};

use super::opened;
use crate::args::CheckArgs;

pub(super) fn run(args: &CheckArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let (vehicle, mut log) = opened(args, args.output.as_deref())?;
    let notes = FieldNotes {
        pressures: args.pressure_kpa.clone(),
        note: args.note.clone(),
        program: concat!("itpms ", env!("CARGO_PKG_VERSION")).to_owned(),
    };
    let progress = screen.progress("reading");
    let checked = check_field(&vehicle, &mut log, &notes, args.output.is_some(), &mut |share| {
        progress.set(share);
        interrupt.flow()
    })?;
    drop(progress);
    if args.json {
        screen.print_lines(format!("{:#}", checked.document()));
    } else {
        show(&checked, screen);
    }
    if !checked.is_good() {
        let (log, count) = (args.log.display(), checked.faults().len());
        let pack = if args.output.is_some() { "; nothing was packed" } else { "" };
        return Err(Failure::Missed(format!(
            "{log}: not good enough for the field kit, {count} thing{} to mend (docs/field-kit.md){pack}",
            if count == 1 { "" } else { "s" }
        )));
    }
    if let (Some(path), Some(archive)) = (&args.output, &checked.archive) {
        AtomicFile::save(path, archive)?;
        let without = match checked.left_out() {
            [] => String::new(),
            left_out => format!("; left out: {}", left_out.join(", ")),
        };
        screen.remark(format!(
            "{}: {:.1} MB to hand on{without}",
            path.display(),
            archive.len() as f64 / 1e6
        ));
    } else {
        screen.remark("good enough; -o PACK.zip packs it");
    }
    Ok(())
}

fn show(checked: &FieldCheck, screen: &Screen) {
    checked.facts().iter().for_each(|fact| screen.print_wrapped(fact));
    checked.notes().iter().for_each(|note| screen.print_wrapped(format!("could be better: {note}")));
    checked.faults().iter().for_each(|fault| screen.print_wrapped(format!("to mend: {fault}")));
}
