//! Tables of numbers that can be set: one struct a module, with what each number means, its default and a check. What is set comes in with the
//! [configuration](crate::monitor::MonitorConfig::tuning), so that leaving a mechanism out, or another threshold, is a run and not a build.

/// A number of such a table, or a few that belong together.
pub(crate) trait Tunable: Copy {
    /// The first of its numbers that cannot be meant: not finite, or of another sign than the default; none where nothing is wrong.
    fn implausible(self, default: Self) -> Option<f64>;
}

impl Tunable for f64 {
    fn implausible(self, default: Self) -> Option<f64> {
        let has_sign = if default == 0.0 { self >= 0.0 } else { self * default > 0.0 };
        (!(self.is_finite() && has_sign)).then_some(self)
    }
}

impl Tunable for u32 {
    fn implausible(self, default: Self) -> Option<f64> {
        f64::from(self).implausible(f64::from(default))
    }
}

impl<const N: usize> Tunable for [f64; N] {
    fn implausible(self, default: Self) -> Option<f64> {
        self.into_iter().zip(default).find_map(|(value, default)| value.implausible(default))
    }
}

/// Makes the table: the struct, its `DEFAULT`, names and meanings of its fields, and the check. In serialized form a field that is missing has
/// its default, and one of an unknown name is refused.
macro_rules! tuning {
    ($(#[$about:meta])* pub struct $name:ident { $($(#[doc = $doc:literal])+ $field:ident: $kind:ty = $value:expr,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, $crate::memory::Blank)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
        pub struct $name { $($(#[doc = $doc])+ pub $field: $kind,)* }

        impl $name {
            /// What holds where nothing else is set.
            pub const DEFAULT: Self = Self { $($field: $value,)* };

            /// Name and meaning of each field, in their order.
            pub const FIELDS: &'static [(&'static str, &'static str)] =
                &[$((stringify!($field), concat!($($doc),+)),)*];

            /// Refuses what cannot be meant.
            pub(crate) fn check(&self) -> Result<(), $crate::model::ParameterError> {
                $(if let Some(value) = $crate::tuning::Tunable::implausible(self.$field, Self::DEFAULT.$field) {
                    let expected = "a number of the same sign as its default";
                    return Err($crate::model::ParameterError { name: stringify!($field), value, expected });
                })*
                Ok(())
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self::DEFAULT
            }
        }
    };
}

pub(crate) use tuning;

#[cfg(test)]
mod tests {
    use crate::tuning::Tunable;

    #[test]
    fn a_number_keeps_the_sign_of_its_default() {
        assert_eq!(0.5.implausible(0.3), None);
        assert_eq!((-0.5).implausible(-0.3), None);
        assert_eq!(0.0.implausible(0.0), None);
        assert_eq!(7_u32.implausible(12), None);
        for (value, default) in [(0.0, 0.3), (-0.5, 0.3), (0.5, -0.3), (-0.1, 0.0), (f64::INFINITY, 1.0)] {
            assert_eq!(value.implausible(default), Some(value));
        }
        assert!(f64::NAN.implausible(0.3).is_some_and(f64::is_nan));
        assert_eq!([1.0, -2.0].implausible([1.0, 2.0]), Some(-2.0));
        assert_eq!(0_u32.implausible(12), Some(0.0));
    }
}
