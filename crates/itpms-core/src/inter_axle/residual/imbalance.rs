//! A wheel's imbalance in one side's roads: a line at one turn of the wheel, which is no road and not shared.
//! Finds how fast the wheels turn, and takes the line off the signals of both axles (docs/math/shared-road.md, section 2).
//! Knows nothing of beliefs.

use nalgebra::{Complex, SVector};

use crate::inter_axle::alignment::channel::BOTH;
use crate::memory::Blank;
use crate::real::Real;

/// Turning rates tried, in radians per meter: of rolling radii from 0.45 to 0.22 m.
const FEWEST_PER_M: f64 = 2.2;
const SPACING_PER_M: f64 = 0.04;
const RATES: usize = 60;
/// Distance in m over which they are looked at together.
const LOOK_M: f64 = 80.0;
/// Speed in m/s from which on an imbalance matters.
const SLOWEST_M_S: f64 = 10.0;
/// Looks that an average runs over, and those before it counts.
const LOOKS: u32 = 30;
const FEWEST_LOOKS: u32 = 3;
/// Places on either side of a rate, from and to, that show what there is without a line.
const BESIDE: [usize; 2] = [4, 8];
/// Power at a rate over that beside it from which on it is a line, and below which it is none any more.
const FOUND: f64 = 5.0;
const LOST: f64 = 2.5;
/// Width of the notch, as a share of the frequency: two tires' rates differ by a hundredth.
const WIDTH: f64 = 0.06;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Imbalance<T: Real> {
    /// Cosine and sine sums of the look under way, and the way it has come in m.
    cosine: SVector<T, RATES>,
    sine: SVector<T, RATES>,
    looked_m: T,
    /// Power at every rate over the mean of all, averaged over looks.
    power: SVector<T, RATES>,
    looks: u32,
    /// Turning rate of the line in radians per meter, if there is one, and where in its turn the wheel is.
    per_m: Option<T>,
    turned: T,
    /// The line in each signal: amplitudes with the turn's cosine and sine.
    lines: [[T; 2]; BOTH],
}

impl<T: Real> Imbalance<T> {
    /// Takes the line off both axles' signals, `distance_m` after the last ones.
    pub(crate) fn clear(&mut self, signals: &mut [T; BOTH], distance_m: T, speed_m_s: T) {
        let Some(per_m) = self.per_m else { return };
        let angle = distance_m * per_m;
        self.turned += angle;
        if self.turned > T::two_pi() {
            self.turned -= T::two_pi();
        }
        if !(speed_m_s > T::lit(SLOWEST_M_S)) {
            return;
        }
        let (sine, cosine) = self.turned.sin_cos_fast();
        let turn = [cosine, sine];
        let step = T::lit(WIDTH) * angle;
        for ([cosine, sine], signal) in self.lines.iter_mut().zip(signals) {
            *signal -= *cosine * turn[0] + *sine * turn[1];
            *cosine += *signal * turn[0] * step;
            *sine += *signal * turn[1] * step;
        }
    }

    /// Looks for a line in what the two roads disagree by, `distance_m` after the last look.
    pub(crate) fn look(&mut self, residual: T, distance_m: T, speed_m_s: T) {
        if !(speed_m_s > T::lit(SLOWEST_M_S)) || !residual.is_finite() {
            self.begin_look();
            return;
        }
        self.looked_m += distance_m;
        let seen = (T::pi() * self.looked_m / T::lit(LOOK_M)).sin_cos_fast().0 * residual;
        let at = |per_m: f64| {
            let angle = self.looked_m * T::lit(per_m);
            let (sine, cosine) = angle.sin_cos_fast();
            Complex::new(cosine, sine)
        };
        let (mut turn, next) = (at(FEWEST_PER_M) * seen, at(SPACING_PER_M));
        for (cosine, sine) in self.cosine.iter_mut().zip(self.sine.iter_mut()) {
            *cosine += turn.re;
            *sine += turn.im;
            turn *= next;
        }
        if self.looked_m >= T::lit(LOOK_M) {
            self.conclude();
            self.begin_look();
        }
    }

    fn begin_look(&mut self) {
        self.looked_m = T::zero();
        self.cosine.fill(T::zero());
        self.sine.fill(T::zero());
    }

    fn conclude(&mut self) {
        let power = self.cosine.component_mul(&self.cosine) + self.sine.component_mul(&self.sine);
        let mean = power.mean();
        if !(mean > T::zero() && mean.is_finite()) {
            return;
        }
        self.looks = (self.looks + 1).min(LOOKS);
        self.power += (power / mean - self.power) / T::lit(f64::from(self.looks));
        if self.looks < FEWEST_LOOKS {
            return;
        }
        let at = self.power.imax();
        let Some(&highest) = self.power.get(at) else { return };
        let over = highest / self.beside(at);
        if over > T::lit(FOUND) {
            self.per_m = Some(T::lit(FEWEST_PER_M) + T::lit(SPACING_PER_M) * self.top(at));
        } else if !(over > T::lit(LOST)) {
            self.per_m = None;
            self.lines = [[T::zero(); 2]; BOTH];
        }
    }

    /// Mean power beside a rate.
    fn beside(&self, at: usize) -> T {
        let [from, to] = BESIDE;
        let (mut sum, mut count) = (T::zero(), T::zero());
        for (other, &power) in self.power.iter().enumerate() {
            if (from..=to).contains(&other.abs_diff(at)) {
                sum += power;
                count += T::one();
            }
        }
        sum / count.max(T::one())
    }

    /// The top of a parabola through the powers around a place.
    fn top(&self, at: usize) -> T {
        let place = T::lit(at as f64);
        if at == 0 || at + 1 == RATES {
            return place;
        }
        let (before, after) = (self.power[at - 1], self.power[at + 1]);
        let bend = T::lit(2.0) * self.power[at] - before - after;
        if bend > T::zero() { place + T::lit(0.5) * (after - before) / bend } else { place }
    }
}

#[cfg(test)]
mod tests {
    // Where another crate of the build brings `std`, numbers have these functions by themselves.
    #[allow(unused_imports)]
    use nalgebra::ComplexField;

    use super::*;

    const PERIOD_S: f64 = 0.005;

    /// White numbers of unit variance, the same ones every time.
    struct White(u64);

    impl White {
        fn next(&mut self) -> f64 {
            // Twelve uniform numbers have a variance of one.
            (0..12).fold(-6.0, |sum, _| {
                self.0 =
                    self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                sum + (self.0 >> 11) as f64 / (1u64 << 53) as f64
            })
        }
    }

    /// Drives at a speed that swings, with a line of amplitude `line` at `per_m`; gives power of the signal in the first
    /// signal after a while, power of that without the line, and the rate that was found.
    fn drive(line: f64, per_m: f64) -> (f64, f64, Option<f64>) {
        let (mut imbalance, mut white) = (Imbalance::<f64>::BLANK, White(1));
        let (mut distance_m, mut left, mut plain) = (0.0, 0.0, 0.0);
        for i in 0..24_000 {
            let time_s = f64::from(i) * PERIOD_S;
            let speed = 25.0 + 5.0 * (0.3 * time_s).sin();
            distance_m += speed * PERIOD_S;
            let road = white.next();
            let residual = road + line * (per_m * distance_m + 1.0).cos();
            imbalance.look(residual, speed * PERIOD_S, speed);
            let mut signals = [residual; BOTH];
            imbalance.clear(&mut signals, speed * PERIOD_S, speed);
            if i > 12_000 {
                left += (signals[0] - road) * (signals[0] - road);
                plain += 0.5 * line * line;
            }
        }
        (left / 12_000.0, plain / 12_000.0, imbalance.per_m)
    }

    #[test]
    fn a_line_at_one_turn_of_the_wheel_is_found_and_taken_off() {
        for radius_m in [0.25, 0.31, 0.4] {
            let (left, plain, found) = drive(1.0, 1.0 / radius_m);
            let found = found.unwrap();
            assert!((found * radius_m - 1.0).abs() < 3e-3, "{radius_m}: {}", 1.0 / found);
            // What is taken off the road with it is the share of all frequencies that the width is: 0.06 of 13 Hz, with the
            // skirts pi/2 as much, of 100 Hz.
            let width_hz = 0.06 * 25.0 / radius_m / core::f64::consts::TAU;
            let road = width_hz * core::f64::consts::FRAC_PI_2 / (0.5 / PERIOD_S);
            assert!(left < 0.02 * plain + 1.5 * road, "{radius_m}: {left} {road}");
        }
    }

    #[test]
    fn without_a_line_nothing_is_taken_off() {
        assert_eq!(drive(0.0, 3.2), (0.0, 0.0, None));
    }

    #[test]
    fn what_is_not_a_line_is_left() {
        // A wheel hop is a hundred times as wide: 4 Hz at 25 m/s are 1 rad/m.
        let (mut imbalance, mut white) = (Imbalance::<f64>::BLANK, White(7));
        let mut state = [0.0; 2];
        for _ in 0..24_000 {
            let (omega, damping) = (core::f64::consts::TAU * 12.0, core::f64::consts::TAU * 2.0);
            state[1] += (white.next() - omega * omega * state[0] - 2.0 * damping * state[1]) * PERIOD_S;
            state[0] += state[1] * PERIOD_S;
            imbalance.look(state[1], 25.0 * PERIOD_S, 25.0);
            assert_eq!(imbalance.per_m, None);
        }
    }
}
