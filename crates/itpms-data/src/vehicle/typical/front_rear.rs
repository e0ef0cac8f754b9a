//! Values of an axle, front and rear: one value for both, or one for each.

use std::fmt;
use std::str::FromStr;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontRear<T> {
    pub front: T,
    pub rear: T,
}

impl<T: Copy> FrontRear<T> {
    pub fn both(value: T) -> Self {
        Self { front: value, rear: value }
    }

    pub fn axles(self) -> [T; 2] {
        [self.front, self.rear]
    }

    /// `230`, or `230,250`: front, rear. `parse` reads one value. Errors: those of `parse`.
    pub fn read<E>(text: &str, parse: impl Fn(&str) -> Result<T, E>) -> Result<Self, E> {
        match text.split_once(',') {
            None => parse(text.trim()).map(Self::both),
            Some((front, rear)) => Ok(Self { front: parse(front.trim())?, rear: parse(rear.trim())? }),
        }
    }
}

impl<T: FromStr + Copy> FromStr for FrontRear<T> {
    type Err = T::Err;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::read(text, str::parse)
    }
}

impl<T: fmt::Display + PartialEq> fmt::Display for FrontRear<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.front == self.rear {
            return self.front.fmt(f);
        }
        write!(f, "{} front, {} rear", self.front, self.rear)
    }
}

#[cfg(test)]
mod tests {
    use super::super::TireSize;
    use super::*;

    #[test]
    fn one_for_both_or_one_for_each() {
        let tires: FrontRear<TireSize> = "225/45R18, 255/40R18".parse().unwrap();
        assert_eq!([tires.front.width_mm, tires.rear.width_mm], [225.0, 255.0]);
        assert_eq!(tires.to_string(), "225/45R18 front, 255/40R18 rear");
        assert_eq!("230".parse(), Ok(FrontRear::both(230.0)));
        for text in ["230,", "230,250,250", "", ",230"] {
            assert!(text.parse::<FrontRear<f64>>().is_err(), "{text}");
        }
    }
}
