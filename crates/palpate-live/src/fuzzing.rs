// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a page may send, without a server: for the fuzz target `message`.

use std::sync::OnceLock;

use palpate::scene::{AnyScene, Scene};
use serde_json::Value;

use crate::server;
use crate::stage::{answer_alone, trace};
use crate::wire::{Ask, Envelope, Question, Unreadable};

/// The longest side of a grid and of a picture that is asked for here: larger ones only take longer.
const LARGEST: usize = 64;

const PLANE: &str = include_str!("../../../scenes/memoir_star.json");
const SPACE: &str = include_str!("../../../scenes/s3.json");

/// Reads a message, the head of a request, or a trace, and answers what can be answered of a scene in
/// the plane and of one in space; each answer is whole JSON, and the envelope of a message that
/// can be read has the same number.
///
/// # Panics
///
/// If reading or answering does, or one of these does not hold.
pub fn hear(text: &str) {
    // A trace may be anything, and so may a request.
    let _ = [2, 3].map(|dimension| trace::read(text.as_bytes(), dimension));
    server::take_head(text.as_bytes());
    let envelope = Envelope::read(text);
    let Ok(Question { ask, id }) = Question::read(text) else { return };
    match envelope {
        Ok(envelope) => assert_eq!(envelope.id, id, "{text}"),
        // Of two values of a key, a question takes the last.
        Err(Unreadable { why, .. }) => {
            assert!(why.contains("duplicate field"), "{why}: {text}")
        }
    }
    let is_large = match &ask {
        Ask::Slice { columns, rows, .. } => *columns.max(rows) > LARGEST,
        Ask::Samples { cells, .. } => *cells > LARGEST,
        Ask::Picture { width, height, .. } => *width.max(height) as usize > LARGEST,
        _ => false,
    };
    if is_large {
        return;
    }
    for scene in scenes() {
        if let Some(text) = answer_alone(scene, &ask) {
            let read: Result<Value, _> = serde_json::from_str(&text);
            assert!(read.is_ok(), "{text}");
        }
    }
}

fn scenes() -> &'static [AnyScene] {
    static SCENES: OnceLock<Vec<AnyScene>> = OnceLock::new();
    SCENES.get_or_init(|| {
        let built = |text| Scene::from_json(text).and_then(|scene| scene.build());
        [PLANE, SPACE].into_iter().filter_map(|text| built(text).ok()).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus/message");

    /// Every message of the corpus, cut off anywhere, and with every number replaced by others.
    #[test]
    fn messages_and_what_is_nearly_one_are_heard() {
        let files = std::fs::read_dir(CORPUS).unwrap();
        let texts: Vec<_> =
            files.map(|file| std::fs::read_to_string(file.unwrap().path()).unwrap()).collect();
        assert!(texts.len() >= 16 && scenes().len() == 2);
        for text in &texts {
            (0..text.len()).filter(|end| text.is_char_boundary(*end)).for_each(|end| {
                hear(&text[..end]);
            });
            hear(text);
            for (place, digit) in text.char_indices().filter(|(_, c)| c.is_ascii_digit()) {
                for number in ["-1", "1e308", "1e-308", "0", "null", "\"x\"", "[]"] {
                    hear(&format!(
                        "{}{number}{}",
                        &text[..place],
                        &text[place + digit.len_utf8()..]
                    ));
                }
            }
        }
    }
}
