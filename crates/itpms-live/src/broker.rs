//! Where an MQTT broker is, and how it is asked: shared by the source and the output.

use std::time::Duration;

use rumqttc::{MqttOptions, NetworkOptions};

use crate::error::LiveError;

/// Without a word from the broker for so long the connection is taken for dead.
const KEEP_ALIVE: Duration = Duration::from_secs(5);
/// Time for a connection to be made, in s.
const CONNECT_S: u64 = 5;
/// Longest message in bytes, in and out.
const LONGEST: usize = 1 << 20;
/// Waiting time before the first new attempt; it doubles.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
/// Longest waiting time between two attempts.
const LONGEST_PAUSE: Duration = Duration::from_secs(5);

/// `mqtt://HOST[:PORT]/TOPIC`, without encryption and without a password.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BrokerAddress {
    /// Name or address.
    pub host: String,
    /// 1883 unless given.
    pub port: u16,
    /// Topic, or what topics begin with.
    pub topic: String,
}

impl BrokerAddress {
    /// Reads an address.
    ///
    /// # Errors
    /// It has another form.
    pub fn parse(text: &str) -> Result<Self, LiveError> {
        let read = || {
            let (place, topic) = text.strip_prefix("mqtt://")?.split_once('/')?;
            let (host, port) = match place.rsplit_once(':') {
                // An IPv6 address ends in its bracket.
                Some((host, port)) if !port.ends_with(']') => (host, port.parse().ok()?),
                _ => (place, 1883),
            };
            let host = host.trim_start_matches('[').trim_end_matches(']');
            let topic = topic.trim_matches('/');
            let whole = !host.is_empty() && !host.contains('@') && !topic.is_empty();
            whole.then(|| Self { host: host.to_owned(), port, topic: topic.to_owned() })
        };
        read().ok_or_else(|| LiveError::BrokerAddress { found: text.to_owned() })
    }

    /// What a client of ours asks of the broker. A new session at every connection: what was not acknowledged is kept here, for
    /// a broker that was restarted may have forgotten it.
    pub(crate) fn options(&self, role: &str) -> (MqttOptions, NetworkOptions) {
        let id = format!("itpms-{role}-{}", std::process::id());
        let mut options = MqttOptions::new(id, self.host.clone(), self.port);
        options.set_keep_alive(KEEP_ALIVE);
        options.set_clean_session(true);
        options.set_max_packet_size(LONGEST, LONGEST);
        let mut network = NetworkOptions::new();
        network.set_connection_timeout(CONNECT_S);
        network.set_tcp_nodelay(true);
        (options, network)
    }
}

/// Pauses between attempts that double.
#[derive(Debug)]
pub(crate) struct Backoff(Duration);

impl Default for Backoff {
    fn default() -> Self {
        Self(FIRST_PAUSE)
    }
}

impl Backoff {
    /// The next pause.
    pub(crate) fn next(&mut self) -> Duration {
        let pause = self.0;
        self.0 = (2 * self.0).min(LONGEST_PAUSE);
        pause
    }

    /// It worked.
    pub(crate) fn reset(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_or_refused() {
        let read = |text| BrokerAddress::parse(text).map(|a| (a.host, a.port, a.topic)).ok();
        let is = |host: &str, port, topic: &str| Some((host.to_owned(), port, topic.to_owned()));
        assert_eq!(read("mqtt://127.0.0.1:1884/cars/7"), is("127.0.0.1", 1884, "cars/7"));
        assert_eq!(read("mqtt://broker/cars/"), is("broker", 1883, "cars"));
        assert_eq!(read("mqtt://[::1]:99/a"), is("::1", 99, "a"));
        assert_eq!(read("mqtt://[::1]/a"), is("::1", 1883, "a"));
        for wrong in ["127.0.0.1:1883/a", "mqtt://h:1883", "mqtt://h/", "mqtt://h:x/a", "mqtt://u:p@h/a"] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
