// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a shape refuses, said with the keys of files.

use palpate_field::catalogue::Entry;
use palpate_field::kernel::ParameterKind;
use palpate_field::{ShapeError, Unit};

use crate::node::Primitive;
use crate::problem::Problem;

/// The problem of an operator whose number is under `key`.
pub(super) fn of_operator(key: &str, error: &ShapeError) -> Problem {
    let problem = Problem::new(error.to_string());
    match error {
        ShapeError::Number { .. } => problem.under(key),
        _ => problem,
    }
}

/// The problem of a primitive of `entry`, seen from its arguments.
pub(super) fn of_primitive<const D: usize>(
    entry: &Entry<D>,
    primitive: &Primitive,
    error: &ShapeError,
) -> Problem {
    let (ShapeError::Number { parameter: name, .. }
    | ShapeError::Count { parameter: name, .. }) = error
    else {
        return Problem::new(error.to_string());
    };
    // "points[2]" is about the parameter "points".
    let base = name.split(['[', '.']).next().unwrap_or(name);
    let parameter = entry.parameters.iter().find(|parameter| parameter.name == base);
    let Some((parameter, (key, _))) = parameter.and_then(|p| Some((p, primitive.argument(p)?)))
    else {
        return Problem::new(error.to_string());
    };
    let message = match error {
        ShapeError::Number { rule, value, .. }
            if parameter.kind == ParameterKind::Angle && value.1 == Unit::Radian =>
        {
            format!("{key} must be {rule}, got {value} ({}°)", value.0.to_degrees())
        }
        _ => error.to_string(),
    };
    Problem::new(message).under(key)
}
