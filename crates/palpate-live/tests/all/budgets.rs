// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a page may ask for, and what waits.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::{Arc, Condvar, Mutex};

use palpate_live::{Live, LiveOptions, Watch, Work};
use serde_json::json;
use tungstenite::Message;

use crate::talk::{BALL, Page, served};

/// Twelve pages with 29 questions of 1 MiB each once held 868 MB.
#[test]
fn bytes_that_wait_are_bounded() {
    let gate = Arc::new((Mutex::new(true), Condvar::new()));
    let held = Arc::clone(&gate);
    let watch = Watch::new(move |work| {
        let (is_open, changed) = &*held;
        let guard = is_open.lock().unwrap();
        drop(changed.wait_while(guard, |is_open| work == Work::Message && !*is_open).unwrap());
    });
    let options = LiveOptions { watch, ..LiveOptions::default() };
    let live = Live::start("ball", None, BALL, options).unwrap();
    let mut page = Page::open(&live);
    *gate.0.lock().unwrap() = false;
    let text =
        json!({ "do": "open", "name": "large", "text": " ".repeat(1_000_000) }).to_string();
    while page.try_send(Message::Text(text.as_str().into())) {}
    let bye = page.text(|message| message["do"] == "bye");
    let why = bye["why"].as_str().unwrap();
    assert!(why.contains("1 MB a second") || why.contains("more than the program"), "{why}");
    *gate.0.lock().unwrap() = true;
    gate.1.notify_all();
}

#[test]
fn long_messages_are_for_scenes_alone() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    for (what, about, longest) in [
        ("hand", "", 4096),
        ("ask", "point", 4096),
        ("ask", "contacts", 65536),
        ("element", "", 65536),
    ] {
        let question = json!({ "question": about, "numbers": vec![0; longest] });
        let refused = page.ask(json!({ "do": what, "question": question }));
        let said = refused["message"].as_str().unwrap();
        assert!(said.contains(&format!("at most {longest} bytes")), "{what}: {said}");
    }
}

/// Strangers once closed the connection of who sent a trace with the token.
#[test]
fn who_names_the_token_is_not_closed_for_strangers() {
    let live = served(LiveOptions::default());
    let _page = Page::open(&live);
    let (address, token) = (live.address(), live.token());
    let trace = "time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0\n";
    let mut known = TcpStream::connect(address).unwrap();
    let head = format!(
        "POST /trace.csv?token={token} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\n\
         Expect: 100-continue\r\nContent-Length: {}\r\n\r\n",
        trace.len()
    );
    known.write_all(head.as_bytes()).unwrap();
    let mut leave = [0; 25];
    known.read_exact(&mut leave).unwrap();
    assert_eq!(&leave, b"HTTP/1.1 100 Continue\r\n\r\n");
    let strangers: Vec<_> = (0..400).map(|_| TcpStream::connect(address).unwrap()).collect();
    // The last of them was accepted once it is answered.
    let mut last = &strangers[399];
    last.write_all(format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n").as_bytes()).unwrap();
    last.read_exact(&mut [0]).unwrap();
    known.write_all(trace.as_bytes()).unwrap();
    let mut answer = String::new();
    known.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 204"), "{answer}");
}
