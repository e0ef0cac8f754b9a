//! Which address gives what.
//!
//! Called once, when the server starts.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use serde_json::json;

use super::guard::{Guard, watch};
use super::history::columns;
use super::pump::{Newest, json};
use super::shared::{Shared, unix_s};
use super::{Options, assets, events, metrics};
use crate::hub::Hub;

pub(super) fn router(options: Options, hub: Arc<Hub>, newest: Newest) -> Router {
    let guard = Arc::new(Guard::new(&options.hosts, &options.origins));
    let run = format!("{:x}", (unix_s() * 1e3) as u64);
    let shared = Arc::new(Shared { hub, newest, run, streams: AtomicUsize::new(0) });
    assets::routes(options.pressure_unit)
        .route("/api/snapshot", get(snapshot))
        .route("/api/history", get(history))
        .route("/api/events", get(stream))
        .route("/healthz", get(healthz))
        .route("/metrics", get(scrape))
        .fallback(|| std::future::ready((StatusCode::NOT_FOUND, "There is nothing at this address.\n")))
        .with_state(shared)
        .layer(from_fn_with_state(guard, watch))
}

fn give_json(status: StatusCode, body: Bytes) -> Response {
    (status, [(CONTENT_TYPE, "application/json"), (CACHE_CONTROL, "no-store")], body).into_response()
}

async fn snapshot(State(shared): State<Arc<Shared>>) -> Response {
    let newest = shared.newest.borrow().clone();
    match newest {
        Some(frame) => give_json(StatusCode::OK, frame.json()),
        None => give_json(StatusCode::SERVICE_UNAVAILABLE, json(&json!({"reason": "nothing has come yet"}))),
    }
}

async fn history(State(shared): State<Arc<Shared>>) -> Response {
    let history = shared.hub.history();
    let body = json!({
        "run": shared.run,
        "coarse": columns(&history.coarse),
        "fine": columns(&history.fine),
        "transitions": history.transitions,
    });
    give_json(StatusCode::OK, json(&body))
}

async fn stream(State(shared): State<Arc<Shared>>, headers: HeaderMap) -> Response {
    let last = headers.get("last-event-id").and_then(|id| id.to_str().ok()).map(str::to_owned);
    events::stream(shared, last.as_deref())
}

async fn healthz(State(shared): State<Arc<Shared>>) -> Response {
    let health = shared.health();
    let status = if health.is_fresh() { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE };
    give_json(status, json(&health))
}

async fn scrape(State(shared): State<Arc<Shared>>) -> Response {
    let kind = [(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8"), (CACHE_CONTROL, "no-store")];
    (kind, metrics::text(&shared)).into_response()
}
