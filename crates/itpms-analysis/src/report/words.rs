//! The results as text: one sentence per corner.
//!
//! Called by the page's writer. Plain text; escaping is the writer's business.

use itpms_core::model::{Corner, PressureUnit, Warning};
use itpms_core::warning::{Doubt, WheelState};

use super::{CornerReport, Reading};

itpms_core::labelled! {
    /// How a corner fares, in the order of urgency.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub(super) enum Status {
        Low = "Low",
        Malfunction = "Malfunction",
        Over = "Over-inflated",
        Uncertain = "Uncertain",
        Unknown = "Unknown",
        Fine = "Fine",
    }
}

impl Status {
    pub(super) fn of(corner: &CornerReport) -> Self {
        let f = &corner.figures;
        if f.low_since_s.is_some() {
            Self::Low
        } else if f.malfunction_since_s.is_some() {
            Self::Malfunction
        } else if corner.state == Some(WheelState::Over) {
            Self::Over
        } else if f.last.is_some() && corner.state == Some(WheelState::Unknown(Doubt::Uncertain)) {
            Self::Uncertain
        } else if f.last.is_none() || matches!(corner.state, Some(WheelState::Unknown(_))) {
            Self::Unknown
        } else {
            Self::Fine
        }
    }

    /// Word for a corner's badge: what was is put into the past tense.
    pub(super) fn badge(corner: &CornerReport) -> &'static str {
        let now = corner.figures.warning;
        match Self::of(corner) {
            Self::Low if now != Warning::Low => "Was low",
            Self::Malfunction if now != Warning::Malfunction => "Was faulty",
            status => status.label(),
        }
    }

    /// Name of the style, and of the badge's sign, so that color is not all that tells them apart.
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Malfunction => "malfunction",
            Self::Over => "over",
            Self::Uncertain | Self::Unknown => "unknown",
            Self::Fine => "fine",
        }
    }

    /// Word beside a tire, where there is little room.
    pub(super) fn short(corner: &CornerReport) -> &'static str {
        let now = corner.figures.warning;
        match Self::of(corner) {
            Self::Low if now != Warning::Low => "was low",
            Self::Malfunction if now != Warning::Malfunction => "was faulty",
            status => status.word(),
        }
    }

    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Low => "LOW",
            Self::Malfunction => "FAULT",
            Self::Over => "OVER",
            Self::Uncertain => "uncertain",
            Self::Unknown => "unknown",
            Self::Fine => "fine",
        }
    }
}

impl CornerReport {
    /// Why the wheel was not known at the end, if the monitor reported that it was not: words that follow on its state and a colon.
    pub fn doubt(&self) -> Option<&'static str> {
        match self.state? {
            WheelState::Unknown(doubt) => Some(match doubt {
                Doubt::Uncertain => "too uncertain to rule out a loss",
                Doubt::Starting => "still learning",
                Doubt::Suspicion => "a sensor is suspected",
                Doubt::Misfit => "the car does not fit its vehicle file",
                Doubt::NoInformation => "nothing to learn from",
                Doubt::Standing => "the car stands; what was known when it stopped may have changed",
            }),
            WheelState::Fine | WheelState::Low | WheelState::Over | WheelState::Malfunction => None,
        }
    }
}

pub(super) fn corner_name(corner: Corner) -> &'static str {
    match corner {
        Corner::FrontLeft => "Front left",
        Corner::FrontRight => "Front right",
        Corner::RearLeft => "Rear left",
        Corner::RearRight => "Rear right",
    }
}

/// `139 ± 6 kPa`: one standard deviation, with as many digits as it is worth, in one piece.
pub(super) fn reading(reading: &Reading, unit: PressureUnit) -> String {
    let places = if reading.sd_kpa < 1.95 { 1 } else { 0 };
    let [pressure, sd] = [reading.pressure_kpa, reading.sd_kpa].map(|kpa| unit.number(kpa, places));
    format!("{pressure}\u{a0}±\u{a0}{sd}\u{a0}{unit}")
}

/// A time since the log's zero, for people.
pub(super) fn clock(time_s: f64) -> String {
    if !time_s.is_finite() {
        return "an unknown time".into();
    }
    if time_s.abs() < 120.0 {
        // Rounded first: 47.99 and 48.01 are both 48 s, not one of them 48.0 s.
        let tenths = (10.0 * time_s).round() / 10.0;
        return if tenths.fract().abs() < 0.05 || time_s >= 100.0 {
            format!("{tenths:.0}\u{a0}s")
        } else {
            format!("{tenths:.1}\u{a0}s")
        };
    }
    let whole = time_s.round() as i64;
    if whole.abs() < 3600 {
        format!("{}\u{a0}min\u{a0}{:02}\u{a0}s", whole / 60, whole % 60)
    } else {
        format!("{}\u{a0}h\u{a0}{:02}\u{a0}min", whole / 3600, whole % 3600 / 60)
    }
}

/// One corner in one sentence without a full stop.
pub(super) fn sentence(corner: &CornerReport, unit: PressureUnit) -> String {
    let reading = |found: &Reading| reading(found, unit);
    let name = corner_name(corner.corner);
    let f = &corner.figures;
    match Status::of(corner) {
        Status::Low => {
            let since = f.low_since_s.unwrap_or(f64::NAN);
            // While it is low its present pressure is the news; the lowest of many readings is one of the worst.
            let (when, found) = match f.low_until_s {
                Some(until) if f.warning != Warning::Low => {
                    (format!("warned of as low from {} to {}", clock(since), clock(until)), &f.lowest)
                }
                _ => (format!("low, warned of at {}", clock(since)), &f.last),
            };
            match found {
                Some(found) => {
                    let verb = if fell(f.first.as_ref(), found) { "fell to" } else { "is at" };
                    format!("{name} {verb} {}: {when}", reading(found))
                }
                None => format!("{name}: {when}"),
            }
        }
        Status::Malfunction => {
            let since = clock(f.malfunction_since_s.unwrap_or(f64::NAN));
            match &f.last {
                Some(last) if f.warning != Warning::Malfunction => {
                    format!("{name} had a sensor fault, warned of at {since}, now over: {}", reading(last))
                }
                _ => format!("{name}: the sensors allow no statement, warned of at {since}"),
            }
        }
        Status::Over => match &f.last {
            Some(last) => format!("{name} is at {}: over-inflated", reading(last)),
            None => format!("{name}: over-inflated"),
        },
        Status::Uncertain => match (&f.last, corner.doubt()) {
            (Some(last), Some(why)) => format!("{name} is at {}: uncertain, {why}", reading(last)),
            _ => format!("{name}: uncertain"),
        },
        Status::Unknown => match (&f.last, corner.state, corner.doubt()) {
            (Some(last), _, why) => {
                let why = why.map_or(String::new(), |why| format!(" ({why})"));
                let at = clock(last.time_s);
                format!("{name} is unknown at the end{why}; it was {} at {at}", reading(last))
            }
            (None, Some(WheelState::Unknown(Doubt::Misfit | Doubt::Suspicion)), Some(why)) => {
                format!("{name} is unknown: {why}")
            }
            (None, ..) => format!("{name}: not enough was seen for a pressure"),
        },
        Status::Fine => match (&f.first, &f.last) {
            (Some(first), Some(last)) if fell(Some(first), last) => {
                format!("{name} went from {} to {}: fine", unit.number(first.pressure_kpa, 0), reading(last))
            }
            (_, Some(last)) => format!("{name} held {}: fine", reading(last)),
            _ => format!("{name}: fine"),
        },
    }
}

/// Whether a reading lies below another by more than their uncertainties explain.
fn fell(first: Option<&Reading>, later: &Reading) -> bool {
    first.is_none_or(|first| first.pressure_kpa - later.pressure_kpa > 2.0 * first.sd_kpa.hypot(later.sd_kpa))
}

pub(super) fn lower(text: &str) -> String {
    text.to_lowercase()
}

/// Level of a road in millionths of m³, with two figures where it is a small one.
pub(super) fn level(gd_n0_m3: f64) -> String {
    let millionths = 1e6 * gd_n0_m3;
    let places = match millionths {
        small if small < 1.0 => 2,
        few if few < 10.0 => 1,
        _ => 0,
    };
    format!("{millionths:.places$}·10⁻⁶ m³")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_for_people() {
        let clock = |t: f64| clock(t).replace('\u{a0}', " ");
        assert_eq!(clock(22.0), "22 s");
        assert_eq!(clock(22.44), "22.4 s");
        assert_eq!((clock(47.998), clock(48.002)), ("48 s".into(), "48 s".into()));
        assert_eq!(clock(119.0), "119 s");
        assert_eq!(clock(245.0), "4 min 05 s");
        assert_eq!(clock(3720.0), "1 h 02 min");
        assert_eq!(clock(f64::NAN), "an unknown time");
    }

    #[test]
    fn small_levels_keep_two_figures() {
        let levels = [16e-6, 9.96e-6, 1.64e-6, 0.3e-6].map(level);
        assert_eq!(levels, ["16·10⁻⁶ m³", "10.0·10⁻⁶ m³", "1.6·10⁻⁶ m³", "0.30·10⁻⁶ m³"]);
    }

    #[test]
    fn readings_with_the_digits_they_are_worth() {
        let at = |p: f64, sd: f64| {
            let found = Reading { time_s: 0.0, pressure_kpa: p, sd_kpa: sd };
            PressureUnit::ALL.map(|unit| reading(&found, unit).replace('\u{a0}', " "))
        };
        assert_eq!(at(139.4, 6.2), ["139 ± 6 kPa", "1.39 ± 0.06 bar", "20.2 ± 0.9 psi"]);
        assert_eq!(at(139.44, 1.24), ["139.4 ± 1.2 kPa", "1.394 ± 0.012 bar", "20.22 ± 0.18 psi"]);
    }
}
