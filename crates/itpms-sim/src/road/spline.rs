//! The natural cubic spline through measured points, twice continuously differentiable: a measured profile's
//! points are 0.25 m apart, and a polygon through them would hammer the wheel at every one.
//!
//! Called by [`MeasuredProfile`](super::MeasuredProfile), which has checked the points.

/// Points with the second derivatives of the natural spline.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Spline {
    x: Vec<f64>,
    y: Vec<f64>,
    second: Vec<f64>,
}

impl Spline {
    /// `x` increases strictly; both have the same length, at least 2.
    pub(crate) fn natural(x: Vec<f64>, y: Vec<f64>) -> Self {
        let second = second_derivatives(&x, &y);
        Self { x, y, second }
    }

    /// Value at a position, which is first brought within the points.
    pub(crate) fn value(&self, x: f64) -> f64 {
        let i = self.x.partition_point(|&p| p <= x).clamp(1, self.x.len() - 1);
        let (x0, x1) = (self.x[i - 1], self.x[i]);
        let h = x1 - x0;
        let b = ((x - x0) / h).clamp(0.0, 1.0);
        let a = 1.0 - b;
        let curvature = (a * a * a - a) * self.second[i - 1] + (b * b * b - b) * self.second[i];
        a * self.y[i - 1] + b * self.y[i] + curvature * h * h / 6.0
    }
}

/// Solves the tridiagonal system that makes the first derivative continuous (elimination without pivoting: the
/// matrix is diagonally dominant).
fn second_derivatives(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let mut second = vec![0.0; n];
    let mut upper = vec![0.0; n];
    for i in 1..n - 1 {
        let (left, right) = (x[i] - x[i - 1], x[i + 1] - x[i]);
        let slopes = (y[i + 1] - y[i]) / right - (y[i] - y[i - 1]) / left;
        let pivot = 2.0 * (left + right) - left * upper[i - 1];
        upper[i] = right / pivot;
        second[i] = (6.0 * slopes - left * second[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        second[i] -= upper[i] * second[i + 1];
    }
    second
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_with_straight_ends_is_reproduced() {
        // y = x³ - 3 L x²/2 has y'' = 6x - 3L; the natural spline needs y'' = 0 at the ends, which
        // y = sin-like pieces lack; instead check on a sine with whole half-waves, y'' = 0 at both ends.
        let n = 40;
        let x: Vec<f64> = (0..=n).map(|i| f64::from(i) / f64::from(n)).collect();
        let y: Vec<f64> = x.iter().map(|x| (std::f64::consts::TAU * x).sin()).collect();
        let spline = Spline::natural(x, y);
        for i in 0..1000 {
            let x = f64::from(i) / 1000.0;
            // Error of a cubic spline: at most 5/384 h^4 max|y''''| = 5/384 (1/40)^4 (2π)^4 = 7.9e-6.
            assert!((spline.value(x) - (std::f64::consts::TAU * x).sin()).abs() < 8e-6);
        }
    }

    #[test]
    fn slope_and_curvature_are_continuous_at_uneven_points() {
        let spline = Spline::natural(vec![0.0, 1.0, 1.5, 4.0, 4.2, 6.0], vec![0.0, 2.0, -1.0, 0.5, 0.7, 0.0]);
        let d = 1e-4;
        for x in [1.0, 1.5, 4.0, 4.2] {
            let v = |o: f64| spline.value(x + o * d);
            let (left, right) = ((v(0.0) - v(-1.0)) / d, (v(1.0) - v(0.0)) / d);
            // Curvatures are below 100 here: the one-sided slopes differ by at most 100 d.
            assert!((left - right).abs() < 100.0 * d, "{x}");
            let (before, after) = (v(0.0) - 2.0 * v(-1.0) + v(-2.0), v(2.0) - 2.0 * v(1.0) + v(0.0));
            assert!((before - after).abs() / (d * d) < 0.5, "{x}");
        }
        assert_eq!((spline.value(-1.0), spline.value(9.0)), (0.0, 0.0));
    }
}
