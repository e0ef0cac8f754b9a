//! Input of the benchmarks: one wheel on a rough road ([`wheel`]) and four of them ([`car`]).
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "not published: names say it, and comments what they do not")]
#![allow(clippy::expect_used)] // A benchmark whose fixed parameters are refused has nothing to measure.

pub mod car;
pub mod wheel;

pub use wheel::{
    HOP, PUBLISHED_WARM_UP, RATE_HZ, Running, SPEED_M_S, WARM_UP, lean, published, road, sample,
};
