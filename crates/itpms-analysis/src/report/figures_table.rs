//! The table of a report's figures: one line a figure, one column a corner. Called by the page's writer.

use std::fmt::Write as _;

use itpms_core::model::{Level, PressureUnit, Warning};

use super::words::{clock, corner_name, level, reading};
use super::{CornerReport, ReportData};

/// A figure's name, its explanation, and its value for a corner (empty: unknown).
type Row = (&'static str, &'static str, fn(&CornerReport, PressureUnit) -> String);

pub(super) fn some(value: Option<f64>, text: impl Fn(f64) -> String) -> String {
    value.filter(|v| v.is_finite()).map_or(String::new(), text)
}

fn pressure(kpa: f64, unit: PressureUnit) -> String {
    format!("{} {unit}", unit.number(kpa, 1))
}

const FIGURES: [Row; 22] = [
    ("Pressure at the end", "last valid estimate, ± one standard deviation", |c, unit| {
        c.figures.last.as_ref().map_or(String::new(), |last| reading(last, unit))
    }),
    ("Level from", "what the pressure's level rests on", |c, _| {
        c.figures.grounds.map_or(String::new(), |g| match g.level {
            Level::VehicleFile => "vehicle file".into(),
            Level::Calibration => "calibration".into(),
            Level::StoredCalibration => "calibration of an earlier drive".into(),
            Level::OtherTires => "the other tires".into(),
        })
    }),
    ("Change known to", "standard deviation of what it has changed by within minutes", |c, unit| {
        some(c.figures.grounds.map(|g| g.change_sd_kpa), |v| format!("± {}", pressure(v, unit)))
    }),
    (
        "Against its axle",
        "standard deviation of the difference from the other tire of the axle",
        |c, unit| {
            some(c.figures.grounds.and_then(|g| g.axle_difference_sd_kpa), |v| {
                format!("± {}", pressure(v, unit))
            })
        },
    ),
    ("Lowest pressure", "where the upper end of the 95 % interval is lowest", |c, unit| {
        c.figures
            .lowest
            .as_ref()
            .map_or(String::new(), |r| format!("{} at {}", reading(r, unit), clock(r.time_s)))
    }),
    ("Tire sensor", "what the tire's own sensor last sent; it may be wrong itself", |c, unit| {
        c.tire_sensor.map_or(String::new(), |sensor| {
            let since = some(sensor.contradicts_since_s, |t| {
                format!("; contradicts the estimate since {}", clock(t))
            });
            format!("{} at {}{since}", pressure(sensor.pressure_kpa, unit), clock(sensor.time_s))
        })
    }),
    ("Placard pressure", "what the tire should have", |c, unit| pressure(c.placard_kpa, unit)),
    ("Warning", "at the end of the drive", |c, _| {
        let since = some(c.figures.low_since_s, |t| format!(", first warned of at {}", clock(t)));
        match c.figures.warning {
            Warning::Low => format!("low{since}"),
            Warning::Malfunction => "malfunction".into(),
            Warning::None if since.is_empty() => "none".into(),
            Warning::None => format!("none; low{since}"),
        }
    }),
    ("Valid", "share of the samples with a valid estimate", |c, _| percent(c.figures.share_valid)),
    ("RMSE", "root mean squared error against the truth, after the settling time", |c, unit| {
        some(c.figures.truth.map(|t| t.rmse_kpa), |v| pressure(v, unit))
    }),
    ("Bias", "mean of estimate less truth", |c, unit| {
        some(c.figures.truth.map(|t| t.bias_kpa), |v| format!("{:+} {unit}", unit.number(v, 1)))
    }),
    ("Coverage", "share of the truth inside the 95 % interval; 95 % is right", |c, _| {
        some(c.figures.truth.map(|t| t.coverage), percent)
    }),
    ("Compared", "samples with a truth, and the settling time before them", |c, _| {
        c.figures.truth.map_or(String::new(), |t| format!("{} after {}", count(t.samples), clock(t.settle_s)))
    }),
    ("Bound at the end", "Cramer-Rao bound of one corner as a standard deviation", |c, unit| {
        some(c.curves.bound_sd_kpa.last().copied(), |v| pressure(v, unit))
    }),
    (
        "Innovations",
        "mean normalised innovation squared; about 1 if the noise is as assumed, which says nothing of masses and tire stiffness",
        |c, _| some(Some(c.figures.mean_nis), |v| format!("{v:.2}")),
    ),
    ("Innovations in band", "share of the averaged innovations inside their 95 % band", |c, _| {
        some(c.curves.nis_check.map(|check| check.share_inside), percent)
    }),
    ("Road class", "ISO 8608 class and level Gd(0.1 cycle/m)", |c, _| {
        let fit = c.road.as_ref().and_then(|r| r.fit);
        fit.map_or(String::new(), |f| format!("{} ({})", f.class.label(), level(f.law.gd_n0_m3)))
    }),
    ("Road slope", "waviness w of the displacement spectrum", |c, _| {
        some(c.road.as_ref().and_then(|r| r.fit).map(|f| f.law.waviness), |v| format!("{v:.2}"))
    }),
    ("True road class", "the same of the true road", |c, _| {
        let fit = c.road.as_ref().and_then(|r| r.truth_fit);
        fit.map_or(String::new(), |f| {
            format!("{} ({}), slope {:.2}", f.class.label(), level(f.law.gd_n0_m3), f.law.waviness)
        })
    }),
    ("Roughness (IRI)", "of the estimated road, without the waves too long to be felt", |c, _| {
        some(c.road.as_ref().and_then(|r| r.iri_m_per_km), |v| format!("{v:.2} m/km"))
    }),
    ("True roughness (IRI)", "of the true road, all wavelengths", |c, _| {
        some(c.road.as_ref().and_then(|r| r.truth_iri_m_per_km), |v| format!("{v:.2} m/km"))
    }),
    ("Road error", "rms error over the rms of the true road, where the estimate holds", |c, _| {
        some(c.road.as_ref().and_then(|r| r.relative_error), percent)
    }),
];

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Thin spaces between thousands.
pub(super) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    out
}

/// One line per figure, one column per corner; lines without any value are left out. Of wheel speeds alone there are none.
pub(super) fn section(data: &ReportData) -> String {
    if data.corners.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<details class=\"fold\" id=\"figures\"><summary><h2>Figures</h2></summary>\
         <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Figures\"><table class=\"figures\"><thead><tr><td></td>",
    );
    for corner in &data.corners {
        let _ = write!(out, "<th scope=\"col\">{}</th>", corner_name(corner.corner));
    }
    out.push_str("</tr></thead><tbody>\n");
    for (name, meaning, value) in FIGURES {
        let values: Vec<String> =
            data.corners.iter().map(|corner| value(corner, data.pressure_unit)).collect();
        if values.iter().all(String::is_empty) {
            continue;
        }
        let _ = write!(out, "<tr><th scope=\"row\">{name}<small>{meaning}</small></th>");
        for value in values {
            let _ = write!(out, "<td>{}</td>", if value.is_empty() { "–" } else { &value });
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div></details>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_grouped() {
        assert_eq!(count(7), "7");
        assert_eq!(count(20_000), "20\u{2009}000");
        assert_eq!(count(1_234_567), "1\u{2009}234\u{2009}567");
    }
}
