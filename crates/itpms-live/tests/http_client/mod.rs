//! A client as plain as can be, so that nothing between it and the server is forgiving.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use itpms_live::http::{Options, Server};
use itpms_live::hub::Hub;
use serde_json::Value;

pub(crate) fn server() -> (Server, Arc<Hub>) {
    served(|options| options)
}

pub(crate) fn served(reported: impl FnOnce(Options) -> Options) -> (Server, Arc<Hub>) {
    let hub = Hub::new();
    let options = reported(Options::new("127.0.0.1:0".parse().unwrap()));
    (Server::start(options, Arc::clone(&hub)).unwrap(), hub)
}

pub(crate) fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    stream
}

/// A whole answer: status, headers in lower case, body.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: String,
}

/// Sends bytes as they are and reads until the connection ends.
pub(crate) fn raw(address: SocketAddr, request: &str) -> Answer {
    let mut stream = connect(address);
    stream.write_all(request.as_bytes()).unwrap();
    let mut text = Vec::new();
    let _ = stream.read_to_end(&mut text);
    let text = String::from_utf8_lossy(&text).into_owned();
    let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
    let status = head.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0);
    Answer { status, head: head.to_lowercase(), body: body.to_owned() }
}

pub(crate) fn ask(server: &Server, method: &str, target: &str, headers: &str) -> Answer {
    let host = server.address();
    let request = format!("{method} {target} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n{headers}\r\n");
    raw(server.address(), &request)
}

pub(crate) fn get(server: &Server, target: &str) -> Answer {
    ask(server, "GET", target, "")
}

/// Until what was published has gone through the server's own task.
pub(crate) fn wait_for(server: &Server, target: &str, holds: impl Fn(&Answer) -> bool) -> Answer {
    let begun = Instant::now();
    loop {
        let answer = get(server, target);
        if holds(&answer) {
            return answer;
        }
        assert!(begun.elapsed() < Duration::from_secs(5), "{target}: {} {}", answer.status, answer.body);
        std::thread::sleep(Duration::from_millis(20));
    }
}

pub(crate) struct Events {
    pub(crate) lines: std::io::Lines<BufReader<TcpStream>>,
}

impl Events {
    pub(crate) fn open(server: &Server, headers: &str) -> Self {
        let mut stream = connect(server.address());
        write!(stream, "GET /api/events HTTP/1.1\r\nHost: {}\r\n{headers}\r\n", server.address()).unwrap();
        let mut events = Self { lines: BufReader::new(stream).lines() };
        assert!(events.line().starts_with("HTTP/1.1 200"));
        events
    }

    pub(crate) fn line(&mut self) -> String {
        self.lines.next().unwrap().unwrap()
    }

    /// The next event: name, id (empty if it has none), data. What frames the chunks is passed over.
    pub(crate) fn next(&mut self) -> (String, String, Value) {
        let (mut name, mut id) = (String::new(), String::new());
        loop {
            let line = self.line();
            if let Some(text) = line.strip_prefix("event: ") {
                name = text.to_owned();
            } else if let Some(text) = line.strip_prefix("id: ") {
                id = text.to_owned();
            } else if let Some(text) = line.strip_prefix("data: ") {
                return (name, id, serde_json::from_str(text).unwrap());
            }
        }
    }

    pub(crate) fn next_named(&mut self, wanted: &str) -> (String, Value) {
        loop {
            let (name, id, data) = self.next();
            if name == wanted {
                return (id, data);
            }
        }
    }
}
