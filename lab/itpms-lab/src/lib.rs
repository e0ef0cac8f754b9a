//! Studies of the estimator on simulated drives, for those who work on it.
//!
//! | module | idea |
//! |---|---|
//! | [`certify`] | the test procedures of UN R141 and FMVSS 138, driven |
//! | [`malfunction`] | sensors that go wrong, and what the monitor reports of it |
//! | [`observability`] | why two accelerations leave the stiffness free, and what each source of information fixes |
//! | [`paper`] | the paper's study, made again |
//! | [`runner`] | many drives on all processors, and why a study ends before its time |
//! | [`score`] | the accuracy table, recomputed over many simulated drives |
//! | [`sensors`] | what a study's car has: accelerometers, or wheel speeds alone |
//! | [`soak`] | false warnings over many simulated hours |
//! | [`tuning`] | the monitor as a study has it |
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "not published: names say it, and comments what they do not")]

pub mod certify;
pub mod malfunction;
pub mod observability;
pub mod paper;
pub mod runner;
pub mod score;
pub mod sensors;
pub mod soak;
pub mod tuning;

/// That a tire is low, for tests.
#[cfg(test)]
fn low(corner: itpms_core::model::Corner) -> itpms_core::warning::Alert<f64> {
    let cause = itpms_core::warning::Cause::UnderInflated(LOW);
    itpms_core::warning::Alert { wheels: corner.into(), since_s: 0.0, reported_s: 0.0, cause }
}

/// Of a tire that is low, for tests.
#[cfg(test)]
const LOW: itpms_core::warning::Reading<f64> = itpms_core::warning::Reading {
    pressure_kpa: 190.0,
    sd_kpa: 4.0,
    limit_kpa: 212.0,
    reference_kpa: 241.0,
    basis: itpms_core::warning::Basis::Calibration,
    probability: Some(0.998),
};
