//! Fig. 9: a deeper loss, and a loss with a recovery.
//!
//! Called by [`super::reproduce`].

use super::histories::{data, error, pressure};
use super::outcome::Outcome;
use super::published::{FIG_9A, FIG_9B};
use super::section::Section;
use super::standing::{spread, standing, verdict};
use itpms_analysis::plot::Figure;

pub(super) fn section(deep: &Outcome, recover: &Outcome) -> Section {
    let figure = Figure::new("figure-09", "Figure 9: Other losses, simulated")
        .describe("The default estimator follows a deep loss and a loss with a recovery.")
        .panel(pressure("a", "241.3 to 41.4 kPa", deep, (0.0, 320.0)))
        .panel(pressure("b", "241.3 to 138 to 195 kPa", recover, (60.0, 320.0)))
        .panel(error("c", "Error, deep loss", deep, 120.0))
        .panel(error("d", "Error, loss and recovery", recover, 80.0));
    let text = format!(
        "<p>Deep loss: the paper has {FIG_9A} kPa, ours is {} kPa. {} Loss and recovery: the paper has {FIG_9B} kPa, ours is {} kPa. {}</p>\
         <p>In the paper a loss nearly twice as deep costs nearly twice the error. An estimator that can jump pays only for the seconds before it \
         notices.</p>",
        spread(&deep.informed_rmse(), 2),
        verdict(FIG_9A, &deep.informed_rmse()),
        spread(&recover.informed_rmse(), 2),
        verdict(FIG_9B, &recover.informed_rmse()),
    );
    Section::new("other-drops", "Simulation study: other losses, Figure 9")
        .text(text)
        .figure(
            figure,
            "First seed. (a, c) down to 41.4 kPa within 2.5 s, far below the 186 kPa where Table 1 ends; (b, d) down to 138 kPa from 15 s, then up to \
             195 kPa at 27.5 s, as an inflation system would. The error axes hold what works; arrows mark what leaves them.",
            vec![
                data("figure-09", "A deep loss, simulated; first seed", deep, ""),
                data("figure-09-recover", "A loss and a recovery, simulated; first seed", recover, ""),
            ],
        )
        .table(
            standing(
                "figure-09-errors",
                "Errors in the cases of Figure 9",
                "Case",
                &[("deep loss".to_owned(), deep), ("loss and recovery".to_owned(), recover)],
            ),
            "Median over the seeds, in brackets 10 to 90 %.",
        )
}
