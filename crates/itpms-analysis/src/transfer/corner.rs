//! A corner's response against its file's: what damper and spring it shows, and what to change. Called by the binary, read by `page`.

use std::f64::consts::TAU;

use itpms_core::model::{BodyFit, Misfit};
use itpms_fourier::Complex;

use super::cross::{Bin, CrossSpectra, FEWEST_SEGMENTS, INCOHERENT};

/// Where a suspension shows in Hz: below, the body moves as the wheel does; above, it bends.
const LOW_HZ: f64 = 2.0;
const HIGH_HZ: f64 = 25.0;
/// Where damper and spring are looked at in Hz.
const FIT_HZ: (f64, f64) = (2.0, 16.0);
/// Relative error of a comparison beside its noise: the four corners of a car share a body, which a quarter car leaves out. A
/// simulated whole car reads its own damping within this.
const COUPLING: f64 = 0.1;
/// How many standard deviations apart is another value.
const APART: f64 = 2.0;

/// The file's parameters of a corner's suspension, with relative standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Suspension {
    pub sprung_mass_kg: f64,
    pub damping_n_s_per_m: f64,
    pub spring_n_per_m: f64,
    pub sprung_mass_relative_sd: f64,
    pub damping_relative_sd: f64,
    pub spring_relative_sd: f64,
}

impl Suspension {
    /// `H = (c s + k) / (m s² + c s + k)` with `s = j 2 pi f`, each parameter times a factor.
    fn response(&self, hz: f64, [m, c, k]: [f64; 3]) -> Complex<f64> {
        let s = Complex::new(0.0, TAU * hz);
        let strut = s * (c * self.damping_n_s_per_m) + k * self.spring_n_per_m;
        strut / (s * s * (m * self.sprung_mass_kg) + strut)
    }

    /// Size of the response, and the least and most it has within a standard deviation of all three.
    fn gain(&self, hz: f64) -> (f64, f64, f64) {
        let sds = [self.sprung_mass_relative_sd, self.damping_relative_sd, self.spring_relative_sd];
        let signs =
            (0..8).map(|i| std::array::from_fn(|j| 1.0 + if i >> j & 1 == 0 { -sds[j] } else { sds[j] }));
        let all = signs.map(|factors: [f64; 3]| self.response(hz, factors).norm());
        let (low, high) =
            all.fold((f64::INFINITY, 0.0f64), |(low, high), gain| (low.min(gain), high.max(gain)));
        (self.response(hz, [1.0; 3]).norm(), low, high)
    }
}

/// The report on motion that [`no_suspension_allows`].
pub(crate) const AGAINST: &str = "body and wheel move against each other as no damper and no spring lets them: a sensor is upside down, or the columns of body and wheel are exchanged";

/// Whether the damper would be negative beyond its error, whatever the mass: the body answers its wheel late, and one sensor turned over makes
/// of that early. Not where the body does not follow the wheel.
pub(crate) fn no_suspension_allows(spectra: &CrossSpectra) -> bool {
    let of_one = Suspension {
        sprung_mass_kg: 1.0,
        damping_n_s_per_m: 1.0,
        spring_n_per_m: 1.0,
        sprung_mass_relative_sd: 0.0,
        damping_relative_sd: 0.0,
        spring_relative_sd: 0.0,
    };
    CornerCheck::of("", spectra, of_one).is_against()
}

#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Less than half a minute of driving.
    TooShort,
    /// The body does not follow this wheel; mean coherence.
    Incoherent(f64),
    /// Damping and spring over the file's, each with its standard error; for the mass of the file.
    Compared {
        /// Damping over the file's.
        damping: (f64, f64),
        /// Spring over the file's.
        spring: (f64, f64),
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct CornerCheck {
    /// `fl`, `fr`, `rl` or `rr`.
    pub label: String,
    pub suspension: Suspension,
    pub verdict: Verdict,
    /// Mean coherence between 4 and 16 Hz.
    pub coherence: f64,
    /// What the estimator says after the whole drive of how body and wheel go together, and what does not, where it ran.
    pub fit: Option<(BodyFit<f64>, Option<Misfit>)>,
    /// What its monitor reports of a broken sensor: then the others say nothing of damper and spring.
    pub broken: Option<String>,
    bins: Vec<Bin>,
}

impl CornerCheck {
    /// Compares a measured response with the file's.
    pub fn of(label: &str, spectra: &CrossSpectra, suspension: Suspension) -> Self {
        let bins = spectra.response(LOW_HZ, HIGH_HZ);
        let coherence = spectra.coherence();
        let verdict = if spectra.segments() < FEWEST_SEGMENTS {
            Verdict::TooShort
        } else if !(coherence > INCOHERENT) {
            Verdict::Incoherent(coherence)
        } else {
            compared(&bins, &suspension)
        };
        Self { label: label.to_owned(), suspension, verdict, coherence, fit: None, broken: None, bins }
    }

    /// See [`no_suspension_allows`]. The spring is no witness: it shows little above the body's bounce, and what the corners share there
    /// may make it negative in a healthy log.
    fn is_against(&self) -> bool {
        matches!(self.verdict, Verdict::Compared { damping: (mean, error), .. } if mean < -APART * error)
    }

    /// The finding and the remedy, in a sentence.
    pub fn sentence(&self) -> String {
        match &self.verdict {
            Verdict::TooShort => {
                "Less than half a minute without a gap: drive longer on a rough road".to_owned()
            }
            Verdict::Incoherent(coherence) => format!(
                "The body does not follow this wheel (coherence {coherence:.2} between 4 and 16 Hz, expected 0.5 or more): check that its body sensor sits above this wheel and that the columns are those of this corner; damper and spring are not judged"
            ),
            Verdict::Compared { damping, spring } => self.compared_sentence(*damping, *spring),
        }
    }

    /// What does not fit beside damper and spring, in a sentence without its full stop. Where these are not judged, the sentence
    /// on them has named the reason.
    pub fn misfit(&self) -> Option<String> {
        let misfit = self.fit.as_ref()?.1?;
        matches!(self.verdict, Verdict::Compared { .. }).then(|| misfit.to_string())
    }

    /// Whether something in the file should be changed, or nothing is judged.
    pub fn asks_for_change(&self) -> bool {
        match &self.verdict {
            Verdict::TooShort | Verdict::Incoherent(_) => true,
            Verdict::Compared { damping, spring } => {
                let s = &self.suspension;
                self.is_against()
                    || self.broken.is_some()
                    || apart(*damping, s.damping_relative_sd)
                    || apart(*spring, s.spring_relative_sd)
                    || self.misfit().is_some()
            }
        }
    }

    fn compared_sentence(&self, damping: (f64, f64), spring: (f64, f64)) -> String {
        if self.is_against() {
            return format!("Damper and spring are not judged: {AGAINST}");
        }
        if let Some(broken) = &self.broken {
            return format!("Damper and spring are not judged: {broken}");
        }
        let s = &self.suspension;
        let part = |name: &str, key: &str, value: f64, sd: f64, (ratio, error): (f64, f64)| {
            if !(ratio > 0.0) {
                format!("{name} does not show in this drive and is not judged")
            } else if apart((ratio, error), sd) {
                format!(
                    "{name} is {ratio:.2} ± {error:.2} times the file's: set {key} to {:.0}",
                    ratio * value
                )
            } else {
                format!("{name} is {ratio:.2} ± {error:.2} times the file's: agrees {}", allowed(ratio, sd))
            }
        };
        let damping =
            part("Damping", "damping_n_s_per_m", s.damping_n_s_per_m, s.damping_relative_sd, damping);
        let spring = part("spring", "spring_n_per_m", s.spring_n_per_m, s.spring_relative_sd, spring);
        format!("{damping}; {spring}")
    }

    /// (Hz, measured gain, its standard error), bin by bin.
    pub fn measured(&self) -> Vec<(f64, f64, f64)> {
        let gain = |bin: &Bin| bin.response.norm();
        self.bins.iter().map(|bin| (bin.hz, gain(bin), bin.relative_error * gain(bin))).collect()
    }

    /// (Hz, coherence), bin by bin.
    pub fn coherences(&self) -> Vec<(f64, f64)> {
        self.bins.iter().map(|bin| (bin.hz, bin.coherence)).collect()
    }

    /// (Hz, the file's gain, least, most).
    pub fn of_file(&self) -> Vec<(f64, (f64, f64, f64))> {
        let hz = |i: i32| LOW_HZ * (HIGH_HZ / LOW_HZ).powf(f64::from(i) / 100.0);
        (0..=100).map(hz).map(|hz| (hz, self.suspension.gain(hz))).collect()
    }
}

fn within(bins: &[Bin], (low, high): (f64, f64)) -> impl Iterator<Item = &Bin> {
    bins.iter().filter(move |bin| (low..=high).contains(&bin.hz))
}

/// Whether a ratio differs from one by more than its error and the file's deviation allow. One that no part has shows none.
fn apart((ratio, error): (f64, f64), sd: f64) -> bool {
    ratio > 0.0 && (ratio - 1.0).abs() > APART * error.hypot(sd)
}

/// What allows a ratio that is not apart: the deviation that the file states, in words.
fn allowed(ratio: f64, sd: f64) -> String {
    let (off, percent) = ((ratio - 1.0).abs(), 100.0 * sd);
    if off <= sd {
        format!("within the ±{percent:.0} % that the file states")
    } else if off <= APART * sd {
        format!("within twice the ±{percent:.0} % that the file states")
    } else {
        format!("within this drive's error and the ±{percent:.0} % that the file states")
    }
}

/// The dynamic stiffness `Z = m s² H / (1 - H) = c s + k`: its imaginary part shows the damper, its real part the spring. Bins
/// weigh by what is known of them: `dZ/dH = m s² / (1 - H)²`.
fn compared(bins: &[Bin], suspension: &Suspension) -> Verdict {
    let (mut damping, mut spring) = (Weighted::default(), Weighted::default());
    for bin in within(bins, FIT_HZ) {
        let s = Complex::new(0.0, TAU * bin.hz);
        let rest = Complex::new(1.0, 0.0) - bin.response;
        let inertia = s * s * suspension.sprung_mass_kg;
        let stiffness = inertia * bin.response / rest;
        let error = bin.relative_error * bin.response.norm() * (inertia / (rest * rest)).norm();
        let w = TAU * bin.hz;
        damping.add(stiffness.im / w, error / w);
        spring.add(stiffness.re, error);
    }
    let over = |part: &Weighted, value: f64| {
        let (mean, error) = part.mean();
        (mean / value, (error / value).hypot(COUPLING * mean / value))
    };
    Verdict::Compared {
        damping: over(&damping, suspension.damping_n_s_per_m),
        spring: over(&spring, suspension.spring_n_per_m),
    }
}

/// A weighted mean whose error grows with the scatter about it.
#[derive(Default)]
struct Weighted {
    values: Vec<(f64, f64)>,
}

impl Weighted {
    fn add(&mut self, value: f64, error: f64) {
        if value.is_finite() && error > 0.0 && error.is_finite() {
            self.values.push((value, error.powi(-2)));
        }
    }

    fn mean(&self) -> (f64, f64) {
        let total: f64 = self.values.iter().map(|(_, w)| w).sum();
        let mean = self.values.iter().map(|(v, w)| v * w).sum::<f64>() / total;
        let chi: f64 = self.values.iter().map(|(v, w)| w * (v - mean).powi(2)).sum();
        let scatter = (chi / (self.values.len() as f64 - 1.0).max(1.0)).max(1.0);
        (mean, (scatter / total).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body that answers its wheel with these parameters, at 200 Hz for two minutes: the wheel is noise below 30 Hz.
    fn driven(damping: f64, spring: f64, noise: f64) -> CrossSpectra {
        driven_as(damping, spring, noise, 1.0)
    }

    /// The same with the sensor of the body `turned`: 1, or -1 for upside down.
    fn driven_as(damping: f64, spring: f64, noise: f64, turned: f64) -> CrossSpectra {
        let (m, step) = (300.0, 0.005);
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
        };
        let mut spectra = CrossSpectra::new(step);
        let (mut slow, mut x, mut v) = ([0.0f64; 2], 0.0, 0.0);
        for _ in 0..24_000 {
            let white = 5.0 * random();
            // Ten steps of Euler's symplectic method for each sample.
            let mut body = 0.0;
            for _ in 0..10 {
                slow[0] += 0.1 * 0.6 * (white - slow[0]);
                slow[1] += 0.1 * 0.6 * (slow[0] - slow[1]);
                // Relative motion: x'' = a_w - a_b, a_b = (c x' + k x)/m.
                body = (damping * v + spring * x) / m;
                v += 0.1 * step * (slow[1] - body);
                x += 0.1 * step * v;
            }
            spectra.push(slow[1] + noise * random(), turned * body + noise * random());
        }
        spectra
    }

    fn suspension(damping: f64, spring: f64) -> Suspension {
        Suspension {
            sprung_mass_kg: 300.0,
            damping_n_s_per_m: damping,
            spring_n_per_m: spring,
            sprung_mass_relative_sd: 0.05,
            damping_relative_sd: 0.1,
            spring_relative_sd: 0.1,
        }
    }

    #[test]
    fn a_sensor_upside_down_is_detected_whatever_the_mass() {
        for (turned, expected) in [(1.0, false), (-1.0, true)] {
            let spectra = driven_as(1_500.0, 22_000.0, 0.02, turned);
            assert_eq!(no_suspension_allows(&spectra), expected);
            let sentence = CornerCheck::of("fl", &spectra, suspension(1_500.0, 22_000.0)).sentence();
            assert_eq!(sentence.contains(AGAINST), expected, "{sentence}");
        }
    }

    #[test]
    fn a_negative_spring_is_not_judged_and_accuses_no_sensor() {
        let spectra = driven(1_500.0, 22_000.0, 0.02);
        let mut check = CornerCheck::of("fl", &spectra, suspension(1_500.0, 22_000.0));
        check.verdict = Verdict::Compared { damping: (1.05, 0.1), spring: (-0.4, 0.15) };
        let sentence = check.sentence();
        assert!(!check.asks_for_change(), "{sentence}");
        assert!(sentence.ends_with("spring does not show in this drive and is not judged"), "{sentence}");
    }

    #[test]
    fn a_damper_that_is_not_the_files_is_named_with_its_value() {
        let spectra = driven(1_500.0, 22_000.0, 0.02);
        let check = CornerCheck::of("fl", &spectra, suspension(1_500.0, 22_000.0));
        assert!(!check.asks_for_change(), "{}", check.sentence());
        let Verdict::Compared { damping, .. } = check.verdict else { panic!("{check:?}") };
        assert!((damping.0 - 1.0).abs() < 0.1, "{damping:?}");
        // The file knows the damper to 10 %.
        assert!(
            check
                .sentence()
                .contains("times the file's: agrees within the ±10 % that the file states; spring is"),
            "{}",
            check.sentence()
        );
        let check = CornerCheck::of("fl", &spectra, suspension(1_000.0, 22_000.0));
        assert!(check.asks_for_change());
        let Verdict::Compared { damping, .. } = check.verdict else { panic!("{check:?}") };
        assert!((damping.0 - 1.5).abs() < 0.15, "{damping:?}");
        assert!(check.sentence().contains("set damping_n_s_per_m to 1"), "{}", check.sentence());
    }

    #[test]
    fn what_hides_a_wrong_value_is_reported() {
        let spectra = driven(1_500.0, 22_000.0, 0.02);
        let wide = |sd: f64, file: f64| Suspension { damping_relative_sd: sd, ..suspension(file, 22_000.0) };
        // Dampers of three quarters of the file's, which knows them to 30 %; of two thirds, to 20 %.
        for (sd, file, words) in [
            (0.3, 2_000.0, "within the ±30 % that the file states"),
            (0.2, 2_250.0, "within twice the ±20 % that the file states"),
        ] {
            let check = CornerCheck::of("fl", &spectra, wide(sd, file));
            assert!(!check.asks_for_change(), "{}", check.sentence());
            assert!(check.sentence().contains(words), "{}", check.sentence());
        }
    }

    #[test]
    fn a_body_that_follows_another_wheel_is_incoherent_and_a_short_drive_says_nothing() {
        let check = CornerCheck::of("rr", &driven(1_500.0, 22_000.0, 20.0), suspension(1_500.0, 22_000.0));
        assert!(matches!(check.verdict, Verdict::Incoherent(_)), "{check:?}");
        assert!(check.sentence().contains("body does not follow this wheel"));
        let check = CornerCheck::of("rr", &CrossSpectra::new(0.01), suspension(1_500.0, 22_000.0));
        assert_eq!(check.verdict, Verdict::TooShort);
    }
}
