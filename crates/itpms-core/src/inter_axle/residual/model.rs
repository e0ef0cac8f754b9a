//! What front and rear of one side should agree on: the road velocity, from each axle's signals (docs/math/shared-road.md,
//! eq. 1-7). Gives the residual of a frame, bin by bin, and how it changes with every unknown quantity. Knows nothing
//! of beliefs.

use nalgebra::{Complex, Matrix3, SMatrix, SVector};

use crate::belief::LEAST_DAMPING;
use crate::belief::measurement::{AxleResidual, BINS, Products, Slope};
use crate::belief::state::{
    BAR, COUPLING, DAMPING, GAIN, MASS, SIDE_GAIN, SIDE_OTHERS, SIDE_REAR, SIDE_SIZE, SIDE_SKEW, SKEW,
    SKEW_UNIT_S, SPRING, State, WHEELBASE, read_compliance,
};
use crate::cholesky::packed;
use crate::inter_axle::alignment::channel::{BOTH, SEEN, place};
use crate::inter_axle::residual::correction::FrfRatios;
use crate::inter_axle::{BIN_SPACING_HZ, Frame, bin_hz};
use crate::memory::Blank;
use crate::model::{Corner, Side};
use crate::real::Real;
use crate::spectrum::front_end::high_pass_power;
use crate::spectrum::transfer::{Body, sine_window_power};

/// Points per bin, on each side, and in all, at which the window's spectrum is averaged, and the lowest frequency in Hz of that.
const KERNEL_DENSITY: f64 = 4.0;
const KERNEL_HALF: usize = 8;
const KERNEL: usize = 2 * KERNEL_HALF + 1;
const LOWEST_HZ: f64 = 0.5;

/// Parameters of one axle's corner.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Wheel<T> {
    /// As in the vehicle file.
    pub(crate) body: Body<T>,
    /// Mean damping of the strut's friction near wheel hop, beside the damper.
    pub(crate) friction_n_s_per_m: T,
    /// Compliance of the tire at placard pressure in m/N.
    pub(crate) theta: T,
    /// Unsprung mass in kg that an axle may couple to the other wheel's: none of a front wheel, or where the other one has no sensors.
    pub(crate) coupled_kg: T,
    pub(crate) corner: Corner,
}

/// A complete frame of both axles, and where it was taken.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AxleFrame<T: Real> {
    /// Spectra of the front's and the rear's signals, then of both reduced to the common road.
    pub(crate) frame: Frame<T>,
    /// Time in s of its middle at the rear wheel.
    pub(crate) middle_s: f64,
    pub(crate) delay_s: T,
    /// What wheelbase and skew were taken to be in aligning them.
    pub(crate) used_wheelbase: T,
    pub(crate) used_skew: T,
}

/// Most of an axle's coupling that is believed: a rod with its mass at both ends has none, a uniform one a third, and a mass that is all in
/// the middle a half, against which its wheels would move without any.
const MOST_COUPLING: f64 = 0.4;
/// One axle's quantities in a side's residual: tire, mass, damping, spring, bar, coupling.
const OWN: usize = SEEN;

/// Whose signals of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Signals<'a, T: Real> {
    Measured,
    /// On the road that both axles agree on, as the instruments have them, times how the axles answer it.
    Common(&'a FrfRatios<T>),
}

/// How the wheels of an axle move: as one, or against each other, where an axle that couples them has less mass. A wheel by itself moves by
/// half of each.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Mode {
    Together,
    Against,
}

/// One axle's parameters as a state has them.
pub(crate) struct Axle<T> {
    /// Compliance in m/N of the tire, as it is and at placard pressure.
    pub(crate) theta: T,
    placard: T,
    /// Unsprung mass, damping, spring, anti-roll bar, the mass that the other wheel moves: as they are, and by how much of each the quantities
    /// of the state count.
    pub(crate) factors: [T; OWN - 1],
    nominal: [T; OWN - 1],
    /// Damping with which the strut answers a road: that of the friction, which is taken out of the signals, included. What the belief
    /// takes off a damper because too much friction was taken out is there again.
    pub(crate) whole_damping: T,
}

impl<T: Real> Axle<T> {
    pub(crate) fn new(wheel: &Wheel<T>, state: &State<T>) -> Self {
        let corner = wheel.corner;
        let at = |kind: usize| T::one() + state[kind + corner.index()];
        let body = &wheel.body;
        let spring = body.spring_n_per_m;
        let nominal = [body.unsprung_mass_kg, body.damping_n_s_per_m, spring, spring, wheel.coupled_kg];
        let mass = nominal[0] * at(MASS);
        let most = T::lit(MOST_COUPLING) * mass;
        let factors = [
            mass,
            nominal[1] * at(DAMPING),
            spring * at(SPRING),
            spring * state[BAR + corner.axle()],
            (wheel.coupled_kg * state[COUPLING]).min(most).max(-most),
        ];
        let least = T::lit(LEAST_DAMPING) * nominal[1];
        let whole_damping = (factors[1] + wheel.friction_n_s_per_m).max(least);
        let theta = wheel.theta * read_compliance(state, corner);
        Self { theta, placard: wheel.theta, factors, nominal, whole_damping }
    }

    /// The road velocity that the signals of an entry tell.
    pub(crate) fn road_velocity(&self, signals: &[T]) -> T {
        let Some((&wheel, signals)) = signals.split_first() else { return T::zero() };
        let force = self.factors.iter().zip(signals).fold(T::zero(), |sum, (&f, &x)| sum + f * x);
        wheel + self.theta * force
    }

    /// Mass in kg that a wheel has as both move alike or against each other.
    pub(crate) fn mode_mass_kg(&self, mode: Mode) -> T {
        let [unsprung_mass_kg, .., coupled_kg] = self.factors;
        match mode {
            Mode::Together => unsprung_mass_kg,
            Mode::Against => unsprung_mass_kg - T::lit(2.0) * coupled_kg,
        }
    }

    /// The signals that a road of unit velocity makes at a frequency in Hz if the other wheel has none, the bar's as if it stood still.
    fn over_unit_road(&self, sprung_mass_kg: T, frequency_hz: T) -> [Complex<T>; SEEN] {
        let of = |mode| self.mode_over_unit_road(self.mode_mass_kg(mode), sprung_mass_kg, frequency_hz);
        let [together, against] = [of(Mode::Together), of(Mode::Against)];
        let mut own = core::array::from_fn(|i| (together[i] + against[i]) * T::lit(0.5));
        own[SEEN - 1] = against[SEEN - 1];
        own
    }

    fn mode_over_unit_road(&self, mass_kg: T, sprung_mass_kg: T, frequency_hz: T) -> [Complex<T>; SEEN] {
        let s = Complex::new(T::zero(), T::two_pi() * frequency_hz);
        let one = Complex::new(T::one(), T::zero());
        let z = s * self.whole_damping + one * self.factors[2];
        let friction = s * (self.whole_damping - self.factors[1]);
        let (sprung, unsprung) = (s * s * sprung_mass_kg, s * s * mass_kg);
        // v_w - v_b = Q v_w, and R = v_w (1 + θ (m s² + Z Q)).
        let relative = sprung / (sprung + z);
        let wheel = one / (one + (unsprung + z * relative) * self.theta);
        // The wheel's jerk is given with friction's part of it taken out.
        let jerk = s * s + friction * relative / mass_kg;
        [wheel, jerk * wheel, s * relative * wheel, relative * wheel, relative * wheel, -jerk * wheel]
    }

    /// Road and its derivatives by tire, mass, damping, spring, bar, coupling, from wheel velocity and the force signals: those measured, or else
    /// instruments', whose force is that of this side's road alone. What another road is misread by would be taken for tires.
    fn road(&self, signals: [Complex<T>; SEEN], measured: bool) -> (Complex<T>, [Complex<T>; OWN]) {
        let [.., coupled_kg] = self.factors;
        let mut force = if measured { signals[SEEN - 1] } else { -signals[1] } * coupled_kg;
        let mut slope = [force; OWN];
        for i in 0..OWN - 1 {
            slope[i + 1] = signals[i + 1] * (self.theta * self.nominal[i]);
        }
        for i in 0..OWN - 2 {
            force += signals[i + 1] * self.factors[i];
        }
        slope[0] = force * self.placard;
        (signals[0] + force * self.theta, slope)
    }
}

/// Compares the axles of a side for a state.
pub(crate) fn linearize<T: Real>(
    taken: &AxleFrame<T>,
    signals: Signals<'_, T>,
    wheels: &[Wheel<T>; 2],
    side: Side,
    state: &State<T>,
) -> AxleResidual<T> {
    let axles = [Axle::new(&wheels[0], state), Axle::new(&wheels[1], state)];
    let gain = T::one() + state[GAIN + side.index()];
    let filter_delay_s = taken.delay_s * (state[WHEELBASE] - taken.used_wheelbase)
        + T::lit(SKEW_UNIT_S) * (state[SKEW + side.index()] - taken.used_skew);
    let mut out = AxleResidual {
        rows: SVector::zeros(),
        slope: SMatrix::zeros(),
        common: [Complex::new(T::zero(), T::zero()); BINS],
        road_power: [T::zero(); BINS],
    };
    for bin in 0..BINS {
        out.fill(taken, signals, &axles, gain, filter_delay_s, bin);
    }
    out
}

/// Road velocity and power of every bin as the axles measured it, their mean. Here and below: functions of their own, so that
/// not all of a frame's derivatives lie on the stack at once.
#[inline(never)]
pub(crate) fn common_road<T: Real>(
    frame: &AxleFrame<T>,
    wheels: &[Wheel<T>; 2],
    side: Side,
    state: &State<T>,
) -> ([Complex<T>; BINS], [T; BINS]) {
    let AxleResidual { common, road_power, .. } = linearize(frame, Signals::Measured, wheels, side, state);
    (common, road_power)
}

/// Derivatives of the residual on the road that both axles agree on.
#[inline(never)]
pub(crate) fn instrument_slope<T: Real>(
    frame: &AxleFrame<T>,
    frf_ratios: &FrfRatios<T>,
    wheels: &[Wheel<T>; 2],
    side: Side,
    state: &State<T>,
) -> Slope<T> {
    linearize(frame, Signals::Common(frf_ratios), wheels, side, state).slope
}

impl<T: Real> AxleResidual<T> {
    fn fill(
        &mut self,
        taken: &AxleFrame<T>,
        signals: Signals<'_, T>,
        axles: &[Axle<T>; 2],
        gain: T,
        filter_delay_s: T,
        bin: usize,
    ) {
        let bin = bin.min(BINS - 1);
        let of = |axle: usize| {
            core::array::from_fn(|i| match (place(axle, i), signals) {
                (None, _) => Complex::new(T::zero(), T::zero()),
                (Some(at), Signals::Measured) => taken.frame.at(bin, at),
                (Some(at), Signals::Common(frf_ratios)) => {
                    taken.frame.at(bin, BOTH + at) * ratio(frf_ratios, bin, at)
                }
            })
        };
        let measured = matches!(signals, Signals::Measured);
        let seen = [axles[0].road(of(0), measured), axles[1].road(of(1), measured)];
        let slope = slopes(&seen, gain, bin_hz(bin));
        let (ahead, behind) = (seen[0].0 * gain, seen[1].0);
        let common = (ahead + behind) * T::lit(0.5);
        let turn = Complex::new(T::zero(), T::two_pi() * bin_hz::<T>(bin)) * common;
        let residual = ahead - behind - turn * filter_delay_s;
        self.common[bin] = common;
        self.rows[bin] = residual.re;
        self.rows[BINS + bin] = residual.im;
        self.road_power[bin] = T::lit(0.5) * (ahead.norm_sqr() + behind.norm_sqr());
        for (column, value) in slope.iter().enumerate() {
            self.slope[(bin, column)] = value.re;
            self.slope[(BINS + bin, column)] = value.im;
        }
    }
}

/// What the derivatives' products on a road of unit power depend on.
pub(crate) struct UnitRoad<'a, T: Real> {
    wheels: &'a [Wheel<T>; 2],
    axles: [Axle<T>; 2],
    gain: T,
    frf_ratios: &'a FrfRatios<T>,
}

impl<'a, T: Real> UnitRoad<'a, T> {
    /// For a state, if the axles answer the road as the ratios say.
    pub(crate) fn new(
        wheels: &'a [Wheel<T>; 2],
        side: Side,
        state: &State<T>,
        frf_ratios: &'a FrfRatios<T>,
    ) -> Self {
        let axles = [Axle::new(&wheels[0], state), Axle::new(&wheels[1], state)];
        Self { wheels, axles, gain: T::one() + state[GAIN + side.index()], frf_ratios }
    }

    /// Products of the derivatives with each other that a road of unit power makes in a bin: `Re⟨C* C⟩`.
    #[inline(never)]
    pub(crate) fn expected_products(&self, bin: usize) -> Products<T> {
        let mut sum = Products::zeros();
        let (mut other_side, mut total) = (Matrix3::zeros(), T::zero());
        for point in 0..KERNEL {
            let offset = T::lit((point as f64 - KERNEL_HALF as f64) / KERNEL_DENSITY);
            let frequency = (bin_hz::<T>(bin) + T::lit(BIN_SPACING_HZ) * offset).abs().max(T::lit(LOWEST_HZ));
            let weight = sine_window_power(offset) * high_pass_power(frequency);
            let seen = |axle: usize| {
                let foretold =
                    self.axles[axle].over_unit_road(self.wheels[axle].body.sprung_mass_kg, frequency);
                let signals = core::array::from_fn(|i| match place(axle, i) {
                    Some(at) => foretold[i] * ratio(self.frf_ratios, bin, at),
                    None => Complex::new(T::zero(), T::zero()),
                });
                self.axles[axle].road(signals, false)
            };
            // As a frame sees it: its turns are those of the middle of a bin.
            let slope = slopes(&[seen(0), seen(1)], self.gain, bin_hz(bin));
            // Real and imaginary part, times the root of the bin's weight at this frequency.
            let root = weight.sqrt();
            let [re, im] = [slope.map(|of| of.re * root), slope.map(|of| of.im * root)];
            let mut left = sum.as_mut_slice();
            for (column, (&by_re, &by_im)) in re.iter().zip(&im).enumerate() {
                let [re, im] = [&re, &im].map(|part| part.get(column..).unwrap_or(&[]));
                let Some((sums, others)) = left.split_at_mut_checked(re.len()) else { break };
                left = others;
                for (sum, (&re, &im)) in sums.iter_mut().zip(re.iter().zip(im)) {
                    *sum += by_re * re + by_im * im;
                }
            }
            other_side +=
                Matrix3::from_fn(|i, j| (slope[SIDE_OTHERS[i]] * slope[SIDE_OTHERS[j]].conj()).re * weight);
            total += weight;
        }
        // The other side moves as much, by itself, and alike under both axles.
        for (i, j) in [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)] {
            sum[packed::<SIDE_SIZE>(SIDE_OTHERS[i], SIDE_OTHERS[j])] += other_side[(i, j)];
        }
        sum / total
    }
}

/// How a signal of an axle is on the common road, over what the instruments make of it.
fn ratio<T: Real>(frf_ratios: &FrfRatios<T>, bin: usize, at: usize) -> Complex<T> {
    let ratios = frf_ratios.get(bin).and_then(|ratios| ratios.get(at));
    ratios.copied().unwrap_or(Complex::new(T::zero(), T::zero()))
}

/// Derivatives of a residual, from each axle's road and its derivatives.
fn slopes<T: Real>(
    seen: &[(Complex<T>, [Complex<T>; OWN]); 2],
    gain: T,
    frequency_hz: T,
) -> [Complex<T>; SIDE_SIZE] {
    let [(front, front_slope), (rear, rear_slope)] = seen;
    let turn = Complex::new(T::zero(), T::two_pi() * frequency_hz) * (*front * gain + rear) * T::lit(0.5);
    let mut slope = [Complex::new(T::zero(), T::zero()); SIDE_SIZE];
    for i in 0..SIDE_REAR {
        slope[i] = front_slope[i] * gain;
        slope[SIDE_REAR + i] = -rear_slope[i];
    }
    let [.., coupling] = SIDE_OTHERS;
    slope[coupling] = -rear_slope[OWN - 1];
    slope[SIDE_GAIN] = *front;
    slope[SIDE_SKEW] = -turn * T::lit(SKEW_UNIT_S);
    slope
}
