// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a shape refuses, said with the keys of files.

use palpate_field::kernel::{Parameter, ParameterKind};
use palpate_field::{ShapeError, Unit};

use crate::catalogue::file_key;
use crate::problem::Problem;

/// The problem of an operator whose number is under `key`.
pub(super) fn of_operator(key: &str, error: &ShapeError) -> Problem {
    let problem = Problem::new(error.to_string());
    match error {
        ShapeError::Number { .. } => problem.under(key),
        _ => problem,
    }
}

/// The problem of a primitive with these parameters, seen from its arguments.
pub(super) fn of_primitive(parameters: &[Parameter], error: &ShapeError) -> Problem {
    let (ShapeError::Number { parameter: name, .. }
    | ShapeError::Count { parameter: name, .. }) = error
    else {
        return Problem::new(error.to_string());
    };
    // "points[2]" is about the parameter "points".
    let base = name.split(['[', '.']).next().unwrap_or(name);
    let Some(parameter) = parameters.iter().find(|parameter| parameter.name == base) else {
        return Problem::new(error.to_string());
    };
    let key = file_key(parameter);
    let message = match error {
        ShapeError::Number { rule, value, .. }
            if parameter.kind == ParameterKind::Angle && value.1 == Unit::Radian =>
        {
            format!("{key} must be {rule}, got {value} ({}°)", value.0.to_degrees())
        }
        _ => error.to_string(),
    };
    Problem::new(message).under(&key)
}
