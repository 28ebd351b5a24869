// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The fuzz target's check, over its corpus and seeded mutations of it.

#[expect(unreachable_pub, reason = "shared with the fuzz target")]
#[path = "../../../../fuzz/scene_text.rs"]
mod scene_text;

use palpate_scene::schema;

/// How many mutated texts are read: some two seconds.
const CASES: u32 = 40_000;

/// The largest text to mutate in bytes: larger ones are slower and no richer.
const LARGEST: usize = 6000;

/// What is put in: the format's own punctuation, words and troublesome numbers.
const TOKENS: &[&str] = &[
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "\"",
    "\\",
    "null",
    "true",
    "\"of\":",
    "\"union\":[",
    "\"a\"",
    "0",
    "-0",
    "-1",
    "1e-400",
    "1e400",
    "1e15",
    "1e-15",
    "1e308",
    "0.1",
    "\"shape\":",
    "\"scale\":",
    "2",
    "\"description\":\"\",",
    "\u{feff}",
    "\u{1}",
    "é",
    "\"dimension\":2",
];

/// A generator of numbers for tests (Steele and Vigna 2021, SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % limit.max(1) as u64) as usize
    }
}

/// `text` with a few changes.
fn mutated(text: &str, numbers: &mut Numbers) -> String {
    let mut text = text.as_bytes().to_vec();
    for _ in 0..=numbers.below(3) {
        let at = numbers.below(text.len());
        let end = (at + numbers.below(12)).min(text.len());
        match numbers.below(5) {
            0 => drop(text.drain(at..end)),
            1 => {
                let token = TOKENS[numbers.below(TOKENS.len())];
                text.splice(at..at, token.bytes());
            }
            2 => {
                let token = TOKENS[numbers.below(TOKENS.len())];
                text.splice(at..end, token.bytes());
            }
            3 => {
                let copy = text[at..end].to_vec();
                let to = numbers.below(text.len());
                text.splice(to..to, copy);
            }
            _ => {
                // A number becomes another.
                let digit = |b: &u8| b.is_ascii_digit();
                if let Some(found) = text[at..].iter().position(digit) {
                    text[at + found] = b'0' + numbers.below(10) as u8;
                }
            }
        }
    }
    String::from_utf8_lossy(&text).into_owned()
}

#[test]
fn no_text_makes_reading_panic_or_lie() {
    let mut corpus = crate::common::files("fuzz/corpus/scene");
    corpus.extend(crate::common::files("scenes"));
    let validator = jsonschema::validator_for(&schema()).unwrap();
    let mut read = 0;
    let mut check = |text: &str| {
        if scene_text::check(text).is_some() {
            read += 1;
            let value = serde_json::from_str(text).unwrap();
            if let Err(error) = validator.validate(&value) {
                panic!("{}: the schema says {error} of {text}", error.instance_path());
            }
        }
    };
    for (name, text) in &corpus {
        let scene = scene_text::check(text);
        assert_eq!(scene.is_none(), name.starts_with("bad_"), "{name}");
    }
    corpus.retain(|(_, text)| text.len() <= LARGEST);
    let mut numbers = Numbers(42);
    for _ in 0..CASES {
        let (_, text) = &corpus[numbers.below(corpus.len())];
        check(&mutated(text, &mut numbers));
    }
    assert!(read > CASES / 20, "only {read} mutations are still scenes");
}
