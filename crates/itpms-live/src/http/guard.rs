//! Access control of requests, and the headers of every answer.
//!
//! Stands before all routes. There is no password: whoever reaches the address may look, but no page of another may
//! do so through a visitor's browser, neither by naming us (cross-origin) nor by a name that it makes point here (DNS rebinding).

use std::net::{Ipv4Addr, Ipv6Addr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{
    ACCESS_CONTROL_ALLOW_ORIGIN, ALLOW, CONTENT_SECURITY_POLICY, HOST, ORIGIN, REFERRER_POLICY, VARY,
    X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Own files only, no script or style inside the page, no frames, nothing to be sent anywhere.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; \
     base-uri 'none'; form-action 'none'; frame-ancestors 'none'; require-trusted-types-for 'script'; trusted-types 'none'";

/// Names and origins that were allowed besides the usual ones.
#[derive(Debug)]
pub(super) struct Guard {
    hosts: Vec<String>,
    origins: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
enum Caller {
    /// Ours, or no page at all.
    Own,
    Allowed(HeaderValue),
    Stranger,
}

impl Guard {
    pub(super) fn new(hosts: &[String], origins: &[String]) -> Self {
        let tidy = |list: &[String]| list.iter().map(|item| item.trim().to_ascii_lowercase()).collect();
        Self { hosts: tidy(hosts), origins: tidy(origins) }
    }

    /// Whether this machine may be called so. Addresses cannot be made to point to another machine; names without a dot and
    /// `.local` ones are not for sale.
    fn knows_host(&self, authority: &str) -> bool {
        let authority = authority.to_ascii_lowercase();
        if let Some(rest) = authority.strip_prefix('[') {
            return rest.split_once(']').is_some_and(|(address, port)| {
                address.parse::<Ipv6Addr>().is_ok() && (port.is_empty() || is_port(port.strip_prefix(':')))
            });
        }
        let (name, port) = match authority.split_once(':') {
            Some((name, port)) => (name, Some(port)),
            None => (authority.as_str(), None),
        };
        let plain = !name.is_empty()
            && name.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'-' || c == b'.' || c == b'_');
        plain
            && (port.is_none() || is_port(port))
            && (name.parse::<Ipv4Addr>().is_ok()
                || !name.contains('.')
                || name.ends_with(".local")
                || name.ends_with(".localhost")
                || self.hosts.iter().any(|host| host == name || *host == authority))
    }

    fn caller(&self, headers: &HeaderMap, host: &str) -> Caller {
        let mut origins = headers.get_all(ORIGIN).iter();
        let Some(origin) = origins.next() else {
            // Pictures and scripts are fetched without an origin; browsers say where from all the same.
            return match headers.get("sec-fetch-site").map(HeaderValue::as_bytes) {
                None | Some(b"same-origin" | b"none") => Caller::Own,
                Some(_) => Caller::Stranger,
            };
        };
        let Some(text) = origin.to_str().ok().filter(|_| origins.next().is_none()) else {
            return Caller::Stranger;
        };
        let text = text.to_ascii_lowercase();
        let named = text.strip_prefix("http://").or(text.strip_prefix("https://"));
        if named == Some(&*host.to_ascii_lowercase()) {
            Caller::Own
        } else if self.origins.contains(&text) {
            Caller::Allowed(origin.clone())
        } else {
            Caller::Stranger
        }
    }
}

fn is_port(text: Option<&str>) -> bool {
    text.is_some_and(|text| text.bytes().all(|c| c.is_ascii_digit()) && text.parse::<u16>().is_ok())
}

/// Before and after every request.
pub(super) async fn watch(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let (mut response, allowed) = match guard.admit(&request) {
        Ok(Caller::Allowed(origin)) => (next.run(request).await, Some(origin)),
        Ok(_) => (next.run(request).await, None),
        Err(refusal) => (refusal.into_response(), None),
    };
    let foreign = if allowed.is_some() { "cross-origin" } else { "same-origin" };
    let headers = response.headers_mut();
    let fixed: [(HeaderName, &'static str); 7] = [
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "DENY"),
        (REFERRER_POLICY, "no-referrer"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-resource-policy"), foreign),
        (VARY, "Origin, Sec-Fetch-Site"),
    ];
    headers.extend(fixed.map(|(name, value)| (name, HeaderValue::from_static(value))));
    headers.extend(allowed.map(|origin| (ACCESS_CONTROL_ALLOW_ORIGIN, origin)));
    response
}

#[derive(Debug, Clone, Copy)]
struct Refusal(StatusCode, &'static str);

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let mut response = (self.0, self.1).into_response();
        if self.0 == StatusCode::METHOD_NOT_ALLOWED {
            response.headers_mut().insert(ALLOW, HeaderValue::from_static("GET, HEAD"));
        }
        response
    }
}

impl Guard {
    fn admit(&self, request: &Request) -> Result<Caller, Refusal> {
        if !matches!(*request.method(), Method::GET | Method::HEAD) {
            return Err(Refusal(StatusCode::METHOD_NOT_ALLOWED, "Only GET and HEAD.\n"));
        }
        let mut hosts = request.headers().get_all(HOST).iter();
        let host = hosts.next().and_then(|host| host.to_str().ok()).filter(|_| hosts.next().is_none());
        let Some(host) = host else {
            return Err(Refusal(StatusCode::BAD_REQUEST, "One Host header, please.\n"));
        };
        // A request may spell out the whole address; then both have to agree.
        let spelled = request.uri().authority().map(|authority| authority.as_str());
        if spelled.is_some_and(|spelled| !spelled.eq_ignore_ascii_case(host)) || !self.knows_host(host) {
            let text = "This machine does not go by that name here; see --http-allow-host.\n";
            return Err(Refusal(StatusCode::FORBIDDEN, text));
        }
        // A link from another site to the page itself is all right.
        let landing = request.uri().path() == "/" && request.headers().get(ORIGIN).is_none();
        match self.caller(request.headers(), host) {
            Caller::Stranger if !landing => {
                let text = "Not for pages of other origins; see --http-allow-origin.\n";
                Err(Refusal(StatusCode::FORBIDDEN, text))
            }
            caller => Ok(caller),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_local_names_are_ours_bought_names_are_not() {
        let guard = Guard::new(&["car7.example.com".to_owned()], &[]);
        for host in [
            "127.0.0.1",
            "127.0.0.1:8080",
            "localhost:1",
            "LOCALHOST",
            "[::1]",
            "[::1]:8080",
            "10.0.0.7:80",
            "raspberrypi",
            "raspberrypi.local:8080",
            "car7.example.com",
            "CAR7.example.com:8080",
            "a.localhost:3",
        ] {
            assert!(guard.knows_host(host), "{host}");
        }
        for host in [
            "",
            "evil.example",
            "evil.example:8080",
            "127.0.0.1.evil.example",
            "localhost.evil.example:80",
            "[::1",
            "[evil]",
            "[::1]:x",
            "127.0.0.1:99999",
            "127.0.0.1:",
            "a b",
            "user@127.0.0.1",
            ".local.evil",
            "127.0.0.1/x",
            "xcar7.example.com",
            "car7.example.com.evil.example",
        ] {
            assert!(!guard.knows_host(host), "{host}");
        }
    }

    #[test]
    fn only_own_and_allowed_origins_may_read() {
        let guard = Guard::new(&[], &["https://fleet.example.com".to_owned()]);
        let caller = |pairs: &[(&str, &str)]| {
            let mut headers = HeaderMap::new();
            for (name, value) in pairs {
                headers.append(HeaderName::try_from(*name).unwrap(), HeaderValue::try_from(*value).unwrap());
            }
            guard.caller(&headers, "127.0.0.1:8080")
        };
        assert_eq!(caller(&[]), Caller::Own);
        assert_eq!(caller(&[("origin", "http://127.0.0.1:8080")]), Caller::Own);
        assert_eq!(caller(&[("sec-fetch-site", "same-origin")]), Caller::Own);
        assert!(matches!(caller(&[("origin", "https://fleet.example.com")]), Caller::Allowed(_)));
        for stranger in
            ["null", "http://127.0.0.1:8081", "http://127.0.0.1", "https://evil.example", "file://", ""]
        {
            assert_eq!(caller(&[("origin", stranger)]), Caller::Stranger, "{stranger}");
        }
        assert_eq!(caller(&[("sec-fetch-site", "cross-site")]), Caller::Stranger);
        assert_eq!(caller(&[("sec-fetch-site", "same-site")]), Caller::Stranger);
        let twice = [("origin", "http://127.0.0.1:8080"), ("origin", "https://evil.example")];
        assert_eq!(caller(&twice), Caller::Stranger);
    }
}
