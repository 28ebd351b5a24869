// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The keys of a shape's object that are not primitives: one list for reading, writing
//! and the schema.

use palpate_field::operator::Operator;

use crate::catalogue;
use crate::scene::Dimension;

/// `{ "union": [..] }`.
pub(crate) const UNION: &str = "union";
/// `{ "intersection": [..] }`.
pub(crate) const INTERSECTION: &str = "intersection";
/// `{ "difference": [first, minus, ..] }`.
pub(crate) const DIFFERENCE: &str = "difference";
/// `{ "symmetric_difference": [..] }`.
pub(crate) const SYMMETRIC_DIFFERENCE: &str = "symmetric_difference";
/// `{ "smooth_union": [..], "width": w, "profile": .. }`.
pub(crate) const SMOOTH_UNION: &str = "smooth_union";
/// `{ "smooth_intersection": [..], "width": w, "profile": .. }`.
pub(crate) const SMOOTH_INTERSECTION: &str = "smooth_intersection";
/// `{ "smooth_difference": [first, minus, ..], "width": w, "profile": .. }`.
pub(crate) const SMOOTH_DIFFERENCE: &str = "smooth_difference";
/// The width of a smooth boolean.
pub(crate) const WIDTH: &str = "width";
/// The profile of a smooth boolean.
pub(crate) const PROFILE: &str = "profile";
/// `{ "displace": [what, by], "height": h }`.
pub(crate) const DISPLACE: &str = "displace";
/// The height of a displacement.
pub(crate) const HEIGHT: &str = "height";
/// `{ "morph": [from, into], "progress": t }`.
pub(crate) const MORPH: &str = "morph";
/// The progress of a morph.
pub(crate) const PROGRESS: &str = "progress";
/// `{ "translate": [..], "of": .. }`.
pub(crate) const TRANSLATE: &str = "translate";
/// `{ "rotate_degrees": .., "of": .. }`.
pub(crate) const ROTATE_DEGREES: &str = "rotate_degrees";
/// `{ "rotation": [x, y, z, w], "of": .. }`, or the rows of a matrix.
pub(crate) const ROTATION: &str = "rotation";
/// `{ "scale": .., "of": .. }`.
pub(crate) const SCALE: &str = "scale";
/// `{ "offset": .., "of": .. }`.
pub(crate) const OFFSET: &str = "offset";
/// `{ "mirror": "x", "of": .. }`.
pub(crate) const MIRROR: &str = "mirror";
/// `{ "repeat": { "x": { "spacing": .. }, .. }, "of": .. }`.
pub(crate) const REPEAT: &str = "repeat";
/// `{ "bend_degrees": .., "of": .. }`.
pub(crate) const BEND_DEGREES: &str = "bend_degrees";
/// `{ "bend": .., "of": .. }`.
pub(crate) const BEND: &str = "bend";
/// `{ "twist_degrees": .., "of": .. }`.
pub(crate) const TWIST_DEGREES: &str = "twist_degrees";
/// `{ "twist": .., "of": .. }`.
pub(crate) const TWIST: &str = "twist";
/// `{ "bake": { "tolerance": .. }, "of": .. }`.
pub(crate) const BAKE: &str = "bake";
/// `{ "extrude": .., "of": .. }`.
pub(crate) const EXTRUDE: &str = "extrude";
/// `{ "revolve": "y", "of": .. }`.
pub(crate) const REVOLVE: &str = "revolve";
/// The operand of the operators that have one.
pub(crate) const OF: &str = "of";
/// `{ "mesh": { "file": "nut.ply", "scale": 0.001 } }`.
pub(crate) const MESH: &str = "mesh";
/// `{ "volume": { "file": "scan.nrrd", "value": 300 } }`, `"inside": "below"` if so wished.
pub(crate) const VOLUME: &str = "volume";
/// `{ "grid": { "file": "part.grid" } }`.
pub(crate) const GRID: &str = "grid";
/// `{ "shape": "name" }`.
pub(crate) const SHAPE: &str = "shape";
/// What a shape is for.
pub(crate) const DESCRIPTION: &str = "description";

/// The operators whose key holds the list of their operands.
pub(crate) const LISTS: [(&str, &str); 9] = [
    (UNION, "What is in any of the shapes."),
    (INTERSECTION, "What is in all of the shapes."),
    (DIFFERENCE, "What is in the first shape and in none of the others."),
    (SYMMETRIC_DIFFERENCE, "What is in an odd number of the shapes."),
    (SMOOTH_UNION, "The union of the shapes, its creases filled."),
    (SMOOTH_INTERSECTION, "The intersection of the shapes, its edges rounded off."),
    (
        SMOOTH_DIFFERENCE,
        "The first shape without the others, the edges of the cuts rounded off.",
    ),
    (
        DISPLACE,
        "The first shape, its surface moved outwards where the second field is positive.",
    ),
    (MORPH, "A shape on the way from the first to the second."),
];

/// The operators with one operand that are not in the catalogue; the first three go together.
const UNARY: [(&str, &str); 14] = [
    (TRANSLATE, "Moves the shape [m]; after the rotation, if there is one."),
    (ROTATE_DEGREES, "Turns the shape: degrees in 2D, axis and angle in 3D."),
    (ROTATION, "Turns the shape: the rows of a matrix, or in 3D a quaternion [x, y, z, w]."),
    (SCALE, "Scales the shape: a factor, or one for each axis."),
    (OFFSET, "Grows the shape by a length [m], or shrinks it if negative."),
    (MIRROR, "Adds the mirror image of the part at positive coordinates of an axis."),
    (REPEAT, "Repeats the shape along axes: spacing [m], first and last number of the copies."),
    (
        BEND_DEGREES,
        "Bends the shape: turns it in the plane of x and y by so much for each metre of x.",
    ),
    (BEND, "As bend_degrees, in radians for each metre."),
    (TWIST_DEGREES, "Twists the shape: turns it about y by so much for each metre of y."),
    (TWIST, "As twist_degrees, in radians for each metre."),
    (
        BAKE,
        "Samples the shape on a grid: its distance then takes the same short time everywhere.",
    ),
    (EXTRUDE, "Gives a 2D shape, drawn in x and z, a height along y [m]."),
    (REVOLVE, "Turns a 2D shape about y, its x the distance from the axis."),
];

/// The operators with one operand, under [`OF`].
pub(crate) fn unary() -> impl Iterator<Item = (&'static str, &'static str)> {
    UNARY
        .into_iter()
        .chain(Operator::ALL.iter().map(|operator| (operator.name, operator.about)))
}

/// The operators of [`UNARY`] that may be there together.
pub(crate) const MOVES: [&str; 3] = [TRANSLATE, ROTATE_DEGREES, ROTATION];

/// The operators of [`UNARY`] that are in 3D alone.
pub(crate) const SOLID: [&str; 4] = [TWIST_DEGREES, TWIST, EXTRUDE, REVOLVE];

/// The keys that make no shape by themselves.
pub(crate) const OTHERS: [&str; 6] = [WIDTH, PROFILE, HEIGHT, PROGRESS, OF, DESCRIPTION];

/// The axes of a mirror and of rows of copies.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The smooth booleans.
pub(crate) const SMOOTH: [&str; 3] = [SMOOTH_UNION, SMOOTH_INTERSECTION, SMOOTH_DIFFERENCE];

/// The lists of two.
#[cfg(test)]
pub(crate) const PAIRS: [&str; 2] = [DISPLACE, MORPH];

/// The keys of numbers that go with lists: which, whether the lists need them, and what
/// they are.
pub(crate) const WITH_LISTS: [(&str, bool, &[&str], &str); 4] = [
    (WIDTH, true, &SMOOTH, "how far the surface moves where two distances are equal [m]"),
    (PROFILE, false, &SMOOTH, "the profile of the crease; quadratic if left out"),
    (HEIGHT, true, &[DISPLACE], "how far the surface moves at most [m]"),
    (PROGRESS, true, &[MORPH], "how far on the way, from 0 to 1"),
];

/// `true` if `key` is an operator with one operand.
pub(crate) fn is_unary(key: &str) -> bool {
    unary().any(|(operator, _)| operator == key)
}

/// `true` if `key` is an operator on a list of shapes.
pub(crate) fn is_list(key: &str) -> bool {
    LISTS.iter().any(|(operator, _)| *operator == key)
}

/// Every key that the object of a shape of a dimension may have, the primitives' names included.
pub(crate) fn all_keys(dimension: Dimension) -> Vec<&'static str> {
    let is_there = |key: &&str| {
        dimension == Dimension::Three || !SOLID.contains(key) && ![MESH, VOLUME].contains(key)
    };
    let lists = LISTS.iter().map(|(key, _)| *key);
    let unary = unary().map(|(key, _)| key).filter(is_there);
    let primitives = catalogue::signatures().filter(|s| s.dimension == dimension);
    let others = OTHERS
        .into_iter()
        .chain([SHAPE, GRID])
        .chain([MESH, VOLUME].into_iter().filter(is_there));
    let names = primitives.map(|signature| signature.name);
    let mut keys: Vec<_> = names.chain(lists).chain(unary).chain(others).collect();
    keys.sort_unstable();
    keys.dedup();
    keys
}
