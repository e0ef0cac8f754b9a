//! `itpms lab reproduce`: a page that needs nothing, figures and data beside it, the same each time.

use serde_json::Value;

use crate::common::{Bench, table};

/// Figures with numbers; 1, 2 and 4 are diagrams.
const FIGURES: [u32; 13] = [3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16];

#[test]
fn every_figure_and_table_is_there_and_the_page_needs_nothing_else() {
    let bench = Bench::new();
    let outcome = bench.run("reproduce --out study --seeds 1");
    let text = outcome.success();
    assert!(text.is_ascii() && text.contains("See study/index.html"), "{text}");
    assert!(text.contains("RMSE in kPa") && text.contains("of one drive"), "{text}");
    // Every number of the paper's text and tables: 3 of Fig. 3, 1 of Fig. 5, 3 of Fig. 7 and 9, 3 tables of 3, Fig. 12
    // in three ways; what it is, an empty line, a head and the last line.
    assert_eq!(text.lines().count(), 3 + 1 + 3 + 9 + 3 + 4, "{text}");
    for paper in
        ["713.91", "60880", "0.998", "2.14", "12.96", "23.21", "18.93", "17.57", "13.31", "3.48", "3.17"]
    {
        assert!(text.contains(paper), "{paper}: {text}");
    }
    let page = bench.read("study/index.html");
    for figure in FIGURES {
        let name = format!("figure-{figure:02}");
        let svg = bench.read(&format!("study/{name}.svg"));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{name}");
        assert!(page.contains(&format!("<figure id=\"{name}\">")), "{name}");
        columns(&bench, &name);
    }
    for table in 1..=5 {
        columns(&bench, &format!("table-{table:02}"));
    }
    columns(&bench, "summary");
    // The namespace of SVG is a name, not something to load.
    let addresses = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(!addresses.contains("http://") && !addresses.contains("https://"));
    // The shell's own script, which asks for day or night.
    assert_eq!(page.matches("<script").count(), 1);
    for loading in ["<link", "<img", "<iframe", "@import", "url(", " src="] {
        assert!(!page.contains(loading), "{loading}");
    }
    links_lead_somewhere(&bench, &page);
}

#[allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]
fn columns(bench: &Bench, name: &str) {
    let (header, rows) = table(&bench.read(&format!("study/{name}.csv")));
    let json: Value = serde_json::from_str(&bench.read(&format!("study/{name}.json"))).unwrap();
    assert_eq!(json["name"], name);
    let columns = json["columns"].as_object().unwrap();
    let mut names: Vec<_> = columns.keys().cloned().collect();
    let mut sorted = header;
    names.sort();
    sorted.sort();
    assert_eq!(names, sorted, "{name}");
    let longest = columns.values().map(|values| values.as_array().unwrap().len()).max();
    assert_eq!(longest, Some(rows.len()), "{name}");
}

/// Every link is an anchor on the page or a file beside it.
fn links_lead_somewhere(bench: &Bench, page: &str) {
    let links: Vec<&str> = page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert!(links.len() > 60, "{}", links.len());
    for link in links {
        match link.strip_prefix('#') {
            Some(anchor) => assert!(page.contains(&format!("id=\"{anchor}\"")), "{link}"),
            None => assert!(bench.path("study").join(link).is_file(), "{link}"),
        }
    }
}
