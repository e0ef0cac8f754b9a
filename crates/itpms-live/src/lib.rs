//! The live monitor: rows from a bus, a broker or a replayed log in; estimates and warnings out, as they come.
//!
//! | module | idea |
//! |---|---|
//! | [`source`] | where rows and frames come from |
//! | [`input`], [`queue`] | what a source tells, and the bounded way it goes |
//! | [`broker`], `tls` | where an MQTT broker is, and whom to believe that it is this one |
//! | [`feed`] | frames to rows |
//! | [`drive`], `options` | the running estimate (an `itpms_drive::Drive`), and how it is made |
//! | `past`, `units` | rows that are late, clocks that are set back; numbers in another unit |
//! | [`speed`] | why the speed of the car is unknown, and when that is reported |
//! | [`engine`] | what came in becomes snapshots and transitions |
//! | [`latency`] | how late they are |
//! | [`monitor`] | the estimating thread |
//! | [`state`] | a drive kept from one start to the next |
//! | [`output`] | where estimates and warnings go |
//! | [`http`] | the page, and what scripts and scrapers read beside it |
//! | [`snapshot`] | what is published: everything known of the car at one moment |
//! | [`hub`] | the newest snapshot for whoever asks, and a bounded history |
//!
//! One thread estimates and waits for no one. Used by `itpms monitor`; knows nothing of arguments and exit codes.
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]

mod beside;
pub mod broker;
mod clock;
mod describe;
pub mod drive;
pub mod engine;
pub mod error;
pub mod feed;
pub mod http;
pub mod hub;
pub mod input;
pub mod latency;
pub mod monitor;
mod options;
pub mod output;
mod past;
pub mod queue;
mod reported;
mod roughness;
pub mod snapshot;
pub mod source;
pub mod speed;
pub mod state;
mod tls;
mod units;

pub use error::LiveError;
