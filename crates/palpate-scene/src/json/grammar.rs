// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is wrong with a text that is no JSON, in the words of who wrote it.
//!
//! What can mean one thing only is mended, so that the rest of the text is read too; at anything
//! else the search ends.

use std::ops::Range;

use super::source::{Kind, Token, tokens};
use super::word;
use crate::names::shortened;
use crate::problem::MOST;

/// Something that is no JSON.
#[derive(Debug)]
pub(super) struct Fault {
    /// Where.
    pub(super) byte: usize,
    pub(super) message: String,
    /// What is read instead of some bytes; `None` if nothing can be.
    pub(super) mend: Option<(Range<usize>, String)>,
    /// The byte of a value that is a guess.
    pub(super) guess: Option<usize>,
    /// A way of writing that a text has in many places; it is told of once.
    pub(super) style: Option<Style>,
}

/// A way of writing that other formats have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    Comment,
    Quotes,
    Key,
}

/// What is wrong with a text, in the order of the text; `false` if what follows the last fault was
/// not read.
pub(super) fn faults(text: &str) -> (Vec<Fault>, bool) {
    let mut walk = Walk {
        text,
        open: Vec::new(),
        wanted: Wanted::Value,
        faults: Vec::new(),
        before: None,
    };
    let tokens = tokens(text);
    let mut rest = tokens.as_slice();
    while let [token, after @ ..] = rest {
        if walk.faults.iter().filter(|fault| fault.style.is_none()).count() > MOST {
            return (walk.faults, false);
        }
        match walk.step(*token, after) {
            Some(taken) => rest = after.get(taken..).unwrap_or_default(),
            None => return (walk.faults, false),
        }
    }
    let is_whole = walk.end().is_some();
    (walk.faults, is_whole)
}

/// What may come next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    Value,
    ValueOrEnd,
    Key,
    KeyOrEnd,
    Colon,
    CommaOrEnd,
    Nothing,
}

/// A walk over the tokens of a text.
struct Walk<'a> {
    text: &'a str,
    /// The brackets that are open.
    open: Vec<Token<'a>>,
    wanted: Wanted,
    faults: Vec<Fault>,
    /// The last token that counts.
    before: Option<Token<'a>>,
}

impl<'a> Walk<'a> {
    /// Takes a token and returns how many of those after it are taken too; `None` if the search
    /// ends.
    fn step(&mut self, token: Token<'a>, after: &[Token<'a>]) -> Option<usize> {
        match token.kind {
            Kind::Comment => {
                let message =
                    "a comment; JSON has none, but every object may have a `description`";
                self.mend_style(Style::Comment, token, message.into(), " ".into());
                return Some(0);
            }
            Kind::Blank => {
                let code = token.text.escape_unicode();
                let message = format!("white space that JSON does not have, {code}");
                self.mend(token.start, message, (token.bytes(), " ".into()));
                return Some(0);
            }
            Kind::OpenText => {
                let message = if token.end() == self.text.len() {
                    "the file ends in the middle of the text that begins here"
                } else {
                    "the text that begins here has no closing quote on its line"
                };
                return self.stop(token.start, message);
            }
            _ => {}
        }
        let taken = match token.kind {
            Kind::Mark(mark) => self.mark(token, mark).map(|()| 0),
            _ if self.is_unit(token) => Some(self.unit(token)),
            _ if self.is_at_key() => self.key(token, after).map(|()| 0),
            _ => self.value(token, after),
        };
        self.before = Some(token);
        taken
    }

    /// Takes a bracket, comma or colon.
    fn mark(&mut self, token: Token<'a>, mark: char) -> Option<()> {
        match mark {
            '{' | '[' => self.open(token, mark),
            '}' | ']' => self.close(token, mark),
            ',' | ';' => self.comma(token),
            _ => self.colon(token),
        }
    }

    fn open(&mut self, token: Token<'a>, mark: char) -> Option<()> {
        if self.is_at_key() {
            return self.stop(
                token.start,
                "a key and a colon are missing before this: in { } each value has a key",
            );
        }
        self.begin_value(token)?;
        self.open.push(token);
        self.wanted = if mark == '{' { Wanted::KeyOrEnd } else { Wanted::ValueOrEnd };
        Some(())
    }

    fn close(&mut self, token: Token<'a>, mark: char) -> Option<()> {
        let Some(open) = self.open.last().copied() else {
            let message = format!("`{mark}` closes nothing; there is one too many");
            self.mend(token.start, message, (token.bytes(), String::new()));
            return Some(());
        };
        match self.wanted {
            Wanted::Colon => {
                return self.stop(
                    token.start,
                    "the key before this has no `:` and no value; a list stands in [ ]",
                );
            }
            Wanted::Value | Wanted::Key => {
                let Some(comma) =
                    self.before.filter(|before| before.text != ":" && before.text != "=")
                else {
                    return self.stop(token.start, "a value is missing before this");
                };
                let message = format!("a comma before `{mark}`; nothing follows it");
                self.mend(comma.start, message, (comma.bytes(), String::new()));
            }
            _ => {}
        }
        self.open.pop();
        self.wanted = if self.open.is_empty() { Wanted::Nothing } else { Wanted::CommaOrEnd };
        let wanted = if open.text == "{" { '}' } else { ']' };
        if wanted == mark {
            return Some(());
        }
        let line = self.line(open.start);
        if self.excess(mark) > 0 {
            let message =
                format!("`{mark}` for the `{}` of line {line}; write `{wanted}`", open.text);
            self.mend(token.start, message, (token.bytes(), wanted.into()));
            return Some(());
        }
        let message = format!(
            "`{wanted}` is missing before this, for the `{}` of line {line}",
            open.text
        );
        self.mend(token.start, message, (token.start..token.start, wanted.into()));
        self.close(token, mark)
    }

    fn comma(&mut self, token: Token<'a>) -> Option<()> {
        match self.wanted {
            Wanted::CommaOrEnd => {
                if token.text != "," {
                    let message = format!("`{}` between values; write `,`", token.text);
                    self.mend(token.start, message, (token.bytes(), ",".into()));
                }
                self.wanted = if self.is_in_object() { Wanted::Key } else { Wanted::Value };
                Some(())
            }
            Wanted::Colon => self.stop(
                token.start,
                "the key before this has no `:` and no value; a list stands in [ ]",
            ),
            Wanted::Nothing => self.after_end(token),
            _ if self.before.is_some_and(|before| matches!(before.text, ":" | "=")) => {
                self.stop(token.start, "a value is missing before this")
            }
            _ => {
                self.mend(
                    token.start,
                    "a comma too many".into(),
                    (token.bytes(), String::new()),
                );
                Some(())
            }
        }
    }

    fn colon(&mut self, token: Token<'a>) -> Option<()> {
        match self.wanted {
            Wanted::Colon => {
                if token.text != ":" {
                    let message = format!("`{}` after a key; write `:`", token.text);
                    self.mend(token.start, message, (token.bytes(), ":".into()));
                }
                self.wanted = Wanted::Value;
                Some(())
            }
            Wanted::CommaOrEnd if !self.is_in_object() => {
                let line = self.open.last().map_or(1, |open| self.line(open.start));
                let message = format!(
                    "a key in a list; `]` is missing before it, for the `[` of line {line}"
                );
                self.stop(token.start, &message)
            }
            Wanted::Nothing => self.after_end(token),
            _ => self.stop(token.start, &format!("`{}` without a key before it", token.text)),
        }
    }

    /// Passes over a word behind a number, and returns how many tokens more are taken: none.
    fn unit(&mut self, token: Token<'a>) -> usize {
        let word = shortened(token.text);
        let message = format!(
            "`{word}` after a number; numbers have no units here: lengths are in metres"
        );
        self.mend(token.start, message, (token.bytes(), String::new()));
        if let Some(number) = self.before {
            self.guess(number.start);
        }
        0
    }

    /// Takes a key.
    fn key(&mut self, token: Token<'a>, after: &[Token<'a>]) -> Option<()> {
        let next = after.iter().find(|next| !matches!(next.kind, Kind::Comment | Kind::Blank));
        let has_colon = next.is_some_and(|next| matches!(next.text, ":" | "="));
        if self.wanted == Wanted::CommaOrEnd {
            self.comma_is_missing();
        }
        match token.kind {
            Kind::Word if !has_colon => {
                let message = format!(
                    "`{}` is no key: in {{ }} each value has a key in double quotes and a `:`",
                    shortened(token.text)
                );
                return self.stop(token.start, &message);
            }
            Kind::Word => {
                let message =
                    format!("the key `{}` stands without double quotes", shortened(token.text));
                self.mend_style(Style::Key, token, message, quoted(token.text));
            }
            _ => self.text(token),
        }
        self.wanted = Wanted::Colon;
        Some(())
    }

    /// Takes a text, a number or a word as a value.
    fn value(&mut self, token: Token<'a>, after: &[Token<'a>]) -> Option<usize> {
        if self.open.is_empty()
            && self.wanted == Wanted::Value
            && token.kind == Kind::Word
            && !word::is_json(token.text)
        {
            return self.stop(token.start, "a scene begins with `{`");
        }
        self.begin_value(token)?;
        self.wanted = if self.open.is_empty() { Wanted::Nothing } else { Wanted::CommaOrEnd };
        if token.kind != Kind::Word {
            self.text(token);
            return Some(0);
        }
        if token.text.starts_with('(') {
            return self.stop(token.start, "a list stands in [ ], not in ( )");
        }
        if self.is_in_object()
            && let Some(comma) = decimal_comma(token, after)
        {
            let decimals = after.get(1).map_or("", |decimals| decimals.text);
            let message = format!("a decimal comma; write {}.{decimals}", token.text);
            self.mend(comma.start, message, (comma.bytes(), ".".into()));
            return Some(2);
        }
        match word::meant(token.text) {
            None => {}
            Some(meant) => {
                self.mend(token.start, meant.message, (token.bytes(), meant.value));
                if meant.is_guess {
                    self.guess(token.start);
                }
            }
        }
        Some(0)
    }

    /// Checks that a value may begin, after a comma or colon that may be missing.
    fn begin_value(&mut self, token: Token<'a>) -> Option<()> {
        let end = self.before.map_or(0, |before| before.end());
        match self.wanted {
            Wanted::Value | Wanted::ValueOrEnd => Some(()),
            Wanted::Nothing => self.after_end(token),
            Wanted::Colon => {
                let message = "a colon is missing after the key";
                self.mend(end, message.into(), (end..end, ":".into()));
                Some(())
            }
            _ => {
                self.comma_is_missing();
                Some(())
            }
        }
    }

    fn comma_is_missing(&mut self) {
        let end = self.before.map_or(0, |before| before.end());
        self.mend(end, "a comma is missing here".into(), (end..end, ",".into()));
    }

    /// Mends the quotes, escapes and control characters of a text.
    fn text(&mut self, token: Token<'a>) {
        if token.kind == Kind::OtherText {
            let mut inner = token.text.chars();
            inner.next();
            inner.next_back();
            let message = "other quotes than double ones; JSON has `\"` alone";
            let text = quoted(&inner.as_str().replace("\\'", "'"));
            self.mend_style(Style::Quotes, token, message.into(), text);
        } else if !word::is_json(token.text) {
            let inner = token.text.get(1..token.text.len() - 1).unwrap_or_default();
            let (message, text) = if inner.contains(char::is_control) {
                let message = "a control character in a text; a tab is written \\t";
                (message, format!("\"{}\"", inner.replace(char::is_control, " ")))
            } else {
                (
                    "a backslash in a text that begins no escape; it is written \\\\",
                    quoted(inner),
                )
            };
            self.mend(token.start, message.into(), (token.bytes(), text));
        }
    }

    /// `true` for a word that follows a number on its line.
    fn is_unit(&self, token: Token<'_>) -> bool {
        let is_number =
            |before: &Token<'_>| before.text.ends_with(|c: char| c.is_ascii_digit());
        let is_beside = |before: &Token<'_>| {
            let between = self.text.get(before.end()..token.start).unwrap_or_default();
            !between.contains('\n')
        };
        self.wanted == Wanted::CommaOrEnd
            && token.kind == Kind::Word
            && token.text.starts_with(|c: char| c.is_alphabetic() || "°%µ".contains(c))
            && self
                .before
                .is_some_and(|b| b.kind == Kind::Word && is_number(&b) && is_beside(&b))
    }

    /// Ends the search at the end of the text; `None` if it is not whole.
    fn end(&mut self) -> Option<()> {
        let end = self.before.map_or(0, |before| before.end());
        let Some(open) = self.open.last().copied() else {
            return match self.wanted {
                Wanted::Nothing => Some(()),
                _ => self.stop(end, "the file is empty"),
            };
        };
        let closing = if open.text == "{" { "}" } else { "]" };
        let line = self.line(open.start);
        let others = match self.open.len() - 1 {
            0 => String::new(),
            others => format!(", and of {others} around it"),
        };
        let message = format!(
            "the file ends here, but `{closing}` is missing for the `{}` of line {line}{others}",
            open.text
        );
        self.stop(end, &message)
    }

    fn after_end(&mut self, token: Token<'_>) -> Option<()> {
        let message = if token.text.starts_with('\0') {
            "bytes of value 0 follow the end of the scene: the file is damaged; save it anew"
        } else {
            "there is more after the end of the scene; is there a closing bracket too many before it?"
        };
        self.stop(token.start, message)
    }

    /// `true` if what is not a mark is a key, perhaps after a comma that is missing.
    fn is_at_key(&self) -> bool {
        match self.wanted {
            Wanted::Key | Wanted::KeyOrEnd => true,
            wanted => wanted == Wanted::CommaOrEnd && self.is_in_object(),
        }
    }

    fn is_in_object(&self) -> bool {
        self.open.last().is_some_and(|open| open.text == "{")
    }

    /// The line of a byte, from 1.
    fn line(&self, byte: usize) -> usize {
        1 + self.text.bytes().take(byte).filter(|byte| *byte == b'\n').count()
    }

    /// How many more of a closing bracket a text has than of its opening one, outside of texts.
    fn excess(&self, closing: char) -> isize {
        let opening = if closing == '}' { '{' } else { '[' };
        let count =
            |mark| tokens(self.text).iter().filter(|t| t.kind == Kind::Mark(mark)).count();
        count(closing).cast_signed() - count(opening).cast_signed()
    }

    /// Tells of a fault and ends the search.
    fn stop<T>(&mut self, byte: usize, message: &str) -> Option<T> {
        let message = message.to_owned();
        self.faults.push(Fault { byte, message, mend: None, guess: None, style: None });
        None
    }

    /// Tells of a fault, and what to read instead of its bytes.
    fn mend(&mut self, byte: usize, message: String, mend: (Range<usize>, String)) {
        let mend = Some(mend);
        self.faults.push(Fault { byte, message, mend, guess: None, style: None });
    }

    /// As [`mend`](Self::mend) for a whole token, written as other formats have it.
    fn mend_style(&mut self, style: Style, token: Token<'_>, message: String, text: String) {
        self.mend(token.start, message, (token.bytes(), text));
        if let Some(fault) = self.faults.last_mut() {
            fault.style = Some(style);
        }
    }

    /// Says that the value at a byte is a guess of the last fault.
    fn guess(&mut self, byte: usize) {
        if let Some(fault) = self.faults.last_mut() {
            fault.guess = Some(byte);
        }
    }
}

/// A text in double quotes.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// The comma between two runs of digits that touch it, of which the second is no key.
fn decimal_comma<'a>(token: Token<'_>, after: &[Token<'a>]) -> Option<Token<'a>> {
    let [comma, decimals, next, ..] = after else { return None };
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let touches = comma.start == token.end() && decimals.start == comma.end();
    let is_number =
        is_digits(token.text.trim_start_matches(['-', '+'])) && is_digits(decimals.text);
    (comma.text == "," && touches && is_number && next.text != ":").then_some(*comma)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text that is read instead, with a `|` before the place of each fault, and the messages.
    fn marked(text: &str) -> (String, Vec<String>, bool) {
        let (mut faults, is_whole) = faults(text);
        faults.sort_by_key(|fault| fault.byte);
        let mut marked = text.to_owned();
        for fault in faults.iter().rev() {
            marked.insert(fault.byte, '|');
        }
        (marked, faults.into_iter().map(|fault| fault.message).collect(), is_whole)
    }

    #[test]
    fn faults_that_mean_one_thing_are_mended() {
        for (expected, message) in [
            (
                "{ |// radius\n \"a\": 1 }",
                "a comment; JSON has none, but every object may have a `description`",
            ),
            ("{ |'a': 1 }", "other quotes than double ones; JSON has `\"` alone"),
            ("{ |“a”: 1 }", "other quotes than double ones; JSON has `\"` alone"),
            ("{ \"a\": [1|, ] }", "a comma before `]`; nothing follows it"),
            ("[1, |, 3]", "a comma too many"),
            ("{ \"a\": 0|,5, \"b\": 1 }", "a decimal comma; write 0.5"),
            ("{ \"a\": 1| \"b\": 1 }", "a comma is missing here"),
            ("[1| 2]", "a comma is missing here"),
            ("{ |a: 1 }", "the key `a` stands without double quotes"),
            ("{ \"a\" |= 1 }", "`=` after a key; write `:`"),
            ("{ \"a\"| 1 }", "a colon is missing after the key"),
            ("{ \"a\": 1|; \"b\": 1 }", "`;` between values; write `,`"),
            ("{ \"a\": |NaN }", "`NaN` is no number that JSON, or a scene, can have"),
            ("{ \"a\": |0x10 }", "the number `0x10` is written 16"),
            ("{ \"a\": |+1 }", "the number `+1` is written 1"),
            ("{ \"a\": |True }", "`True` is written true"),
            ("{ \"a\": |5mm }", "`5mm` has a unit; lengths are in metres: write 0.005"),
            (
                "{ \"a\": 5 |mm }",
                "`mm` after a number; numbers have no units here: lengths are in metres",
            ),
            ("{ \"a\": |ball }", "the text `ball` stands without double quotes"),
            ("{ \"a\": [1, 2|} }", "`}` for the `[` of line 1; write `]`"),
            ("{ \"a\": [1, 2 |}", "`]` is missing before this, for the `[` of line 1"),
            ("{ \"a\": 1 } |}", "`}` closes nothing; there is one too many"),
            ("{ \"a\": |\"x\ty\" }", "a control character in a text; a tab is written \\t"),
            (
                "{ \"a\": |\"C:\\data\" }",
                "a backslash in a text that begins no escape; it is written \\\\",
            ),
            ("{ \"a\":|\u{a0}1 }", "white space that JSON does not have, \\u{a0}"),
        ] {
            let (marked, messages, is_whole) = marked(&expected.replace('|', ""));
            assert_eq!(marked, expected, "{messages:?}");
            assert_eq!(messages, [message]);
            assert!(is_whole, "{expected}");
        }
    }

    #[test]
    fn other_faults_end_the_search() {
        for (expected, message) in [
            (
                "{ \"a\": [1, \"b\"|: 2 ] }",
                "a key in a list; `]` is missing before it, for the `[` of line 1",
            ),
            (
                "{ |1, 2, 3 }",
                "`1` is no key: in { } each value has a key in double quotes and a `:`",
            ),
            ("{ \"a\": |(1, 2) }", "a list stands in [ ], not in ( )"),
            ("{ \"a\": |}", "a value is missing before this"),
            ("{ \"a\"|}", "the key before this has no `:` and no value; a list stands in [ ]"),
            ("{ \"a\": |\"x\n}", "the text that begins here has no closing quote on its line"),
            (
                "{} |{}",
                "there is more after the end of the scene; is there a closing bracket too many before it?",
            ),
            (
                "{} |\0\0",
                "bytes of value 0 follow the end of the scene: the file is damaged; save it anew",
            ),
            (
                "{\n\"a\": [1|",
                "the file ends here, but `]` is missing for the `[` of line 2, and of 1 around it",
            ),
            ("{ \"a\": |\"x", "the file ends in the middle of the text that begins here"),
            ("|", "the file is empty"),
            ("|solid nut", "a scene begins with `{`"),
        ] {
            let (marked, messages, is_whole) = marked(&expected.replace('|', ""));
            assert_eq!(marked, expected, "{messages:?}");
            assert_eq!(messages, [message]);
            assert!(!is_whole, "{expected}");
        }
    }

    #[test]
    fn several_faults_are_found_in_one_go() {
        let text = "{ a: .5, // one\n  'b': [+1, 2,], \"c\": nan\n \"d\": 0,25 }";
        let (marked, messages, is_whole) = marked(text);
        let expected = "{ |a: |.5, |// one\n  |'b': [|+1, 2|,], \"c\": |nan|\n \"d\": 0|,25 }";
        assert_eq!(marked, expected);
        assert_eq!(messages.len(), 9);
        assert!(is_whole);
    }
}
