// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An object that makes a shape: which key decides, and whether the others go with it.

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::catalogue;
use crate::json;
use crate::keys::{self, DESCRIPTION, OF, all_keys};
use crate::problem::{Problem, unknown};

/// An object that makes a shape, its keys checked and its values not.
#[derive(Clone, Copy, Debug)]
pub(super) struct Object<'a> {
    entries: &'a Map<String, Value>,
    /// The primitive or operator: of a translation with a rotation, the first of the two.
    pub(super) head: &'a str,
}

impl<'a> Object<'a> {
    /// Checks which keys are there.
    pub(super) fn new(entries: &'a Map<String, Value>) -> Result<Self, Problem> {
        let head = head(entries)?;
        check_description(entries)?;
        let is_unary = keys::is_one_of(&keys::UNARY, head);
        if entries.contains_key(OF) != is_unary {
            return Err(Problem::new(if is_unary {
                format!("missing key `{OF}`: the shape that `{head}` is applied to")
            } else {
                format!("key `{OF}` does not go with `{head}`")
            }));
        }
        for (key, is_needed, lists, about) in keys::WITH_LISTS {
            let (is_there, goes) = (entries.contains_key(key), lists.contains(&head));
            if is_there && !goes {
                return Err(Problem::new(format!("key `{key}` does not go with `{head}`")));
            }
            if goes && is_needed && !is_there {
                return Err(Problem::new(format!("missing key `{key}`: {about}")));
            }
        }
        Ok(Self { entries, head })
    }

    /// `true` if the object has the key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// The value of a key that was checked to be there.
    pub(super) fn value(&self, key: &str) -> Result<&'a Value, Problem> {
        self.entries.get(key).ok_or_else(|| Problem::new(format!("missing key `{key}`")))
    }

    /// The value of a key that was checked to be there, as a `T`.
    pub(super) fn read<T: DeserializeOwned>(&self, key: &str) -> Result<T, Problem> {
        json::read(self.value(key)?).map_err(|problem| problem.under(key))
    }

    /// The value of a key as a `T`, if the key is there.
    pub(super) fn read_if<T: DeserializeOwned>(&self, key: &str) -> Result<Option<T>, Problem> {
        let value = self.entries.get(key).map(json::read).transpose();
        value.map_err(|problem| problem.under(key))
    }

    /// The place of the value of a key in a list of `words`.
    pub(super) fn word(&self, key: &str, words: &[&str]) -> Result<usize, Problem> {
        let value = self.value(key)?;
        let Value::String(found) = value else {
            let listed = words.join("\", \"");
            let found = json::found(value);
            let message = format!("must be one of \"{listed}\", got {found}");
            return Err(Problem::about(message).under(key));
        };
        let place = words.iter().position(|word| word == found);
        place.ok_or_else(|| Problem::new(unknown("value", found, words)).under(key))
    }
}

/// The key that decides what is made.
fn head(entries: &Map<String, Value>) -> Result<&str, Problem> {
    let mut heads = Vec::new();
    for key in entries.keys().map(String::as_str) {
        if keys::OTHERS.contains(&key) {
            continue;
        }
        let is_operator = key == keys::SHAPE
            || keys::is_one_of(&keys::LISTS, key)
            || keys::is_one_of(&keys::UNARY, key);
        if !is_operator && catalogue::named(key).is_empty() {
            return Err(Problem::new(unknown("key", key, &all_keys())).under(key));
        }
        heads.push(key);
    }
    let Some(first) = heads.first() else {
        return Err(Problem::new("missing the primitive or operator that makes the shape"));
    };
    let go_together = |key: &str| keys::MOVES.contains(first) && keys::MOVES.contains(&key);
    match heads.iter().skip(1).find(|key| !go_together(key)) {
        None => Ok(first),
        Some(other) => Err(Problem::new(format!(
            "`{first}` and `{other}` in one object; an object makes one shape: nest them"
        ))),
    }
}

/// Checks that a description, if there is one, is a text.
pub(super) fn check_description(entries: &Map<String, Value>) -> Result<(), Problem> {
    let description = entries.get(DESCRIPTION).map_or(Ok(String::new()), json::read);
    description.map(drop).map_err(|problem| problem.under(DESCRIPTION))
}
