//! What is made of a drive log besides its pressures: the page about it, figures, spectra, how rough the road was, what the log and
//! bench tests teach of a car's parameters, and how well a pressure can be known at best.
//!
//! | module | idea |
//! |---|---|
//! | [`beside`] | what is found of a car beside its pressures, as a drive goes on |
//! | [`bound`] | Cramer-Rao bound on a pressure from one corner, or from front and rear of a side |
//! | [`identify`] | spring, damper and tire from bench tests, with standard errors |
//! | [`learn`] | parameters of a car from drives at known pressures |
//! | [`odometer`] | the way, from speeds that not every sample has |
//! | [`overview`] | a log before any vehicle is known: signals, spectra, coherence, on one page |
//! | [`page`] | a page that is one file, under a policy by hashes |
//! | [`spectrum`] | Welch's power spectral density; level, slope and ISO 8608 class of a road |
//! | [`plot`] | figures as SVG |
//! | [`report`] | one HTML page about a drive |
//! | [`roughness`] | International Roughness Index, ISO 8608 level and slope, per track and segment |
//! | [`suspension`] | dampers and load of a drive against what the car was when it was healthy |
//! | [`transfer`] | how a corner's body answers its wheel, and whether that is its vehicle file's suspension |
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]

pub mod beside;
pub mod bound;
pub mod identify;
pub mod learn;
pub mod odometer;
pub mod overview;
pub mod page;
pub mod plot;
pub mod report;
pub mod rotation;
pub mod roughness;
pub mod spectrum;
pub mod suspension;
pub mod transfer;
