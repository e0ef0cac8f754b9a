//! Pressures that an owner has read from a gauge, and from when on each was in its tire.

use std::str::FromStr;

use itpms_core::model::Corner;

use crate::learn::no_pressure;

/// The gauge's readings from some time of a log on: gauge pressures in kPa, in the order of [`Corner::ALL`]; `None`: as before.
///
/// Written `240`, `fl=240,fr=240,rl=220,rr=220`, or with the time in s since the log's first row before it: `480:fl=200`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownFrom {
    /// Time in s since the log's first row.
    pub from_s: f64,
    pub kpa: [Option<f64>; 4],
}

impl FromStr for KnownFrom {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || {
            format!(
                "found {text:?}, expected kPa such as 240 or fl=240,fr=240,rl=220,rr=220, after the first with its time in s: 480:fl=200"
            )
        };
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
        let (from_s, rest) = match text.split_once(':') {
            Some((from, rest)) => (number(from).filter(|from| *from >= 0.0).ok_or_else(expected)?, rest),
            None => (0.0, text),
        };
        let pressure = |text: &str| {
            let kpa = number(text).ok_or_else(expected)?;
            no_pressure(kpa).map_or(Ok(kpa), Err)
        };
        let mut kpa = [None; 4];
        if !rest.contains('=') {
            return Ok(Self { from_s, kpa: [Some(pressure(rest)?); 4] });
        }
        for part in rest.split(',') {
            let (label, value) = part.split_once('=').ok_or_else(expected)?;
            let corner = Corner::ALL.into_iter().find(|c| c.label() == label.trim()).ok_or_else(expected)?;
            kpa[corner.index()] = Some(pressure(value)?);
        }
        Ok(Self { from_s, kpa })
    }
}

/// A stretch of a log with the pressures of all four tires in kPa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownStretch {
    /// Where it begins, in s since the log's first row.
    pub from_s: f64,
    /// The pressures in kPa, in the order of [`Corner::ALL`].
    pub kpa: [f64; 4],
}

impl KnownStretch {
    /// The tires that have other pressures than `before`, as `fl 200`; all of them where there is nothing before.
    pub(super) fn changes(&self, before: Option<&Self>) -> String {
        let changed =
            |corner: &Corner| before.is_none_or(|b| b.kpa[corner.index()] != self.kpa[corner.index()]);
        let words =
            Corner::ALL.into_iter().filter(changed).map(|c| format!("{} {}", c.label(), self.kpa[c.index()]));
        words.collect::<Vec<_>>().join(", ")
    }

    /// The largest difference of a tire's pressure between the two, in kPa.
    pub(super) fn difference_kpa(&self, other: &Self) -> f64 {
        self.kpa.iter().zip(&other.kpa).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

/// The stretches of a log, each with all four pressures: what is not given for a tire is what it was before.
/// Errors: none is given; the first is not of the log's beginning or lacks a tire; times that do not ascend. A sentence with the way out.
pub(super) fn stretches(known: &[KnownFrom]) -> Result<Vec<KnownStretch>, String> {
    let Some(first) = known.first() else {
        return Err("no pressure is given: read every tire with a gauge, cold, at the start and after each change, and give them with --pressure-kpa 240 --pressure-kpa 480:fl=200 --pressure-kpa 900:fl=160 (seconds since the start, then kPa)".to_owned());
    };
    if first.from_s > 0.0 {
        return Err(format!(
            "the first pressures hold from {} s on: give those of the log's beginning without a time (--pressure-kpa 240)",
            first.from_s
        ));
    }
    let mut kpa = [f64::NAN; 4];
    let mut out: Vec<KnownStretch> = Vec::new();
    for known in known {
        if out.last().is_some_and(|before| !(known.from_s > before.from_s)) {
            return Err(format!(
                "pressures from {} s on are given after later ones, or twice: give them in the order of their times",
                known.from_s
            ));
        }
        for (kpa, given) in kpa.iter_mut().zip(known.kpa) {
            *kpa = given.unwrap_or(*kpa);
        }
        out.push(KnownStretch { from_s: known.from_s, kpa });
    }
    if let Some(missing) = Corner::ALL.into_iter().find(|c| out[0].kpa[c.index()].is_nan()) {
        return Err(format!(
            "the pressure of {} at the log's beginning is not given: read all four tires, also those that stay as they are",
            missing.label()
        ));
    }
    Ok(out)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]
mod tests {
    use super::*;

    fn read(texts: &[&str]) -> Vec<KnownFrom> {
        texts.iter().map(|text| text.parse().unwrap()).collect()
    }

    #[test]
    fn what_is_not_given_stays_as_it_was() {
        let all = stretches(&read(&["240", "480:fl=200", "900.5:fl=160,rr=230"])).unwrap();
        assert_eq!(all[1].kpa, [200.0, 240.0, 240.0, 240.0]);
        assert_eq!((all[2].from_s, all[2].kpa), (900.5, [160.0, 240.0, 240.0, 230.0]));
        assert_eq!(all[2].changes(Some(&all[1])), "fl 160, rr 230");
        assert_eq!(all[2].difference_kpa(&all[0]), 80.0);
    }

    #[test]
    fn every_mistake_has_its_sentence() {
        for (texts, words) in [
            (&[][..], "no pressure is given"),
            (&["60:240"], "without a time"),
            (&["fl=240"], "the pressure of fr"),
            (&["240", "90:fl=200", "90:fl=180"], "in the order of their times"),
        ] {
            let error = stretches(&read(texts)).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
        for text in ["2.4", "35", "fl:240", "-3:240", "480:", "xx=240", "nan"] {
            assert!(text.parse::<KnownFrom>().is_err(), "{text}");
        }
    }
}
