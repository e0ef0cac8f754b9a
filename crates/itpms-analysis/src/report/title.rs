//! The page's title, from every wheel's curves.

use super::words::{Status, corner_name, lower, reading, sentence};
use super::{CornerReport, ReportData, wheels};

/// The result in one line, the page's title: the most urgent corner, and how many more there are. Numbers and their units are held together
/// by no-break spaces.
pub fn title(data: &ReportData) -> String {
    let mut corners: Vec<&CornerReport> = data.corners.iter().collect();
    corners.sort_by_key(|corner| Status::of(corner));
    let Some(first) = corners.first() else {
        let wheels = data.wheel_speeds.as_ref().map(|wheels| wheels::title(data, wheels));
        return wheels.unwrap_or_else(|| "No corner was estimated".into());
    };
    let status = Status::of(first);
    let sentence = |corner: &CornerReport| sentence(corner, data.pressure_unit);
    let alike: Vec<&str> =
        corners.iter().filter(|c| Status::of(c) == status).map(|c| corner_name(c.corner)).collect();
    match (status, alike.len()) {
        // A wheel of which nothing is known may be the one that is low.
        (Status::Fine, n) if n == corners.len() && !data.not_estimated.is_empty() => {
            let fine = if n == 1 { sentence(first) } else { format!("{n} tires are fine") };
            let others: Vec<&str> = data.not_estimated.iter().map(|corner| corner_name(*corner)).collect();
            let is = if others.len() == 1 { "is" } else { "are" };
            format!("{fine}; {} {is} not estimated", lower(&others.join(", ")))
        }
        (_, 1) => sentence(first),
        (Status::Fine, n) if n == corners.len() => {
            let lowest = corners
                .iter()
                .filter_map(|c| Some((corner_name(c.corner), c.figures.last?)))
                .min_by(|a, b| a.1.pressure_kpa.total_cmp(&b.1.pressure_kpa));
            match lowest {
                Some((name, last)) => {
                    format!(
                        "All {n} tires are fine; lowest is {} at {}",
                        lower(name),
                        reading(&last, data.pressure_unit)
                    )
                }
                None => format!("All {n} tires are fine"),
            }
        }
        (Status::Low, n) if n == corners.len() => format!("All {n} tires are low: {}", sentence(first)),
        (Status::Low, _) => format!("{} (low as well: {})", sentence(first), lower(&alike[1..].join(", "))),
        (_, n) => format!("{}; {} more likewise", sentence(first), n - 1),
    }
}
