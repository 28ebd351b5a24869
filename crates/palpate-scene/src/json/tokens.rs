// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tokens of a text that may be no JSON.

use std::ops::Range;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One of `{ } [ ] : ,`, or of `= ;`, which are written for others.
    Mark(char),
    /// A text in double quotes.
    Text,
    /// A text in other quotes.
    OtherText,
    /// A text that has no end on its line.
    OpenText,
    /// A comment.
    Comment,
    /// White space that JSON does not have.
    Blank,
    /// Anything else up to white space or a mark: a number, or a word.
    Word,
}

/// A part of a text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'a> {
    pub(super) kind: Kind,
    pub(super) start: usize,
    pub(super) text: &'a str,
}

impl Token<'_> {
    pub(super) fn end(&self) -> usize {
        self.start + self.text.len()
    }

    pub(super) fn bytes(&self) -> Range<usize> {
        self.start..self.end()
    }
}

/// The tokens of `text`; white space that JSON has is left out.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut start = 0;
    while let Some(rest) = text.get(start..).filter(|rest| !rest.is_empty()) {
        let (kind, length) = token(rest);
        if let Some(kind) = kind {
            tokens.push(Token { kind, start, text: rest.get(..length).unwrap_or(rest) });
        }
        start += length;
    }
    tokens
}

/// The kind and the length of the token that begins `rest`; no kind for white space.
fn token(rest: &str) -> (Option<Kind>, usize) {
    let first = rest.chars().next().unwrap_or_default();
    let length = first.len_utf8();
    match first {
        ' ' | '\t' | '\n' | '\r' => (None, length),
        '{' | '}' | '[' | ']' | ':' | ',' | '=' | ';' => (Some(Kind::Mark(first)), length),
        '"' => quoted(rest, &['"'], Kind::Text),
        '\'' | '`' => quoted(rest, &[first], Kind::OtherText),
        '“' | '”' | '„' => quoted(rest, &['“', '”'], Kind::OtherText),
        '‘' | '’' => quoted(rest, &['‘', '’'], Kind::OtherText),
        '#' => (Some(Kind::Comment), line(rest)),
        '/' if rest.starts_with("//") => (Some(Kind::Comment), line(rest)),
        '/' if rest.starts_with("/*") => {
            let end = rest.find("*/").map_or(rest.len(), |end| end + 2);
            (Some(Kind::Comment), end)
        }
        _ if is_blank(first) => (Some(Kind::Blank), length),
        _ => (Some(Kind::Word), rest.find(ends_word).unwrap_or(rest.len()).max(length)),
    }
}

/// White space, and characters without width, that JSON does not have.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || matches!(c, '\u{200b}'..='\u{200d}' | '\u{2060}' | '\u{feff}')
}

fn ends_word(c: char) -> bool {
    is_blank(c) || "{}[]:,=;\"'`“”„‘’#/".contains(c)
}

/// The length of the first line.
fn line(rest: &str) -> usize {
    rest.find(['\n', '\r']).unwrap_or(rest.len())
}

/// A text between quotes, of which the first is the opening one.
fn quoted(rest: &str, closing: &[char], kind: Kind) -> (Option<Kind>, usize) {
    let mut characters = rest.char_indices().skip(1);
    while let Some((at, c)) = characters.next() {
        match c {
            '\\' => drop(characters.next()),
            '\n' | '\r' => return (Some(Kind::OpenText), at),
            c if closing.contains(&c) => return (Some(kind), at + c.len_utf8()),
            _ => {}
        }
    }
    (Some(Kind::OpenText), rest.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_is_tokens() {
        let text = "{ a: 'b\\'', /* c */ \"d\\\"\": [.5,1e-3 ] # e\n “f”\u{a0}\"g\n";
        let found: Vec<_> = tokens(text).iter().map(|token| (token.kind, token.text)).collect();
        let mark = Kind::Mark;
        assert_eq!(
            found,
            [
                (mark('{'), "{"),
                (Kind::Word, "a"),
                (mark(':'), ":"),
                (Kind::OtherText, "'b\\''"),
                (mark(','), ","),
                (Kind::Comment, "/* c */"),
                (Kind::Text, "\"d\\\"\""),
                (mark(':'), ":"),
                (mark('['), "["),
                (Kind::Word, ".5"),
                (mark(','), ","),
                (Kind::Word, "1e-3"),
                (mark(']'), "]"),
                (Kind::Comment, "# e"),
                (Kind::OtherText, "“f”"),
                (Kind::Blank, "\u{a0}"),
                (Kind::OpenText, "\"g"),
            ]
        );
    }
}
