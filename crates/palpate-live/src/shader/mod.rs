// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The formulas of a scene's bodies as GLSL.
//!
//! How the text is spelled decides whether a driver compiles it in a third of a second or not at
//! all: choices are written as `mix` and never as branches, and each value that is used twice has
//! a name. Numbers are literals, which compile to the fastest code. Those that change while a
//! control is dragged are uniforms, so that the program need not be compiled again meanwhile.

mod numbering;
mod write;

use std::collections::BTreeSet;

use palpate::field::Shape;
use palpate::field::scalar::{Expression, Operation, Step};

use numbering::Numbering;

/// The most operations of a formula that browsers without a GPU still draw well.
pub const MOST_OPERATIONS: usize = 3000;

/// A number of a formula, by its place: counted through all bodies.
pub type Slot = usize;

/// The formulas of some bodies.
///
/// # Examples
///
/// ```
/// use palpate::field::Shape;
/// use palpate_live::shader::Formulas;
///
/// # fn main() -> Result<(), palpate::field::ShapeError> {
/// let formulas =
///     |radius: f64| Shape::sphere(radius).map(|ball| Formulas::of([&ball]).unwrap());
/// let (small, large) = (formulas(0.25)?, formulas(0.5)?);
/// let moving = small.slots_that_differ(&large).unwrap();
/// let shader = large.shader(&moving);
/// assert!(shader.glsl.contains("uniform float u[1];"));
/// assert_eq!(shader.uniforms, [0.5]);
/// // As long as only these numbers change, the text stays the same.
/// assert_eq!(shader.glsl, small.shader(&moving).glsl);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Formulas {
    bodies: Vec<Expression>,
    dimension: usize,
}

/// A formula as GLSL ES 3.00, with the values of its uniforms.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Shader {
    /// Defines `vec2 field(vec3 p, int only)`, in the plane with a `vec2 p`: the distance [m] and
    /// the number of the nearest body; of the body `only` alone unless that is −1.
    pub glsl: String,
    /// The values of `uniform float u[]`, which is declared if there are any.
    pub uniforms: Vec<f32>,
    /// The operations, shared ones counted once.
    pub operations: usize,
}

impl Formulas {
    /// The formulas of these shapes; `None` if one has none, as a closure.
    pub fn of<'a, const D: usize>(
        shapes: impl IntoIterator<Item = &'a Shape<D>>,
    ) -> Option<Self> {
        let bodies = shapes.into_iter().map(Shape::shader_formula).collect::<Option<_>>()?;
        Some(Self { bodies, dimension: D })
    }

    /// The numbers of the shapes, by their slots.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        self.bodies.iter().flat_map(Expression::steps).flat_map(|step| numbers(step.operation))
    }

    /// The slots in which the numbers of two formulas differ; `None` if they differ in more than
    /// numbers.
    #[must_use]
    pub fn slots_that_differ(&self, other: &Self) -> Option<BTreeSet<Slot>> {
        let is_alike = self.dimension == other.dimension
            && self.bodies.len() == other.bodies.len()
            && self.bodies.iter().zip(&other.bodies).all(|(a, b)| are_alike(a, b));
        let pairs = self.numbers().zip(other.numbers()).enumerate();
        let differ = pairs.filter(|(_, (a, b))| a.to_bits() != b.to_bits());
        is_alike.then(|| differ.map(|(slot, _)| slot).collect())
    }

    /// The shader in which the numbers of these slots are uniforms.
    #[must_use]
    pub fn shader(&self, moving: &BTreeSet<Slot>) -> Shader {
        let mut numbering = Numbering::new(moving);
        let results: Vec<_> = self.bodies.iter().map(|body| numbering.add(body)).collect();
        let numbers: Vec<_> = self.numbers().collect();
        let uniforms = moving.iter().filter_map(|slot| numbers.get(*slot));
        Shader {
            glsl: write::glsl(&numbering, &results, self.dimension),
            uniforms: uniforms.map(|x| *x as f32).collect(),
            operations: numbering.operations(),
        }
    }
}

/// The numbers of a step that belong to the shape.
fn numbers(operation: Operation) -> impl Iterator<Item = f64> {
    let (numbers, count) = match operation {
        Operation::Constant(value) => ([value, 0.0, 0.0], 1),
        Operation::SmoothMin { unit, .. } => ([unit, 0.0, 0.0], 1),
        Operation::NearestMultiple { spacing, low, high } => ([spacing, low, high], 3),
        _ => ([0.0; 3], 0),
    };
    numbers.into_iter().take(count)
}

/// Whether two formulas differ in numbers alone.
fn are_alike(a: &Expression, b: &Expression) -> bool {
    let alike = |a: &Step, b: &Step| {
        let same = match (a.operation, b.operation) {
            (Operation::Constant(_), Operation::Constant(_))
            | (Operation::NearestMultiple { .. }, Operation::NearestMultiple { .. }) => true,
            (
                Operation::SmoothMin { profile: a, .. },
                Operation::SmoothMin { profile: b, .. },
            ) => a == b,
            (a, b) => a == b,
        };
        same && a.arguments == b.arguments
    };
    a.result() == b.result()
        && a.steps().len() == b.steps().len()
        && a.steps().iter().zip(b.steps()).all(|(a, b)| alike(a, b))
}
