//! As many points of a curve as can be seen: per column of the picture the first, the lowest, the highest and the last.

/// Points in the picture, in order of the curve; of more than four in a column of `width`, those four. A point with a
/// NaN is a gap and stays.
pub(super) fn thin(points: &[(f64, f64)], width: f64) -> Vec<(f64, f64)> {
    let mut kept = Vec::with_capacity(points.len().min(4096));
    let mut start = 0;
    while start < points.len() {
        let column = (points[start].0 / width).floor();
        let same = |point: &(f64, f64)| (point.0 / width).floor() == column && point.1.is_finite();
        let length = points[start..].iter().take_while(|point| same(point)).count().max(1);
        keep(&points[start..start + length], &mut kept);
        start += length;
    }
    kept
}

fn keep(group: &[(f64, f64)], kept: &mut Vec<(f64, f64)>) {
    if group.len() <= 4 {
        kept.extend_from_slice(group);
        return;
    }
    let by_height = |a: &usize, b: &usize| group[*a].1.total_cmp(&group[*b].1);
    let lowest = (0..group.len()).min_by(by_height).unwrap_or(0);
    let highest = (0..group.len()).max_by(by_height).unwrap_or(0);
    let mut chosen = [0, lowest, highest, group.len() - 1];
    chosen.sort_unstable();
    for (i, &index) in chosen.iter().enumerate() {
        if i == 0 || index != chosen[i - 1] {
            kept.push(group[index]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_and_gaps_stay() {
        let mut points: Vec<(f64, f64)> =
            (0..10_000).map(|i| (f64::from(i) * 0.01, (f64::from(i) * 0.7).sin())).collect();
        points[5_000].1 = 7.0;
        points[6_000].1 = f64::NAN;
        let thinned = thin(&points, 1.0);
        assert!(thinned.len() <= 4 * 100 + 4, "{}", thinned.len());
        assert!(thinned.iter().any(|p| p.1 == 7.0) && thinned.iter().any(|p| p.1.is_nan()));
        assert!(thinned.is_sorted_by(|a, b| a.0 <= b.0));
        assert_eq!((thinned.first(), thinned.last()), (points.first(), points.last()));
    }

    #[test]
    fn few_points_stay_as_they_are() {
        let points = [(0.0, 1.0), (5.0, 2.0), (2.0, 3.0)];
        assert_eq!(thin(&points, 1.0), points);
    }
}
