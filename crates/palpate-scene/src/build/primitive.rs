// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A primitive with its arguments.

use palpate_field::catalogue::Entry;
use palpate_field::kernel::{Argument, Parameter, ParameterKind};
use palpate_field::{Shape, ShapeError, Unit};
use serde_json::{Map, Value};

use super::object::check_description;
use crate::catalogue::{self, Signature, file_key};
use crate::json::{self, found};
use crate::keys::DESCRIPTION;
use crate::names::{nearest, shortened, unknown};
use crate::problem::{Problem, Problems};
use crate::scene::Dimension;
use crate::{advice, pose};

/// Makes the primitive called `name`; its weight is the number of nodes it counts as.
pub(super) fn primitive<const D: usize>(
    name: &str,
    arguments: &Value,
) -> Result<(Shape<D>, usize), Problems> {
    read(name, arguments).map_err(|problems| problems.under(name))
}

fn read<const D: usize>(name: &str, arguments: &Value) -> Result<(Shape<D>, usize), Problems> {
    let Value::Object(given) = arguments else {
        return Err(no_object::<D>(name, arguments).into());
    };
    let candidates = catalogue::named(name);
    let here = candidates.iter().find(|signature| signature.dimension.count() == D);
    let other = candidates.iter().find(|signature| signature.dimension.count() != D);
    let Some((entry, signature)) = Entry::<D>::find(name).zip(here) else {
        let there = other.map_or(Dimension::Two, |signature| signature.dimension);
        let message = format!("`{name}` is a {there} shape, this place is {D}D");
        return Err(Problem::new(message).of_dimension().into());
    };
    let mut wrong = Problems::default();
    wrong.kept(check_description(given));
    let meant = meant(given, signature, other, &mut wrong);
    let mut arguments = Vec::with_capacity(signature.parameters.len());
    for parameter in signature.parameters {
        let key = file_key(parameter);
        let value = match wrong.kept(given_for(given, parameter)) {
            Some(Some(value)) => value,
            Some(None) if !meant.iter().any(|slip| *slip == key) => {
                wrong.add(missing(parameter, other));
                continue;
            }
            _ => continue,
        };
        arguments.extend(wrong.kept(argument::<D>(parameter, value)));
    }
    if let Some(alias) = signature.alias {
        arguments = alias.arguments(arguments);
    }
    let built = if wrong.is_failed() {
        Err(Problems::told())
    } else {
        entry.build(&arguments).map_err(|error| refused(entry, given, error).into())
    };
    let shape = wrong.end(built)?;
    Ok((shape, arguments.iter().map(weight).sum::<usize>().max(1)))
}

/// The problem of arguments that are no object.
fn no_object<const D: usize>(name: &str, arguments: &Value) -> Problem {
    let dimension = if D == 2 { Dimension::Two } else { Dimension::Three };
    let such_as = advice::arguments(name, dimension)
        .map(|example| format!(", such as {example}"))
        .unwrap_or_default();
    let found = found(arguments);
    Problem::about(format!("must be an object with its parameters{such_as}, got {found}"))
}

/// The problem of a parameter that is not there; `other` is the primitive of that name in the
/// other dimension.
fn missing(parameter: &Parameter, other: Option<&Signature>) -> Problem {
    let key = file_key(parameter);
    let missing = Problem::missing(&key, parameter.about);
    let is_elsewhere_needless = other.is_some_and(|other| other.parameter(&key).is_none());
    if is_elsewhere_needless { missing.of_dimension() } else { missing }
}

/// Checks that the primitive has a parameter of each key, and returns the parameters that unknown
/// keys may be slips of; `other` is the primitive of that name in the other dimension.
fn meant(
    given: &Map<String, Value>,
    signature: &Signature,
    other: Option<&Signature>,
    wrong: &mut Problems,
) -> Vec<String> {
    let is_known = |key: &&String| *key == DESCRIPTION || signature.parameter(key).is_some();
    let known: Vec<_> = signature.parameters.iter().map(file_key).collect();
    let known: Vec<_> = known.iter().map(AsRef::as_ref).collect();
    let mut meant = Vec::new();
    for key in given.keys().filter(|key| !is_known(key)) {
        let problem = Problem::new(unknown_parameter(key, &known, signature)).under(key);
        let is_known_elsewhere = other.is_some_and(|other| other.parameter(key).is_some());
        wrong.add(if is_known_elsewhere { problem.of_dimension() } else { problem });
        meant.extend(nearest(key, &known).map(str::to_owned));
    }
    meant
}

/// What is wrong with a key that no parameter has: what may be meant, or what there is.
fn unknown_parameter(key: &str, known: &[&str], signature: &Signature) -> String {
    if nearest(key, known).is_some() {
        return unknown("key", key, known);
    }
    let (key, name) = (shortened(key), signature.name);
    let parameters = signature.parameters.iter().zip(known);
    let parameters =
        parameters.map(|(parameter, key)| format!("`{key}` ({})", parameter.about));
    let parameters: Vec<_> = parameters.collect();
    format!("unknown key `{key}`; `{name}` has {}", parameters.join(", "))
}

/// The key and value given for a parameter: for an angle in degrees, or in radians.
fn given_for<'a>(
    given: &'a Map<String, Value>,
    parameter: &Parameter,
) -> Result<Option<(&'a str, &'a Value)>, Problem> {
    let in_file = file_key(parameter);
    let degrees = given.get_key_value(&*in_file).filter(|_| in_file != parameter.name);
    match (degrees, given.get_key_value(parameter.name)) {
        (Some((degrees, _)), Some((radians, _))) => Err(Problem::new(format!(
            "`{degrees}` and `{radians}` say the same; give one of them"
        ))),
        (found, None) | (None, found) => Ok(found.map(|(key, value)| (key.as_str(), value))),
    }
}

/// Reads the argument of a parameter from its key and value; angles in degrees become radians.
fn argument<const D: usize>(
    parameter: &Parameter,
    (key, value): (&str, &Value),
) -> Result<Argument, Problems> {
    let argument =
        read_argument(parameter.kind, value).map_err(|problems| problems.under(key))?;
    check_dimension::<D>(&argument).map_err(|problem| problem.under(key))?;
    Ok(match argument {
        Argument::Number(degrees) if key != parameter.name => {
            Argument::Number(degrees.to_radians())
        }
        other => other,
    })
}

/// Reads an argument of a kind.
fn read_argument(kind: ParameterKind, value: &Value) -> Result<Argument, Problems> {
    match kind {
        ParameterKind::Count => json::read(value).map(Argument::Count),
        ParameterKind::Vector | ParameterKind::Direction => {
            json::read(value).map(Argument::Vector)
        }
        ParameterKind::Points => json::read(value).map(Argument::Points),
        ParameterKind::Rings => json::read(value).map(Argument::Rings),
        _ => json::read(value).map(Argument::Number),
    }
}

/// Checks that every position has as many numbers as there are dimensions.
fn check_dimension<const D: usize>(argument: &Argument) -> Result<(), Problem> {
    let check = |numbers: &Vec<f64>| pose::array::<D>(numbers).map(drop);
    let check_all = |points: &Vec<Vec<f64>>| {
        points.iter().enumerate().try_for_each(|(i, p)| check(p).map_err(|e| e.at(i)))
    };
    match argument {
        Argument::Number(_) | Argument::Count(_) => Ok(()),
        Argument::Vector(vector) => check(vector),
        Argument::Points(points) => check_all(points),
        Argument::Rings(rings) => {
            rings.iter().enumerate().try_for_each(|(i, r)| check_all(r).map_err(|e| e.at(i)))
        }
    }
}

/// How many nodes the argument is worth: one for each position of a list.
fn weight(argument: &Argument) -> usize {
    match argument {
        Argument::Points(points) => points.len(),
        Argument::Rings(rings) => rings.iter().map(Vec::len).sum(),
        _ => 0,
    }
}

/// What the kernel refuses, said with the keys of the file.
fn refused<const D: usize>(
    entry: &Entry<D>,
    given: &Map<String, Value>,
    error: ShapeError,
) -> Problem {
    let (ShapeError::Number { parameter: name, .. }
    | ShapeError::Count { parameter: name, .. }) = &error
    else {
        return Problem::of_shape(error);
    };
    // "points[2]" is about the parameter "points".
    let base = name.split(['[', '.']).next().unwrap_or(name);
    let parameter = entry.parameters.iter().find(|parameter| parameter.name == base);
    let in_file = |parameter| Some((parameter, given_for(given, parameter).ok()??));
    let Some((parameter, (key, _))) = parameter.and_then(in_file) else {
        return Problem::of_shape(error);
    };
    let in_degrees = match &error {
        ShapeError::Number { rule, value, .. }
            if parameter.kind == ParameterKind::Angle && value.1 == Unit::Radian =>
        {
            Some(format!("{key} must be {rule}, got {value} ({}°)", value.0.to_degrees()))
        }
        _ => None,
    };
    let problem = Problem::of_shape(error);
    match in_degrees {
        Some(message) => problem.saying(message),
        None => problem,
    }
    .under(key)
}
