//! How rough a road is: International Roughness Index (ASTM E1926), ISO 8608 class, level and slope, per track and segment.
//!
//! Called by the roughness command, the report, the score and the road export.
//!
//! | module | idea |
//! |---|---|
//! | `anomaly` | holes and bumps: what stands out of the road around it |
//! | `golden_car` | the standard's quarter car, and the roughness of whole profiles |
//! | `cells` | even means of samples at any distance |
//! | `even` | even heights from a profile at any distances |
//! | `survey` | one track, segment by segment, as a stream |
//! | `wheel` | the same for a wheel of a driven car |
//! | `place` | where on earth a distance of the drive is |
//! | `geojson` | the road as lines and points on a map |
//! | `map` | that map as a page |
//! | `table` | the tracks side by side, with their mean; as text, CSV and JSON |

mod anomaly;
mod cells;
mod even;
mod geojson;
mod golden_car;
mod map;
mod place;
mod survey;
mod table;
#[cfg(test)]
mod tests;
mod wheel;

pub use anomaly::{Anomaly, AnomalySearch, SideAnomaly, of_a_side};
pub(crate) use cells::{Cells, undo_cells};
pub use even::{EvenError, EvenProfile};
pub use geojson::geojson;
pub use golden_car::{Enveloping, GoldenCar, SpacingError, iri_m_per_km, segment_iri_m_per_km, share_of_iri};
pub use map::{MAP_STYLE, MapCell, cells_picture, map_page};
pub use place::Way;
pub use survey::{
    Sampling, SegmentRoughness, SurveyError, SurveyOptions, TooLittle, TrackRoughness, TrackSurvey,
};
pub use table::RoughnessTable;
pub use wheel::WheelSurvey;
