//! A value that may be absent and yet has its place: an `Option` that is filled where it lies. Written and read as one.

use core::fmt;

use super::Blank;

#[derive(Clone, Copy)]
pub(crate) struct Placed<X> {
    present: bool,
    value: X,
}

impl<X: Blank> Blank for Placed<X> {
    const BLANK: Self = Self { present: false, value: X::BLANK };
}

impl<X> Placed<X> {
    pub(crate) fn as_ref(&self) -> Option<&X> {
        self.present.then_some(&self.value)
    }

    pub(crate) fn as_mut(&mut self) -> Option<&mut X> {
        self.present.then_some(&mut self.value)
    }

    /// The value in its place, present or not.
    pub(crate) fn value(&self) -> &X {
        &self.value
    }

    /// Absent from here on.
    pub(crate) fn clear(&mut self) {
        self.present = false;
    }

    /// Present from here on, as `configure` makes it out of whatever was there.
    pub(crate) fn place(&mut self, configure: impl FnOnce(&mut X)) {
        configure(&mut self.value);
        self.present = true;
    }

    /// The same where that may fail: then it is absent.
    pub(crate) fn try_place<E>(&mut self, configure: impl FnOnce(&mut X) -> Result<(), E>) -> Result<(), E> {
        self.present = false;
        configure(&mut self.value)?;
        self.present = true;
        Ok(())
    }
}

impl<X: Copy> Placed<X> {
    pub(crate) fn get(&self) -> Option<X> {
        self.as_ref().copied()
    }

    /// Present or absent as this is.
    pub(crate) fn set(&mut self, value: Option<X>) {
        match value {
            Some(value) => self.place(|place| *place = value),
            None => self.clear(),
        }
    }
}

impl<X: PartialEq> PartialEq for Placed<X> {
    fn eq(&self, other: &Self) -> bool {
        self.as_ref() == other.as_ref()
    }
}

impl<X: fmt::Debug> fmt::Debug for Placed<X> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_ref().fmt(f)
    }
}

impl<'a, X> IntoIterator for &'a Placed<X> {
    type Item = &'a X;
    type IntoIter = core::option::IntoIter<&'a X>;

    fn into_iter(self) -> Self::IntoIter {
        self.as_ref().into_iter()
    }
}

impl<'a, X> IntoIterator for &'a mut Placed<X> {
    type Item = &'a mut X;
    type IntoIter = core::option::IntoIter<&'a mut X>;

    fn into_iter(self) -> Self::IntoIter {
        self.as_mut().into_iter()
    }
}

#[cfg(feature = "serde")]
impl<X: serde::Serialize> serde::Serialize for Placed<X> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.as_ref().serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de, X: Blank + serde::Deserialize<'de>> serde::Deserialize<'de> for Placed<X> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Option::<X>::deserialize(deserializer)?;
        Ok(value.map_or(Self::BLANK, |value| Self { present: true, value }))
    }
}
