//! The body's equation of motion, all corners together, fitted to the spectra of their frames (docs/math/unknown-car.md, section 2): mass and
//! inertias, spring, damper and anti-roll bar, friction of every strut. Gauss-Newton steps on an information matrix that forgets;
//! friction is never negative.

mod fit;
mod reading;
mod stiffness_error;

use nalgebra::{Complex, SMatrix, SVector};

use super::coherence::{MEMORY_S as POWER_S, geometric_mean};
use super::rigid_body::{MODES, RigidBody};
use super::strut::{ACCELERATION, BINS, BODY, ENOUGH_S, FRICTION, HOP_S, StrutFrame, VELOCITY, WHEEL};
use crate::conditioning::pauses::ENOUGH_S as SETTLING_S;
use crate::memory::Blank;
use crate::model::{Corner, CornerConfig, UNEXPLAINED_BINS};
use crate::real::Real;
use crate::spectrum::OVERLAP;
use crate::spectrum::front_end::ELEMENTS;
use crate::spectrum::transfer::{Body, DescribingFunction, FRICTION_SPACING_HZ};

/// Unknown quantities: logarithmic deviations of mass, pitch and roll inertia, of dampers and springs; stiffness of the two anti-roll bars
/// over the springs'; how freely the body warps, from zero for a rigid one to one; by how much each wheel's sensor is late, in units of
/// [`DELAY_S`]; slip forces, element by element, in units of [`FORCE_N`].
const SIZE: usize = 18 + 4 * ELEMENTS;
const PAIRS: usize = SIZE * (SIZE + 1) / 2;
const INERTIA: usize = 0;
const DAMPER: usize = 3;
const SPRING: usize = 7;
const BAR: usize = 11;
const WARP: usize = 13;
const DELAY: usize = 14;
const SLIP: usize = 18;
const DELAY_S: f64 = 1e-3;
const FORCE_N: f64 = 60.0;
/// Place of the warp among the body's modes.
const WARP_MODE: usize = 3;
/// What they are at first, and with which sd: loads change by persons, inertias are guessed. Of friction the vehicle file says it.
const INERTIA_SD: [f64; 3] = [0.15, 0.2, 0.2];
const DAMPER_SD: f64 = 0.2;
const SPRING_SD: f64 = 0.05;
const BAR_FIRST: f64 = 0.3;
const BAR_SD: f64 = 0.4;
const WARP_SD: f64 = 0.5;
const MOST_WARP: f64 = 1.5;
const DELAY_SD: f64 = 1.0;
const MOST_DELAY: f64 = 5.0;
/// Largest step of a fit, and the furthest that is believed.
const LARGEST_STEP: f64 = 0.3;
const FURTHEST: f64 = 1.0;
/// Error of the equation as a share of the body's motion: no damper is linear.
const MODEL_ERROR: f64 = 0.03;
/// Memory in s of the products.
pub(crate) const MEMORY_S: f64 = 60.0;
/// Passes of a fit at most. With the bins and the rest they have to fit into a hop at 100 Hz.
const PASSES: usize = 6;
const _: () = assert!(BINS + 1 + PASSES <= 20);
/// Seconds within which frames of two corners are of the same time.
const SAME_S: f64 = 0.006;

type Parameters<T> = SVector<T, SIZE>;
/// A lower triangle over them, packed by columns.
type Information<T> = SVector<T, PAIRS>;

/// Where the slip force of a corner's element stands.
fn slip(element: usize, corner: Corner) -> usize {
    SLIP + 4 * element + corner.index()
}

/// Running powers of a corner, per bin.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Powers<T: Real> {
    body: SVector<T, BINS>,
    /// Of the equation's residual, and of the sensors' noise in it.
    residual: SVector<T, BINS>,
    noise: SVector<T, BINS>,
    /// Of the deflection's rate, and its cross power with the rate of each element's force.
    velocity: SVector<T, BINS>,
    elements: SMatrix<T, BINS, { 2 * ELEMENTS }>,
    /// Of the deflection in all bins, the same and that of the last second.
    loudness: [T; 2],
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BodyEquation<T: Real> {
    body: RigidBody<T>,
    damping: [T; 4],
    spring: [T; 4],
    noise_density: [T; 4],
    /// Slip force of each element at first, by the vehicle file, and its sd, in units of [`FORCE_N`].
    slip_first: [[T; 2]; 4],
    parameters: Parameters<T>,
    /// Its lower triangle, packed by columns.
    information: Information<T>,
    score: Parameters<T>,
    /// Slip forces that the present fit holds at zero.
    held: [bool; SIZE],
    powers: [Powers<T>; 4],
    /// Bin nearest to each wheel's hop, and what friction that is not known makes of stiffness and damping there: see
    /// [`stiffness_error`].
    hop_bin: [usize; 4],
    impedance_variance: [[T; 2]; 4],
    learned_s: T,
    /// Whether enough was ever seen for the slip forces to be reported.
    known: bool,
    time_s: f64,
    /// Units of the newest frames' work that are left, one a sample: every bin, how well friction is known, then the fit.
    units_left: usize,
}

/// How far the frames at hand are learned from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Learning {
    /// There is nothing to do.
    Idle,
    UnderWay,
    /// All of them, just now.
    Complete,
}

impl<T: Real> BodyEquation<T> {
    /// For these corners, as the vehicle file has them; whatever was there is forgotten.
    #[inline(never)]
    pub(crate) fn configure(&mut self, corners: &[Option<CornerConfig<T>>; 4], sample_rate_hz: f64) {
        let of = |value: &dyn Fn(&CornerConfig<T>) -> T| {
            corners.each_ref().map(|corner| corner.as_ref().map_or(T::zero(), value))
        };
        let per_hz = T::lit(2.0 / sample_rate_hz);
        let mass_kg =
            corners.each_ref().map(|corner| corner.as_ref().map(|c| c.quarter_car.sprung_mass_kg()));
        self.body = RigidBody::new(mass_kg);
        self.damping = of(&|c| c.quarter_car.damping_n_s_per_m());
        self.spring = of(&|c| c.quarter_car.spring_n_per_m());
        self.noise_density = of(&|c| per_hz * c.accel_noise_or_usual_m_s2() * c.accel_noise_or_usual_m_s2());
        self.slip_first =
            corners.each_ref().map(|corner| corner.as_ref().map_or([T::zero(), T::one()], fit::slip_first));
        self.parameters = self.first();
        self.information.fill(T::zero());
        self.score.fill(T::zero());
        self.powers = [const { Powers::BLANK }; 4];
        self.hop_bin = corners.each_ref().map(|corner| corner.as_ref().map_or(0, stiffness_error::hop_bin));
        self.impedance_variance = [[T::zero(); 2]; 4];
        (self.learned_s, self.known, self.time_s) = (T::zero(), false, f64::NEG_INFINITY);
        self.held = [false; SIZE];
        self.units_left = 0;
    }

    /// Sensors of a corner were out of order: what was seen is forgotten, what it has taught is where the next fit begins.
    pub(crate) fn restart(&mut self) {
        self.information.fill(T::zero());
        self.score.fill(T::zero());
        self.powers = [const { Powers::BLANK }; 4];
        self.learned_s = T::zero();
        self.units_left = 0;
    }

    /// Learns from the newest frames, if all corners that there are have one of the same time: a bin with every call, so that no sample
    /// is much more work than another.
    pub(crate) fn learn(&mut self, frames: [Option<&StrutFrame<T>>; 4]) -> Learning {
        let mut there = Corner::ALL.into_iter().filter(|&corner| self.body.has(corner));
        let Some(first_s) = there.next().and_then(|corner| Some(frames[corner]?.time_s)) else {
            return Learning::Idle;
        };
        if !there.all(|corner| frames[corner].is_some()) {
            return Learning::Idle;
        }
        // For nearly every sample one corner's shows that nothing is new.
        if first_s > self.time_s {
            let [earliest_s, latest_s] = self.times(&frames);
            if latest_s - earliest_s < SAME_S && earliest_s > self.time_s {
                self.time_s = latest_s;
                self.begin_learning();
                // The frames' sample has work of their corners.
                return Learning::UnderWay;
            }
        }
        if self.units_left == 0 {
            return Learning::Idle;
        }
        self.units_left -= 1;
        match self.units_left {
            PASSES => self.note_impedance_error(),
            left if left < PASSES => {
                if self.fit(left == 0) {
                    self.units_left = 0;
                }
            }
            left => self.accumulate(&frames, (BINS + PASSES).saturating_sub(left)),
        }
        if self.units_left == 0 { Learning::Complete } else { Learning::UnderWay }
    }

    pub(crate) fn is_learning(&self) -> bool {
        self.units_left > 0
    }

    /// Times in s of the earliest and the latest frame of the corners that there are.
    fn times(&self, frames: &[Option<&StrutFrame<T>>; 4]) -> [f64; 2] {
        let (mut earliest_s, mut latest_s) = (f64::INFINITY, f64::NEG_INFINITY);
        for frame in
            Corner::ALL.into_iter().filter_map(|corner| frames[corner].filter(|_| self.body.has(corner)))
        {
            (earliest_s, latest_s) = (earliest_s.min(frame.time_s), latest_s.max(frame.time_s));
        }
        [earliest_s, latest_s]
    }

    fn begin_learning(&mut self) {
        let seconds = T::lit(HOP_S);
        self.learned_s += seconds;
        self.known |= self.learned_s >= T::lit(ENOUGH_S);
        let keep = (-seconds / T::lit(MEMORY_S).min(self.learned_s.max(T::lit(1.0)))).exp();
        self.information *= keep;
        self.score *= keep;
        self.held = [false; SIZE];
        self.units_left = BINS + 1 + PASSES;
    }

    /// Slip forces in N of a corner's elements: the vehicle file's until enough was seen.
    pub(crate) fn slip_forces_n(&self, corner: Corner) -> [T; ELEMENTS] {
        let [first, _] = self.slip_first[corner];
        core::array::from_fn(|element| {
            T::lit(FORCE_N) * if self.known { self.parameters[slip(element, corner)] } else { first }
        })
    }

    /// The quarter car that a corner is, if it is there, on a wheel of this mass (docs/math/informed.md, eq. 20): with the mass that its own
    /// strut moves, and with the anti-roll bar beside its spring; a usual one at first.
    pub(crate) fn quarter_car(&self, corner: Corner, unsprung_mass_kg: T) -> Body<T> {
        let (x, (_, whole)) = (&self.parameters, self.compliance());
        let bar = if self.body.is_whole() { x[BAR + corner.axle()] } else { T::zero() };
        let spring_n_per_m = self.spring[corner] * x[SPRING + corner.index()].exp();
        Body {
            sprung_mass_kg: whole[(corner.index(), corner.index())].recip(),
            unsprung_mass_kg,
            damping_n_s_per_m: self.damping[corner] * x[DAMPER + corner.index()].exp(),
            spring_n_per_m: spring_n_per_m * (T::one() + bar),
        }
    }

    /// Equivalent spring and damper of a corner's friction.
    pub(crate) fn describing_function(&self, corner: Corner) -> DescribingFunction<T> {
        let (powers, slip_n) = (&self.powers[corner], self.slip_forces_n(corner));
        let mut function = DescribingFunction::BLANK;
        for (bin, n_per_m) in function.n_per_m.iter_mut().enumerate() {
            let velocity = powers.velocity[bin].max(T::lit(1e-15));
            for (element, slip_n) in slip_n.into_iter().enumerate() {
                n_per_m[0] += slip_n * powers.elements[(bin, 2 * element)] / velocity;
                n_per_m[1] += slip_n * powers.elements[(bin, 2 * element + 1)] / velocity;
            }
        }
        function
    }

    /// Share of a corner's body motion that the equation leaves unexplained, 5 to 20 Hz, the sensors' noise taken off: the geometric
    /// mean over the bins. `None` as long as too little was seen, and where corners are missing: what moves the body there is not known.
    pub(crate) fn unexplained(&self, corner: Corner) -> Option<T> {
        if !(self.body.is_whole() && self.learned_s >= T::lit(ENOUGH_S)) {
            return None;
        }
        let powers = &self.powers[corner];
        Some(geometric_mean(UNEXPLAINED_BINS.map(|bin| {
            let left = (powers.residual[bin] - powers.noise[bin]).max(T::zero());
            left / powers.body[bin].max(T::lit(1e-12))
        })))
    }

    /// `g` at the present parameters, and its parts.
    fn compliance(&self) -> ([SMatrix<T, 4, 4>; MODES], SMatrix<T, 4, 4>) {
        let mut parts = self.body.parts();
        for (part, &deviation) in parts[..WARP_MODE].iter_mut().zip(self.parameters.iter()) {
            *part *= (-deviation).exp();
        }
        let whole = parts[0] + parts[1] + parts[2] + parts[WARP_MODE] * self.parameters[WARP];
        (parts, whole)
    }

    /// Learns from a bin of the frames.
    #[inline(never)]
    fn accumulate(&mut self, frames: &[Option<&StrutFrame<T>>; 4], bin: usize) {
        let (bin, seconds) = (bin.min(BINS - 1), T::lit(HOP_S));
        let (parts, whole) = self.compliance();
        let x = self.parameters;
        let settled_s = (self.learned_s - T::lit(SETTLING_S)).max(seconds);
        let gain = T::one() - (-seconds / T::lit(POWER_S).min(settled_s)).exp();
        let forces = self.forces(frames, bin);
        let omega = T::two_pi() * T::lit((bin + 1) as f64 * FRICTION_SPACING_HZ);
        for row in Corner::ALL.into_iter().filter(|&row| self.body.has(row)) {
            let Some(frame) = frames[row] else { continue };
            let body = frame.spectra.at(bin, BODY);
            let mut slope = SVector::<Complex<T>, SIZE>::zeros();
            let (mut residual, mut noise) = (body, omega * omega * self.noise_density[row]);
            for (corner, force) in Corner::ALL.into_iter().zip(&forces) {
                let (row, column) = (row.index(), corner.index());
                let g = whole[(row, column)];
                residual -= force.total * g;
                for (inertia, part) in parts[..WARP_MODE].iter().enumerate() {
                    slope[INERTIA + inertia] += force.total * part[(row, column)];
                }
                slope[WARP] -= force.total * parts[WARP_MODE][(row, column)];
                slope[DAMPER + column] = -force.damper * g;
                slope[SPRING + column] = -force.spring * g;
                slope[BAR + corner.axle()] -= force.bar * g;
                slope[DELAY + column] = -force.advance * g;
                for (element, rate) in force.elements.iter().enumerate() {
                    slope[slip(element, corner)] = -*rate * g;
                }
                noise += g * g * force.noise;
            }
            let powers = &mut self.powers[row];
            let follow = |of: &mut T, now: T| *of += gain * (now - *of);
            follow(&mut powers.body[bin], body.norm_sqr());
            // Every frame counts alike, as in the spectrum's likelihood: what was loud a minute ago says nothing of how much a strut
            // sticks now.
            let velocity = frame.spectra.at(bin, VELOCITY);
            let loudness = frame.deflection_power().max(T::lit(1e-12));
            follow(&mut powers.velocity[bin], velocity.norm_sqr() / loudness);
            for element in 0..ELEMENTS {
                let cross = frame.spectra.at(bin, FRICTION + element) * velocity.conj() / loudness;
                follow(&mut powers.elements[(bin, 2 * element)], cross.re);
                follow(&mut powers.elements[(bin, 2 * element + 1)], cross.im);
            }
            follow(&mut powers.residual[bin], residual.norm_sqr());
            follow(&mut powers.noise[bin], noise);
            if bin == 0 {
                let [usual, newest] = &mut powers.loudness;
                follow(usual, loudness);
                *newest += gain.max(seconds) * (loudness - *newest);
            }
            // On a road that is smoother than of late less is left, but for the sensors' noise; and how a strut sticks shows there.
            let [usual, newest] = powers.loudness;
            let quieter = (newest / usual.max(T::lit(1e-12))).min(T::one());
            // A loud frame, as over a hole, counts no more than a usual one.
            let loud = (body.norm_sqr() / powers.body[bin].max(T::lit(1e-12))).max(T::one());
            let error = T::lit(MODEL_ERROR * MODEL_ERROR) * powers.body[bin];
            let left = (powers.residual[bin] + error) * quieter + noise * (T::one() - quieter);
            let weight = T::lit(2.0 * OVERLAP) / (left.max(T::lit(1e-12)) * loud);
            // Towards the parameters at which the linearized residual vanishes.
            let [re, im] = [slope.map(|s| s.re), slope.map(|s| s.im)];
            let target = [re.dot(&x) - residual.re, im.dot(&x) - residual.im];
            let mut left = self.information.as_mut_slice();
            for (column, (&by_re, &by_im)) in re.iter().zip(&im).enumerate() {
                let [by_re, by_im] = [weight * by_re, weight * by_im];
                let [re, im] = [&re, &im].map(|part| part.as_slice().get(column..).unwrap_or(&[]));
                let Some((sums, others)) = left.split_at_mut_checked(re.len()) else { break };
                left = others;
                for (sum, (&re, &im)) in sums.iter_mut().zip(re.iter().zip(im)) {
                    *sum += by_re * re + by_im * im;
                }
            }
            for (slope, target) in [re, im].iter().zip(target) {
                self.score.axpy(weight * target, slope, T::one());
            }
        }
    }

    /// Rates of the struts' forces in a bin, by their parts.
    fn forces(&self, frames: &[Option<&StrutFrame<T>>; 4], bin: usize) -> [Force<T>; 4] {
        let x = &self.parameters;
        let at = |corner: Corner, signal: usize| {
            frames[corner].map_or(Complex::new(T::zero(), T::zero()), |frame| frame.spectra.at(bin, signal))
        };
        let omega = T::two_pi() * T::lit((bin + 1) as f64 * FRICTION_SPACING_HZ);
        Corner::ALL.map(|corner| {
            if !self.body.has(corner) {
                return Force::BLANK;
            }
            let (damping, stiffness) = (
                self.damping[corner] * x[DAMPER + corner.index()].exp(),
                self.spring[corner] * x[SPRING + corner.index()].exp(),
            );
            // The delay of the wheel's sensor is advanced, to first order.
            let (late, s) = (x[DELAY + corner.index()] * T::lit(DELAY_S), Complex::new(T::zero(), omega));
            let wheel_jerk = at(corner, WHEEL);
            let wheel_acceleration = wheel_jerk / s;
            let velocity = at(corner, VELOCITY) + wheel_acceleration * late;
            let damper = (at(corner, ACCELERATION) + wheel_jerk * late) * damping;
            let spring = velocity * stiffness;
            let bar = if self.body.is_whole() {
                (velocity - at(corner.same_axle(), VELOCITY)) * stiffness
            } else {
                Complex::new(T::zero(), T::zero())
            };
            let sticking = (Complex::new(T::one(), T::zero()) + s * late) * T::lit(FORCE_N);
            let elements = core::array::from_fn(|element| at(corner, FRICTION + element) * sticking);
            let mut friction = Complex::new(T::zero(), T::zero());
            for (element, rate) in elements.iter().enumerate() {
                friction += *rate * x[slip(element, corner)];
            }
            let bar_share = x[BAR + corner.axle()];
            let total = damper + spring + bar * bar_share + friction;
            let advance = (wheel_jerk * damping
                + wheel_acceleration * (stiffness * (T::one() + bar_share))
                + s * friction)
                * T::lit(DELAY_S);
            // Of both sensors, in acceleration and velocity.
            let noise = T::lit(2.0)
                * self.noise_density[corner]
                * (damping * damping + stiffness * stiffness / (omega * omega));
            Force { damper, spring: spring + bar * bar_share, bar, elements, advance, total, noise }
        })
    }
}

/// The rate of a strut's force and its parts: derivatives by the logarithms of damping and spring, by the bar, by the slip forces and by
/// the time by which the wheel's sensor is late.
#[derive(Blank)]
struct Force<T> {
    damper: Complex<T>,
    spring: Complex<T>,
    bar: Complex<T>,
    elements: [Complex<T>; ELEMENTS],
    advance: Complex<T>,
    total: Complex<T>,
    /// Power density of the sensors' noise in it.
    noise: T,
}

#[cfg(test)]
mod tests;
