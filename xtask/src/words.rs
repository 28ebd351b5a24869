// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rules on what sources and documents say: open ends have an issue, and no path leads into a
//! machine that the reader does not have.

use crate::command::Failure;
use crate::tree::{self, Text};

/// Words for an open end.
const OPEN_ENDS: [&str; 3] = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("XX", "X")];

/// Folders at the root of somebody's machine.
const ROOTS: [&str; 9] =
    ["home", "Users", "root", "tmp", "work", "mnt", "media", "srv", "private"];

/// Checks every source and every document.
pub(crate) fn check() -> Result<(), Failure> {
    let texts = tree::texts(&["rs", "md", "toml", ""])?;
    Failure::any(texts.iter().flat_map(problems).collect())
}

fn problems(text: &Text) -> Vec<String> {
    let place = |(i, problem)| format!("{}, line {}: {problem}", text.path.display(), i + 1);
    let lines = text.text.lines().enumerate();
    let open = lines.clone().filter(|(_, line)| is_open_end(line));
    let open = open.map(|(i, _)| place((i, "an open end without the number of an issue")));
    let paths = lines.filter(|(_, line)| names_a_machine(line));
    open.chain(paths.map(|(i, _)| place((i, "a path of somebody's machine")))).collect()
}

/// `true` if a word for an open end is not followed by the number of an issue, as `(#12)`.
fn is_open_end(line: &str) -> bool {
    OPEN_ENDS.iter().any(|word| {
        line.match_indices(word).any(|(at, _)| {
            let (before, after) = (&line[..at], &line[at + word.len()..]);
            let is_word = !before.ends_with(char::is_alphanumeric)
                && !after.starts_with(|c: char| c.is_alphanumeric() || c == '_');
            let number = after.trim_start_matches(['(', ' ']).strip_prefix('#');
            is_word
                && !number
                    .is_some_and(|number| number.starts_with(|c: char| c.is_ascii_digit()))
        })
    })
}

/// `true` if a line names a folder of a Unix home or a Windows drive.
fn names_a_machine(line: &str) -> bool {
    let starts = |at: usize| {
        let before = line[..at].chars().next_back();
        before.is_none_or(|c| c.is_whitespace() || "\"'`(<=,:".contains(c))
    };
    let unix = ROOTS.iter().any(|root| {
        let path = format!("/{root}/");
        line.match_indices(&path).any(|(at, _)| starts(at))
    });
    // A drive, and an escaped or plain backslash before a name.
    let drive = line.match_indices(":\\").any(|(at, _)| {
        let letter = at.checked_sub(1).filter(|at| line.as_bytes()[*at].is_ascii_uppercase());
        let after = line[at + 2..].trim_start_matches('\\');
        letter.is_some_and(starts) && after.starts_with(|c: char| c.is_ascii_uppercase())
    });
    unix || drive
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Vec<String> {
        problems(&Text { path: "a.rs".into(), text: text.to_owned() })
    }

    #[test]
    fn open_ends_need_an_issue() {
        for word in OPEN_ENDS {
            let bare = format!("let x = 1;\n// {word}: mend this\n");
            assert_eq!(of(&bare), ["a.rs, line 2: an open end without the number of an issue"]);
            assert_eq!(of(&format!("// {word}(#12): mend this\n")), [""; 0]);
            assert_eq!(of(&format!("// {word} #12: mend this\n")), [""; 0]);
            assert_eq!(of(&format!("const A{word}B: u8 = 1;\n")), [""; 0]);
        }
    }

    #[test]
    fn paths_of_a_machine_are_refused() {
        for root in ROOTS {
            for line in ["see /R/me/file", "\"/R/me\"", "[x](/R/me.md)", "`/R/x`"] {
                let line = line.replace('R', root);
                assert_eq!(of(&line), ["a.rs, line 1: a path of somebody's machine"], "{line}");
            }
        }
        for line in ["C~\\Users\\me", "\"D~\\\\Data\""] {
            let line = line.replace('~', ":");
            assert_eq!(of(&line).len(), 1, "{line}");
        }
        for good in ["/dev/null", "https://a.org/R/x", "Examples:\\n  x", "a/R/b", "E:\\n"] {
            let good = good.replace('R', "home");
            assert_eq!(of(&good), [""; 0], "{good}");
        }
    }
}
