//! Transfer functions of a quarter car, and the spectrum of the sine window (docs/math/informed.md, eq. 8-12).

use nalgebra::Complex;

use super::reconstruction::LEAK_RAD_S;
use crate::memory::Blank;
use crate::model::QuarterCar;
use crate::real::Real;

/// Present parameters of a corner; the unsprung mass is known and does not change.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Body<T> {
    pub(crate) sprung_mass_kg: T,
    pub(crate) unsprung_mass_kg: T,
    pub(crate) damping_n_s_per_m: T,
    pub(crate) spring_n_per_m: T,
}

impl<T: Real> From<&QuarterCar<T>> for Body<T> {
    fn from(car: &QuarterCar<T>) -> Self {
        Self {
            sprung_mass_kg: car.sprung_mass_kg(),
            unsprung_mass_kg: car.unsprung_mass_kg(),
            damping_n_s_per_m: car.damping_n_s_per_m(),
            spring_n_per_m: car.spring_n_per_m(),
        }
    }
}

/// Bins of a describing function, and their distance in Hz: 2.5, 5, ... 25 Hz.
pub(crate) const FRICTION_BINS: usize = 10;
pub(crate) const FRICTION_SPACING_HZ: f64 = 2.5;

/// What the friction of a strut makes of its motion on average, as a spring and a damper: the part of the friction force that goes with
/// the deflection, in N/m, by frequency (docs/math/unknown-car.md, eq. 5).
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DescribingFunction<T> {
    pub(crate) n_per_m: [[T; 2]; FRICTION_BINS],
}

impl<T: Real> DescribingFunction<T> {
    /// Its value at a frequency in Hz: between bins on a line, beyond them as in the outermost.
    fn at(&self, frequency_hz: T) -> Complex<T> {
        let place = frequency_hz / T::lit(FRICTION_SPACING_HZ) - T::one();
        let place = place.clamp(T::zero(), T::lit((FRICTION_BINS - 1) as f64));
        let below = (place.to_whole() as usize).min(FRICTION_BINS - 2);
        let share = place - T::whole(below as u32);
        let [from, to] = [self.n_per_m[below], self.n_per_m[below + 1]];
        Complex::new(from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]))
    }
}

/// Power of the sine window's spectrum `offset` bins from its centre, one at the centre.
pub(crate) fn sine_window_power<T: Real>(offset: T) -> T {
    let pole = T::one() - T::lit(4.0) * offset * offset;
    let amplitude =
        if pole.abs() < T::lit(1e-3) { T::frac_pi_4() } else { (T::pi() * offset).sin_cos_fast().1 / pole };
    amplitude * amplitude
}

/// `Z = c_s s + k_s`, and `D` with friction, of which `H = x_w / x_r = 1 / (θ D + 1)`, at one frequency in Hz.
fn transfer<T: Real>(
    body: &Body<T>,
    friction: &DescribingFunction<T>,
    frequency_hz: T,
) -> (Complex<T>, Complex<T>) {
    let omega = T::two_pi() * frequency_hz;
    let (zero, one) = (T::zero(), Complex::new(T::one(), T::zero()));
    let s2 = -omega * omega;
    let linear = Complex::new(body.spring_n_per_m, body.damping_n_s_per_m * omega);
    let z = linear + friction.at(frequency_hz);
    // B = Z / (m_b s² + Z)
    let b = z / (z + Complex::new(body.sprung_mass_kg * s2, zero));
    // D = m_w s² + Z (1 - B)
    (linear, z * (one - b) + Complex::new(body.unsprung_mass_kg * s2, zero))
}

/// `|H|²` from road to wheel with the strut's friction, and the noise power of the leaky road velocity for unit noise density of both
/// accelerometers, at one frequency in Hz, for some compliances of the tire.
pub(crate) fn response<T: Real, const N: usize>(
    body: &Body<T>,
    friction: &DescribingFunction<T>,
    thetas: [T; N],
    frequency_hz: T,
) -> [(T, T); N] {
    let omega = T::two_pi() * frequency_hz;
    let (z, d) = transfer(body, friction, frequency_hz);
    // L v_r = L [1/s + θ (m_w s + Z/s)] a_w - L θ Z/s a_b
    let leak_rad_s = T::lit(LEAK_RAD_S);
    let leak = omega * omega / (omega * omega + leak_rad_s * leak_rad_s);
    let per_s = -T::one() / omega;
    let z_over_s = Complex::new(-z.im * per_s, z.re * per_s);
    thetas.map(|theta| {
        let from_body = z_over_s * theta;
        let inertia = Complex::new(T::zero(), per_s + omega * (theta * body.unsprung_mass_kg));
        let over_h = d * theta + Complex::new(T::one(), T::zero());
        (T::one() / over_h.norm_sqr(), leak * ((inertia + from_body).norm_sqr() + from_body.norm_sqr()))
    })
}
