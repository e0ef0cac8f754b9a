//! A real broker that is stopped and started again in the middle: every warning arrives.

use std::collections::{BTreeSet, VecDeque};
use std::io::{Write as _, stderr};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use itpms_live::broker::{BrokerAddress, Password};
use itpms_live::engine::Published;
use itpms_live::input::Input;
use itpms_live::output::Mqtt;
use itpms_live::queue::Queue;
use itpms_live::source::broker;
use rumqttc::{Client, Event, MqttOptions, Packet, QoS};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::common::{notes, snapshot, transition};

/// A Mosquitto of this test alone.
struct Broker {
    port: u16,
    dir: tempfile::TempDir,
    process: Option<Child>,
}

impl Broker {
    /// `None`, reported loudly, where there is no Mosquitto.
    fn start() -> Option<Self> {
        Self::with(|_, port| format!("listener {port} 127.0.0.1\nallow_anonymous true\n"))
    }

    /// `listener`: what its configuration says of who may come and how, made in a folder and for a port.
    fn with(listener: impl Fn(&Path, u16) -> String) -> Option<Self> {
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
            "{}persistence true\npersistence_location {store}/\n\
             max_queued_messages 0\nmax_inflight_messages 100\n{}",
            listener(dir.path(), port),
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
    let output = Mqtt::open(address(broker.port, "car7"), &notes()).unwrap().start();
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
    // Whoever comes later finds the last warning and that nothing publishes any more.
    let late = subscribe(broker.port, "car7/status");
    let status = std::iter::from_fn(|| late.recv_timeout(Duration::from_secs(5)).ok());
    let mut kept = status.filter(|(topic, _, retained)| topic == "car7/status" && *retained);
    assert_eq!(kept.next().unwrap().1, br#"{"state":"offline"}"#);
}

#[test]
fn lines_that_come_as_messages_are_frames_and_a_restart_is_reported() {
    let Some(mut broker) = Broker::start() else { return };
    let inputs = Arc::new(Queue::new(100));
    let stop = Arc::new(AtomicBool::new(false));
    broker::start(address(broker.port, "bus"), Arc::clone(&inputs), Arc::clone(&stop), notes());
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

/// An authority, a broker's certificate of it for `localhost`, and a password of `car7`.
fn with_secrets(dir: &Path, port: u16) -> String {
    let run = |program: &str, line: &str| {
        let words = line.split(' ').map(|word| word.replace("DIR", &dir.display().to_string()));
        let done = Command::new(program).args(words).stdout(Stdio::null()).stderr(Stdio::null()).status();
        assert!(done.unwrap().success(), "{program} {line}");
    };
    for name in ["ca", "stranger"] {
        let files = format!("-keyout DIR/{name}.key -out DIR/{name}.pem");
        run("openssl", &format!("req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN={name} {files}"));
    }
    std::fs::write(dir.join("names"), "subjectAltName=DNS:localhost\n").unwrap();
    run(
        "openssl",
        "req -newkey rsa:2048 -nodes -subj /CN=localhost -keyout DIR/broker.key -out DIR/broker.csr",
    );
    let signed = "-CA DIR/ca.pem -CAkey DIR/ca.key -CAcreateserial -extfile DIR/names -days 2";
    run("openssl", &format!("x509 -req -in DIR/broker.csr {signed} -out DIR/broker.pem"));
    run("mosquitto_passwd", "-c -b DIR/passwords car7 secret");
    let file = |name: &str| dir.join(name).display().to_string();
    format!(
        "listener {port} 127.0.0.1\nallow_anonymous false\npassword_file {}\ncertfile {}\nkeyfile {}\n",
        file("passwords"),
        file("broker.pem"),
        file("broker.key")
    )
}

#[test]
fn who_has_the_password_and_believes_the_authority_is_let_in_and_nobody_else() {
    if Command::new("openssl").arg("version").output().is_err() {
        stderr().write_all(b"skipped: no openssl here (apt-get install openssl)\n").unwrap();
        return;
    }
    let Some(broker) = Broker::with(with_secrets) else { return };
    let first = |address: &str, password: Option<&str>, ca: Option<&str>| {
        let address = BrokerAddress::parse(&address.replace("PORT", &broker.port.to_string())).unwrap();
        let ca = ca.map(|ca| broker.dir.path().join(ca));
        let password = password.map(|text| Password::new(text.to_owned()));
        let address = address.with_access(password, ca.as_deref()).unwrap();
        let (reported, heard) = mpsc::channel();
        let notes: itpms_live::input::NoteSink = Arc::new(move |note| {
            let (itpms_live::input::Note::Remark(text) | itpms_live::input::Note::Warning(text)) = note;
            drop(reported.send(text));
        });
        let output = Mqtt::open(address, &notes).unwrap().start();
        output.publish(&Published::Warning(transition(7)));
        let first = heard.recv_timeout(Duration::from_secs(2)).unwrap_or_default();
        output.finish().unwrap();
        (first, heard.try_iter().any(|text| text.contains("were never acknowledged")))
    };
    let right = "mqtts://car7@localhost:PORT/car7";
    let (reported, lost) = first(right, Some("secret"), Some("ca.pem"));
    assert!(reported.is_empty() && !lost, "{reported}");
    for (address, password, ca) in [
        (right, Some("wrong"), Some("ca.pem")),
        (right, None, Some("ca.pem")),
        (right, Some("secret"), Some("stranger.pem")),
        // Whom the system believes has not signed it.
        (right, Some("secret"), None),
        // Another name than that of the certificate.
        ("mqtts://car7@127.0.0.1:PORT/car7", Some("secret"), Some("ca.pem")),
        ("mqtt://car7@localhost:PORT/car7", Some("secret"), None),
    ] {
        let (reported, lost) = first(address, password, ca);
        assert!(reported.contains("trying again") && lost, "{address} {password:?} {ca:?}: {reported}");
        assert!(!reported.contains("secret"), "{reported}");
        println!("{reported}");
    }
}
