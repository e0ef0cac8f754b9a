//! A wheel's response to the road at one frequency, and the effect of its sensors' noise on the road as reconstructed
//! (docs/math/informed.md, eq. 8-12, without friction).

use itpms_core::Real;
use itpms_core::model::QuarterCar;
use itpms_core::spectrum::LEAK_RAD_S;
use nalgebra::Complex;

/// `Z = c_s s + k_s` at an angular frequency.
fn strut<T: Real>(car: &QuarterCar<T>, omega: T) -> Complex<T> {
    Complex::new(car.spring_n_per_m(), car.damping_n_s_per_m() * omega)
}

/// `H = x_w / x_r` for the compliance `theta` in m/N at a frequency in Hz.
pub(crate) fn wheel_over_road<T: Real>(car: &QuarterCar<T>, theta: T, frequency_hz: T) -> Complex<T> {
    let omega = T::two_pi() * frequency_hz;
    let (z, s2, one) = (strut(car, omega), -omega * omega, Complex::new(T::one(), T::zero()));
    let body = z / (z + car.sprung_mass_kg() * s2);
    let wheel = z * (one - body) + car.unsprung_mass_kg() * s2;
    one / (wheel * theta + one)
}

/// Noise power of the leaky road velocity for unit noise density of both accelerometers, at a frequency in Hz.
pub(crate) fn noise_gain<T: Real>(car: &QuarterCar<T>, theta: T, frequency_hz: T) -> T {
    let omega = T::two_pi() * frequency_hz;
    let s = Complex::new(T::zero(), omega);
    let leak_rad_s = T::lit(LEAK_RAD_S);
    let leak = omega * omega / (omega * omega + leak_rad_s * leak_rad_s);
    let from_body = strut(car, omega) / s * theta;
    let from_wheel = Complex::new(T::one(), T::zero()) / s + s * (theta * car.unsprung_mass_kg()) + from_body;
    leak * (from_wheel.norm_sqr() + from_body.norm_sqr())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equations of motion `m_b x_b" = Z (x_w - x_b)`, `m_w x_w" = -Z (x_w - x_b) + (x_r - x_w) / θ` hold for it.
    #[test]
    fn the_wheel_moves_as_the_equations_of_motion_say() {
        let (car, theta) = (QuarterCar::<f64>::paper_table_2(), 1.0 / 230_000.0);
        for frequency_hz in [0.5, 1.3, 11.0, 30.0] {
            let omega = core::f64::consts::TAU * frequency_hz;
            let wheel = wheel_over_road(&car, theta, frequency_hz);
            let z = strut(&car, omega);
            // With the body's motion from its own equation.
            let body = wheel * z / (z - Complex::new(car.sprung_mass_kg() * omega * omega, 0.0));
            let inertia = -wheel * (car.unsprung_mass_kg() * omega * omega);
            let forces = (Complex::new(1.0, 0.0) - wheel) / theta - z * (wheel - body);
            assert!((inertia - forces).norm_sqr().sqrt() < 1e-9 / theta, "{frequency_hz} Hz");
        }
    }

    /// A stiff tire on a wheel that nothing holds: the road is the wheel, integrated.
    #[test]
    fn without_forces_the_noise_is_that_of_an_integrated_acceleration() {
        let car = QuarterCar::<f64>::paper_table_2();
        let omega = core::f64::consts::TAU * 10.0;
        let leak = omega * omega / (omega * omega + LEAK_RAD_S * LEAK_RAD_S);
        assert!((noise_gain(&car, 0.0, 10.0) * omega * omega / leak - 1.0).abs() < 1e-12);
    }
}
