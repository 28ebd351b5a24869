// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Who may speak to the server, and how much.
//!
//! Who may speak with the server.
//!
//! A page of another site can make a browser send requests to this machine, so every request is
//! checked: `Host` against names that lead elsewhere, `Origin` against other sites, a token
//! against other users of the machine.

use std::net::{IpAddr, SocketAddr};
use std::time::{Duration, Instant};

use tungstenite::http::header::{HOST, ORIGIN};
use tungstenite::http::{HeaderMap, HeaderName, StatusCode};

/// The headers of all answers: the page runs its own scripts alone, and nothing embeds it.
pub(super) const HEADERS: [(&str, &str); 7] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; \
         img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
         frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    ("referrer-policy", "no-referrer"),
    ("cache-control", "no-store"),
    ("x-frame-options", "DENY"),
];

/// The bits of a token, in bytes.
const TOKEN_BYTES: usize = 16;

/// What requests are checked against.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    address: SocketAddr,
    token: String,
}

/// A new token: 128 random bits in hexadecimal digits.
///
/// # Errors
///
/// If the operating system gives no random numbers.
pub(crate) fn new_token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Whether a text can be a token.
pub(crate) fn is_token(text: &str) -> bool {
    text.len() == 2 * TOKEN_BYTES && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

impl Guard {
    /// For a server at `address`.
    pub(super) fn new(address: SocketAddr, token: String) -> Self {
        Self { address, token }
    }

    /// Whether a host is this server: `localhost`, or a loopback address, or, if other
    /// machines may call, any address. A name leads wherever its owner wants; an address does
    /// not.
    fn is_here(&self, host: &str) -> bool {
        let is_port = |port: &str| port.parse() == Ok(self.address.port());
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port),
            // Browsers leave out the port that is usual.
            _ => (host, "80"),
        };
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']'));
        let ip: Option<IpAddr> = bare.unwrap_or(name).parse().ok();
        let is_local = name == "localhost"
            || ip.is_some_and(|ip| {
                ip.to_canonical().is_loopback()
                    || !self.address.ip().to_canonical().is_loopback()
            });
        is_local && is_port(port)
    }

    /// Refuses a request that was sent to another name: a name of an attacker may lead here.
    pub(super) fn check_host(&self, headers: &HeaderMap) -> Result<(), StatusCode> {
        match only(headers, HOST) {
            Some(host) if self.is_here(host) => Ok(()),
            _ => Err(StatusCode::MISDIRECTED_REQUEST),
        }
    }

    /// Refuses a request of a page that this server did not send.
    pub(super) fn check_origin(&self, headers: &HeaderMap) -> Result<(), StatusCode> {
        let host = only(headers, ORIGIN).and_then(|origin| origin.strip_prefix("http://"));
        match host {
            Some(host) if self.is_here(host) => Ok(()),
            _ => Err(StatusCode::FORBIDDEN),
        }
    }

    /// Refuses a request without the token.
    pub(super) fn check_token(&self, given: Option<&str>) -> Result<(), StatusCode> {
        match given {
            Some(given) if are_equal(given.as_bytes(), self.token.as_bytes()) => Ok(()),
            _ => Err(StatusCode::UNAUTHORIZED),
        }
    }
}

/// The value of a header that is there once.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(value)
}

/// Compares in a time that does not tell where texts differ.
fn are_equal(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

/// The most pages at once.
pub(super) const MOST_PAGES: usize = 64;

/// The most connections at once that have not named the token. A connection is closed for room only
/// after so many later ones: with fewer, a flood would close it before its request comes.
pub(super) const MOST_STRANGERS: usize = 256;

/// The most connections at once that have named it, beside pages.
pub(super) const MOST_KNOWN: usize = 32;

/// How long the server waits where the operating system gives it no more sockets.
pub(super) const ACCEPT_RETRY: Duration = Duration::from_millis(1);

/// The bytes that are read of a connection in a turn: at most so many frames of a socket come at once.
pub(super) const TURN: usize = 4 << 10;

/// The connections that may wait to be accepted: one that finds no room tries again after a second.
pub(super) const BACKLOG: i32 = 4096;

/// The connections that are accepted in a turn.
pub(super) const ACCEPTED: usize = 16;

/// The longest head of a request [bytes].
pub(super) const LONGEST_HEAD: usize = 16 << 10;

/// The requests that may wait to be answered: more are refused.
pub(super) const MOST_REQUESTS: usize = 256;

/// The most traces that come or go at once: each is up to 64 MiB of memory.
pub(super) const MOST_TRACES: usize = 4;

/// The largest trace to be replayed [bytes], and how long it may take to come.
pub(super) const LARGEST_TRACE: usize = 64 << 20;
pub(super) const TRACE_PATIENCE: Duration = Duration::from_secs(60);

/// The largest message of a page [bytes].
pub(super) const LARGEST_MESSAGE: usize = 1 << 20;

/// The bytes that are written to a connection at a time.
pub(super) const CHUNK: usize = 1 << 16;

/// How long a client may leave what is written unread, send no request, or go on sending what counts
/// for nothing.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);

/// Messages of a page a second, and how many may come at once.
const MESSAGES: Rate = Rate { each_second: 120.0, reserve: 60.0 };

/// Bytes of a page's messages a second, and how many may come at once.
const BYTES: Rate = Rate { each_second: 1e6, reserve: 4e6 };

#[derive(Clone, Copy, Debug)]
struct Rate {
    each_second: f64,
    reserve: f64,
}

/// Counts against a rate: a bucket that fills evenly.
#[derive(Debug)]
struct Bucket {
    rate: Rate,
    left: f64,
    at: Instant,
}

impl Bucket {
    fn full(rate: Rate, now: Instant) -> Self {
        Self { rate, left: rate.reserve, at: now }
    }

    /// Takes so much; `false` if there is less.
    fn take(&mut self, much: f64, now: Instant) -> bool {
        let passed = now.saturating_duration_since(self.at).as_secs_f64();
        self.at = now;
        self.left = (self.left + self.rate.each_second * passed).min(self.rate.reserve);
        let is_there = self.left >= much;
        if is_there {
            self.left -= much;
        }
        is_there
    }
}

/// What a page may still send.
#[derive(Debug)]
pub(super) struct Budget {
    messages: Bucket,
    bytes: Bucket,
}

impl Budget {
    pub(super) fn full(now: Instant) -> Self {
        Self { messages: Bucket::full(MESSAGES, now), bytes: Bucket::full(BYTES, now) }
    }

    /// Takes a message of so many bytes.
    ///
    /// # Errors
    ///
    /// Of what the page sent too much.
    pub(super) fn take(&mut self, bytes: usize, now: Instant) -> Result<(), &'static str> {
        if !self.messages.take(1.0, now) {
            return Err("the page sent more than 120 messages a second");
        }
        if !self.bytes.take(bytes as f64, now) {
            return Err("the page sent more than 1 MB a second");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard(address: &str) -> Guard {
        Guard::new(address.parse().unwrap(), "ab".repeat(TOKEN_BYTES))
    }

    fn headers(pairs: &[(HeaderName, &str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.clone(), value.parse().unwrap())).collect()
    }

    #[test]
    fn only_names_of_this_machine_are_hosts() {
        let guard = guard("127.0.0.1:4000");
        for good in ["127.0.0.1:4000", "localhost:4000", "[::1]:4000", "[::ffff:7f00:1]:4000"] {
            assert_eq!(guard.check_host(&headers(&[(HOST, good)])), Ok(()), "{good}");
        }
        for bad in [
            "127.0.0.1",
            "127.0.0.1:4001",
            "localhost:4000.evil.example",
            "evil.example:4000",
            "localhost.evil.example:4000",
            "10.0.0.1:4000",
            "",
            "LOCALHOST:4000x",
        ] {
            assert!(guard.check_host(&headers(&[(HOST, bad)])).is_err(), "{bad}");
        }
        assert!(guard.check_host(&HeaderMap::new()).is_err());
        let mut two = headers(&[(HOST, "localhost:4000")]);
        two.append(HOST, "localhost:4000".parse().unwrap());
        assert!(guard.check_host(&two).is_err());
    }

    #[test]
    fn only_pages_of_this_server_are_origins() {
        let guard = guard("192.168.1.2:80");
        assert_eq!(guard.check_host(&headers(&[(HOST, "192.168.1.2")])), Ok(()));
        assert!(guard.check_host(&headers(&[(HOST, "evil.example")])).is_err());
        let origin = |text: &str| guard.check_origin(&headers(&[(ORIGIN, text)]));
        assert_eq!(origin("http://192.168.1.2:80"), Ok(()));
        assert_eq!(origin("http://localhost:80"), Ok(()));
        for bad in
            ["null", "https://localhost:80", "http://localhost:81", "http://evil.example:80"]
        {
            assert_eq!(origin(bad), Err(StatusCode::FORBIDDEN), "{bad}");
        }
        assert_eq!(guard.check_origin(&HeaderMap::new()), Err(StatusCode::FORBIDDEN));
    }

    #[test]
    fn a_token_is_whole_or_nothing() {
        let guard = guard("127.0.0.1:1");
        assert_eq!(guard.check_token(Some(&"ab".repeat(16))), Ok(()));
        for bad in
            [None, Some(""), Some("ab"), Some(&*"ab".repeat(17)), Some(&*"aa".repeat(16))]
        {
            assert_eq!(guard.check_token(bad), Err(StatusCode::UNAUTHORIZED), "{bad:?}");
        }
        let [one, other] = [new_token().unwrap(), new_token().unwrap()];
        assert!(is_token(&one) && one != other && !is_token("xy"));
    }
}

#[cfg(test)]
mod limits_tests {
    use super::*;

    #[test]
    fn a_budget_has_a_reserve_and_fills_evenly() {
        let start = Instant::now();
        let later = |seconds: f64| start + Duration::from_secs_f64(seconds);
        let taken = |budget: &mut Budget, bytes: usize, now| {
            (0..1000).take_while(|_| budget.take(bytes, now).is_ok()).count()
        };
        let mut budget = Budget::full(start);
        assert_eq!(taken(&mut budget, 10, start), 60);
        assert_eq!(taken(&mut budget, 10, later(0.25)), 30);
        assert_eq!(taken(&mut budget, 10, later(100.0)), 60);
        let mut budget = Budget::full(start);
        assert_eq!(taken(&mut budget, 1_000_000, start), 4);
        assert_eq!(taken(&mut budget, 250_000, later(0.5)), 2);
        let why = budget.take(1_000_000, later(0.6)).unwrap_err();
        assert!(why.contains("1 MB"), "{why}");
    }
}
