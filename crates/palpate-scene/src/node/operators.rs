// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The keys of a node that are not primitives: one list for reading, writing
//! and the schema.

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
/// The width of a smooth union.
pub(crate) const WIDTH: &str = "width";
/// The profile of a smooth union.
pub(crate) const PROFILE: &str = "profile";
/// `{ "translate": [..], "of": .. }`.
pub(crate) const TRANSLATE: &str = "translate";
/// `{ "rotate_degrees": .., "of": .. }`.
pub(crate) const ROTATE_DEGREES: &str = "rotate_degrees";
/// `{ "rotation": [x, y, z, w], "of": .. }`.
pub(crate) const ROTATION: &str = "rotation";
/// `{ "scale": .., "of": .. }`.
pub(crate) const SCALE: &str = "scale";
/// `{ "offset": .., "of": .. }`.
pub(crate) const OFFSET: &str = "offset";
/// `{ "shell": .., "of": .. }`.
pub(crate) const SHELL: &str = "shell";
/// `{ "elongate": [..], "of": .. }`.
pub(crate) const ELONGATE: &str = "elongate";
/// `{ "mirror": "x", "of": .. }`.
pub(crate) const MIRROR: &str = "mirror";
/// `{ "extrude": .., "of": .. }`.
pub(crate) const EXTRUDE: &str = "extrude";
/// `{ "revolve": "y", "of": .. }`.
pub(crate) const REVOLVE: &str = "revolve";
/// The operand of the operators that have one.
pub(crate) const OF: &str = "of";
/// `{ "shape": "name" }`.
pub(crate) const SHAPE: &str = "shape";
/// What a node is for.
pub(crate) const DESCRIPTION: &str = "description";

/// The operators whose key holds the list of their operands.
pub(crate) const LISTS: [(&str, &str); 5] = [
    (UNION, "What is in any of the shapes."),
    (INTERSECTION, "What is in all of the shapes."),
    (DIFFERENCE, "What is in the first shape and in none of the others."),
    (SYMMETRIC_DIFFERENCE, "What is in an odd number of the shapes."),
    (SMOOTH_UNION, "The union of the shapes, its creases filled."),
];

/// The operators with one operand, under [`OF`]; the first three go together.
pub(crate) const UNARY: [(&str, &str); 10] = [
    (TRANSLATE, "Moves the shape [m]; after the rotation, if there is one."),
    (ROTATE_DEGREES, "Turns the shape: degrees in 2D, axis and angle in 3D."),
    (ROTATION, "Turns the shape in 3D: a quaternion [x, y, z, w]."),
    (SCALE, "Scales the shape: a factor, or one for each axis."),
    (OFFSET, "Grows the shape by a length [m], or shrinks it if negative."),
    (SHELL, "Makes a wall of this thickness on the surface of the shape [m]."),
    (ELONGATE, "Pulls the shape apart at the coordinate planes [m]."),
    (MIRROR, "Adds the mirror image of the part at positive coordinates of an axis."),
    (EXTRUDE, "Gives a 2D shape, drawn in x and z, a height along y [m]."),
    (REVOLVE, "Turns a 2D shape about y, its x the distance from the axis."),
];

/// The rest of the keys.
const OTHERS: [&str; 5] = [WIDTH, PROFILE, OF, SHAPE, DESCRIPTION];

/// Every key that a node may have, the primitives' names included.
pub(crate) fn all_keys() -> Vec<&'static str> {
    let lists = LISTS.iter().map(|(key, _)| *key);
    let unary = UNARY.iter().map(|(key, _)| *key);
    let primitives = crate::catalogue::signatures().map(|signature| signature.name);
    let mut keys: Vec<_> = primitives.chain(lists).chain(unary).chain(OTHERS).collect();
    keys.sort_unstable();
    keys.dedup();
    keys
}
