//! Why the monitor does not start, or ends.

use std::io;

use itpms_data::DataError;
use itpms_data::can::CanError;
use itpms_data::error::FileError;
use thiserror::Error;

/// The end of the monitor.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LiveError {
    /// A file in or out.
    #[error(transparent)]
    Data(#[from] DataError),
    /// What the estimator was given.
    #[error("{0}")]
    Refused(String),
    /// The source has none of the corners of the vehicle.
    #[error("{source_name} has the corners {found}, but the vehicle {vehicle:?} describes {described}")]
    NoCorner {
        /// Where the rows come from.
        source_name: String,
        /// The measured corners.
        found: String,
        /// The vehicle's name.
        vehicle: String,
        /// Its corners.
        described: String,
    },
    /// An address of a broker.
    #[error(
        "{found:?} is no address of an MQTT broker, expected mqtt://[USER@]HOST[:PORT]/TOPIC, or mqtts://"
    )]
    BrokerAddress {
        /// What was given.
        found: String,
    },
    /// A password where every program of the machine can read it.
    #[error(
        "a password in the address is seen by everyone on this machine, expected it in the file of --mqtt-password-file, or in ITPMS_MQTT_PASSWORD"
    )]
    PasswordInAddress,
    /// Certificates of an encrypted connection.
    #[error("{name}: {error}")]
    Certificates {
        /// Their file, or the system's store.
        name: String,
        /// What is wrong.
        error: io::Error,
    },
    /// A bus interface.
    #[error("{interface}: {error}")]
    Interface {
        /// Its name.
        interface: String,
        /// What the system says.
        error: io::Error,
    },
    /// Whoever read standard output has gone away, as `head` does; no reason to complain.
    #[error("standard output is closed: its reader has ended")]
    ReaderGone,
    /// An output that cannot be written.
    #[error("{target}: cannot be written: {error}")]
    Output {
        /// Its name.
        target: String,
        /// What the system says.
        error: io::Error,
    },
}

impl From<FileError> for LiveError {
    fn from(error: FileError) -> Self {
        Self::Data(error.into())
    }
}

impl From<CanError> for LiveError {
    fn from(error: CanError) -> Self {
        Self::Data(error.into())
    }
}
