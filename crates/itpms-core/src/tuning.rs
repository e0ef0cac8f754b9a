//! Tables of numbers that can be set: one struct a module, with what each number means, its default and a check. What is set comes in with the
//! [configuration](crate::monitor::MonitorConfig::tuning), so that leaving a mechanism out, or another threshold, is a run and not a build.

/// A number of such a table, or a few that belong together.
pub(crate) trait Tunable: Copy {
    /// As an array of numbers.
    type Numbers: AsRef<[f64]>;

    fn numbers(self) -> Self::Numbers;

    /// Of as many numbers as it has.
    fn of(numbers: &[f64]) -> Option<Self>;

    /// The first of its numbers that cannot be meant; none where nothing is wrong.
    fn implausible(self, default: Self) -> Option<f64> {
        first_implausible(self.numbers().as_ref(), default.numbers().as_ref())
    }
}

/// The first number that is not finite, or of another sign than its default. In the program once, not once a field.
#[inline(never)]
fn first_implausible(numbers: &[f64], defaults: &[f64]) -> Option<f64> {
    numbers.iter().zip(defaults).find_map(|(&value, &default)| {
        let has_sign = if default == 0.0 { value >= 0.0 } else { value * default > 0.0 };
        (!(value.is_finite() && has_sign)).then_some(value)
    })
}

impl Tunable for f64 {
    type Numbers = [f64; 1];

    fn numbers(self) -> [f64; 1] {
        [self]
    }

    fn of(numbers: &[f64]) -> Option<Self> {
        <[f64; 1]>::of(numbers).map(|[number]| number)
    }
}

impl Tunable for u32 {
    type Numbers = [f64; 1];

    fn numbers(self) -> [f64; 1] {
        [f64::from(self)]
    }

    fn of(numbers: &[f64]) -> Option<Self> {
        let number = f64::of(numbers)?;
        (number >= 0.0 && number <= f64::from(Self::MAX) && number % 1.0 == 0.0).then_some(number as Self)
    }
}

impl<const N: usize> Tunable for [f64; N] {
    type Numbers = Self;

    fn numbers(self) -> Self {
        self
    }

    fn of(numbers: &[f64]) -> Option<Self> {
        numbers.try_into().ok()
    }
}

/// Makes the table: the struct, its `DEFAULT`, its fields by their names, and the check.
macro_rules! tuning {
    ($(#[$about:meta])* pub struct $name:ident { $($(#[doc = $doc:literal])+ $field:ident: $kind:ty = $value:expr,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, $crate::memory::Blank)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name { $($(#[doc = $doc])+ pub $field: $kind,)* }

        impl $name {
            /// What holds where nothing else is set.
            pub const DEFAULT: Self = Self { $($field: $value,)* };

            /// Calls for each field, in their order, with its name, its meaning and its numbers: one, or a few that belong together.
            pub fn each(&self, mut call: impl FnMut(&'static str, &'static str, &[f64])) {
                use $crate::tuning::Tunable as _;
                $(call(stringify!($field), concat!($($doc),+), self.$field.numbers().as_ref());)*
            }

            /// Sets the field of this name; `false`: there is none, or it has another number of numbers.
            #[must_use]
            pub fn set(&mut self, name: &str, numbers: &[f64]) -> bool {
                use $crate::tuning::Tunable;
                match name {
                    $(stringify!($field) => Tunable::of(numbers).map(|value| self.$field = value).is_some(),)*
                    _ => false,
                }
            }

            /// Refuses what cannot be meant.
            ///
            /// # Errors
            /// A number that is not finite or has another sign than its default.
            pub fn check(&self) -> Result<(), $crate::model::ParameterError> {
                let mut wrong = None;
                $(wrong = wrong.or_else(|| {
                    Some((stringify!($field), $crate::tuning::Tunable::implausible(self.$field, Self::DEFAULT.$field)?))
                });)*
                let expected = "a number of the same sign as its default";
                wrong.map_or(Ok(()), |(name, value)| Err($crate::model::ParameterError { name, value, expected }))
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

    #[test]
    fn fields_are_set_by_their_names() {
        let mut tuning = crate::warning::Tuning::DEFAULT;
        let mut names = 0;
        crate::warning::Tuning::DEFAULT.each(|name, meaning, numbers| {
            assert!(!meaning.trim().is_empty(), "{name}");
            let twice: [f64; 2] = core::array::from_fn(|i| numbers.get(i).map_or(0.0, |number| 2.0 * number));
            assert!(tuning.set(name, &twice[..numbers.len()]), "{name}");
            assert!(!tuning.set(name, &[1.0; 3]), "{name}");
            names += 1;
        });
        assert!(names > 10 && !tuning.set("nothing", &[1.0]));
        assert_eq!(tuning.low.clear_s, 2.0 * crate::warning::Tuning::DEFAULT.low.clear_s);
        assert_eq!(tuning.check(), Ok(()));
        assert!(tuning.set("standing_s", &[-1.0]));
        assert_eq!(tuning.check().unwrap_err().name, "standing_s");
        assert_eq!(u32::of(&[2.5]).or(u32::of(&[-1.0])).or(u32::of(&[f64::NAN])), None);
    }
}
