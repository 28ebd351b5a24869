// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Connections: one is read by one thread and written by another; and how many there are at once.

use std::collections::VecDeque;
use std::io::{ErrorKind, Result};
use std::net::Shutdown;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Weak};

use socket2::SockRef;
use tokio::net::TcpStream;
use tokio::time::timeout;

use super::guard::{CHUNK, MOST_STRANGERS, PATIENCE, TURN};

/// A connection of a client, which carries one request, or the socket of a page.
#[derive(Debug)]
pub(super) struct Connection {
    stream: TcpStream,
    /// Whether its request named the token.
    is_known: AtomicBool,
}

impl Connection {
    pub(super) fn new(stream: TcpStream) -> Arc<Self> {
        // A frame goes out at once. A failure only delays frames.
        let _ = stream.set_nodelay(true);
        Arc::new(Self { stream, is_known: AtomicBool::new(false) })
    }

    /// Takes note that the request named the token.
    pub(super) fn know(&self) {
        self.is_known.store(true, Ordering::Relaxed);
    }

    /// Reads at most a turn's bytes to the end of `bytes`; 0 at the end of the connection.
    pub(super) async fn read(&self, bytes: &mut Vec<u8>) -> Result<usize> {
        loop {
            self.stream.readable().await?;
            match self.read_turn(bytes) {
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                read => return read,
            }
        }
    }

    fn read_turn(&self, bytes: &mut Vec<u8>) -> Result<usize> {
        let mut turn = [0; TURN];
        let read = self.stream.try_read(&mut turn)?;
        bytes.extend_from_slice(turn.get(..read).unwrap_or_default());
        Ok(read)
    }

    /// Writes all of `bytes`, chunk by chunk. It fails if the client leaves a chunk unread for too long.
    pub(super) async fn write(&self, bytes: &[u8]) -> Result<()> {
        for part in bytes.chunks(CHUNK) {
            let written = timeout(PATIENCE, self.write_part(part)).await;
            written.map_err(|_| std::io::Error::from(ErrorKind::TimedOut))??;
        }
        Ok(())
    }

    async fn write_part(&self, mut part: &[u8]) -> Result<()> {
        while !part.is_empty() {
            self.stream.writable().await?;
            match self.stream.try_write(part) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(written) => part = part.get(written..).unwrap_or_default(),
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Says that nothing more is written.
    pub(super) fn finish(&self) {
        // A client that has gone needs no end.
        let _ = SockRef::from(&self.stream).shutdown(Shutdown::Write);
    }

    /// Ends reading and writing, whoever does it.
    pub(super) fn shut(&self) {
        let _ = SockRef::from(&self.stream).shutdown(Shutdown::Both);
    }
}

/// The connections that have not named the token. If there are too many, the oldest is closed:
/// strangers who hold theirs open keep nobody out.
#[derive(Debug, Default)]
pub(super) struct Strangers(VecDeque<Weak<Connection>>);

impl Strangers {
    /// Adds a connection.
    pub(super) fn add(&mut self, connection: &Arc<Connection>) {
        self.0.retain(|other| {
            other.upgrade().is_some_and(|other| !other.is_known.load(Ordering::Relaxed))
        });
        if self.0.len() >= MOST_STRANGERS {
            self.close_oldest();
        }
        self.0.push_back(Arc::downgrade(connection));
    }

    pub(super) fn close_oldest(&mut self) {
        while let Some(oldest) = self.0.pop_front() {
            if let Some(oldest) =
                oldest.upgrade().filter(|it| !it.is_known.load(Ordering::Relaxed))
            {
                oldest.shut();
                return;
            }
        }
    }
}
