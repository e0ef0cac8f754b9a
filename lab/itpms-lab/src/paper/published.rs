//! The paper's results as data: Tables 1 to 5, eq. (5), and every RMSE its text names.
//!
//! Read by the study's sections; nothing here is computed by us.

/// Table 1: pressure in psi and kPa, vertical stiffness in N/m.
pub(super) const TABLE_1: [(f64, f64, f64); 5] = [
    (27.0, 186.2, 193_780.0),
    (31.0, 213.7, 213_450.0),
    (35.0, 241.3, 233_350.0),
    (39.0, 268.9, 252_960.0),
    (43.0, 296.5, 272_440.0),
];

/// Eq. (5) and Fig. 3: N/m per kPa, N/m, R².
pub(super) const REGRESSION: (f64, f64, f64) = (713.91, 60_880.0, 0.998);

/// Fig. 5b: the road spectrum's slope, as the exponent's absolute value.
pub(super) const SLOPE: f64 = 2.14;

/// Table 2: symbol, meaning, value, unit.
pub(super) const TABLE_2: [(&str, &str, f64, &str); 4] = [
    ("m_b", "sprung mass", 240.8, "kg"),
    ("m_w", "unsprung mass", 56.9, "kg"),
    ("c_s", "damping coefficient", 925.8, "N s/m"),
    ("k_s", "suspension spring", 29_114.0, "N/m"),
];

/// RMSE in kPa of the paper's estimator in Fig. 7 and, by the panels of Fig. 9, a and b.
pub(super) const FIG_7: f64 = 12.96;
pub(super) const FIG_9A: f64 = 23.21;
pub(super) const FIG_9B: f64 = 18.93;
/// Sec. 5.1, Fig. 12.
pub(super) const FIG_12: f64 = 4.22;

/// A row of Tables 3 to 5: what was changed, the RMSE in kPa, and the "relative error to nominal" as printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    /// Sprung mass in kg, or variance in (m/s²)².
    pub(super) setting: f64,
    pub(super) rmse_kpa: f64,
    /// As printed; empty for the nominal row.
    pub(super) printed: &'static str,
}

const fn row(setting: f64, rmse_kpa: f64, printed: &'static str) -> Row {
    Row { setting, rmse_kpa, printed }
}

/// Sprung mass in the simulation.
pub(super) const TABLE_3: [Row; 3] =
    [row(220.0, 17.57, "35%"), row(240.0, 12.96, ""), row(260.0, 13.31, "2.7%")];
/// Sprung mass on the test bed.
pub(super) const TABLE_4: [Row; 3] =
    [row(220.0, 3.48, "9.7%"), row(240.0, 3.17, ""), row(260.0, 3.12, "1.5%")];
/// Noise of the unsprung accelerometer on the test bed.
pub(super) const TABLE_5: [Row; 3] =
    [row(0.248, 3.02, ""), row(0.274, 2.67, "11.58%"), row(0.380, 4.22, "39%")];

/// Change against the nominal row (the one with nothing printed), in percent, computed from the printed errors.
pub(super) fn change_percent(rows: &[Row; 3], row: &Row) -> Option<f64> {
    let nominal = rows.iter().find(|row| row.printed.is_empty())?;
    (row.setting != nominal.setting).then(|| 100.0 * (row.rmse_kpa / nominal.rmse_kpa - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_percentages_are_those_of_the_printed_errors_but_cut_not_rounded() {
        for rows in [TABLE_3, TABLE_4, TABLE_5] {
            for row in rows.iter().filter(|row| !row.printed.is_empty()) {
                let computed = change_percent(&rows, row).unwrap().abs();
                let printed: f64 = row.printed.trim_end_matches('%').parse().unwrap();
                // Within one unit of the last digit printed: the paper cuts 35.57 to 35.
                assert!((0.0..1.0).contains(&(computed - printed)), "{row:?}: {computed}");
            }
        }
    }
}
