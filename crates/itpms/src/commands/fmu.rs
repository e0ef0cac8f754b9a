//! `itpms fmu`: a vehicle file in, the package of a functional mock-up unit out. The work is that of `itpms-fmu`.

use itpms_console::{Failure, Screen, names};
use itpms_data::Vehicle;
use itpms_data::out::AtomicFile;
use itpms_fmu::description::Fmi;
use itpms_fmu::package::{find_library, package};

use crate::args::{FmiVersion, FmuArgs};

pub(crate) fn run(args: &FmuArgs, screen: &Screen) -> Result<(), Failure> {
    let inputs =
        [(Some(args.vehicle.as_path()), "the vehicle file"), (args.library.as_deref(), "the shared library")];
    names::check(&inputs, &[Some(&args.output)])?;
    if !(args.rate_hz > 0.0 && args.rate_hz.is_finite()) {
        return Err(Failure::Usage(format!(
            "--rate-hz {}: expected a positive, finite number",
            args.rate_hz
        )));
    }
    let vehicle = Vehicle::read(&args.vehicle)?;
    let program = std::env::current_exe().map_err(|error| {
        Failure::Usage(format!("this program's own place is not known: {error}; expected --library PATH"))
    })?;
    let unusable = |error: itpms_fmu::package::PackageError| Failure::Usage(error.to_string());
    let library = find_library(args.library.as_deref(), &program).map_err(unusable)?;
    let fmi = match args.fmi {
        FmiVersion::Two => Fmi::Two,
        FmiVersion::Three => Fmi::Three,
    };
    let bytes = package(fmi, &vehicle, &library, args.rate_hz.recip()).map_err(unusable)?;
    AtomicFile::save(&args.output, &bytes)?;
    screen.remark(format!("{}: {} bytes, with {}", args.output.display(), bytes.len(), library.display()));
    Ok(())
}
