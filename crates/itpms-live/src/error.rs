//! Why the monitor does not start, or ends.

use std::io;

use itpms_data::DataError;
use itpms_data::can::CanError;
use itpms_data::error::FileError;
use itpms_drive::DriveError;
use thiserror::Error;

/// The end of the monitor.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LiveError {
    #[error(transparent)]
    Data(#[from] DataError),
    #[error("{0}")]
    Refused(String),
    #[error("{source_name} has the corners {found}, but the vehicle {vehicle:?} describes {described}")]
    NoCorner { source_name: String, found: String, vehicle: String, described: String },
    #[error(
        "{found:?} is no address of an MQTT broker, expected mqtt://[USER@]HOST[:PORT]/TOPIC, or mqtts://"
    )]
    BrokerAddress { found: String },
    #[error(
        "a password in the address is seen by everyone on this machine, expected it in the file of --mqtt-password-file, or in ITPMS_MQTT_PASSWORD"
    )]
    PasswordInAddress,
    #[error("{name}: {error}")]
    Certificates { name: String, error: io::Error },
    #[error("{interface}: {error}")]
    Interface { interface: String, error: io::Error },
    #[error("standard output is closed: its reader has ended")]
    ReaderGone,
    #[error("{target}: cannot be written: {error}")]
    Output { target: String, error: io::Error },
}

impl From<FileError> for LiveError {
    fn from(error: FileError) -> Self {
        Self::Data(error.into())
    }
}

impl From<DriveError> for LiveError {
    fn from(error: DriveError) -> Self {
        match error {
            DriveError::Data(error) => Self::Data(error),
            other => Self::Refused(other.to_string()),
        }
    }
}

impl From<CanError> for LiveError {
    fn from(error: CanError) -> Self {
        Self::Data(error.into())
    }
}
