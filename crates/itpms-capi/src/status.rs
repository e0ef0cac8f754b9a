//! What a function of the library returns: done, or why not.

use core::ffi::CStr;

/// What became of a call. Everything but `ITPMS_STATUS_OK` leaves all as it was, unless the function says otherwise.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_status {
    /// Done.
    Ok = 0,
    /// A pointer that may not be null is null.
    NullPointer = 1,
    /// A pointer is not aligned for what it points to.
    Misaligned = 2,
    /// `struct_size` is not that of this library: header and library differ in version or precision.
    WrongSize = 3,
    /// `api_version` is not `ITPMS_API_VERSION` of this library.
    WrongVersion = 4,
    /// The memory that was given is too small for what belongs there.
    TooSmall = 5,
    /// The memory holds no car, or no wheel speeds where these are asked for: its init was not called, or failed.
    NotACar = 6,
    /// A parameter is outside its range or no number; `itpms_problem` names it.
    BadParameter = 7,
    /// A choice has none of its values.
    BadChoice = 8,
    /// The time of a sample is not finite.
    BadTime = 9,
    /// There is nothing of that index.
    BadIndex = 10,
    /// A length of time is not positive and finite.
    BadDuration = 11,
    /// Nothing was learned: no calibration is over, or it saw too little.
    NotCalibrated = 12,
    /// The car was configured without wheel speeds.
    NoWheelSpeeds = 13,
    /// The car was configured without corners.
    NoCorners = 14,
    /// The bytes are not what was saved: their checksum does not hold.
    Damaged = 15,
    /// The bytes were saved by another version of the library, or hold something else.
    OtherFormat = 16,
    /// The calibration was learned for other corners or other placard pressures.
    OtherCar = 17,
    /// The calibration holds what no car could have.
    Implausible = 18,
    /// A sample was taken already: a stored calibration comes before the first one.
    TooLate = 19,
}

impl itpms_status {
    const ALL: [Self; 20] = [
        Self::Ok,
        Self::NullPointer,
        Self::Misaligned,
        Self::WrongSize,
        Self::WrongVersion,
        Self::TooSmall,
        Self::NotACar,
        Self::BadParameter,
        Self::BadChoice,
        Self::BadTime,
        Self::BadIndex,
        Self::BadDuration,
        Self::NotCalibrated,
        Self::NoWheelSpeeds,
        Self::NoCorners,
        Self::Damaged,
        Self::OtherFormat,
        Self::OtherCar,
        Self::Implausible,
        Self::TooLate,
    ];

    fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::NullPointer => c"a pointer is null that may not be",
            Self::Misaligned => c"a pointer is not aligned for what it points to",
            Self::WrongSize => {
                c"struct_size is not this library's: header and library differ in version or precision"
            }
            Self::WrongVersion => {
                c"api_version is not this library's: header and library are of different versions"
            }
            Self::TooSmall => c"the memory that was given is too small",
            Self::NotACar => {
                c"the memory holds no car or no wheel speeds: itpms_car_init or itpms_wheels_init comes first"
            }
            Self::BadParameter => c"a parameter is outside its range or no number",
            Self::BadChoice => c"a choice has none of its values",
            Self::BadTime => c"the time of the sample is not finite",
            Self::BadIndex => c"there is nothing of that index",
            Self::BadDuration => c"the length of time is not positive and finite",
            Self::NotCalibrated => c"nothing was learned: no calibration is over, or it saw too little",
            Self::NoWheelSpeeds => c"the car was configured without wheel speeds",
            Self::NoCorners => c"the car was configured without corners",
            Self::Damaged => c"the bytes are damaged: their checksum does not hold",
            Self::OtherFormat => c"the bytes are of another version of the library, or hold something else",
            Self::OtherCar => c"the calibration is of other corners or other placard pressures",
            Self::Implausible => c"the calibration holds what no car could have",
            Self::TooLate => c"a sample was taken already: a stored calibration comes before the first one",
        }
    }
}

/// The text of a status, which C may have made up.
pub(crate) fn text(status: u32) -> &'static CStr {
    let known = itpms_status::ALL.into_iter().find(|known| *known as u32 == status);
    known.map_or(c"no status of this library", itpms_status::text)
}
