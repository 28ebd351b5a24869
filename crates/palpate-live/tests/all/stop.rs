// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The emergency stop, whatever the rest of the program does.

use std::collections::{HashMap, HashSet};
use std::io::Write;
use std::net::TcpStream;
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

use palpate::haptics::StopSwitch;
use palpate::servo_loop::VirtualClock;
use palpate_live::{Live, LiveOptions, Watch, Work};
use serde_json::{Value, json};

use crate::load::{GROUND, PRESSED};
use crate::talk::{Page, raw, served};

/// How long what is waited for may take on a machine that does something else.
const PATIENCE: Duration = Duration::from_secs(60);

/// Holds threads where they begin to work.
#[derive(Debug, Default)]
struct Gates {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    closed: HashSet<Work>,
    held: HashMap<Work, usize>,
}

impl Gates {
    fn pass(&self, work: Work) {
        let mut state = self.state.lock().unwrap();
        *state.held.entry(work).or_default() += 1;
        self.changed.notify_all();
        while state.closed.contains(&work) {
            state = self.changed.wait(state).unwrap();
        }
        *state.held.entry(work).or_default() -= 1;
    }

    fn close(&self, work: Work) {
        self.state.lock().unwrap().closed.insert(work);
    }

    fn open(&self) {
        self.state.lock().unwrap().closed.clear();
        self.changed.notify_all();
    }

    fn wait_for(&self, work: Work, count: usize) {
        let state = self.state.lock().unwrap();
        let is_there = |state: &mut State| state.held.get(&work).copied().unwrap_or(0) < count;
        let waited = self.changed.wait_timeout_while(state, PATIENCE, is_there).unwrap();
        assert!(!waited.1.timed_out(), "{count} threads come to {work:?}");
    }
}

/// Opens the gates however a test ends, so that the program can.
struct Opens<'a>(&'a Gates);

impl Drop for Opens<'_> {
    fn drop(&mut self) {
        self.0.open();
    }
}

#[derive(Clone, Copy, Debug)]
enum Way {
    Socket,
    Request,
    /// As the thread that takes Ctrl-C and SIGTERM does.
    Switch,
}

/// 200 connections that asked for a compressed file once delayed a stop by 9.7 s, messages of 1 MiB by
/// 2.7 s: the thread that read the stop also compressed files and read JSON.
#[test]
fn a_stop_waits_for_no_other_thread() {
    for way in [Way::Socket, Way::Request, Way::Switch] {
        let gates = Arc::new(Gates::default());
        let (clock, mut driver) = VirtualClock::driven();
        let (switch, watched) = (StopSwitch::new(), Arc::clone(&gates));
        let options = LiveOptions {
            clock: clock.into(),
            stop: switch.clone(),
            watch: Watch::new(move |work| watched.pass(work)),
            ..LiveOptions::default()
        };
        let live = Live::start("ground", None, GROUND, options).unwrap();
        let _opens = Opens(&gates);
        let mut page = Page::open(&live);
        page.binary(1);
        page.ask(json!({ "do": "hand", "target": PRESSED, "held": true }));
        page.ask(json!({ "do": "clock" }));
        driver.advance(Duration::from_millis(400));
        page.wait_for_tick(401);
        assert!(push(&page.binary(1)) > 0.5);

        let mut others: Vec<_> = (0..3).map(|_| Page::open(&live)).collect();
        for work in [Work::Question, Work::Edit, Work::Request] {
            gates.close(work);
        }
        for other in &mut others {
            other.say(&json!({ "do": "samples", "cells": 64, "id": 9 }));
            let question = json!({ "question": "point", "at": [0, 0, 0] });
            other.say(&json!({ "do": "ask", "question": question, "id": 10 }));
        }
        gates.wait_for(Work::Question, 3);
        others[0].say(&json!({ "do": "undo" }));
        gates.wait_for(Work::Edit, 1);
        let files: Vec<_> = (0..2).map(|_| ask_for_file(&live)).collect();
        gates.wait_for(Work::Request, 2);
        gates.close(Work::Message);
        let text = " ".repeat((1 << 20) - 100);
        others[1].say(&json!({ "do": "open", "name": "large", "text": text }));
        gates.wait_for(Work::Message, 1);

        match way {
            Way::Socket => page.say(&json!({ "do": "stop", "press": "0f", "id": 3 })),
            Way::Request => assert!(post_stop(&live, "").starts_with("HTTP/1.1 204")),
            Way::Switch => _ = switch.stop(),
        }
        let begin = Instant::now();
        while !switch.is_stopped() {
            assert!(begin.elapsed() < PATIENCE, "the stop is read: {way:?}");
            std::thread::yield_now();
        }
        let stopped = page.text(|message| message["do"] == "stopped");
        assert_eq!(stopped["is_mine"], matches!(way, Way::Socket), "{stopped}");
        driver.advance(Duration::from_millis(2));
        page.wait_for_tick(403);
        let frame = page.binary(1);
        assert!(frame[3] & 1 == 1 && push(&frame) == 0.0, "{way:?}: {} N", push(&frame));
        drop((files, driver));
    }
}

/// The force on the hand along y in a frame [N].
fn push(frame: &[u8]) -> f32 {
    f32::from_le_bytes(frame[92..96].try_into().unwrap())
}

/// Asks for a file, and reads nothing.
fn ask_for_file(live: &Live) -> TcpStream {
    let mut stream = TcpStream::connect(live.address()).unwrap();
    let host = live.address();
    let request = format!(
        "GET /vendor/uplot.js HTTP/1.1\r\nHost: {host}\r\nAccept-Encoding: gzip\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).unwrap();
    stream
}

/// Stops by a request, with more of a query; the answer as it comes.
fn post_stop(live: &Live, query: &str) -> String {
    let (host, token) = (live.address(), live.token());
    let head = format!("Host: {host}\r\nOrigin: http://{host}\r\nContent-Length: 0\r\n");
    raw(host, &format!("POST /stop?token={token}{query} HTTP/1.1\r\n{head}\r\n"))
}

fn release(page: &mut Page, number: Value) -> Value {
    page.ask(json!({ "do": "release", "number": number }))
}

/// Another page that sent `release` every 10 ms once lifted each of 20 stops.
#[test]
fn another_page_lifts_no_stop_at_once() {
    let live = served(LiveOptions::default());
    let (mut own, mut other) = (Page::open(&live), Page::open(&live));
    own.say(&json!({ "do": "stop", "press": "c0ffee", "id": 7 }));
    assert!(post_stop(&live, "&press=c0ffee").starts_with("HTTP/1.1 204"));
    let is_second = |told: &Value| told["do"] == "stopped" && told["number"] == 2;
    // A press that comes both ways is one press of this page.
    let told = own.text(is_second);
    assert_eq!(told["is_mine"], true, "{told}");
    let told = other.text(is_second);
    assert_eq!(told["is_mine"], false, "{told}");
    assert!(told["release_after"].as_f64().unwrap() > 1.0, "{told}");
    for (number, said) in [
        (Value::Null, "STOP was pressed again meanwhile"),
        (json!(1), "STOP was pressed again meanwhile"),
        (json!(2), "STOP was pressed elsewhere"),
    ] {
        let refused = release(&mut other, number);
        assert!(refused["message"].as_str().unwrap().starts_with(said), "{refused}");
    }
    own.release(2);
    let released = other.text(|message| message["do"] == "released");
    assert_eq!(released["number"], 2);
    assert!(!live.stop_switch().is_stopped());
    // A page that opens later hears of the stop that still holds.
    assert!(post_stop(&live, "").starts_with("HTTP/1.1 204"));
    let told = Page::silent(&live).text(|message| message["do"] == "stopped");
    assert_eq!((&told["number"], &told["is_mine"]), (&json!(3), &json!(false)));
}

/// A stop in the longest message, and one whose letters are escaped, stop too.
#[test]
fn a_stop_stops_however_it_is_written() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    let long = format!("{}{{\"do\":\"stop\"}}", " ".repeat(900_000));
    for (number, text) in [(1, r#"{"do":"st\u006fp"}"#), (2, &long)] {
        page.try_send(tungstenite::Message::Text(text.into()));
        let told = page.text(|message| message["do"] == "stopped");
        assert_eq!(told["number"], number);
    }
}

/// Pages once said "live" to a program whose clock was held, and to one that was frozen alike.
#[test]
fn frames_show_that_the_program_lives() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    page.ask(json!({ "do": "tour", "on": false }));
    page.ask(json!({ "do": "clock", "speed": 0 }));
    let beat = |frame: &[u8]| u16::from_le_bytes(frame[62..64].try_into().unwrap());
    let tick = |frame: &[u8]| u64::from_le_bytes(frame[8..16].try_into().unwrap());
    let mut before = page.binary(1);
    let mut beats = 0;
    while beats < 5 {
        let now = page.binary(1);
        beats = if tick(&now) == tick(&before) { beats } else { 0 };
        beats += i32::from(beat(&now) != beat(&before));
        before = now;
    }
}
