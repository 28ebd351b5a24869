// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Follows references, once for each shape and dimension.

use std::collections::HashMap;

use palpate_field::Shape;
use serde_json::Value;

use super::object::Object;
use super::operator::refused;
use super::primitive::primitive;
use super::size::{Allowance, Size, check_depth};
use crate::json::found;
use crate::keys::{self, EXTRUDE, OF, REVOLVE};
use crate::pose::{Turning, Turns};
use crate::problem::{Problem, shortened, unknown};
use crate::scene::{Dimension, Scene};
use crate::shape::WrittenShape;

/// A shape and how large it is.
#[derive(Clone, Debug)]
pub(super) struct Built<const D: usize> {
    pub(super) shape: Shape<D>,
    pub(super) size: Size,
}

/// The named shapes of one dimension that are built already.
type Memory<'a, const D: usize> = HashMap<&'a str, Built<D>>;

/// Builds the shapes of a scene.
#[derive(Debug)]
pub(super) struct Builder<'a> {
    scene: &'a Scene,
    planar: Memory<'a, 2>,
    spatial: Memory<'a, 3>,
    /// The names of shapes under construction, outermost first, to find cycles.
    open: Vec<&'a str>,
    pub(super) allowance: Allowance,
}

/// What differs between the dimensions.
pub(super) trait Space<'a, const D: usize> {
    /// The dimension.
    const DIMENSION: Dimension;

    /// Its shapes.
    fn memory(&mut self) -> &mut Memory<'a, D>;

    /// A 2D shape extruded or revolved.
    fn solid(&mut self, object: Object<'a>, level: usize) -> Result<Built<D>, Problem>;

    /// A shape twisted by a `rate` [rad/m] that is given under `key`.
    fn twisted(shape: Shape<D>, key: &str, rate: f64) -> Result<Shape<D>, Problem>;
}

impl<'a> Builder<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            planar: HashMap::new(),
            spatial: HashMap::new(),
            open: Vec::new(),
            allowance: Allowance::new(),
        }
    }

    /// Builds the shape of a body or a tool.
    pub(super) fn shape<const D: usize>(
        &mut self,
        written: &'a WrittenShape,
    ) -> Result<Shape<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let built = self.node(written.json(), 0)?;
        Ok(built.shape)
    }

    /// Checks every named shape: those of a scene in space may be flat.
    pub(super) fn named_shapes<const D: usize>(&mut self) -> Result<(), Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        for name in self.scene.shapes.keys() {
            if name.is_empty() {
                return Err(Problem::new("a shape must have a name, got \"\"").under(name));
            }
            let Err(problem) = self.named::<D>(name, 0) else { continue };
            if D == 3 && problem.is_of_dimension() {
                match self.named::<2>(name, 0) {
                    Ok(_) => continue,
                    Err(flat) if !flat.is_of_dimension() => return Err(flat),
                    Err(_) => {}
                }
            }
            return Err(problem);
        }
        Ok(())
    }

    /// Builds the shape called `name`, or finds it built.
    fn named<const D: usize>(&mut self, name: &str, level: usize) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let Some((name, written)) = self.scene.shapes.get_key_value(name) else {
            let names: Vec<_> = self.scene.shapes.keys().map(String::as_str).collect();
            return Err(Problem::new(unknown("shape", name, &names)));
        };
        if let Some(built) = self.memory().get(name.as_str()) {
            return Ok(built.clone());
        }
        // A cycle may pass through extrusion, so the dimension does not matter.
        if let Some(first) = self.open.iter().position(|open| open == name) {
            let cycle = self.open.iter().skip(first).copied().chain([name.as_str()]);
            let cycle: Vec<_> = cycle.map(shortened).collect();
            let message =
                format!("shapes refer to each other in a cycle: {}", cycle.join(" → "));
            return Err(Problem::new(message));
        }
        self.open.push(name);
        let result = self.node(written.json(), level);
        self.open.pop();
        let built = result.map_err(|problem| problem.under(name).under("shapes").rooted())?;
        Space::<'a, D>::memory(self).insert(name, built.clone());
        Ok(built)
    }

    /// Builds the shape that a name refers to.
    fn reference<const D: usize>(
        &mut self,
        name: &str,
        level: usize,
    ) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let mut built = self.named::<D>(name, level).map_err(|problem| {
            if !problem.is_of_dimension() {
                return problem;
            }
            // Not wrong where it is written, but where it is used.
            let dimension = <Self as Space<'a, D>>::DIMENSION;
            let why = problem.message();
            let name = shortened(name);
            let message = format!("shape `{name}` cannot be used in {dimension}: {why}");
            Problem::new(message).of_dimension()
        })?;
        built.size.depth += 1;
        check_depth(level + built.size.depth)?;
        Ok(built)
    }

    /// Builds the shape of an object or a name.
    pub(super) fn node<const D: usize>(
        &mut self,
        node: &'a Value,
        level: usize,
    ) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        check_depth(level + 1)?;
        let level = level + 1;
        let entries = match node {
            Value::String(name) => return self.reference(name, level),
            Value::Object(entries) => entries,
            other => {
                let expected = "a shape: an object, or the name of another shape";
                let message = format!("must be {expected}, got {}", found(other));
                return Err(Problem::about(message));
            }
        };
        let object = Object::new(entries)?;
        match object.head {
            keys::SHAPE => match object.value(keys::SHAPE)? {
                Value::String(name) => self.reference(name, level),
                other => {
                    let message = format!("must be the name of a shape, got {}", found(other));
                    Err(Problem::about(message).under(keys::SHAPE))
                }
            },
            EXTRUDE | REVOLVE => self.solid(object, level),
            head if keys::is_one_of(&keys::UNARY, head) => self.unary(object, level),
            head if keys::is_one_of(&keys::LISTS, head) => self.list(object, level),
            name => {
                let (shape, nodes) = primitive(name, object.value(name)?)?;
                let size = Size { nodes, depth: 0 };
                self.allowance.take(size, level)?;
                Ok(Built { shape, size })
            }
        }
    }
}

impl<'a> Space<'a, 2> for Builder<'a> {
    const DIMENSION: Dimension = Dimension::Two;

    fn memory(&mut self) -> &mut Memory<'a, 2> {
        &mut self.planar
    }

    fn solid(&mut self, object: Object<'a>, _level: usize) -> Result<Built<2>, Problem> {
        let operator = object.head;
        let message = format!("`{operator}` makes a 3D shape, this place is 2D");
        Err(Problem::new(message).of_dimension())
    }

    fn twisted(_shape: Shape<2>, key: &str, _rate: f64) -> Result<Shape<2>, Problem> {
        let message = format!("`{key}` twists a 3D shape, this place is 2D");
        Err(Problem::new(message).of_dimension())
    }
}

impl<'a> Space<'a, 3> for Builder<'a> {
    const DIMENSION: Dimension = Dimension::Three;

    fn memory(&mut self) -> &mut Memory<'a, 3> {
        &mut self.spatial
    }

    fn solid(&mut self, object: Object<'a>, level: usize) -> Result<Built<3>, Problem> {
        let flat: Built<2> = self.node(object.value(OF)?, level).map_err(|problem| {
            // The place of a flat shape is 2D wherever the whole is used.
            problem.in_any_dimension().under(OF)
        })?;
        let size = Size::over(&[flat.size]);
        self.allowance.take(size, level)?;
        let shape = if object.head == EXTRUDE {
            flat.shape.extruded(object.read(EXTRUDE)?)
        } else {
            object.word(REVOLVE, &["y"])?;
            flat.shape.revolved()
        };
        let shape = shape.map_err(|error| refused(object.head, error))?;
        Ok(Built { shape, size })
    }

    fn twisted(shape: Shape<3>, key: &str, rate: f64) -> Result<Shape<3>, Problem> {
        shape.twisted(rate).map_err(|error| refused(key, error))
    }
}
