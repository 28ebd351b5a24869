// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A page without a browser.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use palpate_live::{Live, LiveOptions};
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// A ball under a hand that rests.
pub(crate) const BALL: &str = r#"{ "palpate": 1, "dimension": 3,
    "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } },
                  "material": { "stiffness": 300, "damping": 0 } } ] }"#;

/// How long an answer may take on a machine that does something else.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) fn served(options: LiveOptions) -> Live {
    Live::start("ball", None, BALL, options).unwrap()
}

/// How long a page may be open: a test that waits for what never comes fails.
const LONGEST: Duration = Duration::from_secs(600);

/// A page.
pub(crate) struct Page {
    socket: WebSocket<TcpStream>,
    opened: Instant,
}

impl Page {
    /// A page that has said hello.
    pub(crate) fn open(live: &Live) -> Self {
        let mut page = Self::silent(live);
        page.say(&json!({ "do": "hello", "version": 2, "id": 0 }));
        page.answer(0);
        page
    }

    /// A page that has said nothing yet.
    pub(crate) fn silent(live: &Live) -> Self {
        let address = live.address();
        let url = format!("ws://{address}/socket?token={}", live.token());
        let mut request = url.into_client_request().unwrap();
        let origin = format!("http://{address}").parse().unwrap();
        request.headers_mut().insert("origin", origin);
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = tungstenite::client(request, stream).unwrap();
        Self { socket, opened: Instant::now() }
    }

    pub(crate) fn say(&mut self, message: &Value) {
        self.socket.send(Message::Text(message.to_string().into())).unwrap();
    }

    /// Sends whatever; `false` if the server has closed.
    pub(crate) fn try_send(&mut self, message: Message) -> bool {
        self.socket.send(message).is_ok()
    }

    /// The next message; `None` if the server has closed.
    pub(crate) fn next(&mut self) -> Option<Message> {
        assert!(self.opened.elapsed() < LONGEST, "what is waited for does not come");
        self.socket.read().ok()
    }

    /// The next text that `is_wanted` takes.
    pub(crate) fn text(&mut self, is_wanted: impl Fn(&Value) -> bool) -> Value {
        loop {
            if let Message::Text(text) = self.next().expect("the server has closed") {
                let message = serde_json::from_str(&text).unwrap();
                if is_wanted(&message) {
                    return message;
                }
            }
        }
    }

    /// The answer with a number.
    pub(crate) fn answer(&mut self, id: u32) -> Value {
        self.text(|message| message["id"] == id)
    }

    /// Asks with the number 1, and waits for the answer.
    pub(crate) fn ask(&mut self, message: Value) -> Value {
        let mut message = message;
        message["id"] = 1.into();
        self.say(&message);
        self.answer(1)
    }

    /// What the program answers to a question that every door takes.
    pub(crate) fn answer_to(&mut self, question: Value) -> Value {
        self.ask(json!({ "do": "ask", "question": question }))["answer"].take()
    }

    /// The next binary message of a kind.
    pub(crate) fn binary(&mut self, kind: u8) -> Vec<u8> {
        loop {
            match self.next().expect("the server has closed") {
                Message::Binary(bytes) if bytes[0] == kind => return bytes.to_vec(),
                _ => {}
            }
        }
    }
}

impl Page {
    /// Gives forces again after the stop that was told last, as soon as that may be.
    pub(crate) fn release(&mut self, number: u64) {
        loop {
            let answer = self.ask(json!({ "do": "release", "number": number }));
            if answer["do"] == "done" {
                return;
            }
            // A page may not ask too often.
            (0..10).for_each(|_| _ = self.binary(1));
        }
    }

    /// Waits for a frame after so many ticks: all rows until then are taken.
    pub(crate) fn wait_for_tick(&mut self, tick: u64) {
        loop {
            let frame = self.binary(1);
            if u64::from_le_bytes(frame[8..16].try_into().unwrap()) >= tick {
                return;
            }
        }
    }
}

/// Sends a request as it is; gives the answer as it comes.
pub(crate) fn raw(address: SocketAddr, request: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    // A server that closes the connection early has answered.
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

/// A request about the trace with this body; the answer as it comes.
pub(crate) fn request_trace(live: &Live, method: &str, body: &str) -> String {
    let (address, token, length) = (live.address(), live.token(), body.len());
    let head = format!(
        "{method} /trace.csv?token={token} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\n\
         Connection: close\r\nContent-Length: {length}\r\n\r\n"
    );
    raw(address, &(head + body))
}
