//! Estimates made up for the monitor, and a drive of them.

use itpms_core::conditioning::SampleClock;
use itpms_core::model::{
    CarConfig, CarEstimate, CarSample, Corner, CornerConfig, CornerEstimate, CornerSample, Diagnostics,
    Level, Loss, TrackState, Validity, Warning,
};
use itpms_core::monitor::{Monitor, MonitorConfig};
use itpms_core::warning::{MonitorReport, WheelState};

/// Steps per second of the made-up drives.
pub(super) const RATE_HZ: f64 = 20.0;

#[derive(Clone, Copy)]
pub(super) struct Reported {
    pub(super) kpa: [f64; 4],
    pub(super) sd: f64,
    pub(super) gate: f64,
    pub(super) validity: Validity,
    pub(super) speed_m_s: f64,
    pub(super) incoherence: f64,
    /// How far the errors of all tires go together, and at least those of an axle's two.
    pub(super) correlation: f64,
    pub(super) axle_correlation: f64,
    pub(super) silent: Option<Corner>,
    pub(super) level: Level,
    pub(super) loss: [Option<Loss<f64>>; 4],
}

pub(super) const FINE: Reported = Reported {
    kpa: [241.3; 4],
    sd: 8.0,
    gate: 1.0,
    validity: Validity::Valid,
    speed_m_s: 20.0,
    incoherence: f64::NAN,
    correlation: 0.0,
    axle_correlation: 0.0,
    silent: None,
    level: Level::Calibration,
    loss: [None; 4],
};

/// Loss of a tire of 302 kPa in this drive.
pub(super) fn lost(lost_kpa: f64, lost_sd_kpa: f64) -> Loss<f64> {
    Loss {
        level_kpa: 302.0,
        is_whole: 1,
        lost_kpa,
        lost_sd_kpa,
        change_sd_kpa: 3.0,
        excess_kpa: lost_kpa,
        excess_sd_kpa: lost_sd_kpa,
    }
}

pub(super) fn car() -> CarConfig<f64> {
    CarConfig { corners: [Some(CornerConfig::paper()); 4], wheelbase_m: Some(2.7) }
}

pub(super) fn estimate(time_s: f64, reported: &Reported) -> CarEstimate<f64> {
    let corner = |pressure_kpa| CornerEstimate {
        time_s,
        stiffness_n_per_m: 230_000.0,
        stiffness_sd_n_per_m: 6000.0,
        pressure_kpa,
        pressure_sd_kpa: reported.sd,
        change_sd_kpa: reported.sd,
        axle_difference_sd_kpa: None,
        loss: None,
        cold: None,
        level: reported.level,
        road_m: 0.0,
        road_sd_m: 0.01,
        validity: reported.validity,
        warning: Warning::None,
        diagnostics: Diagnostics {
            forgetting: 1.0,
            nis: 1.0,
            gate: reported.gate,
            change_probability: 0.0,
            pressure_variance_kpa2: reported.sd * reported.sd,
        },
    };
    let mut corners = reported.kpa.map(|kpa| Some(corner(kpa)));
    for (corner, loss) in corners.iter_mut().flatten().zip(reported.loss) {
        corner.loss = loss;
    }
    if let Some(corner) = reported.silent.and_then(|silent| corners[silent.index()].as_mut()) {
        (corner.validity, corner.diagnostics.gate) = (Validity::BadSignal, 0.0);
    }
    let one = |i: usize, j: usize| match (i == j, i / 2 == j / 2) {
        (true, _) => 1.0,
        (_, true) => reported.correlation.max(reported.axle_correlation),
        _ => reported.correlation,
    };
    CarEstimate {
        time_s,
        corners,
        correlation: [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| one(i, j))),
        loss_correlation: [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| one(i, j))),
        tracks: [TrackState { shared: false, incoherence: reported.incoherence }; 2],
    }
}

/// A drive of made-up estimates, with sensors that move (each by itself: nothing is concluded from them together).
#[derive(Clone)]
pub(super) struct Drive {
    pub(super) monitor: Monitor<f64>,
    pub(super) clock: SampleClock<f64>,
    pub(super) step: u32,
}

impl Drive {
    pub(super) fn new() -> Self {
        Self::with(MonitorConfig::new(&car()))
    }

    pub(super) fn with(config: MonitorConfig<f64>) -> Self {
        Self {
            monitor: Monitor::new(&config, RATE_HZ).unwrap(),
            clock: SampleClock::new(RATE_HZ).unwrap(),
            step: 0,
        }
    }

    pub(super) fn time_s(&self) -> f64 {
        f64::from(self.step) / RATE_HZ
    }

    /// Drives on; gives the first time at which `stop` holds.
    pub(super) fn until(
        &mut self,
        seconds: f64,
        reported: &Reported,
        stop: impl Fn(&MonitorReport<f64>) -> bool,
    ) -> Option<f64> {
        for _ in 0..(seconds * RATE_HZ) as u32 {
            self.step += 1;
            let wiggle = 1e-3 * f64::from(self.step % 7);
            let corner = CornerSample { body_accel_m_s2: wiggle, wheel_accel_m_s2: 2.0 * wiggle };
            let corners = [Some(corner); 4];
            let time_s = self.time_s();
            let at = self.clock.take(time_s, reported.speed_m_s);
            self.monitor.screen(
                &at,
                &CarSample { time_s, speed_m_s: reported.speed_m_s, corners, wheel_speeds: None },
            );
            assert!(self.monitor.judge(&at, &mut estimate(time_s, reported)).is_empty());
            if stop(self.monitor.report()) {
                return Some(time_s);
            }
        }
        None
    }

    pub(super) fn on(&mut self, seconds: f64, reported: &Reported) -> &MonitorReport<f64> {
        self.until(seconds, reported, |_| false);
        self.monitor.report()
    }
}

pub(super) fn state(report: &MonitorReport<f64>, corner: Corner) -> WheelState {
    report.wheels[corner.index()].unwrap().state
}

pub(super) fn low(kpa: f64) -> Reported {
    let [fl, fr, _, rr] = FINE.kpa;
    Reported { kpa: [fl, fr, kpa, rr], ..FINE }
}
