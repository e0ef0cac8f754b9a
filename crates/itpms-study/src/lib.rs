//! What needs the truth, or looks at a drive from outside: how good an estimate can be, how rough the road was,
//! and the page that shows both.
//!
//! | room | idea |
//! |---|---|
//! | [`bound`] | Cramer-Rao bound on a pressure from one corner |
//! | [`spectrum`] | Welch's power spectral density; level, slope and ISO 8608 class of a road |
//! | [`report`] | one HTML page about a drive |
//! | [`roughness`] | International Roughness Index of a profile |
#![forbid(unsafe_code)]

pub mod bound;
pub mod report;
pub mod roughness;
pub mod spectrum;
