//! What both monitors do in the caller's memory, so that one set of functions serves both.

use itpms_core::warning::{Alert, Change};

use crate::config::itpms_config;
use crate::itpms_real;
use crate::read_config::Refusal;
use crate::status::itpms_status;

/// See the [module](self).
pub(crate) trait Kept: Sized {
    /// What stands before it in memory once it is configured.
    const MARK: u32;

    /// Makes one without a configuration of memory.
    ///
    /// # Safety
    /// `place` must be valid for writes and aligned.
    #[allow(unsafe_code)]
    unsafe fn blank(place: *mut Self);

    /// Begins with this configuration.
    fn configure(&mut self, config: &itpms_config) -> Result<(), Refusal>;

    /// Begins anew as configured.
    fn reset(&mut self) -> Result<(), itpms_status>;

    /// Hands the alerts that stand to `take`, one after the other.
    fn alerts(&self, take: impl FnMut(usize, &Alert<itpms_real>));

    /// Hands what began or ended since it last did to `take`, if there is room for so many; gives how many.
    fn events(
        &mut self,
        room: usize,
        take: impl FnMut(usize, &Change<itpms_real>),
    ) -> (usize, Result<(), itpms_status>);

    fn begin_calibration(&mut self, seconds: f64) -> Result<(), itpms_status>;

    fn end_calibration(&mut self) -> Result<(), itpms_status>;

    /// Writes what a calibration taught; gives the bytes it takes.
    fn save_calibration(&self, bytes: &mut [u8]) -> Result<usize, itpms_status>;

    fn load_calibration(&mut self, bytes: &[u8]) -> Result<(), itpms_status>;
}
