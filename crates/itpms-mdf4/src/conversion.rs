//! From a raw number to a physical one: CC blocks.
//!
//! Called by the structure, which reads them, and by the cursor, which applies them. A conversion into text alone leaves the numbers as
//! they are; where a table gives text for some values and numbers for others, the values with text (say, "not available") have no number.

use std::collections::HashMap;
use std::sync::Arc;

use super::block::{Block, BlockFile, Fault, Kind};
use super::error::Mdf4Problem;
use super::formula::Formula;
use super::text;

const CONVERSION: Kind = Kind { name: "conversion", id: b"##CC", links: 4, data: 24, most: 24 + 8 * 65_535 };

/// Numbers of all tables of a file.
const MOST_NUMBERS: usize = 1 << 21;

/// Tables whose values are converted again, one inside the other.
const DEEPEST: usize = 4;

/// Conversion of a raw to a physical value (ASAM MDF 4.1, CCBLOCK, `cc_type`).
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Conversion {
    /// None, or into text alone.
    Identity,
    /// `offset + factor x`.
    Linear { offset: f64, factor: f64 },
    /// `(p0 x² + p1 x + p2) / (p3 x² + p4 x + p5)`.
    Rational([f64; 6]),
    /// A formula in words.
    Formula(Formula),
    /// Keys in rising order with their values.
    Table { keys: Vec<f64>, values: Vec<f64>, between: Between },
    /// Ranges in rising order; what is in none has the default.
    Ranges { ranges: Vec<Range>, default: f64 },
    /// Ranges in rising order, each with a conversion of its own.
    Scales { ranges: Vec<Scale>, default: Option<Arc<Conversion>> },
    /// One that is not computed; what it is.
    Unreadable(String),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Between {
    /// On the straight line.
    Interpolated,
    /// As at the nearest key, the lower one in the middle.
    Nearest,
}

/// A range with a value; the upper end belongs to it if the raw value is an integer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    least: f64,
    most: f64,
    value: f64,
}

/// A range with a conversion; `None` where it gives text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    least: f64,
    most: f64,
    conversion: Option<Arc<Conversion>>,
}

/// Whether raw values are counted or measured: decides on the upper ends of ranges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Raw {
    Integer,
    Float,
}

impl Conversion {
    /// The physical value of the raw value `x`, NaN where there is none.
    pub(super) fn apply(&self, x: f64, raw: Raw) -> f64 {
        match self {
            Conversion::Identity => x,
            Conversion::Linear { offset, factor } => offset + factor * x,
            Conversion::Rational([a, b, c, d, e, f]) => (a * x * x + b * x + c) / (d * x * x + e * x + f),
            Conversion::Formula(formula) => formula.apply(x),
            Conversion::Table { keys, values, between } => look_up(keys, values, *between, x),
            Conversion::Ranges { ranges, default } => {
                let found = find(ranges, x, raw, |range| (range.least, range.most));
                if x.is_nan() { x } else { found.map_or(*default, |range| range.value) }
            }
            Conversion::Scales { ranges, default } => {
                let found = find(ranges, x, raw, |range| (range.least, range.most));
                let conversion = found.map_or(default, |range| &range.conversion);
                conversion.as_ref().map_or(f64::NAN, |conversion| conversion.apply(x, raw))
            }
            Conversion::Unreadable(_) => f64::NAN,
        }
    }
}

fn look_up(keys: &[f64], values: &[f64], between: Between, x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    let above = keys.partition_point(|key| *key <= x);
    let pair = |i: usize| keys.get(i).copied().zip(values.get(i).copied());
    match (above.checked_sub(1).and_then(pair), pair(above)) {
        (Some((low, at_low)), Some((high, at_high))) => match between {
            Between::Interpolated => at_low + (x - low) / (high - low) * (at_high - at_low),
            Between::Nearest if x - low > high - x => at_high,
            Between::Nearest => at_low,
        },
        // Outside, the value at the end.
        (Some((_, value)), None) | (None, Some((_, value))) => value,
        (None, None) => f64::NAN,
    }
}

/// The last range that begins at or below `x`, if it reaches to it.
fn find<T>(ranges: &[T], x: f64, raw: Raw, ends: impl Fn(&T) -> (f64, f64)) -> Option<&T> {
    let after = ranges.partition_point(|range| ends(range).0 <= x);
    let range = ranges.get(after.checked_sub(1)?)?;
    let (least, most) = ends(range);
    let inside = match raw {
        Raw::Integer => x <= most,
        // A range of one value has that one.
        Raw::Float => x < most || (x == most && least == most),
    };
    inside.then_some(range)
}

/// Conversions that were read, by their place.
#[derive(Debug, Default)]
pub(super) struct Conversions {
    known: HashMap<u64, (Arc<Conversion>, u64)>,
    /// Numbers of their tables so far.
    numbers: usize,
}

impl Conversions {
    /// The conversion at `at` and the place of its unit; the identity where there is none.
    pub(super) fn read(
        &mut self,
        file: &mut BlockFile,
        at: u64,
    ) -> Result<(Arc<Conversion>, u64), Mdf4Problem> {
        self.read_nested(file, at, 0)
    }

    fn read_nested(
        &mut self,
        file: &mut BlockFile,
        at: u64,
        depth: usize,
    ) -> Result<(Arc<Conversion>, u64), Mdf4Problem> {
        if at == 0 {
            return Ok((Arc::new(Conversion::Identity), 0));
        }
        if let Some(known) = self.known.get(&at) {
            return Ok(known.clone());
        }
        // What refers to itself finds this.
        let unreadable = |why: String| Arc::new(Conversion::Unreadable(why));
        self.known.insert(at, (unreadable("converted by a conversion that refers to itself".to_owned()), 0));
        let (conversion, unit) = match file.block(&CONVERSION, at) {
            Ok(_) if depth > DEEPEST => (unreadable("converted by tables inside tables".to_owned()), 0),
            Ok(block) => (Arc::new(self.compile(file, &block, depth)?), block.link(1)),
            Err(fault @ Fault::Damaged(_)) => {
                (unreadable(format!("converted by a lost conversion ({})", fault.damage()?)), 0)
            }
            Err(fault) => return Err(fault.into_problem()),
        };
        self.known.insert(at, (Arc::clone(&conversion), unit));
        Ok((conversion, unit))
    }

    fn compile(
        &mut self,
        file: &mut BlockFile,
        block: &Block,
        depth: usize,
    ) -> Result<Conversion, Mdf4Problem> {
        let stored = (block.data.len() - CONVERSION.data) / 8;
        let claimed = usize::from(block.u16(6));
        let value = |i: usize| block.f64(CONVERSION.data + 8 * i);
        let values: Vec<f64> = (0..claimed.min(stored)).map(value).collect();
        self.numbers += values.len();
        if self.numbers > MOST_NUMBERS {
            let why =
                format!("converted by a table beyond the {MOST_NUMBERS} numbers that all tables may have");
            return Ok(Conversion::Unreadable(why));
        }
        let kind = block.u8(0);
        let references = usize::from(block.u16(4));
        let too_few = || Conversion::Unreadable(format!("converted by a table of {} numbers", values.len()));
        Ok(match (kind, values.as_slice()) {
            (0, _) => Conversion::Identity,
            (1, &[offset, factor, ..]) => Conversion::Linear { offset, factor },
            (2, &[a, b, c, d, e, f, ..]) => Conversion::Rational([a, b, c, d, e, f]),
            (3, _) => formula(file, block.link(4))?,
            (4, pairs @ [_, _, ..]) => table(pairs, Between::Interpolated),
            (5, pairs @ [_, _, ..]) => table(pairs, Between::Nearest),
            (6, [triples @ .., default]) => ranges(triples, *default),
            (7, keys) => self.scales(file, block, keys.iter().map(|key| (*key, *key)), references, depth)?,
            (8, ends) => {
                let ends = ends.chunks_exact(2).map(|pair| (pair[0], pair[1]));
                self.scales(file, block, ends, references, depth)?
            }
            (9 | 10, _) => Conversion::Unreadable("converted from text".to_owned()),
            // Words for single bits: the number stays.
            (11, _) => Conversion::Identity,
            (1 | 2 | 4 | 5 | 6, _) => too_few(),
            (other, _) => {
                Conversion::Unreadable(format!("converted by a conversion of unknown type {other}"))
            }
        })
    }

    /// Values or ranges to text or to a further conversion; the last reference is the default.
    fn scales(
        &mut self,
        file: &mut BlockFile,
        block: &Block,
        ends: impl Iterator<Item = (f64, f64)>,
        references: usize,
        depth: usize,
    ) -> Result<Conversion, Mdf4Problem> {
        let mut ranges = Vec::new();
        for (i, (least, most)) in ends.enumerate() {
            let conversion =
                if i < references { self.reference(file, block.link(4 + i), depth)? } else { None };
            if least <= most {
                ranges.push(Scale { least, most, conversion });
            }
        }
        let default = match references.checked_sub(1) {
            Some(last) => self.reference(file, block.link(4 + last), depth)?,
            None => None,
        };
        if default.is_none() && ranges.iter().all(|range| range.conversion.is_none()) {
            return Ok(Conversion::Identity);
        }
        ranges.sort_by(|a, b| a.least.total_cmp(&b.least));
        Ok(Conversion::Scales { ranges, default })
    }

    /// A reference of a table: another conversion, or text, which is `None`.
    fn reference(
        &mut self,
        file: &mut BlockFile,
        at: u64,
        depth: usize,
    ) -> Result<Option<Arc<Conversion>>, Mdf4Problem> {
        if at == 0 {
            return Ok(None);
        }
        match file.frame("conversion", at) {
            Ok(frame) if frame.id == *b"##CC" => Ok(Some(self.read_nested(file, at, depth + 1)?.0)),
            Ok(_) | Err(Fault::Damaged(_)) => Ok(None),
            Err(fault) => Err(fault.into_problem()),
        }
    }
}

fn formula(file: &mut BlockFile, at: u64) -> Result<Conversion, Mdf4Problem> {
    let unreadable = |why: String| Ok(Conversion::Unreadable(why));
    if at == 0 {
        return unreadable("converted by a formula that is not there".to_owned());
    }
    let text = match text::read(file, at) {
        Ok(text) => text,
        Err(fault) => return unreadable(format!("converted by a lost formula ({})", fault.damage()?)),
    };
    if text.len() >= text::LONGEST - 4 {
        return unreadable(format!("converted by a formula of more than {} bytes", text::LONGEST));
    }
    match Formula::parse(&text) {
        Ok(formula) => Ok(Conversion::Formula(formula)),
        Err(rest) => {
            let (text, rest): (String, String) =
                (text.chars().take(60).collect(), rest.chars().take(20).collect());
            unreadable(format!("converted by the formula {text:?}, of which {rest:?} is not understood"))
        }
    }
}

pub(super) fn table(pairs: &[f64], between: Between) -> Conversion {
    let (keys, values): (Vec<f64>, Vec<f64>) = pairs.chunks_exact(2).map(|pair| (pair[0], pair[1])).unzip();
    if !keys.windows(2).all(|pair| pair[0] < pair[1]) {
        return Conversion::Unreadable("converted by a table whose keys do not rise".to_owned());
    }
    Conversion::Table { keys, values, between }
}

fn ranges(triples: &[f64], default: f64) -> Conversion {
    let triples = triples.chunks_exact(3);
    let mut ranges: Vec<Range> = triples
        .map(|t| Range { least: t[0], most: t[1], value: t[2] })
        .filter(|r| r.least <= r.most)
        .collect();
    ranges.sort_by(|a, b| a.least.total_cmp(&b.least));
    Conversion::Ranges { ranges, default }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_a_line_or_a_staircase_and_flat_outside() {
        let line = table(&[0.0, 10.0, 2.0, 20.0, 6.0, 0.0], Between::Interpolated);
        let stairs = table(&[0.0, 10.0, 2.0, 20.0, 6.0, 0.0], Between::Nearest);
        for (x, on_line, on_stairs) in
            [(-1.0, 10.0, 10.0), (0.0, 10.0, 10.0), (1.0, 15.0, 10.0), (3.0, 15.0, 20.0), (9.0, 0.0, 0.0)]
        {
            assert_eq!(line.apply(x, Raw::Float), on_line, "{x}");
            assert_eq!(stairs.apply(x, Raw::Float), on_stairs, "{x}");
        }
        assert!(line.apply(f64::NAN, Raw::Float).is_nan());
        assert!(matches!(table(&[1.0, 0.0, 0.0, 0.0], Between::Nearest), Conversion::Unreadable(_)));
    }

    #[test]
    fn the_upper_end_of_a_range_belongs_to_integers_only() {
        let ranges = ranges(&[10.0, 20.0, 2.0, 0.0, 5.0, 1.0, 7.0, 7.0, 3.0], -1.0);
        for (x, integer, float) in
            [(0.0, 1.0, 1.0), (5.0, 1.0, -1.0), (7.0, 3.0, 3.0), (20.0, 2.0, -1.0), (21.0, -1.0, -1.0)]
        {
            assert_eq!(ranges.apply(x, Raw::Integer), integer, "{x}");
            assert_eq!(ranges.apply(x, Raw::Float), float, "{x}");
        }
    }

    #[test]
    fn a_rational_conversion_has_the_standards_order_of_parameters() {
        let half = Conversion::Rational([0.0, 1.0, 3.0, 0.0, 0.0, 2.0]);
        assert_eq!(half.apply(5.0, Raw::Integer), 4.0);
        let inverse = Conversion::Rational([0.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
        assert_eq!(inverse.apply(4.0, Raw::Integer), 0.25);
    }

    #[test]
    fn where_a_table_gives_text_there_is_no_number() {
        let linear = Arc::new(Conversion::Linear { offset: 1.0, factor: 2.0 });
        let not_available = Scale { least: 255.0, most: 255.0, conversion: None };
        let scales = Conversion::Scales { ranges: vec![not_available], default: Some(linear) };
        assert_eq!(scales.apply(254.0, Raw::Integer), 509.0);
        assert!(scales.apply(255.0, Raw::Integer).is_nan());
    }
}
