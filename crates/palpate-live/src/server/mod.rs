// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The server: its routes.

mod assets;
mod connections;
mod guard;
mod limits;
mod socket;
mod whole;

use std::net::SocketAddr;
use std::sync::Arc;

use axum::Router;
use axum::body::{Body, HttpBody, to_bytes};
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde::Deserialize;
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, oneshot};
use tokio::time::timeout;
use tower_http::compression::CompressionLayer;

use crate::stage::Stage;
use guard::{Guard, HEADERS};
pub(crate) use guard::{is_token, new_token};
use limits::{LARGEST_ANSWER, LARGEST_MESSAGE, LARGEST_TRACE, MOST_TRACES, TRACE_PATIENCE};
use whole::Whole;

/// What all requests share.
#[derive(Clone, Debug)]
struct Shared {
    stage: Arc<Stage>,
    guard: Arc<Guard>,
    /// The places of traces, which are large.
    traces: Arc<Semaphore>,
}

/// The token of a request.
#[derive(Debug, Deserialize)]
struct Token {
    token: Option<String>,
}

/// Serves until `end` is dropped or sent.
pub(crate) async fn serve(
    listener: TcpListener,
    address: SocketAddr,
    token: String,
    stage: Arc<Stage>,
    end: oneshot::Receiver<()>,
) {
    let guard = Arc::new(Guard::new(address, token));
    let shared = Shared { stage, guard, traces: Arc::new(Semaphore::new(MOST_TRACES)) };
    let router = Router::new()
        .route("/", get(|| async { assets::answer("index.html") }))
        .route("/{*path}", get(|Path(path): Path<String>| async move { assets::answer(&path) }))
        .layer(CompressionLayer::new())
        .route("/socket", get(socket))
        .route("/stop", post(stop))
        .route("/scene.json", get(scene))
        .route("/trace.csv", get(trace).post(take_trace))
        .layer(from_fn_with_state(shared.clone(), guarded))
        .with_state(shared);
    tokio::select! {
        never = connections::serve(listener, router) => match never {},
        _ = end => {}
    }
}

/// Checks the host of every request, sets the headers of every answer, and says in words what is refused.
async fn guarded(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let mut response = match shared.guard.check_host(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(status) => status.into_response(),
    };
    if response.body().is_end_stream()
        && let Some(words) = in_words(response.status())
    {
        response = (response.status(), words).into_response();
    }
    for (name, value) in HEADERS {
        let name = HeaderName::from_static(name);
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Why a request is refused, by the status of its answer.
fn in_words(status: StatusCode) -> Option<&'static str> {
    Some(match status {
        StatusCode::UNAUTHORIZED => {
            "The token is missing or wrong: open the address that the program printed, to its end.\n"
        }
        StatusCode::FORBIDDEN => "The request comes from the page of another server.\n",
        StatusCode::MISDIRECTED_REQUEST => {
            "The host of the request is not one at which this server listens.\n"
        }
        StatusCode::NOT_FOUND => "There is nothing at this path.\n",
        StatusCode::REQUEST_TIMEOUT => "The trace came too slowly.\n",
        StatusCode::PAYLOAD_TOO_LARGE => "The trace is too large.\n",
        StatusCode::SERVICE_UNAVAILABLE => "The program is busy: ask again.\n",
        _ => return None,
    })
}

async fn socket(
    State(shared): State<Shared>,
    Query(query): Query<Token>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Result<Response, StatusCode> {
    shared.guard.check_origin(&headers)?;
    shared.guard.check_token(query.token.as_deref())?;
    let upgrade = upgrade
        .max_message_size(LARGEST_MESSAGE)
        .max_frame_size(LARGEST_MESSAGE)
        .max_write_buffer_size(LARGEST_ANSWER)
        .write_buffer_size(0);
    Ok(upgrade.on_upgrade(|socket| socket::speak(socket, shared.stage)))
}

async fn stop(
    State(shared): State<Shared>,
    Query(query): Query<Token>,
    headers: HeaderMap,
) -> Result<StatusCode, StatusCode> {
    shared.guard.check_origin(&headers)?;
    shared.guard.check_token(query.token.as_deref())?;
    shared.stage.stop.set(true);
    Ok(StatusCode::NO_CONTENT)
}

async fn scene(
    State(shared): State<Shared>,
    Query(query): Query<Token>,
) -> Result<Response, StatusCode> {
    shared.guard.check_token(query.token.as_deref())?;
    let text = shared.stage.text();
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

async fn trace(
    State(shared): State<Shared>,
    Query(query): Query<Token>,
) -> Result<Response, StatusCode> {
    shared.guard.check_token(query.token.as_deref())?;
    let place = Arc::clone(&shared.traces).try_acquire_owned();
    let place = place.map_err(|_| StatusCode::SERVICE_UNAVAILABLE)?;
    let stage = Arc::clone(&shared.stage);
    let rows = tokio::task::spawn_blocking(move || {
        stage.trace().map(|trace| trace.map(|trace| trace()))
    });
    let rows = rows.await.ok().flatten().ok_or(StatusCode::SERVICE_UNAVAILABLE)?;
    let Some(rows) = rows else {
        let words = "Nothing is recorded yet: send `record` first.\n";
        return Ok((StatusCode::NOT_FOUND, words).into_response());
    };
    let body = Body::new(Whole::new(rows.into(), place));
    Ok(([(header::CONTENT_TYPE, "text/csv")], body).into_response())
}

async fn take_trace(
    State(shared): State<Shared>,
    Query(query): Query<Token>,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, StatusCode> {
    shared.guard.check_origin(&headers)?;
    shared.guard.check_token(query.token.as_deref())?;
    let place = Arc::clone(&shared.traces).try_acquire_owned();
    let place = place.map_err(|_| StatusCode::SERVICE_UNAVAILABLE)?;
    let bytes = timeout(TRACE_PATIENCE, to_bytes(body, LARGEST_TRACE)).await;
    let bytes = bytes.map_err(|_| StatusCode::REQUEST_TIMEOUT)?;
    let bytes = bytes.map_err(|_| StatusCode::PAYLOAD_TOO_LARGE)?;
    let stage = Arc::clone(&shared.stage);
    let taken = tokio::task::spawn_blocking(move || {
        let taken = stage.take_trace(&bytes);
        drop(place);
        taken
    });
    Ok(match taken.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)? {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(why) => (StatusCode::UNPROCESSABLE_ENTITY, why).into_response(),
    })
}
