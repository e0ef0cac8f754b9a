//! Fourier transforms of real numbers in double precision.
//!
//! Planning a transform is a large piece of generic code, which the compiler would make anew in every crate that plans one: it is done here for
//! all of them. Plans are kept, one set a thread.
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

use std::cell::RefCell;
use std::sync::Arc;

use realfft::RealFftPlanner;
pub use realfft::num_complex::Complex;
pub use realfft::{ComplexToReal, RealToComplex};

thread_local! {
    /// Twiddle factors take longer to compute than a transform, and depend on its length alone.
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// The transform of `length` real numbers: `length / 2 + 1` sums `Σ x_n e^(-i 2π k n / length)`.
#[must_use]
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_forward(length))
}

/// Its inverse, but for the factor `1 / length`.
#[must_use]
pub fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_inverse(length))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn it_is_the_sum_of_its_definition_and_comes_back() {
        // A power of two, one of two, three and five, and a prime.
        for length in [64, 30, 37] {
            let values: Vec<f64> = (0..length).map(|n| ((n * n) as f64 * 0.7).sin()).collect();
            let transform = forward(length);
            let mut bins = transform.make_output_vec();
            transform.process(&mut values.clone(), &mut bins).unwrap();
            for (k, bin) in bins.iter().enumerate() {
                let turn = |n: usize| -TAU * (k * n % length) as f64 / length as f64;
                let sum: Complex<f64> =
                    values.iter().enumerate().map(|(n, x)| Complex::from_polar(*x, turn(n))).sum();
                // Some hundred roundings of numbers below 64.
                assert!((bin - sum).norm() < 1e-12, "{length}: {k}");
            }
            let back = inverse(length);
            let mut again = back.make_output_vec();
            back.process(&mut bins, &mut again).unwrap();
            assert!(again.iter().zip(&values).all(|(a, b)| (a / length as f64 - b).abs() < 1e-14));
        }
    }
}
