// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An object that makes a shape: which key decides, and whether the others go with it.

use std::borrow::Cow;

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::advice;
use crate::catalogue;
use crate::json;
use crate::keys::{self, DESCRIPTION, OF};
use crate::names::unknown;
use crate::problem::Problem;
use crate::problems::Problems;
use crate::scene::Dimension;

/// An object that makes a shape, its keys checked and its values not.
#[derive(Clone, Debug)]
pub(super) struct Object<'a> {
    entries: &'a Map<String, Value>,
    /// The primitive or operator: of a translation with a rotation, the first of the two.
    pub(super) head: &'a str,
    /// Keys that unknown keys were taken for.
    meant: Vec<&'static str>,
}

impl<'a> Object<'a> {
    /// The object, if one key decides what it makes. What is wrong with its keys is added to
    /// `wrong`.
    pub(super) fn new(
        entries: &'a Map<String, Value>,
        dimension: Dimension,
        wrong: &mut Problems,
    ) -> Option<Self> {
        let meant = meant(entries, dimension, wrong);
        let head = wrong.kept(head(entries, wrong.is_failed()))?;
        wrong.kept(check_description(entries));
        let is_unary = keys::is_unary(head);
        let goes = |(key, lists): (&str, &[&str])| match key {
            OF => is_unary,
            _ => lists.contains(&head),
        };
        let others = keys::WITH_LISTS.map(|(key, _, lists, _)| (key, lists));
        for (key, lists) in others.into_iter().chain([(OF, &[][..])]) {
            if entries.contains_key(key) && !goes((key, lists)) {
                wrong.add(Problem::new(format!("key `{key}` does not go with `{head}`")));
            }
        }
        Some(Self { entries, head, meant })
    }

    /// `true` if the object has the key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// The value of a key.
    pub(super) fn value(&self, key: &str) -> Result<&'a Value, Problems> {
        let missing = || {
            if self.meant.contains(&key) {
                return Problems::told();
            }
            Problem::missing(key, &self.about(key)).into()
        };
        self.entries.get(key).ok_or_else(missing)
    }

    /// What a key of the object is for.
    fn about(&self, key: &str) -> Cow<'static, str> {
        if key == OF {
            return format!("the shape that `{}` is applied to", self.head).into();
        }
        let about = keys::WITH_LISTS.iter().find(|(name, ..)| *name == key);
        about.map_or("", |(.., about)| about).into()
    }

    /// The value of a key, as a `T`.
    pub(super) fn read<T: DeserializeOwned>(&self, key: &str) -> Result<T, Problems> {
        json::read(self.value(key)?).map_err(|problems| problems.under(key))
    }

    /// The value of a key as a `T`, if the key is there.
    pub(super) fn read_if<T: DeserializeOwned>(
        &self,
        key: &str,
    ) -> Result<Option<T>, Problems> {
        let value = self.entries.get(key).map(json::read).transpose();
        value.map_err(|problems| problems.under(key))
    }

    /// The place of the value of a key in a list of `words`.
    pub(super) fn word(&self, key: &str, words: &[&str]) -> Result<usize, Problems> {
        let value = self.value(key)?;
        let Value::String(found) = value else {
            let listed = words.join("\", \"");
            let found = json::found(value);
            let message = format!("must be one of \"{listed}\", got {found}");
            return Err(Problem::about(message).under(key).into());
        };
        let place = words.iter().position(|word| word == found);
        place.ok_or_else(|| Problem::new(unknown("value", found, words)).under(key).into())
    }
}

/// `true` if a primitive or an operator has this name.
fn is_head(key: &str) -> bool {
    key == keys::SHAPE
        || [keys::MESH, keys::VOLUME, keys::GRID].contains(&key)
        || keys::is_list(key)
        || keys::is_unary(key)
        || !catalogue::named(key).is_empty()
}

/// Adds the unknown keys to `wrong`, and returns those that they may be slips of.
fn meant(
    entries: &Map<String, Value>,
    dimension: Dimension,
    wrong: &mut Problems,
) -> Vec<&'static str> {
    let is_known = |key: &str| keys::OTHERS.contains(&key) || is_head(key);
    let mut meant = Vec::new();
    for (key, value) in entries.iter().filter(|(key, _)| !is_known(key)) {
        let message = advice::unknown_key(key, value, dimension);
        wrong.add(Problem::new(message).under(key));
        meant.extend(advice::meant(key, dimension));
    }
    meant
}

/// The key that decides what is made; that there is none is told unless a key is unknown.
fn head(entries: &Map<String, Value>, has_unknown: bool) -> Result<&str, Problems> {
    let mut heads = entries.keys().map(String::as_str).filter(|key| is_head(key));
    let Some(first) = heads.next() else {
        if has_unknown {
            return Err(Problems::told());
        }
        let message = "missing the primitive or operator that makes the shape";
        return Err(Problem::new(message).into());
    };
    let go_together = |key: &str| keys::MOVES.contains(&first) && keys::MOVES.contains(&key);
    match heads.find(|key| !go_together(key)) {
        None => Ok(first),
        Some(other) => Err(Problem::new(format!(
            "`{first}` and `{other}` in one object; an object makes one shape: nest them"
        ))
        .into()),
    }
}

/// Checks that a description, if there is one, is a text.
pub(super) fn check_description(entries: &Map<String, Value>) -> Result<(), Problems> {
    let description = entries.get(DESCRIPTION).map_or(Ok(String::new()), json::read);
    description.map(drop).map_err(|problems| problems.under(DESCRIPTION))
}
