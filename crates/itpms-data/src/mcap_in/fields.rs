//! A message as paths and numbers. Called by the codecs, which walk through a message and say each number that they come to.

use std::fmt::Write as _;

/// Messages inside messages.
const DEEPEST: usize = 16;
/// Elements of a list that are signals of their own: a value per wheel. Longer ones are curves and pictures.
pub(super) const MOST_ELEMENTS: usize = 16;

/// Where a codec is in a message, and who wants to know the numbers there.
pub(super) struct Fields<'a> {
    path: String,
    depth: usize,
    found: &'a mut dyn FnMut(&str, f64),
}

impl<'a> Fields<'a> {
    pub(super) fn new(found: &'a mut dyn FnMut(&str, f64)) -> Self {
        Self { path: String::with_capacity(64), depth: 0, found }
    }

    pub(super) fn number(&mut self, value: f64) {
        (self.found)(&self.path, value);
    }

    /// Goes into a field; `None` where that is too deep.
    pub(super) fn field<T>(&mut self, name: &str, inside: impl FnOnce(&mut Self) -> T) -> Option<T> {
        let separator = if self.path.is_empty() { "" } else { "." };
        self.inside(inside, |path| {
            path.push_str(separator);
            path.push_str(name);
        })
    }

    /// Goes into an element of a list; `None` where that is too deep.
    pub(super) fn element<T>(&mut self, number: usize, inside: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.inside(inside, |path| {
            let _ = write!(path, "[{number}]");
        })
    }

    fn inside<T>(&mut self, inside: impl FnOnce(&mut Self) -> T, go: impl FnOnce(&mut String)) -> Option<T> {
        if self.depth == DEEPEST {
            return None;
        }
        let length = self.path.len();
        go(&mut self.path);
        self.depth += 1;
        let result = inside(self);
        self.depth -= 1;
        self.path.truncate(length);
        Some(result)
    }
}
