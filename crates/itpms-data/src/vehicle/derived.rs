//! Quantities derived from a corner's parameters: frequencies, damping ratios, and how a wrong mass reads as a pressure. Shown
//! by `itpms vehicle show`; the tests hold typical cars against it.

use itpms_core::model::CornerConfig;

/// Figures of one corner as a quarter car on a tire at placard pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerFigures {
    /// Vertical stiffness of the tire at placard pressure in N/m.
    pub tire_n_per_m: f64,
    /// Undamped frequency in Hz of the mode in which the body moves.
    pub body_hz: f64,
    /// Damping ratio of that mode, to first order in the damping.
    pub body_damping_ratio: f64,
    /// Undamped frequency in Hz of the mode in which the wheel hops.
    pub hop_hz: f64,
    /// Damping ratio of that mode, to first order in the damping.
    pub hop_damping_ratio: f64,
    /// By how much the pressure is misread in kPa where the unsprung mass is wrong by one per cent: a wheel's hop shows
    /// stiffness over mass, and `d p / d ln k = p + stiffness_at_zero / stiffness_per_kpa`.
    pub kpa_per_percent_of_mass: f64,
}

impl CornerFigures {
    pub fn of(config: &CornerConfig<f64>, tire_damping_n_s_per_m: f64) -> Self {
        let car = &config.quarter_car;
        let (m_b, m_w) = (car.sprung_mass_kg(), car.unsprung_mass_kg());
        let (k_s, c_s) = (car.spring_n_per_m(), car.damping_n_s_per_m());
        let k_t = config.tire.stiffness_n_per_m(config.placard_kpa);
        // det(K - w² M) = 0: m_b m_w w⁴ - (m_b (k_s + k_t) + m_w k_s) w² + k_s k_t = 0.
        let half = 0.5 * (k_s / m_b + (k_s + k_t) / m_w);
        let root = (half * half - k_s * k_t / (m_b * m_w)).max(0.0).sqrt();
        let mode = |w_squared: f64| {
            let w = w_squared.sqrt();
            // Body over wheel in this mode, from the body's row; then Rayleigh's quotient of the damping.
            let body = k_s / (k_s - m_b * w_squared);
            let energy = c_s * (body - 1.0).powi(2) + tire_damping_n_s_per_m;
            (w / std::f64::consts::TAU, energy / (2.0 * w * (m_b * body * body + m_w)))
        };
        let (body_hz, body_damping_ratio) = mode(half - root);
        let (hop_hz, hop_damping_ratio) = mode(half + root);
        let offset_kpa = config.tire.stiffness_at_zero() / config.tire.stiffness_per_kpa();
        Self {
            tire_n_per_m: k_t,
            body_hz,
            body_damping_ratio,
            hop_hz,
            hop_damping_ratio,
            kpa_per_percent_of_mass: 0.01 * (config.placard_kpa + offset_kpa),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_corner_obeys_vietas_formulas() {
        let figures = CornerFigures::of(&CornerConfig::paper(), 0.0);
        let (m_b, m_w, c, k, k_t) = (240.8, 56.9, 925.8, 29_114.0, 713.91 * 241.3 + 60_880.0);
        // Vieta: the moduli's product is sqrt(k k_t / (m_b m_w)), whatever the damping.
        let product = f64::sqrt(k * k_t / (m_b * m_w)) / std::f64::consts::TAU.powi(2);
        assert!((figures.body_hz * figures.hop_hz / product - 1.0).abs() < 1e-12);
        // And the sum of 2 zeta w is the trace of the damping: c (1/m_b + 1/m_w).
        let trace = |hz: f64, zeta: f64| 2.0 * zeta * std::f64::consts::TAU * hz;
        let sum = trace(figures.body_hz, figures.body_damping_ratio)
            + trace(figures.hop_hz, figures.hop_damping_ratio);
        assert!((sum / (c * (1.0 / m_b + 1.0 / m_w)) - 1.0).abs() < 1e-12);
        // 3.27 kPa per cent: 241.3 + 60880/713.91 = 326.6 kPa.
        assert!((figures.kpa_per_percent_of_mass - 3.266).abs() < 1e-3);
    }

    #[test]
    fn a_stiff_tire_leaves_two_simple_oscillators() {
        // Where the tire is a thousand times the spring, the body swings on its spring and the wheel on its tire.
        let tire = itpms_core::model::PressureMap::new(100_000.0, 0.0).unwrap();
        let car = itpms_core::model::QuarterCar::new(300.0, 40.0, 100.0, 20_000.0).unwrap();
        let figures = CornerFigures::of(&CornerConfig::new(car, tire, 200.0).unwrap(), 0.0);
        let hz = |k: f64, m: f64| (k / m).sqrt() / std::f64::consts::TAU;
        assert!((figures.body_hz / hz(20_000.0, 300.0) - 1.0).abs() < 2e-3);
        assert!((figures.hop_hz / hz(20_020_000.0, 40.0) - 1.0).abs() < 2e-3);
        assert!(
            (figures.body_damping_ratio / (100.0 / (2.0 * (20_000.0f64 * 300.0).sqrt())) - 1.0).abs() < 5e-3
        );
    }
}
