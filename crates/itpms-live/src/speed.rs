//! Why the speed of the car is unknown, and when that is reported: once of each reason, when it has lasted.
//!
//! Called by the engine after every row. Without a speed front and rear cannot be held against each other.

/// Seconds for which a speed has to be missing before that is reported: a bus that wakes up tells some signals later than others.
const LASTS_S: f64 = 5.0;

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum SpeedDoubt {
        /// For more than half a second nothing was sent that a car can drive.
        Missing = "missing",
        /// It says that the car stands while its wheels roll.
        Contradicted = "contradicted",
    }
}

#[derive(Debug, Default)]
pub(crate) struct SpeedDoubts {
    /// The present doubt, since when, and when it was last checked.
    doubted: Option<(SpeedDoubt, f64, f64)>,
    reported: Vec<SpeedDoubt>,
}

impl SpeedDoubts {
    /// Takes the doubt after a row at `time_s`; gives what is to be reported, once of each.
    pub(crate) fn take(&mut self, time_s: f64, doubt: Option<SpeedDoubt>) -> Option<String> {
        let since_s = match (self.doubted, doubt) {
            (Some((before, since_s, last_s)), Some(now))
                if before == now && (0.0..LASTS_S).contains(&(time_s - last_s)) =>
            {
                since_s
            }
            // Another doubt, a clock that was set back or a bus that slept.
            _ => time_s,
        };
        self.doubted = doubt.map(|doubt| (doubt, since_s, time_s));
        let doubt = doubt.filter(|doubt| !self.reported.contains(doubt))?;
        let what = match doubt {
            SpeedDoubt::Missing if time_s - since_s < LASTS_S => return None,
            SpeedDoubt::Missing => "there has been no speed_m_s that a car can have",
            SpeedDoubt::Contradicted => "speed_m_s says that the car stands while its wheels roll",
        };
        self.reported.push(doubt);
        Some(format!("since {since_s:.1} s {what}; for as long every wheel is by itself: less accurate"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_reason_is_reported_once_and_a_hole_only_when_it_lasts() {
        let mut word = SpeedDoubts::default();
        let mut reported = Vec::new();
        let rows = (0..600u32).map(|tenths| 0.1 * f64::from(tenths));
        for time_s in rows {
            let doubt = match time_s {
                t if t < 4.0 => Some(SpeedDoubt::Missing),
                t if (10.0..15.5).contains(&t) || t >= 40.0 => Some(SpeedDoubt::Missing),
                t if (20.0..21.0).contains(&t) => Some(SpeedDoubt::Contradicted),
                _ => None,
            };
            reported.extend(word.take(time_s, doubt).map(|text| format!("{time_s:.1}: {text}")));
        }
        assert_eq!(reported.len(), 2, "{reported:?}");
        assert!(reported[0].starts_with("15.0: since 10.0 s there has been no speed_m_s"), "{reported:?}");
        assert!(
            reported[1].starts_with("20.0: since 20.0 s speed_m_s says that the car stands"),
            "{reported:?}"
        );
        // A clock that is set back begins to count again, and so does a bus that slept.
        let mut word = SpeedDoubts::default();
        for time_s in [100.0, 104.0, 3.0, 7.0, 5000.0] {
            assert_eq!(word.take(time_s, Some(SpeedDoubt::Missing)), None);
        }
    }
}
