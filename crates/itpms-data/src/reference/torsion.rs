//! Learned values of tooth pulses, as a table per wheel of a stored reference and back: four parabolas of the speed as information.

use std::fmt::Write as _;

use itpms_core::model::Corner;
use itpms_core::torsion::{TorsionCalibration, TorsionCurve};

use super::{LearnedTorsion, ReferenceProblem};
use crate::error::Problem;
use crate::toml_table::Table;

/// Keys of a parabola: information times coefficients, then the information's upper triangle.
macro_rules! keys {
    ($name:literal) => {
        [
            concat!($name, "_0"),
            concat!($name, "_1"),
            concat!($name, "_2"),
            concat!($name, "_00"),
            concat!($name, "_01"),
            concat!($name, "_02"),
            concat!($name, "_11"),
            concat!($name, "_12"),
            concat!($name, "_22"),
        ]
    };
}

const CURVES: [[&str; 9]; 4] = [keys!("slope"), keys!("curvature"), keys!("damping"), keys!("resonance")];
const AROUND: &str = "around_hz";
const PIECES: &str = "pieces";
const ABOVE: &str = "above_placard_kpa";

pub(super) fn write(out: &mut String, learned: &LearnedTorsion) {
    for (corner, learned) in Corner::ALL.into_iter().zip(learned) {
        let Some((learned, above_kpa)) = learned else { continue };
        let _ = writeln!(out, "\n[torsion.{}]", corner.label());
        // `{:?}` is the shortest form that reads back as the same number.
        let _ =
            writeln!(out, "{AROUND} = {:?}\n{PIECES} = {:?}", learned.around_hz, f64::from(learned.pieces));
        let _ = writeln!(out, "{ABOVE} = {above_kpa:?}");
        for (keys, TorsionCurve { information: [a, b, c], vector }) in CURVES.iter().zip(&learned.curves) {
            let values = vector.iter().chain(a).chain(&b[1..]).chain(&c[2..]);
            for (key, value) in keys.iter().zip(values) {
                let _ = writeln!(out, "{key} = {value:?}");
            }
        }
    }
}

pub(super) fn read(table: &Table<'_>) -> Result<LearnedTorsion, Problem> {
    table.check_keys(&Corner::ALL.map(Corner::label))?;
    let mut learned = [None; 4];
    for (corner, place) in Corner::ALL.into_iter().zip(&mut learned) {
        *place = table.table(corner.label())?.map(|table| wheel(&table)).transpose()?;
    }
    Ok(learned)
}

fn wheel(table: &Table<'_>) -> Result<(TorsionCalibration<f64>, f64), Problem> {
    let keys: Vec<&str> = CURVES.into_iter().flatten().chain([AROUND, PIECES, ABOVE]).collect();
    table.check_keys(&keys)?;
    let pieces = table.needed_number(PIECES)?;
    if !((1.0..4e9).contains(&pieces) && pieces.fract() == 0.0) {
        return Err(ReferenceProblem::Lacks("a number of pieces").into());
    }
    let mut curves = [TorsionCurve { information: [[0.0; 3]; 3], vector: [0.0; 3] }; 4];
    for (curve, keys) in curves.iter_mut().zip(CURVES) {
        let mut values = [0.0; 9];
        for (value, key) in values.iter_mut().zip(keys) {
            *value = table.needed_number(key)?;
        }
        let [x, y, z, a, b, c, d, e, f] = values;
        *curve = TorsionCurve { information: [[a, b, c], [b, d, e], [c, e, f]], vector: [x, y, z] };
    }
    let learned =
        TorsionCalibration { around_hz: table.needed_number(AROUND)?, pieces: pieces as u32, curves };
    Ok((learned, table.needed_number(ABOVE)?))
}
