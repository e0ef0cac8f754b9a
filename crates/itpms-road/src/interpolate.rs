//! A road height between samples: moves the record back by the sensors' delay.
//!
//! Called by [`crate::recorder`]; knows points in time and heights, nothing else.

use itpms_core::Real;

/// Points of the widest stencil.
pub(crate) const WIDTH: usize = 8;
/// Points on each side of the wanted time.
pub(crate) const HALF: usize = WIDTH / 2;
/// Intervals may differ by this factor before a straight line is safer than a polynomial.
const UNEVEN: f64 = 1.6;

/// Height at `at` (any unit of time) by Lagrange's polynomial through up to eight points, strictly increasing in
/// time, of which the two around `at` stand at `left` and `left + 1`. Falls back to the straight line between those
/// two where the points are unevenly spaced: a polynomial across a gap swings.
pub(crate) fn height_at<T: Real>(times: &[T], heights: &[T], left: usize, at: T) -> T {
    let (Some(&t0), Some(&t1)) = (times.get(left), times.get(left + 1)) else {
        return heights.last().copied().unwrap_or_else(T::zero);
    };
    if !evenly_spaced(times) {
        let share = (at - t0) / (t1 - t0);
        return heights[left] + share * (heights[left + 1] - heights[left]);
    }
    let mut sum = T::zero();
    for (i, (&t_i, &height)) in times.iter().zip(heights).enumerate() {
        let mut weight = T::one();
        for (j, &t_j) in times.iter().enumerate() {
            if i != j {
                weight *= (at - t_j) / (t_i - t_j);
            }
        }
        sum += weight * height;
    }
    sum
}

fn evenly_spaced<T: Real>(times: &[T]) -> bool {
    let mut shortest = T::max_value().unwrap_or_else(T::one);
    let mut longest = T::zero();
    for pair in times.windows(2) {
        let step = pair[1] - pair[0];
        shortest = shortest.min(step);
        longest = longest.max(step);
    }
    longest <= T::lit(UNEVEN) * shortest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_its_degree_is_exact_and_a_gap_is_crossed_in_a_line() {
        let times: [f64; 8] = core::array::from_fn(|i| i as f64 + 0.1 * (i as f64).sin());
        let polynomial = |t: f64| 1.0 + t * (0.5 + t * (-0.2 + t * (0.1 + t * (0.02 - 0.003 * t))));
        let heights = times.map(polynomial);
        assert!((height_at(&times, &heights, 3, 3.4) - polynomial(3.4)).abs() < 1e-9);
        let mut gap = times;
        for t in &mut gap[4..] {
            *t += 10.0;
        }
        let share = (5.0 - gap[3]) / (gap[4] - gap[3]);
        let line = heights[3] + share * (heights[4] - heights[3]);
        assert!((height_at(&gap, &heights, 3, 5.0) - line).abs() < 1e-12);
    }
}
