//! The socket: how long each connection may take over what. How many there are at once is the seats' business.
//!
//! Called by [`Server::start`](super::Server::start). Knows no request.

use std::io::{self, Write as _};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::sync::oneshot;

use super::patient::Patient;
use super::seats::{Seat, Seats};
use super::{Options, pump, routes};
use crate::hub::Hub;

/// Time for a request to be complete, and for a connection to stay without one.
const REQUEST: Duration = Duration::from_secs(5);
/// Time for a client to take a part of its answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Bytes that wait in the system for one client; it doubles them. About five seconds of snapshots.
const SEND_BUFFER: u32 = 64 * 1024;
/// Bytes of a request, and of an answer's piece that is prepared for sending at once.
const REQUEST_BYTES: usize = 64 * 1024;

/// Takes the address. To be called inside a runtime.
pub(super) fn bind(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = if address.is_ipv4() { TcpSocket::new_v4()? } else { TcpSocket::new_v6()? };
    // So that a restarted monitor finds its address free although old connections linger.
    #[cfg(not(windows))]
    socket.set_reuseaddr(true)?;
    // Connections inherit it. A slow one then stops its stream early instead of letting it run seconds behind.
    socket.set_send_buffer_size(SEND_BUFFER)?;
    socket.bind(address)?;
    socket.listen(128)
}

/// Accepts until asked to stop.
pub(super) async fn serve(
    listener: TcpListener,
    options: Options,
    hub: Arc<Hub>,
    mut stopped: oneshot::Receiver<()>,
) {
    let router = {
        let newest = pump::start(&hub);
        routes::router(options, hub, newest)
    };
    let seats = Seats::new();
    loop {
        let accepted = tokio::select! {
            _ = &mut stopped => return,
            accepted = listener.accept() => accepted,
        };
        let Ok((stream, peer)) = accepted else {
            // Out of file handles, or the client is gone again: neither is helped by hurry.
            tokio::time::sleep(Duration::from_millis(100)).await;
            continue;
        };
        match seats.take(peer.ip()) {
            Some(seat) => drop(tokio::spawn(converse(stream, router.clone(), Arc::new(seat)))),
            None => refuse(stream),
        }
    }
}

/// One connection from its first request to its end. Whatever ends it is the client's business.
async fn converse(stream: TcpStream, router: Router, seat: Arc<Seat>) {
    // Snapshots are small and wanted at once.
    let _ = stream.set_nodelay(true);
    let stream = TokioIo::new(Patient::new(stream, PATIENCE, Arc::clone(&seat)));
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(REQUEST)
        .max_headers(64)
        .max_buf_size(REQUEST_BYTES)
        .serve_connection(stream, TowerToHyperService::new(router));
    tokio::select! {
        _ = served => {}
        () = seat.wanted() => {}
    }
}

/// Says that there is no room, as far as that can be done without waiting.
fn refuse(stream: TcpStream) {
    const FULL: &[u8] =
        b"HTTP/1.1 503 Service Unavailable\r\nRetry-After: 5\r\nConnection: close\r\nContent-Length: 0\r\n\r\n";
    let _ = stream.into_std().and_then(|mut stream| stream.write(FULL));
}
