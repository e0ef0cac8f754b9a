//! Columns and cells of a table, independent of its file format.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number that may be missing.
    Number,
    Flag,
    Label,
}

/// One value. A number that is NaN is written as missing: an empty cell, a null.
#[derive(Debug, Clone, Copy)]
pub enum Cell<'a> {
    /// A number; NaN where missing.
    Number(f64),
    Flag(bool),
    Label(&'a str),
}

impl Cell<'_> {
    pub fn kind(&self) -> Kind {
        match self {
            Self::Number(_) => Kind::Number,
            Self::Flag(_) => Kind::Flag,
            Self::Label(_) => Kind::Label,
        }
    }
}
