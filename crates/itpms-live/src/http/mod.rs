//! The page of the live monitor, and what scripts and scrapers read beside it, over HTTP.
//!
//! Started by `itpms monitor --http`. Runs in one thread of its own with its own small runtime, so that nothing a client does reaches the
//! estimating thread. Read-only: there is nothing a request could change. It sees the car through the [`Hub`] alone and never opens a file.
//!
//! | address | gives |
//! |---|---|
//! | `/` and `/assets/*` | the page, from memory |
//! | `/api/snapshot` | the newest snapshot |
//! | `/api/history` | the last quarter of an hour, column by column |
//! | `/api/events` | server-sent events: history first, then snapshots, at most ten a second |
//! | `/healthz` | 200 while data is fresh, else 503 and why |
//! | `/metrics` | the same numbers for Prometheus |

mod assets;
mod events;
mod guard;
mod health;
mod history;
mod listen;
mod metrics;
mod patient;
mod pump;
mod routes;
mod seats;
mod shared;

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread::JoinHandle;

use itpms_core::model::PressureUnit;
use tokio::sync::oneshot;

use crate::hub::Hub;

#[derive(Debug, Clone)]
pub struct Options {
    /// Where to listen; port 0 takes a free one.
    pub address: SocketAddr,
    /// Names besides addresses, `localhost`, names without a dot and `*.local` under which the page may be asked for. A page
    /// of another whose name was made to point here is refused by this.
    pub hosts: Vec<String>,
    /// Origins such as `https://fleet.example.com` whose pages may read the stream; all others are refused.
    pub origins: Vec<String>,
    /// Unit in which the page shows pressures.
    pub pressure_unit: PressureUnit,
}

impl Options {
    /// Own pages only, at this address, in kPa.
    pub fn new(address: SocketAddr) -> Self {
        Self { address, hosts: Vec::new(), origins: Vec::new(), pressure_unit: PressureUnit::Kpa }
    }
}

/// Why the page cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum HttpError {
    #[error("cannot listen on {address}: {source}")]
    Listen { address: SocketAddr, source: io::Error },
    #[error("cannot start the web server: {0}")]
    Start(io::Error),
}

/// A running server. Dropping it closes all connections and waits for its thread.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Starts to listen. Errors: [`HttpError`] if the address cannot be had.
    pub fn start(options: Options, hub: Arc<Hub>) -> Result<Self, HttpError> {
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(HttpError::Start)?;
        let failed = |source| HttpError::Listen { address: options.address, source };
        let listener = {
            let _inside = runtime.enter();
            listen::bind(options.address).map_err(failed)?
        };
        let address = listener.local_addr().map_err(failed)?;
        let (stop, stopped) = oneshot::channel();
        let thread = std::thread::Builder::new()
            .name("http".to_owned())
            .spawn(move || {
                runtime.block_on(listen::serve(listener, options, hub, stopped));
                // Tasks of clients that are still there end with the runtime.
            })
            .map_err(HttpError::Start)?;
        Ok(Self { address, stop: Some(stop), thread: Some(thread) })
    }

    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Whether other machines can reach it: to be reported loudly, as there is no password.
    pub fn is_open_to_others(&self) -> bool {
        !self.address.ip().is_loopback()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A panic in there has been reported by its own thread.
            let _ = thread.join();
        }
    }
}
