//! The fit of the body's equation: one pass of Gauss-Newton a call, with slip forces that are never negative.

use super::{
    BAR, BAR_FIRST, BAR_SD, BodyEquation, DAMPER, DAMPER_SD, DELAY, DELAY_SD, ELEMENTS, FORCE_N, FURTHEST,
    INERTIA, INERTIA_SD, Information, LARGEST_STEP, MOST_DELAY, MOST_WARP, Parameters, SIZE, SLIP, SPRING,
    SPRING_SD, WARP, WARP_SD,
};
use crate::cholesky::{self, packed};
use crate::model::{Corner, CornerConfig};
use crate::real::Real;
use crate::suspension::rigid_body::RigidBody;

/// A file that says that a strut has no friction is not believed to more than so many newtons.
const LEAST_FRICTION_N: f64 = 20.0;

impl<T: Real> BodyEquation<T> {
    /// Goes towards the parameters that fit best; slip forces stay where they are not negative: one pass of that, which holds at zero
    /// what those before made negative. True if there is no other to follow.
    #[inline(never)]
    pub(super) fn fit(&mut self, is_last: bool) -> bool {
        let mut best = self.score + self.prior_information().component_mul(&self.first());
        let mut free = self.with_prior();
        for (i, _) in self.held.iter().enumerate().skip(SLIP).filter(|(_, held)| **held) {
            hold(&mut free, &mut best, i);
        }
        if !cholesky::decompose_packed::<T, SIZE>(free.as_mut_slice()) {
            return true;
        }
        cholesky::solve_packed(free.as_slice(), &mut best);
        cholesky::solve_packed_transposed(free.as_slice(), &mut best);
        let found = !hold_negative(&mut self.held, &best) || is_last;
        if found {
            self.move_to(&best);
        }
        found
    }

    /// What the frames and the vehicle file together tell of the parameters: the lower triangle.
    pub(super) fn with_prior(&self) -> Information<T> {
        let (mut information, prior) = (self.information, self.prior_information());
        for (i, &prior) in prior.iter().enumerate() {
            information[packed::<SIZE>(i, i)] += prior;
        }
        information
    }

    /// The root `L` of that, `L L'`: with the covariance `P` of all parameters `q' P q` is the square of `L^-1 q`.
    pub(super) fn root(&self) -> Option<Information<T>> {
        let mut root = self.with_prior();
        cholesky::decompose_packed::<T, SIZE>(root.as_mut_slice()).then_some(root)
    }

    /// Prior of the parameters.
    #[inline(never)]
    pub(super) fn first(&self) -> Parameters<T> {
        let mut first = Parameters::zeros();
        first.fixed_rows_mut::<2>(BAR).fill(T::lit(BAR_FIRST));
        for (i, value) in first.iter_mut().enumerate().skip(SLIP) {
            let [slip, _] = self.slip_first[Corner::ALL[(i - SLIP) % 4]];
            *value = slip;
        }
        first
    }

    /// Prior; parameters that do not exist are held.
    #[inline(never)]
    fn prior_information(&self) -> Parameters<T> {
        let mut information = prior_information(&self.body);
        for (i, value) in information.iter_mut().enumerate().skip(SLIP) {
            let [_, sd] = self.slip_first[Corner::ALL[(i - SLIP) % 4]];
            *value = (sd * sd).recip();
        }
        information
    }

    #[inline(never)]
    fn move_to(&mut self, best: &Parameters<T>) {
        let largest = T::lit(LARGEST_STEP);
        let step = (best - self.parameters).map(|step| step.clamp(-largest, largest));
        if !step.iter().all(|step| step.is_finite()) {
            return;
        }
        self.parameters += step;
        for (i, value) in self.parameters.iter_mut().enumerate() {
            let [least, most] = bounds(i);
            *value = value.at_least(least).at_most(most);
        }
    }
}

// Functions of their own: for all parameters at once a compiler computes with every one of them the addresses of all.

/// Between which a parameter is believed.
#[inline(never)]
fn bounds<T: Real>(i: usize) -> [T; 2] {
    match i {
        WARP => [0.0, MOST_WARP],
        DELAY..SLIP => [-MOST_DELAY, MOST_DELAY],
        SLIP.. => [0.0, f64::INFINITY],
        _ => [-FURTHEST, FURTHEST],
    }
    .map(T::lit)
}

/// Makes of the equations such as leave a parameter at zero.
#[inline(never)]
fn hold<T: Real>(equations: &mut Information<T>, target: &mut Parameters<T>, i: usize) {
    let i = i.min(SIZE - 1);
    for j in 0..SIZE {
        equations[packed::<SIZE>(i.max(j), i.min(j))] = T::zero();
    }
    (equations[packed::<SIZE>(i, i)], target[i]) = (T::one(), T::zero());
}

/// Holds slip forces that came out negative; true if there are any.
#[inline(never)]
fn hold_negative<T: Real>(held: &mut [bool; SIZE], best: &Parameters<T>) -> bool {
    let mut any = false;
    for (held, &best) in held.iter_mut().zip(best.as_slice()).skip(SLIP) {
        let negative = best < T::zero() && !*held;
        *held |= negative;
        any |= negative;
    }
    any
}

/// Slip force of each of a strut's elements by the vehicle file, and its sd, in units of [`FORCE_N`]. Of a friction that is guessed only a part is taken
/// out at first: it is shrunk by its variance (positive-part James-Stein). How it is shared between the elements is not known, so that each has
/// its whole as an error.
pub(super) fn slip_first<T: Real>(corner: &CornerConfig<T>) -> [T; 2] {
    let (friction, sd) = (corner.uncertainty.friction_n, corner.uncertainty.friction_sd_n);
    let whole = friction.hypot(T::lit(2.0) * sd).at_least(T::lit(LEAST_FRICTION_N));
    let first = if friction > sd { friction - sd * sd / friction } else { T::zero() };
    [first / T::lit(ELEMENTS as f64), whole].map(|force| force / T::lit(FORCE_N))
}

/// Prior of all parameters but friction.
#[inline(never)]
fn prior_information<T: Real>(body: &RigidBody<T>) -> Parameters<T> {
    let of = |sd: f64| T::lit(1.0 / (sd * sd));
    let whole = |sd: f64| if body.is_whole() { of(sd) } else { T::lit(1e6) };
    Parameters::from_fn(|i, _| match i {
        INERTIA => of(INERTIA_SD[0]),
        1 | 2 => whole(INERTIA_SD[i]),
        DAMPER..SPRING => of(DAMPER_SD),
        SPRING..BAR => of(SPRING_SD),
        BAR..WARP => whole(BAR_SD),
        WARP => whole(WARP_SD),
        DELAY..SLIP => whole(DELAY_SD),
        _ => T::zero(),
    })
}
