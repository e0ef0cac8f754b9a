//! `itpms roughness`: a profile or a drive in, roughness per track and segment out.
//!
//! | module | idea |
//! |---|---|
//! | `profile` | tracks from OpenCRG, text and Parquet |
//! | `drive` | tracks from a drive log, the road estimated first |

mod drive;
mod profile;

use std::fs;

use itpms_analysis::roughness::RoughnessTable;
use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::out::AtomicFile;
use serde_json::json;

use crate::args::RoughnessArgs;

/// Lines of a table on the terminal; more are for a file.
const MOST_LINES: usize = 60;
/// Rougher than anything that is driven on: 25 m/km is a track that can hardly be passed.
const ROUGHEST_M_PER_KM: f64 = 60.0;

/// What was found, with a line that says where.
struct Found {
    /// What was read, in a few words.
    about: String,
    table: RoughnessTable,
    /// What was repaired or is doubtful.
    warnings: Vec<String>,
}

pub(crate) fn run(args: &RoughnessArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let file = output(args)?;
    let mut found = match &args.vehicle {
        Some(vehicle) => drive::survey(args, vehicle, screen, interrupt)?,
        None => profile::survey(args)?,
    };
    interrupt.check()?;
    if let Some(iri) = found.table.roughest_m_per_km().filter(|iri| *iri > ROUGHEST_M_PER_KM) {
        found.warnings.push(format!("an IRI of {iri:.0} m/km is no road's: heights in another unit than m?"));
    }
    if let Some(mut file) = file {
        file.append(found.table.csv().as_bytes())?;
        file.settle()?;
        file.commit()?;
    }
    for warning in &found.warnings {
        screen.warn(format!("{}: {warning}", args.input.display()));
    }
    if args.json {
        let mut value = found.table.json();
        value["input"] = json!(args.input.display().to_string());
        value["warnings"] = json!(found.warnings);
        value["output"] = json!(args.output.as_ref().map(|path| path.display().to_string()));
        screen.print_lines(format!("{value:#}"));
        return Ok(());
    }
    screen.print(format!("{}: {}", args.input.display(), found.about));
    for line in found.table.lines(MOST_LINES) {
        screen.print(line);
    }
    Ok(())
}

/// Starts the table's file, so that one that cannot be written is known before the work begins.
fn output(args: &RoughnessArgs) -> Result<Option<AtomicFile>, Failure> {
    let Some(path) = &args.output else { return Ok(None) };
    let name = path.display();
    let device = fs::metadata(path).is_ok_and(|about| !about.is_file() && !about.is_dir());
    if !device && path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("csv")) {
        return Err(Failure::Usage(format!("{name}: the table is CSV, expected a name that ends in .csv")));
    }
    let inputs = [(Some(args.input.as_path()), "the road"), (args.vehicle.as_deref(), "the vehicle file")];
    names::check(&inputs, &[Some(path)])?;
    Ok(Some(AtomicFile::create(path)?))
}
