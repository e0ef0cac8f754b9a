//! Shared by all handlers: the hub, the newest snapshot, which run this is.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::time::{SystemTime, UNIX_EPOCH};

use super::health::Health;
use super::pump::Newest;
use crate::hub::Hub;

#[derive(Debug)]
pub(super) struct Shared {
    pub(super) hub: Arc<Hub>,
    pub(super) newest: Newest,
    /// Tells this run of the monitor from the next one, whose counters start again.
    pub(super) run: String,
    pub(super) streams: AtomicUsize,
}

impl Shared {
    pub(super) fn health(&self) -> Health {
        Health::of(self.newest.borrow().as_deref())
    }
}

pub(super) fn unix_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(f64::NAN, |since| since.as_secs_f64())
}
