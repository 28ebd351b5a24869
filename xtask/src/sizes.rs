// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A rule on crates: how large one may grow before it is parted.

use std::collections::BTreeMap;

use crate::command::Failure;
use crate::tree::{self, Text};

/// The most lines of a crate's sources.
const MOST_LINES: usize = 12_000;

/// Crates that may be larger, and up to which size.
const LARGER: &[(&str, usize)] = &[
    // All fields know one another: operators, kernels and the engine that evaluates both.
    ("palpate-field", usize::MAX),
    // A folder a command, and no command knows another: what would be parted is parted already.
    ("palpate-cli", 16_000),
    // Proxy, creases, tools and their servo share one tick; guides alone could leave it.
    ("palpate-haptics", 14_200),
    // All searches share one engine, one pair of bodies and their cells.
    ("palpate-query", 14_000),
];

/// Checks the size of every crate.
pub(crate) fn check() -> Result<(), Failure> {
    Failure::any(problems(&tree::texts(&["rs"])?))
}

fn problems(texts: &[Text]) -> Vec<String> {
    let mut lines: BTreeMap<String, usize> = BTreeMap::new();
    for Text { path, text } in texts {
        let mut parts = path.iter().map(|part| part.to_string_lossy());
        if parts.next().as_deref() != Some("crates") {
            continue;
        }
        let (name, folder) = (parts.next(), parts.next());
        if let (Some(name), Some("src")) = (name, folder.as_deref()) {
            *lines.entry(name.into_owned()).or_default() += text.lines().count();
        }
    }
    let too_large = lines.into_iter().filter_map(|(name, lines)| {
        let most = LARGER.iter().find(|(larger, _)| *larger == name);
        let most = most.map_or(MOST_LINES, |(_, most)| *most);
        (lines > most).then(|| format!("{name} has {lines} lines of sources, {most} at most"))
    });
    too_large.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(path: &str, lines: usize) -> Text {
        Text { path: path.into(), text: "\n".repeat(lines) }
    }

    #[test]
    fn a_crate_that_grew_too_large_is_refused() {
        let half = MOST_LINES / 2;
        let mut texts = vec![
            text("crates/a/src/lib.rs", half),
            text("crates/a/src/b/c.rs", half),
            // Tests and other crates do not count.
            text("crates/a/tests/d.rs", MOST_LINES),
            text("crates/b/src/lib.rs", MOST_LINES),
        ];
        assert_eq!(problems(&texts), [""; 0]);
        texts.push(text("crates/a/src/e.rs", 1));
        assert_eq!(problems(&texts), ["a has 12001 lines of sources, 12000 at most"]);
        assert_eq!(problems(&[text("crates/palpate-field/src/lib.rs", 30_000)]), [""; 0]);
    }
}
