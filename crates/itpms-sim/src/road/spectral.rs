//! An endless Gaussian road of a given spectrum, made in blocks.
//!
//! Called by the surfaces. A block is a Fourier series with random coefficients, far longer than the records that
//! fit into it; where a drive outlasts a block, the next, independent one is faded in with weights whose squares
//! sum to one, so that the road stays Gaussian and its spectrum the same (docs/math/simulation.md, "The road's spectrum").

use std::cell::RefCell;
use std::collections::VecDeque;
use std::sync::Arc;

use itpms_fourier::{Complex, ComplexToReal};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::iso8608::{Amplitude, Iso8608};
use super::lateral::{Line, Source};
use crate::streams::generator;

thread_local! {
    /// Fades by their length: blocks come in a handful of sizes.
    static FADES: RefCell<Vec<Arc<Vec<f64>>>> = const { RefCell::new(Vec::new()) };

    /// The series made last: lines of one road differ in their sources only.
    static SERIES: RefCell<VecDeque<Kept>> = const { RefCell::new(VecDeque::new()) };
}

struct Kept {
    iso: Iso8608,
    nodes: usize,
    spacing_m: f64,
    series: Arc<Series>,
}

/// Series kept: what two tracks need at a join of two stretches.
const SERIES_KEPT: usize = 4;

/// Weights of a block's first nodes, [`fade_in`] over `length` of them.
fn fade(length: usize) -> Arc<Vec<f64>> {
    FADES.with_borrow_mut(|fades| match fades.iter().find(|fade| fade.len() == length) {
        Some(fade) => Arc::clone(fade),
        None => {
            let weight = |place: usize| fade_in((place as f64 + 0.5) / length as f64);
            let fade = Arc::new((0..length).map(weight).collect::<Vec<f64>>());
            fades.push(Arc::clone(&fade));
            fade
        }
    })
}

/// One period of a Fourier series with the spectrum of `iso`: `nodes` heights (an even number), `spacing_m` apart. Bins are
/// drawn from the longest wave on, so that more nodes on the same length add shorter waves to the same road.
pub(crate) struct Series {
    /// Standard deviation of the real and of the imaginary part of each coefficient, from the first harmonic on.
    deviations: Vec<f64>,
    amplitude: Amplitude,
    /// Factor of each coefficient, from the first harmonic on; empty for a road left as it is.
    response: Vec<Complex<f64>>,
    bin_cycles_per_m: f64,
    transform: Arc<dyn ComplexToReal<f64>>,
}

impl Series {
    pub(crate) fn new(iso: &Iso8608, nodes: usize, spacing_m: f64) -> Self {
        let bin_cycles_per_m = 1.0 / (nodes as f64 * spacing_m);
        // A harmonic x = 2 Re(c e^{i..}) has variance 2 E|c|² = Gd(n) Δn, so each part of c has variance Gd Δn / 4.
        let first = 0.5 * (iso.psd_m3(bin_cycles_per_m) * bin_cycles_per_m).sqrt();
        let deviations = (1..nodes / 2).map(|k| first * (k as f64).powf(-0.5 * iso.slope)).collect();
        let transform = itpms_fourier::inverse(nodes);
        Self { deviations, amplitude: iso.amplitude, response: Vec::new(), bin_cycles_per_m, transform }
    }

    /// The same, shared with whoever asked for it before.
    fn shared(iso: &Iso8608, nodes: usize, spacing_m: f64) -> Arc<Self> {
        SERIES.with_borrow_mut(|all| {
            let same = |kept: &&Kept| kept.iso == *iso && kept.nodes == nodes && kept.spacing_m == spacing_m;
            if let Some(kept) = all.iter().find(same) {
                return Arc::clone(&kept.series);
            }
            let series = Arc::new(Self::new(iso, nodes, spacing_m));
            all.push_back(Kept { iso: iso.clone(), nodes, spacing_m, series: Arc::clone(&series) });
            if all.len() > SERIES_KEPT {
                all.pop_front();
            }
            series
        })
    }

    /// The same, passed through a linear system given by its response to a wave of so many cycles per metre.
    pub(crate) fn followed_by(self, response: impl Fn(f64) -> Complex<f64>) -> Self {
        let harmonics = 1..=self.deviations.len();
        Self { response: harmonics.map(|k| response(k as f64 * self.bin_cycles_per_m)).collect(), ..self }
    }

    /// The independent roads that a line of this spectrum is made of.
    pub(crate) fn sources(&self, iso: &Iso8608, line: &Line, number: u64) -> Vec<Source> {
        line.sources(iso, number, self.bin_cycles_per_m, self.deviations.len())
    }

    pub(crate) fn nodes(&self) -> usize {
        self.transform.len()
    }

    /// Heights in m of one period, the sum of its sources.
    pub(crate) fn draw(&self, seed: u64, sources: &[Source], block: u64) -> Vec<f64> {
        let mut coefficients = self.transform.make_input_vec();
        for source in sources {
            self.add_source(seed, source, block, &mut coefficients);
        }
        for (c, factor) in coefficients.iter_mut().skip(1).zip(&self.response) {
            *c *= factor;
        }
        let mut heights = self.transform.make_output_vec();
        // Fails only for buffers of a wrong length, and these are the transform's own.
        if self.transform.process(&mut coefficients, &mut heights).is_err() {
            heights.fill(f64::NAN);
        }
        heights
    }

    fn add_source(&self, seed: u64, source: &Source, block: u64, coefficients: &mut [Complex<f64>]) {
        let mut random = generator(seed, source.purpose, [source.stream, block]);
        let mut weights = source.weights.iter();
        // The mean and the shortest wave of an even grid stay zero.
        for (c, &deviation) in coefficients.iter_mut().skip(1).zip(&self.deviations) {
            let deviation = deviation * weights.next().unwrap_or(&1.0);
            *c += match self.amplitude {
                Amplitude::Gaussian => {
                    let (re, im): (f64, f64) =
                        (StandardNormal.sample(&mut random), StandardNormal.sample(&mut random));
                    Complex::new(deviation * re, deviation * im)
                }
                Amplitude::Fixed => Complex::from_polar(
                    deviation * std::f64::consts::SQRT_2,
                    std::f64::consts::TAU * random.random::<f64>(),
                ),
            };
        }
    }
}

/// An endless road made of faded blocks.
#[derive(Clone)]
pub(crate) struct SpectralRoad {
    series: Arc<Series>,
    seed: u64,
    sources: Arc<Vec<Source>>,
    /// Weights of the nodes over which one block gives way to the next.
    fade: Arc<Vec<f64>>,
    hop: usize,
    /// Node on which block 0 starts, so that a drive begins where only one block counts.
    start: i64,
    /// The last blocks used, newest at the back.
    blocks: VecDeque<(i64, Arc<Vec<f64>>)>,
}

impl std::fmt::Debug for SpectralRoad {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SpectralRoad").field("seed", &self.seed).finish_non_exhaustive()
    }
}

impl SpectralRoad {
    /// `line` and `number` tell roads of one seed apart; `nodes` is the length of a block, a multiple of 16.
    pub(crate) fn new(
        iso: &Iso8608,
        nodes: usize,
        spacing_m: f64,
        seed: u64,
        line: &Line,
        number: u64,
    ) -> Self {
        let fade = fade(nodes / 4);
        let series = Series::shared(iso, nodes, spacing_m);
        Self {
            sources: Arc::new(series.sources(iso, line, number)),
            series,
            seed,
            hop: nodes - fade.len(),
            start: -((fade.len() + nodes / 16) as i64),
            fade,
            blocks: VecDeque::new(),
        }
    }

    /// Adds the heights of the nodes from `first` on.
    pub(crate) fn add(&mut self, first: i64, heights: &mut [f64]) {
        let (hop, length) = (self.hop as i64, self.series.nodes() as i64);
        let end = first + heights.len() as i64;
        let first_block = (first - self.start - length + 1).div_euclid(hop)
            + i64::from((first - self.start - length + 1).rem_euclid(hop) != 0);
        let last_block = (end - 1 - self.start).div_euclid(hop);
        for index in first_block..=last_block {
            let block_start = self.start + index * hop;
            let block = self.block(index);
            let (from, to) = (first.max(block_start), end.min(block_start + length));
            for node in from..to {
                let place = (node - block_start) as usize;
                heights[(node - first) as usize] += self.weight(place) * block[place];
            }
        }
    }

    fn block(&mut self, index: i64) -> Arc<Vec<f64>> {
        if let Some((_, block)) = self.blocks.iter().find(|(i, _)| *i == index) {
            return Arc::clone(block);
        }
        // Two's complement keeps the blocks before the start apart from those after it.
        let block = Arc::new(self.series.draw(self.seed, &self.sources, index as u64));
        self.blocks.push_back((index, Arc::clone(&block)));
        if self.blocks.len() > 2 {
            self.blocks.pop_front();
        }
        block
    }

    /// Weight of a block's node: 1, or a fade whose square and its successor's sum to 1.
    fn weight(&self, place: usize) -> f64 {
        let from_end = self.series.nodes() - 1 - place;
        self.fade.get(place.min(from_end)).copied().unwrap_or(1.0)
    }
}

/// `sin(π/2 s)` with `s = t - sin(2πt)/2π`, smooth at both ends so that a long wave does not leak into short ones.
fn fade_in(t: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, TAU};
    (FRAC_PI_2 * (t - (TAU * t).sin() / TAU)).sin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{RoadClass, Side};

    fn draw(series: &Series, iso: &Iso8608, seed: u64) -> Vec<f64> {
        series.draw(seed, &series.sources(iso, &Line::alone(Side::Left), 0), 0)
    }

    #[test]
    fn fades_keep_the_variance() {
        let road =
            SpectralRoad::new(&Iso8608::new(RoadClass::A, 2.0), 1024, 0.005, 1, &Line::alone(Side::Left), 0);
        for place in 0..road.fade.len() {
            let (rise, fall) = (road.weight(place), road.weight(place + road.hop));
            assert!((rise * rise + fall * fall - 1.0).abs() < 1e-12);
        }
        assert_eq!(road.weight(road.fade.len()), 1.0);
        // A drive starts where one block counts alone, and so does what lies a little behind it.
        let at = |node: i64| (node - road.start) as usize;
        assert!((at(-64)..at(400)).all(|place| road.weight(place) == 1.0));
    }

    #[test]
    fn powers_of_a_gaussian_road_are_exponential_and_of_a_fixed_one_constant() {
        // E P² / (E P)² is 2 for an exponential variable; over 8191 bins its estimate has an sd of
        // sqrt((E P^4 - (E P²)²) / N) ≈ sqrt(20 / 8191) ≈ 0.05 plus the mean's: 0.2 is three of them.
        for (amplitude, expected, tolerance) in
            [(Amplitude::Gaussian, 2.0, 0.2), (Amplitude::Fixed, 1.0, 1e-9)]
        {
            let iso = Iso8608 { amplitude, ..Iso8608::new(RoadClass::A, 2.14) };
            let (nodes, spacing) = (16384, 0.005);
            let mut heights = draw(&Series::new(&iso, nodes, spacing), &iso, 7);
            let forward = itpms_fourier::forward(nodes);
            let mut bins = forward.make_output_vec();
            forward.process(&mut heights, &mut bins).unwrap();
            let dn = 1.0 / (nodes as f64 * spacing);
            // Periodogram 2 |X|² dx / N over the spectrum: mean 1.
            let powers: Vec<f64> = (1..nodes / 2)
                .map(|k| 2.0 * bins[k].norm_sqr() * spacing / nodes as f64 / iso.psd_m3(k as f64 * dn))
                .collect();
            let mean = powers.iter().sum::<f64>() / powers.len() as f64;
            let square = powers.iter().map(|p| p * p).sum::<f64>() / powers.len() as f64;
            // sd of the mean: 1/sqrt(8191) = 0.011.
            assert!((mean - 1.0).abs() < 0.04, "{amplitude:?} {mean}");
            assert!((square / (mean * mean) - expected).abs() < tolerance, "{amplitude:?} {square}");
        }
    }

    #[test]
    fn a_finer_grid_adds_shorter_waves_to_the_same_road() {
        let iso = Iso8608::new(RoadClass::A, 2.0);
        let coarse = draw(&Series::new(&iso, 4096, 0.005), &iso, 3);
        let fine = draw(&Series::new(&iso, 8192, 0.0025), &iso, 3);
        let mean_square =
            coarse.iter().zip(fine.iter().step_by(2)).map(|(c, f)| (c - f) * (c - f)).sum::<f64>() / 4096.0;
        // The waves from 100 to 200 cycles/m: integral of 16e-8 / n² = 16e-8 (1/100 - 1/200), sampled: sd 3 %.
        let expected = 16e-8 * (1.0 / 100.0 - 1.0 / 200.0);
        assert!((mean_square / expected - 1.0).abs() < 0.15, "{}", mean_square / expected);
    }
}
