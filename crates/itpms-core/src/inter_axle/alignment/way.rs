//! A place on the way that the car goes.

use crate::memory::Blank;
use crate::real::Real;

/// A place on the way: whole eighths of a micrometer, modulo the 512 m that 2^32 of them are. Sums of whole numbers lose nothing
/// however far the car has come, and cost a controller no double precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Way(u32);

impl Blank for Way {
    const BLANK: Self = Self(0);
}

impl Way {
    const PER_M: f64 = (1 << 23) as f64;

    /// The place so many meters further on, less than 256.
    pub(crate) fn ahead<T: Real>(self, m: T) -> Self {
        Self(self.0.wrapping_add_signed((m * T::lit(Self::PER_M)).round().to_whole()))
    }

    /// By how many meters it lies beyond another place that is less than 256 m away.
    pub(crate) fn beyond<T: Real>(self, other: Self) -> T {
        let parts = self.0.wrapping_sub(other.0).cast_signed();
        let m = T::whole(parts.unsigned_abs()) * T::lit(1.0 / Self::PER_M);
        if parts < 0 { -m } else { m }
    }

    /// Whether it lies beyond another place that is less than 256 m away.
    pub(crate) fn is_beyond(self, other: Self) -> bool {
        self.0.wrapping_sub(other.0).cast_signed() > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_is_exact_however_long_and_across_its_lap() {
        let (mut way, step_m) = (Way::BLANK, 0.062_5_f32);
        for k in 1..100_000u32 {
            let before = way;
            way = way.ahead(step_m);
            assert!(
                way.is_beyond(before) && !before.is_beyond(way) && way.beyond::<f32>(before) == step_m,
                "{k}"
            );
        }
        assert_eq!(way.ahead(2.7_f64).ahead(-2.7_f64), way);
        assert!((way.ahead(-2.7_f32).beyond::<f64>(way) + 2.7).abs() < 1e-6);
    }
}
