// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What may be meant by a key or a name of a shape that there is none of.

use palpate_field::Shape;
use palpate_field::catalogue::Entry;
use serde_json::Value;

use crate::catalogue::{self, Signature};
use crate::json;
use crate::keys;
use crate::names::{did_you_mean, near, shortened, unknown};
use crate::scene::Dimension;
use crate::write::Writer;

/// Names of other programs, and ours.
const OTHER_NAMES: [(&str, &str); 44] = [
    ("add", "union"),
    ("and", "intersection"),
    ("array", "repeat"),
    ("at", "translate"),
    ("blend", "smooth_union"),
    ("child", "of"),
    ("children", "of"),
    ("copies", "repeat"),
    ("cut", "difference"),
    ("disc", "circle"),
    ("disc", "cylinder"),
    ("disk", "circle"),
    ("disk", "cylinder"),
    ("donut", "torus"),
    ("floor", "half_space"),
    ("grow", "offset"),
    ("group", "union"),
    ("hollow", "shell"),
    ("intersect", "intersection"),
    ("join", "union"),
    ("k", "width"),
    ("lathe", "revolve"),
    ("line", "segment"),
    ("linear_extrude", "extrude"),
    ("merge", "union"),
    ("minus", "difference"),
    ("move", "translate"),
    ("onion", "shell"),
    ("or", "union"),
    ("pill", "capsule"),
    ("pipe", "shell"),
    ("plane", "half_space"),
    ("position", "translate"),
    ("rotate", "rotate_degrees"),
    ("rotate", "rotation"),
    ("rotate_extrude", "revolve"),
    ("round", "offset"),
    ("smin", "smooth_union"),
    ("subtract", "difference"),
    ("symmetry", "mirror"),
    ("thicken", "shell"),
    ("translation", "translate"),
    ("tube", "shell"),
    ("xor", "symmetric_difference"),
];

/// The keys that may be meant by a key of a shape's object, the nearest first.
pub(crate) fn meant(key: &str, dimension: Dimension) -> Vec<&'static str> {
    let known = keys::all_keys(dimension);
    let other_names =
        OTHER_NAMES.iter().filter(|(name, ours)| *name == key && known.contains(ours));
    let meant: Vec<_> = other_names.map(|(_, ours)| *ours).collect();
    if meant.is_empty() { near(key, &known) } else { meant }
}

/// What is wrong with a key of a shape's object that there is none of.
pub(crate) fn unknown_key(key: &str, value: &Value, dimension: Dimension) -> String {
    let shown = shortened(key);
    let meant = meant(key, dimension);
    if !meant.is_empty() {
        return format!("unknown key `{shown}`, {}", did_you_mean(&meant));
    }
    if let Some(form) = value.as_str().and_then(|name| form(name, dimension)) {
        return format!(
            "unknown key `{shown}`; what makes the shape is itself the key: {form}"
        );
    }
    let has_it = |signature: &Signature| signature.parameter(key).is_some();
    if let Some(primitive) = primitives(dimension).find(has_it)
        && let Some(form) = form(primitive.name, dimension)
    {
        return format!(
            "unknown key `{shown}`; parameters stand in the object of their primitive, as in {form}"
        );
    }
    let related = related(key, &keys::all_keys(dimension));
    if related.is_empty() {
        format!("unknown key `{shown}`; the schema and `palpate shapes` list those there are")
    } else {
        format!("unknown key `{shown}`, {}", did_you_mean(&related))
    }
}

/// What is wrong with the name of a shape that none of the `named` has.
pub(crate) fn unknown_shape(name: &str, named: &[&str], dimension: Dimension) -> String {
    match form(name, dimension) {
        None => unknown("shape", name, named),
        Some(form) => format!(
            "unknown shape `{name}`; a text is the name of one of `shapes`, and what makes a shape stands in an object: {form}"
        ),
    }
}

/// A primitive with the arguments of its example, or the form of an operator: `None` if there is
/// none of that name in the dimension.
pub(crate) fn form(name: &str, dimension: Dimension) -> Option<String> {
    if keys::is_list(name) {
        return Some(format!("{{ \"{name}\": [ …, … ] }}"));
    }
    if keys::is_unary(name) {
        return Some(format!("{{ \"{name}\": …, \"of\": … }}"));
    }
    let arguments = arguments(name, dimension)?;
    Some(format!("{{ \"{name}\": {arguments} }}"))
}

/// The arguments of a primitive's example, on one line; of many numbers only the keys.
pub(crate) fn arguments(name: &str, dimension: Dimension) -> Option<String> {
    /// More characters are no longer an example.
    const LONGEST: usize = 100;
    let signature = primitives(dimension).find(|signature| signature.name == name)?;
    if signature.alias.is_some_and(|alias| alias.parameters.is_some()) {
        return Some("{ \"size\": 0.5 }".to_owned());
    }
    let arguments = match dimension {
        Dimension::Two => example(Entry::<2>::find(name)?.example().ok()?),
        Dimension::Three => example(Entry::<3>::find(name)?.example().ok()?),
    };
    let arguments = arguments.filter(|arguments| arguments.chars().count() <= LONGEST);
    Some(arguments.unwrap_or_else(|| {
        let keys = signature.parameters.iter().map(catalogue::file_key);
        let keys: Vec<_> = keys.map(|key| format!("\"{key}\": …")).collect();
        format!("{{ {} }}", keys.join(", "))
    }))
}

/// The arguments of a shape that is one primitive, on one line.
fn example<const D: usize>(shape: Shape<D>) -> Option<String> {
    let written = Writer::new(indexmap::IndexMap::new()).shape(&shape).ok()?;
    let arguments = written.json().as_object()?.values().next()?;
    Some(json::write(arguments).split_whitespace().collect::<Vec<_>>().join(" "))
}

fn primitives(dimension: Dimension) -> impl Iterator<Item = Signature> {
    catalogue::signatures().filter(move |signature| signature.dimension == dimension)
}

/// The names that begin with `key`, then those that share a word with it.
fn related<'a>(key: &str, known: &[&'a str]) -> Vec<&'a str> {
    /// Shorter words are in too many names.
    const SHORTEST: usize = 3;
    let words = || key.split('_').filter(|word| word.len() >= SHORTEST);
    let shares = |name: &&&str| words().any(|word| name.contains(word));
    let mut related: Vec<_> = known.iter().filter(shares).copied().collect();
    related.sort_by_key(|name| (!name.starts_with(key), name.len()));
    related
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_keys_are_answered_with_what_may_be_meant() {
        let told = |key: &str, dimension| unknown_key(key, &Value::Null, dimension);
        use Dimension::{Three, Two};
        for (key, dimension, expected) in [
            ("bal", Three, "unknown key `bal`, did you mean `ball`?"),
            ("subtract", Three, "unknown key `subtract`, did you mean `difference`?"),
            (
                "rotate",
                Two,
                "unknown key `rotate`, did you mean `rotate_degrees` or `rotation`?",
            ),
            ("disc", Two, "unknown key `disc`, did you mean `circle`?"),
            ("disc", Three, "unknown key `disc`, did you mean `cylinder`?"),
            (
                "cyl",
                Three,
                "unknown key `cyl`, did you mean `cylinder`, `cylinder_between`, `cylinder_approximation`, `rounded_cylinder` or `infinite_cylinder`?",
            ),
            (
                "radius",
                Three,
                "unknown key `radius`; parameters stand in the object of their primitive, as in { \"ball\": { \"radius\": 0.7 } }",
            ),
            (
                "lattice",
                Three,
                "unknown key `lattice`; the schema and `palpate shapes` list those there are",
            ),
        ] {
            assert_eq!(told(key, dimension), expected);
        }
        let by_type = unknown_key("type", &"sphere".into(), Three);
        let expected = "unknown key `type`; what makes the shape is itself the key: { \"sphere\": { \"radius\": 0.7 } }";
        assert_eq!(by_type, expected);
    }

    #[test]
    fn other_names_lead_to_keys_that_are_there() {
        let all = [Dimension::Two, Dimension::Three].map(keys::all_keys).concat();
        for (name, ours) in OTHER_NAMES {
            assert!(all.contains(&ours), "{ours}");
            assert!(!all.contains(&name), "{name} is a key");
        }
    }

    #[test]
    fn every_primitive_has_a_form_on_one_line() {
        for signature in catalogue::signatures() {
            let form = form(signature.name, signature.dimension).unwrap();
            assert!(form.chars().count() < 200 && !form.contains('\n'), "{form}");
        }
    }
}
