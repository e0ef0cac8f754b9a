//! `itpms lab identify bump`: a record of a drop in, the parts of each corner out.

use itpms_analysis::identify::{BumpCorner, BumpMasses, BumpSignals, BumpWindow, bump};
use itpms_console::{Failure, Screen, names};
use itpms_core::model::Corner;
use itpms_data::columns::Columns;

use super::{MEASUREMENT, refusal, written};
use crate::args::BumpArgs;

/// Columns of a corner: what follows its label, body then wheel.
const HEIGHTS: [&str; 2] = ["_body_m", "_wheel_m"];
const ACCELERATIONS: [&str; 2] = ["_body_accel_m_s2", "_wheel_accel_m_s2"];

pub(super) fn run(args: &BumpArgs, screen: &Screen) -> Result<(), Failure> {
    names::check(&[(Some(&args.log), MEASUREMENT)], &[args.plot.as_deref()])?;
    let known: Vec<String> = Corner::ALL
        .into_iter()
        .flat_map(|corner| {
            [HEIGHTS, ACCELERATIONS].concat().into_iter().map(move |end| format!("{}{end}", corner.label()))
        })
        .collect();
    let optional: Vec<&str> = known.iter().map(String::as_str).collect();
    let table = Columns::read(&args.log, &["time_s"], &optional)?;
    let corners = corners(args, &table)?;
    let masses = args
        .sprung_mass_kg
        .zip(args.unsprung_mass_kg)
        .map(|(sprung_kg, unsprung_kg)| BumpMasses { sprung_kg, unsprung_kg });
    let window = BumpWindow { from_s: args.from_s, until_s: args.until_s };
    let result =
        bump(table.column("time_s"), &corners, masses, window).map_err(|error| refusal(&args.log, &error))?;
    let json = serde_json::to_string_pretty(&result.json())
        .map_err(|error| Failure::Usage(format!("the result is no JSON: {error}")))?;
    if let Some(path) = &args.plot {
        written(path, &result.figure().svg())?.commit()?;
    }
    let text = result.table();
    screen.print_lines(if args.json { &json } else { text.trim_end() });
    Ok(())
}

/// Measurements of body and wheel.
type Pair<'a> = (&'a [f64], &'a [f64]);

/// The corners that the record has, heights before accelerations.
fn corners<'a>(args: &BumpArgs, table: &'a Columns) -> Result<Vec<BumpCorner<'a>>, Failure> {
    let mut out = Vec::new();
    for corner in Corner::ALL {
        let label = corner.label();
        let pair = |ends: [&str; 2]| -> Result<Option<Pair<'a>>, Failure> {
            let names = ends.map(|end| format!("{label}{end}"));
            match [table.get(&names[0]), table.get(&names[1])] {
                [Some(body), Some(wheel)] => Ok(Some((body, wheel))),
                [None, None] => Ok(None),
                [Some(_), None] => Err(half(args, &names[1], &names[0])),
                [None, Some(_)] => Err(half(args, &names[0], &names[1])),
            }
        };
        if let Some((body_m, wheel_m)) = pair(HEIGHTS)? {
            out.push(BumpCorner { label, signals: BumpSignals::Heights { body_m, wheel_m } });
        } else if let Some((body_m_s2, wheel_m_s2)) = pair(ACCELERATIONS)? {
            out.push(BumpCorner { label, signals: BumpSignals::Accelerations { body_m_s2, wheel_m_s2 } });
        }
    }
    if out.is_empty() {
        return Err(Failure::Usage(format!(
            "{}: no corner is measured, expected {{c}}_body_m and {{c}}_wheel_m or {{c}}_body_accel_m_s2 and {{c}}_wheel_accel_m_s2 with c one of fl, fr, rl, rr",
            args.log.display()
        )));
    }
    Ok(out)
}

fn half(args: &BumpArgs, missing: &str, present: &str) -> Failure {
    Failure::Usage(format!(
        "{}: column {missing} is missing; a corner has both: without {present} the record is read without this corner",
        args.log.display()
    ))
}
