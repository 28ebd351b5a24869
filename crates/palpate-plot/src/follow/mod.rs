// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Follows the surface of a field that bounds its values over cells.
//!
//! A tree of square cells is split level by level; cells whose bounds prove that they hold no
//! zero are dropped. On the edges of the finest cells the zeros are found: where the sign
//! changes, and where the value falls to zero and rises again without a change of sign. The
//! lines of a cell join the zeros of its edges. A cell that stays open without a zero on its
//! edges is split further and searched by Newton's method.

mod cells;
mod dots;
mod edges;
mod lattice;
mod march;
mod rings;
mod thin;
mod walls;

use std::f64::consts::SQRT_2;

use crate::error::{LARGEST, PlotError};
use crate::geometry::Point;
use crate::outline::SurfaceLines;
use crate::sampling::Sampling;
use crate::slope::SampledSlope;
use crate::view::PlaneView;
use lattice::Lattice;

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
        let mut cells = cells::open(&Lattice::over(view, sampling), &mut field);
        let changes = walls::find(&cells.open, &cells.lattice, &mut field)?;
        let walls = march::join_walls(&cells.open, &changes);
        let corner_is_inside = field.values(&[cells.lattice.corner([0, 0])])?[0] < 0.0;
        let rings = rings::close(&cells.lattice, &changes, &walls.segments, corner_is_inside);
        let without = cells.bounded(walls.without.clone(), &mut field);
        let doubtful = [&without[..], &changes.pairs(&cells.open)].concat();
        let zeros = thin::find(&doubtful, &cells.lattice, &mut field)?;
        let mut thin = march::join_thin(&without, &zeros);
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
