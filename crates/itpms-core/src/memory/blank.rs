//! Memory before it is configured: zeros, `false` and `None`, as constants, so that a `static` of them costs no
//! flash and building it no stack.

use nalgebra::{ArrayStorage, Complex, SMatrix};

use crate::real::Real;

/// A type whose memory can be there before anything is known. Nothing may be read from it but that it is not configured. Structs and enums
/// derive it.
pub(crate) trait Blank {
    const BLANK: Self;
}

impl<T: Real> Blank for T {
    const BLANK: Self = T::ZERO;
}

impl Blank for bool {
    const BLANK: Self = false;
}

impl Blank for u8 {
    const BLANK: Self = 0;
}

impl Blank for u32 {
    const BLANK: Self = 0;
}

impl Blank for u64 {
    const BLANK: Self = 0;
}

impl Blank for usize {
    const BLANK: Self = 0;
}

impl<X> Blank for Option<X> {
    const BLANK: Self = None;
}

impl<X: Blank, const N: usize> Blank for [X; N] {
    const BLANK: Self = [X::BLANK; N];
}

impl<T: Real> Blank for Complex<T> {
    const BLANK: Self = Self { re: T::ZERO, im: T::ZERO };
}

impl<X: Blank + Copy, const R: usize, const C: usize> Blank for SMatrix<X, R, C> {
    const BLANK: Self = Self::from_array_storage(ArrayStorage([[X::BLANK; R]; C]));
}
