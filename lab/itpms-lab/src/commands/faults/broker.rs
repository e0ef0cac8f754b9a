//! A broker that goes when it is asked to: as much of MQTT 3.1.1 as publishing and subscribing need. It remembers what it has
//! acknowledged and nothing else, which is all that a judge has to know.

use std::io::{self, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle, sleep};
use std::time::Duration;

/// Longest time without a look for a new client.
const LOOK_EVERY: Duration = Duration::from_millis(5);

/// A broker on a port of this machine.
pub(super) struct Broker {
    address: SocketAddr,
    shared: Arc<Shared>,
    door: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    gone: AtomicBool,
    acknowledged: Mutex<Vec<(String, Vec<u8>)>>,
    clients: Mutex<Vec<TcpStream>>,
    subscribers: Mutex<Vec<TcpStream>>,
}

impl Broker {
    pub(super) fn new() -> io::Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let mut broker = Self { address: listener.local_addr()?, shared: Arc::default(), door: None };
        broker.open(listener)?;
        Ok(broker)
    }

    pub(super) fn port(&self) -> u16 {
        self.address.port()
    }

    /// Goes away in the middle of whatever there is.
    pub(super) fn leave(&mut self) {
        self.shared.gone.store(true, Relaxed);
        for client in lock(&self.shared.clients).drain(..) {
            let _ = client.shutdown(Shutdown::Both);
        }
        lock(&self.shared.subscribers).clear();
        if let Some(door) = self.door.take() {
            let _ = door.join();
        }
    }

    /// Is there again, under the same address.
    pub(super) fn come_back(&mut self) -> io::Result<()> {
        let listener = TcpListener::bind(self.address)?;
        self.open(listener)
    }

    /// What it has acknowledged: topics and messages.
    pub(super) fn acknowledged(&self) -> Vec<(String, Vec<u8>)> {
        lock(&self.shared.acknowledged).clone()
    }

    pub(super) fn has_subscriber(&self) -> bool {
        !lock(&self.shared.subscribers).is_empty()
    }

    pub(super) fn send(&self, topic: &str, payload: &[u8], id: u16) {
        let mut body = (topic.len() as u16).to_be_bytes().to_vec();
        body.extend_from_slice(topic.as_bytes());
        body.extend_from_slice(&id.max(1).to_be_bytes());
        body.extend_from_slice(payload);
        let mut packet = vec![0x32];
        let mut left = body.len();
        while left > 127 {
            packet.push((left % 128) as u8 | 0x80);
            left /= 128;
        }
        packet.push(left as u8);
        packet.extend_from_slice(&body);
        for subscriber in lock(&self.shared.subscribers).iter_mut() {
            let _ = subscriber.write_all(&packet);
        }
    }

    fn open(&mut self, listener: TcpListener) -> io::Result<()> {
        listener.set_nonblocking(true)?;
        self.shared.gone.store(false, Relaxed);
        let shared = Arc::clone(&self.shared);
        self.door = Some(thread::spawn(move || {
            while !shared.gone.load(Relaxed) {
                let Ok((client, _)) = listener.accept() else {
                    sleep(LOOK_EVERY);
                    continue;
                };
                let shared = Arc::clone(&shared);
                let _ = client.set_nonblocking(false);
                if let Ok(kept) = client.try_clone() {
                    lock(&shared.clients).push(kept);
                    thread::spawn(move || converse(client, &shared));
                }
            }
        }));
        Ok(())
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        self.leave();
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One client until it or the broker goes. Bytes that are no MQTT end it.
fn converse(mut client: TcpStream, shared: &Shared) -> Option<()> {
    loop {
        let (kind, body) = packet(&mut client).ok()?;
        let number = |at: usize| Some(u16::from_be_bytes([*body.get(at)?, *body.get(at + 1)?]));
        match kind >> 4 {
            1 => client.write_all(&[0x20, 2, 0, 0]).ok()?,
            3 => {
                let end = 2 + usize::from(number(0)?);
                let topic = String::from_utf8_lossy(body.get(2..end)?).into_owned();
                if kind & 0b110 == 0 {
                    continue;
                }
                let id = number(end)?.to_be_bytes();
                // Remembered only if the acknowledgement goes out: what is lost on the way is the client's to send again.
                client.write_all(&[0x40, 2, id[0], id[1]]).ok()?;
                lock(&shared.acknowledged).push((topic, body.get(end + 2..)?.to_vec()));
            }
            8 => {
                let id = number(0)?.to_be_bytes();
                client.write_all(&[0x90, 3, id[0], id[1], 1]).ok()?;
                lock(&shared.subscribers).push(client.try_clone().ok()?);
            }
            12 => client.write_all(&[0xd0, 0]).ok()?,
            14 => return None,
            _ => {}
        }
    }
}

fn packet(client: &mut TcpStream) -> io::Result<(u8, Vec<u8>)> {
    let mut byte = [0];
    client.read_exact(&mut byte)?;
    let kind = byte[0];
    let mut length = 0usize;
    for shift in [0, 7, 14, 21] {
        client.read_exact(&mut byte)?;
        length |= usize::from(byte[0] & 0x7f) << shift;
        if byte[0] & 0x80 == 0 {
            break;
        }
    }
    if length > 1 << 20 {
        return Err(io::ErrorKind::InvalidData.into());
    }
    let mut body = vec![0; length];
    client.read_exact(&mut body)?;
    Ok((kind, body))
}
