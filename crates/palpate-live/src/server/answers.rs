// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers to requests, and the threads that make those which may take long.

use std::fmt;
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::runtime::Handle;
use tokio::sync::OwnedSemaphorePermit;
use tungstenite::Bytes;
use tungstenite::handshake::server::write_response;
use tungstenite::http::header::{ALLOW, CONNECTION, CONTENT_LENGTH, CONTENT_TYPE};
use tungstenite::http::{HeaderName, HeaderValue, Response, StatusCode};

use super::connections::Connection;
use super::files;
use super::guard::HEADERS;
use super::request::methods;
use crate::stage::{Stage, Work};

/// The threads that make answers: while one reads a trace, the other serves the page.
const THREADS: usize = 2;

/// An answer.
pub(super) type Answer = Response<Bytes>;

/// An answer with a body of a type.
pub(super) fn answer(status: StatusCode, kind: &'static str, body: impl Into<Bytes>) -> Answer {
    let mut answer = Response::new(body.into());
    *answer.status_mut() = status;
    answer.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(kind));
    answer
}

/// An answer in words.
pub(super) fn words(status: StatusCode, words: impl Into<Bytes>) -> Answer {
    answer(status, "text/plain; charset=utf-8", words)
}

/// The answer to a request that is refused, and why.
pub(super) fn refused(status: StatusCode, path: &str) -> Answer {
    let why = match status {
        StatusCode::UNAUTHORIZED => {
            "The token is missing or wrong: open the address that the program printed, to its end.\n"
        }
        StatusCode::FORBIDDEN => "The request comes from the page of another server.\n",
        StatusCode::MISDIRECTED_REQUEST => {
            "The host of the request is not one at which this server listens.\n"
        }
        StatusCode::NOT_FOUND => "There is nothing at this path.\n",
        StatusCode::METHOD_NOT_ALLOWED => "This path does not allow this method.\n",
        StatusCode::REQUEST_TIMEOUT => "The request came too slowly.\n",
        StatusCode::LENGTH_REQUIRED => "The request does not say how long the trace is.\n",
        StatusCode::PAYLOAD_TOO_LARGE => "The trace is too large: it has at most 64 MiB.\n",
        StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE => {
            "The head of the request is too long: it has at most 64 headers and 16 KiB.\n"
        }
        StatusCode::SERVICE_UNAVAILABLE => "The program is busy: ask again.\n",
        _ => "The request cannot be read.\n",
    };
    let mut answer = words(status, why);
    if status == StatusCode::METHOD_NOT_ALLOWED {
        answer.headers_mut().insert(ALLOW, HeaderValue::from_static(methods(path)));
    }
    answer
}

/// The bytes of an answer but for its body. A connection carries one request.
pub(super) fn head(answer: &Answer) -> Vec<u8> {
    let mut head = Response::new(());
    *head.status_mut() = answer.status();
    *head.headers_mut() = answer.headers().clone();
    let headers = head.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    // A socket stays open, and has no body.
    if answer.status() != StatusCode::SWITCHING_PROTOCOLS {
        headers.insert(CONNECTION, HeaderValue::from_static("close"));
        headers.insert(CONTENT_LENGTH, answer.body().len().into());
    }
    if answer.status() == StatusCode::NO_CONTENT {
        headers.remove(CONTENT_LENGTH);
    }
    let mut bytes = Vec::new();
    // A vector takes all that is written.
    let _ = write_response(&mut bytes, &head);
    bytes
}

/// A request that a thread answers.
pub(super) struct Asked {
    pub(super) connection: Arc<Connection>,
    pub(super) what: What,
    /// Whether only the head of the answer is wanted.
    pub(super) is_head: bool,
    /// The permit of a trace, held until its transfer ends.
    pub(super) place: Option<OwnedSemaphorePermit>,
}

/// What is asked for.
pub(super) enum What {
    /// A file of the page, compressed if the client takes that.
    File { path: String, takes_gzip: bool },
    /// The scene as a file.
    Scene,
    /// What was recorded.
    Trace,
    /// To take a trace.
    Taken(Vec<u8>),
}

impl fmt::Debug for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Asked").field("connection", &self.connection).finish_non_exhaustive()
    }
}

/// Starts the threads; `writer` writes what they answer. They end when nobody can ask them any more;
/// nothing waits for what they still do.
pub(super) fn start(requests: Receiver<Asked>, stage: &Arc<Stage>, writer: &Handle) {
    let requests = Arc::new(Mutex::new(requests));
    for _ in 0..THREADS {
        let (requests, stage, writer) =
            (Arc::clone(&requests), Arc::downgrade(stage), writer.clone());
        std::thread::spawn(move || {
            loop {
                // One of the threads waits, and takes what comes.
                let next = requests.lock().unwrap_or_else(PoisonError::into_inner).recv();
                let (Ok(asked), Some(stage)) = (next, stage.upgrade()) else { return };
                stage.watch.begins(Work::Request);
                let Asked { connection, what, is_head, place } = asked;
                let answer = what.answer(&stage);
                drop(stage);
                writer.spawn(super::writer::say(connection, answer, is_head, place));
            }
        });
    }
}

impl What {
    fn answer(self, stage: &Stage) -> Answer {
        let busy = || refused(StatusCode::SERVICE_UNAVAILABLE, "");
        match self {
            Self::File { path, takes_gzip } => files::answer(&path, takes_gzip),
            Self::Scene => answer(StatusCode::OK, "application/json", stage.text()),
            Self::Trace => match stage.trace() {
                Some(Some(trace)) => answer(StatusCode::OK, "text/csv", trace()),
                Some(None) => words(
                    StatusCode::NOT_FOUND,
                    "Nothing is recorded yet: press “record” on the page first.\n",
                ),
                None => busy(),
            },
            Self::Taken(bytes) => match stage.take_trace(&bytes) {
                Ok(()) => words(StatusCode::NO_CONTENT, ""),
                Err(why) => words(StatusCode::UNPROCESSABLE_ENTITY, why),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A method that a path does not allow was refused without a word.
    #[test]
    fn every_refusal_says_why() {
        for status in (400..600).filter_map(|code| StatusCode::from_u16(code).ok()) {
            let answer = refused(status, "/stop");
            assert!(answer.body().ends_with(b".\n"), "{status}");
            let length = answer.body().len().to_string();
            let head = String::from_utf8(head(&answer)).unwrap();
            assert!(head.contains(&format!("content-length: {length}\r\n")), "{head}");
        }
        let answer = refused(StatusCode::METHOD_NOT_ALLOWED, "/stop");
        assert_eq!(answer.headers()[ALLOW], "POST");
    }
}
