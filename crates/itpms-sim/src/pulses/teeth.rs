//! The ring of teeth whose edges a sensor counts; `docs/math/simulation.md`, eq. 20.

use std::f64::consts::TAU;

use rand_pcg::Pcg64;

use super::PulseSpec;
use crate::wheel_speeds::normal;

#[derive(Debug, Clone)]
pub(super) struct Teeth {
    pitch_rad: f64,
    errors: Vec<f64>,
    jitter: f64,
    tick_s: f64,
    /// Angle turned since the last whole turn's first tooth, the next tooth, and where its edge will come.
    angle_rad: f64,
    next: usize,
    edge_rad: f64,
}

impl Teeth {
    pub(super) fn new(spec: &PulseSpec, car: &mut Pcg64) -> Self {
        let mut errors: Vec<f64> = (0..spec.teeth).map(|_| spec.tooth_error * normal(car)).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        errors.iter_mut().for_each(|error| *error -= mean);
        let pitch_rad = TAU / f64::from(spec.teeth);
        Self {
            pitch_rad,
            errors,
            jitter: spec.jitter,
            tick_s: spec.tick_s,
            angle_rad: 0.0,
            next: 1,
            edge_rad: pitch_rad,
        }
    }

    pub(super) fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// Turns by an angle within a step, evenly, and gives each edge that passes, rounded down to the clock's tick.
    pub(super) fn turn(
        &mut self,
        time_s: f64,
        step_s: f64,
        turned_rad: f64,
        random: &mut Pcg64,
        pulse: &mut impl FnMut(f64),
    ) {
        if !(turned_rad > 0.0) {
            return;
        }
        let from_rad = self.angle_rad;
        self.angle_rad += turned_rad;
        while self.edge_rad <= self.angle_rad {
            let at_s = time_s + step_s * ((self.edge_rad - from_rad) / turned_rad).max(0.0);
            pulse(if self.tick_s > 0.0 { (at_s / self.tick_s).floor() * self.tick_s } else { at_s });
            self.next += 1;
            let tooth = self.next % self.errors.len();
            let late = self.errors.get(tooth).copied().unwrap_or(0.0) + self.jitter * normal(random);
            self.edge_rad = self.pitch_rad * (self.next as f64 + late);
        }
    }
}
