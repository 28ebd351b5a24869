// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How late the servo of the live page is: quiet, and under clients that flood, stall and send garbage.

use std::error::Error;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use palpate_live::{Live, LiveOptions};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Bytes, Message, WebSocket};

use crate::fields::Rows;

/// How long frames are taken in a run.
const RUN: Duration = Duration::from_secs(10);

/// Frames before a run counts.
const WARM: usize = 30;

/// Clients that misuse the server.
const CLIENTS: usize = 50;

/// Where a frame has the longest tick and the largest lateness since the one before [s].
const COST: usize = 32;
const LATENESS: usize = 36;

const SCENE: &str = include_str!("../../scenes/s3.json");

/// All rows of the suite.
pub(crate) fn measure() -> Result<Rows, Box<dyn Error>> {
    let mut rows = Rows::new();
    for (name, is_under_load) in [("quiet", false), ("loaded", true)] {
        eprintln!("measuring the page, {name} …");
        let live = Live::start("s3", None, SCENE, LiveOptions::default())?;
        let mut page = connect(&live)?;
        page.send(Message::Text(r#"{"do":"hello","version":2}"#.into()))?;
        let ends = AtomicBool::new(false);
        let frames = std::thread::scope(|scope| {
            if is_under_load {
                for client in 0..CLIENTS {
                    let (live, ends) = (&live, &ends);
                    scope.spawn(move || misuse(live, client, ends));
                }
            }
            let frames = frames(&mut page);
            ends.store(true, Ordering::Relaxed);
            frames
        })?;
        add(&mut rows, &format!("live.{name}"), &frames);
    }
    let late = |name: &str| rows.get(&format!("live.{name}.lateness.p50_ns")).copied();
    if let Some((loaded, quiet)) = late("loaded").zip(late("quiet")) {
        rows.insert("live.lateness.loaded_over_quiet".to_owned(), loaded / quiet);
    }
    Ok(rows)
}

/// Longest tick and largest lateness of each frame of a run [ns].
fn frames(page: &mut WebSocket<TcpStream>) -> Result<Vec<[f64; 2]>, tungstenite::Error> {
    let mut frames = Vec::new();
    let begin = Instant::now();
    while begin.elapsed() < RUN {
        if let Message::Binary(bytes) = page.read()?
            && bytes.first() == Some(&1)
        {
            let number = |at: usize| {
                let bytes = bytes.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
                1e9 * f64::from(bytes.map_or(f32::NAN, f32::from_le_bytes))
            };
            frames.push([number(COST), number(LATENESS)]);
        }
    }
    frames.drain(..WARM.min(frames.len()));
    Ok(frames)
}

fn add(rows: &mut Rows, key: &str, frames: &[[f64; 2]]) {
    let rate = frames.len() as f64 / RUN.as_secs_f64();
    rows.insert(format!("{key}.frames_a_second"), rate);
    for (which, name) in ["tick", "lateness"].into_iter().enumerate() {
        let mut all: Vec<f64> = frames.iter().map(|frame| frame[which]).collect();
        all.sort_by(f64::total_cmp);
        for (part, stat) in [(0.5, "p50_ns"), (0.99, "p99_ns"), (1.0, "max_ns")] {
            let place = (all.len().saturating_sub(1) as f64 * part) as usize;
            if let Some(value) = all.get(place) {
                rows.insert(format!("{key}.{name}.{stat}"), *value);
            }
        }
    }
}

fn connect(live: &Live) -> Result<WebSocket<TcpStream>, Box<dyn Error>> {
    let (address, token) = (live.address(), live.token());
    let mut request = format!("ws://{address}/socket?token={token}").into_client_request()?;
    request.headers_mut().insert("origin", format!("http://{address}").parse()?);
    let stream = TcpStream::connect(address)?;
    Ok(tungstenite::client(request, stream)?.0)
}

/// A third floods, a third reads nothing, a third sends garbage: until `ends`.
fn misuse(live: &Live, client: usize, ends: &AtomicBool) {
    let question = r#"{"do":"ask","question":{"question":"point","at":[0,0.06,0]},"id":1}"#;
    let question = Message::Text(question.into());
    while !ends.load(Ordering::Relaxed) {
        let Ok(mut page) = connect(live) else { continue };
        for round in 0..200_usize {
            let message = match client % 3 {
                0 => question.clone(),
                1 => {
                    std::thread::sleep(Duration::from_millis(5));
                    question.clone()
                }
                _ => {
                    Message::Binary(Bytes::from(vec![round as u8; 1 + 7919 * round % 100_000]))
                }
            };
            if ends.load(Ordering::Relaxed) || page.send(message).is_err() {
                break;
            }
        }
    }
}
