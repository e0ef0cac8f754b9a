//! `itpms roughness`: a profile or a drive in, roughness per track and segment out.
//!
//! | module | idea |
//! |---|---|
//! | `profile` | tracks from OpenCRG, text and Parquet |
//! | `drive` | tracks from a drive log, the road estimated first |

mod drive;
mod profile;

use std::fs;
use std::path::Path;

use itpms_analysis::roughness::{RoughnessTable, SideAnomaly, map_page};
use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::out::AtomicFile;
use itpms_drive::SurveyedRoad;
use serde_json::json;

use crate::args::RoughnessArgs;

/// Lines of a table on the terminal; more are for a file.
const MOST_LINES: usize = 60;
/// Rougher than anything that is driven on: 25 m/km is a track that can hardly be passed.
const ROUGHEST_M_PER_KM: f64 = 60.0;

/// The findings, with a line that names the place.
struct Found {
    /// The input in a few words.
    about: String,
    road: SurveyedRoad,
    warnings: Vec<String>,
}

impl Found {
    fn of_table(about: String, table: RoughnessTable, warnings: Vec<String>) -> Self {
        Self { about, road: SurveyedRoad::of_table(table), warnings }
    }

    /// A line each, no more than `most`.
    fn anomaly_lines(&self, most: usize) -> Vec<String> {
        let all = self.road.along_the_road();
        let line = |(track, SideAnomaly { anomaly, passes }): &(&str, SideAnomaly)| {
            format!(
                "{:>14.1} m  {track:<5}  {} of {:.0} mm (sd {:.0}), {:.1} m long, by {passes} {}, at {:.1} s",
                anomaly.at_m,
                anomaly.kind(),
                1e3 * anomaly.height_m.abs(),
                1e3 * anomaly.height_sd_m,
                anomaly.length_m,
                if *passes == 1 { "wheel" } else { "wheels" },
                anomaly.time_s,
            )
        };
        let mut lines: Vec<String> = all.iter().take(most).map(line).collect();
        if all.len() > most {
            lines.push(format!("... and {} holes and bumps more: see the JSON", all.len() - most));
        }
        lines
    }
}

pub(crate) fn run(args: &RoughnessArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let file = output(args)?;
    let (map, page) = (map(args, args.geojson.as_deref())?, map(args, args.map.as_deref())?);
    let mut found = match &args.vehicle {
        Some(vehicle) => drive::survey(args, vehicle, screen, interrupt)?,
        None => profile::survey(args)?,
    };
    interrupt.check()?;
    if let Some(iri) = found.road.table.roughest_m_per_km().filter(|iri| *iri > ROUGHEST_M_PER_KM) {
        found.warnings.push(format!("an IRI of {iri:.0} m/km is no road's: heights in another unit than m?"));
    }
    write(file, || found.road.table.csv())?;
    if map.is_some() || page.is_some() {
        let (road, left_out) = found.road.geojson();
        let name = args.input.file_name().unwrap_or(args.input.as_os_str()).to_string_lossy();
        write(map, || format!("{road}\n"))?;
        write(page, || map_page(&name, &found.about, &road))?;
        if left_out > 0 {
            found.warnings.push(format!(
                "{left_out} segments, holes and bumps have no position near them and are not on the map"
            ));
        }
    }
    for warning in &found.warnings {
        screen.warn(format!("{}: {warning}", args.input.display()));
    }
    if args.json {
        let mut value = found.road.table.json();
        value["input"] = json!(args.input.display().to_string());
        value["warnings"] = json!(found.warnings);
        if args.vehicle.is_some() {
            value["anomalies"] = found.road.anomalies_json();
        }
        value["output"] = json!(args.output.as_ref().map(|path| path.display().to_string()));
        screen.print_lines(format!("{value:#}"));
        return Ok(());
    }
    screen.print(format!("{}: {}", args.input.display(), found.about));
    for line in found.road.table.lines(MOST_LINES).into_iter().chain(found.anomaly_lines(MOST_LINES)) {
        screen.print(line);
    }
    Ok(())
}

fn write(file: Option<AtomicFile>, content: impl FnOnce() -> String) -> Result<(), Failure> {
    let Some(mut file) = file else { return Ok(()) };
    file.append(content().as_bytes())?;
    file.settle()?;
    Ok(file.commit()?)
}

/// Starts a map's file, as [`output`] does the table's.
fn map(args: &RoughnessArgs, path: Option<&Path>) -> Result<Option<AtomicFile>, Failure> {
    let Some(path) = path else { return Ok(None) };
    let inputs = [(Some(args.input.as_path()), "the road"), (args.vehicle.as_deref(), "the vehicle file")];
    let others = [&args.geojson, &args.map, &args.output].map(Option::as_deref);
    names::check(&inputs, &others)?;
    Ok(Some(AtomicFile::create(path)?))
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
