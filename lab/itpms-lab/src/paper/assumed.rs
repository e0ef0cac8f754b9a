//! Choices that the paper leaves open. A list for the reader, with the option that changes it where there is one.
//!
//! Called by [`super::reproduce`].

use super::Request;
use super::data::Data;
use super::plan::{CONFIGURED_KG, RESET_LONG_S, RESET_SHORT_S};
use super::section::{Section, Table};

/// What, our choice, why.
type Assumption = (&'static str, String, &'static str);

#[rustfmt::skip]
fn assumptions(request: &Request) -> Vec<Assumption> {
    vec![
        ("Sampling rate of the simulation", format!("{} Hz (--rate)", request.rate_hz),
         "Not stated. Below 200 Hz the published filters' first-order step is coarse for wheel hop."),
        ("Accelerometer noise of the simulation", format!("{} m/s² rms per sample, both sensors (--noise)", request.noise_m_s2),
         "Not stated. The filters' R = 0.5 is a tuning, not a measured noise."),
        ("Anti-alias filter", "Butterworth, fourth order, 0.3 of the rate".into(),
         "Not stated. Any logger has one; the published filters have no use for it."),
        ("Road of the simulation", format!("Gaussian, slope 2.14, Gd(n0) = {:e} m³ (--road), a different one for every seed", request.road_gd_n0_m3),
         "The paper's measured road (its reference 30) is not printed. 16e-6 m³ is the mean of ISO 8608 class A."),
        ("Begin of the loss", "20 s (Fig. 7, 9a), 15 s (Fig. 9b)".into(), "Only drawn in the paper."),
        ("Recovery of Fig. 9b", "138 to 195 kPa from 17.5 to 27.5 s".into(), "Only drawn in the paper."),
        ("Sprung mass of Table 3", format!("Estimators are given {CONFIGURED_KG} kg, the car weighs 220, 240 or 260"),
         "The text could also mean the opposite; Fig. 7's 240.8 kg and Table 3's 240 are taken to be one experiment."),
        ("Which input the correction of eq. (17) subtracts", "the new estimate u*_k".into(),
         "Printed with u*_{k-1}; the work it cites has the new one. A table below Fig. 7 has both."),
        ("State derivative, eq. (3)", "rows for both velocities, from eq. (1) and (2)".into(),
         "Printed with rows missing."),
        ("Q and R of Sec. 4", "Q = 1e-10 I (process), R = 0.5 I (measurement)".into(),
         "The paper calls both \"measurement noise\"."),
        ("S_0 of eq. (12)", "not used; u*_0 = 0".into(), "It enters no later equation; no value is given."),
        ("Forgetting factor", "the one-step factor, eq. (28) to (33), λ of the step before in eq. (18)".into(),
         "The paper has two and uses this one."),
        ("Iterative factor, eq. (25) to (27)", "the slope subtracted; (26) between two iterates of one step; started from above".into(),
         "Printed with a plus sign, which climbs; the start is not stated and decides which minimum is found."),
        ("RMSE, eq. (38)", "over t > 3 s".into(),
         "Printed as over all of the time; the first seconds would measure the initial value."),
        ("Sampling rate of the test bed", format!("{} Hz (--bench-rate)", request.bench_rate_hz),
         "Not stated."),
        ("Unsprung mass of the test bed", format!("{} kg (--bench-unsprung-mass)", request.bench_unsprung_mass_kg),
         "Not stated; that of Table 2."),
        ("Tire of the test bed", "eq. (5)".into(), "Taken to be the tire of Table 1."),
        ("Road of the test bed", "the same level, slope 2, drawn at random for every seed, repeated every 0.66 s".into(),
         "Only drawn in the paper (Fig. 11c)."),
        ("Hydraulic actuator", format!("second order, {} Hz (--bench-actuator), damping 0.7", request.bench_actuator_hz),
         "Not stated."),
        ("Noise of the test bed's accelerometers", "wheel: variance 0.248 (m/s²)² per sample; body: 0.05 m/s² rms".into(),
         "Table 5 gives the variance for the wheel and not at which rate; nothing on the body."),
        ("Pressure sensor of the test bed", "slow, noisy and coarse as a PN2023 might be; errors here are against the true pressure".into(),
         "Only its make is stated."),
        ("Reset drive", format!("first {RESET_LONG_S} s at known pressure (Fig. 12, 14, 16), first {RESET_SHORT_S} s (Fig. 13)"),
         "The paper has none. Every indirect system on the market has one; rows without are beside it."),
    ]
}

pub(super) fn section(request: &Request) -> Section {
    let all = assumptions(request);
    let data = Data::new("assumed", "Assumed, because the paper does not say")
        .text("what", all.iter().map(|one| one.0.to_owned()))
        .text("choice", all.iter().map(|one| one.1.clone()))
        .text("why", all.iter().map(|one| one.2.to_owned()));
    let mut table = Table::new("Assumptions", &["What", "Our choice", "Why"], data);
    for (what, choice, why) in all {
        table = table.row([what.to_owned(), choice, why.to_owned()]);
    }
    Section::new("assumed", "Assumed, because the paper does not say")
        .table(table, "Choices that can change a figure. An option in brackets changes the choice.")
}
