// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The thread that accepts and reads all connections. It makes no answers and reads no JSON. It waits
//! for no other thread, but for a short lock on the list of pages; a stop takes no lock. So a stop that
//! was sent acts at once, whatever the rest of the program does.
//!
//! A turn reads at most [`TURN`](super::guard::TURN) bytes of a connection; then the others have
//! theirs.

use std::convert::Infallible;
use std::io::{ErrorKind, Read, Write};
use std::mem::take;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use tokio::net::TcpListener;
use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::yield_now;
use tokio::time::{interval, sleep, timeout};
use tungstenite::http::{Method, Response, StatusCode};
use tungstenite::protocol::{Role, WebSocketConfig, WebSocketContext};
use tungstenite::{Bytes, Error, Message, Utf8Bytes};

use super::answers::{Answer, Asked, What, refused, words};
use super::connections::{Connection, Strangers};
use super::guard::{
    ACCEPT_RETRY, ACCEPTED, Budget, Guard, LARGEST_MESSAGE, LONGEST_HEAD, MOST_PAGES, PATIENCE,
    TRACE_PATIENCE, TURN,
};
use super::request::{Head, Route, is_whole, read, takes_gzip, waits_for_leave};
use super::writer;
use crate::stage::{Opened, Out, PageId, Presser, Stage, Waiting};

/// How often the thread shows that it goes on.
const PULSE: Duration = Duration::from_millis(50);

/// What all connections share.
#[derive(Debug)]
pub(super) struct Reader {
    pub(super) stage: Arc<Stage>,
    pub(super) guard: Guard,
    /// The runtime of the thread that writes.
    pub(super) writer: Handle,
    pub(super) requests: SyncSender<Asked>,
    /// The places of connections that named the token, and of traces among them, which are large.
    pub(super) known: Arc<Semaphore>,
    pub(super) traces: Arc<Semaphore>,
}

/// Accepts connections until it is dropped.
pub(super) async fn listen(listener: TcpListener, reader: Reader) -> Infallible {
    let reader = Arc::new(reader);
    let mut strangers = Strangers::default();
    let stage = Arc::clone(&reader.stage);
    tokio::spawn(async move {
        let mut pulse = interval(PULSE);
        loop {
            pulse.tick().await;
            stage.pulse.beat();
        }
    });
    let mut accepted = 0_usize;
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Probably no file descriptors are left: the oldest strangers are closed.
            (0..ACCEPTED).for_each(|_| strangers.close_oldest());
            sleep(ACCEPT_RETRY).await;
            continue;
        };
        let connection = Connection::new(stream);
        strangers.add(&connection);
        let reader = Arc::clone(&reader);
        tokio::spawn(async move { reader.attend(connection).await });
        accepted += 1;
        if accepted.is_multiple_of(ACCEPTED) {
            // Connections that were accepted before have their turn.
            yield_now().await;
        }
    }
}

impl Reader {
    /// Reads the request of a connection.
    async fn attend(&self, connection: Arc<Connection>) {
        let mut bytes = Vec::new();
        match timeout(PATIENCE, whole_head(&connection, &mut bytes)).await {
            Ok(Ok(())) => {}
            Ok(Err(Some(status))) => {
                self.say(&connection, refused(status, ""), false);
                return discard(&connection).await;
            }
            Ok(Err(None)) | Err(_) => return,
        }
        let (head, length) = match read(&bytes) {
            Ok(read) => read,
            Err(status) => {
                self.say(&connection, refused(status, ""), false);
                return discard(&connection).await;
            }
        };
        let rest = bytes.split_off(length);
        match Route::of(&head, &self.guard) {
            Ok(Route::Socket(opening)) => {
                connection.know();
                self.hear(&connection, rest, opening.map(|()| Bytes::new())).await;
            }
            Ok(route) => self.take(&connection, &head, route, rest).await,
            Err(status) => {
                let answer = refused(status, head.uri().path());
                self.say(&connection, answer, head.method() == Method::HEAD);
            }
        }
        discard(&connection).await;
    }

    /// Hands a request on. A stop acts at once.
    async fn take(
        &self,
        connection: &Arc<Connection>,
        head: &Head,
        route: Route,
        rest: Vec<u8>,
    ) {
        let is_head = head.method() == Method::HEAD;
        let busy = || refused(StatusCode::SERVICE_UNAVAILABLE, "");
        let is_stop = matches!(route, Route::Stop(_));
        if let Route::Stop(press) = &route {
            // It acts before there is a place for its connection.
            self.stage.stop.press(Presser::Request(press.clone()));
        }
        let mut held = None;
        if route.is_known() {
            held = Arc::clone(&self.known).try_acquire_owned().ok();
            if held.is_none() {
                return connection.shut();
            }
            connection.know();
        }
        if is_stop {
            self.say(connection, words(StatusCode::NO_CONTENT, ""), false);
            discard(connection).await;
            return drop(held);
        }
        let place = match route {
            Route::Trace | Route::TakeTrace(_) => {
                let Ok(place) = Arc::clone(&self.traces).try_acquire_owned() else {
                    return self.say(connection, busy(), is_head);
                };
                Some(place)
            }
            _ => None,
        };
        let what = match route {
            Route::File(path) => What::File { path, takes_gzip: takes_gzip(head) },
            Route::Scene => What::Scene,
            Route::Trace => What::Trace,
            Route::TakeTrace(length) => {
                if waits_for_leave(head) {
                    self.writer.spawn(writer::give_leave(Arc::clone(connection)));
                }
                match timeout(TRACE_PATIENCE, body(connection, rest, length)).await {
                    Ok(Some(bytes)) => What::Taken(bytes),
                    Ok(None) => return,
                    Err(_) => {
                        let answer = refused(StatusCode::REQUEST_TIMEOUT, "");
                        return self.say(connection, answer, false);
                    }
                }
            }
            Route::Socket(_) | Route::Stop(_) => return,
        };
        self.ask(connection, what, is_head, place);
        // The client reads its answer, and closes.
        discard(connection).await;
        drop(held);
    }

    fn ask(
        &self,
        connection: &Arc<Connection>,
        what: What,
        is_head: bool,
        place: Option<OwnedSemaphorePermit>,
    ) {
        let asked = Asked { connection: Arc::clone(connection), what, is_head, place };
        if self.requests.try_send(asked).is_err() {
            self.say(connection, refused(StatusCode::SERVICE_UNAVAILABLE, ""), is_head);
        }
    }

    /// Has an answer written that takes no time to make.
    fn say(&self, connection: &Arc<Connection>, answer: Answer, is_head: bool) {
        self.writer.spawn(writer::say(Arc::clone(connection), answer, is_head, None));
    }

    /// Reads the messages of a page until it ends.
    async fn hear(
        &self,
        connection: &Arc<Connection>,
        rest: Vec<u8>,
        opening: Response<Bytes>,
    ) {
        let stage = &self.stage;
        let Some(Opened { page, outbox, waiting }) = stage.pages.add(MOST_PAGES) else {
            self.writer.spawn(writer::turn_away(Arc::clone(connection), opening));
            let mut talk = Talk::new(PageId::NONE, Waiting::default(), stage);
            talk.feed.incoming = rest;
            return self.hear_last(connection, &mut talk).await;
        };
        let frames = stage.frames.clone();
        self.writer.spawn(writer::speak(Arc::clone(connection), opening, outbox, frames));
        let mut talk = Talk::new(page, waiting, stage);
        talk.feed.incoming = rest;
        self.follow(connection, &mut talk).await;
        stage.pages.remove(page);
        self.hear_last(connection, &mut talk).await;
    }

    /// Reads the messages of a closed page, as long as there is a place for its connection. Stops alone
    /// count.
    async fn hear_last(&self, connection: &Arc<Connection>, talk: &mut Talk<'_>) {
        talk.is_closed = true;
        match Arc::clone(&self.known).try_acquire_owned() {
            // It takes too long, or has ended.
            Ok(_place) => _ = timeout(PATIENCE, self.follow(connection, talk)).await,
            Err(_) => connection.shut(),
        }
    }

    /// Reads the messages of a page until its connection ends, or the page is closed meanwhile.
    async fn follow(&self, connection: &Arc<Connection>, talk: &mut Talk<'_>) {
        let was_closed = talk.is_closed;
        loop {
            let goes_on = talk.hear();
            let replies = take(&mut talk.feed.outgoing);
            if !replies.is_empty() {
                self.stage.pages.send(talk.page, Out::Raw(replies.into()));
            }
            let is_closing = talk.is_closed && !was_closed;
            if !goes_on || is_closing {
                return;
            }
            if !matches!(connection.read(&mut talk.feed.incoming).await, Ok(1..)) {
                talk.has_ended = true;
                return;
            }
            yield_now().await;
        }
    }
}

/// Reads until a head is whole.
///
/// # Errors
///
/// The status of an answer, or none if the connection ended.
async fn whole_head(
    connection: &Connection,
    bytes: &mut Vec<u8>,
) -> Result<(), Option<StatusCode>> {
    loop {
        let before = bytes.len();
        if !matches!(connection.read(bytes).await, Ok(1..)) {
            return Err(None);
        }
        if is_whole(bytes, before) {
            return Ok(());
        }
        if bytes.len() > LONGEST_HEAD {
            return Err(Some(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE));
        }
        yield_now().await;
    }
}

/// Reads a body. `bytes` came with its head. `None` if the connection ended.
async fn body(connection: &Connection, mut bytes: Vec<u8>, length: usize) -> Option<Vec<u8>> {
    while bytes.len() < length {
        if !matches!(connection.read(&mut bytes).await, Ok(1..)) {
            return None;
        }
        yield_now().await;
    }
    bytes.truncate(length);
    Some(bytes)
}

/// Reads what else a client sends, so that its answer is not lost, until it closes or takes too long.
async fn discard(connection: &Connection) {
    let ended = async {
        let mut bytes = Vec::with_capacity(TURN);
        while matches!(connection.read(&mut bytes).await, Ok(1..)) {
            bytes.clear();
            yield_now().await;
        }
    };
    let _ = timeout(PATIENCE, ended).await;
}

/// What a page says.
struct Talk<'a> {
    page: PageId,
    waiting: Waiting,
    stage: &'a Stage,
    budget: Budget,
    protocol: WebSocketContext,
    feed: Feed,
    /// Whether the page is closed: then stops alone count.
    is_closed: bool,
    /// Whether the connection has ended.
    has_ended: bool,
}

impl<'a> Talk<'a> {
    fn new(page: PageId, waiting: Waiting, stage: &'a Stage) -> Self {
        let config = WebSocketConfig::default()
            .max_message_size(Some(LARGEST_MESSAGE))
            .max_frame_size(Some(LARGEST_MESSAGE))
            .read_buffer_size(TURN)
            .write_buffer_size(0);
        let protocol = WebSocketContext::new(Role::Server, Some(config));
        let (budget, feed) = (Budget::full(Instant::now()), Feed::default());
        Self {
            page,
            waiting,
            stage,
            budget,
            protocol,
            feed,
            is_closed: false,
            has_ended: false,
        }
    }

    /// Takes the messages that have come. `true` if more may come.
    fn hear(&mut self) -> bool {
        while !self.has_ended {
            match self.protocol.read(&mut self.feed) {
                // A binary message is refused as text that is no JSON.
                Ok(Message::Binary(_)) => self.take(Utf8Bytes::from_static("")),
                Ok(Message::Text(text)) => self.take(text),
                // The protocol answers them, and tells the end at the next read.
                Ok(_) => self.spend(0),
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => return true,
                Err(error) => {
                    if matches!(error, Error::Capacity(_)) {
                        self.close("a message has at most 1 MiB");
                    }
                    self.has_ended = true;
                }
            }
        }
        false
    }

    fn take(&mut self, text: Utf8Bytes) {
        if self.is_closed {
            return self.stage.take_last(&text);
        }
        let length = text.len();
        // A stop acts whatever came before it.
        self.stage.take(self.page, text, &self.waiting);
        self.spend(length);
    }

    fn spend(&mut self, bytes: usize) {
        if let Err(why) = self.budget.take(bytes, Instant::now()) {
            self.close(why);
        }
        self.is_closed |= !self.stage.pages.is_open(self.page);
    }

    fn close(&mut self, why: &str) {
        self.stage.pages.close(self.page, why.to_owned());
        self.is_closed = true;
    }
}

/// The bytes of a socket: those that came, and those that the protocol answers by itself.
#[derive(Debug, Default)]
struct Feed {
    incoming: Vec<u8>,
    outgoing: Vec<u8>,
}

impl Read for Feed {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        if self.incoming.is_empty() {
            return Err(ErrorKind::WouldBlock.into());
        }
        let read = self.incoming.as_slice().read(into)?;
        self.incoming.drain(..read);
        Ok(read)
    }
}

impl Write for Feed {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.outgoing.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
