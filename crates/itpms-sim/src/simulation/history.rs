//! The last values of a signal on the fine grid, read between them and late.
//!
//! Called by a corner in motion, once for each accelerometer.

use std::collections::VecDeque;

#[derive(Debug, Clone)]
pub(crate) struct History {
    /// Oldest first.
    values: VecDeque<f64>,
    late_steps: f64,
}

impl History {
    /// Of a signal that is read so many steps late; zero before the first step.
    pub(crate) fn new(late_steps: f64) -> Self {
        Self { values: vec![0.0; 4 + late_steps.ceil() as usize].into(), late_steps }
    }

    pub(crate) fn push(&mut self, value: f64) {
        self.values.pop_front();
        self.values.push_back(value);
    }

    /// The value, late, at `fraction` of a step after the step before last, by a cubic.
    pub(crate) fn read(&self, fraction: f64) -> f64 {
        let back = (self.late_steps - fraction).ceil().max(0.0);
        let first = self.values.len() - 4 - back as usize;
        let around = [0, 1, 2, 3].map(|i| self.values.get(first + i).copied().unwrap_or(f64::NAN));
        crate::road::cubic(around, fraction - self.late_steps + back)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_as_late_as_it_says() {
        for late in [0.0, 0.3, 1.0, 7.75] {
            let mut history = History::new(late);
            for i in 0..=20 {
                history.push(f64::from(i).powi(2));
            }
            for fraction in [0.0, 0.3, 0.5, 0.99] {
                // The step before last but one is 18.
                let x = 18.0 + fraction - late;
                assert!((history.read(fraction) - x * x).abs() < 1e-9, "{late} {fraction}");
            }
        }
    }
}
