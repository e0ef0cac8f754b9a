//! Who the monitor talks and listens to goes away and returns.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use itpms_console::Failure;
use itpms_core::model::Corner;
use itpms_live::broker::BrokerAddress;
use itpms_live::engine::Published;
use itpms_live::hub::Hub;
use itpms_live::input::{Input, SourceName};
use itpms_live::monitor::{Monitor, STALE_AFTER};
use itpms_live::output::Mqtt;
use itpms_live::queue::Queue;
use itpms_live::snapshot::{SourceState, Transition};
use itpms_live::source::broker;

use super::broker::Broker;
use super::subject::{RATE_HZ, silent};
use super::{Campaign, Outcome};

/// How long something that has to come is waited for.
const PATIENCE: Duration = Duration::from_secs(15);

fn failed(error: impl ToString) -> Failure {
    Failure::Usage(error.to_string())
}

/// Warnings to a broker that is away for a while again and again.
pub(super) fn warnings(campaign: &mut Campaign<'_>) -> Result<Outcome, Failure> {
    let mut broker = Broker::new().map_err(failed)?;
    let address = BrokerAddress::parse(&format!("mqtt://127.0.0.1:{}/car", broker.port())).map_err(failed)?;
    let output = Mqtt::open(address, &silent()).map_err(failed)?.start();
    let outages = campaign.of(20);
    let mut sent = 0u64;
    let mut warn = |until: Instant| {
        while Instant::now() < until {
            let transition = Transition {
                seq: sent,
                time_s: sent as f64,
                unix_s: 0.0,
                event: "begun",
                alert: serde_json::Map::new(),
            };
            output.publish(&Published::Warning(Arc::new(transition)));
            sent += 1;
            sleep(Duration::from_millis(2));
        }
    };
    let mut moment = |most_ms| Instant::now() + Duration::from_millis(50 + campaign.moments.below(most_ms));
    for _ in 0..outages {
        campaign.interrupt.check()?;
        warn(moment(300));
        broker.leave();
        warn(moment(200));
        broker.come_back().map_err(failed)?;
    }
    let missing = |broker: &Broker| {
        let seq = |payload: &[u8]| serde_json::from_slice::<serde_json::Value>(payload).ok()?["seq"].as_u64();
        let there = broker.acknowledged();
        let there = there.iter().filter(|(topic, _)| topic == "car/warning");
        let there: BTreeSet<u64> = there.filter_map(|(_, payload)| seq(payload)).collect();
        (0..sent).filter(|seq| !there.contains(seq)).count() as u64
    };
    let begun = Instant::now();
    while missing(&broker) > 0 && begun.elapsed() < PATIENCE {
        sleep(Duration::from_millis(10));
    }
    let lost = missing(&broker);
    output.finish().map_err(failed)?;
    let found = format!(
        "{} of {sent} warnings acknowledged, the last {:.1} s after the last return",
        sent - lost,
        begun.elapsed().as_secs_f64()
    );
    Ok(Outcome { tried: outages, lost, found })
}

/// Frames from a broker that is away for a while again and again.
pub(super) fn frames(campaign: &mut Campaign<'_>) -> Result<Outcome, Failure> {
    let mut broker = Broker::new().map_err(failed)?;
    let address = BrokerAddress::parse(&format!("mqtt://127.0.0.1:{}/bus", broker.port())).map_err(failed)?;
    let (inputs, stop) = (Arc::new(Queue::new(100_000)), Arc::new(AtomicBool::new(false)));
    broker::start(address, Arc::clone(&inputs), Arc::clone(&stop), silent());
    let outages = campaign.of(20);
    let (mut sent, mut came, mut returns, mut lost) = (0u64, 0, 0, 0);
    let mut taken = VecDeque::new();
    for outage in 0..=outages {
        campaign.interrupt.check()?;
        let begun = Instant::now();
        while !broker.has_subscriber() && begun.elapsed() < PATIENCE {
            sleep(Duration::from_millis(2));
        }
        for _ in 0..1 + campaign.moments.below(50) {
            sent += 1;
            broker.send("bus", format!("({sent}.0) can0 123#01\n").as_bytes(), (sent % 60_000) as u16);
        }
        while came < sent && begun.elapsed() < PATIENCE {
            inputs.take(&mut taken, Duration::from_millis(20));
            for input in taken.drain(..) {
                came += u64::from(matches!(input, Input::Frame { .. }));
                returns += u64::from(matches!(input, Input::Reconnected));
            }
        }
        lost += sent - came;
        came = sent;
        if outage < outages {
            broker.leave();
            sleep(Duration::from_millis(campaign.moments.below(300)));
            broker.come_back().map_err(failed)?;
        }
    }
    stop.store(true, Relaxed);
    lost += outages.saturating_sub(returns);
    Ok(Outcome {
        tried: outages,
        lost,
        found: format!("{sent} frames sent and there, {returns} returns reported"),
    })
}

/// Rows that stop coming for longer than what is known may stay believed.
pub(super) fn silence(campaign: &mut Campaign<'_>) -> Result<Outcome, Failure> {
    let outages = campaign.of(10);
    let rows = &campaign.subject.rows;
    // Ten seconds of driving, and then, after every silence, one more.
    let mut parts = vec![&rows[..(10.0 * RATE_HZ) as usize]];
    parts.extend(rows[(10.0 * RATE_HZ) as usize..].chunks(RATE_HZ as usize).take(outages as usize));
    let hub = Hub::new();
    let source = SourceName { name: "bus".to_owned(), kind: "socketcan" };
    let (vehicle, options) = (campaign.subject.vehicle.clone(), super::subject::options());
    let engine = itpms_live::engine::Engine::new(vehicle, options, source, None, silent());
    let monitor = Monitor::new(engine, Arc::clone(&hub), Vec::new(), None, silent());
    let (inputs, stop) = (Queue::new(100_000), AtomicBool::new(false));
    let is = |state: SourceState, rows: u64| {
        let begun = Instant::now();
        loop {
            if hub.latest().is_some_and(|now| now.source.state == state && now.source.rows >= rows) {
                return true;
            }
            if begun.elapsed() > PATIENCE {
                return false;
            }
            sleep(Duration::from_millis(5));
        }
    };
    let (mut lost, mut pushed, mut longest_s) = (0u64, 0u64, 0.0f64);
    thread::scope(|scope| {
        let running = thread::Builder::new().stack_size(16 << 20);
        let running =
            running.spawn_scoped(scope, || monitor.run(&inputs, || stop.load(Relaxed))).map_err(failed)?;
        inputs.push(Input::Opened {
            sample_rate_hz: RATE_HZ,
            corners: Corner::ALL.to_vec(),
            wheel_speeds: false,
        });
        for part in parts {
            let came = part.iter().map(|row| Input::Row { row: Box::new(*row), arrived: Instant::now() });
            inputs.push_all(came.collect::<Vec<_>>());
            pushed += part.len() as u64;
            // The newest estimate may be of a tenth of a second before the last row.
            let estimated = is(SourceState::Live, pushed - (RATE_HZ / 10.0) as u64);
            let silent_since = Instant::now();
            let reported = is(SourceState::Stale, pushed);
            longest_s = longest_s.max(silent_since.elapsed().as_secs_f64());
            lost += u64::from(!estimated) + u64::from(!reported);
        }
        stop.store(true, Relaxed);
        match running.join() {
            Ok(ended) => ended.map(drop).map_err(failed),
            Err(_) => Err(failed("the monitor broke off")),
        }
    })?;
    let limit_s = STALE_AFTER.as_secs_f64();
    let found = format!(
        "{pushed} rows estimated; silence reported after {longest_s:.2} s at most ({limit_s} s wanted)"
    );
    Ok(Outcome { tried: outages, lost, found })
}
