// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The catalogue: every primitive by its name.

use std::any::{Any, TypeId};

use crate::error::ShapeError;
use crate::field::{Leaf, SharedField};
use crate::kernel::*;
use crate::node::{self, Node};
use crate::pose::Pose;
use crate::shape::Shape;

/// A primitive in the catalogue.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Entry<const D: usize> {
    /// The name in scene files, and of the constructor of [`Shape`].
    pub name: &'static str,
    /// The primitive described in one sentence.
    pub about: &'static str,
    /// Where its origin is and which way it points, in phrases between semicolons and commas:
    /// `"centred; axis along y"`.
    pub origin: &'static str,
    /// The parameters, in the order of the arguments.
    pub parameters: &'static [Parameter],
    kernel: TypeId,
    build: fn(&[Argument]) -> Result<SharedField<D>, ShapeError>,
    arguments: fn(&dyn Any) -> Option<Vec<Argument>>,
    marks: fn(&[Argument]) -> Result<Vec<Mark<D>>, ShapeError>,
    example: fn() -> Result<Vec<Argument>, ShapeError>,
}

impl<const D: usize> Entry<D> {
    const fn of<K: NamedKernel<D>>() -> Self {
        Self {
            name: K::NAME,
            about: K::ABOUT,
            origin: K::ORIGIN,
            parameters: K::PARAMETERS,
            kernel: TypeId::of::<K>(),
            build: |arguments| Ok(SharedField::new(Leaf::new(K::from_arguments(arguments)?))),
            arguments: |kernel| kernel.downcast_ref::<K>().map(K::arguments),
            marks: |arguments| Ok(K::from_arguments(arguments)?.marks()),
            example: || K::example().map(|kernel| kernel.arguments()),
        }
    }

    /// The primitives of this dimension; none but in the plane and in space.
    #[must_use]
    pub fn all() -> &'static [Self] {
        let planar: &dyn Any = &Entry::<2>::ALL;
        let spatial: &dyn Any = &Entry::<3>::ALL;
        let all = |list: &dyn Any| list.downcast_ref::<&'static [Self]>().copied();
        all(planar).or_else(|| all(spatial)).unwrap_or(&[])
    }

    /// The primitive called `name`, in the catalogue or in [`ALIASES`]; an alias may have
    /// parameters of its own.
    ///
    /// ```
    /// use palpate_field::catalogue::Entry;
    ///
    /// assert_eq!(Entry::<3>::find("torus").unwrap().parameters[1].name, "radius");
    /// assert_eq!(Entry::<3>::find("sphere").unwrap().name, "ball");
    /// assert!(Entry::<2>::find("sphere").is_none());
    /// ```
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        let named = |name: &str| Self::all().iter().find(|entry| entry.name == name);
        let alias = || ALIASES.iter().find(|alias| alias.name == name && alias.dimension == D);
        named(name).or_else(|| named(alias()?.of))
    }

    /// The primitive that a kernel is, with the arguments it was made from; `None` for a
    /// kernel that is not of this crate.
    pub(crate) fn of_kernel(kernel: &dyn Any) -> Option<(Self, Vec<Argument>)> {
        let entry = Self::all().iter().find(|entry| entry.kernel == kernel.type_id())?;
        Some((*entry, (entry.arguments)(kernel)?))
    }

    /// The field of the primitive from one argument for each parameter.
    pub(crate) fn field(&self, arguments: &[Argument]) -> Result<SharedField<D>, ShapeError> {
        (self.build)(arguments)
    }

    /// Makes the primitive from one argument for each parameter, in their order.
    ///
    /// # Errors
    ///
    /// If an argument is of the wrong kind or breaks the parameter's rule.
    pub fn build(&self, arguments: &[Argument]) -> Result<Shape<D>, ShapeError> {
        let primitive = node::Primitive::of_entry(*self, arguments.to_vec());
        Shape::from_node(Node::Primitive(primitive))
    }

    /// As [`build`](Self::build), moved by `world_from_body`.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build), or if a number of the pose is not finite.
    pub fn build_at(
        &self,
        arguments: &[Argument],
        world_from_body: &Pose<D>,
    ) -> Result<Shape<D>, ShapeError> {
        self.build(arguments)?.placed(world_from_body)
    }

    /// Where the primitive made from `arguments` shows its parameters.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    pub fn marks(&self, arguments: &[Argument]) -> Result<Vec<Mark<D>>, ShapeError> {
        (self.marks)(arguments)
    }

    /// The arguments of the [`example`](Self::example).
    ///
    /// # Errors
    ///
    /// None in practice.
    pub fn example_arguments(&self) -> Result<Vec<Argument>, ShapeError> {
        (self.example)()
    }

    /// The example of the primitive, of about 1 m.
    ///
    /// # Errors
    ///
    /// None in practice.
    pub fn example(&self) -> Result<Shape<D>, ShapeError> {
        self.build(&self.example_arguments()?)
    }
}

/// Another name of a primitive in one dimension.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Alias {
    /// The other name.
    pub name: &'static str,
    /// The name in the catalogue.
    pub of: &'static str,
    /// The dimension in which it is one.
    pub dimension: usize,
    /// Its parameters, if they are not those of the primitive.
    pub parameters: Option<&'static [Parameter]>,
}

impl Alias {
    const fn new(name: &'static str, of: &'static str, dimension: usize) -> Self {
        Self { name, of, dimension, parameters: None }
    }

    /// A name with one number for the size along all axes.
    const fn regular(name: &'static str, of: &'static str, dimension: usize) -> Self {
        Self { parameters: Some(&[EDGE]), ..Self::new(name, of, dimension) }
    }

    /// The arguments of the primitive, from those of the other name: where it has parameters of
    /// its own, a number holds along all axes.
    #[must_use]
    pub fn arguments(&self, given: Vec<Argument>) -> Vec<Argument> {
        let along_all = |argument| match argument {
            Argument::Number(number) if self.parameters.is_some() => {
                Argument::Vector(vec![number; self.dimension])
            }
            other => other,
        };
        given.into_iter().map(along_all).collect()
    }
}

/// The parameter of a square and of a cube.
const EDGE: Parameter =
    Parameter { name: "size", kind: ParameterKind::Length, about: "the length of every edge" };

/// The names that many people look for first.
pub const ALIASES: &[Alias] = &[
    Alias::new("circle", "ball", 2),
    Alias::new("rectangle", "cuboid", 2),
    Alias::regular("square", "cuboid", 2),
    Alias::new("sphere", "ball", 3),
    Alias::new("box", "cuboid", 3),
    Alias::regular("cube", "cuboid", 3),
];

// Statics, and not constants, so that the code of all primitives is in this crate
// once and not in every crate that looks at the lists.
macro_rules! entries {
    ($list:ident, $dimension:literal: $($kernel:ty),* $(,)?) => {
        static $list: [Entry<$dimension>; [$(stringify!($kernel)),*].len()] =
            [$(Entry::of::<$kernel>()),*];
    };
}

planar::primitives!(entries, PLANAR, 2:);
spatial::primitives!(entries, SPATIAL, 3:);

impl Entry<2> {
    /// All primitives of the plane.
    pub const ALL: &[Self] = &PLANAR;
}

impl Entry<3> {
    /// All primitives of space.
    pub const ALL: &[Self] = &SPATIAL;
}
