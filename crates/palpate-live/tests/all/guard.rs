// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Attacks by pages of other sites, by other users, and by programs that misuse the socket.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;

use palpate_live::{Live, LiveOptions};
use serde_json::json;
use tungstenite::{Bytes, Message};

use crate::talk::{Page, raw, served};

const SOCKET: &str = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
                      Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

/// The status of a request with these headers beside the host.
fn status(live: &Live, method: &str, path: &str, headers: &str) -> u16 {
    let host = live.address();
    status_at(live, method, path, &format!("Host: {host}\r\n{headers}"))
}

fn status_at(live: &Live, method: &str, path: &str, headers: &str) -> u16 {
    // A socket that opens stays open: only the first line is read.
    let request = format!("{method} {path} HTTP/1.1\r\n{headers}Content-Length: 0\r\n\r\n");
    first_line(live, &request)
}

fn first_line(live: &Live, request: &str) -> u16 {
    let mut stream = TcpStream::connect(live.address()).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut line = String::new();
    BufReader::new(stream).read_line(&mut line).unwrap();
    line.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0)
}

#[test]
fn hosts_of_others_are_misdirected() {
    let live = served(LiveOptions::default());
    let port = live.address().port();
    for host in
        [format!("127.0.0.1:{port}"), format!("localhost:{port}"), format!("[::1]:{port}")]
    {
        assert_eq!(status_at(&live, "GET", "/", &format!("Host: {host}\r\n")), 200, "{host}");
    }
    for host in [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        format!("localhost.evil.example:{port}"),
        format!("127.0.0.1.evil.example:{port}"),
        "127.0.0.1".to_owned(),
        format!("127.0.0.1:{}", port.wrapping_add(1)),
    ] {
        assert_eq!(status_at(&live, "GET", "/", &format!("Host: {host}\r\n")), 421, "{host}");
    }
    let two = format!("Host: localhost:{port}\r\nHost: evil.example\r\n");
    assert!([400, 421].contains(&status_at(&live, "GET", "/", &two)));
}

#[test]
fn sockets_and_stops_need_origin_and_token() {
    let live = served(LiveOptions::default());
    let own = format!("Origin: http://{}\r\n", live.address());
    let token = live.token().to_owned();
    let paths = [format!("/socket?token={token}"), format!("/stop?token={token}")];
    for (path, method, good) in [(&paths[0], "GET", 101), (&paths[1], "POST", 204)] {
        let more = if method == "GET" { SOCKET } else { "" };
        let status =
            |path: &str, origin: &str| status(&live, method, path, &format!("{origin}{more}"));
        assert_eq!(status(path, &own), good, "{path}");
        for origin in
            ["", "Origin: null\r\n", "Origin: http://evil.example\r\n", "Origin: file://\r\n"]
        {
            assert_eq!(status(path, origin), 403, "{origin}");
        }
        let https = own.replace("http:", "https:");
        assert_eq!(status(path, &https), 403);
        let bare = path.split('?').next().unwrap();
        let wrong = path.replace(&token, &"0".repeat(32));
        let short = path.replace(&token, &token[..31]);
        for path in [bare, &wrong, &short] {
            assert_eq!(status(path, &own), 401, "{path}");
        }
    }
    // Nothing is recorded yet.
    for (path, code) in [("/scene.json", 200), ("/trace.csv", 404)] {
        assert_eq!(status(&live, "GET", path, ""), 401);
        assert_eq!(status(&live, "GET", &format!("{path}?token={token}"), ""), code);
    }
    let host = live.address();
    let answer = raw(host, &format!("GET /scene.json HTTP/1.0\r\nHost: {host}\r\n\r\n"));
    assert!(answer.contains("The token is missing or wrong"), "{answer}");
}

#[test]
fn nothing_but_the_page_is_served() {
    let live = served(LiveOptions::default());
    for path in [
        "/../Cargo.toml",
        "/..%2f..%2fCargo.toml",
        "/%2e%2e/src/lib.rs",
        "//etc/passwd",
        "/scene/",
        "/jsconfig.json",
        "/nothing.js",
    ] {
        assert_eq!(status(&live, "GET", path, ""), 404, "{path}");
    }
    assert_eq!(status(&live, "POST", "/", ""), 405);
    assert_eq!(status(&live, "GET", "/stop", ""), 405);
    let refused = format!("GET /stop HTTP/1.1\r\nHost: {}\r\n\r\n", live.address());
    let answer = raw(live.address(), &refused);
    assert!(answer.ends_with("\r\n\r\nThis path does not allow this method.\n"), "{answer}");
    let answer = raw(
        live.address(),
        &format!("GET / HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", live.address()),
    );
    for header in ["default-src 'none'", "frame-ancestors 'none'", "nosniff", "no-store"] {
        assert!(answer.contains(header), "{header}");
    }
    assert!(!answer.contains(live.token()));
}

#[test]
fn a_page_that_cannot_be_read_is_closed() {
    let live = served(LiveOptions::default());
    let mut page = Page::silent(&live);
    for number in 1..10 {
        page.say(&json!({ "do": "fly", "id": number }));
        assert_eq!(page.answer(number)["do"], "refused");
    }
    page.try_send(Message::Binary(Bytes::from_static(b"noise")));
    let bye = page.text(|message| message["do"] == "bye");
    assert!(bye["why"].as_str().unwrap().contains("could not be read"), "{bye}");
}

#[test]
fn floods_and_huge_messages_close_the_socket() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    for _ in 0..500 {
        if !page.try_send(Message::Text(r#"{"do":"tour","on":true}"#.into())) {
            break;
        }
    }
    while page.next().is_some() {}
    let mut page = Page::open(&live);
    page.try_send(Message::Text("x".repeat(2 << 20).into()));
    while page.next().is_some() {}
    // The server goes on.
    let answer =
        Page::open(&live).answer_to(json!({ "question": "point", "at": [0, 0.06, 0] }));
    assert!((answer["distance"].as_f64().unwrap() - 0.01).abs() < 1e-12, "{answer}");
}

#[test]
fn no_more_pages_open_than_there_is_room_for() {
    let live = served(LiveOptions::default());
    let pages: Vec<_> = (0..64).map(|_| Page::open(&live)).collect();
    let bye = Page::silent(&live).text(|message| message["do"] == "bye");
    assert_eq!(bye["why"], "64 pages are open already");
    drop(pages);
}

#[test]
fn a_connection_that_says_nothing_is_closed() {
    let live = served(LiveOptions::default());
    let address = live.address();
    let started = format!("GET / HTTP/1.1\r\nHost: {address}\r\n");
    // Without a whole head the server closes, with nothing or with a refusal.
    let answers: Vec<_> = ["", &started].map(|start| raw(address, start)).into();
    assert!(answers.iter().all(|answer| !answer.contains("200 OK")), "{answers:?}");
}

/// 256 strangers who said nothing once kept everybody out, an emergency stop too, until they were closed.
#[test]
fn strangers_who_say_nothing_keep_nobody_out() {
    let live = served(LiveOptions::default());
    let strangers: Vec<_> =
        (0..300).map(|_| TcpStream::connect(live.address()).unwrap()).collect();
    let stop = format!("/stop?token={}", live.token());
    let origin = format!("Origin: http://{}\r\n", live.address());
    assert_eq!(status(&live, "POST", &stop, &origin), 204);
    // It did not wait for the last of them.
    let mut last = &strangers[299];
    last.set_nonblocking(true).unwrap();
    let error = last.read(&mut [0]).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::WouldBlock);
}
