//! A made-up car for work on the page: four tires, a road, and whatever one types.
//!
//! `cargo run -p itpms-live --example made_up_car -- 127.0.0.1:8080 [SPEED]`, then lines on standard input:
//! `low fl`, `over rr`, `malfunction rl`, `unknown fr`, `fine fl` (a wheel's state), `stale`, `end`, `live` (the source),
//! `freeze` (the monitor itself hangs), `back S` (the source's clock is set back by S seconds), `hostile` (names that someone with bad
//! intentions chose), `quit`. SPEED is how much faster the car's clock runs than ours. Nothing here is an estimate.

use std::error::Error;
use std::io::BufRead as _;
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use itpms_live::http::{Options, Server};
use itpms_live::hub::Hub;
use itpms_live::snapshot::{Latency, SensorHealth, Snapshot, Source, SourceState, Track, Transition, Wheel};
use serde_json::{Map, Value, json};

const CORNERS: [&str; 4] = ["fl", "fr", "rl", "rr"];
const STATES: [&str; 5] = ["unknown", "fine", "low", "over", "malfunction"];
/// Markup, a line break, a terminal's escape, a change of direction, and more letters than a line has.
const HOSTILE: &str = "<img src=x onerror=window.taken=1><script>window.taken=1</script>\n\u{1b}[2J\u{202e}egnar-\u{9b}31m-\
    aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa";
const SPEED_M_S: f64 = 22.2;
/// Between two snapshots, on our clock.
const PACE: Duration = Duration::from_millis(10);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let address = arguments.next().unwrap_or("127.0.0.1:8080".to_owned()).parse()?;
    let speed: f64 = arguments.next().map_or(Ok(1.0), |text| text.parse())?;
    let hub = Hub::new();
    let server = Server::start(Options::new(address), Arc::clone(&hub))?;
    println!("http://{}/", server.address());
    let (lines, typed) = mpsc::channel();
    std::thread::spawn(move || {
        std::io::stdin().lock().lines().map_while(Result::ok).try_for_each(|line| lines.send(line))
    });
    let mut car = Car::new();
    let begun = Instant::now();
    loop {
        while let Ok(line) = typed.try_recv() {
            match line.split_whitespace().collect::<Vec<_>>()[..] {
                ["quit"] => return Ok(()),
                ["freeze"] => car.frozen = true,
                ["hostile"] => car.name = HOSTILE,
                ["back", seconds] => car.back_s += seconds.parse::<f64>().unwrap_or(0.0),
                ["live"] => (car.frozen, car.source) = (false, SourceState::Live),
                ["stale"] => car.source = SourceState::Stale,
                ["end"] => car.source = SourceState::Ended,
                [state, corner] => car.turn(&hub, state, corner),
                _ => eprintln!("not understood: {line}"),
            }
        }
        if !car.frozen {
            car.advance(begun.elapsed().as_secs_f64() * speed - car.back_s);
            hub.publish(Arc::new(car.snapshot()));
        }
        std::thread::sleep(PACE);
    }
}

struct Car {
    name: &'static str,
    back_s: f64,
    seq: u64,
    transitions: u64,
    time_s: f64,
    unix_s: f64,
    source: SourceState,
    frozen: bool,
    states: [&'static str; 4],
    since_s: [f64; 4],
    alerts: Vec<Map<String, Value>>,
}

impl Car {
    fn new() -> Self {
        Self {
            name: "made-up",
            back_s: 0.0,
            seq: 0,
            transitions: 0,
            time_s: 0.0,
            unix_s: f64::NAN,
            source: SourceState::Live,
            frozen: false,
            states: ["unknown"; 4],
            since_s: [0.0; 4],
            alerts: Vec::new(),
        }
    }

    fn advance(&mut self, time_s: f64) {
        if self.source != SourceState::Live {
            return;
        }
        (self.time_s, self.unix_s) = (time_s, unix_s());
        for (state, since_s) in self.states.iter_mut().zip(&self.since_s) {
            if *state == "unknown" && *since_s == 0.0 && time_s > 3.0 {
                *state = "fine";
            }
        }
    }

    /// A wheel's new state, with the alert that belongs to it.
    fn turn(&mut self, hub: &Hub, state: &str, corner: &str) {
        let (Some(i), Some(state)) =
            (CORNERS.iter().position(|c| *c == corner), STATES.into_iter().find(|s| *s == state))
        else {
            return eprintln!("no such wheel or state: {corner} {state}");
        };
        let (ended, standing) =
            std::mem::take(&mut self.alerts).into_iter().partition(|a| a["wheels"][0] == corner);
        self.alerts = standing;
        let ended: Vec<Map<String, Value>> = ended;
        ended.into_iter().for_each(|alert| self.announce(hub, "ended", alert));
        (self.states[i], self.since_s[i]) = (state, self.time_s);
        let kind = match state {
            "low" => "under-inflated",
            "over" => "over-inflated",
            "malfunction" => "malfunction",
            _ => return,
        };
        let alert = json!({
            "kind": kind, "wheels": [corner], "since_s": self.time_s - 1.2, "reported_s": self.time_s,
            "pressure_kpa": 150.0, "sd_kpa": 8.0, "limit_kpa": 212.0, "reference_kpa": 241.3,
            "text": format!("malfunction: {corner} wheel sensor is stuck; since then"),
        });
        let Value::Object(alert) = alert else { return };
        self.announce(hub, "begun", alert.clone());
        self.alerts.push(alert);
    }

    fn announce(&mut self, hub: &Hub, event: &'static str, alert: Map<String, Value>) {
        hub.announce(Arc::new(Transition {
            seq: self.transitions,
            time_s: self.time_s,
            unix_s: unix_s(),
            event,
            alert,
        }));
        self.transitions += 1;
    }

    fn snapshot(&mut self) -> Snapshot {
        self.seq += 1;
        let wheels: Vec<Wheel> = (0..4).map(|i| self.wheel(i)).collect();
        let live = self.source == SourceState::Live;
        Snapshot {
            seq: self.seq,
            time_s: self.time_s,
            unix_s: self.unix_s,
            source: Source {
                name: self.name.to_owned(),
                kind: "replay",
                state: self.source,
                rows: (self.time_s * 200.0) as u64,
                frames: (self.time_s * 1000.0) as u64,
                dropped: 0,
                unknown_ids: 12,
                malformed: 0,
                reconnects: 0,
                rate_hz: 200.0,
            },
            vehicle: format!("{} car", self.name),
            speed_m_s: SPEED_M_S,
            speed_doubt: None,
            distance_m: SPEED_M_S * self.time_s,
            latency_ms: Latency { p50: 0.4, p99: 1.1, max: 2.3 },
            not_estimated: Default::default(),
            all_fine: live && wheels.iter().all(|wheel| wheel.state == "fine"),
            tracks: ["left", "right"].map(|side| Track { side, shared: true, incoherence: 0.07 }).to_vec(),
            alerts: self.alerts.clone(),
            sensors: self.sensors(),
            beside: Arc::new(beside(self.time_s)),
            wheels,
        }
    }

    fn wheel(&self, i: usize) -> Wheel {
        let (state, t) = (self.states[i], self.time_s);
        let after_s = t - self.since_s[i];
        let level = match state {
            "low" => 241.3 - 103.4 * (after_s / 2.5).clamp(0.3, 1.0),
            "over" => 290.0,
            _ => 241.3,
        };
        let valid = state != "malfunction" && t > 1.0 && (state != "unknown" || self.since_s[i] == 0.0);
        let sd_kpa = 1.5 + 25.0 * (-t / 4.0).exp();
        let pressure_kpa = level + sd_kpa * (t * 0.3 + i as f64).sin() * 0.8;
        // A morning of -10 C: what a tire that is 2 K warmer would have cold.
        let cold_kpa = (pressure_kpa + 101.3) * 263.15 / 265.15 - 101.3;
        Wheel {
            corner: CORNERS[i],
            state,
            doubt: (state == "unknown").then_some(if self.since_s[i] == 0.0 {
                "starting"
            } else {
                "no-information"
            }),
            pressure_kpa,
            pressure_sd_kpa: sd_kpa,
            change_sd_kpa: 0.8 * sd_kpa,
            axle_difference_sd_kpa: Some(1.2 * sd_kpa),
            lost_kpa: None,
            lost_sd_kpa: None,
            cold_pressure_kpa: Some(cold_kpa),
            cold_pressure_sd_kpa: Some(sd_kpa.hypot(3.0)),
            ambient_temperature_c: Some(-10.0),
            cold_add_kpa: Some(241.3 - cold_kpa).filter(|add_kpa| valid && *add_kpa > sd_kpa.hypot(5.0)),
            lost_share: None,
            lost_share_sd: None,
            detectable_loss: None,
            level: "calibration",
            stiffness_n_per_m: 233_000.0,
            reference_kpa: 241.3,
            placard_kpa: 241.3,
            valid,
            warning: match state {
                "low" => "low",
                "malfunction" => "malfunction",
                _ => "none",
            },
            gate: if valid { 0.82 + 0.15 * (t * 0.7 + i as f64).sin() } else { 0.0 },
            informed_age_s: if valid { 0.1 } else { after_s },
            road_m: 0.004 * (t * 5.1 + i as f64).sin() + 0.002 * (t * 13.7).cos(),
            iri_m_per_km: if t > 5.0 {
                2.2 + 0.6 * ((t / 40.0).floor() + (i % 2) as f64).sin()
            } else {
                f64::NAN
            },
            tire_sensor_kpa: Some(240.0),
        }
    }

    fn sensors(&self) -> Vec<SensorHealth> {
        let places = CORNERS.iter().zip(self.states).flat_map(|(corner, state)| {
            ["body", "wheel"].map(|place| {
                (format!("{corner}_{place}_accel_m_s2"), state == "malfunction" && place == "wheel")
            })
        });
        let health = places.map(|(column, broken)| SensorHealth {
            column,
            state: if broken { "malfunction" } else { "fine" },
            reason: broken.then(|| "stuck: it repeats one value".to_owned()),
        });
        health.collect()
    }
}

/// What `itpms estimate --json` has beside the pressures: a worn damper, a load, an imbalance, a sensor that drifts.
fn beside(time_s: f64) -> Map<String, Value> {
    let wheels = |of: fn(&str) -> Value| Value::from_iter(CORNERS.map(|corner| (corner, of(corner))));
    let dampers = wheels(|corner| match corner {
        "rl" => json!({ "state": "worn", "over_reference": 0.49, "over_reference_sd": 0.03 }),
        _ => json!({ "state": "fine", "over_reference": 1.01, "over_reference_sd": 0.05 }),
    });
    let once_per_turn = wheels(|corner| match corner {
        "fl" => {
            json!({ "state": "found", "force_n": 36.0, "force_sd_n": 4.0, "imbalance_g": 29.0, "imbalance_sd_g": 9.0 })
        }
        _ => json!({ "state": "no-line", "force_n": null, "imbalance_g": null }),
    });
    let tire_sensors = wheels(|corner| match corner {
        "fr" => {
            json!({ "state": "drift", "pressure_kpa": 240.0, "against_estimate_kpa": 21.0, "against_estimate_sd_kpa": 4.0 })
        }
        _ => json!({ "state": "fine", "pressure_kpa": 240.0 }),
    });
    let load = match time_s < 30.0 {
        true => json!({ "state": "learning", "because": "short", "total_kg": null }),
        false => json!({
            "state": "known", "front_axle_kg": 812.0, "front_axle_sd_kg": 17.0, "rear_axle_kg": 905.0, "rear_axle_sd_kg": 18.0,
            "total_kg": 1717.0, "total_sd_kg": 34.0, "added_kg": 241.0, "added_sd_kg": 25.0,
        }),
    };
    let all = [
        ("dampers", dampers),
        ("load", load),
        ("once_per_turn", once_per_turn),
        ("tire_sensors", tire_sensors),
    ];
    all.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
}

fn unix_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(f64::NAN, |since| since.as_secs_f64())
}
