//! `itpms convert`: a log from one format into another.

use std::ops::ControlFlow;

use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::convert::{Request, convert};
use itpms_data::out::Packing;

use crate::args::ConvertArgs;

pub(crate) fn run(args: &ConvertArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let (input, output) = (args.input.display(), args.output.display());
    let [dbc, signals] = args.reading.inputs();
    names::check(&[(Some(&args.input), "the log"), dbc, signals], &[Some(&args.output)])?;
    let options = args.reading.options();
    let packing = if args.plain { Packing::Plain } else { Packing::Packed };
    let request = Request {
        input: &args.input,
        output: &args.output,
        options: &options,
        packing,
        position: args.positions,
    };
    let progress = screen.progress("converting");
    let mut look = |share: f64| -> ControlFlow<()> {
        progress.set(share);
        interrupt.flow()
    };
    let converted = convert(&request, &mut look)?.ok_or(Failure::Interrupted)?;
    interrupt.check()?;
    converted.file.commit()?;
    drop(progress);
    for remark in &converted.remarks {
        screen.remark(format!("{input}: {remark}"));
    }
    for warning in &converted.warnings {
        screen.warn(format!("{input}: {warning}"));
    }
    screen.remark(format!("{output}: {}", converted.content));
    Ok(())
}
