//! A set of wheels.

use core::fmt;
use core::ops::BitOr;

use crate::memory::Blank;
use crate::model::Corner;

/// Some of the four wheels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wheels(u8);

impl Wheels {
    /// No wheel.
    pub const NONE: Self = Self(0);
    /// All four.
    pub const ALL: Self = Self(0b1111);

    /// Whether the wheel is in it.
    #[must_use]
    pub fn contains(self, corner: Corner) -> bool {
        self.0 & (1 << corner.index()) != 0
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The wheels in it, in the order of [`Corner::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Corner> {
        Corner::ALL.into_iter().filter(move |corner| self.contains(*corner))
    }
}

impl From<Corner> for Wheels {
    fn from(corner: Corner) -> Self {
        Self(1 << corner.index())
    }
}

impl BitOr for Wheels {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl FromIterator<Corner> for Wheels {
    fn from_iter<I: IntoIterator<Item = Corner>>(corners: I) -> Self {
        corners.into_iter().fold(Self::NONE, |all, corner| all | corner.into())
    }
}

/// `fl rr`.
impl fmt::Display for Wheels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, corner) in self.iter().enumerate() {
            let space = if i > 0 { " " } else { "" };
            write!(f, "{space}{}", corner.label())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_what_was_put_in() {
        for bits in 0..16u8 {
            let chosen = Corner::ALL.into_iter().filter(|corner| bits & (1 << corner.index()) != 0);
            let wheels: Wheels = chosen.clone().collect();
            assert!(wheels.iter().eq(chosen));
            assert_eq!(wheels.is_empty(), bits == 0);
        }
    }
}
