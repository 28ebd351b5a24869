// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The files of the page, which the program holds.

use std::path::{Component, Path};

use axum::body::Bytes;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use include_dir::{Dir, include_dir};

static PAGE: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/web");

/// A folder from which the files are read instead, by who works on the page.
const FOLDER: &str = "PALPATE_WEB";

/// The file at a path, or 404.
pub(super) fn answer(path: &str) -> Response {
    match (kind(path), bytes(path)) {
        (Some(kind), Some(bytes)) => ([(header::CONTENT_TYPE, kind)], bytes).into_response(),
        _ => StatusCode::NOT_FOUND.into_response(),
    }
}

fn bytes(path: &str) -> Option<Bytes> {
    if let Some(folder) = std::env::var_os(FOLDER) {
        let is_plain = |part| matches!(part, Component::Normal(_));
        let is_within = Path::new(path).components().all(is_plain);
        let read = is_within.then(|| std::fs::read(Path::new(&folder).join(path)).ok());
        return read.flatten().map(Bytes::from);
    }
    PAGE.get_file(path).map(|file| Bytes::from_static(file.contents()))
}

/// The type of a file by its name; `None` for what is no part of the page.
fn kind(path: &str) -> Option<&'static str> {
    Some(match Path::new(path).extension()?.to_str()? {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        "ttf" => "font/ttf",
        "woff2" => "font/woff2",
        "txt" => "text/plain; charset=utf-8",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_there_and_nothing_else() {
        for path in ["index.html", "main.js", "scene/stage.js", "style.css", "favicon.svg"] {
            assert_eq!(answer(path).status(), StatusCode::OK, "{path}");
        }
        for path in ["", "..", "../Cargo.toml", "scene", "scene/../main.js", "main.js.map"] {
            assert_eq!(answer(path).status(), StatusCode::NOT_FOUND, "{path}");
        }
    }

    #[test]
    fn the_page_is_small() {
        fn size(folder: &Dir<'_>) -> usize {
            let files = folder.files().map(|file| file.contents().len());
            files.chain(folder.dirs().map(size)).sum()
        }
        let size = size(&PAGE);
        assert!(size < 700_000, "{size} bytes");
    }
}
