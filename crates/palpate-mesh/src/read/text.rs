// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What files of text have in common: encodings, line ends, and how a complaint quotes them.

use super::ReadProblem;
use crate::encoding::utf16_is_little_endian;

/// The mark with which some editors begin texts in UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Characters of a file that a complaint quotes.
const LONGEST_QUOTE: usize = 40;

/// The bytes of a text without the mark of UTF-8.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(MARK).unwrap_or(bytes)
}

/// Refuses UTF-16. A reader of UTF-8 would find no words in it.
pub(super) fn check_encoding(bytes: &[u8]) -> Result<(), ReadProblem> {
    match utf16_is_little_endian(bytes) {
        None => Ok(()),
        Some(true) => Err(ReadProblem::Utf16 { encoding: "UTF-16LE" }),
        Some(false) => Err(ReadProblem::Utf16 { encoding: "UTF-16BE" }),
    }
}

/// The lines of a text, which end in LF, CR LF or CR.
pub(super) fn lines(text: &str) -> Lines<'_> {
    Lines { rest: text }
}

/// As of [`lines`].
pub(super) struct Lines<'a> {
    rest: &'a str,
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.find(['\n', '\r']).unwrap_or(self.rest.len());
        let (line, after) = self.rest.split_at(end);
        let gap = if after.starts_with("\r\n") { 2 } else { after.len().min(1) };
        self.rest = &after[gap..];
        Some(line)
    }
}

/// A part of a file in quotes, cut if it is long.
pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(LONGEST_QUOTE) {
        Some((end, _)) => format!("{:?}", format!("{}…", &text[..end])),
        None => format!("{text:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_lf_cr_lf_or_cr() {
        let found: Vec<_> = lines("a\nb\r\nc\rd\n\ne\r\rf").collect();
        assert_eq!(found, ["a", "b", "c", "d", "", "e", "", "f"]);
        assert_eq!(lines("").count(), 0);
        assert_eq!(lines("a\n").count(), 1);
    }

    #[test]
    fn long_quotes_are_cut() {
        assert_eq!(quoted("1 x"), "\"1 x\"");
        assert_eq!(quoted(&"é".repeat(100)), format!("\"{}…\"", "é".repeat(40)));
    }
}
