// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Follows references, once for each shape and dimension.

use std::collections::HashMap;

use palpate_field::Shape;
use serde_json::Value;

use super::object::{Allowance, Object, Size};
use super::operator::{over, refused};
use super::primitive::primitive;
use crate::advice;
use crate::grids::{KeptGrids, PLANAR, SPATIAL, WrittenGrid};
use crate::json::{self, found};
use crate::keys::{self, EXTRUDE, GRID, MESH, OF, REVOLVE, VOLUME};
use crate::mesh_file::{BuiltMesh, WrittenMesh, WrittenVolume};
use crate::names::shortened;
use crate::pose::{Turning, Turns};
use crate::problem::{Problem, Problems};
use crate::scene::{Dimension, Scene};
use crate::shape::WrittenShape;

/// A shape and how large it is.
#[derive(Clone, Debug)]
pub(super) struct Built<const D: usize> {
    pub(super) shape: Shape<D>,
    pub(super) size: Size,
}

/// The named shapes of one dimension that were tried already.
type Memory<'a, const D: usize> = HashMap<&'a str, Result<Built<D>, Problems>>;

/// Builds the shapes of a scene.
#[derive(Debug)]
pub(super) struct Builder<'a> {
    pub(super) scene: &'a Scene,
    planar: Memory<'a, 2>,
    spatial: Memory<'a, 3>,
    /// The names of shapes under construction, outermost first, to find cycles.
    open: Vec<&'a str>,
    pub(super) allowance: Allowance,
    /// The meshes that were read, each file and scale once.
    pub(super) meshes: Vec<BuiltMesh>,
}

/// What differs between the dimensions.
pub(super) trait Space<'a, const D: usize> {
    /// The dimension.
    const DIMENSION: Dimension;

    /// Its shapes.
    fn memory(&mut self) -> &mut Memory<'a, D>;

    /// A 2D shape extruded or revolved.
    fn solid(&mut self, object: Object<'a>, level: usize) -> Result<Built<D>, Problems>;

    /// The solid of a mesh file, or of a surface in a volume.
    fn mesh(&mut self, object: &Object<'a>, level: usize) -> Result<Built<D>, Problems>;

    /// The grids of its shapes that are kept.
    fn grids() -> &'static KeptGrids<D>;

    /// A shape twisted by a `rate` [rad/m] that is given under `key`.
    fn twisted(shape: Shape<D>, key: &str, rate: f64) -> Result<Shape<D>, Problems>;
}

impl<'a> Builder<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            planar: HashMap::new(),
            spatial: HashMap::new(),
            open: Vec::new(),
            allowance: Allowance::of(scene.resources.most_nodes),
            meshes: Vec::new(),
        }
    }

    /// Builds the shape of a body or a tool.
    pub(super) fn shape<const D: usize>(
        &mut self,
        written: &'a WrittenShape,
    ) -> Result<Shape<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let built = self.node(written.json(), 0)?;
        Ok(built.shape)
    }

    /// Checks every named shape: those of a scene in space may be flat.
    pub(super) fn named_shapes<const D: usize>(&mut self) -> Result<(), Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let mut wrong = Problems::default();
        for name in self.scene.shapes.keys() {
            if name.is_empty() {
                wrong.add(Problem::new("a shape must have a name, got \"\"").under(name));
                continue;
            }
            let Err(problems) = self.named::<D>(name, 0) else { continue };
            let is_flat = |flat: &Result<Built<2>, Problems>| match flat {
                Ok(_) => true,
                Err(problems) => problems.of_dimension().is_none(),
            };
            let flat = (D == 3 && problems.of_dimension().is_some())
                .then(|| self.named::<2>(name, 0))
                .filter(is_flat);
            match flat {
                None => wrong.add(problems.under(name)),
                Some(Ok(_)) => {}
                Some(Err(problems)) => wrong.add(problems.under(name)),
            }
        }
        wrong.end(Ok(()))
    }

    /// Builds the shape called `name`, or finds it built; problems are seen from the shape.
    fn named<const D: usize>(
        &mut self,
        name: &'a str,
        level: usize,
    ) -> Result<Built<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        if let Some(built) = self.memory().get(name) {
            return built.clone();
        }
        let Some(written) = self.scene.shapes.get(name) else { return Err(Problems::told()) };
        self.open.push(name);
        let built = self.node(written.json(), level);
        self.open.pop();
        Space::<'a, D>::memory(self).insert(name, built.clone());
        built
    }

    /// Builds the shape that a name refers to. Its own problems are told by
    /// [`named_shapes`](Self::named_shapes).
    fn reference<const D: usize>(
        &mut self,
        name: &str,
        level: usize,
    ) -> Result<Built<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let Some((name, _)) = self.scene.shapes.get_key_value(name) else {
            let names: Vec<_> = self.scene.shapes.keys().map(String::as_str).collect();
            let dimension = <Self as Space<'a, D>>::DIMENSION;
            let message = advice::unknown_shape(name, &names, dimension);
            return Err(Problem::new(message).into());
        };
        // A cycle may pass through extrusion, so the dimension does not matter.
        if let Some(first) = self.open.iter().position(|open| open == name) {
            let cycle = self.open.iter().skip(first).copied().chain([name.as_str()]);
            let cycle: Vec<_> = cycle.map(shortened).collect();
            let message =
                format!("shapes refer to each other in a cycle: {}", cycle.join(" → "));
            return Err(Problem::new(message).into());
        }
        let mut built =
            self.named::<D>(name, level).map_err(|problems| match problems.of_dimension() {
                Some(problem) if self.has_dimension(name, level) => {
                    // Not wrong where it is written, but where it is used.
                    let dimension = <Self as Space<'a, D>>::DIMENSION;
                    let (name, why) = (shortened(name), problem.message());
                    let message =
                        format!("shape `{name}` cannot be used in {dimension}: {why}");
                    Problem::new(message).of_dimension().into()
                }
                _ => Problems::told(),
            })?;
        built.size.depth += 1;
        self.allowance.check_depth(level + built.size.depth)?;
        Ok(built)
    }

    /// `true` if the shape called `name` may be of one of the dimensions.
    fn has_dimension(&mut self, name: &'a str, level: usize) -> bool {
        let may_be = |problems: Option<Problems>| {
            problems.is_none_or(|problems| problems.of_dimension().is_none())
        };
        may_be(self.named::<2>(name, level).err()) || may_be(self.named::<3>(name, level).err())
    }

    /// Builds the shape of an object or a name.
    pub(super) fn node<const D: usize>(
        &mut self,
        node: &'a Value,
        level: usize,
    ) -> Result<Built<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let level = level + 1;
        self.allowance.check_depth(level)?;
        let entries = match node {
            Value::String(name) => return self.reference(name, level),
            Value::Object(entries) => entries,
            other => {
                let expected = "a shape: an object, or the name of another shape";
                let message = format!("must be {expected}, got {}", found(other));
                return Err(Problem::about(message).into());
            }
        };
        let mut wrong = Problems::default();
        match Object::new(entries, <Self as Space<'a, D>>::DIMENSION, &mut wrong) {
            Some(object) => {
                let made = self.made(object, level);
                wrong.end(made)
            }
            None => Err(wrong),
        }
    }

    /// Builds the shape of an object.
    fn made<const D: usize>(
        &mut self,
        object: Object<'a>,
        level: usize,
    ) -> Result<Built<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        match object.head {
            keys::SHAPE => match object.value(keys::SHAPE)? {
                Value::String(name) => self.reference(name, level),
                other => {
                    let message = format!("must be the name of a shape, got {}", found(other));
                    Err(Problem::about(message).under(keys::SHAPE).into())
                }
            },
            EXTRUDE | REVOLVE => self.solid(object, level),
            GRID => {
                let written: WrittenGrid =
                    json::read(object.value(GRID)?).map_err(|problems| problems.under(GRID))?;
                let size = Size { nodes: 1, depth: 0 };
                self.allowance.take(size, level)?;
                let shape = written
                    .built(self.scene.resources.folder.as_deref(), Self::grids())
                    .map_err(|problem| problem.under(GRID))?;
                Ok(Built { shape, size })
            }
            MESH | VOLUME => {
                self.mesh(&object, level).map_err(|problems| problems.under(object.head))
            }
            head if keys::is_unary(head) => self.unary(&object, level),
            head if keys::is_list(head) => self.list(&object, level),
            name => {
                let (shape, nodes) = primitive(name, object.value(name)?)?;
                let size = Size { nodes, depth: 0 };
                self.allowance.take(size, level)?;
                Ok(Built { shape, size })
            }
        }
    }

    /// Builds the operand under `of`.
    pub(super) fn operand<const D: usize>(
        &mut self,
        object: &Object<'a>,
        level: usize,
    ) -> Result<Built<D>, Problems>
    where
        Self: Space<'a, D>,
        Turns: Turning<D>,
    {
        let operand = object.value(OF)?;
        self.node(operand, level).map_err(|problems| problems.under(OF))
    }
}

impl<const D: usize> Built<D> {
    /// What stands in for a shape with problems, so that an operator on it is read.
    pub(super) fn stand_in() -> Result<Self, Problems> {
        let shape = Shape::ball(1.0).map_err(Problem::of_shape)?;
        Ok(Self { shape, size: Size { nodes: 1, depth: 0 } })
    }
}

impl<'a> Space<'a, 2> for Builder<'a> {
    const DIMENSION: Dimension = Dimension::Two;

    fn memory(&mut self) -> &mut Memory<'a, 2> {
        &mut self.planar
    }

    fn solid(&mut self, object: Object<'a>, _level: usize) -> Result<Built<2>, Problems> {
        let operator = object.head;
        let message = format!("`{operator}` makes a 3D shape, this place is 2D");
        Err(Problem::new(message).of_dimension().into())
    }

    fn mesh(&mut self, object: &Object<'a>, _level: usize) -> Result<Built<2>, Problems> {
        let message = format!("`{}` makes a 3D shape, this place is 2D", object.head);
        Err(Problem::new(message).of_dimension().into())
    }

    fn grids() -> &'static KeptGrids<2> {
        &PLANAR
    }

    fn twisted(_shape: Shape<2>, key: &str, _rate: f64) -> Result<Shape<2>, Problems> {
        let message = format!("`{key}` twists a 3D shape, this place is 2D");
        Err(Problem::new(message).of_dimension().into())
    }
}

impl<'a> Space<'a, 3> for Builder<'a> {
    const DIMENSION: Dimension = Dimension::Three;

    fn memory(&mut self) -> &mut Memory<'a, 3> {
        &mut self.spatial
    }

    fn solid(&mut self, object: Object<'a>, level: usize) -> Result<Built<3>, Problems> {
        // The place of a flat shape is 2D wherever the whole is used.
        let flat = self.operand(&object, level).map_err(Problems::in_any_dimension);
        over(flat, |flat: Built<2>| {
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
        })
    }

    fn mesh(&mut self, object: &Object<'a>, level: usize) -> Result<Built<3>, Problems> {
        let size = Size { nodes: 1, depth: 0 };
        self.allowance.take(size, level)?;
        let (written, folder) =
            (object.value(object.head)?, self.scene.resources.folder.as_deref());
        let mesh = if object.head == MESH {
            json::read::<WrittenMesh>(written)?.built(folder)?
        } else {
            json::read::<WrittenVolume>(written)?.built(folder)?
        };
        let shape = mesh.shape.clone();
        if !self.meshes.iter().any(|other| other.is_same(&mesh)) {
            self.meshes.push(mesh);
        }
        Ok(Built { shape, size })
    }

    fn grids() -> &'static KeptGrids<3> {
        &SPATIAL
    }

    fn twisted(shape: Shape<3>, key: &str, rate: f64) -> Result<Shape<3>, Problems> {
        shape.twisted(rate).map_err(|error| refused(key, error).into())
    }
}
