//! Dampers and load on the page, as a reader's browser gets it.

use crate::synthetic::{self, Drive};

use itpms_analysis::report::{ReportData, render_report};
use itpms_analysis::suspension::{
    Because, DamperHealth, DamperState, Load, LoadState, Masses, Measured, SuspensionVerdict,
};

fn measured(value: f64, sd: f64) -> Option<Measured> {
    Some(Measured { value, sd })
}

fn damper(state: DamperState, over: f64, left_right: f64) -> DamperHealth {
    DamperHealth {
        damping_n_s_per_m: measured(1500.0 * over, 150.0),
        over_reference: measured(over, 0.06),
        left_right: measured(left_right, 0.02),
        front_rear: measured(0.01, 0.03),
        wheel_damping_ratio: measured(0.21, 0.02),
        state,
        because: None,
    }
}

fn unknown(because: Because) -> DamperHealth {
    DamperHealth {
        damping_n_s_per_m: None,
        over_reference: None,
        left_right: None,
        front_rear: None,
        wheel_damping_ratio: None,
        state: DamperState::Unknown,
        because: Some(because),
    }
}

fn load() -> Load {
    let of = |value, sd| Measured { value, sd };
    let masses = Masses {
        axles_kg: [of(812.0, 18.0), of(905.0, 20.0)],
        total_kg: of(1717.0, 34.0),
        added_kg: of(241.0, 34.0),
    };
    Load { masses: Some(masses), state: LoadState::Known, because: None, gross_axle_kg: None }
}

fn no_load(because: Because) -> Load {
    Load { masses: None, state: LoadState::Unknown, because: Some(because), gross_axle_kg: None }
}

/// The section alone, with spaces that may break, and whether the page leads to it.
fn section(dampers: [DamperHealth; 4], load: Load) -> (String, bool) {
    let drive = Drive { seconds: 5.0, rate_hz: 200.0, corners: 4, truth_known: false };
    let mut data: ReportData = synthetic::report(&drive, "sedan");
    data.suspension = Some(SuspensionVerdict { dampers, load, learned: None, usable_s: 100.0 });
    let page = render_report(&data).unwrap();
    let from = page.find(" id=\"suspension\"").unwrap();
    let to = from + page[from..].find("id=\"roads\"").unwrap();
    (page[from..to].replace('\u{a0}', " "), page.contains("href=\"#suspension\""))
}

#[test]
fn a_worn_damper_and_the_load_are_cards_with_their_standard_deviations() {
    use DamperState::{Fine, Worn};
    let dampers = [
        damper(Fine, 1.02, 0.01),
        damper(Fine, 1.01, 0.01),
        damper(Worn, 0.49, -0.51),
        damper(Fine, 1.0, -0.51),
    ];
    let (page, linked) = section(dampers, load());
    assert!(linked);
    for text in [
        "The rear left damper damps less than it should. If further drives say the same",
        "Rear left</p><span class=\"badge worn\">Worn",
        "49 %<small>± 6 %",
        "735 ± 150 N s/m",
        "damping ratio 0.21 ± 0.02",
        "Front axle: left and right are alike, 1 ± 2 % apart",
        "Rear axle: left damps 51 ± 2 % less than right",
        "1717 kg<small>± 34 in all",
        "241 ± 34 kg more than in the calibration drive",
        "Rear axle <b>905 ± 20 kg",
    ] {
        assert!(page.contains(text), "{text}: {page}");
    }
    assert!(!page.contains("carries more") && !page.contains("Front and rear"));
}

#[test]
fn an_axle_that_carries_too_much_is_named() {
    let dampers = [damper(DamperState::Fine, 1.0, 0.0); 4];
    // 905 less 1.645 times 20 is 872.
    let of = |rear| Load { state: LoadState::Overload, gross_axle_kg: Some([1050.0, rear]), ..load() };
    let (page, _) = section(dampers, of(870.0));
    for text in [
        "All four dampers do what they did",
        "Front and rear have changed alike since the calibration, 1 ± 3 % apart",
        "The rear axle carries more than it may",
        "of 870 kg",
        ">Overload<",
    ] {
        assert!(page.contains(text), "{text}: {page}");
    }
    assert!(!page.contains("front axle carries"));
    assert!(!section(dampers, of(875.0)).0.contains("carries more"));
}

#[test]
fn what_is_not_known_is_one_line_with_its_reason() {
    let (page, _) = section([unknown(Because::Smooth); 4], no_load(Because::Smooth));
    assert!(page.contains("Dampers and load: not judged: the road was so smooth"), "{page}");
    assert!(!page.contains("card"), "{page}");
    // Without a calibration left is known against right all the same.
    let alone = DamperHealth {
        over_reference: None,
        front_rear: None,
        because: Some(Because::NoReference),
        ..damper(DamperState::Unknown, 1.0, -0.3)
    };
    let (page, _) = section([alone; 4], no_load(Because::NoReference));
    assert!(page.contains("a calibration of this car is needed"), "{page}");
    assert!(page.contains("Rear axle: left damps 30 ± 2 % less than right."), "{page}");
    // One of the two is known: the other says why not.
    let adaptive =
        DamperHealth { because: Some(Because::Adaptive), ..damper(DamperState::Unknown, 1.0, 0.0) };
    let (page, _) = section([adaptive; 4], load());
    assert!(page.contains("adaptive") && page.contains("1717 kg"), "{page}");
}
