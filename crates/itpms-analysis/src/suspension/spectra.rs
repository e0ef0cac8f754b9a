//! Frames of the signals of all corners, and their cross-spectral matrix, bin by bin: all that is kept of a drive.

use std::f64::consts::TAU;

use nalgebra::{Complex, DVector};

use super::signals::{BODY, CornerSignals, SETTLING_S, SIGNALS, VELOCITY, WAY, WHEEL, high_pass_power};

/// Signals of the whole car.
pub(super) const ALL: usize = 4 * SIGNALS;
/// Length in s of a frame (Hann window); the next one begins half of it later.
const FRAME_S: f64 = 4.0;
pub(super) const HOP_S: f64 = 0.5 * FRAME_S;
/// Bins, a quarter of a hertz apart: 1 to 12 Hz.
const FIRST_BIN: usize = 4;
const BINS: usize = 45;
/// Rate in Hz to which signals are thinned at least.
const LEAST_RATE_HZ: f64 = 100.0;
/// Speed in m/s below which the car is taken to stand, or to be moved by its driver.
const LEAST_SPEED_M_S: f64 = 3.0;
/// Rate in m/s and way in m of a strut's deflection up to which a frame is calm: beyond, dampers have their knees and springs their stops. Rough ones up to twice of it count where too few are calm.
const CALM: [f64; 2] = [0.35, 0.020];
const ROUGH: f64 = 2.0;
/// Rate in m/s (rms, all corners) below which a strut sticks rather than it moves.
const LEAST_RATE_M_S: f64 = 0.008;
/// Frames that a drive is read from at least.
const FEWEST_FRAMES: u32 = 8;
/// Seconds of samples that may be missing, and are interpolated.
const MOST_MISSING_S: f64 = 0.025;

/// The sum of frames of one kind.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Frames {
    /// The lower triangle of each bin's matrix, by rows, bin after bin.
    matrix: Vec<Complex<f64>>,
    count: u32,
    /// Sum over frames of one over their loudness.
    weight: f64,
    /// Sum over frames of the mean squares of the struts' rates.
    squared_rate: [f64; 4],
}

impl Frames {
    fn new() -> Self {
        Self {
            matrix: vec![Complex::new(0.0, 0.0); BINS * ALL * (ALL + 1) / 2],
            count: 0,
            weight: 0.0,
            squared_rate: [0.0; 4],
        }
    }

    fn add(&mut self, spectra: &[DVector<Complex<f64>>], squared_rate: &[f64; 4], loudness: f64) {
        let weight = 1.0 / loudness;
        let mut sums = self.matrix.iter_mut();
        for z in spectra {
            for row in 0..ALL {
                for (column, sum) in (0..=row).zip(sums.by_ref()) {
                    *sum += z[row] * z[column].conj() * weight;
                }
            }
        }
        self.count += 1;
        self.weight += weight;
        self.squared_rate.iter_mut().zip(squared_rate).for_each(|(sum, now)| *sum += now);
    }
}

/// The matrix of a bin, and what goes with it.
#[derive(Debug, Clone)]
pub(super) struct Bin {
    pub(super) hz: f64,
    /// Mean over the frames of `z z*`, each over its loudness.
    pub(super) matrix: nalgebra::DMatrix<Complex<f64>>,
    /// Power that a sensor's noise of one m/s² (rms per row) adds to that of its acceleration.
    pub(super) noise: f64,
}

impl Bin {
    /// Takes off what noise of these variances in (m/s²)² of each corner's sensors adds: what both have in common with the deflection made of
    /// them would pass for a spring.
    pub(super) fn take_off(&mut self, noise: &[f64; 4]) {
        let s = Complex::new(0.0, TAU * self.hz);
        let one = Complex::new(1.0, 0.0);
        for (corner, variance) in noise.iter().enumerate() {
            let at = corner * SIGNALS;
            // The body's and the wheel's noise in each signal.
            let of_body = [(BODY, one), (VELOCITY, -one / s), (WAY, -one / (s * s))];
            let of_wheel = [(WHEEL, one), (VELOCITY, one / s), (WAY, one / (s * s))];
            for signals in [of_body, of_wheel] {
                for (row, a) in signals {
                    for (column, b) in signals {
                        self.matrix[(at + row, at + column)] -= a * b.conj() * (variance * self.noise);
                    }
                }
            }
        }
    }
}

/// What is left of a drive.
#[derive(Debug, Clone)]
pub(super) struct Sum {
    pub(super) bins: Vec<Bin>,
    pub(super) frames: f64,
    /// Whether calm frames were too few, and rougher ones stand for them.
    pub(super) is_rough: bool,
    /// Of the deflection of each strut, m/s.
    pub(super) rate_rms_m_s: [f64; 4],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TooLittle {
    Short,
    Smooth,
    Rough,
}

/// The cross-spectral matrix of a drive in the making; takes it row by row.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct SuspensionSpectra {
    step_s: f64,
    corners: [CornerSignals; 4],
    /// Samples that are averaged to one of a frame, how many there are, and their sums.
    every: usize,
    taken: usize,
    sums: [[f64; SIGNALS]; 4],
    /// Largest rate and way since the frame's last half began, and in the half before.
    peaks: [[f64; 2]; 2],
    /// The newest samples, signal after signal in each.
    samples: Vec<[[f64; SIGNALS]; 4]>,
    length: usize,
    window: Vec<f64>,
    /// Samples to be left out until the filters have settled.
    unsettled: usize,
    last: Option<(f64, [[f64; 2]; 4])>,
    calm: Frames,
    rough: Frames,
    rougher: u32,
    smoother: u32,
}

impl SuspensionSpectra {
    /// For rows of all four corners so many seconds apart.
    pub fn new(step_s: f64) -> Self {
        let every = ((1.0 / step_s / LEAST_RATE_HZ + 1e-9) as usize).max(1);
        let length = ((FRAME_S / (step_s * every as f64)).round() as usize).max(8) & !1;
        let turn = TAU / length as f64;
        let mut new = Self {
            step_s,
            corners: std::array::from_fn(|_| CornerSignals::new(step_s)),
            every,
            taken: 0,
            sums: [[0.0; SIGNALS]; 4],
            peaks: [[0.0; 2]; 2],
            samples: Vec::with_capacity(length),
            length,
            window: (0..length).map(|i| 0.5 - 0.5 * (turn * i as f64).cos()).collect(),
            unsettled: 0,
            last: None,
            calm: Frames::new(),
            rough: Frames::new(),
            rougher: 0,
            smoother: 0,
        };
        new.begin_again();
        new
    }

    /// One that has seen nothing, for the same rows.
    pub fn begun_anew(&self) -> Self {
        Self::new(self.step_s)
    }

    /// Takes a row: time in s, speed in m/s (NaN: not known), and of each corner the accelerations in m/s² of wheel and body.
    pub fn push(&mut self, time_s: f64, speed_m_s: f64, accelerations: &[[f64; 2]; 4]) {
        if speed_m_s < LEAST_SPEED_M_S {
            self.last = None;
        }
        if !accelerations.as_flattened().iter().all(|value| value.is_finite()) {
            return;
        }
        let Some((last_s, last)) = self.last.replace((time_s, *accelerations)) else {
            self.begin_again();
            if speed_m_s < LEAST_SPEED_M_S {
                self.last = None;
            }
            return;
        };
        let steps = ((time_s - last_s) / self.step_s).round();
        if !(steps * self.step_s <= MOST_MISSING_S.max(1.5 * self.step_s)) {
            self.begin_again();
            return;
        }
        for step in 1..=steps.max(0.0) as u32 {
            let share = f64::from(step) / steps;
            let between = |corner: usize, signal: usize| {
                last[corner][signal] + share * (accelerations[corner][signal] - last[corner][signal])
            };
            self.sample(&std::array::from_fn(|corner| [between(corner, 0), between(corner, 1)]));
        }
    }

    fn begin_again(&mut self) {
        self.corners = std::array::from_fn(|_| CornerSignals::new(self.step_s));
        self.samples.clear();
        (self.taken, self.sums, self.peaks) = (0, [[0.0; SIGNALS]; 4], [[0.0; 2]; 2]);
        self.unsettled = (SETTLING_S / self.step_s) as usize;
    }

    fn sample(&mut self, accelerations: &[[f64; 2]; 4]) {
        let mut peak = [0.0f64; 2];
        for (i, (corner, [wheel, body])) in self.corners.iter_mut().zip(accelerations).enumerate() {
            let signals = corner.push(*wheel, *body);
            peak = [peak[0].max(signals[VELOCITY].abs()), peak[1].max(signals[WAY].abs())];
            for (sum, value) in self.sums[i].iter_mut().zip(signals) {
                *sum += value;
            }
        }
        if self.unsettled > 0 {
            self.unsettled -= 1;
            self.sums = [[0.0; SIGNALS]; 4];
            return;
        }
        let [now, _] = &mut self.peaks;
        *now = [now[0].max(peak[0]), now[1].max(peak[1])];
        self.taken += 1;
        if self.taken < self.every {
            return;
        }
        let scale = 1.0 / self.every as f64;
        self.samples.push(self.sums.map(|corner| corner.map(|sum| sum * scale)));
        (self.taken, self.sums) = (0, [[0.0; SIGNALS]; 4]);
        let half = self.length / 2;
        if self.samples.len() == self.length {
            self.frame();
            self.samples.drain(..half);
            self.peaks = [[0.0; 2], self.peaks[0]];
        } else if self.samples.len() == half {
            self.peaks = [[0.0; 2], self.peaks[0]];
        }
    }

    fn frame(&mut self) {
        let over = |at: usize, limit: f64| self.peaks.iter().any(|peak| !(peak[at] < limit));
        let rate = |corner: usize| {
            let squares = self.samples.iter().map(|sample| sample[corner][VELOCITY].powi(2));
            squares.sum::<f64>() / self.length as f64
        };
        let squared_rate: [f64; 4] = std::array::from_fn(rate);
        if !(squared_rate.iter().sum::<f64>() >= 4.0 * LEAST_RATE_M_S * LEAST_RATE_M_S) {
            self.smoother += 1;
            return;
        }
        let [rate, way] = CALM;
        if over(0, ROUGH * rate) || over(1, ROUGH * way) {
            self.rougher += 1;
            return;
        }
        let is_calm = !(over(0, rate) || over(1, way));
        let spectra = self.transforms();
        let bodies =
            spectra.iter().flat_map(|z| (0..4).map(move |corner| z[corner * SIGNALS + BODY].norm_sqr()));
        let loudness = bodies.sum::<f64>() / (4 * BINS) as f64;
        if !(loudness > 0.0) {
            self.smoother += 1;
            return;
        }
        let frames = if is_calm { &mut self.calm } else { &mut self.rough };
        frames.add(&spectra, &squared_rate, loudness);
    }

    /// The spectra of all signals, bin by bin. The bilinear transform integrates too little at high frequencies, which is put right here.
    fn transforms(&self) -> Vec<DVector<Complex<f64>>> {
        let fft = itpms_fourier::forward(self.length);
        let (mut values, mut bins) = (fft.make_input_vec(), fft.make_output_vec());
        let mut spectra = vec![DVector::zeros(ALL); BINS];
        for signal in 0..ALL {
            let windowed = self
                .samples
                .iter()
                .zip(&self.window)
                .map(|(sample, window)| sample.as_flattened()[signal] * window);
            values.iter_mut().zip(windowed).for_each(|(value, windowed)| *value = windowed);
            // It refuses no length but another than its own.
            let _ = fft.process(&mut values, &mut bins);
            for (i, (z, value)) in spectra.iter_mut().zip(bins.iter().skip(FIRST_BIN)).enumerate() {
                let angle = 0.5 * TAU * self.hz(FIRST_BIN + i) * self.step_s;
                let short = angle.tan() / angle;
                let integrals = [(VELOCITY, short), (WAY, short * short)];
                let missing = integrals.iter().find(|(integral, _)| *integral == signal % SIGNALS);
                z[signal] = value * missing.map_or(1.0, |(_, factor)| *factor);
            }
        }
        spectra
    }

    fn hz(&self, bin: usize) -> f64 {
        bin as f64 / (self.length as f64 * self.step_s * self.every as f64)
    }

    /// Seconds of driving in the frames that a drive is read from.
    pub fn usable_s(&self) -> f64 {
        HOP_S * f64::from(self.chosen().0)
    }

    /// Frames that count, and whether rough ones are among them.
    fn chosen(&self) -> (u32, bool) {
        match self.calm.count {
            calm if calm < FEWEST_FRAMES => (calm + self.rough.count, self.rough.count > 0),
            calm => (calm, false),
        }
    }

    pub(super) fn sum(&self) -> Result<Sum, TooLittle> {
        let (count, is_rough) = self.chosen();
        if count < FEWEST_FRAMES {
            return Err(match () {
                () if self.rougher > self.smoother && self.rougher > count => TooLittle::Rough,
                () if self.smoother > count => TooLittle::Smooth,
                () => TooLittle::Short,
            });
        }
        let frames = f64::from(count);
        let mut sums = self.calm.matrix.iter().zip(&self.rough.matrix);
        let bin = |bin: usize| {
            let mut matrix = nalgebra::DMatrix::zeros(ALL, ALL);
            for row in 0..ALL {
                for (column, (calm, rough)) in (0..=row).zip(sums.by_ref()) {
                    let mean = if is_rough { (*calm + *rough) / frames } else { *calm / frames };
                    (matrix[(row, column)], matrix[(column, row)]) = (mean, mean.conj());
                }
            }
            let squares: f64 = self.window.iter().map(|w| w * w).sum();
            let weight = self.calm.weight + if is_rough { self.rough.weight } else { 0.0 };
            let noise = high_pass_power(self.hz(bin)) * squares / self.every as f64 * weight / frames;
            Bin { hz: self.hz(bin), matrix, noise }
        };
        let bins = (FIRST_BIN..FIRST_BIN + BINS).map(bin).collect();
        let rate = |corner: usize| {
            let rough = if is_rough { self.rough.squared_rate[corner] } else { 0.0 };
            ((self.calm.squared_rate[corner] + rough) / frames).sqrt()
        };
        Ok(Sum { bins, frames, is_rough, rate_rms_m_s: std::array::from_fn(rate) })
    }
}
