// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The server. One thread reads all connections, one writes to them, two make answers that take time.
//! `docs/decisions/live-server.md` says why.

mod answers;
mod connections;
mod files;
mod guard;
mod reader;
mod request;
mod writer;

use std::io::Result;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::thread::{Builder, JoinHandle};

use socket2::{Domain, Socket, Type};
use tokio::runtime::Runtime;
use tokio::sync::{Semaphore, oneshot};

use crate::stage::Stage;
use guard::{BACKLOG, Guard, MOST_KNOWN, MOST_REQUESTS, MOST_TRACES};
pub(crate) use guard::{is_token, new_token};
use reader::Reader;

/// The server, until it is dropped.
#[derive(Debug)]
pub(crate) struct Server {
    /// Those that read end first, so that nothing new is written.
    _reader: Thread,
    _writer: Thread,
}

/// A thread that ends when this is dropped.
#[derive(Debug)]
struct Thread {
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Serves the pages of a stage.
    ///
    /// # Errors
    ///
    /// If the operating system gives no thread.
    pub(crate) fn start(
        listener: TcpListener,
        address: SocketAddr,
        token: String,
        stage: &Arc<Stage>,
    ) -> Result<Self> {
        let (reader_runtime, writer_runtime) = (runtime()?, runtime()?);
        let writer = writer_runtime.handle().clone();
        let (requests, asked) = sync_channel(MOST_REQUESTS);
        answers::start(asked, stage, &writer);
        let reader = Reader {
            stage: Arc::clone(stage),
            guard: Guard::new(address, token),
            writer,
            requests,
            known: Arc::new(Semaphore::new(MOST_KNOWN)),
            traces: Arc::new(Semaphore::new(MOST_TRACES)),
        };
        let writer = Thread::start("palpate writes", writer_runtime, std::future::pending())?;
        let listen = async move {
            // Made in the runtime, whose thread it belongs to.
            let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
            match reader::listen(listener, reader).await {}
        };
        let reader = Thread::start("palpate reads", reader_runtime, listen)?;
        Ok(Self { _reader: reader, _writer: writer })
    }
}

/// Reads bytes as the head of a request, of whoever sent it.
#[cfg(any(test, feature = "fuzzing"))]
pub(crate) fn take_head(bytes: &[u8]) {
    let address = SocketAddr::from(([127, 0, 0, 1], 80));
    let guard = Guard::new(address, "0".repeat(32));
    if let Ok((head, length)) = request::read(bytes) {
        assert!(length <= bytes.len());
        let _ = (request::takes_gzip(&head), request::waits_for_leave(&head));
        let _ = request::Route::of(&head, &guard);
    }
}

/// A socket at which connections may wait.
///
/// # Errors
///
/// If the address cannot be listened at.
pub(crate) fn listener(address: SocketAddr) -> Result<TcpListener> {
    let socket = Socket::new(Domain::for_address(address), Type::STREAM, None)?;
    // As the standard library does: a program that starts again takes its port.
    #[cfg(unix)]
    socket.set_reuse_address(true)?;
    socket.bind(&address.into())?;
    socket.listen(BACKLOG)?;
    socket.set_nonblocking(true)?;
    Ok(socket.into())
}

/// A runtime of one thread.
fn runtime() -> Result<Runtime> {
    tokio::runtime::Builder::new_current_thread().enable_all().build()
}

impl Thread {
    fn start(
        name: &str,
        runtime: Runtime,
        work: impl Future<Output = ()> + Send + 'static,
    ) -> Result<Self> {
        let (end, ended) = oneshot::channel();
        let run = move || {
            runtime.block_on(async {
                tokio::select! {
                    () = work => {}
                    // `end` is dropped.
                    _ = ended => {}
                }
            });
        };
        let thread = Builder::new().name(name.to_owned()).spawn(run)?;
        Ok(Self { end: Some(end), thread: Some(thread) })
    }
}

impl Drop for Thread {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            // A panic in it was printed when it happened.
            let _ = thread.join();
        }
    }
}
