// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Follows references, once for each shape and dimension.

use std::collections::HashMap;

use palpate_field::Shape;

use super::shape_error;
use super::size::{Allowance, Size, check_depth};
use crate::angle::Angle;
use crate::node::Node;
use crate::node::operators::{EXTRUDE, OF, REVOLVE, TWIST, TWIST_DEGREES};
use crate::pose::{Turning, Turns};
use crate::problem::{Problem, shortened, unknown};
use crate::scene::{Dimension, Scene};

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

    /// A 2D shape with a height along y [m], or turned about y without one.
    fn solid(
        &mut self,
        of: &'a Node,
        height: Option<f64>,
        level: usize,
    ) -> Result<Built<D>, Problem>;

    /// A shape twisted by a `rate` for each metre.
    fn twisted(shape: Shape<D>, rate: Angle) -> Result<Shape<D>, Problem>;
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
    pub(super) fn shape<const D: usize>(&mut self, node: &'a Node) -> Result<Shape<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let built = self.node(node, 0)?;
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
        let Some((name, node)) = self.scene.shapes.get_key_value(name) else {
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
        let result = self.node(node, level);
        self.open.pop();
        let built = result.map_err(|problem| problem.under(name).under("shapes").rooted())?;
        Space::<'a, D>::memory(self).insert(name, built.clone());
        Ok(built)
    }

    /// Builds the shape that a node refers to.
    pub(super) fn reference<const D: usize>(
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

    /// Builds a node.
    pub(super) fn node<const D: usize>(
        &mut self,
        node: &'a Node,
        level: usize,
    ) -> Result<Built<D>, Problem>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        check_depth(level + 1)?;
        self.form(&node.form, level + 1)
    }
}

impl<'a> Space<'a, 2> for Builder<'a> {
    const DIMENSION: Dimension = Dimension::Two;

    fn memory(&mut self) -> &mut Memory<'a, 2> {
        &mut self.planar
    }

    fn solid(
        &mut self,
        _of: &'a Node,
        height: Option<f64>,
        _level: usize,
    ) -> Result<Built<2>, Problem> {
        let operator = if height.is_some() { EXTRUDE } else { REVOLVE };
        let message = format!("`{operator}` makes a 3D shape, this place is 2D");
        Err(Problem::new(message).of_dimension())
    }

    fn twisted(_shape: Shape<2>, rate: Angle) -> Result<Shape<2>, Problem> {
        let key = rate.key(TWIST_DEGREES, TWIST);
        let message = format!("`{key}` twists a 3D shape, this place is 2D");
        Err(Problem::new(message).of_dimension())
    }
}

impl<'a> Space<'a, 3> for Builder<'a> {
    const DIMENSION: Dimension = Dimension::Three;

    fn memory(&mut self) -> &mut Memory<'a, 3> {
        &mut self.spatial
    }

    fn solid(
        &mut self,
        of: &'a Node,
        height: Option<f64>,
        level: usize,
    ) -> Result<Built<3>, Problem> {
        let flat: Built<2> = self.node(of, level).map_err(|problem| {
            // The place of a flat shape is 2D wherever the whole is used.
            problem.in_any_dimension().under(OF)
        })?;
        let size = Size::over(&[flat.size]);
        self.allowance.take(size, level)?;
        let (shape, key) = match height {
            Some(height) => (flat.shape.extruded(height), EXTRUDE),
            None => (flat.shape.revolved(), REVOLVE),
        };
        let shape = shape.map_err(|error| shape_error::of_operator(key, &error))?;
        Ok(Built { shape, size })
    }

    fn twisted(shape: Shape<3>, rate: Angle) -> Result<Shape<3>, Problem> {
        let key = rate.key(TWIST_DEGREES, TWIST);
        shape.twisted(rate.radians()).map_err(|error| shape_error::of_operator(key, &error))
    }
}
