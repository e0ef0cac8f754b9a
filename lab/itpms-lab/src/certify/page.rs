//! The result as one HTML page: a table, and a figure per test. Nothing is loaded from anywhere.

use super::table::{clock, false_alerts, named, pressures, relit};
use super::{Certificate, Outcome, Verdict};
use itpms_analysis::page::figures_page;
use itpms_analysis::plot::escape;

const STYLE: &str = include_str!("page.css");

impl Certificate {
    pub fn page(&self) -> String {
        let rows: String = self.outcomes.iter().map(row).collect();
        let figures: String = self.outcomes.iter().map(figure).collect();
        let content = format!(
            "<p>{summary}</p>\
             <p>Each test: a reset, twenty minutes of learning while the tires warm up by 20 K, a standstill in which tires are let down or a plug is pulled, and \
             driving through the whole range of speeds until the tell-tale comes on or the time is over. Then five minutes without the key, after which the \
             tell-tale has to be lit again, and a drive with everything put right, on which it has to go out. Nothing else may be \
             reported at any time. Times are cumulative driving time, minutes and seconds; of what was also reported, time since the reset.</p>\n\
             <div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th>regulation</th><th>clause</th><th>test</th><th>kPa</th><th>warned</th><th>limit</th>\
             <th>wheels named</th><th>lit again</th><th>out after</th><th>also reported, at</th><th>verdict</th></tr></thead><tbody>{rows}</tbody></table></div>\n\
             <h2>Pressures</h2><div class=\"figures\">{figures}</div>\n",
            summary = escape(self.summary().trim_end()),
        );
        figures_page("Regulation runs: UN R141 and FMVSS 138", STYLE, content)
    }
}

fn row(outcome: &Outcome) -> String {
    let class = if outcome.verdict == Verdict::Pass { "pass" } else { "fail" };
    let texts = [pressures(outcome), named(outcome), false_alerts(outcome)];
    let [rule, clause, what] = [outcome.rule.label(), outcome.clause, &outcome.what].map(escape);
    let [kpa, wheels, false_alerts] = texts.map(|text| escape(&text));
    format!(
        "<tr><td>{rule}</td><td>{clause}</td><td><a href=\"#{name}\">{what}</a></td><td class=\"n\">{kpa}</td><td class=\"n\">{warned}</td>\
         <td class=\"n\">{limit}</td><td>{wheels}</td><td>{relit}</td><td class=\"n\">{out}</td><td>{false_alerts}</td>\
         <td class=\"{class}\">{verdict}</td></tr>\n",
        name = escape(&outcome.name),
        warned = clock(outcome.warned_after_s),
        limit = clock(Some(outcome.limit_s)),
        relit = relit(outcome),
        out = clock(outcome.out_after_s),
        verdict = escape(outcome.verdict.label()),
    )
}

fn figure(outcome: &Outcome) -> String {
    let figure = outcome.figure();
    let warned = match outcome.warned_after_s {
        Some(after_s) => format!("warned after {} of {}", clock(Some(after_s)), clock(Some(outcome.limit_s))),
        None => format!("not warned within {}", clock(Some(outcome.limit_s))),
    };
    format!(
        "<figure id=\"{}\">{}<figcaption>{}: {warned}.</figcaption></figure>\n",
        escape(&outcome.name),
        figure.html(),
        escape(figure.title())
    )
}
