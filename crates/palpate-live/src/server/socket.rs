// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The socket of one page.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, WebSocket, close_code};
use serde_json::json;
use tokio::sync::mpsc;
use tokio::time::{Interval, MissedTickBehavior, interval, timeout};

use super::limits::{Bucket, MOST_PAGES, MOST_UNREADABLE, PATIENCE};
use crate::stage::{Out, PageId, Stage};
use crate::wire::{Ask, Question};

/// How often a page that is seen gets a frame: 60 times a second.
const FRAME: Duration = Duration::from_micros(16_666);

/// How often a page that is not seen gets one.
const HIDDEN_FRAME: Duration = Duration::from_secs(1);

/// What ends a conversation.
type End = Option<CloseFrame>;

/// Speaks with a page until one of both ends it.
pub(super) async fn speak(mut socket: WebSocket, stage: Arc<Stage>) {
    let Some((page, waiting)) = stage.pages.add(MOST_PAGES) else {
        let why = format!("{MOST_PAGES} pages are open already");
        let _ = close(&mut socket, refusal(&why)).await;
        return;
    };
    tell_count(&stage);
    let bucket = Bucket::full(Instant::now());
    let mut talk = Talk { page, stage: &stage, bucket, unreadable: 0, frames: frames(FRAME) };
    let end = talk.go_on(&mut socket, waiting).await;
    stage.gone(page);
    tell_count(&stage);
    if let Some(frame) = end {
        let _ = close(&mut socket, frame).await;
    }
}

fn tell_count(stage: &Stage) {
    stage.pages.broadcast(&json!({ "do": "clients", "count": stage.pages.count() }));
}

fn frames(period: Duration) -> Interval {
    let mut frames = interval(period);
    // What was missed is not made up for.
    frames.set_missed_tick_behavior(MissedTickBehavior::Skip);
    frames
}

fn refusal(why: &str) -> CloseFrame {
    CloseFrame { code: close_code::POLICY, reason: why.to_owned().into() }
}

/// Says why, and closes.
async fn close(socket: &mut WebSocket, frame: CloseFrame) -> Result<(), axum::Error> {
    let bye = json!({ "do": "bye", "why": frame.reason.as_str() });
    let ends = async {
        socket.send(Message::Text(bye.to_string().into())).await?;
        socket.send(Message::Close(Some(frame))).await
    };
    timeout(PATIENCE, ends).await.unwrap_or(Ok(()))
}

/// A conversation with a page.
struct Talk<'a> {
    page: PageId,
    stage: &'a Stage,
    bucket: Bucket,
    unreadable: u32,
    frames: Interval,
}

impl Talk<'_> {
    async fn go_on(&mut self, socket: &mut WebSocket, mut waiting: mpsc::Receiver<Out>) -> End {
        let mut newest = self.stage.frames.clone();
        let mut sent = Bytes::new();
        loop {
            let message = tokio::select! {
                // What the page says goes first: it may be a stop.
                biased;
                said = socket.recv() => match said {
                    Some(Ok(said)) => match self.hear(said) {
                        Ok(()) => continue,
                        Err(end) => return end,
                    },
                    _ => return None,
                },
                answer = waiting.recv() => match answer {
                    Some(Out::Text(text)) => Message::Text(text),
                    Some(Out::Binary(bytes)) => Message::Binary(bytes),
                    None => return Some(refusal("the page took its messages too slowly")),
                },
                _ = self.frames.tick() => {
                    let frame = newest.borrow_and_update().clone();
                    if frame.is_empty() || frame == sent {
                        continue;
                    }
                    sent.clone_from(&frame);
                    Message::Binary(frame)
                }
            };
            match timeout(PATIENCE, socket.send(message)).await {
                Ok(Ok(())) => {}
                Ok(Err(_)) => return None,
                Err(_) => return Some(refusal("the page took no message for 5 s")),
            }
        }
    }

    /// Takes a message of the page.
    fn hear(&mut self, said: Message) -> Result<(), End> {
        let text = match said {
            Message::Text(text) => text,
            // The answer to a close goes out with the next read, which ends the conversation.
            Message::Close(_) | Message::Ping(_) | Message::Pong(_) => return Ok(()),

            Message::Binary(_) => return self.not_read(None, "a message is JSON text"),
        };
        let question = Question::read(&text);
        // A stop counts whatever came before it.
        let is_stop = matches!(&question, Ok(Question { ask: Ask::Stop {}, .. }));
        if !is_stop && !self.bucket.take(Instant::now()) {
            return Err(Some(refusal("the page sent more than 120 messages a second")));
        }
        match question {
            Ok(Question { ask: Ask::Hidden { is }, id }) => {
                self.frames = frames(if is { HIDDEN_FRAME } else { FRAME });
                self.stage.pages.answer(self.page, id, json!({ "do": "done" }));
                Ok(())
            }
            Ok(question) => {
                self.stage.take(self.page, question);
                Ok(())
            }
            Err((id, why)) => self.not_read(id, &why),
        }
    }

    fn not_read(&mut self, id: Option<u32>, why: &str) -> Result<(), End> {
        self.unreadable += 1;
        if self.unreadable >= MOST_UNREADABLE {
            let why = format!("{MOST_UNREADABLE} messages could not be read");
            return Err(Some(refusal(&why)));
        }
        self.stage.pages.refuse(self.page, id, why, &[]);
        Ok(())
    }
}
