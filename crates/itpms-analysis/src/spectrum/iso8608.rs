//! ISO 8608: a road's displacement spectrum as a straight line in double-logarithmic axes, and its class A to H.
//!
//! `Gd(n) = Gd(n0) (n / n0)^-w` with `n0 = 0.1` cycle/m. The standard smooths the measured spectrum over bands of
//! one, one third and one twelfth of an octave before it draws the line; so does [`fit_power_law`].

use thiserror::Error;

use super::Psd;

/// The spatial frequency `n0` at which ISO 8608 states a road's level, in cycles per metre.
pub const REFERENCE_FREQUENCY_PER_M: f64 = 0.1;

/// A road's displacement spectrum, `Gd(n0) (n / n0)^-w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Density at [`REFERENCE_FREQUENCY_PER_M`] in m³ (m² per cycle/m).
    pub gd_n0_m3: f64,
    /// The slope `w`, about 2.
    pub waviness: f64,
}

impl PowerLaw {
    /// Displacement density in m³ at a spatial frequency in cycles per metre.
    pub fn density_m3(&self, frequency_per_m: f64) -> f64 {
        self.gd_n0_m3 * (frequency_per_m / REFERENCE_FREQUENCY_PER_M).powf(-self.waviness)
    }
}

itpms_core::labelled! {
    /// ISO 8608 road class, by the geometric means and limits of its Table C.1 (displacement, `n0` = 0.1 cycle/m).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum IsoClass {
        /// Below 32e-6 m³, as a good motorway.
        A = "A",
        /// 32e-6 to 128e-6 m³.
        B = "B",
        /// 128e-6 to 512e-6 m³.
        C = "C",
        /// 512e-6 to 2048e-6 m³.
        D = "D",
        /// 2048e-6 to 8192e-6 m³.
        E = "E",
        /// 8192e-6 to 32 768e-6 m³.
        F = "F",
        /// 32 768e-6 to 131 072e-6 m³.
        G = "G",
        /// Above 131 072e-6 m³.
        H = "H",
    }
}

impl IsoClass {
    /// The class of a level `Gd(n0)` in m³; `None` unless it is positive and finite.
    pub fn of_level(gd_n0_m3: f64) -> Option<Self> {
        if !(gd_n0_m3 > 0.0 && gd_n0_m3.is_finite()) {
            return None;
        }
        Self::ALL.into_iter().find(|class| gd_n0_m3 < class.upper_limit_m3()).or(Some(Self::H))
    }

    /// Geometric mean of the class's `Gd(n0)` in m³: 16e-6 for A, four times as much for each class after it.
    pub fn geometric_mean_m3(self) -> f64 {
        16e-6 * 4f64.powi(self as i32)
    }

    /// Upper limit of the class's `Gd(n0)` in m³: twice the geometric mean. Class H has none in the standard.
    pub fn upper_limit_m3(self) -> f64 {
        2.0 * self.geometric_mean_m3()
    }
}

/// A spectrum no line can be drawn through.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FitError {
    #[error("band from {low_per_m} to {high_per_m} cycles/m, expected 0 < low < high")]
    Band { low_per_m: f64, high_per_m: f64 },
    #[error("{0} smoothed bands hold a positive density, expected at least 3")]
    TooFewBands(usize),
}

/// One band of a smoothed spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    pub low_per_m: f64,
    /// Upper limit in cycles per metre.
    pub high_per_m: f64,
    /// Mean density over the band in m³.
    pub density_m3: f64,
    /// About how many independent values that mean averages.
    pub averages: f64,
}

impl Band {
    /// Geometric centre in cycles per metre.
    pub fn center_per_m(&self) -> f64 {
        (self.low_per_m * self.high_per_m).sqrt()
    }

    fn octaves(&self) -> f64 {
        (self.high_per_m / self.low_per_m).log2()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadFit {
    pub law: PowerLaw,
    pub class: IsoClass,
    /// Limits of the fitted band in cycles per metre.
    pub band_per_m: (f64, f64),
    /// Rms distance of the smoothed spectrum from the line, in natural logarithms (0.1 is 10 %).
    pub residual_ln: f64,
    /// Standard error of `ln Gd(n0)` from the length of the record (0.1 is 10 %).
    pub level_sd_ln: f64,
    /// Standard error of the slope from the length of the record.
    pub waviness_sd: f64,
}

/// Octaves per smoothing band at a spatial frequency in cycles per metre (ISO 8608: whole octaves up to 0.0312,
/// thirds up to 0.25, twelfths above).
fn octaves_per_band(frequency_per_m: f64) -> f64 {
    if frequency_per_m < 0.0312 {
        1.0
    } else if frequency_per_m < 0.25 {
        1.0 / 3.0
    } else {
        1.0 / 12.0
    }
}

/// Independent values per bin: neighbouring Hann segments at half overlap share 1/6 of their amplitude and 1/36 of
/// their power; a Hann window spreads each bin over 1.5.
fn averages_per_bin(psd: &Psd) -> f64 {
    psd.segments as f64 / (1.0 + 2.0 / 36.0) / 1.5
}

/// The smoothed spectrum of ISO 8608 between two spatial frequencies (cycles per metre). Bins are taken with the
/// share of their width that lies in a band; bands beyond the spectrum's ends are left out.
pub fn iso_bands(psd: &Psd, low_per_m: f64, high_per_m: f64) -> Vec<Band> {
    let width = psd.resolution();
    // Bin 1 lost part of its power with the straight line.
    let first = low_per_m.max(1.5 * width);
    let last = high_per_m.min(psd.frequencies.last().copied().unwrap_or(0.0));
    let mut bands = Vec::new();
    if !(width > 0.0 && low_per_m > 0.0) {
        return bands;
    }
    let per_bin = averages_per_bin(psd);
    let mut low = first;
    while low < last * (1.0 - 1e-9) {
        let high = (low * octaves_per_band(low * 1.0001).exp2()).min(last);
        let (mut sum, mut bins) = (0.0, 0.0);
        // Bin k covers (k + 1/2 .. k + 3/2) widths.
        let from = ((low / width - 0.5).floor() as usize).saturating_sub(1);
        for (f, density) in psd.frequencies.iter().zip(&psd.densities).skip(from) {
            let share = ((f + width / 2.0).min(high) - (f - width / 2.0).max(low)) / width;
            if share > 0.0 {
                sum += share * density;
                bins += share;
            } else if *f > high {
                break;
            }
        }
        if bins > 0.0 && sum > 0.0 {
            let averages = (per_bin * bins).max(psd.segments as f64 / (1.0 + 2.0 / 36.0)).max(1.0);
            bands.push(Band { low_per_m: low, high_per_m: high, density_m3: sum / bins, averages });
        }
        low = high;
    }
    bands
}

/// Draws the line through a displacement spectrum between two spatial frequencies (cycles per metre): least
/// squares of `ln Gd` over `ln n` through the bands of [`iso_bands`], each octave with the same weight. The
/// logarithm of a mean of `K` exponential values is low by about `1/(2K) + 1/(12 K²)`; that is added back.
pub fn fit_power_law(psd: &Psd, low_per_m: f64, high_per_m: f64) -> Result<RoadFit, FitError> {
    if !(low_per_m > 0.0 && low_per_m < high_per_m && high_per_m.is_finite()) {
        return Err(FitError::Band { low_per_m, high_per_m });
    }
    let bands = iso_bands(psd, low_per_m, high_per_m);
    if bands.len() < 3 {
        return Err(FitError::TooFewBands(bands.len()));
    }
    let points: Vec<(f64, f64, f64)> = bands
        .iter()
        .map(|band| {
            let k = band.averages;
            let ln_density = band.density_m3.ln() + 0.5 / k + 1.0 / (12.0 * k * k);
            (band.octaves(), (band.center_per_m() / REFERENCE_FREQUENCY_PER_M).ln(), ln_density)
        })
        .collect();
    let weighted =
        |value: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(g, x, y)| g * value(x, y)).sum::<f64>();
    let total = weighted(&|_, _| 1.0);
    let (x_mean, y_mean) = (weighted(&|x, _| x) / total, weighted(&|_, y| y) / total);
    let slope = weighted(&|x, y| (x - x_mean) * (y - y_mean)) / weighted(&|x, _| (x - x_mean).powi(2));
    let intercept = y_mean - slope * x_mean;
    // The logarithm of a mean of K exponential values scatters by 1/K in variance. Bands narrower than a bin share it
    // with their neighbors: each counts with its part.
    let per_width = averages_per_bin(psd) / psd.resolution();
    let spread = weighted(&|x, _| (x - x_mean).powi(2));
    let (mut level_variance, mut slope_variance) = (0.0, 0.0);
    for (band, &(g, x, _)) in bands.iter().zip(&points) {
        let by_slope = g * (x - x_mean) / spread;
        let averages = per_width * (band.high_per_m - band.low_per_m);
        level_variance += (g / total - x_mean * by_slope).powi(2) / averages;
        slope_variance += by_slope.powi(2) / averages;
    }
    let residual_ln = (weighted(&|x, y| (y - intercept - slope * x).powi(2)) / total).sqrt();
    let law = PowerLaw { gd_n0_m3: intercept.exp(), waviness: -slope };
    let class = IsoClass::of_level(law.gd_n0_m3).ok_or(FitError::TooFewBands(0))?;
    let band_per_m = (bands[0].low_per_m, bands[bands.len() - 1].high_per_m);
    let (level_sd_ln, waviness_sd) = (level_variance.sqrt(), slope_variance.sqrt());
    Ok(RoadFit { law, class, band_per_m, residual_ln, level_sd_ln, waviness_sd })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::welch;
    use itpms_fourier::Complex;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// A Gaussian road of `n` samples `spacing` metres apart: each Fourier coefficient complex normal with
    /// variance `Gd(n) N / (2 spacing)`, so that the one-sided density is `Gd`.
    fn gaussian_road(law: PowerLaw, n: usize, spacing: f64, seed: u64) -> Vec<f64> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let inverse = itpms_fourier::inverse(n);
        let mut bins = inverse.make_input_vec();
        for (i, bin) in bins.iter_mut().enumerate().take(n / 2).skip(1) {
            let sd = (law.density_m3(i as f64 / (n as f64 * spacing)) * n as f64 / spacing / 4.0).sqrt();
            let mut normal = || sd * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
            *bin = Complex::new(normal(), normal());
        }
        let mut road = inverse.make_output_vec();
        inverse.process(&mut bins, &mut road).unwrap();
        road.iter_mut().for_each(|v| *v /= n as f64);
        road
    }

    #[test]
    fn level_slope_and_class_of_a_known_road_come_back() {
        for (seed, (level, w)) in
            [(16e-6, 2.14), (64e-6, 1.6), (256e-6, 2.0), (1024e-6, 2.6)].into_iter().enumerate()
        {
            let law = PowerLaw { gd_n0_m3: level, waviness: w };
            // 6.5 km at 5 cm, segments of 205 m.
            let road = gaussian_road(law, 1 << 17, 0.05, seed as u64);
            let fit = fit_power_law(&welch(&road, 4096, 0.05).unwrap().unwrap(), 0.05, 2.0).unwrap();
            // About 60 segments; the level at n0 rests on roughly 10 bins: 4 %, the slope on 5 octaves: 0.015.
            assert!((fit.law.gd_n0_m3 / level).ln().abs() < 0.15, "level {} for {level}", fit.law.gd_n0_m3);
            assert!((fit.law.waviness - w).abs() < 0.05, "slope {} for {w}", fit.law.waviness);
            assert_eq!(fit.class, IsoClass::ALL[seed]);
            assert!(fit.residual_ln < 0.15);
        }
    }

    #[test]
    fn short_records_are_not_read_low() {
        // 200 drives of 102 m, two segments and a half each: the mean of ln Gd(n0) must not lean.
        let law = PowerLaw { gd_n0_m3: 16e-6, waviness: 2.0 };
        let mut mean = (0.0, 0.0);
        let (mut scatter, mut stated) = ((0.0, 0.0), (0.0, 0.0));
        for seed in 0..200 {
            // A piece of a road whose period is eight times as long, as a real road has none.
            let road = gaussian_road(law, 1 << 14, 0.05, 1000 + seed);
            let fit = fit_power_law(&welch(&road[..2048], 1024, 0.05).unwrap().unwrap(), 0.1, 2.0).unwrap();
            mean.0 += (fit.law.gd_n0_m3 / 16e-6).ln() / 200.0;
            mean.1 += (fit.law.waviness - 2.0) / 200.0;
            scatter.0 += (fit.law.gd_n0_m3 / 16e-6).ln().powi(2) / 200.0;
            scatter.1 += (fit.law.waviness - 2.0).powi(2) / 200.0;
            stated.0 += fit.level_sd_ln.powi(2) / 200.0;
            stated.1 += fit.waviness_sd.powi(2) / 200.0;
        }
        // One drive's ln level scatters by about 0.35, the mean of 200 by 0.025; uncorrected it leans by -0.15.
        assert!(mean.0.abs() < 0.1, "{mean:?}");
        assert!(mean.1.abs() < 0.06, "{mean:?}");
        // The stated standard errors are the scatter's: 200 drives know it to 5 %; bands of one or two bins, whose
        // logarithms scatter more than 1/K, and half-overlapping windows leave the rest.
        for (scatter, stated) in [(scatter.0, stated.0), (scatter.1, stated.1)] {
            let ratio = (scatter / stated).sqrt();
            assert!((0.7..1.4).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn an_exact_line_is_read_exactly_where_bands_are_narrow() {
        let law = PowerLaw { gd_n0_m3: 64e-6, waviness: 2.0 };
        let frequencies: Vec<f64> = (1..=4000).map(|i| f64::from(i) * 0.001).collect();
        let densities = frequencies.iter().map(|n| law.density_m3(*n)).collect();
        let psd = Psd { frequencies, densities, segments: 1_000_000 };
        let fit = fit_power_law(&psd, 0.25, 2.8).unwrap();
        // The mean of n^-2 over a band is the density at its geometric centre, exactly; bins add 1e-4.
        assert!((fit.law.gd_n0_m3 / 64e-6 - 1.0).abs() < 1e-3, "{}", fit.law.gd_n0_m3);
        assert!((fit.law.waviness - 2.0).abs() < 1e-3);
    }

    #[test]
    fn classes_have_the_standards_limits() {
        // ISO 8608, Table C.1: geometric means and limits in 1e-6 m3.
        let means = [16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0, 65536.0, 262_144.0];
        let limits = [32.0, 128.0, 512.0, 2048.0, 8192.0, 32768.0, 131_072.0];
        for (class, mean) in IsoClass::ALL.into_iter().zip(means) {
            assert!((class.geometric_mean_m3() / (mean * 1e-6) - 1.0).abs() < 1e-12);
            assert_eq!(IsoClass::of_level(mean * 1e-6), Some(class));
        }
        for (class, limit) in IsoClass::ALL.into_iter().zip(limits) {
            assert_eq!(IsoClass::of_level(limit * 0.999e-6), Some(class));
            assert!(IsoClass::of_level(limit * 1.001e-6) > Some(class));
        }
        assert_eq!(IsoClass::of_level(1e9), Some(IsoClass::H));
        assert_eq!(IsoClass::of_level(f64::NAN), None);
        assert_eq!(IsoClass::of_level(0.0), None);
    }

    #[test]
    fn a_band_without_data_is_refused() {
        let psd = Psd { frequencies: vec![0.1, 0.2, 0.3], densities: vec![1e-6; 3], segments: 1 };
        assert!(matches!(fit_power_law(&psd, 1.0, 2.0), Err(FitError::TooFewBands(0))));
        assert!(matches!(fit_power_law(&psd, 2.0, 1.0), Err(FitError::Band { .. })));
        assert!(matches!(fit_power_law(&psd, f64::NAN, 1.0), Err(FitError::Band { .. })));
    }
}
