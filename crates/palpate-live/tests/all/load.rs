// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo under clients that flood, stall and send garbage.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use palpate::servo_loop::VirtualClock;
use palpate_live::{Live, LiveOptions};
use serde_json::json;
use tungstenite::{Bytes, Message};

use crate::talk::{Page, raw};

/// Ground under a hand that rests. Without bounds there is no tour, and the hand is led so near that
/// it is not lifted: both are led by steps of the machine's clock, which would make runs differ.
pub(crate) const GROUND: &str = r#"{ "palpate": 1, "dimension": 3,
    "bodies": [ { "name": "ground", "shape": { "half_space": { "normal": [0, 1, 0], "offset": -0.01 } },
                  "material": { "stiffness": 300, "damping": 0 } } ] }"#;

/// Where the hand presses into the ground [m].
pub(crate) const PRESSED: [f64; 3] = [0.0, -0.02, 0.0];

/// Clients that misuse the server.
const CLIENTS: usize = 50;

/// Steps of the virtual clock, and the ticks of each.
const STEPS: u32 = 40;
const TICKS: u32 = 50;

/// The rows of a run in which a hand presses the ground, without the times that they took.
fn rows(is_under_load: bool) -> Vec<String> {
    let (clock, mut driver) = VirtualClock::driven();
    let options = LiveOptions { clock: clock.into(), ..LiveOptions::default() };
    let live = Live::start("ground", None, GROUND, options).unwrap();
    let mut page = Page::open(&live);
    // The first tick comes by itself, at time zero.
    page.binary(1);
    page.ask(json!({ "do": "hand", "target": PRESSED, "held": true }));
    page.say(&json!({ "do": "record", "on": true }));
    // Orders are obeyed one after the other.
    page.ask(json!({ "do": "clock" }));
    let ends = AtomicBool::new(false);
    std::thread::scope(|scope| {
        if is_under_load {
            for client in 0..CLIENTS {
                let (live, ends) = (&live, &ends);
                scope.spawn(move || misuse(live, client, ends));
            }
        }
        for step in 1..=STEPS {
            driver.advance(Duration::from_millis(TICKS.into()));
            // Rows wait for a second of ticks: they are taken before the next ones come.
            page.wait_for_tick(1 + u64::from(step * TICKS));
        }
        ends.store(true, Ordering::Relaxed);
    });
    let (address, token) = (live.address(), live.token());
    let request = format!("GET /trace.csv?token={token} HTTP/1.0\r\nHost: {address}\r\n\r\n");
    let answer = raw(address, &request);
    drop(driver);
    let (_, csv) = answer.split_once("\r\n\r\n").unwrap();
    let mut lines = csv.lines();
    let names: Vec<_> = lines.next().unwrap().split(',').collect();
    let kept: Vec<_> = (0..names.len()).filter(|i| !names[*i].ends_with("_ns")).collect();
    lines
        .map(|line| {
            let fields: Vec<_> = line.split(',').collect();
            kept.iter().map(|i| fields[*i]).collect::<Vec<_>>().join(",")
        })
        .collect()
}

/// A third floods, a third reads nothing, a third sends garbage; until it is closed or `ends`.
fn misuse(live: &Live, client: usize, ends: &AtomicBool) {
    while !ends.load(Ordering::Relaxed) {
        let mut page = Page::silent(live);
        let question = r#"{"do":"ask","question":{"question":"point","at":[0,0.06,0]},"id":1}"#;
        let question = Message::Text(question.into());
        for round in 0..200_usize {
            if ends.load(Ordering::Relaxed) {
                return;
            }
            let is_open = match client % 3 {
                0 => page.try_send(question.clone()),
                1 => {
                    std::thread::sleep(Duration::from_millis(5));
                    page.try_send(question.clone())
                }
                _ => {
                    let noise = vec![round as u8; 1 + 7919 * round % 100_000];
                    page.try_send(Message::Binary(Bytes::from(noise)))
                }
            };
            if !is_open {
                break;
            }
        }
        // A request that is never finished.
        let _ = std::net::TcpStream::connect(live.address());
    }
}

#[test]
fn the_servo_does_the_same_ticks_with_the_same_bits_under_load() {
    let quiet = rows(false);
    assert_eq!(quiet.len(), (STEPS * TICKS) as usize, "one row a tick");
    // In contact with body 0, not slipping, not lifted.
    let pressed = ",true,0,false,false,";
    assert!(quiet.last().unwrap().contains(pressed), "the hand presses: {:?}", quiet.last());
    let loaded = rows(true);
    assert_eq!(quiet.len(), loaded.len());
    for (quiet, loaded) in quiet.iter().zip(&loaded) {
        assert_eq!(quiet, loaded);
    }
}
