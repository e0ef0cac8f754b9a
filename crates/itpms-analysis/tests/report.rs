//! The report as a reader's browser gets it.

use crate::synthetic;

use itpms_analysis::report::{
    CornerRow, Provenance, ReportCollector, ReportData, ReportOptions, headline, render_report,
};
use itpms_core::conditioning::SampleClock;
use itpms_core::model::{
    CarConfig, CarEstimate, Corner, CornerConfig, CornerEstimate, Diagnostics, Level, PressureUnit,
    TrackState, Validity, Warning,
};
use itpms_core::monitor::{Monitor, MonitorConfig};
use itpms_core::warning::{Doubt, WheelState};
use synthetic::{Drive, report};

const PAPER: Drive = Drive { seconds: 40.0, rate_hz: 500.0, corners: 1, truth_known: true };

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
            if rest[..rest.find('>').unwrap()].ends_with('/') {
                continue;
            }
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
    let data = report(&PAPER, "sedan");
    let page = render_report(&data).unwrap();
    let title = &page[page.find("<title>").unwrap() + 7..page.find("</title>").unwrap()];
    assert!(
        title.starts_with("Front left fell to 1") && title.contains("kPa: low, warned of at 2"),
        "{title}"
    );
    assert!(page.contains(&format!("<h1>{title}</h1>")) && headline(&data) == title);
    for word in
        ["RMSE", "Bias", "Coverage", "Road class", "Roughness (IRI)", "itpms 0.1.0", "missing samples"]
    {
        assert!(page.contains(word), "{word}");
    }
    assert!(!page.contains("NaN") || page.find("NaN") > page.find("id=\"report-data\""), "NaN in the text");
}

#[test]
fn says_what_rests_on_which_parameter() {
    let mut data = report(&PAPER, "sedan");
    let row = |page: &str, name: &str| {
        let from = page.find(&format!("<th scope=\"row\">{name}")).unwrap();
        page[from..].split_once("</tr>").unwrap().0.to_owned()
    };
    // Calibrated, a hundredth of 48.3 kPa; the paper's corner is known to 1.5 and 1 %: 1.8 % of those.
    let page = render_report(&data).unwrap();
    let mass = row(&page, "Unsprung mass");
    assert!(
        mass.contains("56.90 ± 0.85") && mass.contains("1 % of it is 0.5 kPa of a loss of a fifth"),
        "{mass}"
    );
    assert!(mass.contains("&lt;the file&gt;"), "{mass}");
    assert!(row(&page, "Slope of stiffness").contains("1 % of it is 0.5 kPa of a loss of a fifth"));
    assert!(row(&page, "Tire stiffness over unsprung mass").contains("0.9 kPa (sd) of a loss of a fifth"));
    // By the file, 1 % of 241.3 kPa + 60880/713.91 kPa, and 1.8 % of them.
    data.corners[0].level = Some(Level::VehicleFile);
    let page = render_report(&data).unwrap();
    assert!(row(&page, "Unsprung mass").contains("1 % of it is 3.3 kPa<"));
    assert!(row(&page, "Tire stiffness over unsprung mass").contains("6 kPa (sd), until a calibration"));
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
    let curves = "p notValid lo hi truth sd error bound boundLo boundHi forgetting nis nisMean gate change";
    for curve in curves.split(' ') {
        assert_eq!(time[curve].as_array().unwrap().len(), t.len(), "{curve}");
    }
    let road = &json["corners"][0]["road"];
    assert_eq!(road["x"].as_array().unwrap().len(), road["z"].as_array().unwrap().len());
    assert_eq!(road["psd"]["fit"]["class"], "A");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    assert_balanced(&page);
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
    // In the middle of a drive, where the estimate has begun to be valid.
    data.corners[0].curves.pressure_kpa[1007] = f64::NAN;
    data.corners[0].curves.sd_kpa[9] = f64::INFINITY;
    let json = embedded(&render_report(&data).unwrap());
    let time = &json["corners"][0]["time"];
    assert!(time["p"][1007].is_null() && time["sd"][9].is_null() && time["p"][1008].is_number());
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

/// Four wheels under a monitor, made of nothing but numbers: front left loses 100 kPa at 30 s, the others hold.
fn monitored(origin_s: f64) -> ReportData {
    let corners = [Some(CornerConfig::paper()); 4];
    let car = CarConfig { corners, wheelbase_m: Some(2.7) };
    let mut monitor = Monitor::new(&MonitorConfig::new(&car), 100.0).unwrap();
    let mut clock = SampleClock::new(100.0).unwrap();
    let mut collector = ReportCollector::new(&corners, ReportOptions::default());
    for k in 0..6000u32 {
        let time_s = origin_s + f64::from(k) * 0.01;
        // The pressures are made up, so there are no sensors to be screened.
        let estimate = |pressure_kpa| Some(steady_estimate(time_s, pressure_kpa, Validity::Valid));
        let fallen = if k < 3000 { 240.0 } else { 140.0 };
        let mut estimate = CarEstimate {
            time_s,
            corners: [estimate(fallen), estimate(240.0), estimate(240.0), estimate(240.0)],
            correlation: [[0.0; 4]; 4],
            loss_correlation: [[0.0; 4]; 4],
            tracks: [TrackState { shared: false, incoherence: f64::NAN }; 2],
        };
        monitor.judge(&clock.take(time_s, f64::NAN), &mut estimate);
        collector.push_report(monitor.report());
        let nan = f64::NAN;
        let row = |estimate| CornerRow { estimate, truth_kpa: nan, truth_road_m: nan, sensor_kpa: nan };
        collector.push(time_s, 20.0, &estimate.corners.map(|corner| corner.map(row)));
    }
    collector.finish(Provenance::default())
}

#[test]
fn a_wheel_that_is_not_estimated_is_in_the_title() {
    let mut data = monitored(0.0);
    data.corners.remove(0);
    assert!(headline(&data).starts_with("All 3 tires are fine"), "{}", headline(&data));
    data.not_estimated = vec![Corner::FrontLeft];
    assert_eq!(headline(&data), "3 tires are fine; front left is not estimated");
    data.not_estimated.push(Corner::RearLeft);
    data.corners.remove(1);
    data.corners.remove(1);
    let title = headline(&data);
    assert!(title.ends_with("; front left, rear left are not estimated"), "{title}");
}

#[test]
fn what_the_monitor_said_is_a_table_and_a_time_line() {
    for origin_s in [0.0, 1.7e9] {
        let data = monitored(origin_s);
        let watch = data.watch.as_ref().unwrap();
        assert_eq!(watch.last[0], Some(WheelState::Low));
        assert_eq!(watch.last[1..], [Some(WheelState::Fine); 3]);
        let low = watch.alerts.iter().find(|span| span.alert.cause.label() == "under-inflated").unwrap();
        // Reported within seconds of the loss, in the report's time, and standing at the end.
        assert!(low.alert.wheels.contains(Corner::FrontLeft) && low.ended_s.is_none());
        assert!((30.0..35.0).contains(&low.alert.reported_s), "{low:?}");
        let page = render_report(&data).unwrap();
        assert!(page.contains("</span> 140 ± 4 kPa then"), "the table says why");
        assert!(page.contains("class=\"tire low\"") && page.matches("class=\"tire fine\"").count() == 3);
        // One state, one word: on the card, its section and beside the tire.
        assert_eq!(page.matches("\"badge fine\">Fine<").count(), 6);
        assert_eq!(page.matches(">fine</text>").count(), 3);
        // When it was reported is the same moment wherever it stands; `since` is the table's alone.
        let reported = moment(low.alert.reported_s);
        assert!(page.contains(&format!("low, warned of at {reported}")), "{reported}");
        assert!(page.contains(&format!("<span>warned of at {reported}</span>")), "{reported}");
        assert!(page.contains(&format!("data-label=\"warned of at\">{reported}</td>")), "{reported}");
        let json = embedded(&page);
        assert_eq!(json["alerts"][0]["wheels"][0], "fl");
        let states = json["corners"][0]["state"].as_array().unwrap();
        let last = states.last().unwrap();
        assert!(last[2] == 5 && (last[1].as_f64().unwrap() - 59.99).abs() < 0.2, "{states:?}");
        assert_balanced(&page);
    }
}

/// A time below 100 s as the page writes it.
fn moment(time_s: f64) -> String {
    format!("{time_s:.1}\u{a0}s").replace(".0\u{a0}", "\u{a0}")
}

/// No one can go by a pressure that could be low as well: no wheel of these is called fine.
#[test]
fn a_wheel_that_is_not_known_says_so_and_why() {
    let mut data = monitored(0.0);
    for (corner, doubt) in
        data.corners[1..].iter_mut().zip([Doubt::Uncertain, Doubt::Misfit, Doubt::Starting])
    {
        corner.state = Some(WheelState::Unknown(doubt));
    }
    let why: Vec<_> = data.corners.iter().map(|corner| corner.doubt()).collect();
    assert_eq!(why[0], None);
    let page = render_report(&data).unwrap();
    assert_eq!(page.matches("\"badge unknown\">Unknown<").count(), 4);
    assert_eq!(page.matches("\"badge unknown\">Uncertain<").count(), 2);
    assert_eq!((page.matches(">unknown</text>").count(), page.matches(">uncertain</text>").count()), (2, 1));
    for why in why.iter().flatten() {
        assert!(page.contains(&format!("<span>{why}</span>")), "{why}");
    }
    assert!(page.contains(
        "Front right is at 240\u{a0}±\u{a0}4\u{a0}kPa: uncertain, too uncertain to rule out a loss."
    ));
    assert_balanced(&page);
}

/// A corner that holds 230 kPa on a road that is one slow sine.
fn steady_from(start_s: f64, seconds: f64, rate_hz: f64, speed_m_s: f64, validity: Validity) -> ReportData {
    let configs = [Some(CornerConfig::paper()), None, None, None];
    let mut collector = ReportCollector::new(&configs, ReportOptions::default());
    for k in 0..(seconds * rate_hz) as u64 {
        let time_s = start_s + k as f64 / rate_hz;
        let estimate = steady_estimate(time_s, if k == 1000 { 90.0 } else { 230.0 }, validity);
        let row = CornerRow { estimate, truth_kpa: f64::NAN, truth_road_m: f64::NAN, sensor_kpa: f64::NAN };
        collector.push(time_s, speed_m_s, &[Some(row), None, None, None]);
    }
    collector.finish(Provenance::default())
}

/// Ten minutes at 230 kPa beside a sensor that sends `sent_kpa` (NaN: nothing) at whole minutes, or in every row.
fn beside_a_sensor(held: bool, sent_kpa: impl Fn(usize) -> f64) -> ReportData {
    let configs = [Some(CornerConfig::paper()), None, None, None];
    let mut collector = ReportCollector::new(&configs, ReportOptions::default());
    for k in 0..6000usize {
        let time_s = k as f64 * 0.1;
        let estimate = steady_estimate(time_s, 230.0, Validity::Valid);
        let sensor_kpa = if held || k % 600 == 0 { sent_kpa(k / 600) } else { f64::NAN };
        let row = CornerRow { estimate, truth_kpa: f64::NAN, truth_road_m: f64::NAN, sensor_kpa };
        collector.push(time_s, 20.0, &[Some(row), None, None, None]);
    }
    collector.finish(Provenance::default())
}

#[test]
fn a_tires_own_sensor_is_shown_and_one_that_contradicts_for_good_is_named() {
    let sensor = |held, sent: &dyn Fn(usize) -> f64| beside_a_sensor(held, sent).corners[0].tire_sensor;
    // An sd of 4 and one of 7 are 8.1 together: 20 kPa are no contradiction, 40 are.
    let agrees = sensor(false, &|minute| if minute == 3 { 190.0 } else { 210.0 }).unwrap();
    assert_eq!((agrees.time_s, agrees.pressure_kpa, agrees.contradicts_since_s), (540.0, 210.0, None));
    for held in [false, true] {
        let wrong = sensor(held, &|minute| if minute < 5 { 225.0 } else { 190.0 }).unwrap();
        assert_eq!((wrong.pressure_kpa, wrong.contradicts_since_s), (190.0, Some(300.0)));
    }
    // A minute is not for good: the tire may be ahead of its sensor.
    assert_eq!(
        sensor(false, &|minute| if minute < 9 { 225.0 } else { 190.0 }).unwrap().contradicts_since_s,
        None
    );
    // Nor is a sensor that has sent only once.
    assert_eq!(
        sensor(false, &|minute| if minute == 0 { 190.0 } else { f64::NAN }).unwrap().contradicts_since_s,
        None
    );
    assert_eq!(sensor(false, &|_| f64::NAN), None);

    let data = beside_a_sensor(false, |_| 190.0);
    let page = render_report(&data).unwrap();
    assert!(page.contains("190.0 kPa at") && page.contains("contradicts the estimate since"));
    let words = data.corners[0].tire_sensor.unwrap().contradiction(230.0, 4.0, data.pressure_unit).unwrap();
    assert!(
        words.starts_with("the tire's own sensor sends 190 kPa, the estimate is 230 with an sd of 4"),
        "{words}"
    );
    assert!(!render_report(&beside_a_sensor(false, |_| f64::NAN)).unwrap().contains("Tire sensor"));
}

fn steady_estimate(time_s: f64, pressure_kpa: f64, validity: Validity) -> CornerEstimate<f64> {
    CornerEstimate {
        time_s,
        stiffness_n_per_m: 225_000.0,
        stiffness_sd_n_per_m: 3_000.0,
        pressure_kpa,
        pressure_sd_kpa: 4.0,
        change_sd_kpa: 4.0,
        axle_difference_sd_kpa: None,
        loss: None,
        cold: None,
        level: Level::Calibration,
        road_m: 0.01 * (time_s * 9.0).sin(),
        road_sd_m: 5e-4,
        validity,
        warning: Warning::None,
        diagnostics: Diagnostics {
            forgetting: 1.0,
            nis: 1.0,
            gate: 1.0,
            change_probability: f64::NAN,
            pressure_variance_kpa2: 16.0,
        },
    }
}

fn steady(seconds: f64, rate_hz: f64, speed_m_s: f64, validity: Validity) -> ReportData {
    steady_from(0.0, seconds, rate_hz, speed_m_s, validity)
}

#[test]
fn times_since_an_epoch_are_shown_from_the_first_row_on() {
    let data = steady_from(1.7e9, 10.0, 200.0, 10.0, Validity::Valid);
    assert_eq!(data.drive.origin_s, 1.7e9);
    assert!(data.time_s[0] == 0.0 && (data.time_s[data.time_s.len() - 1] - 9.995).abs() < 1e-6);
    assert!((data.drive.distance_m - 99.95).abs() < 1e-3);
    assert!(render_report(&data).unwrap().contains("time_s = 1700000000"));
}

#[test]
fn a_long_drive_makes_no_longer_page() {
    // Two hours at 108 km/h and 100 Hz: 720 000 samples, 216 km.
    let data = steady(7200.0, 100.0, 30.0, Validity::Valid);
    assert!((data.drive.distance_m - 216_000.0).abs() < 1.0);
    assert!(data.time_s.len() <= 4001);
    let corner = &data.corners[0];
    let road = corner.road.as_ref().unwrap();
    assert!(road.profile.distance_m.len() <= 4001 && road.roughness.distance_m.len() <= 500);
    // The one odd sample is still there.
    assert_eq!(corner.curves.pressure_kpa.iter().copied().fold(f64::MAX, f64::min), 90.0);
    assert!(corner.curves.change_probability.is_empty());
    let page = render_report(&data).unwrap();
    assert!(page.len() < 600_000, "{} bytes", page.len());
    assert!(page.contains("Front left held 230\u{a0}±\u{a0}4\u{a0}kPa: fine"));
}

#[test]
fn without_speed_there_is_no_road_and_without_validity_no_pressure() {
    let data = steady(10.0, 200.0, f64::NAN, Validity::Valid);
    assert!(data.corners[0].road.is_none() && data.drive.distance_m.is_nan());
    let page = render_report(&data).unwrap();
    assert!(page.contains("No road is shown") && !page.contains("NaN"));
    let data = steady(10.0, 200.0, 5.0, Validity::NoInformation);
    let curves = &data.corners[0].curves;
    assert!(curves.pressure_kpa.is_empty() && curves.band_kpa.iter().all(Vec::is_empty));
    assert_eq!(curves.not_valid_kpa.len(), data.time_s.len());
    let page = render_report(&data).unwrap();
    assert!(page.contains("Front left: not enough was seen for a pressure"));
}

#[test]
fn a_page_without_any_row_is_still_a_page() {
    let data = report(&Drive { seconds: 0.0, ..PAPER }, "sedan");
    let page = render_report(&data).unwrap();
    assert!(page.contains("not enough was seen"));
    assert_balanced(&page);
}

#[test]
fn every_pressure_on_the_page_is_in_the_unit_that_was_asked_for() {
    let mut data = monitored(0.0);
    for unit in PressureUnit::ALL {
        data.pressure_unit = unit;
        let page = render_report(&data).unwrap();
        let (_, body) = page.split_once("<body").unwrap();
        let (text, script) = body.split_once("id=\"report-data\"").unwrap();
        let others = PressureUnit::ALL.into_iter().filter(|other| *other != unit);
        for other in others {
            // A tire's slope is the vehicle file's own key.
            let text = text.replace("N/m per kPa", "");
            assert!(!text.contains(other.symbol()), "{unit}: {other}");
        }
        // 241.3 kPa on the placard, and the 140 kPa that the first tire fell to.
        let [placard, low] = match unit {
            PressureUnit::Kpa => ["placard 241 kPa", "140"],
            PressureUnit::Bar => ["placard 2.41 bar", "1.40"],
            PressureUnit::Psi => ["placard 35.0 psi", "20.3"],
        };
        assert!(text.contains(placard) && headline(&data).contains(low), "{}", headline(&data));
        // Output for scripts stays in kPa.
        assert!(script.contains("\"placard\":241.3,"));
    }
}
