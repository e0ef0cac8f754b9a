//! How late estimates are: median, 99th percentile and worst of the last ten seconds.
//!
//! Fed by the estimating thread at every row. Memory and time per row do not depend on the rate: times are counted in
//! classes an eighth of an octave wide, so a percentile is right to within 9 % (and never stated too low); the worst is exact.

use std::time::{Duration, Instant};

use crate::snapshot::Latency;

/// Seconds that are looked back on, in parts of one second.
const PARTS: usize = 10;
const PER_OCTAVE: f64 = 8.0;
/// Upper end of the first class, in ms.
const FIRST_MS: f64 = 1e-3;
/// Up to 1 µs times 2^32, over an hour.
const CLASSES: usize = 8 * 32;

/// The delays of the last seconds.
#[derive(Debug)]
pub struct LatencyWindow {
    parts: Vec<Part>,
    current: usize,
    begun: Option<Instant>,
}

#[derive(Debug, Clone)]
struct Part {
    counts: [u32; CLASSES],
    worst_ms: f64,
}

impl Part {
    const EMPTY: Self = Self { counts: [0; CLASSES], worst_ms: 0.0 };
}

impl Default for LatencyWindow {
    fn default() -> Self {
        Self { parts: vec![Part::EMPTY; PARTS], current: 0, begun: None }
    }
}

impl LatencyWindow {
    /// Takes the delay of a row that was done `now`.
    pub fn add(&mut self, delay: Duration, now: Instant) {
        self.turn(now);
        let ms = delay.as_secs_f64() * 1000.0;
        let class = ((ms / FIRST_MS).log2() * PER_OCTAVE).ceil().clamp(0.0, (CLASSES - 1) as f64) as usize;
        let part = &mut self.parts[self.current];
        part.counts[class] = part.counts[class].saturating_add(1);
        part.worst_ms = part.worst_ms.max(ms);
    }

    /// Begins a new part for every second that is over.
    fn turn(&mut self, now: Instant) {
        let begun = *self.begun.get_or_insert(now);
        let over = now.saturating_duration_since(begun).as_secs();
        for _ in 0..over.min(PARTS as u64) {
            self.current = (self.current + 1) % PARTS;
            self.parts[self.current] = Part::EMPTY;
        }
        self.begun = Some(begun + Duration::from_secs(over));
    }

    /// The delays up to `now`; NaN without any.
    pub fn summary(&mut self, now: Instant) -> Latency {
        self.turn(now);
        let mut counts = [0u64; CLASSES];
        for part in &self.parts {
            counts.iter_mut().zip(&part.counts).for_each(|(sum, count)| *sum += u64::from(*count));
        }
        let all: u64 = counts.iter().sum();
        if all == 0 {
            return Latency { p50: f64::NAN, p99: f64::NAN, max: f64::NAN };
        }
        let max = self.parts.iter().fold(0.0, |worst: f64, part| worst.max(part.worst_ms));
        let below = |share: f64| {
            let wanted = (share * all as f64).ceil() as u64;
            let mut seen = 0;
            let class = counts.iter().position(|count| {
                seen += count;
                seen >= wanted
            });
            (FIRST_MS * (class.unwrap_or(CLASSES - 1) as f64 / PER_OCTAVE).exp2()).min(max)
        };
        Latency { p50: below(0.5), p99: below(0.99), max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_right_within_a_class_and_old_ones_are_forgotten() {
        let (mut window, start) = (LatencyWindow::default(), Instant::now());
        assert!(window.summary(start).p50.is_nan());
        for i in 1..=1000u32 {
            window.add(Duration::from_micros(u64::from(i) * 10), start + Duration::from_millis(u64::from(i)));
        }
        let now = start + Duration::from_secs(2);
        let found = window.summary(now);
        let class = 2f64.powf(1.0 / PER_OCTAVE);
        assert!(
            (5.0..5.0 * class).contains(&found.p50) && (9.9..9.9 * class).contains(&found.p99),
            "{found:?}"
        );
        assert_eq!(found.max, 10.0);
        assert!(window.summary(start + Duration::from_secs(12)).max.is_nan());
    }
}
