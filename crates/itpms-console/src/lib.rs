//! What the programs of itpms share: arguments in, files and a few lines of text out. No mathematics.
//!
//! | module | idea |
//! |---|---|
//! | `exit` | why a command ends, and the code for it |
//! | `interrupt` | Ctrl-C and a polite kill end a run between two rows |
//! | [`screen`] | results on standard output, remarks on standard error |
//! | [`progress`] | a bar on a terminal, nothing in a file or pipe |
//! | [`threads`] | on how many threads the work is done |
//! | [`options`] | options and values that several commands take |
//! | [`names`] | no file is written that is read, and none twice |
//! | [`numbers`] | numbers as a person reads them |
//! | [`former`] | what people edited by hand is kept when it is written anew |
//! | `folder` | a folder that receives several files when all are complete |
//! | `program` | which build this is |
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]

mod exit;
mod folder;
pub mod former;
mod interrupt;
pub mod names;
pub mod numbers;
pub mod options;
mod program;
pub mod progress;
pub mod screen;
pub mod threads;

pub use exit::Failure;
pub use folder::Folder;
pub use interrupt::Interrupt;
pub use program::fingerprint;
pub use screen::{Screen, plain};
