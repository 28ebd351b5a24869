// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An operator with its numbers and the shapes it is applied to.

use palpate_field::kernel::Argument;
use palpate_field::operator::{Copies, Operator, Profile};
use palpate_field::{Node, Shape, ShapeError};
use serde::Deserialize;
use serde_json::Value;

use super::builder::{Builder, Built, Space};
use super::object::{Object, Size};
use crate::grids::WrittenBake;
use crate::json::{self, found};
use crate::keys;
use crate::pose::{self, Turning, Turns};
use crate::problem::{Problem, Problems};

/// The problem of an operator whose number is under `key`.
pub(super) fn refused(key: &str, error: ShapeError) -> Problem {
    let is_of_number = matches!(error, ShapeError::Number { .. });
    let problem = Problem::of_shape(error);
    if is_of_number { problem.under(key) } else { problem }
}

/// What an operator makes of an operand. For one with problems something else stands in, so
/// that the operator's own numbers are read; what a shape finds wrong with them is not told then.
pub(super) fn over<const D: usize, T>(
    operand: Result<Built<D>, Problems>,
    make: impl FnOnce(Built<D>) -> Result<T, Problems>,
) -> Result<T, Problems> {
    match operand {
        Ok(operand) => make(operand),
        Err(problems) => {
            let made = make(Built::stand_in()?);
            problems.end(made.map_err(Problems::of_the_text))
        }
    }
}

impl<'a> Builder<'a> {
    /// The operators on a list of shapes.
    pub(super) fn list<const D: usize>(
        &mut self,
        object: &Object<'a>,
        level: usize,
    ) -> Result<Built<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let key = object.head;
        let operands = object.value(key)?;
        let Value::Array(operands) = operands else {
            let message = format!("must be a list, got {}", found(operands));
            return Err(Problem::about(message).under(key).into());
        };
        if operands.is_empty() {
            let message = format!("{key} must have at least 1 shape, got 0");
            return Err(Problem::new(message).under(key).into());
        }
        let mut wrong = Problems::default();
        let mut built = Vec::with_capacity(operands.len());
        for (i, operand) in operands.iter().enumerate() {
            let operand = self.node(operand, level).map_err(|p| p.at(i).under(key));
            built.push(match wrong.kept(operand) {
                Some(operand) => operand,
                None if wrong.is_full() => return Err(wrong),
                None => Built::stand_in()?,
            });
        }
        let made = self.combined(object, built, level);
        let made = if wrong.is_failed() { made.map_err(Problems::of_the_text) } else { made };
        wrong.end(made)
    }

    /// What an operator makes of a list of shapes.
    fn combined<const D: usize>(
        &mut self,
        object: &Object<'a>,
        built: Vec<Built<D>>,
        level: usize,
    ) -> Result<Built<D>, Problems> {
        let key = object.head;
        let (mut shapes, sizes): (Vec<_>, Vec<_>) =
            built.into_iter().map(|built| (built.shape, built.size)).unzip();
        let size = Size::over(&sizes);
        self.allowance.take(size, level)?;
        let (shape, number) = match key {
            keys::UNION => (Shape::union(shapes), key),
            keys::INTERSECTION => (Shape::intersection(shapes), key),
            keys::DIFFERENCE => (shapes.remove(0).difference(shapes), key),
            keys::SYMMETRIC_DIFFERENCE => (Shape::symmetric_difference(shapes), key),
            keys::DISPLACE => {
                let [what, by] = two(shapes, key)?;
                (what.displaced(by, object.read(keys::HEIGHT)?), keys::HEIGHT)
            }
            keys::MORPH => {
                let [from, into] = two(shapes, key)?;
                (from.morphed(into, object.read(keys::PROGRESS)?), keys::PROGRESS)
            }
            _ => {
                let (width, profile) =
                    Problems::both(object.read(keys::WIDTH), profile(object))?;
                let shape = match key {
                    keys::SMOOTH_UNION => Shape::smooth_union(shapes, profile, width),
                    keys::SMOOTH_INTERSECTION => {
                        Shape::smooth_intersection(shapes, profile, width)
                    }
                    _ => shapes.remove(0).smooth_difference(shapes, profile, width),
                };
                (shape, keys::WIDTH)
            }
        };
        let shape = shape.map_err(|error| refused(number, error))?;
        Ok(Built { shape, size })
    }

    /// The operators on one shape that keep its dimension.
    pub(super) fn unary<const D: usize>(
        &mut self,
        object: &Object<'a>,
        level: usize,
    ) -> Result<Built<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let child = self.operand(object, level);
        if object.head == keys::BAKE && child.is_err() {
            // What stands in for the operand may have another size, so it is not baked.
            return over(child, |child| {
                object
                    .read::<WrittenBake>(keys::BAKE)?
                    .check()
                    .map_err(|p| p.under(keys::BAKE))?;
                Ok(child)
            });
        }
        over(child, |child| {
            let size = match object.head {
                keys::REPEAT => Size::over(&[child.size.repeated(D as u32)]),
                _ => Size::over(&[child.size]),
            };
            self.allowance.take(size, level)?;
            Ok(Built { shape: self.applied(object, child.shape)?, size })
        })
    }

    /// What an operator makes of one shape.
    fn applied<const D: usize>(
        &self,
        object: &Object<'a>,
        child: Shape<D>,
    ) -> Result<Shape<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let key = object.head;
        if let Some(operator) = Operator::find(key) {
            let argument = if operator.is_per_axis {
                Argument::Vector(vector::<D>(object)?.to_vec())
            } else {
                Argument::Number(object.read(key)?)
            };
            let shape = Shape::from_node(Node::Operated { operator, argument, of: child });
            return shape.map_err(|error| refused(key, error).into());
        }
        let shape = match key {
            keys::SCALE => match object.value(key)? {
                Value::Number(_) => child.scaled(object.read(key)?),
                Value::Array(_) => child.stretched(vector(object)?),
                other => {
                    let found = found(other);
                    let message = format!(
                        "must be a number, or a list with one for each axis, got {found}"
                    );
                    return Err(Problem::about(message).under(key).into());
                }
            },
            keys::OFFSET => child.offset(object.read(key)?),
            keys::MIRROR => {
                let axis = object.word(key, &keys::AXES)?;
                if axis >= D {
                    let message = "there is no z in 2D: mirror \"x\" or \"y\"";
                    return Err(Problem::new(message).of_dimension().under(key).into());
                }
                child.mirrored(axis)
            }
            keys::REPEAT => {
                let copies =
                    copies(object.value(key)?).map_err(|problem| problem.under(key))?;
                child.repeated(copies)
            }
            keys::BEND => child.bent(object.read(key)?),
            keys::BEND_DEGREES => child.bent(object.read::<f64>(key)?.to_radians()),
            keys::TWIST | keys::TWIST_DEGREES => {
                let rate: f64 = object.read(key)?;
                let is_degrees = key == keys::TWIST_DEGREES;
                let rate = if is_degrees { rate.to_radians() } else { rate };
                return Self::twisted(child, key, rate);
            }
            keys::BAKE => {
                let written: WrittenBake = object.read(key)?;
                return written
                    .baked(child, Self::grids(), &self.scene.resources)
                    .map_err(|problem| problem.under(key).into());
            }
            _ => {
                let (degrees, rows) = Problems::both(
                    object.read_if(keys::ROTATE_DEGREES),
                    object.read_if(keys::ROTATION),
                )?;
                let rotation = pose::one_rotation(degrees, rows).map_err(Problem::new);
                let (translation, rotation) =
                    Problems::both(object.read_if::<Vec<f64>>(keys::TRANSLATE), rotation)?;
                let translation = (keys::TRANSLATE, translation.as_deref());
                child.placed(&pose::pose(translation, rotation.as_ref())?)
            }
        };
        let number = if keys::MOVES.contains(&key) { keys::TRANSLATE } else { key };
        shape.map_err(|error| refused(number, error).into())
    }
}

/// The two shapes of a list.
fn two<const D: usize>(shapes: Vec<Shape<D>>, key: &str) -> Result<[Shape<D>; 2], Problem> {
    let count = shapes.len();
    let message = || format!("{key} must have 2 shapes, got {count}");
    shapes.try_into().map_err(|_| Problem::new(message()).under(key))
}

/// The profile of a smooth boolean; quadratic if left out.
fn profile(object: &Object<'_>) -> Result<Profile, Problems> {
    if !object.has(keys::PROFILE) {
        return Ok(Profile::Quadratic);
    }
    let place = object.word(keys::PROFILE, &Profile::ALL.map(Profile::name))?;
    Ok(Profile::ALL[place])
}

/// One number for each axis, under the key of the operator.
fn vector<const D: usize>(object: &Object<'_>) -> Result<[f64; D], Problems> {
    let numbers: Vec<f64> = object.read(object.head)?;
    pose::array(&numbers).map_err(|problem| problem.under(object.head).into())
}

/// Rows of copies, along the axes that have one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct Rows {
    x: Option<Row>,
    y: Option<Row>,
    z: Option<Row>,
}

/// A row of copies: between two numbers, or without end. The shape itself is number 0. A row from
/// 0 to 0 without a spacing is the shape alone, as along an axis without a row.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct Row {
    spacing: Option<f64>,
    first: Option<i32>,
    last: Option<i32>,
}

/// The copies along each axis; a problem seen from `rows`.
fn copies<const D: usize>(rows: &Value) -> Result<[Copies; D], Problems> {
    let rows: Rows = json::read(rows)?;
    if D == 2 && rows.z.is_some() {
        let problem = Problem::new("there is no z in 2D: repeat along x or y");
        return Err(problem.of_dimension().under("z").into());
    }
    let axes = [("x", rows.x), ("y", rows.y), ("z", rows.z)];
    if axes.iter().all(|(_, row)| row.is_none()) {
        let message = "repeat must have a row along at least one axis";
        return Err(Problem::new(message).into());
    }
    let mut copies = [Copies::One; D];
    for (copies, (axis, row)) in copies.iter_mut().zip(axes) {
        *copies = match row {
            None | Some(Row { spacing: None, first: Some(0), last: Some(0) }) => Copies::One,
            Some(Row { spacing: None, .. }) => {
                return Err(Problem::missing("spacing", "").under(axis).into());
            }
            Some(Row { spacing: Some(spacing), first: None, last: None }) => {
                Copies::Endless { spacing }
            }
            Some(Row { spacing: Some(spacing), first: Some(first), last: Some(last) }) => {
                Copies::Between { spacing, first, last }
            }
            Some(_) => {
                return Err(Problem::new("first and last go together").under(axis).into());
            }
        };
    }
    Ok(copies)
}
