//! The web server from outside: plain requests over a socket, as a browser, a scraper or someone with bad intentions sends them.

use crate::{http_client, made_up};

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use http_client::{Events, ask, connect, get, raw, served, server, wait_for};
use itpms_core::model::PressureUnit;
use itpms_live::http::{Options, Server};
use itpms_live::snapshot::SourceState;
use made_up::{snapshot, transition};
use serde_json::Value;

#[test]
fn the_page_and_all_its_files_come_from_memory_with_a_strict_policy() {
    let (server, _hub) = server();
    let page = get(&server, "/");
    assert_eq!(page.status, 200);
    for wanted in [
        "content-type: text/html; charset=utf-8",
        "content-security-policy: default-src 'none'; script-src 'self'; style-src 'self'",
        "x-content-type-options: nosniff",
        "x-frame-options: deny",
        "referrer-policy: no-referrer",
        "cross-origin-resource-policy: same-origin",
    ] {
        assert!(page.head.contains(wanted), "{wanted} in {}", page.head);
    }
    assert!(!page.head.contains("unsafe") && !page.head.contains("set-cookie"), "{}", page.head);
    // Nothing in the page that this policy forbids, and every file that it names is there.
    assert!(
        !page.body.contains("style=") && !page.body.contains("<style") && !page.body.contains("http://www")
    );
    let named = page.body.split('"').filter(|text| text.starts_with("/assets/")).collect::<Vec<_>>();
    assert!(named.len() >= 6, "{named:?}");
    for name in named {
        let file = get(&server, name);
        assert!(file.status == 200 && file.body.len() > 200, "{name}: {}", file.status);
        // The scripts' imports have to be there as well.
        for import in file.body.split("from \"./").skip(1) {
            let import = format!("/assets/{}", import.split('"').next().unwrap());
            assert_eq!(get(&server, &import).status, 200, "{import}");
        }
    }
    let head = ask(&server, "HEAD", "/", "");
    assert!(head.status == 200 && head.body.is_empty());
    let mark = page.head.lines().find_map(|line| line.strip_prefix("etag: ")).unwrap().to_owned();
    assert_eq!(ask(&server, "GET", "/", &format!("If-None-Match: {mark}\r\n")).status, 304);
}

#[test]
fn no_path_leads_out() {
    let (server, _hub) = server();
    for target in [
        "/../Cargo.toml",
        "/assets/../../Cargo.toml",
        "/assets/../src/lib.rs",
        "/assets/%2e%2e/%2e%2e/Cargo.toml",
        "/assets/..%2f..%2fCargo.toml",
        "/assets/%252e%252e/Cargo.toml",
        "//etc/passwd",
        "/etc/passwd",
        "/assets/",
        "/assets",
        "/assets/style.css/",
        "/assets/style.css%00.js",
        "/assets/..\\..\\Cargo.toml",
        "/assets/./style.css",
        "/index.html",
        "/api/",
        "/api/snapshot/..",
        "/.git/config",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/assets/%c0%ae%c0%ae/Cargo.toml",
    ] {
        let answer = get(&server, target);
        assert!((400..500).contains(&answer.status), "{target}: {}", answer.status);
        assert!(answer.body.len() < 100 && !answer.body.contains("[package]"), "{target}: {}", answer.body);
    }
}

#[test]
fn nothing_can_be_written() {
    let (server, _hub) = server();
    for method in ["POST", "PUT", "PATCH", "DELETE", "OPTIONS", "CONNECT", "TRACE", "BREW"] {
        for target in ["/", "/api/snapshot", "/api/events", "/metrics", "/nowhere"] {
            let answer = ask(&server, method, target, "Content-Length: 0\r\n");
            assert!(answer.status == 405 || answer.status == 400, "{method} {target}: {}", answer.status);
        }
    }
    // A body that comes with a GET is not read: the connection ends instead.
    let long = format!("Content-Length: 1000000000\r\n\r\n{}", "x".repeat(10_000));
    assert_eq!(ask(&server, "GET", "/healthz", &long).status, 503);
}

#[test]
fn other_names_and_other_pages_are_refused() {
    let (server, hub) = served(|options| Options {
        hosts: vec!["car7.example.com".to_owned()],
        origins: vec!["https://fleet.example.com".to_owned()],
        ..options
    });
    hub.publish(snapshot(1, 1.0, SourceState::Live));
    wait_for(&server, "/api/snapshot", |answer| answer.status == 200);
    let of = |request: &str| raw(server.address(), &format!("{request}Connection: close\r\n\r\n")).status;
    let here = server.address();
    assert_eq!(of(&format!("GET / HTTP/1.1\r\nHost: localhost:{}\r\n", here.port())), 200);
    assert_eq!(of("GET / HTTP/1.1\r\nHost: car7.example.com\r\n"), 200);
    // A name that someone made point here.
    for target in ["/", "/api/snapshot", "/api/events", "/metrics", "/healthz"] {
        assert_eq!(of(&format!("GET {target} HTTP/1.1\r\nHost: evil.example\r\n")), 403, "{target}");
        assert_eq!(
            of(&format!("GET http://evil.example{target} HTTP/1.1\r\nHost: {here}\r\n")),
            403,
            "{target}"
        );
    }
    assert_eq!(of("GET / HTTP/1.1\r\n"), 400);
    assert_eq!(of(&format!("GET / HTTP/1.1\r\nHost: {here}\r\nHost: {here}\r\n")), 400);
    // A page of another.
    let from = |target: &str, header: &str| ask(&server, "GET", target, header);
    for target in ["/api/snapshot", "/api/history", "/api/events", "/metrics", "/assets/app.js"] {
        for header in
            ["Origin: https://evil.example\r\n", "Origin: null\r\n", "Sec-Fetch-Site: cross-site\r\n"]
        {
            let answer = from(target, header);
            assert_eq!(answer.status, 403, "{target} {header}");
            assert!(!answer.head.contains("access-control-allow-origin"), "{}", answer.head);
        }
    }
    // A link to the page, and those who were allowed.
    assert_eq!(from("/", "Sec-Fetch-Site: cross-site\r\n").status, 200);
    assert_eq!(from("/api/snapshot", &format!("Origin: http://{here}\r\n")).status, 200);
    let allowed =
        from("/api/snapshot", "Origin: https://fleet.example.com\r\nSec-Fetch-Site: cross-site\r\n");
    assert_eq!(allowed.status, 200);
    assert!(
        allowed.head.contains("access-control-allow-origin: https://fleet.example.com"),
        "{}",
        allowed.head
    );
}

#[test]
fn health_follows_the_data_and_says_why() {
    let (server, hub) = server();
    let is = |status: u16, word: &'static str| {
        let answer =
            wait_for(&server, "/healthz", |answer| answer.status == status && answer.body.contains(word));
        serde_json::from_str::<Value>(&answer.body).unwrap()
    };
    assert_eq!(is(503, "waiting")["reason"], "nothing has come yet");
    hub.publish(snapshot(1, 1.0, SourceState::Live));
    assert!(is(200, "fresh")["reason"].is_null());
    hub.publish(snapshot(2, 1.0, SourceState::Stale));
    assert!(is(503, "stale")["reason"].as_str().unwrap().contains("no row from can0"));
    hub.publish(snapshot(3, 1.0, SourceState::Ended));
    is(503, "ended");
    hub.publish(snapshot(4, 2.0, SourceState::Live));
    is(200, "fresh");
    // The monitor hangs: it cannot say so, the server can.
    std::thread::sleep(Duration::from_millis(3200));
    assert!(is(503, "stale")["reason"].as_str().unwrap().contains("the monitor has sent nothing"));
    assert!(get(&server, "/metrics").body.contains("\nitpms_fresh 0\n"));
}

#[test]
fn metrics_are_in_the_format_and_hold_the_numbers() {
    let (server, hub) = server();
    assert!(get(&server, "/metrics").body.contains("itpms_fresh 0"));
    hub.publish(snapshot(1, 7.5, SourceState::Live));
    let answer = wait_for(&server, "/metrics", |answer| answer.body.contains("\nitpms_fresh 1\n"));
    assert!(answer.head.contains("content-type: text/plain; version=0.0.4"));
    for wanted in [
        "itpms_tire_pressure_kpa{wheel=\"fl\"} 138.25",
        "itpms_tire_pressure_sd_kpa{wheel=\"fl\"} 2.5",
        "itpms_tire_pressure_kpa{wheel=\"rr\"} NaN",
        "itpms_tire_state{wheel=\"fl\",state=\"low\"} 1",
        "itpms_tire_state{wheel=\"fl\",state=\"fine\"} 0",
        "itpms_tire_valid{wheel=\"rr\"} 0",
        "itpms_rows_total 1500",
        "itpms_frames_total 7500",
        "itpms_frames_dropped_total 3",
        "itpms_latency_seconds{quantile=\"0.99\"} 0.002",
        "itpms_http_streams 0",
        "itpms_alerts 0",
        "itpms_all_fine 0",
    ] {
        assert!(answer.body.lines().any(|line| line == wanted), "{wanted} in\n{}", answer.body);
    }
    // Every line is a comment or `name{labels} number`, and every family is introduced before its numbers and only once.
    let mut families = Vec::new();
    for line in answer.body.lines() {
        if let Some(rest) = line.strip_prefix("# TYPE ") {
            families.push(rest.split(' ').next().unwrap());
        } else if !line.starts_with("# HELP ") {
            let (name, value) = line.rsplit_once(' ').unwrap();
            assert!(value.parse::<f64>().is_ok(), "{line}");
            assert_eq!(families.last(), Some(&name.split('{').next().unwrap()), "{line}");
        }
    }
    let count = families.len();
    families.sort_unstable();
    families.dedup();
    assert_eq!(families.len(), count);
}

#[test]
fn the_stream_opens_with_the_past_and_goes_on_from_where_it_broke() {
    let (server, hub) = server();
    for i in 0..30 {
        hub.publish(snapshot(i, i as f64, SourceState::Live));
    }
    hub.announce(transition(0, 12.0));
    let mut events = Events::open(&server, "");
    let (name, _, hello) = events.next();
    assert_eq!(name, "hello");
    let (name, _, past) = events.next();
    assert_eq!((name.as_str(), &past["resumed"]), ("history", &Value::Bool(false)));
    assert_eq!(past["coarse"]["time_s"].as_array().unwrap().len(), 30);
    assert_eq!(past["coarse"]["wheels"][0]["pressure_kpa"][29], 138.25);
    // What may not be shown is not in the curves either.
    assert!(past["coarse"]["wheels"][3]["pressure_kpa"][29].is_null());
    assert_eq!(past["transitions"][0]["kind"], "under-inflated");
    let (id, newest) = events.next_named("snapshot");
    assert_eq!(newest["seq"], 29);
    assert_eq!(id, format!("{}.29", hello["run"].as_str().unwrap()));
    drop(events);
    // Away for three snapshots.
    (30..33).for_each(|i| hub.publish(snapshot(i, i as f64, SourceState::Live)));
    let mut events = Events::open(&server, &format!("Last-Event-ID: {id}\r\n"));
    let (_, past) = events.next_named("history");
    assert_eq!(past["resumed"], true);
    assert_eq!(past["coarse"]["time_s"], serde_json::json!([30.0, 31.0, 32.0]));
    // An id of another run, or nonsense, is not believed.
    for id in ["abc.3", "3", &format!("{}.x", hello["run"].as_str().unwrap()), ""] {
        let mut events = Events::open(&server, &format!("Last-Event-ID: {id}\r\n"));
        assert_eq!(events.next_named("history").1["resumed"], false, "{id}");
    }
}

#[test]
fn a_fast_source_is_thinned_the_newest_wins_and_no_transition_is_lost() {
    let (server, hub) = server();
    let mut events = Events::open(&server, "");
    let publisher = std::thread::spawn(move || {
        for i in 0..1500u64 {
            hub.publish(snapshot(i, i as f64, SourceState::Live));
            if i % 100 == 0 {
                hub.announce(transition(i / 100, i as f64));
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        hub
    });
    let (mut seen, mut transitions, mut first) = (0, Vec::new(), None);
    loop {
        let (name, _, data) = events.next();
        if name == "transition" {
            transitions.push(data["seq"].as_u64().unwrap());
        }
        if name == "snapshot" {
            first.get_or_insert_with(Instant::now);
            seen += 1;
            if data["seq"] == 1499 {
                break;
            }
        }
    }
    // Ten a second at most, the first and the last one besides.
    let most = 10.0 * first.unwrap().elapsed().as_secs_f64() + 2.0;
    assert!((seen as f64) <= most && seen >= 5, "{seen} snapshots, expected at most {most}");
    assert_eq!(transitions, (0..15).collect::<Vec<_>>());
    drop(publisher.join().unwrap());
}

#[test]
fn silence_is_broken_by_signs_of_life() {
    let (server, hub) = server();
    hub.publish(snapshot(0, 1.0, SourceState::Stale));
    let mut events = Events::open(&server, "");
    let (_, first) = events.next_named("beat");
    let (_, second) = events.next_named("beat");
    let apart_s = second["unix_s"].as_f64().unwrap() - first["unix_s"].as_f64().unwrap();
    assert!((0.9..3.0).contains(&apart_s), "{apart_s} s");
    assert_eq!(second["health"]["status"], "stale");
}

#[test]
fn streams_and_connections_are_limited_and_come_free_again() {
    let (server, _hub) = server();
    let mut streams: Vec<Events> = (0..32).map(|_| Events::open(&server, "")).collect();
    streams.iter_mut().for_each(|stream| assert_eq!(stream.next().0, "hello"));
    let refused = get(&server, "/api/events");
    assert!(refused.status == 503 && refused.head.contains("retry-after"), "{}", refused.head);
    // Who asks for health gets an answer all the same.
    assert!(get(&server, "/metrics").body.contains("itpms_http_streams 32"));
    // 72 connections of one address; 32 are streams.
    let idle: Vec<TcpStream> = (0..40).map(|_| connect(server.address())).collect();
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(raw(server.address(), "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 503);
    let mut full = connect(server.address());
    let mut reported = String::new();
    let _ = full.read_to_string(&mut reported);
    assert!(reported.starts_with("HTTP/1.1 503") && reported.contains("Connection: close"), "{reported}");
    drop((idle, streams));
    // A stream whose client is gone is noticed with the next sign of life.
    wait_for(&server, "/metrics", |answer| answer.body.contains("itpms_http_streams 0"));
    assert_eq!(Events::open(&server, "").next().0, "hello");
}

/// A connection from another address of this machine.
#[cfg(target_os = "linux")]
fn connect_from(address: SocketAddr, from: [u8; 4]) -> TcpStream {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let stream = runtime.block_on(async {
        let socket = tokio::net::TcpSocket::new_v4().unwrap();
        socket.bind(SocketAddr::from((from, 0))).unwrap();
        socket.connect(address).await.unwrap().into_std().unwrap()
    });
    stream.set_nonblocking(false).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    stream
}

#[cfg(target_os = "linux")]
#[test]
fn held_connections_keep_nobody_out() {
    let (server, _hub) = server();
    let answer = |mut stream: TcpStream| {
        stream.write_all(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        let mut reported = String::new();
        let _ = stream.read_to_string(&mut reported);
        reported.split(' ').nth(1).unwrap_or_default().to_owned()
    };
    // As many as there are seats, each with half a request, from one address.
    let held: Vec<TcpStream> = (0..96)
        .map(|_| {
            let mut stream = connect(server.address());
            let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost: loc");
            stream
        })
        .collect();
    // From another address there is room at once; from the same one as soon as they have been silent.
    assert_eq!(answer(connect_from(server.address(), [127, 0, 0, 2])), "200");
    let begun = Instant::now();
    while answer(connect(server.address())) != "200" {
        assert!(begun.elapsed() < Duration::from_secs(3), "still shut out after {:?}", begun.elapsed());
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(held);
}

#[test]
fn a_stopped_server_ends_its_streams_and_frees_its_address() {
    let (server, hub) = server();
    let address = server.address();
    let mut events = Events::open(&server, "");
    events.next_named("history");
    let begun = Instant::now();
    drop(server);
    assert!(begun.elapsed() < Duration::from_secs(2));
    // The stream comes to its end.
    while events.lines.next().is_some_and(|line| line.is_ok()) {}
    let again = Server::start(Options::new(address), Arc::clone(&hub)).unwrap();
    assert_eq!(get(&again, "/").status, 200);
    // Taken: reported in words, with the address.
    let error = Server::start(Options::new(address), hub).unwrap_err().to_string();
    assert!(error.contains(&address.to_string()), "{error}");
}

#[test]
fn nonsense_is_refused_and_breaks_nothing() {
    let (server, _hub) = server();
    let long = format!("GET /{} HTTP/1.1\r\nHost: localhost\r\n\r\n", "a".repeat(100_000));
    let many = format!("GET / HTTP/1.1\r\nHost: localhost\r\n{}\r\n", "X-Y: z\r\n".repeat(1000));
    for request in [
        "\r\n\r\n",
        "GET\r\n\r\n",
        "GET / HTTP/9.9\r\n\r\n",
        "\u{0}\u{1}\u{2}",
        "GET / HTTP/1.1\r\nHost: a\r\n b\r\n\r\n",
        &long,
        &many,
        "GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\nContent-Length: 3\r\n\r\nabc",
    ] {
        let mut stream = connect(server.address());
        stream.set_read_timeout(Some(Duration::from_millis(300))).unwrap();
        // It may hang up before everything is sent.
        let _ = stream.write_all(request.as_bytes());
        let mut text = Vec::new();
        let _ = stream.read_to_end(&mut text);
        let shown = String::from_utf8_lossy(&text[..text.len().min(12)]).into_owned();
        let accepted = shown.starts_with("HTTP/1.1 200");
        assert!(!accepted || request.contains("Transfer-Encoding"), "{shown} to {:.60}", request);
    }
    assert_eq!(get(&server, "/").status, 200);
}

#[test]
fn the_page_knows_in_which_unit_it_shows_pressures() {
    for (unit, mark) in [
        (PressureUnit::Kpa, r#"data-unit="kPa" data-unit-kpa="1" data-unit-places="0""#),
        (PressureUnit::Bar, r#"data-unit="bar" data-unit-kpa="100" data-unit-places="2""#),
        (PressureUnit::Psi, r#"data-unit="psi" data-unit-kpa="6.894757293168" data-unit-places="1""#),
    ] {
        let (server, _hub) = served(|options| Options { pressure_unit: unit, ..options });
        let page = ask(&server, "GET", "/", "");
        assert!(page.body.contains(mark), "{unit}");
    }
}
