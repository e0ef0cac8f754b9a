//! Why two accelerations leave the stiffness free, and what fixes it (`docs/math/identifiability.md`).
//!
//! Called by `itpms lab observability` and by the page about the paper. Needs no drive: masses, springs and dampers are
//! enough. It must never be asked for an estimate; it says what any estimator could know.
//!
//! | module | idea |
//! |---|---|
//! | `twin` | two tires, two roads, one measurement: the proof, driven |
//! | `rank`, `motion`, `dual` | the observability matrix with the road as unknown input |
//! | `subject` | which corner on which drive |
//! | `information` | Fisher information of wheels that pass over the same road |
//! | `car` | what an uncertain mass, spring or damper does to the accelerations |
//! | `sources` | which wheel passes where: the four sources, alone and together |
//! | `figures`, `summary`, `page` | the result drawn, in words, and as HTML |

mod car;
mod dual;
mod figures;
mod information;
mod motion;
mod page;
mod rank;
mod sources;
mod subject;
mod summary;
mod twin;

pub use rank::{RankCase, Stiffness, TOLERANCE};
pub use sources::{Car, Situation, Source, Sources};
pub use subject::Subject;
pub use twin::{Twin, Twins};

use std::ops::ControlFlow;

use rayon::prelude::*;
use serde::Serialize;

use crate::runner::{Result, StudyError};
use sources::{Circumstances, SourceBound};

/// The least sd over time for one set of sources.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Which sources: `a`, `b'`, `a+d`, ...
    pub sources: String,
    pub words: &'static str,
    pub situation: Situation,
    pub car: Car,
    /// (time in s, sd in kPa); infinite (`null` in JSON) where nothing can be known. (value, sd in kPa).
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// The sd in kPa at a time that is one of the curve's, else NaN.
    pub fn at(&self, seconds: f64) -> f64 {
        self.points.iter().find(|(t, _)| (t - seconds).abs() < 1e-9).map_or(f64::NAN, |&(_, sd)| sd)
    }
}

itpms_core::labelled! {
    /// The varied parameter of a sweep; everything else stays.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Varied {
        SpeedKmH = "speed_km_h",
        DampingNSPerM = "damping_n_s_per_m",
        /// Noise of every accelerometer in m/s², rms per sample.
        NoiseMS2 = "noise_m_s2",
        /// Share of the road's power that is not common to passes over one road: tracks beside each other.
        IncoherentShare = "incoherent_share",
    }
}

impl Varied {
    fn values(self) -> &'static [f64] {
        match self {
            Varied::SpeedKmH => &[20.0, 30.0, 40.0, 60.0, 80.0, 100.0, 120.0],
            Varied::DampingNSPerM => &[300.0, 500.0, 750.0, 1000.0, 1500.0, 2000.0, 3000.0],
            Varied::NoiseMS2 => &[0.02, 0.035, 0.05, 0.1, 0.2, 0.35, 0.5],
            Varied::IncoherentShare => &[1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1],
        }
    }
}

/// The least sd for one set of sources over one circumstance, at [`SWEEP_S`] after the loss.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    pub varied: Varied,
    pub sources: String,
    pub car: Car,
    pub points: Vec<(f64, f64)>,
}

/// When a sweep looks, in s after the loss.
pub const SWEEP_S: f64 = 8.0;
/// When the curves are looked at, in s; the tables take 2, 8 and 40.
const TIMES_S: [f64; 15] = [0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 16.0, 22.0, 32.0, 40.0, 60.0];

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Observability {
    pub vehicle: String,
    pub corner: String,
    pub conditions: Conditions,
    pub twins: Twins,
    pub ranks: Vec<RankCase>,
    pub curves: Vec<Curve>,
    /// Bounds over speed, damping, noise and the road's incoherent share.
    pub sweeps: Vec<Sweep>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Conditions {
    pub placard_kpa: f64,
    pub pressure_after_kpa: f64,
    pub stiffness_n_per_m: f64,
    /// Time at placard pressure before the loss in s.
    pub before_s: f64,
    pub speed_km_h: f64,
    pub road_level_m3: f64,
    pub road_slope: f64,
    pub noise_m_s2: f64,
    pub rate_hz: f64,
    pub band_hz: (f64, f64),
    pub damping_n_s_per_m: f64,
    pub period_s: f64,
    pub reset_sd_kpa: f64,
    /// Unsprung masses in kg of the corner and of the unlike one (b').
    pub unsprung_masses_kg: (f64, f64),
    pub unlike_is_made_up: bool,
}

/// The whole study of one corner: some seconds. `look` is called now and then with the share done and may stop it.
pub fn study(subject: &Subject, look: &(dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Result<Observability> {
    subject.drive.check()?;
    let go_on = |share: f64| if look(share).is_break() { Err(StudyError::Stopped) } else { Ok(()) };
    go_on(0.0)?;
    let twins = Twins::drive(&subject.front, &subject.drive);
    go_on(0.1)?;
    let ranks = rank::cases(&subject.front, &subject.unlike);
    go_on(0.2)?;
    let found: Result<Vec<_>> = Sources::ALL
        .par_iter()
        .map(|&sources| {
            go_on(0.3)?;
            Ok((curves(subject, sources)?, sweeps(subject, sources)?))
        })
        .collect();
    let (curves, sweeps): (Vec<_>, Vec<_>) = found?.into_iter().unzip();
    go_on(1.0)?;
    Ok(Observability {
        vehicle: subject.vehicle.clone(),
        corner: subject.corner.clone(),
        conditions: conditions(subject),
        twins,
        ranks,
        curves: curves.into_iter().flatten().collect(),
        sweeps: sweeps.into_iter().flatten().collect(),
    })
}

fn curves(subject: &Subject, sources: Sources) -> Result<Vec<Curve>> {
    let mut curves = Vec::new();
    for car in Car::ALL {
        let bound = SourceBound::new(subject, sources, car, Circumstances::of(subject))?;
        curves.extend(Situation::ALL.map(|situation| Curve {
            sources: sources.to_string(),
            words: sources.text(),
            situation,
            car,
            points: TIMES_S.iter().map(|&t| (t, bound.sd_kpa(situation, t))).collect(),
        }));
    }
    Ok(curves)
}

fn sweeps(subject: &Subject, sources: Sources) -> Result<Vec<Sweep>> {
    let mut sweeps = Vec::new();
    for (varied, car) in Varied::ALL.into_iter().flat_map(|varied| Car::ALL.map(|car| (varied, car))) {
        let point = |&value: &f64| {
            let mut here = Circumstances::of(subject);
            match varied {
                Varied::SpeedKmH => here.drive.speed_m_s = value / 3.6,
                Varied::DampingNSPerM => here.damping_n_s_per_m = Some(value),
                Varied::NoiseMS2 => here.drive.accel_noise_m_s2 = value,
                Varied::IncoherentShare => here.incoherent = value,
            }
            let bound = SourceBound::new(subject, sources, car, here)?;
            Ok((value, bound.sd_kpa(Situation::AfterLoss, SWEEP_S)))
        };
        let points = varied.values().iter().map(point).collect::<Result<Vec<_>>>()?;
        sweeps.push(Sweep { varied, sources: sources.to_string(), car, points });
    }
    Ok(sweeps)
}

fn conditions(subject: &Subject) -> Conditions {
    let (front, drive) = (&subject.front, &subject.drive);
    Conditions {
        placard_kpa: front.placard_kpa,
        pressure_after_kpa: front.placard_kpa * (1.0 - subject.loss),
        stiffness_n_per_m: front.tire.stiffness_n_per_m(front.placard_kpa),
        before_s: subject.before_s,
        speed_km_h: drive.speed_m_s * 3.6,
        road_level_m3: drive.road.gd_n0_m3,
        road_slope: drive.road.waviness,
        noise_m_s2: drive.accel_noise_m_s2,
        rate_hz: drive.rate_hz,
        band_hz: drive.band_hz,
        damping_n_s_per_m: front.quarter_car.damping_n_s_per_m(),
        period_s: subject.period_s,
        reset_sd_kpa: subject.reset_sd_kpa,
        unsprung_masses_kg: (
            front.quarter_car.unsprung_mass_kg(),
            subject.unlike.quarter_car.unsprung_mass_kg(),
        ),
        unlike_is_made_up: subject.unlike_is_made_up,
    }
}

impl Observability {
    pub fn curve(&self, sources: &str, situation: Situation, car: Car) -> Option<&Curve> {
        let wanted = |c: &&Curve| c.sources == sources && c.situation == situation && c.car == car;
        self.curves.iter().find(wanted)
    }

    /// The sweep of these sources over this circumstance with this car.
    pub fn sweep(&self, sources: &str, varied: Varied, car: Car) -> Option<&Sweep> {
        self.sweeps.iter().find(|s| s.sources == sources && s.varied == varied && s.car == car)
    }
}

#[cfg(test)]
fn rear() -> itpms_core::model::CornerConfig<f64> {
    let quarter_car = itpms_core::model::QuarterCar::new(216.0, 50.0, 925.8, 29_114.0).unwrap();
    itpms_core::model::CornerConfig { quarter_car, ..itpms_core::model::CornerConfig::paper() }
}
