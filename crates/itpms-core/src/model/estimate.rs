//! Output of every estimator: pressure and stiffness with their standard deviations, whether to believe them, and a warning.

use crate::memory::Blank;
use crate::model::{Confidence, ParameterError, ParameterUncertainty, PressureMap, QuarterCar, positive};
use crate::real::Real;

/// Configuration of a corner's estimator.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CornerConfig<T> {
    /// Masses, spring and damper.
    pub quarter_car: QuarterCar<T>,
    /// Stiffness over pressure.
    pub tire: PressureMap<T>,
    /// Pressure the car's placard asks for, in kPa gauge.
    pub placard_kpa: T,
    /// Accelerometer noise in m/s², rms per sample at the log's rate, both sensors; `None`: 0.05 is assumed.
    pub accel_noise_m_s2: Option<T>,
    /// Pressure to start from, in kPa gauge; `None`: the placard's.
    pub initial_kpa: Option<T>,
    /// How well all of this is known.
    pub uncertainty: ParameterUncertainty<T>,
}

impl<T: Real> CornerConfig<T> {
    /// A corner with the placard's pressure as its start and unknown sensor noise, its parameters as well known as
    /// [typical](Confidence::Typical) ones.
    ///
    /// # Errors
    /// The placard pressure must be positive and finite.
    pub fn new(
        quarter_car: QuarterCar<T>,
        tire: PressureMap<T>,
        placard_kpa: T,
    ) -> Result<Self, ParameterError> {
        let placard_kpa = positive("placard_kpa", placard_kpa)?;
        let uncertainty = ParameterUncertainty::of(Confidence::Typical);
        Ok(Self { quarter_car, tire, placard_kpa, accel_noise_m_s2: None, initial_kpa: None, uncertainty })
    }

    /// The same with a known accelerometer noise in m/s² rms per sample.
    ///
    /// # Errors
    /// The noise must be positive and finite.
    pub fn with_accel_noise(self, accel_noise_m_s2: T) -> Result<Self, ParameterError> {
        Ok(Self { accel_noise_m_s2: Some(positive("accel_noise_m_s2", accel_noise_m_s2)?), ..self })
    }

    /// The same with another pressure to start from, in kPa gauge.
    ///
    /// # Errors
    /// The pressure must be positive and finite.
    pub fn with_initial_pressure(self, initial_kpa: T) -> Result<Self, ParameterError> {
        Ok(Self { initial_kpa: Some(positive("initial_kpa", initial_kpa)?), ..self })
    }

    /// The paper's simulated corner: Table 2, eq. (5), placard 241.3 kPa (35 psi), noise 0.05 m/s²; measured.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            quarter_car: QuarterCar::paper_table_2(),
            tire: PressureMap::paper_eq_5(),
            placard_kpa: T::lit(241.3),
            accel_noise_m_s2: Some(T::lit(0.05)),
            initial_kpa: None,
            uncertainty: ParameterUncertainty::of(Confidence::Measured),
        }
    }

    /// Accelerometer noise in m/s² rms per sample: as given, else 0.05.
    pub fn accel_noise_or_usual_m_s2(&self) -> T {
        self.accel_noise_m_s2.unwrap_or(T::lit(0.05))
    }

    /// Stiffness to start from in N/m.
    pub fn initial_stiffness_n_per_m(&self) -> T {
        self.tire.stiffness_n_per_m(self.initial_kpa.unwrap_or(self.placard_kpa))
    }
}

/// Whether, and if not why not, an estimate may be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// `Starting` is zero, as is all memory that is not configured.
pub enum Validity {
    /// The data says this.
    Valid = 1,
    /// Not enough has been seen since the start.
    #[blank]
    Starting = 0,
    /// Nothing to learn from for a while: standing still, too smooth, hidden in noise.
    NoInformation = 2,
    /// Samples are missing, stuck or absurd.
    BadSignal = 3,
    /// The computation left its range (a published filter diverged).
    Diverged = 4,
    /// Body and wheel do not move as the vehicle file says: what is read from them is no tire.
    Misfit = 5,
}

impl Validity {
    /// True for [`Validity::Valid`] alone.
    #[must_use]
    pub fn is_valid(self) -> bool {
        self == Validity::Valid
    }
}

crate::labelled! {
    /// Reference of a pressure's level; changes show by themselves.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Blank)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub enum Level {
        /// On masses and the tire's stiffness in the vehicle file.
        #[blank]
        VehicleFile = "file",
        /// On a calibration of this drive, which set it.
        Calibration = "calibration",
        /// On a calibration of an earlier drive: since then load, tires and whatever else may have changed.
        StoredCalibration = "reference",
        /// On nothing: what is known is how the tire differs from the others since a calibration. What all four lost alike is not seen.
        OtherTires = "other-tires",
    }
}

/// One tire's message to the driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// Begins at one, so that `None` of a wheel's report is zero, as is all memory that is not configured.
pub enum Warning {
    /// Nothing to say. Not a promise that all is well: see [`Validity`].
    None = 1,
    /// Under-inflated.
    Low,
    /// The sensors do not allow a statement.
    Malfunction,
}

impl Warning {
    /// The word in `est.csv`: `none`, `low` or `malfunction`.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Warning::None => "none",
            Warning::Low => "low",
            Warning::Malfunction => "malfunction",
        }
    }
}

/// The estimate of one corner after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CornerEstimate<T> {
    /// Time of the sample in s.
    pub time_s: f64,
    /// Tire stiffness in N/m.
    pub stiffness_n_per_m: T,
    /// Its standard deviation in N/m, that of the vehicle file included.
    pub stiffness_sd_n_per_m: T,
    /// Gauge pressure in kPa.
    pub pressure_kpa: T,
    /// Its standard deviation in kPa, that of the vehicle file and the map included.
    pub pressure_sd_kpa: T,
    /// The same without what the vehicle file leaves open: how well a change within minutes is known, in kPa.
    pub change_sd_kpa: T,
    /// Reference of its level.
    pub level: Level,
    /// Standard deviation in kPa of its difference from the pressure of its axle's other tire: errors of the level are common to
    /// both. `None` without another one.
    pub axle_difference_sd_kpa: Option<T>,
    /// The tire's loss since losses are counted; `None` as long as they are not. For show: [`lost_kpa`](Self::lost_kpa).
    pub loss: Option<Loss<T>>,
    /// Its cold pressure; `None` where the temperature of the air is not known.
    pub cold: Option<ColdPressure<T>>,
    /// Road height under the wheel in m, causal and without drift; NaN where no filter of the road has set it.
    pub road_m: T,
    /// Its standard deviation in m.
    pub road_sd_m: T,
    /// Whether to believe it.
    pub validity: Validity,
    /// The message to the driver.
    pub warning: Warning,
    /// The estimator's inner life, for reports and consistency checks.
    pub diagnostics: Diagnostics<T>,
}

impl<T: Real> CornerEstimate<T> {
    /// The tire's loss in this drive and its standard deviation in kPa; NaN as long as that is not counted, and where it may have lost
    /// air before that.
    pub fn lost_kpa(&self) -> [T; 2] {
        let whole = self.loss.filter(|loss| loss.is_whole == 1);
        whole.map_or([T::lit(f64::NAN); 2], |loss| [loss.lost_kpa, loss.lost_sd_kpa])
    }
}

/// A tire's loss since losses are counted, in kPa: its level is wrong by the same before and after, so a loss is known far better.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Loss<T> {
    /// Pressure when the loss began to be counted.
    pub level_kpa: T,
    /// One if that is all it has lost in this drive, since it was not low when the loss began to be counted; else zero. No `bool`: its unused
    /// values would be what `None` is made of, and memory that has not been configured would not be zeros.
    pub is_whole: u8,
    /// Loss since then; below zero where the tire became warmer.
    pub lost_kpa: T,
    /// Its standard deviation, with what the vehicle file leaves open.
    pub lost_sd_kpa: T,
    /// The same on one road, as far as the signals tell: how well it is known that it has changed.
    pub change_sd_kpa: T,
    /// Loss beyond the other tires' mean loss, and its standard deviation: warmth and a change of the whole car
    /// cancel. What the vehicle file leaves open is no part of the latter: it is a share of the loss, and none where nothing was lost.
    pub excess_kpa: T,
    /// See [`excess_kpa`](Self::excess_kpa).
    pub excess_sd_kpa: T,
}

/// The pressure that a tire would have once it had cooled down to the temperature of the air around the car, where tires are filled
/// (docs/math/cold-pressure.md, eq. 1).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ColdPressure<T> {
    /// Gauge pressure in kPa.
    pub pressure_kpa: T,
    /// Its standard deviation in kPa: that of the pressure, and what is not known of the tire's temperature and of the air.
    pub sd_kpa: T,
    /// Ambient temperature in degrees Celsius that it holds for.
    pub ambient_temperature_c: T,
}

/// Less than this many kPa short is not worth a pump.
const WORTH_KPA: f64 = 5.0;

impl<T: Real> ColdPressure<T> {
    /// Air in kPa that the tire lacks to have its placard pressure cold; `None` where that is less than its standard deviation or hardly any.
    pub fn air_to_add_kpa(&self, placard_kpa: T) -> Option<T> {
        let short_kpa = placard_kpa - self.pressure_kpa;
        (short_kpa > self.sd_kpa && short_kpa > T::lit(WORTH_KPA)).then_some(short_kpa)
    }
}

/// How an estimate came about.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Diagnostics<T> {
    /// Forgetting factor `lambda >= 1` of the covariance (eq. 28); 1 keeps everything. For `informed`: the factor by
    /// which its variance grew in the last prediction step.
    pub forgetting: T,
    /// Normalised innovation squared of the last update, divided by its expected value: about 1 when consistent.
    pub nis: T,
    /// Information gate, 0 (nothing learned) to 1 (all of the last frame used, or a road that both axles share).
    pub gate: T,
    /// Probability that the pressure is changing now; NaN where the estimator has no such notion.
    pub change_probability: T,
    /// Variance of the pressure in kPa² (`P_55` over slope squared for the filters).
    pub pressure_variance_kpa2: T,
}
