//! Implausible signals of a log, a sentence each. Plain text; escaping is the page's business.

use super::{Found, FoundCorner, HOP_HZ, Statistics};
use crate::transfer::{AGAINST, Density, FEWEST_SEGMENTS, INCOHERENT};

/// Mean acceleration in m/s² from which gravity must be in it: half of it.
const GRAVITY: f64 = 4.9;
/// Values that follow another one at the limit, and are no accident: an acceleration of a driving car does not stand still.
const AT_LIMIT: u64 = 8;
/// Share of missing values worth a word.
const MISSING: f64 = 0.01;
/// Steps of a coarse sensor per standard deviation.
const STEPS_PER_SD: f64 = 3.0;
/// Coherence of signals that are one and the same.
const SAME: f64 = 0.9999;

impl Found {
    /// Suspicious findings, corner by corner; empty without any.
    pub fn doubts(&self) -> Vec<String> {
        let mut out = Vec::new();
        if self.speed.is_none() && (self.wheels.is_none() || !self.corners.is_empty()) {
            out.push("No speed: neither the axles' common road nor the roughness can be used".to_owned());
        }
        for corner in &self.corners {
            out.extend(corner.doubts());
        }
        out.extend(self.pairs());
        out.extend(self.gravity());
        out
    }

    /// Sentences on body and wheel together, each once with all corners it holds for.
    fn pairs(&self) -> Vec<String> {
        let mut sentences: Vec<(String, String)> = Vec::new();
        for corner in &self.corners {
            let Some(text) = corner.pair() else { continue };
            match sentences.iter_mut().find(|(_, before)| *before == text) {
                Some((labels, _)) => *labels = format!("{labels} {}", corner.label),
                None => sentences.push((corner.label.to_owned(), text)),
            }
        }
        sentences.into_iter().map(|(labels, text)| format!("{labels}: {text}")).collect()
    }

    fn gravity(&self) -> Option<String> {
        let sensors = self.corners.iter().flat_map(|corner| {
            let of = |name, s| (format!("{}, {name}", corner.label), s);
            [of("body", &corner.body), of("wheel", &corner.wheel)]
        });
        let with: Vec<(String, f64)> = sensors
            .filter(|(_, s)| s.sd != 0.0 && s.samples > 0 && s.mean.abs() > GRAVITY)
            .map(|(name, s)| (name, s.mean))
            .collect();
        // Of a mean that no car has, the size says enough.
        let size = |mean: f64| if mean.abs() < 1e6 { format!("{mean:.1}") } else { format!("{mean:.1e}") };
        match &with[..] {
            [] => None,
            [(name, mean)] => Some(format!("{name}: its mean is {} m/s², so gravity is in it", size(*mean))),
            [(first, mean), others @ ..] => Some(format!(
                "{first}, and {} more: their means are {} m/s² and the like, so gravity is in them",
                others.len(),
                size(*mean)
            )),
        }
    }
}

impl FoundCorner {
    fn doubts(&self) -> Vec<String> {
        [("body", &self.body), ("wheel", &self.wheel)]
            .into_iter()
            .flat_map(|(name, statistics)| signal(&format!("{}, {name}", self.label), statistics))
            .collect()
    }

    fn pair(&self) -> Option<String> {
        if self.body.sd == 0.0 || self.wheel.sd == 0.0 || self.body.samples == 0 || self.wheel.samples == 0 {
            return None;
        }
        if self.segments < FEWEST_SEGMENTS {
            return Some(
                "less than half a minute without a gap: too short to judge body and wheel".to_owned(),
            );
        }
        let (wheel, body) = self.hop_power();
        if self.coherence > SAME && (wheel / body - 1.0).abs() < 0.01 {
            return Some("body and wheel are one and the same signal".to_owned());
        }
        if body > wheel {
            return Some(format!(
                "the body moves more than the wheel where wheels hop ({:.0} to {:.0} Hz): check whether the two are exchanged",
                HOP_HZ.0, HOP_HZ.1
            ));
        }
        if self.against {
            return Some(AGAINST.to_owned());
        }
        (self.coherence < INCOHERENT).then(|| {
            format!(
                "the body does not follow this wheel (coherence {:.2} between 4 and 16 Hz, expected {INCOHERENT} or more): check that its body sensor sits above this wheel and that the columns are those of this corner",
                self.coherence
            )
        })
    }

    /// Mean density of wheel and body where wheels hop.
    fn hop_power(&self) -> (f64, f64) {
        let within = |line: &&Density| (HOP_HZ.0..=HOP_HZ.1).contains(&line.hz);
        let sum = |of: fn(&Density) -> f64| self.lines.iter().filter(within).map(of).sum::<f64>();
        (sum(|line| line.wheel), sum(|line| line.body))
    }
}

fn signal(name: &str, s: &Statistics) -> Vec<String> {
    if s.samples == 0 {
        return vec![format!("{name}: never has a value")];
    }
    if s.sd == 0.0 {
        return vec![format!("{name}: always {}", s.mean)];
    }
    let mut out = Vec::new();
    let missing = s.missing as f64 / (s.missing + s.samples) as f64;
    if missing > MISSING {
        out.push(format!("{name}: {:.0} % of its values are missing", 100.0 * missing));
    }
    // A coarse signal stays at its limit without being cut off there.
    if s.smallest_step * STEPS_PER_SD > s.sd {
        out.push(format!(
            "{name}: moves in steps of {:.3} m/s², coarse for a standard deviation of {:.3} m/s²",
            s.smallest_step, s.sd
        ));
    } else if s.repeated_at_limit >= AT_LIMIT {
        out.push(format!(
            "{name}: stays at its limits ({:.4} and {:.4} m/s²) for {} values: its range is too small, or it stood still",
            s.low, s.high, s.repeated_at_limit
        ));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::CornerSignals;
    use super::super::tests::{minute, noise};

    #[test]
    fn nothing_is_wrong_with_a_body_that_follows_its_wheel() {
        assert_eq!(minute(0.2, |_, _| {}).doubts(), Vec::<String>::new());
    }

    #[test]
    fn what_is_wrong_is_reported() {
        let expect_text = |found: super::Found, words: &str| {
            let doubts = found.doubts();
            assert!(doubts.iter().any(|doubt| doubt.contains(words)), "{words}: {doubts:?}");
            assert_eq!(doubts.len(), 1, "{doubts:?}");
        };
        let expect_of_all = |edit: fn(&mut CornerSignals), words: &str| {
            expect_text(minute(0.2, |_, signals| edit(signals)), words);
        };
        expect_of_all(
            |s| std::mem::swap(&mut s.body_accel_m_s2, &mut s.wheel_accel_m_s2),
            "fr: the body moves more than the wheel where wheels hop (8 to 20 Hz)",
        );
        expect_of_all(|s| s.body_accel_m_s2 = s.wheel_accel_m_s2, "one and the same signal");
        expect_of_all(|s| s.body_accel_m_s2 += 9.81, "fr, body: its mean is 9.8 m/s², so gravity is in it");
        expect_of_all(
            |s| {
                s.body_accel_m_s2 += 9.81;
                s.wheel_accel_m_s2 += 9.81;
            },
            "fr, body, and 1 more: their means are 9.8 m/s² and the like, so gravity is in them",
        );
        expect_of_all(|s| s.body_accel_m_s2 = 1.5, "fr, body: always 1.5");
        expect_of_all(|s| s.wheel_accel_m_s2 = f64::NAN, "fr, wheel: never has a value");
        expect_of_all(
            |s| s.wheel_accel_m_s2 = s.wheel_accel_m_s2.clamp(-3.5, 3.5),
            "fr, wheel: stays at its limits (-3.5000 and 3.5000 m/s²) for",
        );
        expect_text(
            minute(0.2, |i, s| {
                if (3_000..3_600).contains(&i) {
                    s.wheel_accel_m_s2 = f64::NAN;
                }
            }),
            "fr, wheel: 5 % of its values are missing",
        );
        expect_of_all(
            |s| s.body_accel_m_s2 = (s.body_accel_m_s2 / 0.16).round() * 0.16,
            "moves in steps of 0.16",
        );
    }

    #[test]
    fn what_is_the_same_of_several_corners_is_reported_once() {
        let exchanged =
            || minute(0.2, |_, s| std::mem::swap(&mut s.body_accel_m_s2, &mut s.wheel_accel_m_s2));
        let mut found = exchanged();
        let mut other = exchanged().corners.remove(0);
        other.label = "rl";
        found.corners.push(other);
        let doubts = found.doubts();
        assert!(doubts.len() == 1 && doubts[0].starts_with("fr rl: the body moves more"), "{doubts:?}");
    }

    #[test]
    fn a_body_of_another_wheel_is_named() {
        let state = std::cell::Cell::new(7);
        let random = || {
            let mut now = state.get();
            let value = noise(&mut now);
            state.set(now);
            value
        };
        let found = minute(0.0, |_, s| s.body_accel_m_s2 = random());
        let doubts = found.doubts();
        assert!(doubts.len() == 1 && doubts[0].contains("the body does not follow this wheel"), "{doubts:?}");
    }
}
