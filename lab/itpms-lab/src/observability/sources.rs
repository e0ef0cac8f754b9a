//! The four sources of information, alone and together: who passes over which road, and what that allows to know
//! (`docs/math/identifiability.md`, section 4).
//!
//! Called by the study. Two situations: a pressure that has always been what it is, and one that has fallen a while ago.

use std::fmt;

use itpms_core::model::{CornerConfig, ParameterError, QuarterCar};
use nalgebra::DMatrix;
use serde::Serialize;

use super::Subject;
use super::car::{CAR_PARAMETERS, CAR_SD};
use super::information::{self, Occurrence, Pass, RoadModel, Stretch};
use itpms_analysis::bound::BoundSetting;

itpms_core::labelled! {
    /// Where information about the stiffness can come from.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Source {
        /// (a) The road's spectrum is a power law.
        Spectrum = "a",
        /// (b) Front and rear wheel over the same road; a corner like the front one.
        Alike = "b",
        /// (b) The same with another unsprung mass at the rear.
        Unlike = "b'",
        Repeated = "c",
        /// (d) A known pressure at the start.
        Reset = "d",
        /// The road's height known everywhere: what no car has, for comparison.
        Survey = "road known",
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sources(&'static [Source]);

impl Sources {
    /// Alone and together, in the order of the tables.
    pub const ALL: [Sources; 15] = {
        use Source::{Alike, Repeated, Reset, Spectrum, Survey, Unlike};
        [
            Sources(&[Spectrum]),
            Sources(&[Alike]),
            Sources(&[Unlike]),
            Sources(&[Repeated]),
            Sources(&[Reset]),
            Sources(&[Spectrum, Alike]),
            Sources(&[Spectrum, Unlike]),
            Sources(&[Spectrum, Repeated]),
            Sources(&[Spectrum, Reset]),
            Sources(&[Alike, Reset]),
            Sources(&[Unlike, Reset]),
            Sources(&[Repeated, Reset]),
            Sources(&[Spectrum, Alike, Reset]),
            Sources(&[Spectrum, Alike, Repeated, Reset]),
            Sources(&[Survey]),
        ]
    };

    fn has(self, source: Source) -> bool {
        self.0.contains(&source)
    }

    pub fn text(self) -> &'static str {
        match self.to_string().as_str() {
            "a" => "the road's spectrum is a power law",
            "b" => "same road, front and rear alike",
            "b'" => "same road, rear wheel another one",
            "c" => "repeated road: its own past",
            "d" => "reset: known at the start",
            "a+b" | "a+b'" => "spectrum, and front and rear",
            "a+c" => "spectrum of a repeated road",
            "a+d" => "spectrum and reset",
            "b+d" | "b'+d" => "front and rear, and reset",
            "c+d" => "repeated road and reset",
            "a+b+d" => "what a car has on the road",
            "a+b+c+d" => "all four",
            _ => "no car has that; for comparison",
        }
    }
}

impl fmt::Display for Sources {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters: Vec<&str> = self.0.iter().map(|source| source.label()).collect();
        f.write_str(&letters.join("+"))
    }
}

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Situation {
        /// Always the same since the start; the time is that since the start.
        Constant = "constant",
        /// It fell a while after the start, in no time; the time is that since then.
        AfterLoss = "after-loss",
    }
}

itpms_core::labelled! {
    /// How well the car is known.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Car {
        Exact = "exact",
        /// As well as a vehicle file is believed: unsprung mass 1 %, sprung mass 15 %, damping 20 %, spring 5 % (sd), each
        /// corner's own. The tire's line from stiffness to pressure is known.
        AsFiled = "as-filed",
    }
}

// The parameters: pressure before, pressure after, the rear's; the two cars' own; then level and slope.
const BEFORE: usize = 0;
const AFTER: usize = 1;
const REAR: usize = 2;
const FRONT_CAR: usize = 3;
const REAR_CAR: usize = FRONT_CAR + CAR_PARAMETERS;
const PARAMETERS: usize = REAR_CAR + CAR_PARAMETERS + 2;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Circumstances {
    pub(super) drive: BoundSetting,
    /// Damping of both corners in N s/m; `None`: their own.
    pub(super) damping_n_s_per_m: Option<f64>,
    /// Share of the road's power that is not common to passes over one road.
    pub(super) incoherent: f64,
}

impl Circumstances {
    /// Those of the subject, on roads that are quite common.
    pub(super) fn of(subject: &Subject) -> Self {
        Self { drive: subject.drive, damping_n_s_per_m: None, incoherent: 0.0 }
    }
}

/// The bound of one corner and drive for one set of sources, ready for any time.
pub(super) struct SourceBound<'a> {
    subject: &'a Subject,
    sources: Sources,
    car: Car,
    circumstances: Circumstances,
    front: CornerConfig<f64>,
    rear: CornerConfig<f64>,
    /// Information of one second before and after the loss, on a road driven once.
    per_second: [DMatrix<f64>; 2],
}

impl<'a> SourceBound<'a> {
    /// Errors: a damping that is none.
    pub(super) fn new(
        subject: &'a Subject,
        sources: Sources,
        car: Car,
        circumstances: Circumstances,
    ) -> Result<Self, ParameterError> {
        let damping = circumstances.damping_n_s_per_m;
        let rear = if sources.has(Source::Unlike) { subject.unlike } else { subject.front };
        let mut bound = Self {
            subject,
            sources,
            car,
            circumstances,
            front: damped(&subject.front, damping)?,
            rear: damped(&rear, damping)?,
            per_second: [DMatrix::zeros(PARAMETERS, PARAMETERS), DMatrix::zeros(PARAMETERS, PARAMETERS)],
        };
        if !sources.has(Source::Repeated) {
            for (i, (before, after)) in [(1.0, 0.0), (0.0, 1.0)].into_iter().enumerate() {
                let stretch = bound.stretch(before, after);
                information::add(&mut bound.per_second[i], &stretch, model(sources), &circumstances.drive);
            }
        }
        Ok(bound)
    }

    /// Smallest sd in kPa of the front's pressure now, `seconds` after the start or the loss; infinite where nothing can be known.
    pub(super) fn sd_kpa(&self, situation: Situation, seconds: f64) -> f64 {
        let (before, after) = match situation {
            Situation::Constant => (seconds, 0.0),
            Situation::AfterLoss => (self.subject.before_s, seconds),
        };
        let mut sum = DMatrix::zeros(PARAMETERS, PARAMETERS);
        if self.sources.has(Source::Repeated) {
            let stretch = self.stretch(before, after);
            information::add(&mut sum, &stretch, model(self.sources), &self.circumstances.drive);
        } else {
            sum += &self.per_second[0] * before + &self.per_second[1] * after;
        }
        if self.sources.has(Source::Reset) {
            for pinned in [BEFORE, REAR] {
                sum[(pinned, pinned)] += self.subject.reset_sd_kpa.powi(-2);
            }
        }
        if self.car == Car::AsFiled {
            for start in [FRONT_CAR, REAR_CAR] {
                for (i, sd) in CAR_SD.iter().enumerate() {
                    sum[(start + i, start + i)] += sd.powi(-2);
                }
            }
        }
        let mut wanted = [0.0; PARAMETERS];
        wanted[match situation {
            Situation::Constant => BEFORE,
            Situation::AfterLoss => AFTER,
        }] = 1.0;
        information::variance(&sum, &wanted).sqrt()
    }

    /// The road that all of them drive on.
    fn stretch(&self, before: f64, after: f64) -> Stretch {
        let passes = self.passes(before, after);
        let occurrence = match self.sources.has(Source::Repeated) {
            true => Occurrence::Repeated(self.subject.period_s),
            false => Occurrence::Once,
        };
        // A wheel that shares its road with none has all of it for itself.
        let incoherent = if passes.len() > 1 { self.circumstances.incoherent } else { 0.0 };
        Stretch { passes, occurrence, incoherent }
    }

    /// Who drives there, and how long; wheels that do not drive are left out.
    fn passes(&self, before: f64, after: f64) -> Vec<Pass> {
        let full = self.front.placard_kpa;
        let low = full * (1.0 - self.subject.loss);
        let (front, rear) = match self.car {
            Car::Exact => (None, None),
            Car::AsFiled => (Some(FRONT_CAR), Some(REAR_CAR)),
        };
        let mut passes = vec![
            Pass { corner: self.front, pressure_kpa: full, parameter: BEFORE, car: front, seconds: before },
            Pass { corner: self.front, pressure_kpa: low, parameter: AFTER, car: front, seconds: after },
        ];
        if self.sources.has(Source::Alike) || self.sources.has(Source::Unlike) {
            let pressure_kpa = self.rear.placard_kpa;
            let seconds = before + after;
            passes.push(Pass { corner: self.rear, pressure_kpa, parameter: REAR, car: rear, seconds });
        }
        passes.retain(|pass| pass.seconds > 0.0);
        passes
    }
}

fn model(sources: Sources) -> RoadModel {
    if sources.has(Source::Survey) {
        RoadModel::Surveyed
    } else if sources.has(Source::Spectrum) {
        RoadModel::PowerLaw
    } else {
        RoadModel::Free
    }
}

fn damped(corner: &CornerConfig<f64>, damping: Option<f64>) -> Result<CornerConfig<f64>, ParameterError> {
    let Some(damping) = damping else { return Ok(*corner) };
    let car = &corner.quarter_car;
    let quarter_car =
        QuarterCar::new(car.sprung_mass_kg(), car.unsprung_mass_kg(), damping, car.spring_n_per_m())?;
    Ok(CornerConfig { quarter_car, ..*corner })
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_analysis::bound::CornerBound;

    fn bound<'a>(
        subject: &'a Subject,
        label: &str,
        car: Car,
        circumstances: Circumstances,
    ) -> SourceBound<'a> {
        let sources = Sources::ALL.into_iter().find(|sources| sources.to_string() == label).unwrap();
        SourceBound::new(subject, sources, car, circumstances).unwrap()
    }

    fn sd(label: &str, situation: Situation, seconds: f64) -> f64 {
        let subject = Subject::paper();
        bound(&subject, label, Car::Exact, Circumstances::of(&subject)).sd_kpa(situation, seconds)
    }

    fn quiet(subject: &Subject) -> Circumstances {
        let drive = BoundSetting { accel_noise_m_s2: 1e-3, ..subject.drive };
        Circumstances { drive, ..Circumstances::of(subject) }
    }

    #[test]
    fn a_road_that_is_not_quite_common_limits_comparing() {
        let subject = Subject::paper();
        let with = |label: &str, incoherent: f64| {
            let circumstances = Circumstances { incoherent, ..quiet(&subject) };
            bound(&subject, label, Car::Exact, circumstances).sd_kpa(Situation::AfterLoss, 8.0)
        };
        // Sensors without noise: what is not common is the only noise, so ten times the share is ten times the variance
        // as long as it is small.
        let ratio = with("b", 1e-3) / with("b", 1e-4);
        assert!((ratio / 10f64.sqrt() - 1.0).abs() < 0.02, "{ratio}");
        // One wheel alone does not care.
        assert_eq!(with("a", 0.1), with("a", 0.0));
    }

    #[test]
    fn alone_each_source_knows_what_it_can() {
        use Situation::{AfterLoss, Constant};
        let corner = CornerBound::new(&CornerConfig::paper(), &BoundSetting::paper()).unwrap();
        assert!((sd("a", Constant, 8.0) / corner.sd_kpa(8.0, 241.3) - 1.0).abs() < 1e-9);
        // Corners alike with the same pressure, a repetition without a change, a reset long past: nothing.
        assert!(sd("b", Constant, 40.0).is_infinite());
        assert!(sd("c", Constant, 40.0).is_infinite());
        assert!((sd("d", Constant, 40.0) - Subject::paper().reset_sd_kpa).abs() < 1e-9);
        assert!(sd("d", AfterLoss, 40.0).is_infinite());
        // Unlike corners, or a pressure that has changed: something.
        for (label, situation) in [("b'", Constant), ("b", AfterLoss), ("c", AfterLoss)] {
            assert!(sd(label, situation, 40.0).is_finite(), "{label}");
        }
    }

    #[test]
    fn more_information_is_never_worse_and_time_helps() {
        for situation in Situation::ALL {
            for (less, more) in [
                ("a", "a+b"),
                ("b", "a+b"),
                ("a", "a+d"),
                ("b", "b+d"),
                ("c", "a+c"),
                ("c", "c+d"),
                ("a+b", "a+b+d"),
                ("c+d", "a+b+c+d"),
                ("b'", "a+b'"),
            ] {
                let (less, more) = (sd(less, situation, 8.0), sd(more, situation, 8.0));
                assert!(more <= less * (1.0 + 1e-9), "{situation:?}: {less} {more}");
            }
            for sources in Sources::ALL {
                let label = sources.to_string();
                let (early, late) = (sd(&label, situation, 2.0), sd(&label, situation, 40.0));
                assert!(late <= early * (1.0 + 1e-9), "{label}: {early} {late}");
            }
        }
    }

    #[test]
    fn an_uncertain_car_is_as_uncertain_as_its_scale() {
        // Masses, damper, spring and tire all stiffer by one factor move alike: the factor is known from the priors alone,
        // sd 1 / sqrt(sum of their 1/sd²), and everything else from a road known to the millimeter.
        let subject = Subject::paper();
        let quiet = quiet(&subject);
        let at = |label: &str, situation| bound(&subject, label, Car::AsFiled, quiet).sd_kpa(situation, 40.0);
        let scale = [0.01f64, 0.15, 0.20, 0.05].iter().map(|sd| sd.powi(-2)).sum::<f64>();
        let stiffness = |kpa: f64| 713.91 * kpa + 60_880.0;
        let expected = stiffness(241.3) / scale.sqrt() / 713.91;
        let found = at("road known", Situation::Constant);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        // A reset measures the scale, too: sd over 241.3 kPa's stiffness. It is what is left at the lower one.
        let reset = subject.reset_sd_kpa * 713.91 / stiffness(241.3);
        let expected = stiffness(0.8 * 241.3) / (scale + reset.powi(-2)).sqrt() / 713.91;
        let found = at("c+d", Situation::AfterLoss);
        assert!((found / expected - 1.0).abs() < 1e-2, "{found} {expected}");
    }

    #[test]
    fn two_resets_of_corners_alike_are_worth_the_root_of_two() {
        // Without noise the difference is known; without a loss nothing else is. The mean of two gauges remains.
        let subject = Subject { loss: 1e-9, ..Subject::paper() };
        let bound = bound(&subject, "b+d", Car::Exact, quiet(&subject));
        let found = bound.sd_kpa(Situation::AfterLoss, 60.0);
        assert!((found / (subject.reset_sd_kpa / 2f64.sqrt()) - 1.0).abs() < 1e-2, "{found}");
    }
}
