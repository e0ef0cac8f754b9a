//! A stretch of road on an even grid: heights, their average over the tire's contact length, and the cubic that reads between the nodes.
//!
//! Called by [`Road`](super::Road); positions are in nodes, never in metres.

/// Nodes a chunk answers for: 20 m at the coarsest spacing.
pub(crate) const CHUNK_NODES: usize = 4096;

/// Nodes the cubic needs to the left of the first interval and to the right of the last.
const BEFORE: usize = 1;
const AFTER: usize = 2;

/// Heights of nodes `-1 ..= CHUNK_NODES + 1` counted from the chunk's start.
#[derive(Debug, Clone)]
pub(crate) struct Chunk {
    heights: Vec<f64>,
    /// Averaged over the contact length; empty for a point follower.
    contact: Vec<f64>,
}

impl Chunk {
    /// Room for chunk `index` and what its averages reach beyond it: the first node's number and zeros to fill.
    pub(crate) fn empty(index: i64, half_contact: f64) -> (i64, Vec<f64>) {
        let reach = reach(half_contact);
        let first = index * CHUNK_NODES as i64 - (BEFORE + reach) as i64;
        (first, vec![0.0; BEFORE + CHUNK_NODES + AFTER + 2 * reach])
    }

    /// From the filled room of [`Chunk::empty`].
    pub(crate) fn new(mut heights: Vec<f64>, half_contact: f64) -> Self {
        let reach = reach(half_contact);
        let contact = if reach == 0 { Vec::new() } else { moving_average(&heights, half_contact, reach) };
        heights.drain(..reach);
        heights.truncate(BEFORE + CHUNK_NODES + AFTER);
        Self { heights, contact }
    }

    /// Height at `position` nodes from the chunk's start, `0 <= position <= CHUNK_NODES`.
    #[inline]
    pub(crate) fn height(&self, position: f64) -> f64 {
        read(&self.heights, position)
    }

    /// The same, averaged over the contact length.
    #[inline]
    pub(crate) fn contact_height(&self, position: f64) -> f64 {
        read(if self.contact.is_empty() { &self.heights } else { &self.contact }, position)
    }
}

#[inline]
fn read(nodes: &[f64], position: f64) -> f64 {
    let i = (position as usize).min(CHUNK_NODES - 1);
    match nodes.get(i..i + 4) {
        Some(&[a, b, c, d]) => cubic([a, b, c, d], position - i as f64),
        // Unreachable for positions within the chunk; a NaN is visible where a panic would lose the drive.
        _ => f64::NAN,
    }
}

/// Nodes that the average reaches to either side.
fn reach(half_contact: f64) -> usize {
    half_contact.ceil() as usize
}

/// Average over `2 half_contact` nodes around every node but the outer `reach`, exact for the polygon through the nodes.
fn moving_average(heights: &[f64], half_contact: f64, reach: usize) -> Vec<f64> {
    // Integral of the polygon from the first node to each.
    let mut integral = Vec::with_capacity(heights.len());
    let mut sum = 0.0;
    for (i, &h) in heights.iter().enumerate() {
        if i > 0 {
            sum += 0.5 * (heights[i - 1] + h);
        }
        integral.push(sum);
    }
    // How far the end of the contact lies inside its interval, from the interval's outer node.
    let inside = reach as f64 - half_contact;
    let partial = |outer: f64, inner: f64| inside * (outer + 0.5 * inside * (inner - outer));
    (reach..heights.len() - reach)
        .map(|i| {
            let whole = integral[i + reach] - integral[i - reach];
            let left = partial(heights[i - reach], heights[i - reach + 1]);
            let right = partial(heights[i + reach], heights[i + reach - 1]);
            (whole - left - right) / (2.0 * half_contact)
        })
        .collect()
}

/// The cubic through four values at -1, 0, 1, 2, read at `f` in `0..=1` (Lagrange). Its error on a wave of
/// `theta` rad per node is at most `0.023 theta^4`.
#[inline]
pub(crate) fn cubic([a, b, c, d]: [f64; 4], f: f64) -> f64 {
    let third = 1.0 / 3.0;
    let c1 = c - third * a - 0.5 * b - d / 6.0;
    let c2 = 0.5 * (a + c) - b;
    let c3 = (d - a) / 6.0 + 0.5 * (b - c);
    ((c3 * f + c2) * f + c1) * f + b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cubic_reproduces_cubics_and_nearly_waves() {
        let p = |x: f64| 0.3 - 1.2 * x + 0.7 * x * x - 0.25 * x * x * x;
        for f in [0.0, 0.2, 0.5, 0.9, 1.0] {
            assert!((cubic([p(-1.0), p(0.0), p(1.0), p(2.0)], f) - p(f)).abs() < 1e-14);
            let theta = 0.3f64;
            let w = |x: f64| (theta * x + 0.4).sin();
            // 3/128 theta^4 bounds the error of four-point Lagrange interpolation in the middle interval.
            let error = (cubic([w(-1.0), w(0.0), w(1.0), w(2.0)], f) - w(f)).abs();
            assert!(error <= 3.0 / 128.0 * theta.powi(4) + 1e-15);
        }
    }

    #[test]
    fn the_average_of_a_wave_is_its_sinc() {
        // Contact of 20.6 nodes on a wave of 200 nodes: the average multiplies by sin(u)/u, u = theta L / 2. The
        // polygon differs from the wave by theta^2/12 = 8e-5 at most.
        let (half, theta) = (10.3, std::f64::consts::TAU / 200.0);
        let (first, mut heights) = Chunk::empty(3, half);
        for (i, h) in heights.iter_mut().enumerate() {
            *h = (theta * (first + i as i64) as f64).sin();
        }
        let chunk = Chunk::new(heights, half);
        let sinc = (theta * half).sin() / (theta * half);
        for position in [0.0, 17.25, 1000.5, 4095.75, 4096.0] {
            let wave = (theta * (3.0 * 4096.0 + position)).sin();
            assert!((chunk.height(position) - wave).abs() < 1e-6);
            assert!((chunk.contact_height(position) - sinc * wave).abs() < 1.1e-4, "{position}");
        }
    }

    #[test]
    fn a_point_follower_feels_the_road_itself() {
        let (_, mut heights) = Chunk::empty(0, 0.0);
        heights.iter_mut().enumerate().for_each(|(i, h)| *h = i as f64);
        let chunk = Chunk::new(heights, 0.0);
        assert_eq!(chunk.height(10.25), chunk.contact_height(10.25));
        assert!((chunk.height(10.25) - 11.25).abs() < 1e-12);
    }
}
