//! One drive at known pressures: what each tire reads on an average, and what each strut showed minute by minute.

use itpms_core::model::{CarConfig, CarSample, Corner, Misfit, ParameterError, Validity};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_core::warning::Cause;

/// Seconds at the start of a drive that do not count, time between two looks at a tire, and valid time of a block of looks.
const START_S: f64 = 30.0;
const LOOK_S: f64 = 0.1;
const BLOCK_S: f64 = 30.0;
const FEWEST_BLOCKS: usize = 2;
/// Time between two looks at the struts, which forget with as much.
const STRUTS_S: f64 = 60.0;

/// A tire's stiffness over its unsprung mass, averaged over a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelReading {
    /// Geometric mean in 1/s².
    pub stiffness_over_mass: f64,
    /// Its relative standard deviation, by how its half minutes scatter.
    pub relative_sd: f64,
    pub seconds: f64,
}

/// A strut averaged over a drive, for the file's sprung mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrutMean {
    pub damping_n_s_per_m: f64,
    pub spring_n_per_m: f64,
    pub friction_n: f64,
}

/// A drive's result. The same whatever unsprung masses, dampers, springs and tires its [`Listener`] was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveReading {
    pub pressures_kpa: [f64; 4],
    /// By corner; `None` where too little was valid.
    pub wheels: [Option<WheelReading>; 4],
    /// By corner; `None` where nothing was seen.
    pub struts: [Option<StrutMean>; 4],
}

/// Estimates a drive as one whose pressures are unknown, and keeps what the tires and struts read.
#[derive(Debug)]
pub struct Listener {
    car: Box<MonitoredCar<f64>>,
    config: CarConfig<f64>,
    pressures_kpa: [f64; 4],
    first_s: f64,
    look_s: f64,
    struts_s: f64,
    wheels: [Blocks; 4],
    struts: [StrutSum; 4],
}

/// Logarithms of stiffness over mass, in blocks.
#[derive(Debug, Clone, Default)]
struct Blocks {
    sum: f64,
    count: u32,
    means: Vec<f64>,
}

/// Sums of logarithms, of damping and spring over the file's; of friction in N.
#[derive(Debug, Clone, Copy, Default)]
struct StrutSum {
    sums: [f64; 3],
    count: u32,
}

/// Gate from which on a wheel's reading shows something.
const LEARNING: f64 = 0.1;

/// Friction of a strut in N of which nothing is known, as an sd.
const ANY_FRICTION_N: f64 = 50.0;

impl Listener {
    /// For a drive of this car at these pressures in kPa gauge, by corner.
    /// Errors: a rate or parameters that the estimator refuses; a pressure that is not positive and finite.
    pub fn new(
        config: &CarConfig<f64>,
        pressures_kpa: [f64; 4],
        sample_rate_hz: f64,
    ) -> Result<Self, ParameterError> {
        let mut config = *config;
        for (corner, kpa) in config.corners.iter_mut().zip(pressures_kpa) {
            let Some(corner) = corner.as_mut() else { continue };
            // The estimate begins where the tires are. Stiffness over mass is what is asked for: that it is not known makes no reading
            // worthless.
            *corner = corner.with_initial_pressure(kpa)?;
            corner.placard_kpa = kpa;
            corner.uncertainty.stiffness_over_mass_relative_sd = Some(0.0);
            // The file's friction is weighed against the drive's afterwards.
            (corner.uncertainty.friction_n, corner.uncertainty.friction_sd_n) = (0.0, ANY_FRICTION_N);
        }
        let mut car = Box::new(MonitoredCar::unconfigured());
        car.configure(&MonitorConfig::new(&config), sample_rate_hz)?;
        Ok(Self {
            car,
            config,
            pressures_kpa,
            first_s: f64::NAN,
            look_s: f64::NEG_INFINITY,
            struts_s: STRUTS_S,
            wheels: Default::default(),
            struts: Default::default(),
        })
    }

    pub fn take(&mut self, sample: &CarSample<f64>) {
        let estimate = self.car.update(sample);
        if self.first_s.is_nan() {
            self.first_s = sample.time_s;
        }
        let driven_s = sample.time_s - self.first_s;
        if !(driven_s >= START_S && driven_s >= self.look_s) {
            return;
        }
        self.look_s = driven_s + LOOK_S;
        for (i, blocks) in self.wheels.iter_mut().enumerate() {
            let (Some(read), Some(stated)) = (&estimate.corners[i], &self.config.corners[i]) else {
                continue;
            };
            // With another wheelbase than the car's, front and rear never meet: a wheel's own spectrum tells of it all the same.
            let misfit = self.car.estimator().fit(Corner::ALL[i]).and_then(|(_, misfit)| misfit);
            let apart = misfit == Some(Misfit::Apart) && read.diagnostics.gate > LEARNING;
            // The pressure is known. One that the monitor would not show, of a rim or of no tire, is a car far from its file.
            let unlike_file = read.validity == Validity::Misfit && misfit.is_none();
            if (read.validity.is_valid() || apart || unlike_file) && read.stiffness_n_per_m > 0.0 {
                blocks.push((read.stiffness_n_per_m / stated.quarter_car.unsprung_mass_kg()).ln());
            }
        }
        if driven_s >= self.struts_s {
            self.struts_s = driven_s + STRUTS_S;
            let readings = self.car.estimator().strut_readings();
            for (sum, reading) in self.struts.iter_mut().zip(readings) {
                let Some(reading) = reading else { continue };
                let values = [reading.ln_damping, reading.ln_spring, reading.friction_n];
                sum.sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                sum.count += 1;
            }
        }
    }

    /// The monitor's report of a malfunction of this corner's sensors, if any: why it is not read.
    pub fn malfunction(&self, corner: Corner) -> Option<String> {
        let mut alerts = self.car.report().alerts_of(corner);
        alerts.find(|alert| matches!(alert.cause, Cause::Malfunction(_))).map(ToString::to_string)
    }

    pub fn finish(self) -> DriveReading {
        let strut = |i: usize| {
            let (sum, stated) = (&self.struts[i], self.config.corners[i].as_ref()?.quarter_car);
            let mean = |value: usize| sum.sums[value] / f64::from(sum.count);
            (sum.count > 0).then(|| StrutMean {
                damping_n_s_per_m: stated.damping_n_s_per_m() * mean(0).exp(),
                spring_n_per_m: stated.spring_n_per_m() * mean(1).exp(),
                friction_n: mean(2),
            })
        };
        DriveReading {
            pressures_kpa: self.pressures_kpa,
            wheels: self.wheels.each_ref().map(Blocks::reading),
            struts: std::array::from_fn(strut),
        }
    }
}

impl Blocks {
    fn push(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
        if f64::from(self.count) * LOOK_S >= BLOCK_S {
            self.means.push(self.sum / f64::from(self.count));
            (self.sum, self.count) = (0.0, 0);
        }
    }

    fn reading(&self) -> Option<WheelReading> {
        let count = self.means.len();
        if count < FEWEST_BLOCKS {
            return None;
        }
        let n = count as f64;
        let mean = self.means.iter().sum::<f64>() / n;
        let squares: f64 = self.means.iter().map(|value| (value - mean).powi(2)).sum();
        Some(WheelReading {
            stiffness_over_mass: mean.exp(),
            relative_sd: (squares / (n - 1.0) / n).sqrt(),
            seconds: n * BLOCK_S,
        })
    }
}
