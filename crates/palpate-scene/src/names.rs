// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Names in messages: short, and the near ones first.

/// The longest text from a file that a message repeats, in characters.
const LONGEST_QUOTE: usize = 60;

/// The most names that a message lists.
const LONGEST_LIST: usize = 16;

/// The most names that a message proposes.
const MOST_GUESSES: usize = 8;

/// The beginning of `text`, fit for a message: 60 characters at most, on one line.
///
/// ```
/// assert_eq!(palpate_scene::shortened("two\nlines"), r"two\nlines");
/// assert_eq!(palpate_scene::shortened(&"9".repeat(1000)).chars().count(), 61);
/// ```
#[must_use]
pub fn shortened(text: &str) -> String {
    let mut shown = String::new();
    for c in text.chars().take(LONGEST_QUOTE) {
        if c.is_control() { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    if text.chars().nth(LONGEST_QUOTE).is_some() {
        shown.push('…');
    }
    shown
}

/// The message of a name that there is none of: those of `known` that it may be a slip of, or the
/// list of them.
///
/// ```
/// use palpate_scene::unknown_name;
///
/// let known = ["peg", "block"];
/// assert_eq!(unknown_name("body", "pag", &known), "unknown body `pag`, did you mean `peg`?");
/// assert_eq!(unknown_name("body", "it", &known), "unknown body `it`; known are `peg` and `block`");
/// ```
#[must_use]
pub fn unknown(what: &str, found: &str, known: &[&str]) -> String {
    let shown = shortened(found);
    match near(found, known)[..] {
        [] if known.is_empty() => format!("unknown {what} `{shown}`; there are none here"),
        [] => format!("unknown {what} `{shown}`; known are {}", listed(known, "and")),
        ref near => format!("unknown {what} `{shown}`, {}", did_you_mean(near)),
    }
}

/// "did you mean `a` or `b`?", of at most eight names.
pub(crate) fn did_you_mean(near: &[&str]) -> String {
    let near = near.get(..MOST_GUESSES).unwrap_or(near);
    format!("did you mean {}?", listed(near, "or"))
}

/// The names of `known` that `found` may be a slip of, the nearest first: a third of the letters may
/// be wrong, and two that are swapped count as one.
///
/// ```
/// use palpate_scene::near_names;
///
/// assert_eq!(near_names("raduis", &["height", "radius"]), ["radius"]);
/// ```
#[must_use]
pub fn near<'a>(found: &str, known: &[&'a str]) -> Vec<&'a str> {
    let found = shortened(found);
    let letters = found.chars().count();
    // A third of the letters may be wrong: more, and the guess is none.
    let distance = |candidate: &str| {
        let allowed = candidate.chars().take(2 * LONGEST_QUOTE).count() / 3;
        let is_near = candidate.len().abs_diff(letters) <= LONGEST_QUOTE;
        let distance = is_near.then(|| strsim::osa_distance(&found, candidate));
        distance.filter(|distance| *distance <= allowed)
    };
    let mut near: Vec<_> =
        known.iter().filter_map(|name| Some((distance(name)?, *name))).collect();
    near.sort_by_key(|(distance, _)| *distance);
    near.into_iter().map(|(_, name)| name).collect()
}

/// The name of `known` that `found` is most likely a slip of.
pub(crate) fn nearest<'a>(found: &str, known: &[&'a str]) -> Option<&'a str> {
    near(found, known).first().copied()
}

/// "`a`, `b` and `c`", with another word before the last.
fn listed(names: &[&str], word: &str) -> String {
    let shown = names.iter().take(LONGEST_LIST);
    let mut quoted: Vec<_> = shown.map(|name| format!("`{}`", shortened(name))).collect();
    if names.len() > LONGEST_LIST {
        quoted.push(format!("{} more", names.len() - LONGEST_LIST));
    }
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} {word} {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stays_on_its_line() {
        assert_eq!(shortened("a\n\u{1b}é"), "a\\n\\u{1b}é");
        assert_eq!(shortened(&"é".repeat(61)), format!("{}…", "é".repeat(60)));
    }

    #[test]
    fn far_names_are_listed_near_ones_proposed() {
        let known = ["radius", "height"];
        assert_eq!(
            unknown("key", "raduis", &known),
            "unknown key `raduis`, did you mean `radius`?"
        );
        assert_eq!(
            unknown("key", "colour", &known),
            "unknown key `colour`; known are `radius` and `height`"
        );
    }
}
