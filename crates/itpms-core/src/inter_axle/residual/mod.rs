//! What front and rear disagree on, and what that is worth.

pub(crate) mod correction;
pub(crate) mod expected_products;
pub(crate) mod hop_excess;
pub(crate) mod imbalance;
pub(crate) mod instrument;
pub(crate) mod model;
pub(crate) mod noise;
