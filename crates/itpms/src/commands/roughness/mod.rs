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

use itpms_analysis::roughness::{RoughnessTable, SideAnomaly, Way, geojson, map_page};
use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::out::AtomicFile;
use serde_json::{Value, json};

use crate::args::RoughnessArgs;

/// Lines of a table on the terminal; more are for a file.
const MOST_LINES: usize = 60;
/// Rougher than anything that is driven on: 25 m/km is a track that can hardly be passed.
const ROUGHEST_M_PER_KM: f64 = 60.0;

/// The findings, with a line that names the place.
struct Found {
    /// The input in a few words.
    about: String,
    table: RoughnessTable,
    /// Holes and bumps of the left and the right track, of a drive.
    anomalies: [Vec<SideAnomaly>; 2],
    /// Where the car was, of a drive.
    way: Way,
    warnings: Vec<String>,
}

/// How the tracks of [`Found::anomalies`] are called.
const SIDES: [&str; 2] = ["left", "right"];

impl Found {
    fn of_table(about: String, table: RoughnessTable, warnings: Vec<String>) -> Self {
        Self { about, table, anomalies: Default::default(), way: Way::default(), warnings }
    }

    /// Holes and bumps with their tracks, in the order of the road.
    fn along_the_road(&self) -> Vec<(&'static str, SideAnomaly)> {
        let sides = SIDES.into_iter().zip(&self.anomalies);
        let mut all: Vec<_> =
            sides.flat_map(|(track, found)| found.iter().map(move |one| (track, *one))).collect();
        all.sort_by(|(_, a), (_, b)| a.anomaly.at_m.total_cmp(&b.anomaly.at_m));
        all
    }

    /// A line each, no more than `most`.
    fn anomaly_lines(&self, most: usize) -> Vec<String> {
        let all = self.along_the_road();
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

    fn anomalies_json(&self) -> Value {
        let one = |(track, SideAnomaly { anomaly, passes }): (&str, SideAnomaly)| {
            json!({
                "kind": anomaly.kind(),
                "track": track,
                "distance_m": anomaly.at_m,
                "time_s": anomaly.time_s,
                "height_m": anomaly.height_m,
                "height_sd_m": anomaly.height_sd_m,
                "length_m": anomaly.length_m,
                "passes": passes,
            })
        };
        self.along_the_road().into_iter().map(one).collect()
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
    if let Some(iri) = found.table.roughest_m_per_km().filter(|iri| *iri > ROUGHEST_M_PER_KM) {
        found.warnings.push(format!("an IRI of {iri:.0} m/km is no road's: heights in another unit than m?"));
    }
    write(file, || found.table.csv())?;
    if map.is_some() || page.is_some() {
        let [left, right] = [0, 1].map(|side| (SIDES[side], found.anomalies[side].as_slice()));
        let (road, left_out) = geojson(&found.table, &[left, right], &found.way);
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
        let mut value = found.table.json();
        value["input"] = json!(args.input.display().to_string());
        value["warnings"] = json!(found.warnings);
        if args.vehicle.is_some() {
            value["anomalies"] = found.anomalies_json();
        }
        value["output"] = json!(args.output.as_ref().map(|path| path.display().to_string()));
        screen.print_lines(format!("{value:#}"));
        return Ok(());
    }
    screen.print(format!("{}: {}", args.input.display(), found.about));
    for line in found.table.lines(MOST_LINES).into_iter().chain(found.anomaly_lines(MOST_LINES)) {
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
