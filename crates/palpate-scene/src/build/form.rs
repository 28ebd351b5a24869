// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One node at a time: from its form to a shape.

use palpate_field::Shape;
use palpate_field::catalogue::Entry;
use palpate_field::kernel::Argument;
use palpate_field::operator::{Boolean, Copies, Profile};

use super::builder::{Builder, Built, Space};
use super::shape_error;
use super::size::Size;
use crate::catalogue::{self, file_key};
use crate::node::operators as keys;
use crate::node::{Axis, Factor, Form, Primitive, Row, Rows};
use crate::pose::{self, Turning, Turns};
use crate::problem::{Problem, unknown};

impl<'a> Builder<'a> {
    /// Builds a form, whose node is `level` deep.
    pub(super) fn form<const D: usize>(
        &mut self,
        form: &'a Form,
        level: usize,
    ) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        match form {
            Form::Reference(name) => self.reference(name, level),
            Form::Primitive(primitive) => self.primitive(primitive, level),
            Form::Union(_)
            | Form::Intersection(_)
            | Form::Difference(_)
            | Form::SymmetricDifference(_)
            | Form::Smooth { .. }
            | Form::Displaced { .. }
            | Form::Morphed { .. } => self.list(form, level),
            Form::Extruded { height, of } => self.solid(of, Some(*height), level),
            Form::Revolved { of } => self.solid(of, None, level),
            _ => self.unary(form, level),
        }
    }

    fn primitive<const D: usize>(
        &mut self,
        primitive: &Primitive,
        level: usize,
    ) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
    {
        let name = primitive.name.as_str();
        let Some(entry) = Entry::<D>::find(name) else {
            let here = Self::DIMENSION;
            let problem = match catalogue::named(name).first() {
                Some(other) => Problem::new(format!(
                    "`{name}` is a {} shape, this place is {here}",
                    other.dimension
                ))
                .of_dimension(),
                None => {
                    let names: Vec<_> = Entry::<D>::all().iter().map(|e| e.name).collect();
                    Problem::new(unknown("primitive", name, &names))
                }
            };
            return Err(problem.under(name));
        };
        let mut arguments = Vec::with_capacity(entry.parameters.len());
        for parameter in entry.parameters {
            let Some((key, argument)) = primitive.argument(parameter) else {
                let key = file_key(parameter);
                let missing = Problem::new(format!("missing key `{key}`: {}", parameter.about));
                return Err(missing.under(name));
            };
            check_dimension::<D>(argument).map_err(|problem| problem.under(key).under(name))?;
            arguments.push(match argument {
                Argument::Number(degrees) if key != parameter.name => {
                    Argument::Number(degrees.to_radians())
                }
                other => other.clone(),
            });
        }
        let size = Size { nodes: arguments.iter().map(weight).sum::<usize>().max(1), depth: 0 };
        self.allowance.take(size, level)?;
        let shape = entry
            .build(&arguments)
            .map_err(|error| shape_error::of_primitive(entry, primitive, &error).under(name))?;
        Ok(Built { shape, size })
    }

    fn list<const D: usize>(
        &mut self,
        form: &'a Form,
        level: usize,
    ) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let (key, nodes) = form.operands();
        let mut shapes = Vec::with_capacity(nodes.len());
        let mut sizes = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            let built = self.node(node, level).map_err(|problem| problem.at(i).under(key))?;
            shapes.push(built.shape);
            sizes.push(built.size);
        }
        if shapes.is_empty() {
            let message = format!("{key} must have at least 1 shape, got 0");
            return Err(Problem::new(message).under(key));
        }
        let size = Size::over(&sizes);
        self.allowance.take(size, level)?;
        let shape = match form {
            Form::Union(_) => Shape::union(shapes),
            Form::Intersection(_) => Shape::intersection(shapes),
            Form::SymmetricDifference(_) => Shape::symmetric_difference(shapes),
            Form::Smooth { boolean, width, profile, .. } => {
                let profile = profile.unwrap_or(Profile::Quadratic);
                match boolean {
                    Boolean::Union => Shape::smooth_union(shapes, profile, *width),
                    Boolean::Intersection => {
                        Shape::smooth_intersection(shapes, profile, *width)
                    }
                    Boolean::Difference => {
                        let first = shapes.remove(0);
                        first.smooth_difference(shapes, profile, *width)
                    }
                }
            }
            Form::Displaced { height, .. } => {
                let [what, by] = two(shapes, key)?;
                what.displaced(by, *height)
            }
            Form::Morphed { progress, .. } => {
                let [from, into] = two(shapes, key)?;
                from.morphed(into, *progress)
            }
            _ => {
                let first = shapes.remove(0);
                first.difference(shapes)
            }
        };
        let number = match form {
            Form::Displaced { .. } => keys::HEIGHT,
            Form::Morphed { .. } => keys::PROGRESS,
            _ => keys::WIDTH,
        };
        let shape = shape.map_err(|error| shape_error::of_operator(number, &error))?;
        Ok(Built { shape, size })
    }

    /// The operators that have one operand and keep its dimension.
    fn unary<const D: usize>(
        &mut self,
        form: &'a Form,
        level: usize,
    ) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let (_, operands) = form.operands();
        let [of] = operands else {
            return Err(Problem::new("an operator without its shape"));
        };
        let child: Built<D> =
            self.node(of, level).map_err(|problem| problem.under(keys::OF))?;
        let size = match form {
            Form::Repeated { .. } => Size::over(&[child.size.repeated(D as u32)]),
            _ => Size::over(&[child.size]),
        };
        self.allowance.take(size, level)?;
        let child = child.shape;
        let (key, result) = match form {
            Form::Placed { translate, rotation, .. } => {
                if translate.is_none() && rotation.is_none() {
                    return Err(Problem::new("missing the translation or rotation"));
                }
                let motion =
                    pose::pose((keys::TRANSLATE, translate.as_deref()), rotation.as_ref())?;
                (keys::TRANSLATE, child.placed(&motion))
            }
            Form::Scaled { factor: Factor::Uniform(factor), .. } => {
                (keys::SCALE, child.scaled(*factor))
            }
            Form::Scaled { factor: Factor::Axes(factors), .. } => (
                keys::SCALE,
                child.stretched(
                    pose::array(factors).map_err(|problem| problem.under(keys::SCALE))?,
                ),
            ),
            Form::Offset { distance, .. } => (keys::OFFSET, child.offset(*distance)),
            Form::Shell { thickness, .. } => (keys::SHELL, child.shell(*thickness)),
            Form::Elongated { lengths, .. } => (
                keys::ELONGATE,
                child.elongated(
                    pose::array(lengths).map_err(|problem| problem.under(keys::ELONGATE))?,
                ),
            ),
            Form::Mirrored { axis: Axis::Z, .. } if D == 2 => {
                let message = "there is no z in 2D: mirror \"x\" or \"y\"";
                return Err(Problem::new(message).of_dimension().under(keys::MIRROR));
            }
            Form::Mirrored { axis, .. } => (keys::MIRROR, child.mirrored(*axis as usize)),
            Form::Repeated { rows, .. } => (keys::REPEAT, child.repeated(copies(rows)?)),
            Form::Twisted { rate, .. } => {
                let shape = Self::twisted(child, *rate)?;
                return Ok(Built { shape, size });
            }
            Form::Bent { rate, .. } => {
                (rate.key(keys::BEND_DEGREES, keys::BEND), child.bent(rate.radians()))
            }
            _ => return Err(Problem::new("an operator on one shape")),
        };
        let shape = result.map_err(|error| shape_error::of_operator(key, &error))?;
        Ok(Built { shape, size })
    }
}

/// The two shapes of a list.
fn two<const D: usize>(shapes: Vec<Shape<D>>, key: &str) -> Result<[Shape<D>; 2], Problem> {
    let count = shapes.len();
    shapes
        .try_into()
        .map_err(|_| Problem::new(format!("{key} must have 2 shapes, got {count}")).under(key))
}

/// The copies along each axis.
fn copies<const D: usize>(rows: &Rows) -> Result<[Copies; D], Problem> {
    let axes = [("x", rows.x), ("y", rows.y), ("z", rows.z)];
    if D == 2 && rows.z.is_some() {
        let problem = Problem::new("there is no z in 2D: repeat along x or y");
        return Err(problem.of_dimension().under("z").under(keys::REPEAT));
    }
    if axes.iter().all(|(_, row)| row.is_none()) {
        let problem = Problem::new("repeat must have a row along at least one axis");
        return Err(problem.under(keys::REPEAT));
    }
    let mut copies = [Copies::One; D];
    for (copies, (axis, row)) in copies.iter_mut().zip(axes) {
        *copies = match row {
            None | Some(Row { spacing: None, first: Some(0), last: Some(0) }) => Copies::One,
            Some(Row { spacing: None, .. }) => {
                let problem = Problem::new("missing key `spacing`");
                return Err(problem.under(axis).under(keys::REPEAT));
            }
            Some(Row { spacing: Some(spacing), first: None, last: None }) => {
                Copies::Endless { spacing }
            }
            Some(Row { spacing: Some(spacing), first: Some(first), last: Some(last) }) => {
                Copies::Between { spacing, first, last }
            }
            Some(_) => {
                let problem = Problem::new("first and last go together");
                return Err(problem.under(axis).under(keys::REPEAT));
            }
        };
    }
    Ok(copies)
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
