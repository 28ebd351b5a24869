// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reading on past what is wrong.
//!
//! What is wrong is taken out of the tree, and the rest is read again, so that each error is
//! found. Errors that only follow from what was taken out are not told.

use std::collections::HashSet;
use std::sync::LazyLock;

use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use super::deserialize::Node;
use crate::device_file;
use crate::names::nearest;
use crate::problem::{Problem, Step};
use crate::problems::Problems;

/// `value` as a `T`.
pub(crate) fn read<T: DeserializeOwned>(value: &Value) -> Result<T, Problems> {
    let mut reading = Reading::new(value);
    let read = reading.read();
    reading.problems.end(read.ok_or_else(Problems::told))
}

/// What stands in for keys that are missing or wrong, so that the rest can be read.
static STAND_INS: LazyLock<Vec<(&str, Value)>> = LazyLock::new(|| {
    let others = [
        ("palpate", json!(1)),
        ("bodies", json!([])),
        ("name", json!("")),
        ("shape", json!({ "ball": { "radius": 1 } })),
        ("body", json!("")),
        ("to", json!({})),
        ("palpate_device", json!(1)),
        ("palpate_motions", json!(1)),
        ("motions", json!([])),
        ("device", json!("")),
        ("source", json!("")),
    ];
    let numbers = device_file::numbers().map(|name| (name, json!(device_file::UNKNOWN)));
    others.into_iter().chain(numbers).collect()
});

/// What stands in for a dimension that is missing or wrong.
static DIMENSIONS: LazyLock<[Value; 2]> = LazyLock::new(|| [json!(2), json!(3)]);

/// A key of an object, and the value that stands in for it.
#[derive(Clone, Copy)]
struct StandIn<'t> {
    object: *const Value,
    key: &'static str,
    value: &'t Value,
}

/// What was taken out of a tree, and what stands in for it. Values are known by their addresses.
#[derive(Default)]
pub(super) struct Taken<'t> {
    out: HashSet<*const Value>,
    stand_ins: Vec<StandIn<'t>>,
}

impl<'t> Taken<'t> {
    /// The elements that are left of a list.
    pub(super) fn left<'v>(&self, list: &'v [Value]) -> impl Iterator<Item = &'v Value> {
        list.iter().filter(|value| !self.is_out(value))
    }

    /// The entries that are left of an object, with those that stand in for others.
    pub(super) fn entries(
        &self,
        object: &Value,
        entries: &'t Map<String, Value>,
    ) -> Vec<(&'t str, &'t Value)> {
        let left = entries.iter().filter(|(_, value)| !self.is_out(value));
        let left = left.map(|(key, value)| (key.as_str(), value));
        let stand_ins = self.stand_ins.iter().filter(|s| std::ptr::eq(s.object, object));
        left.chain(stand_ins.map(|s| (s.key, s.value))).collect()
    }

    fn is_out(&self, value: &Value) -> bool {
        self.out.contains(&std::ptr::from_ref(value))
    }

    /// The keys that are out of an object.
    fn keys_out<'v>(
        &self,
        entries: &'v Map<String, Value>,
    ) -> impl Iterator<Item = &'v String> {
        entries.iter().filter(|(_, value)| self.is_out(value)).map(|(key, _)| key)
    }

    fn stands_in(&self, object: &Value, step: &Step) -> bool {
        let is_it = |s: &StandIn<'_>| {
            std::ptr::eq(s.object, object) && matches!(step, Step::Key(key) if key == s.key)
        };
        self.stand_ins.iter().any(is_it)
    }
}

/// A tree that is read.
pub(crate) struct Reading<'t> {
    root: &'t Value,
    taken: Taken<'t>,
    /// What is wrong, in indices of the file.
    problems: Problems,
    /// `false` if what was read says less than the file: its dimension is a guess.
    is_buildable: bool,
}

impl<'t> Reading<'t> {
    pub(crate) fn new(root: &'t Value) -> Self {
        let (taken, problems) = <(Taken<'_>, Problems)>::default();
        Self { root, taken, problems, is_buildable: true }
    }

    /// The tree as a `T`, without what is wrong; `None` if too much is.
    pub(crate) fn read<T: DeserializeOwned>(&mut self) -> Option<T> {
        loop {
            let node = Node { value: self.root, taken: &self.taken };
            let problem = match T::deserialize(node) {
                Ok(value) => return Some(value),
                Err(problem) => problem,
            };
            if !self.take_out(problem) {
                return None;
            }
        }
    }

    /// `true` if what was read can be built to find further problems.
    pub(crate) fn is_buildable(&self) -> bool {
        self.is_buildable
    }

    /// Adds what is wrong with what was built of the value that was read.
    pub(crate) fn add_built(&mut self, problems: Problems) {
        for problem in problems.into_vec() {
            let problem = self.in_file(problem);
            if !self.is_of_stand_in(&problem) && !self.follows(&problem) {
                self.problems.add(problem);
            }
        }
    }

    /// All that is wrong.
    pub(crate) fn into_problems(self) -> Problems {
        self.problems
    }

    /// Tells of a problem and takes its place out; `false` if nothing is left then.
    fn take_out(&mut self, problem: Problem) -> bool {
        let problem = self.in_file(problem);
        let way = self.way(&problem);
        let (place, is_root) = (way.last().copied().unwrap_or(self.root), way.len() <= 1);
        let stand_in = problem.missing_key().and_then(|key| self.stand_in(key, place));
        if !self.follows(&problem) {
            self.problems.add(problem);
        }
        match stand_in {
            _ if self.problems.is_full() => false,
            Some(stand_in) => {
                self.taken.stand_ins.push(stand_in);
                true
            }
            None => !is_root && self.taken.out.insert(place),
        }
    }

    /// What may stand in for a missing key of `object`.
    fn stand_in(&mut self, key: &str, object: &'t Value) -> Option<StandIn<'t>> {
        let object_at = std::ptr::from_ref(object);
        if key == "dimension" {
            let written = object.get(key).map(Value::to_string).unwrap_or_default();
            let [two, three] = ["2", "3"].map(|digit| written.contains(digit));
            self.is_buildable &= two != three;
            let value = &DIMENSIONS[usize::from(!two)];
            return Some(StandIn { object: object_at, key: "dimension", value });
        }
        let (key, value) = STAND_INS.iter().find(|(name, _)| *name == key)?;
        Some(StandIn { object: object_at, key, value })
    }

    /// `problem` with the indices that elements have in the file.
    fn in_file(&self, problem: Problem) -> Problem {
        let mut place = Some(self.root);
        problem.with_steps(|step| {
            let step = match (step, place) {
                (Step::Index(index), Some(Value::Array(list))) => {
                    let left = self.taken.left(list).nth(index);
                    let is_it =
                        |value: &Value| left.is_some_and(|left| std::ptr::eq(left, value));
                    Step::Index(list.iter().position(is_it).unwrap_or(index))
                }
                (step, _) => step,
            };
            place = place.and_then(|value| child(value, &step));
            step
        })
    }

    /// The values on the way to a problem, from the root to the deepest that is there.
    fn way(&self, problem: &Problem) -> Vec<&'t Value> {
        let mut way = vec![self.root];
        for step in problem.steps() {
            match way.last().and_then(|value| child(value, step)) {
                Some(next) => way.push(next),
                None => break,
            }
        }
        way
    }

    /// `true` if a problem is with what stands in for a key.
    fn is_of_stand_in(&self, problem: &Problem) -> bool {
        let way = self.way(problem);
        let stands_in = |(step, value): (&Step, &&Value)| self.taken.stands_in(value, step);
        problem.steps().zip(&way).any(stands_in)
            || (is_name_of_body(problem) && !self.has_all_names())
    }

    /// `true` if every body was read with its own name, or the file has none: a file of motions.
    fn has_all_names(&self) -> bool {
        let bodies = Step::Key("bodies".into());
        let Some(Value::Array(bodies)) = self.root.get("bodies") else {
            return self.root.get("bodies").is_none()
                && !self.taken.stands_in(self.root, &bodies);
        };
        let name = Step::Key("name".into());
        bodies.iter().all(|body| !self.taken.is_out(body) && !self.taken.stands_in(body, &name))
    }

    /// `true` if a problem only follows from what was taken out of its place.
    fn follows(&self, problem: &Problem) -> bool {
        let way = self.way(problem);
        if way.len() <= problem.steps().count() {
            return false;
        }
        match (way.last(), problem.missing_key()) {
            (Some(Value::Object(entries)), Some(missing)) => {
                let is_meant = |key: &String| nearest(key, &[missing]).is_some();
                self.taken.keys_out(entries).any(is_meant)
            }
            (Some(Value::Object(entries)), None) => {
                self.taken.keys_out(entries).next().is_some()
            }
            (Some(Value::Array(list)), _) => list.iter().any(|value| self.taken.is_out(value)),
            _ => false,
        }
    }
}

/// `true` for the place of the name of a body that moves.
fn is_name_of_body(problem: &Problem) -> bool {
    let steps: Vec<_> = problem.steps().collect();
    matches!(steps[..], [Step::Key(list), Step::Index(_), Step::Key(key)]
        if list == "motions" && key == "body")
}

/// One step down.
fn child<'t>(value: &'t Value, step: &Step) -> Option<&'t Value> {
    match step {
        Step::Key(key) => value.get(key),
        Step::Index(index) => value.get(index),
    }
}
