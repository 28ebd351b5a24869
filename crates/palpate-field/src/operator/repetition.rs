// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Repetition: copies of a shape on a grid along the axes.
//!
//! # Derivation
//!
//! Space is cut into tiles about the places of the copies; a point belongs to the
//! nearest place. Along an axis in which the shape is its own mirror image and stays
//! in its tile, the nearest copy is that of the point's own tile: folding space like an
//! accordion at the walls between tiles brings a point of any other copy to one of that
//! copy, and no nearer points apart. Along the other axes the copies to both sides are
//! asked too. Copies further away are at least as far as their boxes: that distance,
//! the clearance, limits the answer from above, so that it stays a bound and does not
//! jump where the point comes into another tile.
//!
//! Over a cell that crosses a wall between tiles, the formula of its centre's tile is
//! taken. It equals the field on the wall, and both vary by at most the Lipschitz
//! constant, so it is wrong by twice that times the depth beyond the wall at most.

use super::surface::guarded;
use crate::bounds::{Aabb, Bounds};
use crate::error::{LARGEST_LENGTH, ShapeError, Unit, positive};
use crate::field::{Combined, Minimum, Remap, Remapped, SharedField, Warp, Warped};
use crate::promise::{Promise, Rounding};
use crate::scalar::{Float, Scalar};
use crate::vector::{Vector, array, unrolled};

/// The number of copies to either side where a row has no end.
const ENDLESS: i32 = 1_000_000;

/// The copies of a shape along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Copies {
    /// Once, where it is.
    One,
    /// At `first · spacing` to `last · spacing` from where it is.
    Between {
        /// From one copy to the next [m].
        spacing: f64,
        /// The lowest number of a copy.
        first: i32,
        /// The highest number of a copy.
        last: i32,
    },
    /// To both sides without end: a million times either way.
    Endless {
        /// From one copy to the next [m].
        spacing: f64,
    },
}

/// The places of copies along an axis.
#[derive(Clone, Copy, Debug)]
struct Row {
    spacing: f64,
    /// The numbers of the first and the last copy; both zero for one copy alone.
    first: f64,
    last: f64,
    /// The middle of the tile of copy zero.
    centre: f64,
    /// Half the width of a copy.
    half_extent: f64,
    /// The copies to both sides are asked too.
    neighbours: bool,
    is_endless: bool,
}

impl Row {
    fn new(copies: Copies, low: f64, high: f64, symmetric: bool) -> Result<Self, ShapeError> {
        let (spacing, first, last) = match copies {
            Copies::One => (1.0, 0, 0),
            Copies::Between { spacing, first, last } => (spacing, first, last),
            Copies::Endless { spacing } => (spacing, -ENDLESS, ENDLESS),
        };
        let number = |x: i32| {
            if (-ENDLESS..=ENDLESS).contains(&x) {
                return Ok(f64::from(x));
            }
            let rule = format!("from -{ENDLESS} to {ENDLESS}");
            Err(ShapeError::number("repeat", rule, f64::from(x), Unit::One))
        };
        positive("spacing", spacing, Unit::Metre)?;
        if first > last {
            let rule = format!("at most the last, {last}");
            return Err(ShapeError::number("first", rule, f64::from(first), Unit::One));
        }
        let repeats = first < last;
        let half_extent = 0.5 * (high - low);
        if repeats && half_extent > spacing {
            let rule = format!("at least half the width of the shape, {} m", 2.0 * half_extent);
            return Err(ShapeError::number("spacing", rule, spacing, Unit::Metre));
        }
        let centre = if symmetric { 0.0 } else { 0.5 * (low + high) };
        let stays = symmetric && high <= 0.5 * spacing;
        Ok(Self {
            spacing,
            first: number(first)?,
            last: number(last)?,
            centre,
            half_extent,
            neighbours: repeats && !stays,
            is_endless: matches!(copies, Copies::Endless { .. }),
        })
    }

    /// How much farther from the origin a copy may be asked than the point is [m]: where copy
    /// zero is left out, or the middle of its tile or a neighbour's is elsewhere.
    fn detour(&self) -> f64 {
        if self.is_alone() {
            return 0.0;
        }
        let left_out = self.spacing * self.first.max(-self.last).max(0.0);
        let beside = if self.neighbours { 1.5 * self.spacing } else { 0.0 };
        left_out + beside + 2.0 * self.centre.abs()
    }

    /// There is one copy, where the shape is.
    fn is_alone(&self) -> bool {
        self.first == 0.0 && self.last == 0.0
    }

    /// The place of the copy nearest to `x`, relative to copy zero.
    #[inline(always)]
    fn nearest<S: Scalar>(&self, x: S) -> S {
        (x - S::constant(self.centre)).nearest_multiple(self.spacing, self.first, self.last)
    }

    /// The depth of `x` beyond the wall to the next tile; zero within its own.
    #[inline(always)]
    fn beyond<S: Scalar>(&self, x: S) -> S {
        let place = self.nearest(x);
        let inside = x - place - S::constant(self.centre);
        let wall = S::constant(0.5 * self.spacing);
        let (none, far) = (S::constant(0.0), S::constant(-LARGEST_LENGTH));
        // Halfway between two places, where rounding cannot matter.
        let limit = |number: f64| S::constant(number * self.spacing);
        let above = S::select_less(place, limit(self.last - 0.5), inside - wall, far);
        let below = S::select_less(limit(self.first + 0.5), place, -inside - wall, far);
        none.max(above.max(below))
    }

    /// A lower bound of the distance from `x` to the copies that are not evaluated, along
    /// the axis.
    ///
    /// A row counts as one copy longer at each end: otherwise the bound would jump where
    /// a point enters the last tile and the copy two tiles behind it is skipped.
    #[inline(always)]
    fn clearance<S: Scalar>(&self, x: S) -> S {
        let place = self.nearest(x);
        let inside = x - place - S::constant(self.centre);
        let gap = S::constant(2.0 * self.spacing - self.half_extent);
        let far = S::constant(LARGEST_LENGTH);
        let limit = |number: f64| S::constant(number * self.spacing);
        let above = S::select_less(place, limit(self.last - 0.5), gap - inside, far);
        let below = S::select_less(limit(self.first + 0.5), place, gap + inside, far);
        above.min(below).max(S::constant(0.0))
    }
}

/// The rows of copies along all axes.
#[derive(Clone, Copy, Debug)]
struct Grid<const D: usize> {
    rows: [Row; D],
    /// The Lipschitz constant of the child, and at least one.
    lipschitz: f64,
}

impl<const D: usize> Grid<D> {
    /// A bound of the error over a cell where only the formula of one tile is evaluated.
    #[inline(always)]
    fn across_walls<S: Scalar>(&self, p: Vector<S, D>) -> S {
        let mut sum = S::constant(0.0);
        unrolled!(i < D => sum = sum + self.rows[i].beyond(p.0[i]));
        sum.scale(2.0 * self.lipschitz)
    }

    /// The box of all copies.
    fn aabb(&self, copy: &Aabb<D>) -> Aabb<D> {
        let mut all = *copy;
        for (i, row) in self.rows.iter().enumerate() {
            all.min[i] += row.first * row.spacing;
            all.max[i] += row.last * row.spacing;
        }
        for i in 0..D {
            let slack = 4.0 * f64::EPSILON * all.min[i].abs().max(all.max[i].abs());
            all.min[i] -= slack;
            all.max[i] += slack;
        }
        all
    }

    /// The bounds of all copies; none if they are endless.
    fn bounds(&self, copy: &Aabb<D>) -> Option<Bounds<D>> {
        let endless = self.rows.iter().any(|row| row.is_endless);
        (!endless).then(|| Bounds::of_box(self.aabb(copy)))
    }
}

/// The copy of the point's own tile, or one beside it.
#[derive(Debug)]
pub(crate) struct Tile<const D: usize> {
    grid: Grid<D>,
    /// The offset from the point's own tile, in tiles along each axis.
    beside: [f64; D],
    /// `true` if no other copy is evaluated.
    alone: bool,
}

impl<const D: usize> Warp<D, D> for Tile<D> {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        Vector(array!(i < D => {
            let row = &self.grid.rows[i];
            let place = row.nearest(p.0[i]) + S::constant(self.beside[i] * row.spacing);
            p.0[i] - place.clamp(row.first * row.spacing, row.last * row.spacing)
        }))
    }

    #[inline(always)]
    fn value<S: Scalar>(&self, p: Vector<S, D>, child: S) -> S {
        if self.alone { child.give_or_take(self.grid.across_walls(p)) } else { child }
    }

    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        _p: Vector<T, D>,
        child: T,
        child_gradient: Vector<T, D>,
    ) -> (T, Vector<T, D>) {
        (child, child_gradient)
    }
}

/// `min(f, clearance)`, with the clearance a bound of the distance to the copies that
/// were not evaluated.
#[derive(Debug)]
pub(crate) struct Clearance<const D: usize> {
    grid: Grid<D>,
    /// The box of all copies.
    centre: [f64; D],
    half_extents: [f64; D],
}

impl<const D: usize> Remap<D> for Clearance<D> {
    #[inline(always)]
    fn value<S: Scalar>(&self, p: Vector<S, D>, child: S) -> S {
        let zero = S::constant(0.0);
        // How far outside the box of all copies, along each axis.
        let outside: [S; D] = array!(i < D => {
            let from_centre = (p.0[i] - S::constant(self.centre[i])).abs();
            zero.max(from_centre - S::constant(self.half_extents[i]))
        });
        let mut result = child;
        unrolled!(i < D => {
            let row = &self.grid.rows[i];
            if row.neighbours {
                let mut gaps = outside;
                gaps[i] = row.clearance(p.0[i]);
                result = result.min(S::norm(gaps));
            }
        });
        result.give_or_take(self.grid.across_walls(p))
    }
}

/// The promise of copies of which only the nearest is evaluated.
fn promise_of_tiles<const D: usize>(
    child: &Promise<D>,
    grid: &Grid<D>,
    copy: &Aabb<D>,
) -> Promise<D> {
    let apart = (0..D).all(|i| {
        let row = &grid.rows[i];
        row.first == row.last || copy.max[i] < 0.5 * row.spacing
    });
    let size = copy.radius_about_origin();
    let detour = Vector(std::array::from_fn::<_, D, _>(|i| grid.rows[i].detour())).norm();
    let moved = Rounding::of_operations(8.0 * grid.lipschitz, size + detour);
    Promise {
        inside: if apart { child.inside } else { child.inside.bounded() },
        lipschitz: grid.lipschitz,
        bounds: grid.bounds(copy),
        convex: false,
        symmetric: std::array::from_fn(|i| child.symmetric[i] && grid.rows[i].is_alone()),
        rounding: child.rounding.at(1.0, detour).plus(&moved),
        ..*child
    }
}

/// Copies of `child` on a grid.
pub(crate) fn repeated<const D: usize>(
    child: SharedField<D>,
    copies: [Copies; D],
) -> Result<SharedField<D>, ShapeError> {
    let of = *child.promise();
    let needs = |needs: &'static str| ShapeError::Unsuitable {
        operator: "repeat",
        needs: needs.into(),
    };
    let copy = of.bounds.ok_or_else(|| needs("a shape with bounds"))?.aabb;
    if of.region.is_some() {
        return Err(needs("a shape whose steepness is known everywhere"));
    }
    let mut rows = Vec::with_capacity(D);
    for (i, copies) in copies.into_iter().enumerate() {
        rows.push(Row::new(copies, copy.min[i], copy.max[i], of.symmetric[i])?);
    }
    let rows = std::array::from_fn(|i| rows[i]);
    let grid = Grid { rows, lipschitz: of.lipschitz.max(1.0) };
    let promise = promise_of_tiles(&of, &grid, &copy);
    if rows.iter().any(|row| row.neighbours) {
        return with_neighbours(child, grid, &grid.aabb(&copy), &promise);
    }
    let map = Tile { grid, beside: [0.0; D], alone: true };
    Warped::shared(map, child, promise)
}

/// The copies of a point's tile and of those beside it, and the clearance.
fn with_neighbours<const D: usize>(
    child: SharedField<D>,
    grid: Grid<D>,
    all: &Aabb<D>,
    alone: &Promise<D>,
) -> Result<SharedField<D>, ShapeError> {
    let promise = Promise { above_bounds: true, ..alone.bound() };
    let child = guarded(child)?;
    let mut besides = vec![[0.0; D]];
    for (i, row) in grid.rows.iter().enumerate() {
        if row.neighbours {
            let here = besides.clone();
            for step in [-1.0, 1.0] {
                besides.extend(here.iter().map(|beside| {
                    let mut beside = *beside;
                    beside[i] = step;
                    beside
                }));
            }
        }
    }
    let tiles: Result<Vec<_>, _> = besides
        .into_iter()
        .map(|beside| {
            let map = Tile { grid, beside, alone: false };
            Warped::shared(map, child.clone(), promise)
        })
        .collect();
    let nearest = Combined::shared(Minimum, tiles?, promise)?;
    let (centre, half_extents) = (all.centre().0, all.half_extents().0);
    let map = Clearance { grid, centre, half_extents };
    Remapped::shared(map, nearest, promise)
}
