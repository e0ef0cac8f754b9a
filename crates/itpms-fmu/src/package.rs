//! The package: description, shared library and vehicle file in a zip archive, where both versions of the standard want them.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use itpms_data::Vehicle;
use thiserror::Error;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::description::{Fmi, MODEL_IDENTIFIER, description};

/// The vehicle file's name in the folder of resources.
pub const VEHICLE_FILE: &str = "vehicle.toml";

/// The shared library's name as cargo builds it.
pub fn library_name() -> String {
    format!("{}itpms_fmu{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

#[derive(Debug, Error)]
pub enum PackageError {
    #[error(
        "{searched}: the shared library {name} is not there; expected where cargo build --release -p itpms-fmu leaves it, or --library PATH"
    )]
    NoLibrary { name: String, searched: String },
    #[error("{}: cannot be read: {}", .0.display(), .1)]
    Read(PathBuf, std::io::Error),
    #[error("the archive cannot be made: {0}")]
    Zip(#[from] zip::result::ZipError),
    #[error("the archive cannot be made: {0}")]
    Write(#[from] std::io::Error),
    #[error("the standard has no folder for shared libraries of this system ({0})")]
    Platform(&'static str),
}

/// The shared library: as given, else beside the program, in the folder `deps` there, where cargo leaves it, or in `../lib/itpms`, where
/// packages put it that have programs in a folder of their own. Errors: it is in none of these places.
pub fn find_library(given: Option<&Path>, program: &Path) -> Result<PathBuf, PackageError> {
    let name = library_name();
    let folder = program.parent().unwrap_or(Path::new("."));
    let places = given.map_or_else(
        || {
            let mut places = vec![folder.join(&name), folder.join("deps").join(&name)];
            places.extend(folder.parent().map(|prefix| prefix.join("lib").join("itpms").join(&name)));
            places
        },
        |given| vec![given.to_owned()],
    );
    let searched = places.iter().map(|place| place.display().to_string()).collect::<Vec<_>>().join(", ");
    places.into_iter().find(|place| place.is_file()).ok_or(PackageError::NoLibrary { name, searched })
}

/// The folder of a shared library of this machine in a package.
fn platform(fmi: Fmi) -> Result<&'static str, PackageError> {
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    Ok(match (fmi, os, arch) {
        (Fmi::Two, "linux", "x86_64") => "linux64",
        (Fmi::Two, "windows", "x86_64") => "win64",
        (Fmi::Two, "macos", _) => "darwin64",
        (Fmi::Three, "linux", "x86_64") => "x86_64-linux",
        (Fmi::Three, "linux", "aarch64") => "aarch64-linux",
        (Fmi::Three, "windows", "x86_64") => "x86_64-windows",
        (Fmi::Three, "macos", "x86_64") => "x86_64-darwin",
        (Fmi::Three, "macos", "aarch64") => "aarch64-darwin",
        _ => return Err(PackageError::Platform(os)),
    })
}

/// The bytes of a vehicle's package. Errors: the library cannot be read; the standard has no place for it.
pub fn package(fmi: Fmi, vehicle: &Vehicle, library: &Path, step_s: f64) -> Result<Vec<u8>, PackageError> {
    let code = std::fs::read(library).map_err(|error| PackageError::Read(library.to_owned(), error))?;
    let suffix = std::env::consts::DLL_SUFFIX;
    let place = format!("binaries/{}/{MODEL_IDENTIFIER}{suffix}", platform(fmi)?);
    // The archive of the same files is the same bytes: no clock.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default());
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    archive.start_file("modelDescription.xml", options)?;
    archive.write_all(description(fmi, vehicle, step_s).as_bytes())?;
    archive.start_file(place, options.unix_permissions(0o755))?;
    archive.write_all(&code)?;
    archive.start_file(format!("resources/{VEHICLE_FILE}"), options)?;
    archive.write_all(vehicle.to_toml().as_bytes())?;
    Ok(archive.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_is_looked_for_where_packages_put_it() {
        let prefix = Path::new("no-such-prefix");
        let error = find_library(None, &prefix.join("bin").join("itpms")).map_err(|error| error.to_string());
        let place = prefix.join("lib").join("itpms").join(library_name());
        assert!(error.is_err_and(|sentence| sentence.contains(&place.display().to_string())));
    }
}
