// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The surfaces that rays meet: bodies thickened where they have no interior, and cut.

use palpate_field::{Aabb, BLOCK, Block, BoundingBall, Column, Node, Point, Shape, ShapeError};

use crate::beam::{Beam, Extent};
use crate::bundle::Bundle;
use crate::color::Light;
use crate::subject::{Cut, LitBody, Subject};

/// The bodies as rays meet them.
#[derive(Debug)]
pub(crate) struct Surfaces {
    pub(crate) bodies: Vec<Surface>,
    /// The shapes that together are all bodies.
    parts: Vec<Part>,
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

/// A member of a union.
#[derive(Debug)]
struct Part {
    shape: Shape<3>,
    ball: Option<BoundingBall<3>>,
    /// Whether the field is at least the distance to the ball.
    is_above_ball: bool,
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
        let mut parts = Vec::new();
        let mut surface = |body: &LitBody| {
            let mut uncut = Vec::new();
            take_apart(&body.shape, thin, &mut uncut)?;
            let shapes = uncut.iter().map(|part| kept(part, cut));
            let shapes = shapes.collect::<Result<Vec<_>, ShapeError>>()?;
            parts.extend(shapes.iter().zip(&uncut).map(|(shape, uncut)| Part {
                shape: shape.clone(),
                ball: uncut.promise().bounds.map(|bounds| bounds.ball),
                is_above_ball: uncut.promise().above_bounds,
            }));
            let (shape, uncut) = (Shape::union(shapes)?, Shape::union(uncut)?);
            let ball = uncut.promise().bounds.map(|bounds| bounds.ball);
            Ok(Surface { shape, uncut, light: body.color.light(), ball })
        };
        let bodies = subject.bodies().iter().map(&mut surface);
        let bodies = bodies.collect::<Result<Vec<_>, ShapeError>>()?;
        let whole = Shape::union(parts.iter().map(|part| part.shape.clone()))?;
        let extent = if subject.is_bounded() {
            Extent::Box(subject.bounds().grown(thin))
        } else {
            Extent::Ball(subject.horizon())
        };
        Ok(Self { bodies, parts, whole, extent, cut, gap })
    }

    /// The union of the parts that some of these beams may meet; `None` if there are none.
    pub(crate) fn along(&self, beams: &[Beam]) -> Option<Shape<3>> {
        let bundle = Bundle::around(beams.iter().filter(|beam| beam.near < beam.far))?;
        self.union_of(|part| part.ball.is_none_or(|ball| bundle.may_meet(&ball)))
    }

    /// The union of the parts whose fields may be less than `reach` at these points [m]; `None` if
    /// there are none.
    pub(crate) fn around(&self, points: &[Point<3>], reach: f64) -> Option<Shape<3>> {
        let all = ball_around(points)?;
        self.union_of(|part| {
            let ball = part.ball.filter(|_| part.is_above_ball);
            ball.is_none_or(|ball| gap_between(&ball, &all) <= reach)
        })
    }

    fn union_of(&self, is_near: impl Fn(&Part) -> bool) -> Option<Shape<3>> {
        let near: Vec<_> = self.parts.iter().filter(|part| is_near(part)).collect();
        if near.len() == self.parts.len() {
            return Some(self.whole.clone());
        }
        // A union of fewer members is no deeper than that of all.
        Shape::union(near.into_iter().map(|part| part.shape.clone())).ok()
    }

    /// `true` where the face of the cut lies nearer than the body's own surface.
    pub(crate) fn is_cut_face(&self, body: usize, point: Point<3>) -> bool {
        let above = |cut: Cut| cut.elevation(point) > self.bodies[body].uncut.distance(point);
        self.cut.is_some_and(above)
    }
}

/// What is left of a shape that is cut.
fn kept(shape: &Shape<3>, cut: Option<Cut>) -> Result<Shape<3>, ShapeError> {
    let Some(Cut { point, normal }) = cut else { return Ok(shape.clone()) };
    Shape::intersection([shape.clone(), Shape::half_space(normal, point.dot(normal))?])
}

/// Takes a shape apart into the members of its unions. Curves and sheets become as thick as
/// `2 radius` [m]; where an operator other than a union or a motion holds them, they are as thick
/// as they are.
fn take_apart(
    shape: &Shape<3>,
    radius: f64,
    parts: &mut Vec<Shape<3>>,
) -> Result<(), ShapeError> {
    match shape.node() {
        Node::Union(of) => of.iter().try_for_each(|of| take_apart(of, radius, parts))?,
        Node::Placed { pose, of } => {
            let first = parts.len();
            take_apart(of, radius, parts)?;
            for part in &mut parts[first..] {
                *part = part.clone().placed(pose)?;
            }
        }
        _ if !shape.promise().has_interior => parts.push(shape.clone().offset(radius)?),
        _ => parts.push(shape.clone()),
    }
    Ok(())
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
        self.bodies = [0; BLOCK];
        let Some(all) = ball_around(points).filter(|_| surfaces.bodies.len() > 1) else {
            return;
        };
        self.block.fill(points.len(), |i| points[i]);
        for (index, body) in surfaces.bodies.iter().enumerate() {
            let is_far = body.ball.is_some_and(|ball| gap_between(&ball, &all) > surfaces.gap);
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
fn ball_around(points: &[Point<3>]) -> Option<BoundingBall<3>> {
    let bounds = Aabb::around(points.iter().copied())?;
    Some(BoundingBall { centre: bounds.centre(), radius: bounds.half_extents().norm() })
}

/// How far two balls are apart; negative if they overlap [m].
fn gap_between(a: &BoundingBall<3>, b: &BoundingBall<3>) -> f64 {
    (a.centre - b.centre).norm() - a.radius - b.radius
}
