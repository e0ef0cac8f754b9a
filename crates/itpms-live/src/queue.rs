//! A bounded queue between two threads, with both answers to "what if it is full": wait, or lose the oldest and count it.
//!
//! Between a source and the estimating thread, and between that and every output. Knows nothing of its items.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A bounded queue, shared by reference.
#[derive(Debug)]
pub struct Queue<T> {
    inner: Mutex<Inner<T>>,
    filled: Condvar,
    emptied: Condvar,
    capacity: usize,
}

#[derive(Debug)]
struct Inner<T> {
    items: VecDeque<T>,
    closed: bool,
    dropped: u64,
}

/// The outcome of waiting for items.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Taken {
    Some,
    /// None in the time given.
    Nothing,
    /// None, and there will never be one.
    Closed,
}

impl<T> Queue<T> {
    pub fn new(capacity: usize) -> Self {
        let inner = Inner { items: VecDeque::new(), closed: false, dropped: 0 };
        Self { inner: Mutex::new(inner), filled: Condvar::new(), emptied: Condvar::new(), capacity }
    }

    /// Adds all items, waiting for room before each when there is none. `false` if the queue was closed: what had no room then is gone.
    pub fn push_all(&self, items: impl IntoIterator<Item = T>) -> bool {
        let mut inner = self.lock();
        for item in items {
            while inner.items.len() >= self.capacity && !inner.closed {
                self.filled.notify_one();
                inner = self.emptied.wait(inner).unwrap_or_else(PoisonError::into_inner);
            }
            if inner.closed {
                return false;
            }
            inner.items.push_back(item);
        }
        drop(inner);
        self.filled.notify_one();
        true
    }

    /// Adds an item, waiting for room.
    pub fn push(&self, item: T) -> bool {
        self.push_all([item])
    }

    /// Adds an item at once. If there is no room, the oldest item goes that may go, and is counted; if none may, the oldest.
    pub fn push_now(&self, item: T, may_go: impl Fn(&T) -> bool) {
        let mut inner = self.lock();
        if inner.closed {
            return;
        }
        if inner.items.len() >= self.capacity {
            let place = inner.items.iter().position(may_go).unwrap_or(0);
            inner.items.remove(place);
            inner.dropped += 1;
        }
        inner.items.push_back(item);
        drop(inner);
        self.filled.notify_one();
    }

    /// Moves everything there is to `into`, waiting for at most `patience` if there is nothing.
    pub fn take(&self, into: &mut VecDeque<T>, patience: Duration) -> Taken {
        let inner = self.lock();
        let empty = |inner: &mut Inner<T>| inner.items.is_empty() && !inner.closed;
        let waited = self.filled.wait_timeout_while(inner, patience, empty);
        let (mut inner, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if inner.items.is_empty() {
            return if inner.closed { Taken::Closed } else { Taken::Nothing };
        }
        if into.is_empty() {
            std::mem::swap(into, &mut inner.items);
        } else {
            into.append(&mut inner.items);
        }
        drop(inner);
        self.emptied.notify_all();
        Taken::Some
    }

    /// Nothing more goes in; what is inside can still be taken.
    pub fn close(&self) {
        self.lock().closed = true;
        self.filled.notify_all();
        self.emptied.notify_all();
    }

    /// Items lost for want of room.
    pub fn dropped(&self) -> u64 {
        self.lock().dropped
    }

    /// A thread that panicked while it held the lock leaves whole items behind.
    fn lock(&self) -> MutexGuard<'_, Inner<T>> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::thread;

    const SOON: Duration = Duration::from_millis(20);

    #[test]
    fn without_room_the_oldest_that_may_go_is_lost_and_counted() {
        let queue = Queue::new(3);
        (1..=5).for_each(|i| queue.push_now(i, |i| *i != 1));
        let mut taken = VecDeque::new();
        assert_eq!(queue.take(&mut taken, SOON), Taken::Some);
        assert_eq!((taken.into_iter().collect::<Vec<_>>(), queue.dropped()), (vec![1, 4, 5], 2));
        assert_eq!(queue.take(&mut VecDeque::new(), SOON), Taken::Nothing);
    }

    #[test]
    fn who_waits_for_room_loses_nothing_and_a_closed_queue_is_emptied_first() {
        let queue = Arc::new(Queue::new(7));
        let filler = thread::spawn({
            let queue = Arc::clone(&queue);
            move || {
                assert!(queue.push_all(0..10_000));
                queue.close();
                assert!(!queue.push(1));
            }
        });
        let (mut seen, mut taken) = (Vec::new(), VecDeque::new());
        while queue.take(&mut taken, Duration::from_secs(5)) == Taken::Some {
            assert!(taken.len() <= 7);
            seen.extend(taken.drain(..));
        }
        filler.join().unwrap();
        assert!(seen.into_iter().eq(0..10_000));
        assert_eq!(queue.dropped(), 0);
    }
}
