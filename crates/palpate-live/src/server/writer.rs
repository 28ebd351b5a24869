// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The thread that writes to all connections, and does nothing else.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::sync::{OwnedSemaphorePermit, watch};
use tokio::time::{MissedTickBehavior, interval, sleep};
use tungstenite::Bytes;
use tungstenite::http::Response;
use tungstenite::protocol::CloseFrame;
use tungstenite::protocol::frame::coding::{CloseCode, Data, OpCode};
use tungstenite::protocol::frame::{Frame, FrameHeader};

use super::answers::{Answer, head};
use super::connections::Connection;
use super::guard::{MOST_PAGES, PATIENCE};
use crate::stage::{Out, Outbox};
use crate::wire::Told;

/// How often a page that is seen gets a frame: 60 times a second.
const FRAME: Duration = Duration::from_micros(16_666);

/// How often a page that is not seen gets one.
const HIDDEN_FRAME: Duration = Duration::from_secs(1);

/// The longest reason of a close frame [bytes].
const LONGEST_REASON: usize = 123;

/// A client may send its body.
const LEAVE: &[u8] = b"HTTP/1.1 100 Continue\r\n\r\n";

/// Answers a request.
pub(super) async fn say(
    connection: Arc<Connection>,
    answer: Answer,
    is_head: bool,
    place: Option<OwnedSemaphorePermit>,
) {
    let bytes = head(&answer);
    let written = async {
        connection.write(&bytes).await?;
        if is_head { Ok(()) } else { connection.write(answer.body()).await }
    };
    match written.await {
        Ok(()) => connection.finish(),
        Err(_) => connection.shut(),
    }
    drop(place);
}

/// Gives leave to send a body.
pub(super) async fn give_leave(connection: Arc<Connection>) {
    // A client that has gone sends no body.
    let _ = connection.write(LEAVE).await;
}

/// Tells a page that there are too many.
pub(super) async fn turn_away(connection: Arc<Connection>, opening: Response<Bytes>) {
    if connection.write(&head(&opening)).await.is_ok() {
        end(&connection, &format!("{MOST_PAGES} pages are open already")).await;
    }
}

/// Writes to a page what waits for it, and the newest frame whenever one is due, until the page is
/// closed.
pub(super) async fn speak(
    connection: Arc<Connection>,
    opening: Response<Bytes>,
    mut outbox: Outbox,
    mut frames: watch::Receiver<Bytes>,
) {
    if connection.write(&head(&opening)).await.is_err() {
        return connection.shut();
    }
    let mut due = interval(FRAME);
    // What was missed is not made up for.
    due.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let (mut sent, mut sent_at) = (Bytes::new(), None::<Instant>);
    loop {
        let message = tokio::select! {
            biased;
            message = outbox.next() => match message {
                Some(message) => message,
                None => return end(&connection, outbox.why()).await,
            },
            _ = due.tick() => {
                let is_early = outbox.is_hidden()
                    && sent_at.is_some_and(|at| at.elapsed() < HIDDEN_FRAME);
                let frame = frames.borrow_and_update().clone();
                if is_early || frame.is_empty() || frame == sent {
                    continue;
                }
                (sent, sent_at) = (frame.clone(), Some(Instant::now()));
                Out::Binary(frame)
            }
        };
        if write(&connection, message).await.is_err() {
            return end(&connection, "the page took no message for 5 s").await;
        }
    }
}

/// Writes a message.
async fn write(connection: &Connection, message: Out) -> std::io::Result<()> {
    let (data, bytes) = match message {
        Out::Text(text) => (Data::Text, text.into()),
        Out::Binary(bytes) => (Data::Binary, bytes),
        Out::Raw(bytes) => return connection.write(&bytes).await,
    };
    let header = FrameHeader { opcode: OpCode::Data(data), ..FrameHeader::default() };
    let mut head = Vec::new();
    // A vector takes all that is written.
    let _ = header.format(bytes.len() as u64, &mut head);
    if bytes.len() <= super::guard::TURN {
        // In one packet.
        head.extend(&bytes);
        return connection.write(&head).await;
    }
    connection.write(&head).await?;
    connection.write(&bytes).await
}

/// Tells a page why it is closed, and closes it.
async fn end(connection: &Connection, why: &str) {
    let end = why.floor_char_boundary(LONGEST_REASON);
    let reason = why.get(..end).unwrap_or_default().to_owned();
    let close =
        Frame::close(Some(CloseFrame { code: CloseCode::Policy, reason: reason.into() }));
    let mut bytes = Vec::new();
    let _ = close.format(&mut bytes);
    let told = async {
        write(connection, Told::Bye { why }.into()).await?;
        connection.write(&bytes).await
    };
    if told.await.is_ok() {
        connection.finish();
        // The client closes, unless it does nothing.
        sleep(PATIENCE).await;
    }
    connection.shut();
}
