//! A car under its monitor as a functional mock-up unit (FMU): co-simulation by FMI 2.0 and 3.0, both from one shared library, and the
//! package that simulation tools open.
//!
//! The estimator is that of `itpms estimate` ([`itpms_drive::Drive`]). Accelerations, speed and wheel speeds go in with every step;
//! pressures, states and warnings come out. docs/fmu.md tells how it is made and used.
//!
//! | module | idea |
//! |---|---|
//! | [`variables`] | the one table of variables that everything else goes by |
//! | [`model`] | the car between two steps: values, the drive, saved states |
//! | `outputs` | what is known, as numbers |
//! | `struts` | dampers and load |
//! | [`description`] | `modelDescription.xml` of both versions |
//! | [`package`] | the zip file |
//! | `abi` | what the C interfaces of both versions have in common |
//! | `fmi2`, `fmi3` | the functions that a tool calls |
#![deny(unsafe_code, unsafe_op_in_unsafe_fn)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]

mod abi;
pub mod description;
mod fmi2;
mod fmi3;
pub mod model;
mod outputs;
pub mod package;
mod struts;
pub mod variables;
