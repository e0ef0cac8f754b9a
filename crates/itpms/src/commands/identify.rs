//! `itpms lab identify spring|damper|bump` and `itpms lab calibrate`: measurements of a bench or a drop in, the numbers of a vehicle file with
//! their standard errors out.

mod bump;

use std::path::Path;

use itpms_analysis::identify::{IdentifyError, SineRecord, Units, calibrate, damper, spring};
use itpms_analysis::plot::Figure;
use itpms_console::{Failure, Screen, former, names};
use itpms_data::DataError;
use itpms_data::columns::Columns;
use itpms_data::out::AtomicFile;
use itpms_data::vehicle::tire_table;

use crate::args::{BenchOutput, CalibrateArgs, DamperArgs, IdentifyPart, SpringArgs};

const MEASUREMENT: &str = "the measurement";

pub(crate) fn run(part: &IdentifyPart, screen: &Screen) -> Result<(), Failure> {
    match part {
        IdentifyPart::Spring(args) => run_spring(args, screen),
        IdentifyPart::Damper(args) => run_damper(args, screen),
        IdentifyPart::Bump(args) => bump::run(args, screen),
    }
}

fn units(output: &BenchOutput) -> Units {
    if output.trust_units { Units::Trusted } else { Units::Checked }
}

fn refusal(path: &Path, error: &IdentifyError) -> Failure {
    Failure::Usage(format!("{}: {error}", path.display()))
}

fn run_spring(args: &SpringArgs, screen: &Screen) -> Result<(), Failure> {
    names::check(&[(Some(&args.table), MEASUREMENT)], &[args.output.plot.as_deref()])?;
    let table = Columns::read(&args.table, &["displacement_m", "load_n"], &[])?;
    let result = spring(table.column("displacement_m"), table.column("load_n"), units(&args.output))
        .map_err(|error| refusal(&args.table, &error))?;
    let json = serde_json::to_string_pretty(&result);
    finish(&args.output, json, &result.table(), &result.figure(), Vec::new(), screen)
}

const SINE: [&str; 3] = ["time_s", "displacement_m", "force_n"];

fn run_damper(args: &DamperArgs, screen: &Screen) -> Result<(), Failure> {
    let inputs: Vec<_> = args.tables.iter().map(|table| (Some(table.as_path()), MEASUREMENT)).collect();
    names::check(&inputs, &[args.output.plot.as_deref()])?;
    let tables: Vec<Columns> = args
        .tables
        .iter()
        .map(|path| Columns::read(path, &SINE, &["run"]))
        .collect::<Result<_, DataError>>()?;
    let names: Vec<Vec<(String, std::ops::Range<usize>)>> =
        args.tables.iter().zip(&tables).map(|(path, table)| stretches(path, table)).collect();
    let records: Vec<SineRecord<'_>> = tables
        .iter()
        .zip(&names)
        .flat_map(|(table, stretches)| {
            stretches.iter().map(|(name, rows)| SineRecord {
                name,
                time_s: &table.column(SINE[0])[rows.clone()],
                displacement_m: &table.column(SINE[1])[rows.clone()],
                force_n: &table.column(SINE[2])[rows.clone()],
            })
        })
        .collect();
    let result =
        damper(&records, args.spring, units(&args.output)).map_err(|error| match args.tables.as_slice() {
            [only] => refusal(only, &error),
            several => Failure::Usage(format!(
                "{}: {error}",
                several.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
            )),
        })?;
    let json = serde_json::to_string_pretty(&result);
    finish(&args.output, json, &result.table(), &result.figure(), Vec::new(), screen)
}

/// The records of a file: one, or one for each stretch of equal `run`.
fn stretches(path: &Path, table: &Columns) -> Vec<(String, std::ops::Range<usize>)> {
    let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let rows = table.lines().len();
    let Some(run) = table.get("run") else { return vec![(file.into_owned(), 0..rows)] };
    let mut out = Vec::new();
    let mut start = 0;
    for end in 1..=rows {
        if end == rows || run[end] != run[start] {
            out.push((format!("{file} run {}", run[start]), start..end));
            start = end;
        }
    }
    out
}

pub(crate) fn run_calibrate(args: &CalibrateArgs, screen: &Screen) -> Result<(), Failure> {
    names::check(&[(Some(&args.table), MEASUREMENT)], &[args.tire.as_deref(), args.output.plot.as_deref()])?;
    let table = Columns::read(&args.table, &["pressure_kpa", "stiffness_n_per_m"], &[])?;
    let result =
        calibrate(table.column("pressure_kpa"), table.column("stiffness_n_per_m"), units(&args.output))
            .map_err(|error| refusal(&args.table, &error))?;
    let tire = tire_table(&result.map);
    let files = args.tire.iter().map(|path| written(path, &tire)).collect::<Result<_, DataError>>()?;
    if let Some(path) = &args.tire {
        former::keep(path, &tire, screen)?;
    }
    let mut text = result.table();
    if args.tire.is_none() {
        text.push_str("\nfor the vehicle file:\n\n");
        text.push_str(&tire);
    }
    finish(&args.output, serde_json::to_string_pretty(&result), &text, &result.figure(), files, screen)
}

/// A file that is complete but for its name.
fn written(path: &Path, content: &str) -> Result<AtomicFile, DataError> {
    Ok(AtomicFile::settled(path, content.as_bytes())?)
}

/// All files, then the result: nothing is reported of a result that could not be written.
fn finish(
    output: &BenchOutput,
    json: serde_json::Result<String>,
    text: &str,
    figure: &Figure,
    mut files: Vec<AtomicFile>,
    screen: &Screen,
) -> Result<(), Failure> {
    let json = json.map_err(|error| Failure::Usage(format!("the result is no JSON: {error}")))?;
    if let Some(path) = &output.plot {
        files.push(written(path, &figure.svg())?);
    }
    for file in files {
        file.commit()?;
    }
    screen.print_lines(if output.json { &json } else { text.trim_end() });
    Ok(())
}
