//! How each axle really answers the road that both agree on, over how the instruments' quarter car does: a loaded body, a
//! damper that is harder in rebound, a sensor that is late answer otherwise, and instruments that answer otherwise than
//! the car lead astray (docs/math/shared-road.md, section 4). Knows nothing of beliefs.

use nalgebra::Complex;

use crate::belief::measurement::BINS;
use crate::inter_axle::Frame;
use crate::inter_axle::alignment::channel::{BOTH, FRONT, JERK, RELATIVE};
use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::Frame as Spectra;

/// Frames that an average runs over, and those that the quarter car counts for.
const REMEMBERED: f64 = 200.0;
const COUNTED: f64 = 5.0;
/// Largest difference from the quarter car, as a share of it.
const LARGEST: f64 = 0.5;
/// Frames from which on it shows how far the wheels' answers are from it.
const ENOUGH: f64 = 0.3 * REMEMBERED;

/// What each signal of both axles is on the common road, over what the instruments make of it, bin by bin.
pub(crate) type FrfRatios<T> = [[Complex<T>; BOTH]; BINS];

/// Products of the common road with the signals of both axles, averaged.
type Products<T> = Spectra<T, BINS, BOTH>;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrfCorrection<T: Real> {
    /// With the signals as measured, and as the instruments have them.
    measured: Products<T>,
    foretold: Products<T>,
    /// Frames seen as far as they were trusted, and all of them; those long ago count less.
    frames: T,
    all_frames: T,
    /// How far the wheels' answers are from the quarter car's, by all of that.
    response_error: T,
}

impl<T: Real> FrfCorrection<T> {
    /// How the axles answer, as far as was seen: one where nothing was.
    pub(crate) fn frf_ratios(&self) -> FrfRatios<T> {
        let share = self.frames / (self.frames + T::lit(COUNTED));
        let one = Complex::new(T::one(), T::zero());
        let largest = T::lit(LARGEST);
        core::array::from_fn(|bin| {
            let mut frf_ratios = core::array::from_fn(|column| {
                let more = self.more(bin, column) * share;
                let size = more.norm_sqr().sqrt();
                match size {
                    size if size <= largest => one + more,
                    size if size.is_finite() => one + more * (largest / size),
                    _ => one,
                }
            });
            // The other side of an axle moves by itself.
            for axle in [0, FRONT] {
                frf_ratios[axle + RELATIVE + 1] = frf_ratios[axle + RELATIVE];
            }
            frf_ratios[BOTH - 1] = frf_ratios[FRONT + JERK];
            frf_ratios
        })
    }

    /// By how much a signal is more than the quarter car's, as a share of that, by all frames.
    fn more(&self, bin: usize, column: usize) -> Complex<T> {
        self.measured.at(bin, column) / self.foretold.at(bin, column) - Complex::new(T::one(), T::zero())
    }

    /// How far the wheels' accelerations are from the quarter car's, as a share of these: rms over the bins, the farther axle; `None` before enough frames
    /// were seen, however little they are trusted: where the axles answer otherwise they seem to be on two roads.
    pub(crate) fn response_error(&self) -> Option<T> {
        let counted = self.frames >= T::lit(COUNTED) && self.all_frames >= T::lit(ENOUGH);
        counted.then_some(self.response_error)
    }

    fn rms_error(&self) -> T {
        let squares = |wheel: usize| {
            let more = |bin| self.more(bin, wheel).norm_sqr();
            (0..BINS).fold(T::zero(), |sum, bin| sum + more(bin))
        };
        (squares(0).max(squares(FRONT)) / T::lit(BINS as f64)).sqrt()
    }

    /// Learns from a frame, given the road that both axles agree on and how far the frame is trusted.
    pub(crate) fn learn(&mut self, frame: &Frame<T>, common: &[Complex<T>; BINS], weight: T) {
        let keep = T::one() - T::lit(1.0 / REMEMBERED);
        self.frames = self.frames * keep + weight;
        self.all_frames = self.all_frames * keep + T::one();
        for (bin, road) in common.iter().enumerate() {
            // Every frame counts alike, however rough its road is.
            let weight = weight / road.norm_sqr().max(T::lit(1e-20));
            for column in 0..BOTH {
                for (products, from) in [(&mut self.measured, column), (&mut self.foretold, BOTH + column)] {
                    let new = road.conj() * frame.at(bin, from) * weight;
                    products.re[(bin, column)] = products.re[(bin, column)] * keep + new.re;
                    products.im[(bin, column)] = products.im[(bin, column)] * keep + new.im;
                }
            }
        }
        self.response_error = self.rms_error();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type C = Complex<f64>;
    const ONE: C = C::new(1.0, 0.0);

    /// Frames on roads of any size whose signals, for all but the other side's, are `ratio` times what the instruments
    /// have, and on top of it what is not on the common road, now this way and now that.
    fn answered(ratio: C, frames: usize) -> FrfRatios<f64> {
        correction(ratio, frames).frf_ratios()
    }

    fn correction(ratio: C, frames: usize) -> FrfCorrection<f64> {
        let mut frf_correction = FrfCorrection::<f64>::BLANK;
        for i in 0..frames {
            let road = C::new(0.3 + i as f64, 0.1);
            let mut frame = Frame::<f64>::zero();
            let own = if i % 2 == 0 { ONE } else { -ONE } * road * 0.2;
            for bin in 0..BINS {
                for column in 0..BOTH {
                    let foretold = road * C::new(1.0, column as f64);
                    let measured = foretold * ratio + own;
                    (frame.re[(bin, column)], frame.im[(bin, column)]) = (measured.re, measured.im);
                    let at = BOTH + column;
                    (frame.re[(bin, at)], frame.im[(bin, at)]) = (foretold.re, foretold.im);
                }
            }
            frf_correction.learn(&frame, &[road; BINS], 1.0);
        }
        frf_correction
    }

    /// However far it is: only what is made of it has a limit.
    #[test]
    fn the_error_of_the_response_is_how_far_the_answer_is() {
        for ratio in [C::new(0.8, 0.1), C::new(-3.0, 2.0), ONE] {
            let error = correction(ratio, 2000).response_error().unwrap();
            let expected = (ratio - ONE).norm_sqr().sqrt();
            assert!((error - expected).abs() < 0.01 + 0.03 * expected, "{error} {expected}");
        }
        assert_eq!(correction(ONE, 10).response_error(), None);
    }

    #[test]
    fn an_answer_is_learned_and_what_is_not_on_the_common_road_is_not() {
        let ratio = C::new(0.8, 0.1);
        for learned in answered(ratio, 2000).iter().flatten() {
            // The quarter car counts for five frames of two hundred, the last frame's own part for one.
            assert!((learned - ratio).norm_sqr().sqrt() < 0.01, "{learned}");
        }
    }

    #[test]
    fn nothing_seen_is_the_quarter_car_and_nothing_is_too_far_from_it() {
        assert_eq!(answered(ONE, 0), [[ONE; BOTH]; BINS]);
        for learned in answered(C::new(-3.0, 2.0), 500).iter().flatten() {
            assert!((learned - ONE).norm_sqr().sqrt() < LARGEST + 1e-12);
        }
    }
}
