//! How brokers are reached: their addresses, and what only this machine knows of them.

use std::env;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use itpms_console::{Failure, Screen};
use itpms_live::broker::{BrokerAddress, Password};

use super::failure;
use crate::args::MonitorArgs;

/// Where a password may be instead of in a file.
const VARIABLE: &str = "ITPMS_MQTT_PASSWORD";
/// Bytes of a password, at most: as many as MQTT can send.
const LONGEST: u64 = 65_535;

/// The broker at this address, as far as it can be known before it is connected to.
pub(super) fn broker(args: &MonitorArgs, address: &str, screen: &Screen) -> Result<BrokerAddress, Failure> {
    let address = BrokerAddress::parse(address).map_err(failure)?;
    // A variable may be there for another's sake: without a user it is not asked.
    let password = match (&args.mqtt_password_file, &address.user) {
        (Some(path), _) => Some(read(path, screen)?),
        (None, Some(_)) => env::var(VARIABLE).ok(),
        (None, None) => None,
    };
    let address =
        address.with_access(password.map(Password::new), args.mqtt_ca.as_deref()).map_err(failure)?;
    if address.shows_password() {
        screen.warn(format!("the password goes to {} UNENCRYPTED; mqtts:// encrypts it", address.host));
    }
    Ok(address)
}

/// The first line of a file.
fn read(path: &Path, screen: &Screen) -> Result<String, Failure> {
    let read = || {
        let mut text = String::new();
        File::open(path)?.take(LONGEST + 1).read_to_string(&mut text)?;
        let first = text.lines().next().unwrap_or_default();
        if first.is_empty() || first.len() as u64 > LONGEST {
            let text = format!("found a first line of {} bytes, expected a password", first.len());
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        Ok(first.to_owned())
    };
    let password = read().map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))?;
    if is_open(path) {
        screen.warn(format!("{}: can be read by others (chmod 600 keeps it)", path.display()));
    }
    Ok(password)
}

#[cfg(unix)]
fn is_open(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    std::fs::metadata(path).is_ok_and(|about| about.is_file() && about.permissions().mode() & 0o077 != 0)
}

#[cfg(not(unix))]
fn is_open(_path: &Path) -> bool {
    false
}
