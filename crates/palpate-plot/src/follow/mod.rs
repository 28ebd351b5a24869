// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Isolines followed through cells.
//!
//! Follows the surface of a field that bounds its values over cells.
//!
//! A tree of square cells is split level by level; cells whose bounds prove that they hold no
//! zero are dropped. On the edges of the finest cells the zeros are found: where the sign
//! changes, and where the value falls to zero and rises again without a change of sign. The
//! lines of a cell join the zeros of its edges. A cell that stays open without a zero on its
//! edges is split further and searched by Newton's method.

use std::f64::consts::SQRT_2;

use crate::error::{LARGEST, PlotError};
use crate::geometry::{Point, distance};
use crate::outline::SurfaceLines;
use crate::slice::{PlaneView, Sampling};
use crate::slope::SampledSlope;

mod dots;
mod rings;
mod thin;
mod walls;

/// A square cell of a plane, in plane coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// The middle \[m\].
    pub centre: [f64; 2],
    /// Half the edge \[m\].
    pub half: f64,
}

/// A field in a plane that bounds its values over cells.
///
/// # Examples
///
/// A wire around a disc is the zero set of a field without a negative value:
///
/// ```
/// use palpate_plot::{BoundedField, Cell, SurfaceLines, Sampling, SampledSlope, PlaneView};
///
/// struct Wire;
///
/// impl BoundedField for Wire {
///     fn values(&mut self, points: &[[f64; 2]], values: &mut [f64]) {
///         for (p, value) in points.iter().zip(values) {
///             *value = (p[0].hypot(p[1]) - 0.03).abs();
///         }
///     }
///
///     fn slopes(&mut self, points: &[[f64; 2]], slopes: &mut [SampledSlope]) {
///         for (p, slope) in points.iter().zip(slopes) {
///             let radius = p[0].hypot(p[1]);
///             let way = (radius - 0.03).signum() / radius;
///             let gradient = [way * p[0], way * p[1], 0.0];
///             *slope = SampledSlope { value: (radius - 0.03).abs(), gradient };
///         }
///     }
///
///     fn safe_radii(&mut self, points: &[[f64; 2]], radii: &mut [f64]) {
///         self.values(points, radii); // exact
///     }
///
///     fn bounds(&mut self, cells: &[Cell], bounds: &mut [[f64; 2]]) {
///         for (cell, bounds) in cells.iter().zip(bounds) {
///             let value = (cell.centre[0].hypot(cell.centre[1]) - 0.03).abs();
///             let change = 2.0_f64.sqrt() * cell.half; // no steeper than one
///             *bounds = [value - change, value + change];
///         }
///     }
/// }
///
/// let view = PlaneView::new([0.0, 0.0], 0.1, 0.1)?;
/// let wire = SurfaceLines::follow(&view, Sampling::default(), Wire)?;
/// assert!(wire.lines().iter().any(|line| line.len() > 300));
/// assert!(wire.lines().iter().flatten().all(|p| (p[0].hypot(p[1]) - 0.03).abs() < 1e-6));
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
pub trait BoundedField {
    /// Writes the value \[m\] at each of `points` \[m\].
    fn values(&mut self, points: &[[f64; 2]], values: &mut [f64]);

    /// Writes the value and the gradient at each of `points` \[m\], as many as `slopes`.
    fn slopes(&mut self, points: &[[f64; 2]], slopes: &mut [SampledSlope]);

    /// Writes for each of `points` \[m\] the radius of a disc about it that is sure to hold no zero
    /// \[m\]; zero where none is known.
    fn safe_radii(&mut self, points: &[[f64; 2]], radii: &mut [f64]);

    /// Writes a lower and an upper bound \[m\] of the values over each of `cells`.
    fn bounds(&mut self, cells: &[Cell], bounds: &mut [[f64; 2]]);
}

impl SurfaceLines {
    /// Follows the surface of `field` in the window `view`.
    ///
    /// The finest cells are a quarter of those of `sampling`: less than half a pixel of a
    /// figure. So lines keep that close to the surface, and no part of it is left out that the
    /// field's bounds do not rule out:
    ///
    /// - where the sign changes, ends of lines are zeros to 2 % of a cell;
    /// - a wire without a change of sign, and a gap or wall thinner than a cell, are single
    ///   lines; the value falls to less than 5 % of those at the ends of the edge;
    /// - a cell whose values are all below a millionth of its size belongs to the surface as a
    ///   whole, as where the plane lies in a sheet;
    /// - a surface smaller than a cell is dots.
    ///
    /// Where the bounds are so loose that over 300 000 cells stay open, the finest cells are
    /// larger, at most as large as those of `sampling`.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is NaN, infinite or over 1e150,
    /// [`PlotError::Gradient`] for the first such gradient.
    pub fn follow(
        view: &PlaneView,
        sampling: Sampling,
        field: impl BoundedField,
    ) -> Result<Self, PlotError> {
        let mut field = Asked { field };
        let mut cells = open(&Lattice::over(view, sampling), &mut field);
        let changes = walls::find(&cells.open, &cells.lattice, &mut field)?;
        let walls = join_walls(&cells.open, &changes);
        let corner_is_inside = field.values(&[cells.lattice.corner([0, 0])])?[0] < 0.0;
        let rings = rings::close(&cells.lattice, &changes, &walls.segments, corner_is_inside);
        let without = cells.bounded(walls.without.clone(), &mut field);
        let doubtful = [&without[..], &changes.pairs(&cells.open)].concat();
        let zeros = thin::find(&doubtful, &cells.lattice, &mut field)?;
        let mut thin = join_thin(&without, &zeros);
        thin.end_at_walls(&cells.open, &zeros, &changes);
        let dots = dots::find(&thin.without, &cells.lattice, &mut field)?;
        let dots = dots.into_iter().map(|dot| vec![dot, dot]);
        Ok(Self {
            rings,
            lines: walls.joined().chain(thin.joined()).chain(dots).collect(),
            solids: cells.solid.iter().map(|cell| cell.corners().to_vec()).collect(),
        })
    }
}

impl Cell {
    /// Its corners, counter-clockwise.
    pub(crate) fn corners(&self) -> [Point; 4] {
        let [x, y] = self.centre;
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[i, j]| [x + i * self.half, y + j * self.half])
    }
}

/// Points and cells that are asked about together.
const BLOCK: usize = 64;

/// A field whose answers are checked.
struct Asked<F> {
    field: F,
}

impl<F: BoundedField> Asked<F> {
    /// The values at `points`.
    fn values(&mut self, points: &[Point]) -> Result<Vec<f64>, PlotError> {
        let mut values = vec![0.0; points.len()];
        for (points, values) in points.chunks(BLOCK).zip(values.chunks_mut(BLOCK)) {
            self.field.values(points, values);
            for (&at, &value) in points.iter().zip(&*values) {
                PlotError::check_sample(at, value)?;
            }
        }
        Ok(values)
    }

    /// The slopes at `points`.
    fn slopes(&mut self, points: &[Point]) -> Result<Vec<SampledSlope>, PlotError> {
        let mut slopes = vec![SampledSlope::default(); points.len()];
        for (points, slopes) in points.chunks(BLOCK).zip(slopes.chunks_mut(BLOCK)) {
            self.field.slopes(points, slopes);
            for (&at, slope) in points.iter().zip(&*slopes) {
                slope.check(at)?;
            }
        }
        Ok(slopes)
    }

    /// For each of `cells`, whether it is larger than the safe radius about its centre.
    fn radii_leave_open(&mut self, cells: &[Cell]) -> Vec<bool> {
        let centres: Vec<_> = cells.iter().map(|cell| cell.centre).collect();
        let mut radii = vec![0.0; cells.len()];
        for (centres, radii) in centres.chunks(BLOCK).zip(radii.chunks_mut(BLOCK)) {
            self.field.safe_radii(centres, radii);
        }
        // Written so that NaN leaves a cell open.
        let is_ruled_out = |(cell, radius): (&Cell, f64)| radius > SQRT_2 * cell.half;
        cells.iter().zip(radii).map(|asked| !is_ruled_out(asked)).collect()
    }

    /// The bounds over `cells`; those that are not numbers rule nothing out.
    fn bounds(&mut self, cells: &[Cell]) -> Vec<[f64; 2]> {
        let mut bounds = vec![[-LARGEST, LARGEST]; cells.len()];
        for (cells, bounds) in cells.chunks(BLOCK).zip(bounds.chunks_mut(BLOCK)) {
            self.field.bounds(cells, bounds);
        }
        bounds
    }
}

/// The most open cells: twice those of a raster, a few megabytes of slopes.
const MOST: usize = 300_000;

/// A cell whose values are all below this share of its half edge is surface as a whole. Values
/// in a sheet are a few roundings.
const FLAT: f64 = 1e-6;

/// Splits all cells that may hold a zero, until they are the finest or too many.
fn open(lattice: &Lattice, field: &mut Asked<impl BoundedField>) -> Cells {
    let mut sieve = Sieve { lattice, field, solid: Vec::new() };
    let mut level = lattice.levels;
    let mut open = sieve.pass(lattice.roots());
    while level > 0 && 4 * open.len() <= MOST {
        level -= 1;
        let quarters = open.into_iter().flat_map(|spot| lattice.quarters(spot)).collect();
        open = sieve.pass(quarters);
    }
    let solid = sieve.solid;
    let open = open.iter().map(|spot| spot.at.map(|coordinate| coordinate >> level)).collect();
    Cells { lattice: lattice.coarser(level), open, solid }
}

/// The cells that are left.
#[derive(Debug)]
struct Cells {
    /// Of which the open cells are the finest.
    lattice: Lattice,
    /// Lower left corners of the open cells, neighbours mostly near each other.
    open: Vec<Corner>,
    /// Cells of any size that are surface as a whole.
    solid: Vec<Cell>,
}

impl Cells {
    /// Those of the open cells `at` that are open by their bounds too; others become solid if
    /// they are all zero.
    fn bounded(
        &mut self,
        at: Vec<Corner>,
        field: &mut Asked<impl BoundedField>,
    ) -> Vec<Corner> {
        let spots = at.into_iter().map(|at| Spot { at, level: 0 }).collect();
        let mut sieve = Sieve { lattice: &self.lattice, field, solid: Vec::new() };
        let open = sieve.bounded(spots);
        let solid = sieve.solid;
        self.solid.extend(solid);
        open.into_iter().map(|spot| spot.at).collect()
    }
}

/// Rules out cells.
struct Sieve<'a, F> {
    lattice: &'a Lattice,
    field: &'a mut Asked<F>,
    solid: Vec<Cell>,
}

impl<F: BoundedField> Sieve<'_, F> {
    /// The cells that may hold a zero; those that are all zero become solid. Bounds cost several
    /// times a value, so they are asked for only where the radii rule out little.
    fn pass(&mut self, spots: Vec<Spot>) -> Vec<Spot> {
        let cells: Vec<_> = spots.iter().map(|spot| self.lattice.cell(*spot)).collect();
        let count = spots.len();
        let is_open = self.field.radii_leave_open(&cells);
        let open: Vec<_> = kept(spots, is_open);
        if 4 * open.len() < 3 * count { open } else { self.bounded(open) }
    }

    /// As [`pass`](Self::pass), by bounds.
    fn bounded(&mut self, spots: Vec<Spot>) -> Vec<Spot> {
        let cells: Vec<_> = spots.iter().map(|spot| self.lattice.cell(*spot)).collect();
        let bounds = self.field.bounds(&cells);
        let is_open = cells.iter().zip(bounds).map(|(cell, bounds)| {
            if is_flat(cell, bounds) {
                self.solid.push(*cell);
            }
            may_hold_zero(bounds) && !is_flat(cell, bounds)
        });
        kept(spots, is_open.collect())
    }
}

/// Those of `items` that `are_kept`.
fn kept<T>(items: Vec<T>, are_kept: Vec<bool>) -> Vec<T> {
    items.into_iter().zip(are_kept).filter(|item| item.1).map(|item| item.0).collect()
}

fn is_flat(cell: &Cell, bounds: [f64; 2]) -> bool {
    bounds.iter().all(|bound| bound.abs() < FLAT * cell.half)
}

/// Whether a cell with these bounds may hold a zero. Written so that bounds that are NaN rule
/// nothing out.
fn may_hold_zero([low, high]: [f64; 2]) -> bool {
    !(low > 0.0 || high < 0.0)
}

/// Edges along a tile.
const TILE: usize = 16;

/// The corner of a cell, as the number of cells to its left and below it.
type Corner = [usize; 2];

/// The edge from a corner to the next one along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Edge {
    at: Corner,
    axis: usize,
}

impl Edge {
    /// Its ends.
    fn ends(self) -> [Corner; 2] {
        let mut end = self.at;
        end[self.axis] += 1;
        [self.at, end]
    }

    /// The point at a share of the way from its first end to the other [m].
    fn point(self, lattice: &Lattice, share: f64) -> Point {
        let mut p = lattice.corner(self.at);
        p[self.axis] += share * lattice.edge;
        p
    }

    fn key(self) -> ([usize; 4], usize) {
        (order(self.at), self.axis)
    }
}

/// The corners of the cell at its lower left one, counter-clockwise.
fn corners_of([i, j]: Corner) -> [Corner; 4] {
    [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]
}

/// The edges of a cell: below, right, above, left.
fn edges_of([i, j]: Corner) -> [Edge; 4] {
    [([i, j], 0), ([i + 1, j], 1), ([i, j + 1], 0), ([i, j], 1)]
        .map(|(at, axis)| Edge { at, axis })
}

/// Orders corners by tiles, and row by row in a tile. Corners that are asked about together then
/// lie near each other, and fields of many parts answer such questions faster.
fn order([across, up]: Corner) -> [usize; 4] {
    [up / TILE, across / TILE, up, across]
}

/// Something known of the corners of some cells.
#[derive(Debug)]
struct Corners<T> {
    corners: Vec<Corner>,
    known: Vec<T>,
}

impl<T: Copy> Corners<T> {
    /// Asks for what is to be known of the corners of `cells`, by their places [m].
    fn of<E>(
        cells: &[Corner],
        lattice: &Lattice,
        ask: impl FnOnce(&[Point]) -> Result<Vec<T>, E>,
    ) -> Result<Self, E> {
        let mut corners: Vec<_> = cells.iter().flat_map(|&at| corners_of(at)).collect();
        corners.sort_unstable_by_key(|&at| order(at));
        corners.dedup();
        let places: Vec<_> = corners.iter().map(|&at| lattice.corner(at)).collect();
        Ok(Self { known: ask(&places)?, corners })
    }

    /// What is known of a corner of one of the cells.
    fn get(&self, at: Corner) -> Option<T> {
        let index = self.corners.binary_search_by_key(&order(at), |&at| order(at)).ok()?;
        self.known.get(index).copied()
    }
}

/// The edges of `cells`, each once, in order.
fn sorted_edges(cells: &[Corner]) -> Vec<Edge> {
    let mut edges: Vec<_> = cells.iter().flat_map(|&at| edges_of(at)).collect();
    edges.sort_unstable_by_key(|edge| edge.key());
    edges.dedup();
    edges
}

/// Zeros on edges, in the order of [`sorted_edges`].
#[derive(Debug, Default)]
struct Zeros {
    edges: Vec<Edge>,
    /// A zero on each edge [m].
    places: Vec<Point>,
}

impl Zeros {
    /// The numbers of the zeros on the edges of a cell: below, right, above, left.
    fn of_cell(&self, at: Corner) -> Vec<usize> {
        edges_of(at).into_iter().filter_map(|edge| self.find(edge)).collect()
    }

    /// Those of `cells` with zeros that share an edge without one, which a line of single cells
    /// has not.
    fn pairs(&self, cells: &[Corner]) -> Vec<Corner> {
        let has_zero =
            |at: Corner| edges_of(at).into_iter().any(|edge| self.find(edge).is_some());
        let mut pairs = Vec::new();
        for &[i, j] in cells.iter().filter(|at| has_zero(**at)) {
            let [_, right, above, _] = edges_of([i, j]);
            for (edge, next) in [(right, [i + 1, j]), (above, [i, j + 1])] {
                if self.find(edge).is_none() && has_zero(next) {
                    pairs.extend([[i, j], next]);
                }
            }
        }
        pairs
    }

    fn find(&self, edge: Edge) -> Option<usize> {
        self.edges.binary_search_by_key(&edge.key(), |edge| edge.key()).ok()
    }
}

/// Finest cells along a cell of the sampling, as a power of two.
const FINER: u32 = 2;

/// Cells along the longer side at the coarsest level, at most.
const COARSEST: usize = 16;

/// The window begins this many finest cells within the lattice, across and up. No round numbers:
/// the axes of a scene, along which its surfaces like to lie, then run between corners.
const SHIFT: Point = [1.381_966, 1.708_204];

/// A rectangle of square cells.
#[derive(Debug, Clone, PartialEq)]
struct Lattice {
    /// Lower left corner [m].
    origin: Point,
    /// Edge of a finest cell [m].
    edge: f64,
    /// Finest cells across and up.
    count: [usize; 2],
    /// Levels above the finest one.
    levels: u32,
}

/// A cell by the finest cells that it spans: from `at`, 2 to the `level` of them across and up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Spot {
    at: [usize; 2],
    level: u32,
}

impl Lattice {
    /// The lattice over `view` and a border.
    fn over(view: &PlaneView, sampling: Sampling) -> Self {
        let longer = view.width().max(view.height());
        let edge = longer / (sampling.cells() << FINER) as f64;
        let count = |size: f64, shift: f64| (size / edge + 2.0 * shift).ceil() as usize;
        let count = [count(view.width(), SHIFT[0]), count(view.height(), SHIFT[1])];
        let largest = count[0].max(count[1]);
        let mut levels = 0;
        while largest.div_ceil(1 << levels) > COARSEST {
            levels += 1;
        }
        let origin = [0, 1].map(|k| view.min()[k] - SHIFT[k] * edge);
        Self { origin, edge, count, levels }
    }

    /// The lattice with cells of `level` as the finest ones, which may reach beyond this one.
    fn coarser(&self, level: u32) -> Self {
        Self {
            edge: self.edge * f64::from(1_u32 << level),
            count: self.count.map(|count| count.div_ceil(1 << level)),
            levels: self.levels - level,
            ..*self
        }
    }

    /// The place of a corner [m].
    fn corner(&self, at: [usize; 2]) -> Point {
        [0, 1].map(|k| self.origin[k] + at[k] as f64 * self.edge)
    }

    /// A cell of any level.
    fn cell(&self, spot: Spot) -> Cell {
        let half = 0.5 * self.edge * f64::from(1_u32 << spot.level);
        Cell { centre: self.corner(spot.at).map(|x| x + half), half }
    }

    /// The cells of the coarsest level.
    fn roots(&self) -> Vec<Spot> {
        let level = self.levels;
        let [across, up] = self.count.map(|count| count.div_ceil(1 << level));
        let spot = |i: usize| Spot { at: [i % across, i / across].map(|k| k << level), level };
        (0..across * up).map(spot).collect()
    }

    /// The quarters of a cell that lie in the lattice.
    fn quarters(&self, spot: Spot) -> impl Iterator<Item = Spot> {
        let level = spot.level - 1;
        let quarters = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|quarter: [usize; 2]| Spot {
            at: [0, 1].map(|k| spot.at[k] + (quarter[k] << level)),
            level,
        });
        let count = self.count;
        quarters.into_iter().filter(move |spot| (0..2).all(|k| spot.at[k] < count[k]))
    }
}

/// Lines between numbered places.
#[derive(Debug, Default)]
struct Lines {
    /// Where lines begin and end [m].
    places: Vec<Point>,
    segments: Vec<[usize; 2]>,
    /// Cells without a zero on their edges.
    without: Vec<Corner>,
}

/// Joins the changes of sign on the edges of each cell. Where all four edges have one, the pairs
/// that are shorter in sum.
fn join_walls(cells: &[Corner], zeros: &Zeros) -> Lines {
    let mut lines = Lines { places: zeros.places.clone(), ..Lines::default() };
    let length = |[a, b]: [usize; 2]| distance(zeros.places[a], zeros.places[b]);
    for &at in cells {
        match zeros.of_cell(at)[..] {
            [] => lines.without.push(at),
            [a, b] => lines.segments.push([a, b]),
            [below, right, above, left] => {
                let one = [[below, right], [above, left]];
                let other = [[below, left], [right, above]];
                let sum = |pairs: [[usize; 2]; 2]| pairs.map(length).iter().sum::<f64>();
                lines.segments.extend(if sum(one) <= sum(other) { one } else { other });
            }
            // The sign changes an even number of times around a cell.
            _ => {}
        }
    }
    lines
}

/// Joins the zeros without a change of sign on the edges of each cell: two by a line, more of them
/// in their middle. One alone is the end of a line.
fn join_thin(cells: &[Corner], zeros: &Zeros) -> Lines {
    let mut lines = Lines { places: zeros.places.clone(), ..Lines::default() };
    for &at in cells {
        match zeros.of_cell(at)[..] {
            [] => lines.without.push(at),
            [only] => lines.segments.push([only, only]),
            [a, b] => lines.segments.push([a, b]),
            ref several => {
                let middle = lines.places.len();
                lines.places.push(mean(zeros, several));
                lines.segments.extend(several.iter().map(|&number| [number, middle]));
            }
        }
    }
    lines
}

impl Lines {
    /// Joins those of `zeros`, without a change of sign, that lie on edges of cells with walls to
    /// the walls in these cells.
    fn end_at_walls(&mut self, cells: &[Corner], zeros: &Zeros, walls: &Zeros) {
        for &at in cells {
            let ends = zeros.of_cell(at);
            let around = if ends.is_empty() { Vec::new() } else { walls.of_cell(at) };
            if !around.is_empty() {
                let middle = self.places.len();
                self.places.push(mean(walls, &around));
                self.segments.extend(ends.into_iter().map(|number| [number, middle]));
            }
        }
    }

    /// The segments joined into long lines [m].
    fn joined(&self) -> impl Iterator<Item = Vec<Point>> {
        let chains = crate::chain::chains(&self.segments).into_iter();
        chains.map(|chain| chain.into_iter().map(|node| self.places[node]).collect())
    }
}

/// The mean of some zeros [m].
fn mean(zeros: &Zeros, numbers: &[usize]) -> Point {
    let sum = |k: usize| numbers.iter().map(|&number| zeros.places[number][k]).sum::<f64>();
    [sum(0), sum(1)].map(|sum| sum / numbers.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inside of a rotated square, no steeper than one; `loose` bounds rule nothing out.
    struct Square {
        centre: Point,
        loose: bool,
    }

    impl Square {
        fn value(&self, p: Point) -> f64 {
            let [x, y] = [0, 1].map(|k| p[k] - self.centre[k]);
            (x.abs() + y.abs() - 1.0) / SQRT_2
        }
    }

    impl BoundedField for Square {
        fn values(&mut self, points: &[Point], values: &mut [f64]) {
            points.iter().zip(values).for_each(|(&p, value)| *value = self.value(p));
        }

        fn slopes(&mut self, points: &[Point], slopes: &mut [SampledSlope]) {
            for (&p, slope) in points.iter().zip(slopes) {
                let [x, y] = [0, 1].map(|k| (p[k] - self.centre[k]).signum() / SQRT_2);
                *slope = SampledSlope { value: self.value(p), gradient: [x, y, 0.0] };
            }
        }

        fn safe_radii(&mut self, points: &[Point], radii: &mut [f64]) {
            let share = if self.loose { 0.0 } else { 1.0 };
            let points = points.iter().zip(radii);
            points.for_each(|(&p, radius)| *radius = share * self.value(p).abs());
        }

        fn bounds(&mut self, cells: &[Cell], bounds: &mut [[f64; 2]]) {
            let [low, high] = if self.loose { [f64::NAN, f64::NAN] } else { [-1.0, 1.0] };
            let cells = cells.iter().zip(bounds);
            cells.for_each(|(cell, bounds)| {
                let value = self.value(cell.centre);
                let change = SQRT_2 * cell.half;
                *bounds = [value + low * change, value + high * change];
            });
        }
    }

    /// The area within rings by the even-odd rule, if they do not cross.
    fn area(rings: &[Vec<Point>]) -> f64 {
        let twice = |ring: &Vec<Point>| {
            let pairs = ring.windows(2).map(|pair| (pair[0], pair[1]));
            pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
        };
        rings.iter().map(|ring| 0.5 * twice(ring).abs()).sum()
    }

    fn outline(centre: Point, loose: bool) -> SurfaceLines {
        let view = PlaneView::new([0.0, 0.0], 4.0, 3.0).unwrap();
        SurfaceLines::follow(&view, Sampling::default(), Square { centre, loose }).unwrap()
    }

    /// The only long line. Where a corner of the square is cut off, its tip may be a dot.
    fn line(outline: &SurfaceLines) -> &[Point] {
        let mut long = outline.lines.iter().filter(|line| line.len() > 3);
        let (line, other) = (long.next().unwrap(), long.next());
        assert!(other.is_none() && outline.lines.len() <= 5, "{}", outline.lines.len());
        line
    }

    #[test]
    fn rings_enclose_the_inside() {
        let whole = outline([0.0, 0.0], false);
        assert_eq!(line(&whole).first(), line(&whole).last());
        assert_eq!(whole.rings.len(), 1);
        // Four corners are cut off by a cell at most.
        assert!((area(&whole.rings) - 2.0).abs() < 1e-5, "{}", area(&whole.rings));
    }

    /// Beyond the window the lattice has about one cell more.
    #[test]
    fn rings_are_closed_along_the_edge_of_the_window() {
        for (centre, inside) in [([-2.0, 0.0], 1.0), ([2.0, 1.5], 0.5), ([0.0, -1.5], 1.0)] {
            let cut = outline(centre, false);
            assert_ne!(line(&cut).first(), line(&cut).last());
            let found = area(&cut.rings);
            assert!((found - inside).abs() < 0.02, "{found} for {inside} at {centre:?}");
        }
    }

    #[test]
    fn a_window_inside_or_outside_has_no_line() {
        let view = PlaneView::new([0.0, 0.0], 0.8, 0.6).unwrap();
        for (centre, inside) in [([0.0, 0.0], 0.8 * 0.6), ([3.0, 0.0], 0.0)] {
            let square = Square { centre, loose: false };
            let found = SurfaceLines::follow(&view, Sampling::default(), square).unwrap();
            assert!(found.lines.is_empty());
            assert!((area(&found.rings) - inside).abs() < 0.01);
        }
    }

    /// Where nothing is ruled out, cells end at the size of samples: four edges.
    #[test]
    fn loose_bounds_give_coarser_lines() {
        let [loose, tight] = [true, false].map(|loose| outline([0.1, 0.2], loose));
        let edge = 4.0 / 420.0;
        let error = |p: &Point| Square { centre: [0.1, 0.2], loose: true }.value(*p).abs();
        assert!(line(&loose).iter().all(|p| error(p) < 0.1 * edge));
        assert!(3 * line(&loose).len() < line(&tight).len());
    }

    #[test]
    fn a_value_that_is_no_number_is_refused() {
        let view = PlaneView::new([0.0, 0.0], 4.0, 3.0).unwrap();
        let square = Square { centre: [f64::NAN, 0.0], loose: true };
        let error = SurfaceLines::follow(&view, Sampling::default(), square).unwrap_err();
        assert!(matches!(error, PlotError::Sample { .. }), "{error}");
    }
}
