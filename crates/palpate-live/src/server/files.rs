// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The files of the page, which the program holds as `build.rs` compressed them.

use std::io::Read;
use std::path::{Component, Path};

use flate2::read::GzDecoder;
use tungstenite::Bytes;
use tungstenite::http::header::{CONTENT_ENCODING, VARY};
use tungstenite::http::{HeaderValue, StatusCode};

use super::answers::{Answer, answer as answer_of, refused};

/// A file by its path, compressed by gzip.
struct Compressed {
    path: &'static str,
    bytes: &'static [u8],
}

/// In the order of their paths.
const PAGE: &[Compressed] = include!(concat!(env!("OUT_DIR"), "/page.rs"));

/// A folder from which the files are read instead, by who works on the page.
const FOLDER: &str = "PALPATE_WEB";

/// The file at a path, or 404.
pub(super) fn answer(path: &str, takes_gzip: bool) -> Answer {
    let found = kind(path).zip(bytes(path, takes_gzip));
    let Some((kind, (bytes, is_compressed))) = found else {
        return refused(StatusCode::NOT_FOUND, path);
    };
    let mut answer = answer_of(StatusCode::OK, kind, bytes);
    answer.headers_mut().insert(VARY, HeaderValue::from_static("accept-encoding"));
    if is_compressed {
        answer.headers_mut().insert(CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    }
    answer
}

/// The bytes of a file, and whether they are compressed.
fn bytes(path: &str, takes_gzip: bool) -> Option<(Bytes, bool)> {
    if let Some(folder) = std::env::var_os(FOLDER) {
        let is_plain = |part| matches!(part, Component::Normal(_));
        let is_within = Path::new(path).components().all(is_plain);
        let read = is_within.then(|| std::fs::read(Path::new(&folder).join(path)).ok());
        return read.flatten().map(|bytes| (bytes.into(), false));
    }
    let place = PAGE.binary_search_by(|file| file.path.cmp(path)).ok()?;
    let compressed = PAGE.get(place)?.bytes;
    if takes_gzip {
        return Some((Bytes::from_static(compressed), true));
    }
    plain(compressed).map(|bytes| (bytes.into(), false))
}

/// The bytes of a file as it was.
fn plain(compressed: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    GzDecoder::new(compressed).read_to_end(&mut bytes).ok()?;
    Some(bytes)
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
            let on_disk = Path::new(env!("CARGO_MANIFEST_DIR")).join("web").join(path);
            let on_disk = std::fs::read(on_disk).unwrap();
            let whole = answer(path, false);
            assert_eq!((whole.status(), whole.body().as_ref()), (StatusCode::OK, &on_disk[..]));
            assert!(!whole.headers().contains_key(CONTENT_ENCODING));
            let small = answer(path, true);
            assert_eq!(small.headers()[CONTENT_ENCODING], "gzip");
            assert_eq!(plain(small.body()).unwrap(), on_disk);
        }
        for path in ["", "..", "../Cargo.toml", "scene", "scene/../main.js", "main.js.map"] {
            assert_eq!(answer(path, true).status(), StatusCode::NOT_FOUND, "{path}");
        }
    }

    #[test]
    fn the_page_is_small() {
        let size: usize =
            PAGE.iter().filter_map(|file| plain(file.bytes)).map(|it| it.len()).sum();
        assert!((300_000..700_000).contains(&size), "{size} bytes");
    }
}
