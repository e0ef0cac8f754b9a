//! The broker's queue: messages in their order until they are acknowledged, and the newest estimate.
//!
//! Filled by the output's thread, emptied by the link. Knows nothing of sockets.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::Notify;

/// Messages that wait at most, each some 500 bytes.
pub(super) const MOST: usize = 4096;
/// Messages that are on their way at once.
const ON_THEIR_WAY: usize = 16;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) topic: String,
    pub(super) payload: Vec<u8>,
}

#[derive(Debug)]
pub(super) struct Outbox {
    waiting: VecDeque<Message>,
    /// Sent and not acknowledged, with the packet's number once it has one.
    sent: VecDeque<(Option<u16>, Message)>,
    /// The newest estimate, if it was not sent.
    pub(super) newest: Option<Vec<u8>>,
    /// Messages that had no room.
    pub(super) lost: u64,
    online: Message,
    connected: bool,
    closed: Option<Instant>,
}

impl Outbox {
    pub(super) fn new(prefix: &str) -> Self {
        Self {
            waiting: VecDeque::new(),
            sent: VecDeque::new(),
            newest: None,
            lost: 0,
            online: status(prefix, "online"),
            connected: false,
            closed: None,
        }
    }

    /// A message that has to arrive.
    pub(super) fn post(&mut self, topic: String, payload: Vec<u8>) {
        if self.waiting.len() >= MOST {
            self.waiting.pop_front();
            self.lost += 1;
        }
        self.waiting.push_back(Message { topic, payload });
    }

    /// The next message to be sent, if the link is there and not too much is on its way.
    pub(super) fn send(&mut self) -> Option<Message> {
        if !self.connected || self.sent.len() >= ON_THEIR_WAY {
            return None;
        }
        let message = self.waiting.pop_front()?;
        self.sent.push_back((None, message.clone()));
        Some(message)
    }

    /// The estimate to be sent, if the link is there.
    pub(super) fn send_newest(&mut self) -> Option<Vec<u8>> {
        if self.connected { self.newest.take() } else { None }
    }

    /// The oldest message without a number has this one.
    pub(super) fn numbered(&mut self, number: u16) {
        if let Some((place, _)) = self.sent.iter_mut().find(|(known, _)| known.is_none()) {
            *place = Some(number);
        }
    }

    pub(super) fn acknowledged(&mut self, number: u16) {
        self.sent.retain(|(known, _)| *known != Some(number));
    }

    pub(super) fn connected(&mut self) {
        self.connected = true;
        if self.closed.is_none() {
            self.waiting.push_front(self.online.clone());
        }
    }

    /// The connection is gone: what was sent and not acknowledged waits again, in its order. Gives how many those are.
    pub(super) fn disconnected(&mut self) -> usize {
        self.connected = false;
        let count = self.sent.len();
        let online = &self.online;
        for (_, message) in self.sent.drain(..).rev().filter(|(_, message)| message != online) {
            self.waiting.push_front(message);
        }
        self.waiting.retain(|message| message != online);
        count
    }

    /// There will be nothing more; the link has so much time.
    pub(super) fn close(&mut self, prefix: &str, patience: Duration) {
        self.waiting.push_back(status(prefix, "offline"));
        self.closed = Some(Instant::now() + patience);
    }

    /// Whether the link can go: everything has arrived, or the time is over.
    pub(super) fn is_done(&self) -> bool {
        self.closed.is_some_and(|until| self.left() == 0 || Instant::now() >= until)
    }

    /// Messages that have not arrived.
    pub(super) fn left(&self) -> usize {
        self.waiting.len() + self.sent.len()
    }
}

pub(super) fn status(prefix: &str, state: &str) -> Message {
    Message { topic: format!("{prefix}/status"), payload: format!("{{\"state\":\"{state}\"}}").into_bytes() }
}

/// The outbox between two threads.
#[derive(Debug)]
pub(super) struct Shared {
    outbox: Mutex<Outbox>,
    pub(super) changed: Notify,
}

impl Shared {
    pub(super) fn new(outbox: Outbox) -> Self {
        Self { outbox: Mutex::new(outbox), changed: Notify::new() }
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Outbox> {
        self.outbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sent(outbox: &mut Outbox) -> Vec<String> {
        let texts = std::iter::from_fn(|| outbox.send());
        texts.map(|message| String::from_utf8(message.payload).unwrap()).collect()
    }

    #[test]
    fn what_was_not_acknowledged_is_sent_again_in_its_order() {
        let mut outbox = Outbox::new("car");
        ["a", "b", "c"].into_iter().for_each(|text| outbox.post("car/warning".to_owned(), text.into()));
        assert!(outbox.send().is_none(), "without a connection nothing is sent");
        outbox.connected();
        assert_eq!(sent(&mut outbox), [r#"{"state":"online"}"#, "a", "b", "c"]);
        (1..=4).for_each(|number| outbox.numbered(number));
        outbox.acknowledged(1);
        // Not in their order: brokers may.
        outbox.acknowledged(3);
        outbox.post("car/warning".to_owned(), "d".into());
        assert_eq!(outbox.disconnected(), 2);
        outbox.connected();
        assert_eq!(sent(&mut outbox), [r#"{"state":"online"}"#, "a", "c", "d"]);
        (5..=8).for_each(|number| outbox.numbered(number));
        (5..=8).for_each(|number| outbox.acknowledged(number));
        assert_eq!(outbox.left(), 0);
        outbox.close("car", Duration::from_secs(60));
        assert!(!outbox.is_done());
        assert_eq!(sent(&mut outbox), [r#"{"state":"offline"}"#]);
        outbox.numbered(9);
        outbox.acknowledged(9);
        assert!(outbox.is_done());
    }

    #[test]
    fn beyond_the_bound_the_oldest_are_lost_and_counted() {
        let mut outbox = Outbox::new("car");
        for i in 0..MOST + 3 {
            outbox.post("car/warning".to_owned(), i.to_string().into_bytes());
        }
        assert_eq!((outbox.left(), outbox.lost), (MOST, 3));
    }
}
