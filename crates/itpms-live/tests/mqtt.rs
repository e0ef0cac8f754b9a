//! A real broker that is stopped and started again in the middle: every warning arrives.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail like tests")]

mod common;

use std::collections::BTreeSet;
use std::io::{Write as _, stderr};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use common::{say, snapshot, transition};
use itpms_live::broker::BrokerAddress;
use itpms_live::engine::Published;
use itpms_live::input::Input;
use itpms_live::output::Mqtt;
use itpms_live::queue::Queue;
use itpms_live::source::broker;
use rumqttc::{Client, Event, MqttOptions, Packet, QoS};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A Mosquitto of this test alone.
struct Broker {
    port: u16,
    dir: tempfile::TempDir,
    process: Option<Child>,
}

impl Broker {
    /// `None`, said loudly, where there is no Mosquitto.
    fn start() -> Option<Self> {
        let found =
            ["/usr/sbin/mosquitto", "/usr/local/sbin/mosquitto"].iter().any(|path| Path::new(path).exists());
        if !found {
            // On the stream itself: what the macros print in a test that passes is not shown.
            stderr().write_all(b"skipped: no mosquitto here (apt-get install mosquitto)\n").unwrap();
            return None;
        }
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let dir = tempfile::tempdir().unwrap();
        let store = dir.path().display();
        // A store, so that the broker keeps what it has acknowledged: what we test is not the broker.
        let config = format!(
            "listener {port} 127.0.0.1\nallow_anonymous true\npersistence true\npersistence_location {store}/\n\
             max_queued_messages 0\nmax_inflight_messages 100\n{}",
            // Started as root, it would become another user, who may not write here.
            if running_as_root() { "user root\n" } else { "" }
        );
        std::fs::write(dir.path().join("broker.conf"), config).unwrap();
        let mut broker = Self { port, dir, process: None };
        broker.begin();
        Some(broker)
    }

    fn begin(&mut self) {
        let program = if Path::new("/usr/sbin/mosquitto").exists() {
            "/usr/sbin/mosquitto"
        } else {
            "/usr/local/sbin/mosquitto"
        };
        let process = Command::new(program)
            .arg("-c")
            .arg(self.dir.path().join("broker.conf"))
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        self.process = Some(process);
        let start = Instant::now();
        while std::net::TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            assert!(start.elapsed() < Duration::from_secs(10), "mosquitto does not listen");
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Stops it as a service is stopped: it stores what it holds.
    fn end(&mut self) {
        if let Some(mut process) = self.process.take() {
            Command::new("kill").args(["-TERM", &process.id().to_string()]).status().unwrap();
            process.wait().unwrap();
        }
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        self.end();
    }
}

fn running_as_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout == b"0\n")
}

/// Everything that arrives under a topic, by a session that the broker keeps. Ends with the test.
fn subscribe(port: u16, topic: &str) -> Receiver<(String, Vec<u8>, bool)> {
    let mut options = MqttOptions::new("judge", "127.0.0.1", port);
    options.set_clean_session(false);
    options.set_max_packet_size(1 << 20, 1 << 20);
    let (client, mut connection) = Client::new(options, 10);
    let (arrived, arrivals) = mpsc::channel();
    let (ready, is_ready) = mpsc::channel();
    let topic = topic.to_owned();
    thread::spawn(move || {
        for event in connection.iter() {
            match event {
                Ok(Event::Incoming(Packet::ConnAck(_))) => {
                    drop(client.try_subscribe(&topic, QoS::AtLeastOnce))
                }
                Ok(Event::Incoming(Packet::SubAck(_))) => drop(ready.send(())),
                Ok(Event::Incoming(Packet::Publish(p))) => {
                    if arrived.send((p.topic, p.payload.to_vec(), p.retain)).is_err() {
                        return;
                    }
                }
                Ok(_) => {}
                Err(_) => thread::sleep(Duration::from_millis(20)),
            }
        }
    });
    is_ready.recv_timeout(Duration::from_secs(10)).unwrap();
    arrivals
}

fn address(port: u16, topic: &str) -> BrokerAddress {
    BrokerAddress::parse(&format!("mqtt://127.0.0.1:{port}/{topic}")).unwrap()
}

#[test]
fn every_warning_arrives_though_the_broker_is_restarted_twice_in_the_middle() {
    let Some(mut broker) = Broker::start() else { return };
    let arrivals = subscribe(broker.port, "car7/#");
    let output = Mqtt::open(address(broker.port, "car7"), &say()).unwrap().start();
    let warnings = 900u64;
    for seq in 0..warnings {
        match seq {
            300 | 600 => broker.end(),
            400 | 700 => broker.begin(),
            _ => {}
        }
        output.publish(&Published::Warning(transition(seq)));
        output.publish(&Published::Estimate(snapshot(seq)));
        thread::sleep(Duration::from_millis(2));
    }
    let restarted = Instant::now();
    let mut missing: BTreeSet<u64> = (0..warnings).collect();
    let (mut online, mut estimates, mut last) = (0, 0, 0);
    while !missing.is_empty() {
        let (topic, payload, _) = arrivals.recv_timeout(Duration::from_secs(20)).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&payload).unwrap();
        match topic.as_str() {
            "car7/warning" => {
                last = json["seq"].as_u64().unwrap();
                missing.remove(&last);
            }
            "car7/estimate" => estimates += 1,
            "car7/status" => online += u32::from(json["state"] == "online"),
            other => panic!("{other}"),
        }
    }
    println!(
        "all of {warnings} warnings there {:.2} s after the last was made",
        restarted.elapsed().as_secs_f64()
    );
    assert_eq!(last, warnings - 1, "the newest arrives last: the order is kept");
    assert!(online >= 2 && estimates > 100, "{online} {estimates}");
    output.finish().unwrap();
    // Whoever comes later finds the last warning and that nobody publishes any more.
    let late = subscribe(broker.port, "car7/status");
    let status = std::iter::from_fn(|| late.recv_timeout(Duration::from_secs(5)).ok());
    let mut kept = status.filter(|(topic, _, retained)| topic == "car7/status" && *retained);
    assert_eq!(kept.next().unwrap().1, br#"{"state":"offline"}"#);
}

#[test]
fn lines_that_come_as_messages_are_frames_and_a_restart_is_told() {
    let Some(mut broker) = Broker::start() else { return };
    let inputs = Arc::new(Queue::new(100));
    let stop = Arc::new(AtomicBool::new(false));
    broker::start(address(broker.port, "bus"), Arc::clone(&inputs), Arc::clone(&stop), say());
    let send = |port: u16| {
        let (client, mut connection) = Client::new(MqttOptions::new("sender", "127.0.0.1", port), 10);
        let text = "(1.5) can0 123#01\n(1.6) can0 123#02\nnonsense\n";
        client.publish("bus", QoS::AtLeastOnce, true, text).unwrap();
        for event in connection.iter() {
            if let Ok(Event::Incoming(Packet::PubAck(_))) = event {
                return;
            }
        }
    };
    let wait = |what: &str, is: fn(&Input) -> bool| {
        let start = Instant::now();
        let mut taken = VecDeque::new();
        while !taken.iter().any(is) {
            inputs.take(&mut taken, Duration::from_millis(50));
            assert!(start.elapsed() < Duration::from_secs(15), "{what}: {taken:?}");
        }
        taken
    };
    send(broker.port);
    let taken = wait("frames", |input| matches!(input, Input::Malformed(1)));
    let times: Vec<f64> = taken
        .iter()
        .filter_map(|input| match input {
            Input::Frame { frame, .. } => Some(frame.time_s),
            _ => None,
        })
        .collect();
    assert_eq!(times, [1.5, 1.6]);
    broker.end();
    wait("the loss", |input| matches!(input, Input::Disconnected(_)));
    let gone = Instant::now();
    broker.begin();
    wait("the return", |input| matches!(input, Input::Reconnected));
    println!("connected again {:.2} s after the broker was gone", gone.elapsed().as_secs_f64());
    stop.store(true, Ordering::Relaxed);
}
