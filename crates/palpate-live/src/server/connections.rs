// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Connections: how many at once, and how long one may say nothing.

use std::collections::VecDeque;
use std::convert::Infallible;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::task::AbortHandle;
use tokio::time::sleep;

use super::limits::{MOST_CONNECTIONS, PATIENCE, RECOVERY};

/// Serves until it is dropped. A connection that sends no whole head of a request in time is closed,
/// also between requests. If there are too many, the oldest is closed: strangers who hold theirs open
/// keep nobody out.
pub(super) async fn serve(listener: TcpListener, router: Router) -> Infallible {
    let mut open: VecDeque<AbortHandle> = VecDeque::with_capacity(MOST_CONNECTIONS);
    let mut connections = http1::Builder::new();
    connections.timer(TokioTimer::new()).header_read_timeout(PATIENCE);
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // No file descriptors are left: the oldest connection is closed.
            if let Some(oldest) = open.pop_front() {
                oldest.abort();
            }
            sleep(RECOVERY).await;
            continue;
        };
        open.retain(|connection| !connection.is_finished());
        if open.len() == MOST_CONNECTIONS
            && let Some(oldest) = open.pop_front()
        {
            oldest.abort();
        }
        let service = TowerToHyperService::new(router.clone());
        let connection =
            connections.serve_connection(TokioIo::new(stream), service).with_upgrades();
        // It ends when the connection becomes a WebSocket. An error concerns its client alone.
        let task = tokio::spawn(async { drop(connection.await) });
        open.push_back(task.abort_handle());
    }
}
