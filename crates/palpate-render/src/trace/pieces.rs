// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A shape as booleans of pieces, each of which is bounded by itself.
//!
//! A part of a ray is free of an intersection where it is free of one of its shapes, and of a union
//! where it is free of all. So a box that holds a fine thread rules out what the model of the thread
//! would not.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, BoundingBall, Column, Node, Shape, Vector};

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

/// Cells over which pieces are bounded, with memory.
#[derive(Debug)]
pub(super) struct Cells {
    /// The coordinates of the cell of each lane.
    pub(super) cells: [Vector<Model, 3>; BLOCK],
    block: Block<Model, 3, BLOCK>,
    models: Column<Model, BLOCK>,
    /// Evaluations since the last call.
    pub(super) evaluations: u64,
}

impl Cells {
    pub(super) fn new() -> Self {
        Self {
            cells: [Vector([Model::default(); 3]); BLOCK],
            block: Block::zero(),
            models: Column::zero(),
            evaluations: 0,
        }
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
        // Flat pieces first: they are cheap, and rule out most.
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

    /// Sets the share of the cell of each of `lanes`, from its beginning, that is free of the
    /// shape.
    pub(super) fn passed(&self, cells: &mut Cells, lanes: &[usize], shares: &mut [f64; BLOCK]) {
        let (of, start) = match self {
            Self::One(piece) => return piece.passed(cells, lanes, shares),
            Self::Any(of) => (of, 1.0),
            Self::All(of) => (of, 0.0),
        };
        lanes.iter().for_each(|lane| shares[*lane] = start);
        let is_any = start > 0.0;
        let (mut open, mut found) = (lanes.to_vec(), [0.0; BLOCK]);
        for piece in of {
            piece.passed(cells, &open, &mut found);
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

    fn passed(&self, cells: &mut Cells, lanes: &[usize], shares: &mut [f64; BLOCK]) {
        lanes.iter().for_each(|lane| shares[*lane] = 1.0);
        let is_near =
            |lane: &&usize| self.ball.is_none_or(|ball| meets(&ball, &cells.cells[**lane]));
        let near: Vec<usize> = lanes.iter().filter(is_near).copied().collect();
        if near.is_empty() {
            return;
        }
        let Cells { cells, block, models, evaluations } = cells;
        block.fill(near.len(), |i| cells[near[i]]);
        self.shape.block_distances(block, near.len(), models);
        *evaluations += near.len() as u64;
        for (i, lane) in near.into_iter().enumerate() {
            let model = models.get(i);
            shares[lane] = positive(&if self.is_complement { -model } else { model });
        }
    }
}

/// `false` if a cell lies outside a ball.
fn meets(ball: &BoundingBall<3>, cell: &Vector<Model, 3>) -> bool {
    let centre = Vector(cell.0.map(|x| x.value));
    // Room for the rounding of the distance; NaN meets.
    let apart = (centre - ball.centre).norm() * (1.0 - 1e-9);
    !(apart > ball.radius + Model::radius(&cell.0))
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
        Pieces::of(shape).passed(&mut cells, &[7], &mut shares);
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
        let ball = Shape::ball(1.0).unwrap().translated([0.0, 2.0, 0.0]).unwrap();
        assert_eq!(share(&ball), 1.0);
    }
}
