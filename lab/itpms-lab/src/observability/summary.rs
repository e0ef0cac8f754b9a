//! The result in a page of plain text.
//!
//! Called by the binary.

use super::{Car, Observability, Situation, Sources, TOLERANCE};

/// When the bounds are printed, in s.
pub(super) const REPORTED_S: [f64; 3] = [2.0, 8.0, 40.0];

impl Observability {
    pub fn summary(&self) -> String {
        let c = &self.conditions;
        let mut text = format!(
            "{}, corner {}: {:.0} N/m at {:.1} kPa\nroad Gd(n0) {:.1e} m3, slope {:.2}, {:.0} km/h; noise {} m/s2 at {:.0} Hz\n",
            self.vehicle,
            self.corner,
            c.stiffness_n_per_m,
            c.placard_kpa,
            c.road_level_m3,
            c.road_slope,
            c.speed_km_h,
            c.noise_m_s2,
            c.rate_hz
        );
        self.write_twins(&mut text);
        self.write_ranks(&mut text);
        self.write_bounds(&mut text);
        text
    }

    fn write_twins(&self, text: &mut String) {
        *text += "\nTwo tires, two roads, one measurement\n";
        *text += "  tire                                 road differs by   accelerations differ by (body, wheel)\n";
        for twin in self.twins.drives.iter().skip(1) {
            *text += &format!(
                "  {:<36} {:>7.3} mm rms    {:.0e}, {:.0e} of their largest\n",
                twin.label,
                1e3 * twin.road_difference_rms_m,
                twin.relative_difference[0],
                twin.relative_difference[1]
            );
        }
    }

    fn write_ranks(&self, text: &mut String) {
        *text += "\nRank with the road as unknown input (7 derivatives, 20 instants)\n";
        *text +=
            "  case                                            rank  missing  of these drift  stiffness\n";
        for case in &self.ranks {
            *text += &format!(
                "  {:<46} {:>2} of {:<2} {:>5} {:>15}  {}\n",
                case.label,
                case.rank,
                case.unknowns,
                case.missing,
                case.drifts,
                case.stiffness.label()
            );
        }
        let kept = self.ranks.iter().map(|case| case.smallest_kept).fold(f64::INFINITY, f64::min);
        let dropped = self.ranks.iter().map(|case| case.largest_dropped).fold(0.0, f64::max);
        *text += &format!(
            "  zero is below {TOLERANCE:.0e} of the largest singular value (kept: {kept:.0e} and up; dropped: {dropped:.0e} and down)\n"
        );
    }

    fn write_bounds(&self, text: &mut String) {
        let c = &self.conditions;
        let loss = 100.0 * (1.0 - c.pressure_after_kpa / c.placard_kpa);
        *text += "\nNo estimator can know the pressure better than (kPa, one sd; - is not at all)\n";
        *text += &format!("{:11}the car known exactly         | its file's values uncertain\n", "");
        *text += &format!(
            "{:11}constant       after a loss    | constant       after a loss (of {loss:.0} %, {:.0} s driven before)\n",
            "", c.before_s
        );
        *text += &format!("  {:<9}", "sources");
        for _ in 0..4 {
            *text += &REPORTED_S.map(|t| format!("{:>5}", format!("{t:.0} s"))).concat();
            text.push(' ');
        }
        text.push('\n');
        for sources in Sources::ALL {
            let label = sources.to_string();
            *text += &format!("  {label:<9}");
            for (car, situation) in Car::ALL.into_iter().flat_map(|car| Situation::ALL.map(|s| (car, s))) {
                for t in REPORTED_S {
                    let sd = self.curve(&label, situation, car).map_or(f64::NAN, |curve| curve.at(t));
                    *text += &format!("{:>5}", reported(sd));
                }
                text.push(' ');
            }
            *text += &format!(" {}\n", sources.text());
        }
        *text += &format!(
            "  (b') unsprung mass {:.1} kg against {:.1}{}\n  (c) period {} s; (d) sd {:.1} kPa; uncertain: unsprung mass 1 %, sprung mass 15 %, damping 20 %, spring 5 %\n",
            c.unsprung_masses_kg.1,
            c.unsprung_masses_kg.0,
            if c.unlike_is_made_up { ", made up: the vehicle's corners are alike" } else { "" },
            c.period_s,
            c.reset_sd_kpa
        );
    }
}

/// Three digits at most, or a dash.
pub(super) fn reported(sd: f64) -> String {
    if !sd.is_finite() {
        "-".to_owned()
    } else if sd < 0.005 {
        "<0.01".to_owned()
    } else if sd < 1.0 {
        format!("{sd:.2}")
    } else if sd < 100.0 {
        format!("{sd:.1}")
    } else {
        format!("{sd:.0}")
    }
}
