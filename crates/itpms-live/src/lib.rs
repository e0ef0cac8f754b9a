//! The live monitor: rows from a bus, a broker or a replayed log in; estimates and warnings out, as they come.
//!
//! | room | idea |
//! |---|---|
//! | [`http`] | the page, and what scripts and scrapers read beside it |
//! | [`snapshot`] | what is published: everything known of the car at one moment |
//! | [`hub`] | the newest snapshot for whoever asks, and a bounded history |
//!
//! One thread estimates and waits for nobody. Used by `itpms monitor`; knows nothing of arguments and exit codes.
#![forbid(unsafe_code)]

pub mod http;
pub mod hub;
pub mod snapshot;
