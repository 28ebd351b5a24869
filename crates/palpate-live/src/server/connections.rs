// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Connections: how many at once, and how long one may say nothing.

use std::convert::Infallible;
use std::sync::Arc;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio::time::sleep;

use super::limits::{MOST_CONNECTIONS, PATIENCE, RECOVERY};

/// Serves until it is dropped. A connection that sends no whole head of a request in time is closed,
/// also between requests.
pub(super) async fn serve(listener: TcpListener, router: Router) -> Infallible {
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    let mut connections = http1::Builder::new();
    connections.timer(TokioTimer::new()).header_read_timeout(PATIENCE);
    loop {
        // The semaphore is never closed.
        let place = Arc::clone(&places).acquire_owned().await;
        let Ok((stream, _)) = listener.accept().await else {
            // Without files for more sockets, others have to end first.
            sleep(RECOVERY).await;
            continue;
        };
        let service = TowerToHyperService::new(router.clone());
        let connection =
            connections.serve_connection(TokioIo::new(stream), service).with_upgrades();
        tokio::spawn(async move {
            // What fails is that of one client.
            let _ = connection.await;
            drop(place);
        });
    }
}
