//! The result as CSV, for other programs. An empty cell is a pressure of which nothing can be known.
//!
//! Called by the binary and by whoever writes a study's files.

use super::Observability;

impl Observability {
    /// File names without ending, and their content: the twins over time, the ranks, the bounds over time, the bounds over circumstances.
    pub fn tables(&self) -> Vec<(&'static str, String)> {
        vec![
            ("observability-twins", self.twin_table()),
            ("observability-rank", self.rank_table()),
            ("observability-time", self.time_table()),
            ("observability-sweeps", self.sweep_table()),
        ]
    }

    fn twin_table(&self) -> String {
        let mut text = "time_s".to_owned();
        for i in 0..self.twins.drives.len() {
            text += &format!(",pressure_{i}_kpa,road_{i}_m,wheel_accel_{i}_m_s2");
        }
        text.push('\n');
        for (row, time) in self.twins.time_s.iter().enumerate() {
            text += &number(*time);
            for twin in &self.twins.drives {
                for value in [twin.pressure_kpa[row], twin.road_m[row], twin.wheel_accel_m_s2[row]] {
                    text += &format!(",{}", number(value));
                }
            }
            text.push('\n');
        }
        text
    }

    fn rank_table(&self) -> String {
        let mut text =
            "case,unknowns,rank,missing,drifts,stiffness,smallest_kept,largest_dropped\n".to_owned();
        for case in &self.ranks {
            text += &format!(
                "\"{}\",{},{},{},{},{},{:.0e},{:.0e}\n",
                case.label,
                case.unknowns,
                case.rank,
                case.missing,
                case.drifts,
                case.stiffness.words(),
                case.smallest_kept,
                case.largest_dropped
            );
        }
        text
    }

    fn time_table(&self) -> String {
        let mut text = "sources,situation,car,time_s,sd_kpa\n".to_owned();
        for curve in &self.curves {
            for (time, sd) in &curve.points {
                text += &format!(
                    "{},{},{},{time},{}\n",
                    curve.sources,
                    curve.situation.label(),
                    curve.car.label(),
                    number(*sd)
                );
            }
        }
        text
    }

    fn sweep_table(&self) -> String {
        let mut text = "varied,value,sources,car,sd_kpa\n".to_owned();
        for sweep in &self.sweeps {
            for (value, sd) in &sweep.points {
                text += &format!(
                    "{},{value},{},{},{}\n",
                    sweep.varied.label(),
                    sweep.sources,
                    sweep.car.label(),
                    number(*sd)
                );
            }
        }
        text
    }
}

/// Seven digits, more would be rounding; nothing for what is infinite.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    format!("{value:.6e}").parse::<f64>().map_or_else(|_| value.to_string(), |rounded| rounded.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(f64::INFINITY), "");
        assert_eq!(number(-1.0 / 3.0), "-0.3333333");
    }
}
