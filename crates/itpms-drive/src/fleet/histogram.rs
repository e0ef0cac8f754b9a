//! How often values lie where, as a panel of a figure.

use itpms_analysis::plot::{Axis, Ink, Panel};

/// Bars over a quantity and its unit; `what` is counted.
pub(super) fn histogram(
    title: &str,
    (label, unit): (&str, &str),
    values: &[f64],
    ink: Ink,
    what: &str,
) -> Panel {
    let bars = bins(values);
    let room = bars.first().zip(bars.last()).map_or((0.0, 1.0), |(first, last)| (first.0, last.1));
    let x = Axis::linear(label, unit).within(room.0, room.1);
    Panel::new("", title, x, Axis::linear("Number", what).holding(0.0)).height(230.0).bars("", ink, bars)
}

/// Bars of a round width, some twenty of them at most.
fn bins(values: &[f64]) -> Vec<(f64, f64, f64)> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !(high >= low) {
        return Vec::new();
    }
    let least = ((high - low) / 20.0).max(1e-3 * high.abs()).max(1e-9);
    let decade = 10f64.powf(least.log10().floor());
    let width = [1.0, 2.0, 5.0, 10.0].map(|m| m * decade).into_iter().find(|w| *w >= least).unwrap_or(least);
    let first = (low / width).floor();
    let count = (high / width).floor() - first + 1.0;
    let mut bars: Vec<(f64, f64, f64)> = (0..count as usize)
        .map(|i| ((first + i as f64) * width, (first + i as f64 + 1.0) * width, 0.0))
        .collect();
    for value in values {
        let i = ((value / width).floor() - first) as usize;
        if let Some(bar) = bars.get_mut(i) {
            bar.2 += 1.0;
        }
    }
    bars
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_in_one_bar() {
        let values: Vec<f64> = (0..1000).map(|i| 57.0 + 0.0517 * f64::from(i)).collect();
        let bars = bins(&values);
        assert!((5..=22).contains(&bars.len()), "{}", bars.len());
        assert_eq!(bars.iter().map(|bar| bar.2).sum::<f64>(), 1000.0);
        assert!(bars[0].0 <= 57.0 && bars[0].1 > 57.0 && bars.windows(2).all(|pair| pair[0].1 == pair[1].0));
        // All alike, and none.
        assert_eq!(bins(&[100.0; 8]).iter().map(|bar| bar.2).sum::<f64>(), 8.0);
        assert_eq!(bins(&[0.0, 0.0]).iter().map(|bar| bar.2).sum::<f64>(), 2.0);
        assert!(bins(&[]).is_empty());
    }
}
