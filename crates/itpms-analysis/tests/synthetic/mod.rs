//! A drive as an estimator might have given it: no physics, only curves of the right shape, so that the report can be
//! tested and looked at without one.

use itpms_analysis::report::{CornerRow, Parameter, Provenance, ReportCollector, ReportData, ReportOptions};
use itpms_core::model::{CornerConfig, CornerEstimate, Diagnostics, Level, Validity, Warning};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// How long, how fast sampled, and which corners.
pub(crate) struct Drive {
    pub(crate) seconds: f64,
    pub(crate) rate_hz: f64,
    pub(crate) corners: usize,
    pub(crate) truth_known: bool,
}

/// One tire: truth, and an estimate that follows it with a delay and an honest sd.
struct Tire {
    wander: f64,
    level: f64,
    frame: (f64, f64),
    low: bool,
}

fn normal(rng: &mut Pcg64) -> f64 {
    (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
}

/// A road of class A as a sum of 400 sines from 0.02 to 6 cycles/m, w = 2.
fn road(x: f64) -> f64 {
    let step = 300f64.ln() / 400.0;
    (0..400)
        .map(|k| {
            let n = 0.02 * (f64::from(k) * step).exp();
            let amplitude = (2.0 * 16e-6 * (n / 0.1).powi(-2) * n * step).sqrt();
            amplitude * (std::f64::consts::TAU * n * x + f64::from(k * k) * 2.4).sin()
        })
        .sum()
}

fn pressure(corner: usize, t: f64) -> f64 {
    let drop = 103.4 * ((t - 20.0) / 2.5).clamp(0.0, 1.0);
    [241.3 - drop, 236.0, 228.5, 240.0][corner]
}

impl Tire {
    fn estimate(
        &mut self,
        t: f64,
        dt: f64,
        truth: f64,
        driving: bool,
        rng: &mut Pcg64,
    ) -> CornerEstimate<f64> {
        let since_drop = t - 20.0;
        let changing = self.level - truth > 12.0;
        let sd = if (0.0..6.0).contains(&since_drop) && truth < 200.0 {
            8.0 + 14.0 * (-0.5 * since_drop).exp()
        } else {
            6.0 + 22.0 * (-t / 6.0).exp()
        };
        self.level += (truth - self.level) * dt / 0.8;
        self.wander += -self.wander * dt / 1.5 + (2.0 * dt / 1.5).sqrt() * normal(rng);
        if (t * 10.0).floor() != ((t - dt) * 10.0).floor() {
            // Twelve exponential values a frame.
            self.frame.0 = (0..12).map(|_| -rng.random::<f64>().ln()).sum::<f64>() / 12.0;
            self.frame.1 = if driving { (0.93 + 0.1 * normal(rng)).clamp(0.2, 1.0) } else { 0.0 };
        }
        let pressure_kpa = self.level + 0.9 * sd * self.wander;
        self.low |= pressure_kpa + 2.0 * sd < 0.8 * 241.3;
        CornerEstimate {
            time_s: t,
            stiffness_n_per_m: 713.91 * pressure_kpa + 60_880.0,
            stiffness_sd_n_per_m: 713.91 * sd,
            pressure_kpa,
            pressure_sd_kpa: sd,
            change_sd_kpa: sd,
            axle_difference_sd_kpa: None,
            loss: None,
            cold: None,
            level: Level::Calibration,
            road_m: 0.0,
            road_sd_m: 4e-4,
            validity: match (t < 1.5, driving) {
                (true, _) => Validity::Starting,
                (_, true) => Validity::Valid,
                (_, false) => Validity::NoInformation,
            },
            warning: if self.low { Warning::Low } else { Warning::None },
            diagnostics: Diagnostics {
                forgetting: if changing { 1.6 } else { 1.0 + 0.02 * rng.random::<f64>() },
                nis: self.frame.0 * if changing { 2.2 } else { 1.0 },
                gate: self.frame.1,
                change_probability: if changing { 0.9 } else { 0.04 * rng.random::<f64>() },
                pressure_variance_kpa2: sd * sd,
            },
        }
    }
}

/// The drive's report. `name` is the vehicle's, as hostile as the test likes.
pub(crate) fn report(drive: &Drive, name: &str) -> ReportData {
    let mut rng = Pcg64::seed_from_u64(11);
    let mut configs = [None; 4];
    configs[..drive.corners].fill(Some(CornerConfig::paper()));
    let mut collector = ReportCollector::new(&configs, ReportOptions::default());
    let start = || Tire { wander: 0.5, level: 241.3, frame: (1.0, 0.0), low: false };
    let mut tires = [start(), start(), start(), start()];
    let (mut distance, mut smooth, dt) = (0.0, 0.0, 1.0 / drive.rate_hz);
    for k in 0..(drive.seconds * drive.rate_hz) as u64 {
        let t = k as f64 * dt;
        let speed = match t {
            32.0..34.0 if drive.corners > 1 => 0.0,
            _ => 20.0 / 3.6,
        };
        distance += speed * dt;
        let truth_road_m = road(distance);
        // The estimate has lost the long waves.
        smooth += (truth_road_m - smooth) * dt * speed / 3.0;
        let mut rows = [None; 4];
        for (corner, tire) in tires.iter_mut().enumerate().take(drive.corners) {
            let truth = pressure(corner, t);
            let mut estimate = tire.estimate(t, dt, truth, speed > 0.0, &mut rng);
            estimate.road_m = truth_road_m - smooth + 1e-4 * normal(&mut rng);
            rows[corner] = Some(CornerRow {
                estimate,
                truth_kpa: if drive.truth_known { truth } else { f64::NAN },
                truth_road_m: if drive.truth_known { truth_road_m } else { f64::NAN },
                sensor_kpa: f64::NAN,
            });
        }
        collector.push(t, speed, &rows);
    }
    collector.finish(Provenance {
        program: "itpms 0.1.0".into(),
        made: "2026-03-01".into(),
        source: "paper-drop.csv".into(),
        vehicle: name.into(),
        estimator: "informed".into(),
        command: String::new(),
        options: vec![("calibrate-s".into(), "0".into()), ("seed".into(), "11".into())],
        sources: vec![(Parameter::UnsprungMass, "<the file>".into())],
        repairs: vec![("missing samples".into(), 12), ("rows out of order".into(), 1)],
    })
}
