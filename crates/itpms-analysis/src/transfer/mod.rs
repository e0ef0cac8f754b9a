//! How a corner's body answers its wheel in a drive, and whether that is what its vehicle file says: the transfer
//! function from wheel to body acceleration, its coherence, and the damper and spring that it shows.
//!
//! Called by `itpms vehicle check` and by `overview` with samples and parameters; knows no files. Road, tire and unsprung mass do not enter: the
//! suspension alone stands between the two sensors, `H(s) = (c s + k) / (m s² + c s + k)`.
//!
//! | module | idea |
//! |---|---|
//! | `cross` | spectra of both signals and between them, from a stream |
//! | `corner` | measured against the file's; what to change |
//! | `page` | all corners as one HTML page |

mod corner;
mod cross;
mod page;

pub(crate) use corner::{AGAINST, no_suspension_allows};
pub use corner::{CornerCheck, Suspension, Verdict};
pub use cross::{CrossSpectra, Density, FEWEST_SEGMENTS, INCOHERENT};
pub(crate) use page::named;
pub use page::page;
