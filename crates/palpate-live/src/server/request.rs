// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The head of a request: its bytes, and what it asks for.

use tungstenite::handshake::server::create_response;
use tungstenite::http::header::{ACCEPT_ENCODING, CONTENT_LENGTH, EXPECT};
use tungstenite::http::{HeaderName, HeaderValue, Method, Request, Response, StatusCode};

use super::guard::{Guard, LARGEST_TRACE, LONGEST_HEAD};

/// The most headers of a request.
const MOST_HEADERS: usize = 64;

/// A request without its body.
pub(super) type Head = Request<()>;

/// Whether bytes hold a whole head. The first `read` bytes were looked at before.
pub(super) fn is_whole(bytes: &[u8], read: usize) -> bool {
    let new = bytes.get(read.saturating_sub(3)..).unwrap_or_default();
    new.windows(4).any(|end| end == b"\r\n\r\n") || new.windows(2).any(|end| end == b"\n\n")
}

/// Reads a head, and how many bytes it has.
///
/// # Errors
///
/// The status of the answer to bytes that are none.
pub(super) fn read(bytes: &[u8]) -> Result<(Head, usize), StatusCode> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    let length = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(length)) if length <= LONGEST_HEAD => length,
        Err(httparse::Error::TooManyHeaders) => {
            return Err(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE);
        }
        _ => return Err(StatusCode::BAD_REQUEST),
    };
    let bad = |_| StatusCode::BAD_REQUEST;
    let mut head = Request::builder()
        .method(parsed.method.unwrap_or_default())
        .uri(parsed.path.unwrap_or_default())
        .body(())
        .map_err(|_| StatusCode::BAD_REQUEST)?;
    for header in parsed.headers.iter() {
        let name = HeaderName::from_bytes(header.name.as_bytes())
            .map_err(|_| StatusCode::BAD_REQUEST)?;
        head.headers_mut().append(name, HeaderValue::from_bytes(header.value).map_err(bad)?);
    }
    Ok((head, length))
}

/// What a request asks for.
#[derive(Debug)]
pub(super) enum Route {
    /// A file of the page.
    File(String),
    /// The socket of a page, with the answer that opens it.
    Socket(Response<()>),
    /// An emergency stop, with the digits of its press.
    Stop(Option<String>),
    /// The scene as a file.
    Scene,
    /// What was recorded.
    Trace,
    /// To take a trace of so many bytes.
    TakeTrace(usize),
}

impl Route {
    /// What a request asks for, if its sender may.
    ///
    /// # Errors
    ///
    /// The status of the answer to who may not, or asks for nothing that there is.
    pub(super) fn of(head: &Head, guard: &Guard) -> Result<Self, StatusCode> {
        guard.check_host(head.headers())?;
        let path = head.uri().path();
        let is_get = matches!(*head.method(), Method::GET | Method::HEAD);
        let is_post = head.method() == Method::POST;
        let token = || guard.check_token(value(head, "token"));
        let own = || guard.check_origin(head.headers()).and_then(|()| token());
        Ok(match path {
            "/socket" if is_get => {
                own()?;
                Self::Socket(create_response(head).map_err(|_| StatusCode::BAD_REQUEST)?)
            }
            "/stop" if is_post => {
                own()?;
                Self::Stop(value(head, "press").map(str::to_owned))
            }
            "/scene.json" if is_get => token().map(|()| Self::Scene)?,
            "/trace.csv" if is_get => token().map(|()| Self::Trace)?,
            "/trace.csv" if is_post => {
                own()?;
                Self::TakeTrace(length(head)?)
            }
            "/socket" | "/stop" | "/scene.json" | "/trace.csv" => {
                return Err(StatusCode::METHOD_NOT_ALLOWED);
            }
            _ if !is_get => return Err(StatusCode::METHOD_NOT_ALLOWED),
            "/" => Self::File("index.html".to_owned()),
            _ => Self::File(path.trim_start_matches('/').to_owned()),
        })
    }

    /// Whether the request named the token.
    pub(super) fn is_known(&self) -> bool {
        !matches!(self, Self::File(_))
    }
}

/// The methods that a path takes.
pub(super) fn methods(path: &str) -> &'static str {
    match path {
        "/stop" => "POST",
        "/trace.csv" => "GET, HEAD, POST",
        _ => "GET, HEAD",
    }
}

/// A value of the query, as it is written: those in use have no character that is written otherwise.
fn value<'a>(head: &'a Head, name: &str) -> Option<&'a str> {
    let pairs = head.uri().query()?.split('&');
    pairs
        .filter_map(|pair| pair.split_once('='))
        .find(|(key, _)| *key == name)
        .map(|(_, it)| it)
}

/// The length of a body.
fn length(head: &Head) -> Result<usize, StatusCode> {
    let length = head.headers().get(CONTENT_LENGTH).ok_or(StatusCode::LENGTH_REQUIRED)?;
    let length = length.to_str().ok().and_then(|text| text.parse().ok());
    match length.ok_or(StatusCode::BAD_REQUEST)? {
        length if length > LARGEST_TRACE => Err(StatusCode::PAYLOAD_TOO_LARGE),
        length => Ok(length),
    }
}

/// Whether the client takes compressed bodies.
pub(super) fn takes_gzip(head: &Head) -> bool {
    let mut names =
        head.headers().get_all(ACCEPT_ENCODING).iter().filter_map(|it| it.to_str().ok());
    names.any(|names| {
        names.split(',').any(|name| {
            let (name, weight) = name.split_once(';').unwrap_or((name, ""));
            let is_off = weight.trim().trim_start_matches("q=").parse() == Ok(0.0);
            matches!(name.trim(), "gzip" | "*") && !is_off
        })
    })
}

/// Whether the client waits for leave to send the body.
pub(super) fn waits_for_leave(head: &Head) -> bool {
    head.headers()
        .get(EXPECT)
        .is_some_and(|it| it.as_bytes().eq_ignore_ascii_case(b"100-continue"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN: &str = "abababababababababababababababab";

    fn head(text: &str) -> Head {
        read(text.as_bytes()).unwrap().0
    }

    fn route(request: &str, headers: &str) -> Result<Route, StatusCode> {
        let guard = Guard::new("127.0.0.1:80".parse().unwrap(), TOKEN.to_owned());
        let text = format!("{request} HTTP/1.1\r\nHost: localhost\r\n{headers}\r\n");
        Route::of(&head(&text), &guard)
    }

    #[test]
    fn a_head_ends_with_an_empty_line() {
        let text = b"GET / HTTP/1.1\r\nHost: a\r\n\r\nrest";
        let whole = (1..=text.len()).find(|end| is_whole(&text[..*end], end - 1)).unwrap();
        assert_eq!(read(text).unwrap().1, whole);
        assert!(is_whole(b"GET / HTTP/1.0\n\n", 0) && !is_whole(b"GET / HTTP/1.0\r\n", 0));
        assert_eq!(read(b"noise\r\n\r\n").unwrap_err(), StatusCode::BAD_REQUEST);
        let many = format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(65));
        let status = read(many.as_bytes()).unwrap_err();
        assert_eq!(status, StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE);
    }

    #[test]
    fn a_request_has_its_route() {
        let own = "Origin: http://localhost\r\n";
        let stop = route(&format!("POST /stop?press=0f&token={TOKEN}"), own);
        assert!(matches!(stop, Ok(Route::Stop(Some(press))) if press == "0f"));
        let stop = route("POST /stop?token=0f", own).unwrap_err();
        assert_eq!(stop, StatusCode::UNAUTHORIZED);
        let stop = route(&format!("POST /stop?token={TOKEN}"), "").unwrap_err();
        assert_eq!(stop, StatusCode::FORBIDDEN);
        for wrong in ["GET /stop", "POST /", "DELETE /scene.json", "PUT /socket"] {
            assert_eq!(
                route(wrong, own).unwrap_err(),
                StatusCode::METHOD_NOT_ALLOWED,
                "{wrong}"
            );
        }
        let trace = format!("POST /trace.csv?token={TOKEN}");
        for (length, status) in [
            ("", StatusCode::LENGTH_REQUIRED),
            ("Content-Length: x\r\n", StatusCode::BAD_REQUEST),
            ("Content-Length: 67108865\r\n", StatusCode::PAYLOAD_TOO_LARGE),
        ] {
            assert_eq!(route(&trace, &format!("{own}{length}")).unwrap_err(), status);
        }
        let taken = route(&trace, &format!("{own}Content-Length: 67108864\r\n")).unwrap();
        assert!(matches!(taken, Route::TakeTrace(67_108_864)) && taken.is_known());
        let socket = route(&format!("GET /socket?token={TOKEN}"), own).unwrap_err();
        assert_eq!(socket, StatusCode::BAD_REQUEST);
        let file = route("HEAD /scene/stage.js?v=1", "").unwrap();
        assert!(matches!(&file, Route::File(path) if path == "scene/stage.js"));
        assert!(!file.is_known());
    }

    #[test]
    fn who_takes_gzip_says_so() {
        let takes = |value: &str| {
            takes_gzip(&head(&format!("GET / HTTP/1.1\r\nAccept-Encoding: {value}\r\n\r\n")))
        };
        for value in ["gzip", "br, gzip;q=0.5", "*", "deflate,gzip , br"] {
            assert!(takes(value), "{value}");
        }
        for value in ["", "br", "gzip;q=0", "gzip; q=0.0", "identity"] {
            assert!(!takes(value), "{value}");
        }
    }
}
