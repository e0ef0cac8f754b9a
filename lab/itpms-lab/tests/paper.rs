//! The paper's study seen from outside: what diverges is shown, what is asked to stop stops.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use itpms_lab::paper::{Request, reproduce};
use itpms_lab::runner::{StudyError, UNWATCHED};

#[test]
fn what_diverges_is_shown_as_diverged() {
    // With this noise the published forgetting factor lets the stiffness walk until the filter is lost, within seconds.
    let request = Request { seeds: 1, noise_m_s2: 0.5, rate_hz: 500.0, ..Request::default() };
    let study = reproduce(&request, UNWATCHED).unwrap();
    let files = study.files().unwrap();
    let file = |name: &str| &files.iter().find(|file| file.name == name).unwrap().content;
    let svg = file("figure-07.svg");
    assert!(svg.contains(">aekf-ui diverges</text>") && svg.contains(">aekf-ui (diverges)</text>"));
    let errors = file("figure-07-errors.csv");
    let row = |who: &str| {
        let line = errors.lines().find(|line| line.contains(&format!(",{who},"))).unwrap();
        line.split(',').map(str::to_owned).collect::<Vec<_>>()
    };
    let column =
        errors.lines().next().unwrap().split(',').position(|name| name == "diverged_drives").unwrap();
    assert_eq!((row("aekf-ui")[column].as_str(), row("informed")[column].as_str()), ("1", "0"));
    // The median error of a diverged filter is no number; that of the default is one.
    assert_eq!(row("aekf-ui")[3], "");
    assert!(row("informed")[3].parse::<f64>().unwrap() > 0.0);
    // In the histories the diverged one ends, the others go on.
    let last = file("figure-07.csv").lines().last().unwrap().split(',').collect::<Vec<_>>();
    let place = |name: &str| {
        file("figure-07.csv").lines().next().unwrap().split(',').position(|c| c == name).unwrap()
    };
    assert_eq!(last[place("aekf_ui_pressure_kpa")], "");
    assert!(last[place("informed_pressure_kpa")].parse::<f64>().unwrap() > 0.0);
    assert!(file("index.html").contains("<td class=\"n\">diverged</td>"));
}

#[test]
fn a_break_ends_the_study() {
    let reported = AtomicU64::new(0);
    let stop = |_, _| {
        reported.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Break(())
    };
    let request = Request { seeds: 1000, ..Request::default() };
    assert!(matches!(reproduce(&request, &stop), Err(StudyError::Stopped)));
    // One word per processor at most.
    assert!(reported.load(Ordering::Relaxed) < 1000);
}

#[test]
fn statistics_of_nothing_are_refused() {
    let request = Request { seeds: 0, ..Request::default() };
    let error = reproduce(&request, UNWATCHED).unwrap_err();
    assert_eq!(error.to_string(), "0 seeds, expected at least one");
}
