//! Where an MQTT broker is, and how it is asked: shared by the source and the output.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rumqttc::{MqttOptions, NetworkOptions, TlsConfiguration, Transport};
use rustls::ClientConfig;

use crate::error::LiveError;
use crate::tls;

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

/// `mqtt://[USER@]HOST[:PORT]/TOPIC`, or `mqtts://` with encryption.
#[derive(Debug, Clone)]
pub struct BrokerAddress {
    pub host: String,
    /// 1883 unless given, 8883 with encryption.
    pub port: u16,
    pub topic: String,
    pub user: Option<String>,
    password: Option<Password>,
    encryption: Encryption,
}

/// A secret that is never printed.
#[derive(Clone)]
pub struct Password(String);

impl Password {
    pub fn new(text: String) -> Self {
        Self(text)
    }
}

impl std::fmt::Debug for Password {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Password")
    }
}

#[derive(Debug, Clone)]
enum Encryption {
    None,
    /// Whom to believe is not known yet.
    Wanted,
    Tls(Arc<ClientConfig>),
}

impl BrokerAddress {
    /// Reads an address. Errors: it has another form.
    pub fn parse(text: &str) -> Result<Self, LiveError> {
        let read = || {
            let (encryption, usual_port, rest) = match text.strip_prefix("mqtts://") {
                Some(rest) => (Encryption::Wanted, 8883, rest),
                None => (Encryption::None, 1883, text.strip_prefix("mqtt://")?),
            };
            let (place, topic) = rest.split_once('/')?;
            let (user, place) = match place.rsplit_once('@') {
                Some((user, place)) => (Some(user.to_owned()), place),
                None => (None, place),
            };
            let (host, port) = match place.rsplit_once(':') {
                // An IPv6 address ends in its bracket.
                Some((host, port)) if !port.ends_with(']') => (host, port.parse().ok()?),
                _ => (place, usual_port),
            };
            let host = host.trim_start_matches('[').trim_end_matches(']');
            let topic = topic.trim_matches('/');
            let whole = !host.is_empty() && !topic.is_empty() && user.as_deref() != Some("");
            let (host, topic) = (host.to_owned(), topic.to_owned());
            whole.then_some(Self { host, port, topic, user, password: None, encryption })
        };
        let address = read().ok_or_else(|| LiveError::BrokerAddress { found: text.to_owned() })?;
        if address.user.as_ref().is_some_and(|user| user.contains(':')) {
            // Not shown again either.
            return Err(LiveError::PasswordInAddress);
        }
        Ok(address)
    }

    /// The same with a password, and with whom to believe that it is this broker: whom the certificates in `ca` have signed, or whom the
    /// system believes. Errors: there is a password and no user, or certificates and no encryption; or no certificate can be had.
    pub fn with_access(mut self, password: Option<Password>, ca: Option<&Path>) -> Result<Self, LiveError> {
        if password.is_some() && self.user.is_none() {
            return Err(LiveError::Refused(
                "a password without a user, expected mqtts://USER@HOST".to_owned(),
            ));
        }
        self.password = password;
        match (&self.encryption, ca) {
            (Encryption::None, None) => {}
            (Encryption::None, Some(path)) => {
                let text = format!("{}: certificates without encryption, expected mqtts://", path.display());
                return Err(LiveError::Refused(text));
            }
            _ => {
                let name = || {
                    ca.map_or_else(|| "the system's certificates".to_owned(), |ca| ca.display().to_string())
                };
                let client = tls::client(ca);
                let client = client.map_err(|error| LiveError::Certificates { name: name(), error })?;
                self.encryption = Encryption::Tls(client);
            }
        }
        Ok(self)
    }

    /// Whether someone on the way could read a password of this address.
    pub fn shows_password(&self) -> bool {
        let host = self.host.as_str();
        let here = host == "localhost" || host.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback());
        self.password.is_some() && matches!(self.encryption, Encryption::None) && !here
    }

    /// How the broker is called in messages: no user, no topic.
    pub(crate) fn place(&self) -> String {
        let scheme = if matches!(self.encryption, Encryption::None) { "mqtt" } else { "mqtts" };
        format!("{scheme}://{}:{}", self.host, self.port)
    }

    /// Options of a connection to the broker. A new session at every connection: unacknowledged messages are kept here, for
    /// a broker that was restarted may have forgotten it.
    pub(crate) fn options(&self, role: &str) -> (MqttOptions, NetworkOptions) {
        let id = format!("itpms-{role}-{}", std::process::id());
        let mut options = MqttOptions::new(id, self.host.clone(), self.port);
        options.set_keep_alive(KEEP_ALIVE);
        options.set_clean_session(true);
        options.set_max_packet_size(LONGEST, LONGEST);
        if let Some(user) = &self.user {
            let password = self.password.as_ref().map_or("", |password| &password.0);
            options.set_credentials(user, password);
        }
        match &self.encryption {
            Encryption::None => {}
            // Never without encryption where it was asked for: an empty store trusts none.
            Encryption::Wanted => drop(options.set_transport(Transport::tls(Vec::new(), None, None))),
            Encryption::Tls(client) => {
                let tls = TlsConfiguration::Rustls(Arc::clone(client));
                options.set_transport(Transport::tls_with_config(tls));
            }
        }
        let mut network = NetworkOptions::new();
        network.set_connection_timeout(CONNECT_S);
        network.set_tcp_nodelay(true);
        (options, network)
    }
}

/// Pauses between attempts that double, until a connection has lasted: a broker that takes everybody and sends them away again at once (a
/// second client of our name, no right to the topic) is not asked ten times a second.
#[derive(Debug)]
pub(crate) struct Backoff {
    pause: Duration,
    connected: Option<Instant>,
}

impl Default for Backoff {
    fn default() -> Self {
        Self { pause: FIRST_PAUSE, connected: None }
    }
}

impl Backoff {
    pub(crate) fn next(&mut self) -> Duration {
        self.next_at(Instant::now())
    }

    fn next_at(&mut self, now: Instant) -> Duration {
        let lasted = self.connected.take().map(|since| now.saturating_duration_since(since));
        if lasted.is_some_and(|lasted| lasted >= LONGEST_PAUSE) {
            self.reset();
        }
        let pause = self.pause;
        self.pause = (2 * self.pause).min(LONGEST_PAUSE);
        pause
    }

    pub(crate) fn connected(&mut self) {
        self.connected = Some(Instant::now());
    }

    pub(crate) fn reset(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_connection_that_does_not_last_shortens_no_pause() {
        let mut backoff = Backoff::default();
        let mut pauses = Vec::new();
        for _ in 0..8 {
            backoff.connected();
            pauses.push(backoff.next().as_millis());
        }
        assert_eq!(pauses, [100, 200, 400, 800, 1600, 3200, 5000, 5000]);
        backoff.connected();
        assert_eq!(backoff.next_at(Instant::now() + LONGEST_PAUSE), FIRST_PAUSE, "one that has lasted does");
        assert_eq!(backoff.next(), 2 * FIRST_PAUSE, "and no connection is none");
    }

    #[test]
    fn addresses_are_read_or_refused() {
        let read = |text| BrokerAddress::parse(text).map(|a| (a.host, a.port, a.topic)).ok();
        let is = |host: &str, port, topic: &str| Some((host.to_owned(), port, topic.to_owned()));
        assert_eq!(read("mqtt://127.0.0.1:1884/cars/7"), is("127.0.0.1", 1884, "cars/7"));
        assert_eq!(read("mqtt://broker/cars/"), is("broker", 1883, "cars"));
        assert_eq!(read("mqtt://[::1]:99/a"), is("::1", 99, "a"));
        assert_eq!(read("mqtt://[::1]/a"), is("::1", 1883, "a"));
        assert_eq!(read("mqtts://broker/a"), is("broker", 8883, "a"));
        assert_eq!(read("mqtts://car7@broker:99/a"), is("broker", 99, "a"));
        for wrong in
            ["127.0.0.1:1883/a", "mqtt://h:1883", "mqtt://h/", "mqtt://h:x/a", "mqtt://@h/a", "http://h/a"]
        {
            assert_eq!(read(wrong), None, "{wrong}");
        }
        let user = |text| BrokerAddress::parse(text).unwrap().user;
        assert_eq!(user("mqtts://car7@broker/a").as_deref(), Some("car7"));
        assert_eq!(user("mqtt://broker/a@b"), None);
    }

    #[test]
    fn a_password_is_neither_taken_from_an_address_nor_shown() {
        let refused = BrokerAddress::parse("mqtts://car7:secret@broker/a").unwrap_err().to_string();
        assert!(refused.contains("--mqtt-password-file") && !refused.contains("secret"), "{refused}");
        let password = || Some(Password::new("secret".to_owned()));
        let open = |text: &str| BrokerAddress::parse(text).unwrap();
        let address = open("mqtt://car7@broker/a").with_access(password(), None).unwrap();
        assert!(address.shows_password() && !format!("{address:?}").contains("secret"));
        assert!(!open("mqtt://car7@127.0.0.1/a").with_access(password(), None).unwrap().shows_password());
        assert!(open("mqtt://broker/a").with_access(password(), None).is_err(), "nobody's password");
        assert!(open("mqtt://broker/a").with_access(None, Some(Path::new("ca.pem"))).is_err());
    }

    #[test]
    fn certificates_that_are_none_are_refused_with_their_name() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("ca.pem");
        std::fs::write(&path, "no certificate").unwrap();
        let address = || BrokerAddress::parse("mqtts://broker/a").unwrap();
        let refused = address().with_access(None, Some(&path)).unwrap_err().to_string();
        assert!(refused.ends_with("ca.pem: no certificate, expected one or more in PEM"), "{refused}");
        assert!(address().with_access(None, Some(&dir.path().join("none.pem"))).is_err());
    }
}
