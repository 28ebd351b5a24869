// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Texts of JSON: tokens and places.

use std::borrow::Cow;
use std::ops::Range;

use serde::de::IgnoredAny;

use super::grammar::{self, Fault, Style};
use crate::problem::{SceneError, SceneProblem};

/// A place in a text, in characters from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Position {
    pub(crate) line: usize,
    pub(crate) column: usize,
}

impl Position {
    fn of_byte(text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            line: before.bytes().filter(|b| *b == b'\n').count() + 1,
            column: before.get(line_start..).map_or(0, |line| line.chars().count()) + 1,
        }
    }
}

/// Where text was replaced by text of another length.
#[derive(Clone, Copy, Debug)]
struct Edit {
    /// The first byte that was replaced, after all edits before this one.
    at: usize,
    removed: usize,
    inserted: usize,
}

/// A text as it is read: what is wrong with its grammar is mended, so that the rest is checked too.
pub(crate) struct Source<'a> {
    original: &'a str,
    mended: Cow<'a, str>,
    /// In the order of the text.
    edits: Vec<Edit>,
    /// Bytes of the file at which a value is a guess.
    guesses: Vec<usize>,
    problems: Vec<SceneProblem>,
    /// `false` if the text cannot be mended.
    is_whole: bool,
}

impl<'a> Source<'a> {
    /// Judges the grammar of a text.
    pub(crate) fn of(text: &'a str) -> Self {
        let original = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut source = Self {
            original,
            mended: Cow::Borrowed(original),
            edits: Vec::new(),
            guesses: Vec::new(),
            problems: Vec::new(),
            is_whole: true,
        };
        if let Err(error) = serde_json::from_str::<IgnoredAny>(original) {
            let (faults, is_whole) = grammar::faults(original);
            source.is_whole = is_whole;
            source.mend(faults);
            if source.problems.is_empty() {
                source.add_unknown(&error);
            }
            source.is_whole &= serde_json::from_str::<IgnoredAny>(&source.mended).is_ok();
        }
        source
    }

    /// The text to be read, or what is wrong with it if it cannot be.
    pub(super) fn readable(&self) -> Result<&str, SceneError> {
        if self.is_whole { Ok(&self.mended) } else { Err(self.error([])) }
    }

    /// The error of the grammar and of what was found in the mended text.
    pub(super) fn error(&self, others: impl IntoIterator<Item = SceneProblem>) -> SceneError {
        let mut problems = self.problems.clone();
        problems.extend(others);
        problems.sort_by_key(|problem| (problem.line, problem.column));
        let error = SceneError::of(problems);
        if self.is_whole { error } else { error.and_maybe_more() }
    }

    /// `true` if the grammar is good.
    pub(super) fn is_good(&self) -> bool {
        self.problems.is_empty()
    }

    /// Where a byte of the mended text is in the file.
    pub(super) fn position(&self, byte: usize) -> Position {
        Position::of_byte(self.original, self.in_file(byte))
    }

    /// `true` if the value in these bytes of the mended text is a guess.
    pub(super) fn is_guessed(&self, bytes: Range<usize>) -> bool {
        let bytes = self.in_file(bytes.start)..=self.in_file(bytes.end);
        self.guesses.iter().any(|guess| bytes.contains(guess))
    }

    /// The byte of the file that a byte of the mended text comes from.
    fn in_file(&self, byte: usize) -> usize {
        self.edits.iter().rev().fold(byte, |byte, edit| {
            if byte >= edit.at + edit.inserted {
                byte + edit.removed - edit.inserted
            } else {
                byte.min(edit.at)
            }
        })
    }

    /// Tells of the faults and mends them.
    fn mend(&mut self, faults: Vec<Fault>) {
        let mut mends = Vec::new();
        let mut styles: Vec<(Style, usize, usize)> = Vec::new();
        for fault in faults {
            mends.extend(fault.mend);
            self.guesses.extend(fault.guess);
            let told = styles.iter_mut().find(|(style, ..)| Some(*style) == fault.style);
            if let Some((.., count)) = told {
                *count += 1;
                continue;
            }
            styles.extend(fault.style.map(|style| (style, self.problems.len(), 0)));
            self.add(fault.byte, fault.message);
        }
        for (_, place, count) in styles.into_iter().filter(|(.., count)| *count > 0) {
            let times = if count == 1 { "once" } else { &format!("{count} times") };
            self.problems[place].problem.push_str(&format!("; {times} more below"));
        }
        mends.sort_by_key(|(bytes, _)| bytes.start);
        self.replace(mends);
    }

    /// Makes the mended text by replacing bytes of the file, in their order.
    fn replace(&mut self, mends: Vec<(Range<usize>, String)>) {
        let mut mended = String::with_capacity(self.original.len());
        let mut done = 0;
        for (bytes, text) in mends {
            mended.push_str(self.original.get(done..bytes.start).unwrap_or_default());
            let edit = Edit { at: mended.len(), removed: bytes.len(), inserted: text.len() };
            self.edits.push(edit);
            mended.push_str(&text);
            done = bytes.end;
        }
        mended.push_str(self.original.get(done..).unwrap_or_default());
        self.mended = Cow::Owned(mended);
    }

    /// Tells of what is wrong at a byte of the file.
    fn add(&mut self, byte: usize, message: String) {
        let Position { line, column } = Position::of_byte(self.original, byte);
        let problem = format!("not JSON: {message}");
        let excerpt = excerpt(self.original, byte);
        let problem = SceneProblem { line, column, problem, excerpt, ..Default::default() };
        self.problems.push(problem);
    }

    /// Tells of what only serde finds wrong.
    fn add_unknown(&mut self, error: &serde_json::Error) {
        let full = error.to_string();
        let end = full.rfind(" at line ").unwrap_or(full.len());
        let lines = self.original.split_inclusive('\n').take(error.line().saturating_sub(1));
        let line_start: usize = lines.map(str::len).sum();
        let mut byte = (line_start + error.column().saturating_sub(1)).min(self.original.len());
        while !self.original.is_char_boundary(byte) {
            byte -= 1;
        }
        self.add(byte, full.get(..end).unwrap_or(&full).to_owned());
    }
}

/// How many characters of a line are shown on each side of a place.
const SHOWN: usize = 60;

/// The line of a byte, or the part of it around the byte, and below it a caret at the byte; empty
/// for an empty line.
fn excerpt(text: &str, byte: usize) -> String {
    let (before, after) = text.split_at_checked(byte).unwrap_or((text, ""));
    let before = before.rsplit('\n').next().unwrap_or_default();
    let after = after.split('\n').next().unwrap_or_default().trim_end_matches('\r');
    let skipped = before.chars().count().saturating_sub(SHOWN);
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    let mut shown: String = if skipped > 0 { "…".into() } else { String::new() };
    shown.extend(before.chars().skip(skipped).map(plain));
    let caret = shown.chars().count();
    shown.extend(after.chars().take(SHOWN).map(plain));
    if after.chars().nth(SHOWN).is_some() {
        shown.push('…');
    }
    if shown.trim().is_empty() {
        return String::new();
    }
    format!("  {}\n  {}^", shown.trim_end(), " ".repeat(caret))
}

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
    fn places_in_a_mended_text_are_those_of_the_file() {
        let text = "{ a: .5, // one\n  'b': +2, \"c\": [3, ] }";
        let source = Source::of(text);
        let mended = source.readable().unwrap();
        assert_eq!(mended, "{ \"a\": 0.5,  \n  \"b\": 2, \"c\": [3 ] }");
        for (mended_text, original) in [("0.5", ".5"), ("\"c\"", "\"c\""), ("3", "3,")] {
            let byte = mended.find(mended_text).unwrap();
            let expected = Position::of_byte(text, text.find(original).unwrap());
            assert_eq!(source.position(byte), expected, "{mended_text}");
        }
    }

    #[test]
    fn excerpts_of_long_lines_are_short() {
        let line = format!("{}x{}", "a".repeat(1000), "b".repeat(1000));
        let shown = excerpt(&line, 1000);
        let (shown, caret) = shown.split_once('\n').unwrap();
        assert_eq!(shown.chars().count(), 2 + 1 + SHOWN + SHOWN + 1);
        assert_eq!(shown.chars().nth(caret.chars().count() - 1), Some('x'));
        assert_eq!(excerpt("a\n\tbc\r\nd", 3), "   bc\n   ^");
    }
}

#[cfg(test)]
mod tokens_tests {
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
