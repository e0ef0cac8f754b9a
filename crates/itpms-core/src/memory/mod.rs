//! Memory that the caller owns. A car is some 140 KB in `f32`, more than a controller's stack has room for, so it is never
//! built somewhere and moved: its memory is there first, as a constant, and what is in it is configured where it lies.
//!
//! | module | idea |
//! |---|---|
//! | `blank` | what is in such memory before it is configured |
//! | `placed` | a value that may be absent and yet has its place |

mod blank;
mod placed;

pub(crate) use self::blank::Blank;
pub(crate) use self::placed::Placed;
pub(crate) use itpms_derive::Blank;

#[cfg(test)]
pub(crate) fn configured<X: Blank>(configure: impl FnOnce(&mut X)) -> X {
    let mut value = X::BLANK;
    configure(&mut value);
    value
}
