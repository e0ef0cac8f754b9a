//! Student's t, Fisher's F and chi-square, as far as intervals and tests need them, for up to millions of degrees of freedom,
//! where general libraries lose their digits. Called by the identifications; knows no data.

use libm::lgamma;

/// Lentz's evaluation of the continued fraction `1 / (1 + a_1 / (1 + a_2 / ...))`.
fn continued_fraction(term: impl Fn(usize) -> f64) -> f64 {
    const TINY: f64 = 1e-300;
    let away_from_zero = |x: f64| if x.abs() < TINY { TINY } else { x };
    let (mut c, mut d, mut value) = (1.0, 0.0, 1.0);
    for i in 1..=500 {
        let a = term(i);
        d = 1.0 / away_from_zero(1.0 + a * d);
        c = away_from_zero(1.0 + a / c);
        value *= c * d;
        if (c * d - 1.0).abs() < 1e-14 {
            break;
        }
    }
    1.0 / value
}

/// Regularised incomplete beta function `I_x(a, b)`.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if !(x > 0.0) {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    // The fraction converges fast on this side of the mean only.
    if x > (a + 1.0) / (a + b + 2.0) { 1.0 - below_mean(1.0 - x, b, a) } else { below_mean(x, a, b) }
}

fn below_mean(x: f64, a: f64, b: f64) -> f64 {
    let ln_front = lgamma(a + b) - lgamma(a) - lgamma(b) + a * x.ln() + b * (1.0 - x).ln();
    let term = |i: usize| {
        let m = (i / 2) as f64;
        if i.is_multiple_of(2) {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        }
    };
    ln_front.exp() / a * continued_fraction(term)
}

/// Probability that Student's t with `dof` degrees of freedom is farther from zero than `t`.
pub(super) fn t_beyond(t: f64, dof: f64) -> f64 {
    incomplete_beta(dof / (dof + t * t), 0.5 * dof, 0.5)
}

/// The `t` that is exceeded in size with probability `beyond`.
pub(super) fn t_quantile(beyond: f64, dof: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while t_beyond(high, dof) > beyond && high < 1e9 {
        high *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if t_beyond(middle, dof) > beyond { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Probability that Fisher's F with `upper` and `lower` degrees of freedom is larger than `f`.
pub(super) fn f_beyond(f: f64, upper: f64, lower: f64) -> f64 {
    incomplete_beta(lower / (lower + upper * f.max(0.0)), 0.5 * lower, 0.5 * upper)
}

/// Probability that chi-square with `dof` degrees of freedom is larger than `x`: the limit of F for a variance that is known.
pub(super) fn chi_square_beyond(x: f64, dof: f64) -> f64 {
    if !(x > 0.0) {
        return 1.0;
    }
    let (a, y) = (0.5 * dof, 0.5 * x);
    let front = (a * y.ln() - y - lgamma(a)).exp();
    // Series of the lower part; all terms are positive.
    let (mut term, mut sum, mut i) = (1.0 / a, 1.0 / a, a);
    while term > 1e-16 * sum && i < a + 10_000.0 {
        i += 1.0;
        term *= y / i;
        sum += term;
    }
    (1.0 - front * sum).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_printed_tables() {
        // Two-sided 5 %: any table of Student's t.
        for (dof, t) in [(1.0, 12.7062), (2.0, 4.3027), (3.0, 3.1824), (10.0, 2.2281), (30.0, 2.0423)] {
            assert!((t_quantile(0.05, dof) - t).abs() < 1e-4, "{dof}");
        }
        assert!((t_quantile(0.05, 1e7) - 1.959_964).abs() < 1e-5);
        // Upper 5 % points of F and chi-square, printed to four or five digits; that of 33.5 degrees from another program.
        for (f, upper, lower) in [(10.128, 1.0, 3.0), (3.4780, 4.0, 10.0), (2.3848, 6.0, 33.5)] {
            assert!((f_beyond(f, upper, lower) - 0.05).abs() < 1e-5, "{f}");
        }
        for (x, dof) in [(3.8415, 1.0), (5.9915, 2.0), (18.307, 10.0)] {
            assert!((chi_square_beyond(x, dof) - 0.05).abs() < 1e-5, "{x}");
        }
    }

    #[test]
    fn special_cases_have_closed_forms() {
        // t with one degree of freedom is Cauchy's; chi-square with two is exponential; F(1, n) is t squared.
        for t in [0.1, 1.0, 5.0, 40.0] {
            assert!((t_beyond(t, 1.0) - (1.0 - 2.0 / std::f64::consts::PI * f64::atan(t))).abs() < 1e-12);
            assert!((chi_square_beyond(t, 2.0) - f64::exp(-0.5 * t)).abs() < 1e-12);
            assert!((f_beyond(t * t, 1.0, 7.0) - t_beyond(t, 7.0)).abs() < 1e-12);
        }
    }
}
