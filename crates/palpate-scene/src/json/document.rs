// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Documents of JSON, read.
//!
//! Reading on past what is wrong.
//!
//! What is wrong is taken out of the tree, and the rest is read again, so that each error is
//! found. Errors that only follow from what was taken out are not told.

use std::collections::HashSet;
use std::sync::LazyLock;

use jsonc_parser::ast::{ObjectProp, Value as Tree};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use super::source::Source;
use super::write::Node;
use crate::device_file;
use crate::names::{nearest, shortened};
use crate::problem::{MOST, Problem, Problems, SceneError, SceneProblem, Step};

/// How deep objects and lists may nest: what two of them for each of the 64
/// levels of a shape need, twice over. Deeper ones could exhaust the stack.
const DEEPEST: usize = 250;

/// A JSON text, its value, and the tree that knows the places.
pub(crate) struct Document<'a> {
    source: &'a Source<'a>,
    tree: Tree<'a>,
    value: Value,
    /// Duplicate keys, of which the last is in the value, and numbers out of range, for which a
    /// number within it is.
    wrong: Vec<Problem>,
}

impl<'a> Document<'a> {
    /// Reads one JSON value, strictly: a key that is there twice and a number beyond the range of
    /// `f64` are problems.
    pub(crate) fn parse(source: &'a Source<'a>) -> Result<Self, SceneError> {
        // Serde has judged the grammar; the other parser, made for JSON with
        // comments, is more tolerant of odd whitespace and control characters.
        let text = source.readable()?;
        let at = |message: String, byte| {
            source.error([Problem::new(message).located(Some(source.position(byte)))])
        };
        if let Some((depth, byte)) = too_deep(text) {
            let message = format!(
                "objects and lists are nested {depth} deep, at most {DEEPEST} are allowed"
            );
            return Err(at(message, byte));
        }
        let options = CollectOptions::default();
        let parsed = parse_to_ast(text, &options, &STRICT)
            .map_err(|error| at(format!("not JSON: {}", error.kind()), error.range().start))?;
        let Some(tree) = parsed.value else {
            return Err(at("not JSON: nothing there".into(), 0));
        };
        let mut wrong = Vec::new();
        let value = value(&tree, &mut wrong);
        Ok(Self { source, tree, value, wrong })
    }

    /// The JSON value.
    pub(crate) fn into_value(self) -> Result<Value, SceneError> {
        if self.source.is_good() && self.wrong.is_empty() {
            return Ok(self.value);
        }
        Err(self.error(Problems::default()))
    }

    /// What the text holds, which `build` checks.
    pub(crate) fn read<T: DeserializeOwned>(
        &self,
        build: impl FnOnce(&T) -> Result<(), Problems>,
    ) -> Result<T, SceneError> {
        let mut reading = Reading::new(&self.value);
        let read: Option<T> = reading.read();
        let is_built = read.is_some() && reading.is_buildable();
        if let (Some(read), true) = (&read, is_built) {
            reading.add_built(build(read).err().unwrap_or_default());
        }
        let problems = reading.into_problems();
        let is_good = self.source.is_good() && self.wrong.is_empty() && !problems.is_failed();
        match read.filter(|_| is_good) {
            Some(read) => Ok(read),
            None if is_built => Err(self.error(problems)),
            None => Err(self.error(problems).and_maybe_more()),
        }
    }

    /// The error of the text and of what is wrong with the value, but for what is wrong where the
    /// text already is.
    fn error(&self, problems: Problems) -> SceneError {
        let found = problems.into_vec();
        let found = found.iter().filter(|problem| !self.is_told(problem));
        let all = self.wrong.iter().chain(found);
        self.source.error(all.map(|problem| self.locate(problem)))
    }

    /// `true` if the text is wrong where a problem is.
    fn is_told(&self, problem: &Problem) -> bool {
        let (_, place) = self.place(problem);
        let is_inside = |wrong: &Problem| {
            let mut steps = wrong.steps();
            problem.steps().all(|step| steps.next() == Some(step))
        };
        !matches!(place, Tree::Object(_))
            && (self.source.is_guessed(place.range().start..place.range().end)
                || self.wrong.iter().any(is_inside))
    }

    /// `problem` with the place of the deepest value on its path.
    fn locate(&self, problem: &Problem) -> SceneProblem {
        let (start, _) = self.place(problem);
        problem.clone().located(Some(self.source.position(start)))
    }

    /// The deepest value on the path of a problem, and where it, or its key, begins.
    fn place(&self, problem: &Problem) -> (usize, &Tree<'a>) {
        let (mut start, mut tree) = (self.tree.range().start, &self.tree);
        for step in problem.steps() {
            let next = match (step, tree) {
                (Step::Key(key), Tree::Object(object)) => object
                    .properties
                    .iter()
                    // Of duplicates the last is the one too many.
                    .rfind(|property| name(property) == key)
                    .map(|property| (property.range.start, &property.value)),
                (Step::Index(index), Tree::Array(array)) => {
                    array.elements.get(*index).map(|element| (element.range().start, element))
                }
                _ => None,
            };
            match next {
                Some(inner) => (start, tree) = inner,
                None => break,
            }
        }
        (start, tree)
    }
}

/// The value of a tree; what is wrong in it is added to `wrong`.
fn value(tree: &Tree<'_>, wrong: &mut Vec<Problem>) -> Value {
    match tree {
        Tree::StringLit(text) => Value::String(text.value.clone().into_owned()),
        Tree::NumberLit(literal) => number(literal.value).unwrap_or_else(|problem| {
            add(wrong, problem);
            f64::MAX.into()
        }),
        Tree::BooleanLit(literal) => Value::Bool(literal.value),
        Tree::NullKeyword(_) => Value::Null,
        Tree::Array(array) => {
            let elements = array.elements.iter().enumerate();
            let element = |(i, tree)| {
                let known = wrong.len();
                let value = value(tree, wrong);
                seen_from(&mut wrong[known..], |problem| problem.at(i));
                value
            };
            elements.map(element).collect()
        }
        Tree::Object(object) => {
            let mut entries = Map::with_capacity(object.properties.len());
            for property in &object.properties {
                let (key, known) = (name(property), wrong.len());
                let value = value(&property.value, wrong);
                seen_from(&mut wrong[known..], |problem| problem.under(key));
                if entries.insert(key.to_owned(), value).is_some() {
                    let shown = shortened(key);
                    let message = format!("duplicate key `{shown}`");
                    add(wrong, Problem::new(message).under(key));
                }
            }
            Value::Object(entries)
        }
    }
}

/// Adds a problem, if it is not one of too many to tell.
fn add(wrong: &mut Vec<Problem>, problem: Problem) {
    if wrong.len() <= MOST {
        wrong.push(problem);
    }
}

/// Changes the problems of a part to those of what holds it.
fn seen_from(wrong: &mut [Problem], change: impl Fn(Problem) -> Problem) {
    for problem in wrong {
        *problem = change(problem.clone());
    }
}

/// Reads whole numbers as integers, for counts, and all others as `f64`.
fn number(literal: &str) -> Result<Value, Problem> {
    if let Ok(whole) = literal.parse::<u64>() {
        return Ok(whole.into());
    }
    match literal.parse::<i64>() {
        // "-0" is a float of its own.
        Ok(whole) if whole != 0 => return Ok(whole.into()),
        _ => {}
    }
    match literal.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number.into()),
        _ => {
            let literal = shortened(literal);
            Err(Problem::about(format!("must be within the range of numbers, got {literal}")))
        }
    }
}

/// The key of a property.
fn name<'a>(property: &'a ObjectProp<'_>) -> &'a str {
    property.name.as_str()
}

/// JSON and nothing else.
const STRICT: ParseOptions = ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

/// The greatest depth of a JSON text and where [`DEEPEST`] is first passed, if
/// it is.
fn too_deep(text: &str) -> Option<(usize, usize)> {
    let (mut depth, mut greatest, mut place) = (0_usize, 0, None);
    let mut bytes = text.bytes().enumerate();
    while let Some((i, byte)) = bytes.next() {
        match byte {
            b'"' => {
                while let Some((_, inner)) = bytes.next() {
                    match inner {
                        b'\\' => drop(bytes.next()),
                        b'"' => break,
                        _ => {}
                    }
                }
            }
            b'{' | b'[' => {
                depth += 1;
                greatest = greatest.max(depth);
                if depth > DEEPEST {
                    place = place.or(Some(i));
                }
            }
            b'}' | b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    place.map(|byte| (greatest, byte))
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_in_strings_do_not_nest() {
        let text = format!("[\"{}\\\"[\"]", "[".repeat(1000));
        assert!(Document::parse(&Source::of(&text)).is_ok());
        let deep = format!("{}{}", "[".repeat(251), "]".repeat(251));
        assert_eq!(too_deep(&deep), Some((251, 250)));
    }

    #[test]
    fn only_json_is_json() {
        for text in
            ["", "{} {}", "[1,]", "[01]", "// no\n1", "'a'", "\u{b}1", "\"\u{1}\"", "[1 2]"]
        {
            let source = Source::of(text);
            let error = Document::parse(&source).and_then(Document::into_value).unwrap_err();
            assert!(error.to_string().contains("not JSON: "), "{text:?}: {error}");
        }
    }
}
