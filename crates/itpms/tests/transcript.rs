//! The command's sessions, in folders in which the paper's drive lies as `drive.csv` and `car.toml`.
#![cfg(target_os = "linux")]

use std::path::Path;

use crate::common::Bench;
use crate::common::session::replay;

macro_rules! transcripts {
    ($($(#[$attribute:meta])* $name:ident,)*) => {$(
        $(#[$attribute])*
        #[test]
        fn $name() {
            replay(Path::new(env!("CARGO_MANIFEST_DIR")), stringify!($name), &Bench::with_drive());
        }
    )*};
}

transcripts! {
    air,
    #[cfg(all(feature = "can", feature = "mdf4", feature = "parquet"))]
    convert,
    endless,
    #[cfg(all(feature = "can", feature = "mdf4", feature = "parquet"))]
    estimate,
    exchanged,
    field,
    fleet,
    identify,
    lab,
    learn,
    #[cfg(all(feature = "live", feature = "can"))]
    monitor,
    plot,
    pressures,
    program,
    reference,
    #[cfg(feature = "parquet")]
    roughness,
    #[cfg(feature = "parquet")]
    same,
    #[cfg(feature = "can")]
    signals,
    simulate,
    #[cfg(feature = "mdf4")]
    tables,
    unwritable,
    vehicle,
    #[cfg(feature = "can")]
    wheel_speeds,
}
