// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Objects of a scene, built.

use std::borrow::Cow;

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::keys::{self, DESCRIPTION, OF};
use crate::names::unknown;
use crate::problem::{Problem, Problems};
use crate::scene::Dimension;
use crate::{advice, catalogue, json};

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

/// The deepest nesting of operators in a scene, through references: twice what
/// the shapes allow, since translations and unions within unions disappear when
/// they are built.
pub(crate) const DEEPEST: usize = 2 * palpate_field::MAX_DEPTH;

/// The most nodes of a scene once every reference is followed, each counted
/// again in everything that holds it; points of polygons count as nodes. Building as many takes
/// seconds; without a limit, twenty lines of references could take years.
pub(crate) const MOST: usize = 1_000_000;

/// The size of a built shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// Its nodes once every reference is followed.
    pub(super) nodes: usize,
    /// How deep its operators are nested.
    pub(super) depth: usize,
}

impl Size {
    /// The size of an operator on shapes of these sizes.
    pub(super) fn over(operands: &[Self]) -> Self {
        Self {
            nodes: operands.iter().fold(1, |sum, size| sum.saturating_add(size.nodes)),
            depth: operands.iter().map(|size| size.depth).max().unwrap_or(0) + 1,
        }
    }
}

impl Size {
    /// The size of a repetition, which may ask its shape for the copies to both sides
    /// along each axis.
    pub(super) fn repeated(self, dimensions: u32) -> Self {
        let copies = 3_usize.pow(dimensions);
        Self { nodes: self.nodes.saturating_mul(copies), depth: self.depth + 2 }
    }
}

/// The nodes that were built, and the limits that were passed. Each is told of once: what is too
/// large makes all that holds it too large.
#[derive(Debug)]
pub(super) struct Allowance {
    /// The most nodes.
    most: usize,
    spent: usize,
    is_spent_told: bool,
    is_depth_told: bool,
}

impl Allowance {
    /// At most [`MOST`] nodes, or fewer.
    pub(super) fn of(most: Option<usize>) -> Self {
        let most = most.map_or(MOST, |most| most.min(MOST));
        Self { most, spent: 0, is_spent_told: false, is_depth_told: false }
    }

    /// Takes the nodes of a shape that is about to be built at `level`.
    pub(super) fn take(&mut self, size: Size, level: usize) -> Result<(), Problems> {
        self.check_depth(level + size.depth)?;
        self.spent = self.spent.saturating_add(size.nodes);
        let (most, is_told) = (self.most, &mut self.is_spent_told);
        refused_once(self.spent > most, is_told, || {
            format!(
                "with all references followed the scene has more than {most} nodes, the most allowed"
            )
        })
    }

    /// Refuses what is nested too deeply.
    pub(super) fn check_depth(&mut self, depth: usize) -> Result<(), Problems> {
        refused_once(depth > DEEPEST, &mut self.is_depth_told, || {
            format!("shapes are nested more than {DEEPEST} deep, references followed")
        })
    }
}

/// An error if `is_wrong`, which is told unless it was.
fn refused_once(
    is_wrong: bool,
    is_told: &mut bool,
    message: impl FnOnce() -> String,
) -> Result<(), Problems> {
    match (is_wrong, std::mem::replace(is_told, *is_told || is_wrong)) {
        (false, _) => Ok(()),
        (true, true) => Err(Problems::told()),
        (true, false) => Err(Problem::new(message()).into()),
    }
}
