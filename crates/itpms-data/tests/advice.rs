//! Every piece of advice, followed, works: the map that is written reads the log it was written of; what a remark or a refusal says to
//! put into a map is accepted; and refusals are short.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use itpms_data::LogReader;
use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::signals::{Resolved, SignalMap, resolve_knowing};

use crate::common::{Bench, listed};

const MOST: usize = 400;

/// Headers with separators and decimal points as loggers have them; a clock, a speed, then accelerations and whatever else.
const HEADERS: [&str; 12] = [
    "time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2",
    "speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2,__index_level_0__",
    "Zeit;v_Fahrzeug [km/h];Aufbau_az_VL [g];Rad_az_VL [g]",
    "t [ms],v_veh_mph,body_acc_z_fl_m_s2,wheel_acc_z_fl_g",
    "time,timestamp_ms,VehicleSpeed_kmh,FL_BodyAccZ_g,FL_WheelAccZ_g",
    // Of two speeds, two bodies.
    "Time,VehicleSpeed [km/h],VehSpd [m/s],FL_BodyAccZ [g],BodyAccZ_FL [g],FL_WheelAccZ [g]",
    // Without units, and with ones that say nothing.
    "Time,VehicleSpeed,FL_BodyAccZ,FL_WheelAccZ",
    "Time,VehicleSpeed [km/h],FL_BodyAccZ [LSB],FL_WheelAccZ [LSB]",
    "t\tVehicleSpeed [m/s]\tFL_BodyAccZ \"inner\" [g]\tFL_WheelAccZ [g]",
    "a,b,c,d",
    "time_s,RR_BodyAccZ_g,RR_WheelAccZ_g,RL_BodyAccZ_g",
    "Time,FL_Body,FL_Wheel",
];

impl Bench {
    fn log(&self, header: &str) -> PathBuf {
        let separator = [';', '\t'].into_iter().find(|separator| header.contains(*separator)).unwrap_or(',');
        let columns: Vec<&str> = header.split(separator).collect();
        let mut text = format!("{header}\n");
        for row in 0..600 {
            let cells = columns.iter().enumerate().map(|(place, name)| {
                let lower = name.to_lowercase();
                let is_clock = lower.starts_with('t') || lower.starts_with("zeit") || lower.starts_with("__");
                let step = if lower.contains("ms") { 5.0 } else { 0.005 };
                let noise = f64::from((row * 7919 + place as u32 * 104_729) % 1009) / 500.0 - 1.0;
                let value = if is_clock {
                    f64::from(row) * step
                } else {
                    noise * if lower.contains("wheel") { 2.0 } else { 0.5 }
                };
                format!("{value:.6}")
            });
            writeln!(text, "{}", cells.collect::<Vec<_>>().join(&separator.to_string())).unwrap();
        }
        self.write("drive.csv", text)
    }

    fn resolved(&self, log: &Path, map: Option<&str>) -> (Resolved, Option<String>) {
        let map = map.map(|text| SignalMap::parse(text, Path::new("map.toml")).unwrap());
        let listing = listed(log);
        (resolve_knowing(&listing.candidates(), &listing.unread, map.as_ref()).unwrap(), listing.clock)
    }

    fn read(&self, log: &Path, map: &str) -> Result<usize, String> {
        let path = self.write("map.toml", map);
        let options = LogOptions { units: UnitCheck::Trusting, dbc: None, signals: Some(path), rows: vec![] };
        LogReader::open_with(log, &options).map(Iterator::count).map_err(|error| error.to_string())
    }
}

/// `column = ...` as a remark or a refusal says it, up to the words that explain it.
fn advised(text: &str) -> Option<String> {
    let (_, advice) = text.split_once("in a map, ").or_else(|| text.split_once("in the map, "))?;
    let advice = advice.split(" (or ").next()?.split(", which make").next()?.split("; ").next()?;
    Some(advice.replace("factor = ..., offset = ...", "factor = 2.0, offset = 0.5"))
}

#[test]
fn the_map_that_is_written_reads_its_log_and_what_is_advised_is_accepted() {
    for header in HEADERS {
        let bench = Bench::new();
        let log = bench.log(header);
        let (resolved, clock) = bench.resolved(&log, None);
        let map = resolved.to_toml(clock.as_deref());
        match (resolved.unusable(), clock.is_some()) {
            (None, true) => assert_eq!(bench.read(&log, &map), Ok(600), "{header}\n{map}"),
            _ => assert!(bench.read(&log, &map).is_err_and(|text| text.chars().count() <= MOST), "{header}"),
        }
        // One doubt after the other is settled as it says, until the corner can be read.
        let mut map = map;
        for _ in 0..resolved.remarks().len() {
            let (now, _) = bench.resolved(&log, Some(&map));
            let Some(advice) = now.remarks().iter().find_map(|remark| advised(&remark.to_string())) else {
                break;
            };
            writeln!(map, "{advice}").unwrap();
            let (after, _) = bench.resolved(&log, Some(&map));
            assert_eq!(after.remarks().len() + 1, now.remarks().len(), "{header}: {advice}");
        }
        if !resolved.remarks().is_empty() {
            let (settled, _) = bench.resolved(&log, Some(&map));
            assert!(settled.unusable().is_none(), "{header}\n{map}");
            assert_eq!(bench.read(&log, &map), Ok(600), "{header}\n{map}");
        }
    }
}

#[test]
fn refusals_are_short_whatever_is_in_the_log() {
    let bench = Bench::new();
    // Forty ambiguous signals for each of eight columns.
    let corners = ["FL", "FR", "RL", "RR"];
    let names = (0..40)
        .flat_map(|i| corners.map(|corner| format!("{corner}_BodyAccZ{i} [g],{corner}_WheelAccZ{i} [g]")));
    let header = format!("Time,{}", names.collect::<Vec<_>>().join(","));
    let log = bench.log(&header);
    let refusal = bench.read(&log, "[signals]\n").unwrap_err();
    assert!(refusal.chars().count() <= MOST, "{} characters", refusal.chars().count());
    let long = "x".repeat(3000);
    for map in [format!("[signals]\n{long} = 1\n"), format!("[signals]\nspeed_m_s = \"{long}\"\n")] {
        let refusal = bench.read(&log, &map).unwrap_err();
        assert!(refusal.chars().count() <= MOST, "{} characters", refusal.chars().count());
    }
    // The nearest name in a refusal is one that works.
    let refusal = bench.read(&log, "[signals]\nfl_body_accel_m_s2 = \"FL_BodyAccZ1 [q]\"\n").unwrap_err();
    let nearest = refusal.rsplit('"').nth(1).unwrap();
    assert!(header.split(',').any(|name| name == nearest), "{refusal}");
}

/// Every file of the readers' tests: `signals` and the reader agree on whether there is something to estimate.
#[cfg(feature = "mdf4")]
#[test]
fn the_list_and_the_reader_agree_on_every_file_of_the_tests() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../itpms-mdf4/tests/data");
    for entry in fs::read_dir(folder).unwrap() {
        let log = entry.unwrap().path();
        if log.extension().is_none_or(|extension| extension != "mf4") {
            continue;
        }
        let bench = Bench::new();
        let (resolved, _) = bench.resolved(&log, None);
        let unusable = resolved.unusable().is_some();
        let read = bench.read(&log, &resolved.to_toml(None));
        assert_eq!(unusable, read.is_err(), "{}: {read:?}", log.display());
        assert!(read.is_ok() || read.is_err_and(|text| text.chars().count() <= MOST));
    }
}
