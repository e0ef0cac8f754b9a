//! The extension module `itpms._itpms`. Numbers go in and out as bytes of little-endian `f64`, everything else as text and
//! JSON; the Python layer above makes arrays and frames of them. No one else calls it.
//!
//! | module | idea |
//! |---|---|
//! | `errors` | sentences as the package's exceptions |
//! | `work` | long computations beside the interpreter, ended by Ctrl-C, and how far they are |
//! | `columns` | numbers as bytes |
//! | `pieces` | a drive that Python hands over piece by piece |
//! | `options` | settings of an estimate |
//! | `output` | files that are written completely or not at all |
//! | `found` | estimates over time |
//! | `estimate` | a whole drive |
//! | `car` | an estimator, sample by sample |
//! | `simulate` | made-up drives |
//! | `vehicle` | a car's parameters |
//! | `learn` | a car's parameters from drives at known pressures |
//! | `check` | a vehicle file held against a drive |
//! | `road` | roughness of a profile |

#![forbid(unsafe_code)]

mod car;
mod check;
mod columns;
mod errors;
mod estimate;
mod found;
mod learn;
mod options;
mod output;
mod pieces;
mod road;
mod simulate;
mod vehicle;
mod work;

use itpms_data::log::Slot;
use pyo3::prelude::*;

/// The extension module of the package itpms.
#[pymodule]
fn _itpms(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("COLUMNS", Slot::all().map(Slot::name).collect::<Vec<String>>())?;
    module.add_class::<estimate::Estimated>()?;
    module.add_class::<car::Car>()?;
    module.add_class::<simulate::Simulated>()?;
    module.add_class::<vehicle::Vehicle>()?;
    module.add_class::<learn::Learned>()?;
    module.add_class::<check::Checked>()?;
    module.add_function(wrap_pyfunction!(estimate::estimate_log, module)?)?;
    module.add_function(wrap_pyfunction!(estimate::estimate_pieces, module)?)?;
    module.add_function(wrap_pyfunction!(check::check_log, module)?)?;
    module.add_function(wrap_pyfunction!(check::check_pieces, module)?)?;
    module.add_function(wrap_pyfunction!(learn::learn, module)?)?;
    module.add_function(wrap_pyfunction!(output::write, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::scenarios, module)?)?;
    module.add_function(wrap_pyfunction!(road::iri, module)?)
}
