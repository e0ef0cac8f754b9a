//! Where wheel hop lies.

/// Band in Hz in which every car's wheels hop.
pub(crate) const HOP_BAND_HZ: [f64; 2] = [8.0, 20.0];
pub(crate) const HOP_HZ: f64 = 12.0;
