// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One node at a time: from its form to a shape.

use palpate_field::Shape;
use palpate_field::kernel::Argument;
use palpate_field::operator::Smooth;

use super::builder::{Builder, Built, Space};
use super::shape_error;
use super::size::Size;
use crate::catalogue::{self, file_key};
use crate::node::operators as keys;
use crate::node::{Axis, Factor, Form, Primitive, Profile};
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
            | Form::SmoothUnion { .. } => self.list(form, level),
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
        let Some(entry) = Self::catalogue().iter().find(|entry| entry.name == name) else {
            let here = Self::DIMENSION;
            let problem = match catalogue::named(name).first() {
                Some(other) => Problem::new(format!(
                    "`{name}` is a {} shape, this place is {here}",
                    other.dimension
                ))
                .of_dimension(),
                None => {
                    let names: Vec<_> = Self::catalogue().iter().map(|e| e.name).collect();
                    Problem::new(unknown("primitive", name, &names))
                }
            };
            return Err(problem.under(name));
        };
        let mut arguments = Vec::with_capacity(entry.parameters.len());
        for parameter in entry.parameters {
            let key = file_key(parameter);
            let Some(argument) = primitive.arguments.get(&*key) else {
                let missing = Problem::new(format!("missing key `{key}`: {}", parameter.about));
                return Err(missing.under(name));
            };
            check_dimension::<D>(argument)
                .map_err(|problem| problem.under(&key).under(name))?;
            arguments.push(match argument {
                Argument::Number(degrees) if *key != *parameter.name => {
                    Argument::Number(degrees.to_radians())
                }
                other => other.clone(),
            });
        }
        let size = Size { nodes: arguments.iter().map(weight).sum::<usize>().max(1), depth: 0 };
        self.allowance.take(size, level)?;
        let shape = entry
            .build(&arguments)
            .map_err(|error| shape_error::of_primitive(entry.parameters, &error).under(name))?;
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
            Form::SmoothUnion { width, profile, .. } => {
                let profile = profile.unwrap_or(Profile::Quadratic);
                Shape::smooth_union(shapes, Smooth::from(profile), *width)
            }
            _ => {
                let first = shapes.remove(0);
                first.difference(shapes)
            }
        };
        let shape = shape.map_err(|error| shape_error::of_operator(keys::WIDTH, &error))?;
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
        let size = Size::over(&[child.size]);
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
            _ => return Err(Problem::new("an operator on one shape")),
        };
        let shape = result.map_err(|error| shape_error::of_operator(key, &error))?;
        Ok(Built { shape, size })
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
