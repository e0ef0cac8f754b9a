//! The scalar the core computes with: `f32` on a controller, `f64` on a workstation.

use nalgebra::{ComplexField, RealField};

/// A real scalar. Everything mathematical comes from [`RealField`]; this adds constants and the way back.
pub trait Real: RealField + Copy {
    /// Zero, where it has to be a constant.
    const ZERO: Self;
    /// The constant `value`, rounded to this type.
    fn lit(value: f64) -> Self;
    /// A whole number, without going through `f64`, which a controller has to do in software.
    fn whole(value: u32) -> Self;
    /// Its whole part, towards zero, within the bounds of the type; zero for NaN.
    fn to_whole(self) -> i32;
    /// This value, widened (or kept) to `f64`.
    fn to_f64(self) -> f64;
    /// The largest relative spacing of this type around one.
    fn epsilon() -> Self;
    /// The larger of this and `least`, which stands for NaN: what [`RealField::max`] gives, without a call.
    fn at_least(self, least: Self) -> Self {
        if self > least { self } else { least }
    }
    /// The smaller of this and `most`, which stands for NaN.
    fn at_most(self, most: Self) -> Self {
        if self < most { self } else { most }
    }
    /// `e^x` by a polynomial; right to 3e-7 of it in `f32`, to 1e-15 in `f64`.
    fn exp_fast(self) -> Self;
    /// `ln x`; in `f32` by a polynomial, right to 2e-7 of the larger of itself and one.
    fn ln_fast(self) -> Self;
    /// `(sin x, cos x)`; in `f32` by polynomials, right to 2e-7 where `|x| < 100`.
    fn sin_cos_fast(self) -> (Self, Self);
}

/// Added to and taken off a number, it leaves the nearest integer: 1.5 * 2^23.
const ROUND: f32 = 12_582_912.0;
/// The same of a double: 1.5 * 2^52.
pub(crate) const ROUND_F64: f64 = 6_755_399_441_055_744.0;
/// Least weight or determinant that differs from zero: nearer to it single precision ends.
pub(crate) const SMALLEST: f64 = 1e-30;
/// `ln 2` with eleven zeros at its end, and what is missing.
const LN_2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fefa_3800);
const LN_2_LOW: f64 = f64::from_bits(0x3d2e_f357_93c7_6730);

impl Real for f32 {
    const ZERO: Self = 0.0;
    fn lit(value: f64) -> Self {
        value as f32
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn whole(value: u32) -> Self {
        value as f32
    }
    fn to_whole(self) -> i32 {
        self as i32
    }
    fn epsilon() -> Self {
        f32::EPSILON
    }
    #[inline]
    fn exp_fast(self) -> Self {
        let t = self * core::f32::consts::LOG2_E;
        if !(-125.0..125.0).contains(&t) {
            return ComplexField::exp(self);
        }
        // e^x = 2^n 2^f with |f| <= 1/2, and the series of 2^f.
        let n = (t + ROUND) - ROUND;
        let f = t - n;
        let high = 0.055_504_11 + f * (0.009_618_13 + f * (0.001_333_356 + f * 0.000_154_035_3));
        let power = 1.0 + f * (core::f32::consts::LN_2 + f * (0.240_226_5 + f * high));
        // The exponent lies in the upper nine bits, of a positive number.
        f32::from_bits(power.to_bits().wrapping_add_signed((n as i32) << 23))
    }
    #[inline]
    fn ln_fast(self) -> Self {
        if !(f32::MIN_POSITIVE..f32::INFINITY).contains(&self) {
            return ComplexField::ln(self);
        }
        // x = 2^e (1 + m) with 1 + m between 2/3 and 4/3; the polynomial of Cephes' logf.
        let bits = self.to_bits() as i32;
        let e = (bits - 0x3f2a_aaab) >> 23;
        let m = f32::from_bits((bits - (e << 23)) as u32) - 1.0;
        let low =
            0.142_493_23 + m * (-0.124_201_41 + m * (0.116_769_99 + m * (-0.115_146_1 + m * 0.070_376_836)));
        let p = 0.333_333_3 + m * (-0.249_999_94 + m * (0.200_007_15 + m * (-0.166_680_58 + m * low)));
        m + m * m * (m * p - 0.5) + e as f32 * core::f32::consts::LN_2
    }
    #[inline]
    fn sin_cos_fast(self) -> (Self, Self) {
        if !(self.abs() < 1e4) {
            return ComplexField::sin_cos(self);
        }
        // Less a multiple of a right angle, which is taken off in three parts; then the polynomials of Cephes' sinf and cosf.
        let n = (self * core::f32::consts::FRAC_2_PI + ROUND) - ROUND;
        let x = ((self - n * 1.570_312_5) - n * 4.837_513e-4) - n * 7.549_79e-8;
        let z = x * x;
        let sine = x + x * z * (-0.166_666_55 + z * (8.332_161e-3 - z * 1.951_529_6e-4));
        let cosine = 1.0 - 0.5 * z + z * z * (4.166_664_6e-2 + z * (-1.388_731_6e-3 + z * 2.443_315_7e-5));
        match (n as i32) & 3 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    fn lit(value: f64) -> Self {
        value
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn whole(value: u32) -> Self {
        f64::from(value)
    }
    fn to_whole(self) -> i32 {
        self as i32
    }
    fn epsilon() -> Self {
        f64::EPSILON
    }
    #[inline]
    fn exp_fast(self) -> Self {
        if !(-700.0..700.0).contains(&self) {
            return ComplexField::exp(self);
        }
        // e^x = 2^n e^f with |f| <= (ln 2) / 2; ln 2 in two parts, the first of which n times is exact.
        let n = (self * core::f64::consts::LOG2_E + ROUND_F64) - ROUND_F64;
        let f = (self - n * LN_2_HIGH) - n * LN_2_LOW;
        // The series up to f^13 / 13!, its terms by pairs: what follows is 2e-18.
        let f2 = f * f;
        let f4 = f2 * f2;
        let low = (1.0 + f) + f2 * (0.5 + f * (1.0 / 6.0));
        let middle = (1.0 / 24.0 + f * (1.0 / 120.0)) + f2 * (1.0 / 720.0 + f * (1.0 / 5040.0));
        let high =
            (1.0 / 40_320.0 + f * (1.0 / 362_880.0)) + f2 * (1.0 / 3_628_800.0 + f * (1.0 / 39_916_800.0));
        let highest = 1.0 / 479_001_600.0 + f * (1.0 / 6_227_020_800.0);
        let power = low + f4 * (middle + f4 * (high + f4 * highest));
        f64::from_bits(power.to_bits().wrapping_add_signed((n as i64) << 52))
    }
    fn ln_fast(self) -> Self {
        ComplexField::ln(self)
    }
    fn sin_cos_fast(self) -> (Self, Self) {
        ComplexField::sin_cos(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest of the errors at 200 000 places from `from` to `to`, by `error`.
    fn largest(from: f64, to: f64, error: impl Fn(f32) -> f64) -> f64 {
        let places = (0..=200_000).map(|i| (from + (to - from) * f64::from(i) / 200_000.0) as f32);
        places.map(error).fold(0.0, f64::max)
    }

    #[test]
    fn exponential_and_logarithm_are_as_near_as_they_say() {
        // Against the double's: relative, and the logarithm's where it is large.
        let exp = |x: f32| (f64::from(x.exp_fast()) / f64::from(x).exp() - 1.0).abs();
        // Rounding the exponent costs |x| times half a spacing of single precision.
        assert!(largest(-1.0, 1.0, exp) < 3e-7, "{}", largest(-1.0, 1.0, exp));
        assert!(largest(-80.0, 80.0, |x| exp(x) / f64::from(1.0 + x.abs())) < 3e-7);
        let ln = |x: f32| {
            let right = f64::from(x).ln();
            (f64::from(x.ln_fast()) - right).abs() / right.abs().max(1.0)
        };
        assert!(largest(1e-3, 3.0, ln) < 2e-7, "{}", largest(1e-3, 3.0, ln));
        assert!(largest(-80.0, 80.0, |x| ln(f64::from(x).exp() as f32)) < 2e-7);
    }

    #[test]
    fn the_exponential_of_a_double_is_as_near_as_it_says() {
        let error = |x: f64| (x.exp_fast() / x.exp() - 1.0).abs();
        let worst = (0..=400_000).map(|i| error(-80.0 + 4e-4 * f64::from(i))).fold(0.0, f64::max);
        assert!(worst < 1e-15, "{worst}");
        assert!(error(-699.9) < 1e-15 && error(699.9) < 1e-15 && f64::NAN.exp_fast().is_nan());
        assert!((-1e3f64).exp_fast() == 0.0 && 1e3f64.exp_fast() == f64::INFINITY && 0f64.exp_fast() == 1.0);
    }

    #[test]
    fn sine_and_cosine_are_as_near_as_they_say() {
        let sine = |x: f32| (f64::from(x.sin_cos_fast().0) - f64::from(x).sin()).abs();
        let cosine = |x: f32| (f64::from(x.sin_cos_fast().1) - f64::from(x).cos()).abs();
        assert!(largest(-100.0, 100.0, sine) < 2e-7 && largest(-100.0, 100.0, cosine) < 2e-7);
    }

    #[test]
    fn what_is_no_number_stays_so() {
        assert!(f32::NAN.exp_fast().is_nan() && f32::NAN.ln_fast().is_nan() && (-1.0f32).ln_fast().is_nan());
        assert!(f32::NAN.sin_cos_fast().0.is_nan());
        assert!((-1e3f32).exp_fast() == 0.0 && 1e3f32.exp_fast() == f32::INFINITY);
        assert!(0f32.ln_fast() == f32::NEG_INFINITY && f32::INFINITY.ln_fast() == f32::INFINITY);
    }
}
