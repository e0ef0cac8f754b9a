//! The page's files, all of them in memory: there is no folder that a path could climb out of.
//!
//! Read by the routes. The sources are in `dashboard/`; what all pages share and the charting library are the report's.

use std::hash::{DefaultHasher, Hash, Hasher};

use axum::Router;
use axum::body::Bytes;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, ETAG, IF_NONE_MATCH};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use itpms_analysis::page::{BASE_STYLE, PATTERN_SCRIPT};
use itpms_analysis::report::{PLOT_LICENSE, PLOT_SCRIPT, PLOT_STYLE};
use itpms_core::model::PressureUnit;

#[derive(Debug, Clone, Copy)]
struct Asset {
    path: &'static str,
    kind: &'static str,
    text: &'static str,
}

/// Where the page says in which unit it shows pressures.
const UNIT: &str = "data-unit=\"kPa\" data-unit-kpa=\"1\" data-unit-places=\"0\"";

fn in_unit(page: &str, unit: PressureUnit) -> String {
    let unit = format!(
        "data-unit=\"{unit}\" data-unit-kpa=\"{}\" data-unit-places=\"{}\"",
        unit.kpa(),
        unit.more_places()
    );
    page.replace(UNIT, &unit)
}

const HTML: &str = "text/html; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const PICTURE: &str = "image/svg+xml";
const TEXT: &str = "text/plain; charset=utf-8";

macro_rules! asset {
    ($name:literal, $kind:expr) => {
        Asset {
            path: concat!("/assets/", $name),
            kind: $kind,
            text: include_str!(concat!("../../dashboard/", $name)),
        }
    };
}

const ASSETS: &[Asset] = &[
    Asset { path: "/", kind: HTML, text: include_str!("../../dashboard/index.html") },
    asset!("style.css", STYLE),
    asset!("icon.svg", PICTURE),
    asset!("app.js", SCRIPT),
    asset!("alerts.js", SCRIPT),
    asset!("beside.js", SCRIPT),
    asset!("car.js", SCRIPT),
    asset!("charts.js", SCRIPT),
    asset!("connection.js", SCRIPT),
    asset!("health.js", SCRIPT),
    asset!("past.js", SCRIPT),
    asset!("roads.js", SCRIPT),
    asset!("status.js", SCRIPT),
    asset!("theme.js", SCRIPT),
    asset!("wheels.js", SCRIPT),
    asset!("words.js", SCRIPT),
    Asset { path: "/assets/base.css", kind: STYLE, text: BASE_STYLE },
    Asset { path: "/assets/pattern.js", kind: SCRIPT, text: PATTERN_SCRIPT },
    Asset { path: "/assets/uplot.js", kind: SCRIPT, text: PLOT_SCRIPT },
    Asset { path: "/assets/uplot.css", kind: STYLE, text: PLOT_STYLE },
    Asset { path: "/assets/uplot.LICENSE", kind: TEXT, text: PLOT_LICENSE },
];

pub(super) fn routes<S: Clone + Send + Sync + 'static>(unit: PressureUnit) -> Router<S> {
    ASSETS.iter().fold(Router::new(), |router, asset| {
        let (mark, text) = match asset.kind {
            HTML => {
                let page = in_unit(asset.text, unit);
                (mark(&page), Bytes::from(page))
            }
            _ => (mark(asset.text), Bytes::from_static(asset.text.as_bytes())),
        };
        let answer = move |headers: HeaderMap| std::future::ready(give(asset.kind, &text, &mark, &headers));
        router.route(asset.path, get(answer))
    })
}

/// Browsers may keep a file but have to ask whether it is still the same: after an update it is another.
fn give(kind: &'static str, text: &Bytes, mark: &HeaderValue, asked: &HeaderMap) -> Response {
    let common = [(CACHE_CONTROL, HeaderValue::from_static("no-cache")), (ETAG, mark.clone())];
    if asked.get(IF_NONE_MATCH) == Some(mark) {
        return (StatusCode::NOT_MODIFIED, common).into_response();
    }
    (common, [(CONTENT_TYPE, kind)], text.clone()).into_response()
}

/// Changes whenever the text does.
fn mark(text: &str) -> HeaderValue {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    HeaderValue::from_str(&format!("\"{:016x}\"", hasher.finish()))
        .unwrap_or(HeaderValue::from_static("\"0\""))
}
