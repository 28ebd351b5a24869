// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The surfaces that rays meet: bodies thickened where they have no interior, and cut.

use palpate_field::{BLOCK, Block, BoundingBall, Column, Node, Point, Shape, ShapeError};

use crate::beam::Extent;
use crate::color::Light;
use crate::subject::{Body, Cut, Subject};

/// The bodies as rays meet them.
#[derive(Debug)]
pub(crate) struct Surfaces {
    pub(crate) bodies: Vec<Surface>,
    /// The union of all.
    pub(crate) whole: Shape<3>,
    pub(crate) extent: Extent,
    pub(crate) cut: Option<Cut>,
    /// A ray meets a surface where the field is at most this [m].
    pub(crate) gap: f64,
}

/// A body as rays meet it.
#[derive(Debug)]
pub(crate) struct Surface {
    /// The body, thickened and cut.
    shape: Shape<3>,
    /// The body, thickened.
    pub(crate) uncut: Shape<3>,
    pub(crate) light: Light,
    /// The ball around it; `None` without bounds.
    ball: Option<BoundingBall<3>>,
}

impl Surface {
    /// The field of the body, thickened and cut, at a point [m].
    pub(crate) fn distance(&self, point: Point<3>) -> f64 {
        self.shape.distance(point)
    }
}

impl Surfaces {
    /// The bodies of `subject`: curves and sheets with a radius of `thin`, surfaces where fields
    /// are at most `gap`; both [m].
    pub(crate) fn new(
        subject: &Subject,
        cut: Option<Cut>,
        gap: f64,
        thin: f64,
    ) -> Result<Self, ShapeError> {
        let surface = |body: &Body| {
            let uncut = thickened(&body.shape, thin)?;
            let shape = match cut {
                None => uncut.clone(),
                Some(Cut { point, normal }) => {
                    let kept = Shape::half_space(normal, point.dot(normal))?;
                    Shape::intersection([uncut.clone(), kept])?
                }
            };
            let ball = uncut.promise().bounds.map(|bounds| bounds.ball);
            Ok(Surface { shape, uncut, light: body.color.light(), ball })
        };
        let bodies = subject.bodies().iter().map(surface);
        let bodies = bodies.collect::<Result<Vec<_>, ShapeError>>()?;
        let whole = Shape::union(bodies.iter().map(|body| body.shape.clone()))?;
        let extent = if subject.is_bounded() {
            Extent::Box(subject.bounds().grown(thin))
        } else {
            Extent::Ball(subject.horizon())
        };
        Ok(Self { bodies, whole, extent, cut, gap })
    }

    /// `true` where the face of the cut lies nearer than the body's own surface.
    pub(crate) fn is_cut_face(&self, body: usize, point: Point<3>) -> bool {
        let above = |cut: Cut| cut.elevation(point) > self.bodies[body].uncut.distance(point);
        self.cut.is_some_and(above)
    }
}

/// The shape, with its curves and sheets as thick as `2 radius` [m]; where an operator other
/// than a union or a motion holds them, as thick as they are.
fn thickened(shape: &Shape<3>, radius: f64) -> Result<Shape<3>, ShapeError> {
    match shape.node() {
        Node::Union(of) => Shape::union(
            of.iter().map(|of| thickened(of, radius)).collect::<Result<Vec<_>, _>>()?,
        ),
        Node::Placed { pose, of } => thickened(of, radius)?.placed(pose),
        _ if !shape.promise().has_interior => shape.clone().offset(radius),
        _ => Ok(shape.clone()),
    }
}

/// Finds the body whose surface a point lies on.
#[derive(Debug)]
pub(crate) struct Owners {
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
    least: [f64; BLOCK],
    /// The body of each point.
    pub(crate) bodies: [usize; BLOCK],
}

impl Owners {
    pub(crate) fn new() -> Self {
        Self {
            block: Block::zero(),
            values: Column::zero(),
            least: [f64::INFINITY; BLOCK],
            bodies: [0; BLOCK],
        }
    }

    /// Sets [`bodies`](Self::bodies) to those whose fields are least at points of surfaces, at
    /// most [`BLOCK`]; the first of equals.
    pub(crate) fn find(&mut self, surfaces: &Surfaces, points: &[Point<3>]) {
        self.least = [f64::INFINITY; BLOCK];
        let Some(all) = around(points) else { return };
        self.block.fill(points.len(), |i| points[i]);
        for (index, body) in surfaces.bodies.iter().enumerate() {
            let reach = |ball: BoundingBall<3>| ball.radius + all.radius + surfaces.gap;
            let is_far =
                body.ball.is_some_and(|ball| (ball.centre - all.centre).norm() > reach(ball));
            // A field may be less than the distance to its ball.
            if is_far && body.shape.promise().above_bounds {
                continue;
            }
            body.shape.block_distances(&self.block, points.len(), &mut self.values);
            for i in 0..points.len() {
                let value = self.values.get(i);
                if value < self.least[i] {
                    (self.least[i], self.bodies[i]) = (value, index);
                }
            }
        }
    }
}

/// A ball around points; `None` if there are none.
fn around(points: &[Point<3>]) -> Option<BoundingBall<3>> {
    let bounds = palpate_field::Aabb::around(points.iter().copied())?;
    Some(BoundingBall { centre: bounds.centre(), radius: bounds.half_extents().norm() })
}
