//! Four wheel speeds alone, under their monitor, in the caller's memory.

use itpms_core::monitor::MonitoredWheels;
use itpms_core::warning::{Alert, Change};
use itpms_core::wheel_speed::{RadiusCalibration, WheelSpeedConfig};

use crate::config::itpms_config;
use crate::image::{self, Kind};
use crate::itpms_real;
use crate::kept::Kept;
use crate::radii::{self, itpms_radius_report};
use crate::read_config::{Refusal, read_wheel_speeds};
use crate::sample::itpms_wheel_speed_sample;
use crate::status::itpms_status;

const CALIBRATION: Kind = Kind::new(b'W', 1);

/// See the [module](self).
pub(crate) struct Wheels {
    config: Option<WheelSpeedConfig<itpms_real>>,
    wheels: MonitoredWheels<itpms_real>,
    /// As the events were last asked for.
    reported: Option<Alert<itpms_real>>,
}

impl Wheels {
    /// Begins anew with this configuration.
    fn begin(&mut self, config: &WheelSpeedConfig<itpms_real>) -> Result<(), itpms_core::ParameterError> {
        self.wheels.configure(config)?;
        (self.config, self.reported) = (Some(*config), None);
        Ok(())
    }

    pub(crate) fn update(&mut self, sample: &itpms_wheel_speed_sample) -> Result<(), itpms_status> {
        self.wheels.update(&sample.read()?);
        Ok(())
    }

    pub(crate) fn report(&self) -> itpms_radius_report {
        radii::report(&self.wheels)
    }
}

impl Kept for Wheels {
    const MARK: u32 = u32::from_le_bytes(*b"IPTW");

    #[allow(unsafe_code)]
    #[inline(never)] // Its blank copies leave the stack before it is configured.
    unsafe fn blank(place: *mut Self) {
        // SAFETY: the caller's promise; every field is written, and none is read before.
        unsafe {
            (&raw mut (*place).config).write(None);
            (&raw mut (*place).wheels).write(MonitoredWheels::unconfigured());
            (&raw mut (*place).reported).write(None);
        }
    }

    fn configure(&mut self, given: &itpms_config) -> Result<(), Refusal> {
        let config = read_wheel_speeds(&given.wheel_speeds, given.wheelbase_m)?;
        let config = config.ok_or_else(|| Refusal::choice("wheel_speeds.is_used", 0, "1"))?;
        Ok(self.begin(&config)?)
    }

    fn reset(&mut self) -> Result<(), itpms_status> {
        let config = self.config.ok_or(itpms_status::NotACar)?;
        self.begin(&config).map_err(|_| itpms_status::BadParameter)
    }

    fn alerts(&self, mut take: impl FnMut(usize, &Alert<itpms_real>)) {
        if let Some(alert) = self.wheels.alert() {
            take(0, &alert);
        }
    }

    fn events(
        &mut self,
        room: usize,
        mut take: impl FnMut(usize, &Change<itpms_real>),
    ) -> (usize, Result<(), itpms_status>) {
        // Alerts that were reported at one time are one.
        let reported = |alert: &Alert<itpms_real>| alert.reported_s.to_bits();
        let (now, before) = (self.wheels.alert(), self.reported);
        if now.as_ref().map(reported) == before.as_ref().map(reported) {
            return (0, Ok(()));
        }
        let changes = before.map(Change::Ended).into_iter().chain(now.map(Change::Begun));
        let count = changes.clone().count();
        if count > room {
            return (count, Err(itpms_status::TooSmall));
        }
        changes.enumerate().for_each(|(i, change)| take(i, &change));
        self.reported = now;
        (count, Ok(()))
    }

    fn begin_calibration(&mut self, seconds: f64) -> Result<(), itpms_status> {
        self.wheels.begin_calibration(seconds).map_err(|_| itpms_status::BadDuration)
    }

    fn end_calibration(&mut self) -> Result<(), itpms_status> {
        if self.wheels.end_calibration() { Ok(()) } else { Err(itpms_status::NotCalibrated) }
    }

    fn save_calibration(&self, bytes: &mut [u8]) -> Result<usize, itpms_status> {
        image::save(CALIBRATION, self.wheels.calibration().ok_or(itpms_status::NotCalibrated)?, bytes)
    }

    fn load_calibration(&mut self, bytes: &[u8]) -> Result<(), itpms_status> {
        let calibration: RadiusCalibration<itpms_real> = image::load(CALIBRATION, bytes)?;
        if self.wheels.radii().time_s.is_finite() {
            return Err(itpms_status::TooLate);
        }
        if self.wheels.load_calibration(&calibration) { Ok(()) } else { Err(itpms_status::Implausible) }
    }
}
