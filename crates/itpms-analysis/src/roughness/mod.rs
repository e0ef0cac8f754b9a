//! How rough a road is: International Roughness Index (ASTM E1926), ISO 8608 class, level and slope, per track and
//! segment.
//!
//! Called by the roughness command, the report, the score and the road export.
//!
//! | module | idea |
//! |---|---|
//! | `golden_car` | the standard's quarter car, and the roughness of whole profiles |
//! | `cells` | even means of samples at any distance |
//! | `even` | even heights from a profile at any distances |
//! | `survey` | one track, segment by segment, as a stream |
//! | `wheel` | the same for a wheel of a driven car |
//! | `table` | the tracks side by side, with their mean; as text, CSV and JSON |

mod cells;
mod even;
mod golden_car;
mod survey;
mod table;
#[cfg(test)]
mod tests;
mod wheel;

pub(crate) use cells::{Cells, undo_cells};
pub use even::{EvenError, EvenProfile};
pub use golden_car::{Enveloping, GoldenCar, SpacingError, iri_m_per_km, segment_iri_m_per_km, share_of_iri};
pub use survey::{
    Sampling, SegmentRoughness, SurveyError, SurveyOptions, TooLittle, TrackRoughness, TrackSurvey,
};
pub use table::RoughnessTable;
pub use wheel::WheelSurvey;
