//! What a frame says to one Gaussian of the belief: how likely it was, and where its quantities should go (docs/math/shared-road.md,
//! eq. 11-13). Used by every hypothesis in turn; knows nothing of the others.

use nalgebra::{ArrayStorage, SMatrix, SVector};

use super::covariance::{Covariance, product};
use super::gaussian::Hypothesis;
use super::measurement::{AxleResidual, BINS, Expectation, Gram, ROWS, Score, Slope};
use super::state::{SIDE_SIZE, SIZE, SideReading};
use crate::cholesky;
use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::OVERLAP;

/// Degrees of freedom of the residual's distribution: how heavy its tails are.
const TAILS: f64 = 8.0;
/// Chance that a frame is none that any hypothesis foretells, as where the axles' roads part.
const STRAY: f64 = 1e-3;
/// Least power of a road in a bin, in m²/s².
const LEAST_POWER: f64 = 1e-12;

/// Covariance of the quantities that a side's residual depends on.
#[inline(never)]
pub(crate) fn own_covariance<T: Real>(covariance: &Covariance<T>, reading: &SideReading<T>) -> Gram<T> {
    let (parts, mut own) = (reading.parts(), Gram::zeros());
    for (n, &(i, row, times)) in parts.iter().enumerate() {
        for (m, &(j, column, as_often)) in parts.iter().enumerate().take(n + 1) {
            let covariance = times * as_often * covariance[(row, column)];
            let [i, j] = [i, j].map(|place: usize| place.min(SIDE_SIZE - 1));
            own[(i, j)] += covariance;
            if m < n {
                own[(j, i)] += covariance;
            }
        }
    }
    own
}

/// Covariance of a residual that is due to what is not known of the side: its lower triangle.
#[inline(never)]
fn spread<T: Real>(own: &Gram<T>, slope: &Slope<T>) -> SMatrix<T, ROWS, ROWS> {
    let by = Slope::from_data(ArrayStorage(own.data.0.map(|own| combine(&slope.data.0, &own))));
    let mut spread = SMatrix::zeros();
    for i in 0..ROWS {
        for j in 0..=i {
            spread[(i, j)] = (0..SIDE_SIZE).fold(T::zero(), |sum, k| sum + by[(i, k)] * slope[(j, k)]);
        }
    }
    spread
}

/// What a frame teaches one Gaussian, in the side's quantities: with the covariances `P_o` of everything with these it takes `P_o W W' P_o'`
/// off the covariance, and moves the mean by `P_o` times the pull.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Lesson<T: Real> {
    root: Gram<T>,
    pull: Score<T>,
}

impl<T: Real> Lesson<T> {
    /// A frame's information with its score, counting `weight` of them; `None` if that is no covariance. The mean moves by no more than the residual,
    /// both in standard deviations: no update by Bayes' rule would, but the score is taken with instruments, and what these
    /// measured need not have been the road, as when a wheel comes down.
    #[inline(never)]
    pub(crate) fn learn(
        &mut self,
        own: &Gram<T>,
        score: &Score<T>,
        information_root: &Gram<T>,
        likelihood: &Likelihood<T>,
        weight: T,
    ) -> Option<()> {
        let scale = likelihood.scale / weight;
        // With G G' the information over V: P' = P - P_o W W' P_o', where W = G K'^-1 and K K' = I + G' P_oo G. And with it the mean:
        // m' = m + P'_o score / V.
        let (Self { root, pull }, mut inner) = (self, Gram::zeros());
        multiply(own, information_root, root);
        for (i, row) in information_root.data.0.iter().enumerate() {
            for (j, column) in root.data.0.iter().enumerate().take(i + 1) {
                inner[(i, j)] = product(row, column) / scale;
            }
            inner[(i, i)] += T::one();
        }
        if !cholesky::decompose(&mut inner) {
            return None;
        }
        root.copy_from(information_root);
        divide(root, &inner, scale.sqrt());
        let score = score / scale;
        *pull = score - *root * root.tr_mul(&(own * score));
        // step^T P^-1 step, as step = P_o pull.
        let length = pull.dot(&(own * *pull));
        if length > likelihood.mahalanobis_sq {
            *pull *= (likelihood.mahalanobis_sq / length).sqrt();
        }
        Some(())
    }

    #[inline(never)]
    pub(crate) fn teach(&self, hypothesis: &mut Hypothesis<T>, reading: &SideReading<T>) {
        // P_o, a row for every quantity of the state; then P_o W.
        let mut rows = [[T::zero(); SIDE_SIZE]; SIZE];
        for (own, place, times) in reading.parts() {
            hypothesis.covariance.for_each_of(place, |other, covariance| {
                if let Some(entry) = rows.get_mut(other).and_then(|row| row.get_mut(own)) {
                    *entry += times * covariance;
                }
            });
        }
        let ([pull], root) = (&self.pull.data.0, self.root.transpose());
        for (row, mean) in rows.iter_mut().zip(hypothesis.mean.iter_mut()) {
            *mean += product(row, pull);
            *row = combine(&root.data.0, row);
        }
        hypothesis.covariance.take_off(&rows);
        hypothesis.covariance.hold_variances();
    }
}

/// What solves `x L' = a / by`, for a lower triangular `L`, in the place of `a`: a column after the other.
#[inline(never)]
fn divide<T: Real>(a: &mut Gram<T>, lower: &Gram<T>, by: T) {
    for k in 0..SIDE_SIZE {
        let (before, rest) = a.data.0.split_at_mut(k);
        let Some(column) = rest.first_mut() else { return };
        column.iter_mut().for_each(|value| *value /= by);
        for (earlier, below) in before.iter().zip(&lower.data.0) {
            let share = below[k];
            column.iter_mut().zip(earlier).for_each(|(value, &earlier)| *value -= earlier * share);
        }
        column.iter_mut().for_each(|value| *value /= lower[(k, k)]);
    }
}

/// `a b` for a lower triangular `b`.
#[inline(never)]
fn multiply<T: Real>(a: &Gram<T>, b: &Gram<T>, out: &mut Gram<T>) {
    for (k, (out, b)) in out.data.0.iter_mut().zip(&b.data.0).enumerate() {
        let (columns, shares) = (a.data.0.get(k..).unwrap_or(&[]), b.get(k..).unwrap_or(&[]));
        *out = combine(columns, shares);
    }
}

/// So much of every column together, in registers.
#[inline(always)]
fn combine<T: Real, const N: usize>(columns: &[[T; N]], shares: &[T]) -> [T; N] {
    let mut sum = [T::zero(); N];
    for (column, &share) in columns.iter().zip(shares) {
        sum.iter_mut().zip(column).for_each(|(sum, &value)| *sum += value * share);
    }
    sum
}

/// Half of a bin's power is in each of its two numbers; frames that overlap say half of everything twice.
fn share<T: Real>() -> T {
    T::lit(0.5 / OVERLAP)
}

/// How well a hypothesis foretold a frame.
pub(crate) struct Likelihood<T: Real> {
    pub(crate) log: T,
    /// Square of the residual over its standard deviations, these so enlarged.
    pub(crate) mahalanobis_sq: T,
    /// Factor by which the residual's variance is larger than expected, at least one.
    pub(crate) scale: T,
    /// The residual, white by these, and the root that makes it so.
    pub(super) white: SVector<T, ROWS>,
    pub(super) root: SMatrix<T, ROWS, ROWS>,
}

impl<T: Real> Likelihood<T> {
    /// Residuals are shares of the road that the hypothesis itself reads, and what is not known of the side spreads them by the instruments: derivatives
    /// by what was measured hold the residual's own noise, which would favor who reads less of a road, or knows less (docs/math/shared-road.md, eq. 10a).
    #[inline(never)]
    pub(crate) fn new(
        own: &Gram<T>,
        found: &AxleResidual<T>,
        instrument: &Slope<T>,
        expected: &Expectation<T>,
    ) -> Option<Self> {
        let road_power = expected.road_power.iter().zip(&found.road_power);
        let mut relative = [T::one(); BINS];
        for (relative, (&reference, &own)) in relative.iter_mut().zip(road_power) {
            *relative = ((reference + T::lit(LEAST_POWER)) / (own + T::lit(LEAST_POWER))).sqrt();
        }
        let rows: SVector<T, ROWS> = SVector::from_fn(|row, _| found.rows[row] * relative[row % BINS]);
        let known = spread(own, instrument);
        let share = share();
        let root = |scale: T| {
            let mut total = known;
            (0..ROWS).for_each(|row| total[(row, row)] += expected.power[row % BINS] * share * scale);
            cholesky::decompose(&mut total).then_some(total)
        };
        let plain = root(T::one())?;
        let log_determinant = (0..ROWS).fold(T::zero(), |sum, i| sum + T::lit(2.0) * plain[(i, i)].ln_fast());
        let mahalanobis_sq = cholesky::solve(&plain, &rows).norm_squared();
        // A residual far larger than expected says little: Student's t with few degrees of freedom.
        let (tails, degrees) = (T::lit(TAILS), T::lit(ROWS as f64));
        let scale = ((tails + mahalanobis_sq) / (tails + degrees)).max(T::one());
        let root = if scale > T::one() { root(scale)? } else { plain };
        let white = cholesky::solve(&root, &rows);
        let density = |log_determinant: T, mahalanobis_sq: T| {
            let beyond = (T::one() + mahalanobis_sq / tails).ln_fast();
            T::lit(-0.5) * (log_determinant + (tails + degrees) * beyond)
        };
        // A stray frame is as likely as one whose residual is as large as its noise.
        let noise = expected
            .power
            .iter()
            .fold(T::zero(), |sum, &power| sum + T::lit(2.0) * (power * share).ln_fast());
        let stray = density(noise, T::lit(OVERLAP) * degrees) + T::lit(STRAY).ln_fast();
        let own = density(log_determinant, mahalanobis_sq);
        let most = own.max(stray);
        let log = most + ((own - most).exp_fast() + (stray - most).exp_fast()).ln_fast();
        Some(Self { log, mahalanobis_sq: white.norm_squared(), scale, white, root })
    }

    /// Power of the residual over its expectation, per bin.
    #[inline(never)]
    pub(crate) fn power_ratio(&self) -> [T; BINS] {
        let mut ratio = [T::zero(); BINS];
        for row in 0..ROWS {
            // A column of the root's inverse, with which rows and columns of the whole inverse are products.
            let column = cholesky::solve(&self.root, &SVector::ith(row, T::one()));
            let weighted = column.dot(&self.white);
            ratio[row % BINS] += share::<T>() * self.scale * weighted * weighted / column.norm_squared();
        }
        ratio
    }
}

/// How the instruments want the side's quantities changed.
pub(crate) fn score<T: Real>(
    found: &AxleResidual<T>,
    instrument: &Slope<T>,
    expected: &Expectation<T>,
) -> Score<T> {
    let mut score = Score::zeros();
    for row in 0..ROWS {
        let weight = T::lit(2.0 * OVERLAP) / expected.power[row % BINS];
        score -= instrument.row(row).transpose() * (found.rows[row] * weight);
    }
    score
}
