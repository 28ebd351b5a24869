// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A shape as booleans of pieces, each of which is bounded by itself.
//!
//! A part of a ray is free of an intersection where it is free of one of its shapes, and of a union
//! where it is free of all. So a box that holds a fine thread rules out what the model of the thread
//! would not.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, BoundingBall, Column, Node, Point, Quality, Shape, Vector};
use palpate_query::free_radius;

/// Fields steeper than this are passed by models alone: a ball about a value `f` has the radius
/// `f / L`, where models follow the slope that the field has there.
const STEEP: f64 = 1.5;

/// `true` of a field whose values say little of the distance.
pub(super) fn is_steep(shape: &Shape<3>) -> bool {
    let promise = shape.promise();
    promise.outside == Quality::Lipschitz && promise.lipschitz > STEEP
}

/// A shape as a tree of booleans.
#[derive(Debug)]
pub(super) enum Pieces {
    /// A field, or its complement.
    One(Piece),
    /// The union.
    Any(Vec<Self>),
    /// The intersection.
    All(Vec<Self>),
}

/// A field, or its complement.
#[derive(Debug)]
pub(super) struct Piece {
    shape: Shape<3>,
    is_complement: bool,
    /// The ball outside of which the piece is empty, if there is one.
    ball: Option<BoundingBall<3>>,
}

/// What is asked about pieces, of each lane: a part of a ray, or a point.
pub(super) trait Probe {
    /// Sets the free share of each of these lanes; of a point, zero or one.
    fn look_at(&mut self, piece: &Piece, lanes: &[usize], shares: &mut [f64; BLOCK]);
}

/// Cells over which pieces are bounded, with memory.
#[derive(Debug)]
pub(super) struct Cells {
    /// The coordinates of the cell of each lane.
    pub(super) cells: [Vector<Model, 3>; BLOCK],
    /// `true` where pieces that are not steep are asked for values before models: what they
    /// decide spares the models of those that are.
    pub(super) has_steep: bool,
    centres: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
    block: Block<Model, 3, BLOCK>,
    models: Column<Model, BLOCK>,
    /// Evaluations since the last call.
    pub(super) evaluations: u64,
}

impl Cells {
    pub(super) fn new() -> Self {
        Self {
            cells: [Vector([Model::default(); 3]); BLOCK],
            has_steep: false,
            centres: Block::zero(),
            values: Column::zero(),
            block: Block::zero(),
            models: Column::zero(),
            evaluations: 0,
        }
    }

    /// Sets the shares of those lanes whose cells lie on one side of a piece by the value at the
    /// centre, which costs less than a model; returns the others.
    fn undecided(
        &mut self,
        piece: &Piece,
        mut lanes: Vec<usize>,
        shares: &mut [f64; BLOCK],
    ) -> Vec<usize> {
        let Self { cells, centres, values, evaluations, .. } = self;
        let centre = |lane: usize| Vector(cells[lane].0.map(|x| x.value));
        centres.fill(lanes.len(), |i| centre(lanes[i]));
        piece.shape.block_distances(centres, lanes.len(), values);
        *evaluations += lanes.len() as u64;
        let lipschitz = piece.shape.promise().lipschitz;
        let mut number = 0;
        lanes.retain(|lane| {
            let value = values.get(number);
            number += 1;
            let radius = Model::radius(&cells[*lane].0);
            let value = if piece.is_complement { -value } else { value };
            let is_blocked = value < -lipschitz * radius;
            let is_free = !piece.is_complement
                && free_radius(&piece.shape, centre(*lane), value) > radius;
            if is_blocked {
                shares[*lane] = 0.0;
            }
            !(is_blocked || is_free)
        });
        lanes
    }
}

/// Points that are free where a field is greater than `gap`, with memory.
#[derive(Debug)]
pub(super) struct Places {
    /// The point of each lane.
    pub(super) points: [Point<3>; BLOCK],
    gap: f64,
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
    /// Evaluations since the last call.
    pub(super) evaluations: u64,
}

impl Places {
    pub(super) fn new(gap: f64) -> Self {
        let (block, values) = (Block::zero(), Column::zero());
        Self { points: [Vector::ZERO; BLOCK], gap, block, values, evaluations: 0 }
    }
}

impl Pieces {
    /// The pieces of a shape.
    pub(super) fn of(shape: &Shape<3>) -> Self {
        Self::build(shape, false)
    }

    fn build(shape: &Shape<3>, is_complement: bool) -> Self {
        let each =
            |of: &[Shape<3>]| of.iter().map(|of| Self::build(of, is_complement)).collect();
        let (any, of) = match shape.node() {
            Node::Union(of) => (!is_complement, each(of)),
            Node::Intersection(of) => (is_complement, each(of)),
            Node::Difference(of) => {
                let piece = |(i, of)| Self::build(of, is_complement != (i > 0));
                (is_complement, of.iter().enumerate().map(piece).collect())
            }
            Node::Placed { pose, of } => {
                let place = |of: &Shape<3>| of.clone().placed(pose);
                let moved = match of.node() {
                    Node::Union(of) => Shape::union(of.iter().flat_map(place)),
                    Node::Intersection(of) => Shape::intersection(of.iter().flat_map(place)),
                    _ => return Self::One(Piece::new(shape, is_complement)),
                };
                return match moved {
                    Ok(moved) => Self::build(&moved, is_complement),
                    Err(_) => Self::One(Piece::new(shape, is_complement)),
                };
            }
            _ => return Self::One(Piece::new(shape, is_complement)),
        };
        // The least steep pieces first: they are cheap, and rule out most.
        let mut of: Vec<Self> = of;
        of.sort_by(|a, b| a.steepness().total_cmp(&b.steepness()));
        if any { Self::Any(of) } else { Self::All(of) }
    }

    /// The largest Lipschitz constant of its pieces.
    fn steepness(&self) -> f64 {
        match self {
            Self::One(piece) => piece.shape.promise().lipschitz,
            Self::Any(of) | Self::All(of) => of.iter().map(Self::steepness).fold(0.0, f64::max),
        }
    }

    /// Sets the share of what each of `lanes` asks about, from its beginning, that is free of the
    /// shape.
    pub(super) fn free(
        &self,
        probe: &mut impl Probe,
        lanes: &[usize],
        shares: &mut [f64; BLOCK],
    ) {
        let (of, start) = match self {
            Self::One(piece) => return probe.look_at(piece, lanes, shares),
            Self::Any(of) => (of, 1.0),
            Self::All(of) => (of, 0.0),
        };
        lanes.iter().for_each(|lane| shares[*lane] = start);
        let is_any = start > 0.0;
        let (mut open, mut found) = (lanes.to_vec(), [0.0; BLOCK]);
        for piece in of {
            piece.free(probe, &open, &mut found);
            open.retain(|lane| {
                let share = &mut shares[*lane];
                *share = if is_any { share.min(found[*lane]) } else { share.max(found[*lane]) };
                if is_any { *share > 0.0 } else { *share < 1.0 }
            });
        }
    }
}

impl Piece {
    fn new(shape: &Shape<3>, is_complement: bool) -> Self {
        let bounds = shape.promise().bounds.filter(|_| !is_complement);
        let ball = bounds.map(|bounds| bounds.ball);
        Self { shape: shape.clone(), is_complement, ball }
    }

    /// Those of the lanes that are not outside the piece's ball; all others are free.
    fn near(
        &self,
        lanes: &[usize],
        shares: &mut [f64; BLOCK],
        meets: impl Fn(&BoundingBall<3>, usize) -> bool,
    ) -> Vec<usize> {
        lanes.iter().for_each(|lane| shares[*lane] = 1.0);
        let is_near = |lane: &usize| self.ball.is_none_or(|ball| meets(&ball, *lane));
        lanes.iter().copied().filter(is_near).collect()
    }
}

impl Probe for Cells {
    fn look_at(&mut self, piece: &Piece, lanes: &[usize], shares: &mut [f64; BLOCK]) {
        let meets = |ball: &BoundingBall<3>, lane: usize| meets(ball, &self.cells[lane]);
        let mut near = piece.near(lanes, shares, meets);
        if self.has_steep && !is_steep(&piece.shape) && !near.is_empty() {
            near = self.undecided(piece, near, shares);
        }
        if near.is_empty() {
            return;
        }
        let Self { cells, block, models, evaluations, .. } = self;
        block.fill(near.len(), |i| cells[near[i]]);
        piece.shape.block_distances(block, near.len(), models);
        *evaluations += near.len() as u64;
        for (i, lane) in near.into_iter().enumerate() {
            let model = models.get(i);
            shares[lane] = positive(&if piece.is_complement { -model } else { model });
        }
    }
}

impl Probe for Places {
    fn look_at(&mut self, piece: &Piece, lanes: &[usize], shares: &mut [f64; BLOCK]) {
        let Self { points, gap, block, values, evaluations } = self;
        // Written so that NaN meets.
        let meets = |ball: &BoundingBall<3>, lane: usize| {
            let is_outside = (points[lane] - ball.centre).norm() > ball.radius + *gap;
            !is_outside
        };
        let near = piece.near(lanes, shares, meets);
        if near.is_empty() {
            return;
        }
        block.fill(near.len(), |i| points[near[i]]);
        piece.shape.block_distances(block, near.len(), values);
        *evaluations += near.len() as u64;
        for (i, lane) in near.into_iter().enumerate() {
            let value = values.get(i);
            let value = if piece.is_complement { -value } else { value };
            shares[lane] = if value > *gap { 1.0 } else { 0.0 };
        }
    }
}

/// `false` if a cell lies outside a ball.
fn meets(ball: &BoundingBall<3>, cell: &Vector<Model, 3>) -> bool {
    let centre = Vector(cell.0.map(|x| x.value));
    // Room for the rounding of the distance; NaN meets.
    let apart = (centre - ball.centre).norm() * (1.0 - 1e-9);
    let is_outside = apart > ball.radius + Model::radius(&cell.0);
    !is_outside
}

/// The share of a cell from its beginning over which a model is positive.
pub(super) fn positive(model: &Model) -> f64 {
    if model.minimum() > 0.0 {
        return 1.0;
    }
    let [along, across, other] = model.gradient;
    // Room for the roundings of this sum, as `Model::minimum` has it.
    let inflated = 1.0 + 8.0 * f64::EPSILON;
    let below = (across.abs() + other.abs() + model.lower) * inflated;
    let least = model.value - below - 4.0 * f64::EPSILON * model.value.abs();
    // At u along the cell, from −1 to 1, the field is at least `least + along u`.
    if least - along > 0.0 && along < 0.0 {
        let share = 0.5 * (1.0 - least / along);
        // Less than all of it, which is for the minimum to say.
        (share * (1.0 - 1e-9)).min(1.0 - 1e-9)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_field_is_passed_up_to_its_zero() {
        let falling = Model { value: 1.0, gradient: [-4.0, 0.0, 0.0], lower: 0.0, upper: 0.0 };
        // From 5 to −3 over the cell: zero after 5/8 of it.
        assert!((positive(&falling) - 0.625).abs() < 1e-8 && positive(&falling) < 0.625);
        let rising = Model { gradient: [4.0, 0.0, 0.0], ..falling };
        assert_eq!(positive(&rising), 0.0);
        // Half as far if it may be 2.5 less anywhere.
        let loose = Model { lower: 2.5, ..falling };
        assert!((positive(&loose) - 0.3125).abs() < 1e-8);
        assert_eq!(positive(&Model { value: 9.0, ..falling }), 1.0);
    }

    /// The share of a cell of the x axis from −3 to 3 that is free of a shape.
    fn share(shape: &Shape<3>) -> f64 {
        let mut cells = Cells::new();
        cells.cells[7] = Vector(Model::cell([0.0, 0.0, 0.0], [3.0, 0.0, 0.0]));
        let mut shares = [f64::NAN; BLOCK];
        Pieces::of(shape).free(&mut cells, &[7], &mut shares);
        shares[7]
    }

    #[test]
    fn pieces_are_joined_as_the_shape_joins_them() {
        // Half-spaces x ≥ 0, x ≥ 1.5 and x ≤ −1.
        let from = |x: f64| Shape::half_space([-1.0, 0.0, 0.0], -x).unwrap();
        let (a, b) = (from(0.0), from(1.5));
        let c = Shape::half_space([1.0, 0.0, 0.0], -1.0).unwrap();
        let near = |found: f64, expected: f64| {
            assert!(found <= expected && found > expected - 1e-6, "{found} {expected}");
        };
        near(share(&(&a | &b)), 0.5);
        near(share(&(&a & &b)), 0.75);
        // The part of `a` before `b` begins at 0; what is not in `a` is there from the start.
        near(share(&(&a - &b)), 0.5);
        near(share(&(&b - &a)), 0.75);
        assert_eq!(share(&(&c | &a)), 0.0);
        near(share(&(&c & &a)), 0.5);
        let moved = (&a & &b).translated([0.5, 0.0, 0.0]).unwrap();
        near(share(&moved), 2.0 / 3.0 + 1.0 / 6.0);
        let is_free = |shape: &Shape<3>, x: f64| {
            let mut places = Places::new(0.25);
            places.points[7] = Vector([x, 0.0, 0.0]);
            let mut shares = [f64::NAN; BLOCK];
            Pieces::of(shape).free(&mut places, &[7], &mut shares);
            shares[7] == 1.0
        };
        for (shape, x, expected) in [
            (&a | &b, -0.3, true),
            (&a | &b, -0.2, false),
            (&a & &b, 1.2, true),
            (&a & &b, 1.3, false),
            (&a - &b, 1.7, false),
            (&a - &b, 1.8, true),
            (&b - &a, 2.0, true),
        ] {
            assert_eq!(is_free(&shape, x), expected, "{x}");
            assert_eq!(shape.distance([x, 0.0, 0.0]) > 0.25, expected, "{x}");
        }
        let ball = Shape::ball(1.0).unwrap().translated([0.0, 2.0, 0.0]).unwrap();
        assert_eq!(share(&ball), 1.0);
    }
}
