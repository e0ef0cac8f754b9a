//! Who is connected, and who has to make room: a seat per connection, few enough for one address that others get in, and none
//! that someone silent keeps from someone who comes.
//!
//! Called by the socket beside it. Knows no request.

use std::net::IpAddr;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::Notify;

pub(super) const SEATS: usize = 96;
/// Seats of one address, or of one network of IPv6.
pub(super) const SEATS_OF_ONE: usize = 72;
/// So long without a byte in either direction is silence. An open stream says something every second.
const SILENCE: Duration = Duration::from_secs(2);

#[derive(Debug)]
pub(super) struct Seats {
    begun: Instant,
    taken: Mutex<Vec<Arc<Place>>>,
}

/// A seat that is taken.
#[derive(Debug)]
struct Place {
    peer: IpAddr,
    /// Milliseconds from `begun` to the last byte.
    active_ms: AtomicU64,
    leave: Notify,
}

/// A seat that is taken until this is dropped.
#[derive(Debug)]
pub(super) struct Seat {
    seats: Arc<Seats>,
    place: Arc<Place>,
}

impl Seats {
    pub(super) fn new() -> Arc<Self> {
        Arc::new(Self { begun: Instant::now(), taken: Mutex::new(Vec::with_capacity(SEATS)) })
    }

    /// A seat for someone from this address, of whoever was silent for longest if there is none; `None` if no one is.
    pub(super) fn take(self: &Arc<Self>, peer: IpAddr) -> Option<Seat> {
        let peer = network(peer);
        let now_ms = self.now_ms();
        let mut taken = self.taken();
        let of_one = taken.iter().filter(|place| place.peer == peer).count();
        if of_one >= SEATS_OF_ONE || taken.len() >= SEATS {
            let active_ms = |place: &Arc<Place>| place.active_ms.load(Relaxed);
            let longest = taken
                .iter()
                .enumerate()
                .filter(|(_, place)| of_one < SEATS_OF_ONE || place.peer == peer)
                .min_by_key(|(_, place)| active_ms(place))
                .filter(|(_, place)| now_ms.saturating_sub(active_ms(place)) >= SILENCE.as_millis() as u64)
                .map(|(at, _)| at)?;
            taken.swap_remove(longest).leave.notify_one();
        }
        let place = Arc::new(Place { peer, active_ms: AtomicU64::new(now_ms), leave: Notify::new() });
        taken.push(Arc::clone(&place));
        Some(Seat { seats: Arc::clone(self), place })
    }

    fn taken(&self) -> MutexGuard<'_, Vec<Arc<Place>>> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn now_ms(&self) -> u64 {
        self.begun.elapsed().as_millis() as u64
    }
}

impl Seat {
    /// A byte has come or gone.
    pub(super) fn active(&self) {
        self.place.active_ms.store(self.seats.now_ms(), Relaxed);
    }

    /// Waits until another needs the seat.
    pub(super) async fn wanted(&self) {
        self.place.leave.notified().await;
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.seats.taken().retain(|place| !Arc::ptr_eq(place, &self.place));
    }
}

/// What counts as one: a network of IPv6 has as many addresses as someone likes.
fn network(peer: IpAddr) -> IpAddr {
    match peer.to_canonical() {
        IpAddr::V6(address) => IpAddr::V6((u128::from(address) & !u128::from(u64::MAX)).into()),
        address => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(last: u8) -> IpAddr {
        IpAddr::from([192, 0, 2, last])
    }

    #[test]
    fn one_address_leaves_seats_to_others_and_the_silent_leave_theirs_to_who_comes() {
        let seats = Seats::new();
        let mut of_one: Vec<Seat> = (0..SEATS_OF_ONE).map(|_| seats.take(from(1)).unwrap()).collect();
        assert!(seats.take(from(1)).is_none());
        let others: Vec<Seat> = (SEATS_OF_ONE..SEATS).map(|_| seats.take(from(2)).unwrap()).collect();
        assert!(seats.take(from(3)).is_none(), "full, and nobody is silent");
        std::thread::sleep(SILENCE + Duration::from_millis(50));
        of_one.iter().skip(1).chain(&others).for_each(Seat::active);
        let third = seats.take(from(3)).unwrap();
        assert!(seats.take(from(3)).is_none(), "only one was silent");
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            tokio::time::timeout(Duration::from_millis(100), of_one[0].wanted()).await.unwrap();
            let stays = tokio::time::timeout(Duration::from_millis(100), of_one[1].wanted());
            assert!(stays.await.is_err());
        });
        drop(third);
        of_one.clear();
        assert_eq!(seats.taken().len(), SEATS - SEATS_OF_ONE);
    }

    #[test]
    fn a_network_of_ipv6_is_one() {
        let of = |text: &str| network(text.parse().unwrap());
        assert_eq!(of("2001:db8::1"), of("2001:db8::ffff:1"));
        assert_ne!(of("2001:db8::1"), of("2001:db8:0:1::1"));
        assert_eq!(of("::ffff:192.0.2.1"), from(1));
    }
}
