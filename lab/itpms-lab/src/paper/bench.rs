//! The test bed's three pressure profiles: Fig. 12 and 13.
//!
//! Called by [`super::reproduce`].

use super::histories::{data, error, pressure, usual_panels, without_reset};
use super::outcome::Outcome;
use super::plan::{RESET_LONG_S, RESET_SHORT_S};
use super::published::FIG_12;
use super::section::{Section, number};
use super::standing::{spread, standing, verdict};
use itpms_analysis::plot::Figure;

/// Half the height in kPa of an error axis for those that work.
const CLOSE_UP_KPA: f64 = 20.0;

pub(super) fn section(drop: &Outcome, recover: &Outcome, slow: &Outcome) -> Section {
    let [a, b, c, d] = usual_panels(drop, (110.0, 260.0));
    let figure_12 = Figure::new("figure-12", "Figure 12: A loss on the test bed")
        .describe("Pressure falls from 224 to 142 kPa between 38 and 43 s.")
        .panel(a)
        .panel(b)
        .panel(c)
        .panel(d)
        .panel(error("e", "Error, close up", drop, CLOSE_UP_KPA))
        .panel(without_reset("f", "The default without a reset", drop, (110.0, 320.0)));
    let figure_13 = Figure::new("figure-13", "Figure 13: Other losses on the test bed")
        .describe("A loss with a slow recovery, and a slow loss.")
        .panel(pressure("a", "224 to 142 to 180 kPa", recover, (110.0, 260.0)))
        .panel(pressure("b", "220 to 160 kPa within 30 s", slow, (110.0, 260.0)))
        .panel(error("c", "Error, loss and recovery", recover, 80.0))
        .panel(error("d", "Error, slow loss", slow, 80.0));
    let without = drop.records.last().map(|record| record.rmse);
    let drawn = drop.records.last().map_or(f64::NAN, |record| record.drawn_rmse_kpa);
    let after = drop.informed().map(|record| record.after);
    let text = format!(
        "<p>Paper: {FIG_12} kPa. Ours, <code>informed</code> after a reset of {RESET_LONG_S} s: {with}. {verdict} While the reset lasts \
         the estimator is told the pressure, so these seconds flatter the RMSE; over the time after the reset alone it is {after}, and \
         without any reset {without}.</p>\
         <p>A road that repeats shows how the stiffness changes from pass to pass, and before anything has changed it says little of \
         its level: without a reset the estimator is left with some forty spectral lines of one short segment (1.5 Hz apart from 3 to 60 Hz), which \
         need not look like a road. How well it then does depends on the segment: {drawn} kPa in the drive of (f), {without} over the seeds.</p>\
         <p>The published filters get the covariances of Sec. 5.1 and the start of 200 000 N/m (194.9 kPa); they know no reset.</p>",
        with = spread(&drop.informed_rmse(), 2),
        verdict = verdict(FIG_12, &drop.informed_rmse()),
        after = after.map_or_else(String::new, |s| spread(&s, 2)),
        without = without.map_or_else(String::new, |s| spread(&s, 2)),
        drawn = number(drawn, 2),
    );
    Section::new("bench-drops", "Test bed: losses, Figures 12 and 13")
        .text(text)
        .figure(
            figure_12,
            format!(
                "First seed; shaded from the left: the reset drive of {RESET_LONG_S} s, in which the pressure is known to be the placard's. (a) pressure, (b) \
                 forgetting factor, (c) error and (e) the same close up, (d) variance claimed for the stiffness; (f) the default in the same drive when nobody tells it the \
                 pressure at the start. In the paper AEKF-UI follows with an RMSE of {FIG_12} kPa."
            ),
            vec![data("figure-12", "A loss on the test bed; first seed", drop, "")],
        )
        .table(
            standing("figure-12-errors", "Errors in the case of Figure 12", "Case", &[("224 to 142 kPa".to_owned(), drop)]),
            "Median over the seeds, in brackets 10 to 90 %.",
        )
        .figure(
            figure_13,
            format!(
                "First seed. (a, c) 224 to 142 kPa between 5 and 10 s, then up to 180 kPa within 30 s; (b, d) 220 to 160 kPa within 30 s. The change starts at \
                 5 s, so the reset lasts {RESET_SHORT_S} s only. The paper draws these two and states no number."
            ),
            vec![
                data("figure-13", "A loss and a recovery on the test bed; first seed", recover, ""),
                data("figure-13-slow", "A slow loss on the test bed; first seed", slow, ""),
            ],
        )
        .table(
            standing(
                "figure-13-errors",
                "Errors in the cases of Figure 13",
                "Case",
                &[("loss and recovery".to_owned(), recover), ("slow loss".to_owned(), slow)],
            ),
            "Median over the seeds, in brackets 10 to 90 %.",
        )
}
