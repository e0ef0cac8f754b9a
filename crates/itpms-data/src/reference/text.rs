//! A stored reference as text and back. The first line is read before anything else is believed.

use std::fmt::Write as _;

use itpms_core::model::{Corner, CornerCalibration, Learned, VehicleCalibration};
use itpms_core::wheel_speed::RadiusDays;
use itpms_files::{Date, Unsealed, seal, unsealed};
use toml::de::DeTable;

use super::{
    FORMAT, ReferenceProblem, StoredReference, VehicleIdentity, WITH_DAYS, WITH_WHEEL_SPEEDS, days,
    nothing_of_corners, suspension, torsion, wheel_speeds,
};
use crate::error::Problem;
use crate::toml_table::{Table, escaped, syntax_problem};

/// How every format of the file begins.
const MAGIC: &str = "itpms-reference ";
const SIDES: [&str; 2] = ["left", "right"];
const CORNER_QUANTITIES: [&str; 5] =
    ["unsprung_mass", "damping", "spring", "spectrum_bias_kpa", "shared_road_bias"];
/// The format before `shared_road_bias`.
const WITHOUT_ROAD_BIAS: u32 = 1;
const SIDE_QUANTITIES: [&str; 2] = ["gain", "skew_s"];

/// The file with its first line.
pub(super) fn sealed(stored: &StoredReference) -> String {
    let body = body(stored);
    let format = match stored.days.is_empty() {
        _ if stored.has_corners() => FORMAT,
        false => WITH_DAYS,
        true => WITH_WHEEL_SPEEDS,
    };
    seal(MAGIC, &format.to_string(), body.as_bytes()) + &body
}

/// The reference in a file that is whole and of a known format.
pub(super) fn opened(bytes: &[u8]) -> Result<StoredReference, Problem> {
    let (format, body) = unsealed(MAGIC, bytes).map_err(|error| match error {
        Unsealed::Foreign(found) => ReferenceProblem::Foreign { found },
        Unsealed::Damaged { found, expected } => ReferenceProblem::Damaged { found, expected },
    })?;
    let format = match format.parse() {
        Ok(known @ WITHOUT_ROAD_BIAS..=FORMAT) => known,
        Ok(other) => return Err(ReferenceProblem::Newer { found: other, newest: FORMAT }.into()),
        Err(_) => return Err(ReferenceProblem::Lacks("a number of its format").into()),
    };
    let body = str::from_utf8(body).map_err(|_| ReferenceProblem::Lacks("readable text"))?;
    read_body(body, format)
}

fn body(stored: &StoredReference) -> String {
    let vehicle = &stored.vehicle;
    let mut out = format!("[vehicle]\nname = \"{}\"\n", escaped(&vehicle.name));
    if let Some(id) = &vehicle.id {
        let _ = writeln!(out, "id = \"{}\"", escaped(id));
    }
    let _ = writeln!(out, "parameters = \"{}\"", vehicle.parameters);
    // The seconds as text: TOML's numbers are read as f64 here.
    let _ = writeln!(
        out,
        "\n[learned]\nunix_s = \"{}\"  # {}",
        stored.learned_unix_s,
        day(stored.learned_unix_s)
    );
    if stored.has_corners() {
        corners(&mut out, stored);
    }
    if let Some(learned) = &stored.wheel_speeds {
        wheel_speeds::write(&mut out, learned);
    }
    if !stored.days.is_empty() {
        days::write(&mut out, &stored.days);
    }
    if let Some(learned) = &stored.suspension {
        suspension::write(&mut out, learned);
    }
    torsion::write(&mut out, &stored.torsion);
    out
}

fn corners(out: &mut String, stored: &StoredReference) {
    let reference = &stored.reference;
    let _ = writeln!(out, "driving_s = {:?}", reference.learned_s);
    if let Some(wheelbase_m) = stored.wheelbase_m {
        let _ = writeln!(out, "wheelbase_m = {wheelbase_m:?}");
    }
    write_learned(out, "wheelbase", &reference.wheelbase);
    write_learned(out, "front_bar", &reference.bar[0]);
    write_learned(out, "rear_bar", &reference.bar[1]);
    write_learned(out, "rear_axle_coupling", &reference.rear_axle_coupling);
    for (i, side) in SIDES.into_iter().enumerate() {
        let _ = writeln!(out, "\n[learned.{side}]");
        write_learned(out, "gain", &reference.gain[i]);
        write_learned(out, "skew_s", &reference.skew_s[i]);
    }
    for corner in Corner::ALL {
        let Some(learned) = &reference.corners[corner.index()] else { continue };
        let _ = writeln!(out, "\n[corner.{}]\nplacard_kpa = {:?}", corner.label(), learned.placard_kpa);
        let values = [
            learned.unsprung_mass,
            learned.damping,
            learned.spring,
            learned.spectrum_bias_kpa,
            learned.shared_road_bias,
        ];
        for (name, value) in CORNER_QUANTITIES.into_iter().zip(&values) {
            write_learned(out, name, value);
        }
    }
}

fn write_learned(out: &mut String, name: &str, learned: &Learned<f64>) {
    // `{:?}` is the shortest form that reads back as the same number.
    let _ = writeln!(out, "{name} = {:?}\n{name}_sd = {:?}", learned.value, learned.sd);
}

fn read_body(text: &str, format: u32) -> Result<StoredReference, Problem> {
    let document = DeTable::parse(text).map_err(|error| syntax_problem(text, &error))?;
    let root = Table::root(text, document.get_ref());
    root.check_keys(&["vehicle", "learned", "corner", "wheel_speeds", "torsion", "days", "suspension"])?;
    let vehicle = needed_table(&root, "vehicle")?;
    vehicle.check_keys(&["name", "id", "parameters"])?;
    let vehicle = VehicleIdentity {
        name: needed_text(&vehicle, "name")?,
        id: vehicle.text("id")?,
        parameters: needed_text(&vehicle, "parameters")?,
    };
    let learned = needed_table(&root, "learned")?;
    let unix_s = needed_text(&learned, "unix_s")?;
    let learned_unix_s = unix_s.parse().map_err(|_| ReferenceProblem::Lacks("a time in whole seconds"))?;
    let wheel_speeds = root.table("wheel_speeds")?.map(|table| wheel_speeds::read(&table)).transpose()?;
    let torsion = match root.table("torsion")? {
        Some(_) if wheel_speeds.is_none() => return Err(ReferenceProblem::Lacks("wheel speeds").into()),
        Some(table) => torsion::read(&table)?,
        None => [None; 4],
    };
    let days = match root.table("days")? {
        Some(_) if wheel_speeds.is_none() => return Err(ReferenceProblem::Lacks("wheel speeds").into()),
        Some(table) => days::read(&table, learned_unix_s)?,
        None => RadiusDays::since(learned_unix_s as f64),
    };
    let stored = StoredReference {
        vehicle,
        learned_unix_s,
        wheelbase_m: None,
        reference: nothing_of_corners(),
        wheel_speeds,
        torsion,
        days,
        suspension: None,
    };
    if stored.wheel_speeds.is_some() && !root.has("corner") {
        return Ok(stored);
    }
    let [[left_gain, left_skew], [right_gain, right_skew]] =
        [read_side(&learned, SIDES[0])?, read_side(&learned, SIDES[1])?];
    let reference = VehicleCalibration {
        corners: read_corners(&needed_table(&root, "corner")?, format)?,
        bar: [
            read_learned(&learned, "front_bar", "front_bar_sd")?,
            read_learned(&learned, "rear_bar", "rear_bar_sd")?,
        ],
        rear_axle_coupling: if format < FORMAT {
            VehicleCalibration::unknown_coupling()
        } else {
            read_learned(&learned, "rear_axle_coupling", "rear_axle_coupling_sd")?
        },
        gain: [left_gain, right_gain],
        wheelbase: read_learned(&learned, "wheelbase", "wheelbase_sd")?,
        skew_s: [left_skew, right_skew],
        learned_s: learned.needed_number("driving_s")?,
    };
    let wheelbase_m = learned.number("wheelbase_m")?;
    if wheelbase_m.is_some_and(|m| !super::is_a_cars(m)) {
        return Err(ReferenceProblem::Lacks("a wheelbase that a car has").into());
    }
    let suspension = root.table("suspension")?.map(|table| suspension::read(&table)).transpose()?;
    Ok(StoredReference { wheelbase_m, reference, suspension, ..stored })
}

fn read_corners(corners: &Table<'_>, format: u32) -> Result<[Option<CornerCalibration<f64>>; 4], Problem> {
    corners.check_keys(&Corner::ALL.map(Corner::label))?;
    let mut read = [None; 4];
    for corner in Corner::ALL {
        let Some(table) = corners.table(corner.label())? else { continue };
        let [mass, damping, spring, bias, road_bias] = CORNER_QUANTITIES;
        read[corner.index()] = Some(CornerCalibration {
            placard_kpa: table.needed_number("placard_kpa")?,
            unsprung_mass: read_learned(&table, mass, "unsprung_mass_sd")?,
            damping: read_learned(&table, damping, "damping_sd")?,
            spring: read_learned(&table, spring, "spring_sd")?,
            spectrum_bias_kpa: read_learned(&table, bias, "spectrum_bias_kpa_sd")?,
            shared_road_bias: if format == WITHOUT_ROAD_BIAS {
                CornerCalibration::uncalibrated_residual_bias()
            } else {
                read_learned(&table, road_bias, "shared_road_bias_sd")?
            },
        });
    }
    Ok(read)
}

fn read_side(learned: &Table<'_>, side: &'static str) -> Result<[Learned<f64>; 2], Problem> {
    let table = needed_table(learned, side)?;
    let [gain, skew] = SIDE_QUANTITIES;
    Ok([read_learned(&table, gain, "gain_sd")?, read_learned(&table, skew, "skew_s_sd")?])
}

fn read_learned(table: &Table<'_>, name: &'static str, sd: &'static str) -> Result<Learned<f64>, Problem> {
    Ok(Learned { value: table.needed_number(name)?, sd: table.needed_number(sd)? })
}

fn needed_table<'a>(parent: &Table<'a>, key: &'static str) -> Result<Table<'a>, Problem> {
    parent.table(key)?.ok_or_else(|| parent.lacks(key))
}

fn needed_text(table: &Table<'_>, key: &'static str) -> Result<String, Problem> {
    table.text(key)?.ok_or_else(|| table.lacks(key))
}

/// The day of a time in s since 1970, `2026-03-01`, in the Gregorian calendar and UTC.
pub fn day(unix_s: u64) -> String {
    let Date { year, month, day, .. } = Date::of_seconds(i64::try_from(unix_s).unwrap_or(i64::MAX));
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::day;

    #[test]
    fn days_that_everybody_knows() {
        assert_eq!(day(0), "1970-01-01");
        // The second before and at the turn of the millennium, its leap day, and the end of 32-bit time.
        assert_eq!(day(946_684_799), "1999-12-31");
        assert_eq!(day(946_684_800), "2000-01-01");
        assert_eq!(day(951_782_400), "2000-02-29");
        assert_eq!(day(951_868_800), "2000-03-01");
        assert_eq!(day(2_147_483_647), "2038-01-19");
    }
}
