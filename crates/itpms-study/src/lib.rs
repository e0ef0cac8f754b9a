//! What needs the truth, or looks at a drive from outside: how good an estimate can be and is, how rough the road
//! was, and the page that shows it.
//!
//! | module | idea |
//! |---|---|
//! | [`bound`] | Cramer-Rao bound on a pressure from one corner, or from front and rear of a side |
//! | [`certify`] | the test procedures of UN R141 and FMVSS 138, driven |
//! | [`identify`] | spring, damper and tire from bench tests, with standard errors |
//! | [`learn`] | parameters of a car from drives at known pressures |
//! | [`malfunction`] | sensors that go wrong, and what the monitor says of it |
//! | [`observability`] | why two accelerations leave the stiffness free, and what each source of information fixes |
//! | [`overview`] | a log before any vehicle is known: signals, spectra, coherence, on one page |
//! | [`page`] | a page that is one file, under a policy by hashes |
//! | [`spectrum`] | Welch's power spectral density; level, slope and ISO 8608 class of a road |
//! | [`paper`] | the paper's study, made again |
//! | [`plot`] | figures as SVG |
//! | [`report`] | one HTML page about a drive |
//! | [`roughness`] | International Roughness Index, ISO 8608 level and slope, per track and segment |
//! | [`score`] | the accuracy table, recomputed over many simulated drives |
//! | [`sensors`] | what a study's car has: accelerometers, or wheel speeds alone |
//! | [`soak`] | false warnings over many simulated hours |
//! | [`transfer`] | how a corner's body answers its wheel, and whether that is its vehicle file's suspension |
#![forbid(unsafe_code)]

pub mod bound;
pub mod certify;
pub mod identify;
pub mod learn;
pub mod malfunction;
pub mod observability;
pub mod overview;
pub mod page;
pub mod paper;
pub mod plot;
pub mod report;
pub mod roughness;
pub mod score;
pub mod sensors;
pub mod soak;
pub mod spectrum;
pub mod transfer;
