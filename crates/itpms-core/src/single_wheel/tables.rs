//! Expected frames for every stiffness of the grid: tables of the transfer function and of the
//! sensor noise per bin and cell (docs/math/informed.md, eq. 8-12), averaged over the window's own spectrum.
//!
//! Kept for every third cell: in between they go by the cubic in the compliance, of which noise is a parabola. Built two bins of a cell at a time, so that following slow changes
//! of the car costs the same every frame: all of them within 10 s.

use nalgebra::{ComplexField, SMatrix, SVector};

use crate::memory::Blank;
use crate::model::PressureMap;
use crate::real::Real;
use crate::single_wheel::BINS;
use crate::spectrum::reconstruction::LEAK_RAD_S;
use crate::spectrum::transfer::{Body, DescribingFunction, response, sine_window_power};

pub(crate) const CELLS: usize = 36;
/// Cells from one that has tables to the next, and how many have; the last one lies beyond the grid.
const NODES_APART: usize = 3;
const NODES: usize = CELLS / NODES_APART + 1;
const _: () = assert!(CELLS.is_multiple_of(NODES_APART) && NODES >= NEAREST);
/// The node that the others' gains are relative to.
const MIDDLE: usize = NODES / 2;
/// Points through which a cubic goes.
pub(crate) const NEAREST: usize = 4;
/// Lowest cell and step as shares of the placard pressure: 33 kPa and 8 kPa at 241.3 kPa, one cell on the placard.
const LOWEST: f64 = 1.0 - 26.0 * STEP;
pub(crate) const STEP: f64 = 8.0 / 241.3;
/// Corner of the sensors' anti-alias filter as a share of the sampling rate.
const ANTI_ALIAS: f64 = 0.3;
/// Points per bin, and on each side, at which the window's spectrum is averaged.
const KERNEL_DENSITY: i32 = 8;
const KERNEL_HALF: i32 = 20;
const AT_ONCE: usize = 2;
/// Points of one bin's window, and of those that are filled at once.
const WINDOW: usize = 2 * KERNEL_HALF as usize + 1;
const POINTS: usize = WINDOW + (AT_ONCE - 1) * KERNEL_DENSITY as usize;
const LOWEST_HZ: f64 = 0.1;
/// Exponents on each side of zero through which the power law's parabola is drawn.
const SHAPE_REACH: f64 = 0.6;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Grid<T> {
    lowest_kpa: T,
    step_kpa: T,
}

impl<T: Real> Grid<T> {
    pub(crate) fn new(placard_kpa: T) -> Self {
        Self { lowest_kpa: placard_kpa * T::lit(LOWEST), step_kpa: placard_kpa * T::lit(STEP) }
    }

    pub(crate) fn step_kpa(&self) -> T {
        self.step_kpa
    }

    pub(crate) fn pressure_kpa(&self, cell: usize) -> T {
        self.lowest_kpa + self.step_kpa * T::lit(cell as f64)
    }
}

/// The weights with which values at four places make one in between: Lagrange's cubic through them.
pub(crate) fn cubic_weights<T: Real>(places: [T; NEAREST], at: T) -> [T; NEAREST] {
    core::array::from_fn(|i| {
        let (mut over, mut under) = (T::one(), T::one());
        for (j, &place) in places.iter().enumerate() {
            if j != i {
                (over, under) = (over * (at - place), under * (places[i] - place));
            }
        }
        over / under
    })
}

/// Expected frames of one cell, per bin.
pub(crate) struct CellTables<T> {
    /// `ln |H|²`, `H` from road to wheel, less the middle cell's, averaged with the power that the road and the window
    /// give each frequency: for a displacement slope of two, and its change with the exponent `2 - w`.
    log_gain: [T; BINS],
    log_gain_by_exponent: [T; BINS],
    /// Noise power of the reconstructed velocity for unit accelerometer noise density.
    pub(crate) noise: [T; BINS],
    /// The same, moved with the gain from the middle cell: for the log-determinant alone, so that pure noise says
    /// nothing about the stiffness.
    pub(crate) determinant_noise: [T; BINS],
}

impl<T: Real> CellTables<T> {
    /// `ln |H|²` in a bin relative to the middle cell's, as a road of `exponent = 2 - w` weighs it.
    pub(crate) fn log_gain(&self, bin: usize, exponent: T) -> T {
        let bin = bin.min(BINS - 1);
        self.log_gain[bin] + exponent * self.log_gain_by_exponent[bin]
    }
}

/// Tables over (node, bin), see [`CellTables`], over cells, and over bins alone.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Tables<T: Real> {
    log_gain: SMatrix<T, BINS, NODES>,
    log_gain_by_exponent: SMatrix<T, BINS, NODES>,
    noise: SMatrix<T, BINS, NODES>,
    determinant_noise: SMatrix<T, BINS, NODES>,
    /// `1/k_t` per node in m/N, and per cell.
    node_theta: SVector<T, NODES>,
    pub(crate) theta: SVector<T, CELLS>,
    /// `ln (f / 10 Hz)` per bin.
    pub(crate) log_frequency: SVector<T, BINS>,
    /// What leak, anti-alias filter and window make of a power law of exponent `x` in a bin, as a parabola in `x`:
    /// `ln ⟨|L|² |A|² (f'/f)^x⟩`.
    window: SMatrix<T, 3, BINS>,
    /// Squared frequency in Hz² per bin.
    pub(crate) frequency_squared: SVector<T, BINS>,
    /// How much power the window lets through at each point around a bin.
    window_power: SVector<T, WINDOW>,
    bin_spacing_hz: T,
    /// Where they are next brought up to date.
    next_node: usize,
    next_bin: usize,
}

impl<T: Real> Tables<T> {
    pub(crate) fn configure(
        &mut self,
        bin_spacing_hz: f64,
        sample_rate_hz: f64,
        grid: &Grid<T>,
        tire: &PressureMap<T>,
        body: &Body<T>,
    ) {
        let frequency = |bin: usize| bin_spacing_hz * (bin as f64 + 1.0);
        let per_bin = |f: &dyn Fn(f64) -> T| SVector::from_fn(|bin, _| f(frequency(bin)));
        let theta = |cell: usize| T::one() / tire.stiffness_n_per_m(grid.pressure_kpa(cell));
        self.theta = SVector::from_fn(|cell, _| theta(cell));
        self.node_theta = SVector::from_fn(|node, _| theta(NODES_APART * node));
        self.log_frequency = per_bin(&|f| T::lit(f / 10.0).ln());
        self.window = window_parabolas(bin_spacing_hz, sample_rate_hz);
        self.frequency_squared = per_bin(&|f| T::lit(f * f));
        self.window_power = window_powers::<T>();
        self.bin_spacing_hz = T::lit(bin_spacing_hz);
        (self.next_node, self.next_bin) = (0, 0);
        for node in 0..NODES {
            for bin in (0..BINS).step_by(AT_ONCE) {
                self.fill(node, bin, body, &DescribingFunction::BLANK);
            }
        }
    }

    /// Brings two more bins of a node up to date with the body and the friction of its strut.
    pub(crate) fn refresh_next(&mut self, body: &Body<T>, friction: &DescribingFunction<T>) {
        self.fill(self.next_node, self.next_bin, body, friction);
        self.next_bin += AT_ONCE;
        if self.next_bin >= BINS {
            self.next_bin = 0;
            self.next_node = (self.next_node + 1) % NODES;
        }
    }

    /// Log of a bin's response to a power law of this exponent: leak, anti-alias filter and window.
    pub(crate) fn log_window(&self, bin: usize, exponent: T) -> T {
        let c = self.window.column(bin);
        c[0] + exponent * (c[1] + exponent * c[2])
    }

    /// The tables of a cell: those of a node as they are, of the others by the cubic in the compliance through four nodes around.
    pub(crate) fn of_cell(&self, cell: usize) -> CellTables<T> {
        let from = (cell / NODES_APART).saturating_sub(1).min(NODES - NEAREST);
        let nodes: [usize; NEAREST] = core::array::from_fn(|i| from + i);
        let theta_of = |node: usize| self.node_theta.get(node).copied().unwrap_or(T::ZERO);
        let theta = self.theta.get(cell).copied().unwrap_or(T::ZERO);
        let weights = cubic_weights(nodes.map(theta_of), theta);
        let read = |table: &SMatrix<T, BINS, NODES>| {
            let mut read = [T::zero(); BINS];
            for (node, &weight) in nodes.iter().zip(&weights) {
                let column = table.data.0.get(*node).into_iter().flatten();
                read.iter_mut().zip(column).for_each(|(read, &value)| *read += weight * value);
            }
            read
        };
        CellTables {
            log_gain: read(&self.log_gain),
            log_gain_by_exponent: read(&self.log_gain_by_exponent),
            noise: read(&self.noise),
            determinant_noise: read(&self.determinant_noise),
        }
    }

    /// Bins from `first` on, whose windows share most of their frequencies, of a node.
    fn fill(&mut self, node: usize, first: usize, body: &Body<T>, friction: &DescribingFunction<T>) {
        let node = node.min(NODES - 1);
        let (theta, middle) = (self.node_theta[node], self.node_theta[MIDDLE]);
        // Of negative frequencies there are none.
        let lowest = window_points(first).min().unwrap_or(0);
        let points: [Point<T>; POINTS] = core::array::from_fn(|i| {
            Point::new(point_hz(self.bin_spacing_hz, lowest + i), body, friction, theta, middle)
        });
        for bin in (first..BINS).take(AT_ONCE) {
            let mut noise = (T::zero(), T::zero());
            // Sums of ln|H|² and of the weights for an exponent below and above zero.
            let mut gain = [(T::zero(), T::zero()); 2];
            let mut middle_noise = T::zero();
            for (i, &weight) in window_points(bin).zip(&self.window_power) {
                let Some(point) = points.get(i - lowest.min(i)) else { continue };
                noise = (noise.0 + weight * point.noise, noise.1 + weight);
                middle_noise += weight * point.middle_noise;
                let roads = [weight * point.leak / point.tilt, weight * point.leak * point.tilt];
                for (sum, road) in gain.iter_mut().zip(roads) {
                    *sum = (sum.0 + road * point.log_gain, sum.1 + road);
                }
            }
            let [below, above] = gain.map(|(sum, total)| sum / total);
            self.log_gain[(bin, node)] = T::lit(0.5) * (above + below);
            self.log_gain_by_exponent[(bin, node)] = (above - below) / T::lit(2.0 * SHAPE_REACH);
            self.noise[(bin, node)] = noise.0 / noise.1;
            let moved = (-self.log_gain[(bin, node)]).exp_fast();
            self.determinant_noise[(bin, node)] = middle_noise / noise.1 * moved;
        }
    }
}

/// The quantities averaged over a bin's window, at one frequency. The windows of neighbouring bins share their frequencies, so
/// each is computed once per node and not once per bin.
#[derive(Clone, Copy)]
struct Point<T> {
    /// `ln |H|²` less the middle cell's.
    log_gain: T,
    noise: T,
    middle_noise: T,
    /// Power that the leaky integrator leaves.
    leak: T,
    /// Power of a road whose exponent is [`SHAPE_REACH`], one at 10 Hz.
    tilt: T,
}

impl<T: Real> Point<T> {
    fn new(frequency: T, body: &Body<T>, friction: &DescribingFunction<T>, theta: T, middle: T) -> Self {
        let leak_hz = T::lit(LEAK_RAD_S) / T::two_pi();
        let [(gain_here, noise), (gain_middle, middle_noise)] =
            response(body, friction, [theta, middle], frequency);
        Self {
            log_gain: (gain_here / gain_middle).ln_fast(),
            noise,
            middle_noise,
            leak: frequency * frequency / (frequency * frequency + leak_hz * leak_hz),
            tilt: (T::lit(SHAPE_REACH) * (frequency * T::lit(0.1)).ln_fast()).exp_fast(),
        }
    }
}

/// Frequency in Hz of point `i`; the first lies at zero, where [`LOWEST_HZ`] takes its place.
fn point_hz<T: Real>(bin_spacing_hz: T, i: usize) -> T {
    (bin_spacing_hz * T::whole(i as u32) * T::lit(1.0 / f64::from(KERNEL_DENSITY))).max(T::lit(LOWEST_HZ))
}

/// The points around a bin, from below to above it; those of negative frequencies mirrored.
fn window_points(bin: usize) -> impl Iterator<Item = usize> {
    let centre = (bin as i32 + 1) * KERNEL_DENSITY;
    (-KERNEL_HALF..=KERNEL_HALF).map(move |k| (centre + k).unsigned_abs() as usize)
}

/// How much power the window lets through at each point around a bin.
fn window_powers<T: Real>() -> SVector<T, WINDOW> {
    SVector::from_fn(|i, _| {
        sine_window_power(T::lit(f64::from(i as i32 - KERNEL_HALF) / f64::from(KERNEL_DENSITY)))
    })
}

/// See [`Tables::window`]: the parabola through three exponents.
fn window_parabolas<T: Real>(bin_spacing_hz: f64, sample_rate_hz: f64) -> SMatrix<T, 3, BINS> {
    let leak_hz = LEAK_RAD_S / core::f64::consts::TAU;
    let window = window_powers::<f64>();
    let average = |bin: usize, exponent: f64| {
        let centre = bin_spacing_hz * (bin as f64 + 1.0);
        let (mut power, mut total) = (0.0, 0.0);
        for (i, &weight) in window_points(bin).zip(&window) {
            let f = point_hz(bin_spacing_hz, i);
            let leak = f * f / (f * f + leak_hz * leak_hz);
            // Butterworth of order four: |A|² = 1 / (1 + x⁸)
            let x = f / (ANTI_ALIAS * sample_rate_hz);
            let anti_alias = 1.0 / (1.0 + ComplexField::powi(x, 8));
            power += weight * leak * anti_alias * ComplexField::exp(exponent * ComplexField::ln(f / centre));
            total += weight;
        }
        ComplexField::ln(power / total)
    };
    let mut coefficients = SMatrix::zeros();
    for bin in 0..BINS {
        let (low, middle, high) = (average(bin, -SHAPE_REACH), average(bin, 0.0), average(bin, SHAPE_REACH));
        coefficients[(0, bin)] = T::lit(middle);
        coefficients[(1, bin)] = T::lit((high - low) / (2.0 * SHAPE_REACH));
        coefficients[(2, bin)] = T::lit((high + low - 2.0 * middle) / (2.0 * SHAPE_REACH * SHAPE_REACH));
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::configured;

    fn body() -> Body<f64> {
        Body {
            sprung_mass_kg: 240.8,
            unsprung_mass_kg: 56.9,
            damping_n_s_per_m: 925.8,
            spring_n_per_m: 29_114.0,
        }
    }

    #[test]
    fn gain_agrees_with_the_equations_of_motion() {
        // Solve eq. (1) for a harmonic road as a real 4x4 system: an independent way to the same number.
        let (m_b, m_w, c, k, k_t) = (240.8, 56.9, 925.8, 29_114.0, 233_000.0);
        for f in [1.0, 5.0, 10.3, 13.0, 40.0] {
            let w = std_tau() * f;
            let a = nalgebra::Matrix4::new(
                k - m_b * w * w,
                -c * w,
                -k,
                c * w,
                c * w,
                k - m_b * w * w,
                -c * w,
                -k,
                -k,
                c * w,
                k + k_t - m_w * w * w,
                -c * w,
                -c * w,
                -k,
                c * w,
                k + k_t - m_w * w * w,
            );
            let x = a.lu().solve(&nalgebra::Vector4::new(0.0, 0.0, k_t, 0.0)).unwrap();
            let [(gain, _)] = response(&body(), &DescribingFunction::BLANK, [1.0 / k_t], f);
            assert!((gain - (x[2] * x[2] + x[3] * x[3])).abs() < 1e-10 * gain);
        }
    }

    #[test]
    fn window_power_has_its_known_values() {
        // Sine window of n samples: amplitude 1 at 0, π/4 half a bin off, -1/3 a whole bin off, zero at 1.5 bins.
        assert!((sine_window_power(0.0f64) - 1.0).abs() < 1e-15);
        assert!((sine_window_power(0.5f64) - (core::f64::consts::FRAC_PI_4).powi(2)).abs() < 1e-9);
        assert!((sine_window_power(1.0f64) - 1.0 / 9.0).abs() < 1e-12);
        assert!(sine_window_power(1.5f64) < 1e-30);
    }

    #[test]
    fn a_cell_agrees_with_averages_bin_by_bin() {
        // Eq. (9-12) written out for one bin after the other; the sums are the same, so only rounding may differ.
        let tire = PressureMap::new(860.0, 25_500.0).unwrap();
        let grid = Grid::new(241.3);
        let spacing = 1.0 / 0.12;
        let mut tables =
            configured(|tables: &mut Tables<f64>| tables.configure(spacing, 500.0, &grid, &tire, &body()));
        let moved = Body { sprung_mass_kg: 260.0, damping_n_s_per_m: 1000.0, ..body() };
        (0..BINS / AT_ONCE).for_each(|_| tables.refresh_next(&moved, &DescribingFunction::BLANK));
        let (theta, middle) = (tables.theta[0], tables.node_theta[MIDDLE]);
        let leak_hz = LEAK_RAD_S / std_tau();
        for bin in 0..BINS {
            let sum = |value: &dyn Fn(f64) -> f64| -> f64 {
                let offsets = (-20..=20).map(|k| f64::from(k) / 8.0);
                let hz = |offset: f64| (spacing * (bin as f64 + 1.0 + offset)).abs().max(LOWEST_HZ);
                offsets.map(|offset| sine_window_power(offset) * value(hz(offset))).sum()
            };
            let road =
                |f: f64, exponent: f64| f * f / (f * f + leak_hz * leak_hz) * (f / 10.0).powf(exponent);
            let none = DescribingFunction::BLANK;
            let gain = |f: f64| {
                let [own, middle] = response(&moved, &none, [theta, middle], f);
                (own.0 / middle.0).ln()
            };
            for exponent in [-SHAPE_REACH, SHAPE_REACH] {
                let mean = sum(&|f| road(f, exponent) * gain(f)) / sum(&|f| road(f, exponent));
                assert!((tables.of_cell(0).log_gain(bin, exponent) - mean).abs() < 1e-12);
            }
            let noise = sum(&|f| response(&moved, &none, [theta], f)[0].1) / sum(&|_| 1.0);
            assert!((tables.of_cell(0).noise[bin] / noise - 1.0).abs() < 1e-12);
        }
    }

    /// Between nodes the tables are what a node there would have: noise exactly, gains to a thousandth of a bin's log-likelihood.
    #[test]
    fn cells_between_nodes_are_as_if_they_had_tables() {
        let tire = PressureMap::new(860.0, 25_500.0).unwrap();
        let grid = Grid::new(241.3);
        let mut tables = configured(|tables: &mut Tables<f64>| {
            tables.configure(1.0 / 0.12, 500.0, &grid, &tire, &body());
        });
        // From a quarter of the placard pressure on.
        for cell in 4..CELLS {
            let between = tables.of_cell(cell);
            // As if a node lay there.
            let (theta, node) = (tables.theta[cell], NODES - 1);
            let before = tables.clone();
            tables.node_theta[node] = theta;
            (0..BINS)
                .step_by(AT_ONCE)
                .for_each(|bin| tables.fill(node, bin, &body(), &DescribingFunction::BLANK));
            for bin in 0..BINS {
                let off = between.log_gain[bin] - tables.log_gain[(bin, node)];
                assert!(off.abs() < 2e-3, "cell {cell}, bin {bin}: {off}");
                let slope = between.log_gain_by_exponent[bin] - tables.log_gain_by_exponent[(bin, node)];
                assert!(slope.abs() < 2e-3, "cell {cell}, bin {bin}: {slope}");
                let noise = between.noise[bin] / tables.noise[(bin, node)] - 1.0;
                assert!(noise.abs() < 1e-12, "cell {cell}, bin {bin}: {noise}");
                let noise = between.determinant_noise[bin] / tables.determinant_noise[(bin, node)] - 1.0;
                assert!(noise.abs() < 1e-4, "cell {cell}, bin {bin}: {noise}");
            }
            tables = before;
        }
    }

    fn std_tau() -> f64 {
        core::f64::consts::TAU
    }
}
