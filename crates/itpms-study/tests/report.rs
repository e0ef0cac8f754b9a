//! The report as a reader's browser gets it.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod synthetic;

use itpms_study::report::{render_report, write_report};
use synthetic::{Drive, report};

const PAPER: Drive = Drive { seconds: 40.0, rate_hz: 500.0, corners: 1, truth_known: true };

/// The JSON the page carries.
fn embedded(page: &str) -> serde_json::Value {
    let start = page.find("id=\"report-data\">").unwrap() + "id=\"report-data\">".len();
    let end = start + page[start..].find("</script>").unwrap();
    serde_json::from_str(&page[start..end]).unwrap()
}

/// Opening and closing tags outside scripts and styles must pair up.
fn assert_balanced(page: &str) {
    let mut stack: Vec<String> = Vec::new();
    let mut rest = page;
    while let Some(open) = rest.find('<') {
        rest = &rest[open + 1..];
        if rest.starts_with('!') {
            continue;
        }
        let name: String =
            rest.chars().skip_while(|c| *c == '/').take_while(|c| c.is_ascii_alphanumeric()).collect();
        if rest.starts_with('/') {
            assert_eq!(stack.pop().as_deref(), Some(name.as_str()), "near {}", &rest[..rest.len().min(60)]);
        } else if !matches!(name.as_str(), "meta" | "br" | "input" | "link" | "img") {
            if name == "script" || name == "style" {
                let end = rest.find(&format!("</{name}>")).unwrap();
                rest = &rest[end + name.len() + 3..];
                continue;
            }
            stack.push(name);
        }
    }
    assert!(stack.is_empty(), "left open: {stack:?}");
}

#[test]
fn says_in_words_what_was_found() {
    let page = render_report(&report(&PAPER, "sedan")).unwrap();
    let title = &page[page.find("<title>").unwrap() + 7..page.find("</title>").unwrap()];
    assert!(title.starts_with("Front left fell to 1") && title.contains("kPa: low since 2"), "{title}");
    assert!(page.contains(&format!("<h1>{title}</h1>")));
    for word in
        ["RMSE", "Bias", "Coverage", "Road class", "Roughness (IRI)", "itpms 0.1.0", "missing samples"]
    {
        assert!(page.contains(word), "{word}");
    }
    assert!(!page.contains("NaN") || page.find("NaN") > page.find("id=\"report-data\""), "NaN in the text");
}

#[test]
fn needs_no_network_and_no_other_file() {
    let page = render_report(&report(&PAPER, "sedan")).unwrap().to_lowercase();
    for attribute in ["src=", "href=\"http", "href='http", "url(http", "@import", "<link", "<iframe", "<img"]
    {
        assert!(!page.contains(attribute), "{attribute}");
    }
    assert!(page.contains("default-src 'none'"));
    assert!(page.contains("prefers-color-scheme"));
    assert!(page.contains("copyright (c) 2022 leon sorokin"), "the plot library's license travels with it");
}

#[test]
fn hostile_names_stay_text() {
    let name = "</script><script>alert(1)</script> & \"sons\" {{style}}";
    let page = render_report(&report(&PAPER, name)).unwrap();
    assert!(!page.contains("<script>alert"));
    assert!(
        page.contains(
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;sons&quot; {{style}}"
        )
    );
    assert_balanced(&page);
}

#[test]
fn the_data_is_all_there_and_small() {
    let data = report(&PAPER, "sedan");
    let page = render_report(&data).unwrap();
    let json = embedded(&page);
    let t = json["t"].as_array().unwrap();
    assert!(t.len() > 1000 && t.len() <= 4200);
    assert_eq!(json["corners"].as_array().unwrap().len(), 1);
    let time = &json["corners"][0]["time"];
    for curve in [
        "p",
        "lo",
        "hi",
        "truth",
        "sd",
        "error",
        "bound",
        "boundLo",
        "boundHi",
        "forgetting",
        "nis",
        "nisMean",
        "gate",
        "change",
    ] {
        assert_eq!(time[curve].as_array().unwrap().len(), t.len(), "{curve}");
    }
    let road = &json["corners"][0]["road"];
    assert_eq!(road["x"].as_array().unwrap().len(), road["z"].as_array().unwrap().len());
    assert_eq!(road["psd"]["fit"]["class"], "A");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    assert_balanced(&page);
    let mut written = Vec::new();
    write_report(&mut written, &data).unwrap();
    assert_eq!(written, page.as_bytes());
}

#[test]
fn figures_agree_with_sums_over_the_curves() {
    let data = report(&PAPER, "sedan");
    let corner = &data.corners[0];
    let truth = corner.figures.truth.unwrap();
    // The drawn curve is the extremes of 0.02 s: its rms error is the samples' within a few per cent.
    let late = data.time_s.iter().zip(corner.curves.pressure_kpa.iter().zip(&corner.curves.truth_kpa));
    let errors: Vec<f64> = late.filter(|(t, _)| **t > 3.0).map(|(_, (p, q))| p - q).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((truth.rmse_kpa / rms - 1.0).abs() < 0.05, "{} {rms}", truth.rmse_kpa);
    assert_eq!(truth.samples, 18_499);
    assert!((data.drive.rate_hz - 500.0).abs() < 1e-6);
    assert!((data.drive.distance_m - 222.2).abs() < 0.1);
    let road = corner.road.as_ref().unwrap();
    // The invented road is of class A with w = 2; the record holds three segments and a half.
    assert!((road.truth_fit.unwrap().law.waviness - 2.0).abs() < 0.25);
    assert!((road.truth_fit.unwrap().law.gd_n0_m3 / 16e-6).ln().abs() < 0.7);
    assert!(road.relative_error.unwrap() < 0.5);
    // The bound: 36 kPa sqrt(s) from a prior of 30 kPa, so below 9 after 20 s and above 3.
    let before = data.time_s.iter().position(|t| *t > 19.9).unwrap();
    assert!((3.0..9.0).contains(&corner.curves.bound_sd_kpa[before]));
}

#[test]
fn without_truth_or_speed_the_page_says_less_and_stays_whole() {
    let data = report(&Drive { truth_known: false, ..PAPER }, "sedan");
    assert!(data.corners[0].figures.truth.is_none() && data.corners[0].curves.truth_kpa.is_empty());
    let page = render_report(&data).unwrap();
    assert!(!page.contains("RMSE") && !page.contains(">Bias<"));
    assert_balanced(&page);
}

#[test]
fn a_missing_value_is_null() {
    let mut data = report(&PAPER, "sedan");
    data.corners[0].curves.pressure_kpa[7] = f64::NAN;
    data.corners[0].curves.sd_kpa[9] = f64::INFINITY;
    let json = embedded(&render_report(&data).unwrap());
    let time = &json["corners"][0]["time"];
    assert!(time["p"][7].is_null() && time["sd"][9].is_null() && time["p"][8].is_number());
}

#[test]
fn four_corners_and_a_stop() {
    let data = report(&Drive { corners: 4, ..PAPER }, "sedan");
    let page = render_report(&data).unwrap();
    let json = embedded(&page);
    assert_eq!(json["corners"].as_array().unwrap().len(), 4);
    for name in ["Front left", "Front right", "Rear left", "Rear right"] {
        assert!(page.contains(&format!("<h2>{name}")), "{name}");
    }
    // The stop from 32 to 34 s is no information, and the bound does not fall during it.
    let runs = json["corners"][1]["time"]["validity"].as_array().unwrap();
    let stop = runs.iter().find(|run| run[2] == 2).unwrap();
    assert!(
        (stop[0].as_f64().unwrap() - 32.0).abs() < 0.05 && (stop[1].as_f64().unwrap() - 34.0).abs() < 0.05
    );
    let at = |t: f64| data.corners[1].curves.bound_sd_kpa[data.time_s.iter().position(|x| *x >= t).unwrap()];
    assert!(at(33.9) >= at(32.1));
    assert_balanced(&page);
}

#[test]
fn a_page_without_any_row_is_still_a_page() {
    let data = report(&Drive { seconds: 0.0, ..PAPER }, "sedan");
    let page = render_report(&data).unwrap();
    assert!(page.contains("not enough was seen"));
    assert_balanced(&page);
}
