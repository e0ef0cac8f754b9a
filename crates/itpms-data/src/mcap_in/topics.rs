//! Contents of a file: topics, the paths of the numbers in their messages, and their names as signals.
//!
//! A topic's messages are on one clock: their own stamps, where they have some and these agree with the recorder's clock, else when they were
//! published or, where that is not known, recorded.

use std::collections::HashMap;
use std::sync::Arc;

use itpms_core::model::Corner;
use prost_reflect::MessageDescriptor;

use super::fields::Fields;
use super::records::Message;
use super::{json, protobuf, ros};
use crate::log::Slot;
use crate::signals::{Candidate, column_unit, element_name};

/// Paths of a topic; a message in JSON may have other names each time.
const MOST_PATHS: usize = 4096;
/// A stamp further from the recorder's clock, in s, is on another one.
const SAME_CLOCK_S: f64 = 10.0;
/// Where messages have their stamps: of ROS, of Foxglove's schemas, in protobuf; whole seconds and nanoseconds.
const STAMPS: [&str; 3] = ["header.stamp", "timestamp", "stamp"];
const SECONDS: [&str; 2] = ["sec", "seconds"];
const NANOSECONDS: [&str; 3] = ["nanosec", "nsec", "nanos"];

/// Encoding of a topic's messages.
#[derive(Debug, Clone)]
enum Codec {
    Json,
    Ros(Arc<ros::Definition>),
    Protobuf(MessageDescriptor),
}

#[derive(Debug)]
pub(crate) struct Topic {
    pub(crate) name: String,
    codec: Result<Codec, String>,
    is_ros: bool,
    pub(crate) paths: Vec<String>,
    places: HashMap<String, usize>,
    /// Whether its own stamps agreed with the recorder's clock so far.
    has_own_clock: bool,
    /// Messages that were none by their schema.
    pub(crate) not_understood: u64,
}

#[derive(Debug, Default)]
pub(crate) struct Topics {
    schemas: HashMap<u16, (String, String, Vec<u8>)>,
    channels: HashMap<u16, usize>,
    pub(crate) topics: Vec<Topic>,
    /// The values of the last message: places of paths, and numbers.
    pub(crate) found: Vec<(usize, f64)>,
}

impl Topics {
    /// Takes a record; of a message, says of which topic and time in s it is, and puts its numbers into `found`.
    pub(crate) fn take(&mut self, message: Message<'_>) -> Option<(usize, f64)> {
        match message {
            Message::Schema { id, name, encoding, text } => {
                self.schemas.insert(id, (name, encoding, text));
                None
            }
            Message::Channel(channel) => {
                if self.channels.contains_key(&channel.id) {
                    return None;
                }
                let place = self.topics.iter().position(|topic| topic.name == channel.topic);
                let place = place.unwrap_or_else(|| {
                    let schema = self.schemas.get(&channel.schema_id);
                    self.topics.push(Topic::new(channel.topic, &channel.message_encoding, schema));
                    self.topics.len() - 1
                });
                self.channels.insert(channel.id, place);
                None
            }
            Message::Data { channel, log_ns, published_ns, bytes } => {
                let place = *self.channels.get(&channel)?;
                let topic = self.topics.get_mut(place)?;
                self.found.clear();
                topic.read(bytes, &mut self.found);
                Some((place, topic.time_s(log_ns, published_ns, &self.found)))
            }
        }
    }

    /// Why a topic has no signals, if it has none.
    pub(crate) fn unread(&self, topic: &Topic) -> Option<String> {
        let under = |root: &str| {
            topic.name.strip_prefix(root).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let is_ours =
            self.topics.iter().any(|topic| topic.name == "/signals" || topic.name.starts_with("/signals/"));
        match &topic.codec {
            Err(why) => Some(why.clone()),
            Ok(_) if is_ours && ["/estimate", "/road"].into_iter().any(under) => {
                Some("what was estimated of the drive in this file, no measurement".to_owned())
            }
            Ok(_) => None,
        }
    }
}

impl Topic {
    fn new(name: String, encoding: &str, schema: Option<&(String, String, Vec<u8>)>) -> Self {
        Self {
            name,
            codec: codec(encoding, schema),
            is_ros: matches!(encoding, "cdr" | "ros1"),
            paths: Vec::new(),
            places: HashMap::new(),
            has_own_clock: true,
            not_understood: 0,
        }
    }

    fn read(&mut self, bytes: &[u8], found: &mut Vec<(usize, f64)>) {
        let Self { codec, paths, places, .. } = self;
        let Ok(codec) = codec else { return };
        let mut take = |path: &str, value: f64| {
            let place = places.get(path).copied().or_else(|| {
                (paths.len() < MOST_PATHS).then(|| {
                    paths.push(path.to_owned());
                    places.insert(path.to_owned(), paths.len() - 1);
                    paths.len() - 1
                })
            });
            found.extend(place.map(|place| (place, value)));
        };
        let mut fields = Fields::new(&mut take);
        let understood = match codec {
            Codec::Json => json::walk(bytes, &mut fields),
            Codec::Ros(definition) => definition.walk(bytes, &mut fields),
            Codec::Protobuf(kind) => protobuf::walk(kind, bytes, &mut fields),
        };
        if !understood {
            self.not_understood += 1;
            found.clear();
        }
    }

    /// When a message was taken, in s on the file's clock.
    fn time_s(&mut self, log_ns: u64, published_ns: u64, found: &[(usize, f64)]) -> f64 {
        let log_s = log_ns as f64 / 1e9;
        let is_near = |time_s: &f64| (time_s - log_s).abs() < SAME_CLOCK_S;
        let own = if self.has_own_clock { self.own_s(found) } else { None };
        match own {
            Some(own_s) if is_near(&own_s) => own_s,
            own => {
                self.has_own_clock &= own.is_none();
                Some(published_ns as f64 / 1e9).filter(|_| published_ns > 0).filter(is_near).unwrap_or(log_s)
            }
        }
    }

    fn own_s(&self, found: &[(usize, f64)]) -> Option<f64> {
        let value = |stamp: &str, name: &str| {
            let place = self.places.get(&format!("{stamp}.{name}"))?;
            found.iter().find(|(of, _)| of == place).map(|(_, value)| *value)
        };
        STAMPS.into_iter().find_map(|stamp| {
            let seconds = SECONDS.into_iter().find_map(|name| value(stamp, name))?;
            let nanoseconds = NANOSECONDS.into_iter().find_map(|name| value(stamp, name)).unwrap_or(0.0);
            Some((seconds * 1e9 + nanoseconds) / 1e9)
        })
    }

    pub(crate) fn signal(&self, place: usize) -> Candidate {
        let path = self.paths.get(place).map_or("", String::as_str);
        let group = self.name.clone();
        let array = path.strip_suffix(']').and_then(|path| path.rsplit_once('['));
        let number = array.and_then(|(array, number)| Some((array, number.parse::<usize>().ok()?)));
        if let Some((array, number)) = number {
            let of = (0..).take_while(|k| self.places.contains_key(&format!("{array}[{k}]"))).count();
            let unit = self.unit(array);
            return Candidate { name: element_name(&group, array, &unit, number, of), group, unit };
        }
        // A topic per wheel, as this project writes them.
        let corner =
            Corner::ALL.into_iter().find(|corner| self.name.rsplit('/').next() == Some(corner.label()));
        let own = corner.map(|corner| format!("{}_{path}", corner.label()));
        let own = own.filter(|own| Slot::all().any(|slot| slot.name() == *own));
        Candidate { name: own.unwrap_or_else(|| path.to_owned()), group, unit: self.unit(path) }
    }

    /// The unit in the path's name; ROS has SI units throughout (REP 103).
    fn unit(&self, path: &str) -> String {
        let stated = column_unit::candidate(path).unit;
        let says = |word: &str| self.is_ros && path.split('.').any(|field| field == word);
        match stated.as_str() {
            "" if says("linear_acceleration") || says("accel") => "m/s^2".to_owned(),
            "" if says("angular_velocity") || says("angular") => "rad/s".to_owned(),
            "" if says("linear") || says("longitudinal_velocity") => "m/s".to_owned(),
            _ => stated,
        }
    }
}

/// Decoder of messages of this encoding and schema, or why they are not read.
fn codec(encoding: &str, schema: Option<&(String, String, Vec<u8>)>) -> Result<Codec, String> {
    let of_ros = |wire| match schema {
        Some((name, kind, text)) if matches!(kind.as_str(), "ros2msg" | "ros1msg") => {
            ros::Definition::parse(wire, name, &String::from_utf8_lossy(text))
                .map(|found| Codec::Ros(Arc::new(found)))
        }
        Some((_, kind, _)) => {
            Err(format!("described by a schema of kind {kind:?}, of which ros2msg and ros1msg are read"))
        }
        None => Err("without a schema".to_owned()),
    };
    match (encoding, schema) {
        ("json", _) => Ok(Codec::Json),
        ("cdr", _) => of_ros(ros::Wire::Cdr),
        ("ros1", _) => of_ros(ros::Wire::Ros1),
        ("protobuf", Some((name, _, text))) => protobuf::compile(name, text).map(Codec::Protobuf),
        ("protobuf", None) => Err("without a schema".to_owned()),
        (other, _) => Err(format!("messages in {other:?}, of which json, cdr, ros1 and protobuf are read")),
    }
}
