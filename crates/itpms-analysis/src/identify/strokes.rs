//! Where a displacement turns: strokes up and down, distinguished from noise by a threshold. Called by the identifications.

/// One way of the displacement between two turning points, or up to an end of the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stroke {
    pub(super) start: usize,
    /// Row after the last.
    pub(super) end: usize,
    pub(super) rising: bool,
}

/// The strokes of a displacement: it has turned when it has come back by `threshold`. Each turning row belongs to the
/// stroke that leads to it. Rests before the first movement belong to the first stroke.
pub(super) fn strokes(x: &[f64], threshold: f64) -> Vec<Stroke> {
    let mut turns: Vec<(usize, bool)> = Vec::new();
    let (mut low, mut high) = (0, 0);
    let mut rising = None;
    for i in 0..x.len() {
        match rising {
            None => {
                if x[i] < x[low] {
                    low = i;
                }
                if x[i] > x[high] {
                    high = i;
                }
                if x[i] - x[low] > threshold {
                    rising = Some(true);
                    high = i;
                } else if x[high] - x[i] > threshold {
                    rising = Some(false);
                    low = i;
                }
            }
            Some(true) if x[i] >= x[high] => high = i,
            Some(true) if x[high] - x[i] > threshold => {
                turns.push((high, true));
                rising = Some(false);
                low = i;
            }
            Some(false) if x[i] <= x[low] => low = i,
            Some(false) if x[i] - x[low] > threshold => {
                turns.push((low, false));
                rising = Some(true);
                high = i;
            }
            Some(_) => {}
        }
    }
    let Some(last) = rising else { return Vec::new() };
    turns.push((x.len() - 1, last));
    let mut start = 0;
    turns
        .into_iter()
        .map(|(turn, rising)| {
            let stroke = Stroke { start, end: turn + 1, rising };
            start = turn + 1;
            stroke
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_does_not_turn_a_stroke() {
        // Up to 10, down to 0, up to 4, with a ripple of 0.4.
        let x: Vec<f64> = (0..=240)
            .map(|i| {
                let t = f64::from(i) / 10.0;
                let ramp = if t <= 10.0 {
                    t
                } else if t <= 20.0 {
                    20.0 - t
                } else {
                    t - 20.0
                };
                ramp + if i % 2 == 0 { 0.2 } else { -0.2 }
            })
            .collect();
        let found = strokes(&x, 1.0);
        let shape: Vec<bool> = found.iter().map(|s| s.rising).collect();
        assert_eq!(shape, [true, false, true]);
        assert!(found[0].end.abs_diff(101) <= 4 && found[1].end.abs_diff(201) <= 4, "{found:?}");
        assert_eq!((found[0].start, found[2].end), (0, 241));
        assert!(strokes(&[1.0; 9], 0.1).is_empty());
    }
}
