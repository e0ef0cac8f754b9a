//! A page that is one file: a template with its parts, under a policy that lets nothing run but the template's own scripts and styles.
//!
//! Called by every page that the programs write. The hashes of the policy are those of the template's `<script>` and
//! `<style>` elements; what comes into the page from outside, through any other place, is never hashed and so never runs.

use crate::plot::{escape, night_style};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest as _, Sha256};

/// Style of a page of figures and tables, after the shared one.
const FIGURES_STYLE: &str = include_str!("../assets/figures.css");

const FIGURES_BODY: &str =
    "<body>\n<header><h1>{{title}}</h1></header>\n<main>\n{{content}}</main>\n</body>\n</html>\n";

/// The place of the policy in a template: in the content of `<meta http-equiv="Content-Security-Policy">`, before all scripts and styles.
const POLICY: &str = "policy";

/// Style shared by the report, the live page and the fleet's page: colors by day and by night, type, cards, panels, tables.
pub const BASE_STYLE: &str = include_str!("../assets/base.css");

/// A script that defines `fillPattern`, which draws a state's color and pattern.
pub const PATTERN_SCRIPT: &str = include_str!("../assets/pattern.js");

/// The beginning of a page, up to its body: its `title`, and the styles `plot_style`, the shared one and `style`.
const HEAD: &str = include_str!("../assets/head.html");

/// A whole page of which `body` is the template: the shared beginning and the `{{places}}` of both filled. A place without a part stays
/// empty; what is filled in is not searched for further places.
pub fn page(body: &str, parts: &[(&str, String)]) -> String {
    let base_style = [("base_style", BASE_STYLE.to_owned() + &percent_style() + &night_style())];
    under_policy(&[HEAD, body].concat(), &[parts, &base_style].concat())
}

/// A page of figures and tables: a title, which is text, and what stands under it, which is markup, with a style of its own after the shared
/// one.
pub fn figures_page(title: &str, style: &str, content: String) -> String {
    let style = FIGURES_STYLE.to_owned() + style;
    page(FIGURES_BODY, &[("title", escape(title)), ("style", style), ("content", content)])
}

fn under_policy(template: &str, parts: &[(&str, String)]) -> String {
    let policy = format!(
        "default-src 'none'; style-src {}; script-src {}; img-src data:; base-uri 'none'; form-action 'none'",
        hashes(template, "style", parts),
        hashes(template, "script", parts)
    );
    let with_policy = |name: &str| if name == POLICY { Some(policy.as_str()) } else { part(parts, name) };
    filled(template, with_policy)
}

fn part<'a>(parts: &'a [(&str, String)], name: &str) -> Option<&'a str> {
    parts.iter().find(|(key, _)| *key == name).map(|(_, text)| text.as_str())
}

fn filled<'a>(template: &str, part: impl Fn(&str) -> Option<&'a str>) -> String {
    let (mut page, mut rest) = (String::with_capacity(2 * template.len()), template);
    while let Some((before, after)) = rest.split_once("{{") {
        page.push_str(before);
        let (name, after) = after.split_once("}}").unwrap_or(("", after));
        page.push_str(part(name).unwrap_or_default());
        rest = after;
    }
    page + rest
}

/// The sources of all elements of this name without attributes, each by the SHA-256 of its content (CSP Level 3, section 2.3.1).
fn hashes(template: &str, element: &str, parts: &[(&str, String)]) -> String {
    let (begin, end) = (format!("<{element}>"), format!("</{element}>"));
    let contents = template.split(&begin).skip(1).filter_map(|rest| rest.split_once(&end));
    let hash = |(content, _): (&str, &str)| {
        let content = filled(content, |name| part(parts, name));
        format!("'sha256-{}'", STANDARD.encode(Sha256::digest(content)))
    };
    contents.map(hash).collect::<Vec<_>>().join(" ")
}

/// Class names for places and widths in whole per cent, which a policy without inline styles needs: `x30 w12`.
fn percent_style() -> String {
    (0..=100).map(|n| format!(".x{n}{{left:{n}%}}.w{n}{{width:{n}%}}")).collect()
}

/// A share in per cent, as the number of a class of the shared style: `w12`, a width, or `x12`, a place.
pub fn whole_percent(percent: f64) -> u8 {
    // A number that is none is 0.
    percent.round().clamp(0.0, 100.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_runs_its_templates_scripts_and_nothing_else() {
        let template = "<meta content=\"{{policy}}\"><style>{{looks}}</style><script>alert('Hello, world.');</script>\
                        <script type=\"application/json\">{{data}}</script><p>{{text}}</p>{{nothing}}";
        let parts = [
            ("looks", "p { color: red }".to_owned()),
            ("data", "{}".to_owned()),
            ("text", "<script>stolen()</script>{{looks}}".to_owned()),
        ];
        let page = under_policy(template, &parts);
        // The example of CSP Level 3, section 8.3, and `printf 'p { color: red }' | openssl dgst -sha256 -binary | base64`.
        let policy = "style-src 'sha256-ngewhhP73WDIbgwseeu52VAAJgKdGUsu1IUQQsAm8m4='; script-src 'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='; img-src";
        assert!(page.contains(policy), "{page}");
        assert!(page.ends_with("<p><script>stolen()</script>{{looks}}</p>"), "{page}");
    }

    #[test]
    fn shares_have_classes() {
        let style = percent_style();
        for (percent, class) in [(-3.0, ".w0{"), (57.4, ".w57{"), (1e300, ".w100{"), (f64::NAN, ".w0{")] {
            assert!(style.contains(class) && class == format!(".w{}{{", whole_percent(percent)), "{percent}");
        }
    }
}
