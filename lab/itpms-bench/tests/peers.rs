//! The peers compute the same: what is compared in cost is one filter, not several.

use itpms_bench::peers::corner::Drive;
use itpms_bench::peers::{Peer, STEPS, on_kfilter, on_minikalman, on_nalgebra, ours};

/// What a filter finds after every sample.
fn run<P: Peer>(steps: usize) -> Vec<[f64; 6]> {
    let (mut filter, mut drive) = (P::fresh(), Drive::default());
    (0..steps)
        .map(|_| {
            filter.step(drive.sample());
            filter.found()
        })
        .collect()
}

/// The largest difference of every quantity over its largest value.
fn apart(found: &[[f64; 6]], expected: &[[f64; 6]]) -> [f64; 6] {
    std::array::from_fn(|i| {
        let size = expected.iter().fold(0.0f64, |size, at| size.max(at[i].abs()));
        found.iter().zip(expected).fold(0.0f64, |worst, (found, expected)| {
            let apart = (found[i] - expected[i]).abs() / size;
            if apart.is_nan() { f64::INFINITY } else { worst.max(apart) }
        })
    })
}

fn agree(name: &str, found: &[[f64; 6]], expected: &[[f64; 6]], tolerance: f64) {
    let apart = apart(found, expected);
    let listed = apart.map(|apart| format!("{apart:.0e}")).join(", ");
    println!("{name}: {listed}");
    assert!(apart.iter().all(|apart| *apart <= tolerance), "{name}: {listed}");
}

/// A second long; some steps later the published filter has walked off, in every program alike (`docs/math/ekf-ui.md`, section 4). By
/// then the factor has acted and the stiffness has moved far.
const A_SECOND: usize = 500;

#[test]
fn every_step_is_the_published_filters() {
    let expected = run::<ours::Dense<f64>>(A_SECOND);
    // They round otherwise: 4e-12 is found, and what the filter amplifies of one rounding, 1e-16, is allowed tenfold and more.
    agree("closed form", &run::<ours::Lean<f64>>(A_SECOND), &expected, 1e-10);
    agree("nalgebra", &run::<on_nalgebra::Step<f64>>(A_SECOND), &expected, 1e-10);
    agree("kfilter", &run::<on_kfilter::Step<f64>>(A_SECOND), &expected, 1e-10);
    agree("minikalman", &run::<on_minikalman::Step<f64>>(A_SECOND), &expected, 1e-10);
}

#[test]
fn the_factor_acts_and_the_stiffness_moves() {
    // Or else a filter that does nothing would agree.
    let stiffness = run::<ours::Dense<f64>>(A_SECOND).last().expect("samples")[4];
    assert!((stiffness / 220_000.0 - 1.0).abs() > 0.5, "{stiffness}");
    let (mut input, mut drive) = (on_nalgebra::Step::<f64>::fresh(), Drive::default());
    let largest = (0..A_SECOND).fold(0.0f64, |largest, _| {
        input.step(drive.sample());
        largest.max(input.lambda())
    });
    assert!(largest > 1.2, "{largest}");
}

#[test]
fn the_ordinary_filters_agree_among_themselves() {
    let expected = run::<on_nalgebra::Ordinary<f64>>(A_SECOND);
    agree("kfilter", &run::<on_kfilter::Ordinary<f64>>(A_SECOND), &expected, 1e-11);
    agree("minikalman", &run::<on_minikalman::Ordinary<f64>>(A_SECOND), &expected, 1e-11);
}

#[test]
fn single_precision_lives_for_the_steps_that_are_counted() {
    // A rounding is 6e-8; the dense filter, which forms I - HK, loses most of seven digits.
    let expected = run::<ours::Dense<f64>>(STEPS);
    agree("dense", &run::<ours::Dense<f32>>(STEPS), &expected, 5e-3);
    agree("closed form", &run::<ours::Lean<f32>>(STEPS), &expected, 1e-4);
    agree("nalgebra", &run::<on_nalgebra::Step<f32>>(STEPS), &expected, 1e-4);
    agree("kfilter", &run::<on_kfilter::Step<f32>>(STEPS), &expected, 1e-4);
    agree("minikalman", &run::<on_minikalman::Step<f32>>(STEPS), &expected, 1e-4);
    let expected = run::<on_nalgebra::Ordinary<f64>>(STEPS);
    agree("ordinary, nalgebra", &run::<on_nalgebra::Ordinary<f32>>(STEPS), &expected, 5e-3);
    agree("ordinary, kfilter", &run::<on_kfilter::Ordinary<f32>>(STEPS), &expected, 5e-3);
    agree("ordinary, minikalman", &run::<on_minikalman::Ordinary<f32>>(STEPS), &expected, 5e-3);
}
