//! The first delay of a side.

use core::f64::consts::TAU;

use crate::belief::state::State;
use crate::inter_axle::alignment::axle_pair::{AxlePair, PairingContext};
use crate::inter_axle::alignment::channel::Entry;
use crate::inter_axle::alignment::delay_search::Found;
use crate::inter_axle::alignment::way::Way;
use crate::inter_axle::tests::{PERIOD_S, wheels};
use crate::memory::{Blank, configured};
use crate::model::Side;

const WHEELBASE_M: f64 = 2.7;
const SPEED_M_S: f64 = 9.0;
/// The real wheelbase is longer than the file's by this share.
const LONGER: f64 = 0.02;

/// Vertical velocity of a wheel on a road of waves from 0.6 to 6 m, at this way.
fn velocity(distance_m: f64) -> f64 {
    (1..30)
        .map(|k| {
            (TAU * distance_m * f64::from(k) / 9.0 * (1.0 + 0.01 * f64::from(k)) + f64::from(k * k)).sin()
        })
        .sum()
}

fn entry(step: u32, wheel_m: f64) -> Entry<f64> {
    let time_s = f64::from(step) * PERIOD_S;
    let distance_m = SPEED_M_S * time_s;
    Entry {
        time_s,
        way: Some(Way::BLANK.ahead(distance_m)),
        speed_m_s: SPEED_M_S,
        // A wheel that no force deforms runs on the road itself.
        signals: [velocity(distance_m + wheel_m), 0.0, 0.0, 0.0],
        invalid: false,
        unloaded: false,
        after_gap: false,
    }
}

/// What a side finds whose car is believed to have this deviation of its wheelbase, by time.
fn find(believed: impl Fn(f64) -> f64) -> Found<f64> {
    let mut track = configured(|pair: &mut AxlePair<f64>| pair.configure(Side::Left, PERIOD_S, [0.0; 2]));
    let state = State::zeros();
    for step in 0..1500 {
        let (front, rear) = (entry(step, WHEELBASE_M * (1.0 + LONGER)), entry(step, 0.0));
        let road = PairingContext {
            wheelbase_m: WHEELBASE_M,
            wheels: wheels(),
            wheelbase: believed(rear.time_s),
            skew: 0.0,
            state: &state,
        };
        track.front(&front);
        if let Some(found) = track.search(&rear, &road) {
            return found;
        }
    }
    unreachable!("nothing found")
}

#[test]
fn a_side_finds_how_much_longer_the_car_is() {
    let found = find(|_| 0.0);
    let later_s = WHEELBASE_M * LONGER / SPEED_M_S;
    // A parabola through three shifts, 1.1 ms apart.
    assert!((found.later_s - later_s).abs() < 1e-4, "{} s, {later_s} s", found.later_s);
    assert_eq!(found.used, [0.0; 2]);
}

/// The other side may find it first, in the middle of this side's search or in its last moment: what is found here must not count
/// from what is believed then.
#[test]
fn what_the_other_side_finds_is_not_found_twice() {
    let alone = find(|_| 0.0);
    for found_s in [1.0, 1.2, 1.8] {
        let found = find(|time_s| if time_s > found_s { LONGER } else { 0.0 });
        assert_eq!((found.later_s, found.used), (alone.later_s, [0.0; 2]), "other side at {found_s} s");
    }
}
