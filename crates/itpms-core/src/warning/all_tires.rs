//! All tires of an estimate together, as shares of their references.

use crate::decision::{DECISIVE, Probabilities, Shares, Since};
use crate::model::{CarEstimate, Corner, CornerEstimate, Level};
use crate::real::Real;
use crate::warning::Rules;

/// Which tires are low, by their levels and by their losses in this drive, whichever gives any low tire the larger probability: an error of the
/// level cancels in a loss, and a tire low from the start loses nothing.
pub(crate) fn low_tires<T: Real>(
    estimate: &CarEstimate<T>,
    reference_kpa: [T; 4],
    &Rules { limits, decision, .. }: &Rules<'_, T>,
) -> Probabilities<T> {
    let is_stored = |i: Corner| valid(estimate, i).is_some_and(|tire| tire.level == Level::StoredCalibration);
    let since = if Corner::ALL.into_iter().any(is_stored) { Since::EarlierDay } else { Since::Ever };
    let levels = Corner::ALL.map(|i| {
        let tire = valid(estimate, i)?;
        Some([reference_kpa[i] - tire.pressure_kpa, tire.pressure_sd_kpa].map(|kpa| kpa / reference_kpa[i]))
    });
    let losses = losses(estimate, reference_kpa);
    let evidence =
        [(levels, &estimate.correlation, since), (losses, &estimate.loss_correlation, Since::Beginning)];
    let [levels, losses] = evidence.map(|(lacking, correlation, since)| {
        let is_known = lacking.iter().any(Option::is_some);
        is_known
            .then(|| Shares::new(&lacking, correlation).probabilities(limits.loss_share(), since, decision))
            .flatten()
    });
    match (levels, losses) {
        (Some(levels), Some(losses)) if losses.any_low() > levels.any_low() => losses.with_doubt_of(&levels),
        (Some(levels), _) => levels,
        (None, losses) => losses.unwrap_or(Probabilities::of_nothing(decision)),
    }
}

/// Which tires have lost in this drive what makes a leak if it was fast.
pub(crate) fn leaking_tires<T: Real>(
    estimate: &CarEstimate<T>,
    reference_kpa: [T; 4],
    &Rules { limits, decision, tuning }: &Rules<'_, T>,
) -> Probabilities<T> {
    let losses = losses(estimate, reference_kpa);
    let loss = T::lit(tuning.leak_of_a_loss) * limits.loss_share();
    let nothing = Probabilities::of_nothing(decision);
    // Most of the time no tire has lost so much, which needs no weighing.
    if !losses.iter().flatten().any(|[lost, _]| *lost > T::lit(DECISIVE) * loss) {
        return nothing;
    }
    Shares::new(&losses, &estimate.loss_correlation)
        .probabilities(loss, Since::Beginning, decision)
        .unwrap_or(nothing)
}

fn valid<T: Real>(estimate: &CarEstimate<T>, i: Corner) -> Option<&CornerEstimate<T>> {
    estimate.corners[i].as_ref().filter(|corner| corner.validity.is_valid())
}

/// Loss of each tire in this drive and its sd, where losses are counted.
fn losses<T: Real>(estimate: &CarEstimate<T>, reference_kpa: [T; 4]) -> [Option<[T; 2]>; 4] {
    Corner::ALL.map(|i| {
        let loss = valid(estimate, i)?.loss?;
        Some([loss.lost_kpa, loss.lost_sd_kpa].map(|kpa| kpa / reference_kpa[i]))
    })
}

/// A weighted sum of the tires' shares of their references, and its sd; weights that sum to zero leave out what all are wrong by
/// alike. `None` where one that has a weight is not known.
pub(crate) fn weighted_share<T: Real>(
    estimate: &CarEstimate<T>,
    weights: [T; 4],
    reference_kpa: [T; 4],
) -> Option<[T; 2]> {
    let (mut sum, mut sds) = (T::zero(), [T::zero(); 4]);
    for i in Corner::ALL.into_iter().filter(|&i| weights[i] != T::zero()) {
        let (tire, weight) = (valid(estimate, i)?, weights[i] / reference_kpa[i]);
        sum += weight * tire.pressure_kpa;
        sds[i] = weight * tire.pressure_sd_kpa;
    }
    let mut variance = T::zero();
    for (row, &first) in estimate.correlation.iter().zip(&sds) {
        for (&correlation, &second) in row.iter().zip(&sds) {
            variance += correlation * first * second;
        }
    }
    Some([sum, variance.max(T::zero()).sqrt()])
}
