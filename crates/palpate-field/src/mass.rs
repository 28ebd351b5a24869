// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Mass, centroid and moments.
//!
//! Mass, centroid and inertia, with bounds on their errors.
//!
//! # Derivation
//!
//! The box of the shape is cut into cells. Over a cell a [`Model`] says between which
//! two planes the surface runs: all of the cell below the lower plane is inside, all
//! above the upper one outside. Volume and moments of a box below a plane have a closed
//! form: that of the simplex cut off at its lowest corner, less those at the corners
//! next to it, and so on by inclusion and exclusion. What is between the planes is
//! counted half, and its whole half is the error; it shrinks with the square of the
//! cell where the surface is smooth. Cells that contribute most are cut again.
//!
//! A polyhedron needs no cells: it is a sum of simplices, of its faces and one apex.
//!
//! This loop is not the best-first search of `palpate-query`, which bounds a least value and
//! leaves cells alone that cannot hold it. A volume is a sum: every cell counts, and which
//! cells to cut follows from the errors of all.

use std::fmt;

use crate::bounds::Aabb;
use crate::error::{ShapeError, Unit, positive};
use crate::machine::{BLOCK, Block, Column};
use crate::scalar::Model;
use crate::shape::Shape;
use crate::vector::{Point, Vector};

/// The least component of a model's gradient, relative to the largest: smaller ones are taken for
/// zero, and the planes are moved apart to make up for it.
const FLATTEST: f64 = 3e-3;

/// Rounding of the closed form, in parts of the volume of the cell: the terms of its second moments
/// are up to [`FLATTEST`]⁻⁴ times as large as their sum. Ten times the largest that thousands of
/// random planes with two such slopes show.
const CANCELLATION: f64 = 4e-6;

/// Rounding of the middle of a cell, in units of the farthest coordinate's last place: a sum, and
/// the halvings before it.
const MIDDLE_ROUNDINGS: f64 = 4.0;

/// The error at which [`Shape::mass`] stops, and the work after which it gives up.
///
/// ```
/// use palpate_field::MassLimits;
///
/// let limits = MassLimits { tolerance: 1e-2, ..MassLimits::default() };
/// assert_eq!((limits.tolerance, limits.cells), (1e-2, 3_000_000));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassLimits {
    /// The relative error of the volume at which to stop.
    pub tolerance: f64,
    /// The largest number of cells evaluated.
    pub cells: usize,
}

impl Default for MassLimits {
    /// A tolerance of 1e-3, three million cells, which take half a gigabyte.
    fn default() -> Self {
        Self { tolerance: 1e-3, cells: 3_000_000 }
    }
}

/// Mass, centroid and second moments of a body of one density.
///
/// In the plane a body is one metre thick: mass is in kg for each metre.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Mass<const D: usize> {
    /// The volume [m³], or area [m²].
    pub volume: f64,
    /// The largest error of the volume.
    pub volume_error: f64,
    /// The density [kg/m³].
    pub density: f64,
    /// The centre of mass [m].
    pub centroid: Point<D>,
    /// The largest error of each of its coordinates [m]; infinite if the volume may be
    /// zero.
    pub centroid_error: f64,
    /// `∫ ρ (p − c)(p − c)ᵀ` about the centroid `c` [kg·m²].
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::convert::serde::rows"))]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub second_moments: [[f64; D]; D],
    /// The largest error of each second moment [kg·m²].
    pub second_moments_error: f64,
    /// The cells that were looked at; none of a polyhedron, whose faces tell.
    pub cells: usize,
}

impl<const D: usize> Mass<D> {
    /// `true` if the volume is proven to be zero: the shape is empty, or a curve or sheet without
    /// an inside.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.volume + self.volume_error <= 0.0
    }

    /// The mass [kg].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.density * self.volume
    }

    /// The largest error of the mass [kg].
    #[must_use]
    pub fn mass_error(&self) -> f64 {
        self.density * self.volume_error
    }

    /// The trace of the second moments [kg·m²]: in the plane, the moment of inertia
    /// about the centroid.
    #[must_use]
    pub fn polar_inertia(&self) -> f64 {
        (0..D).map(|i| self.second_moments[i][i]).sum()
    }
}

impl<const D: usize> fmt::Display for Mass<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mass, error, centroid) = (self.mass(), self.mass_error(), self.centroid.0);
        write!(f, "{mass} ± {error} kg about {centroid:?} ± {} m", self.centroid_error)
    }
}

impl Mass<3> {
    /// The inertia tensor about the centroid [kg·m²]: the trace of the second moments
    /// times the identity, less the second moments.
    #[must_use]
    pub fn inertia(&self) -> [[f64; 3]; 3] {
        let trace = self.polar_inertia();
        std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                (if i == k { trace } else { 0.0 }) - self.second_moments[i][k]
            })
        })
    }
}

/// Volume, first and second moments of a set of points.
#[derive(Clone, Copy, Debug)]
struct Moments<const D: usize> {
    volume: f64,
    first: [f64; D],
    second: [[f64; D]; D],
}

impl<const D: usize> Moments<D> {
    const ZERO: Self = Self { volume: 0.0, first: [0.0; D], second: [[0.0; D]; D] };

    /// Adds `weight` times `other`.
    fn add(&mut self, other: &Self, weight: f64) {
        self.volume += weight * other.volume;
        for i in 0..D {
            self.first[i] += weight * other.first[i];
            for k in 0..D {
                self.second[i][k] += weight * other.second[i][k];
            }
        }
    }

    /// Those of the cube `[−1, 1]ᴰ`.
    fn of_cube() -> Self {
        let volume = 2.0_f64.powi(D as i32);
        let mut second = [[0.0; D]; D];
        for (i, row) in second.iter_mut().enumerate() {
            row[i] = volume / 3.0;
        }
        Self { volume, first: [0.0; D], second }
    }

    /// Those of the corner that a plane cuts off: the simplex of `corner` and the points `edges[i]`
    /// from it along some `axes`; along the others nothing is there.
    fn of_simplex(corner: &[f64; D], edges: &[f64; D], axes: &[usize]) -> Self {
        let mut volume = 1.0;
        for (i, axis) in axes.iter().enumerate() {
            volume *= edges[*axis] / (i + 1) as f64;
        }
        // Of the corners: one more than axes, of which one differs from `corner` in axis i.
        let count = (axes.len() + 1) as f64;
        let sum: [f64; D] = std::array::from_fn(|i| count * corner[i] + edges[i]);
        Self::of_corners(count, volume, &sum, |i, k| {
            let same = if i == k { edges[i] * edges[i] } else { 0.0 };
            count * corner[i] * corner[k] + corner[i] * edges[k] + edges[i] * corner[k] + same
        })
    }

    /// Those of a simplex, from the number of its corners, the sums of their coordinates and of the
    /// products of these.
    fn of_corners(
        count: f64,
        volume: f64,
        sum: &[f64; D],
        products: impl Fn(usize, usize) -> f64,
    ) -> Self {
        Self {
            volume,
            first: std::array::from_fn(|i| volume * sum[i] / count),
            second: std::array::from_fn(|i| {
                std::array::from_fn(|k| {
                    volume * (products(i, k) + sum[i] * sum[k]) / (count * (count + 1.0))
                })
            }),
        }
    }

    /// Those of the part of the cube `[−1, 1]ᴰ` with `slopes·x ≤ limit`.
    fn of_cube_below(slopes: &[f64; D], limit: f64) -> Self {
        let reach: f64 = slopes.iter().map(|slope| slope.abs()).sum();
        if limit <= -reach {
            return Self::ZERO;
        }
        if limit >= reach {
            return Self::of_cube();
        }
        // Along an axis without a slope the part goes through the cube.
        let mut all = [0; D];
        let mut count = 0;
        for axis in (0..D).filter(|axis| slopes[*axis] != 0.0) {
            all[count] = axis;
            count += 1;
        }
        let axes = &all[..count];
        // The volume to the left of a corner is positive too.
        let turned: f64 = axes.iter().map(|axis| slopes[*axis].signum()).product();
        let mut below = Self::ZERO;
        for code in 0..1_usize << count {
            // From the lowest corner, along the axes whose bits are set.
            let (mut corner, mut room) = ([0.0; D], limit);
            for (bit, axis) in axes.iter().enumerate() {
                let side = if (code >> bit) & 1 == 1 { 1.0 } else { -1.0 };
                corner[*axis] = side * slopes[*axis].signum();
                room -= side * slopes[*axis].abs();
            }
            if room > 0.0 {
                let mut edges = [0.0; D];
                for axis in axes {
                    edges[*axis] = room / slopes[*axis];
                }
                let sign = if code.count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
                below.add(&Self::of_simplex(&corner, &edges, axes), sign * turned);
            }
        }
        let mut through = Self::ZERO;
        through.add(&below, 2.0_f64.powi((D - count) as i32));
        for i in (0..D).filter(|i| slopes[*i] == 0.0) {
            through.second[i][i] = through.volume / 3.0;
        }
        through
    }

    /// These, of points scaled by `half` and moved to `centre`.
    fn placed(&self, centre: &[f64; D], half: &[f64; D]) -> Self {
        let scale: f64 = half.iter().product();
        let volume = scale * self.volume;
        let first: [f64; D] = std::array::from_fn(|i| scale * half[i] * self.first[i]);
        let second = |i: usize, k: usize| scale * half[i] * half[k] * self.second[i][k];
        Self {
            volume,
            first: std::array::from_fn(|i| first[i] + centre[i] * volume),
            second: std::array::from_fn(|i| {
                std::array::from_fn(|k| {
                    second(i, k)
                        + centre[i] * first[k]
                        + first[i] * centre[k]
                        + centre[i] * centre[k] * volume
                })
            }),
        }
    }
}

/// Part of the box of a shape, in coordinates from the middle of the box.
#[derive(Clone, Copy, Debug)]
struct MassCell<const D: usize> {
    centre: [f64; D],
    half: [f64; D],
}

impl<const D: usize> MassCell<D> {
    fn volume(&self) -> f64 {
        self.half.iter().map(|half| 2.0 * half).product()
    }

    /// The largest distance of a point of the cell from the middle of the box.
    fn farthest(&self) -> f64 {
        let squares = (0..D).map(|i| (self.centre[i].abs() + self.half[i]).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// Cut in two along every axis.
    fn parts(&self) -> impl Iterator<Item = Self> {
        let whole = *self;
        (0..1_usize << D).map(move |code| {
            let half = whole.half.map(|half| 0.5 * half);
            let side = |i: usize| if (code >> i) & 1 == 1 { half[i] } else { -half[i] };
            Self { centre: std::array::from_fn(|i| whole.centre[i] + side(i)), half }
        })
    }
}

/// The part of a cell that is inside.
#[derive(Clone, Copy, Debug)]
struct Filling<const D: usize> {
    cell: MassCell<D>,
    /// With half of what may be inside.
    moments: Moments<D>,
    /// The volume of what may be inside.
    unsure: f64,
}

impl<const D: usize> Filling<D> {
    /// The part that is inside, of a field whose values are off by at most `slack` [m].
    fn new(cell: MassCell<D>, model: &Model, slack: f64) -> Self {
        let largest = (0..D).fold(0.0_f64, |most, i| most.max(model.gradient[i].abs()));
        let mut moved = 0.0;
        let slopes = std::array::from_fn(|i| {
            let slope = model.gradient[i];
            if slope.abs() >= FLATTEST * largest {
                return slope;
            }
            moved += slope.abs();
            0.0
        });
        // Rounding of the limits: a few units of the numbers in them.
        let limits = 8.0 * f64::EPSILON * (model.value.abs() + D as f64 * largest);
        let rounded = limits + moved + slack;
        let sure = Moments::of_cube_below(&slopes, -model.value - model.upper - rounded);
        let possible = Moments::of_cube_below(&slopes, -model.value + model.lower + rounded);
        let mut moments = Moments::ZERO;
        moments.add(&sure, 0.5);
        moments.add(&possible, 0.5);
        let whole = Moments::<D>::of_cube().volume;
        let is_cut = possible.volume > 0.0 && sure.volume < whole;
        let cancelled = if is_cut { CANCELLATION } else { 0.0 };
        let share = (possible.volume - sure.volume).max(0.0) / whole;
        Self {
            cell,
            moments: moments.placed(&cell.centre, &cell.half),
            unsure: (share + cancelled) * cell.volume(),
        }
    }
}

/// Fills cells about `middle`, in blocks of models.
fn filled<const D: usize>(
    shape: &Shape<D>,
    middle: &[f64; D],
    slack: f64,
    cells: &[MassCell<D>],
) -> Vec<Filling<D>> {
    let mut fillings = Vec::with_capacity(cells.len());
    let mut block = Block::<Model, D, BLOCK>::zero();
    let mut values = Column::<Model, BLOCK>::zero();
    for cells in cells.chunks(BLOCK) {
        for (i, cell) in cells.iter().enumerate() {
            let centre = std::array::from_fn(|k| middle[k] + cell.centre[k]);
            block.set(i, Vector(Model::cell(centre, cell.half)));
        }
        shape.block_distances(&block, cells.len(), &mut values);
        fillings.extend(
            cells
                .iter()
                .enumerate()
                .map(|(i, cell)| Filling::new(*cell, &values.get(i), slack)),
        );
    }
    fillings
}

impl<const D: usize> Shape<D> {
    /// The mass of the shape at a `density` [kg/m³], its centroid and moments, with
    /// bounds on their errors.
    ///
    /// Cells are cut until the error of the volume is below the tolerance or the limit
    /// of cells is reached: then the errors are larger, and say so. Curves and sheets have no
    /// inside, and a volume of zero. A field of [faces](crate::CustomField::faces), moved and scaled at
    /// most, is summed over its faces.
    ///
    /// ```
    /// use palpate_field::{MassLimits, Shape, Vector, kernel::Ball};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let ball = Shape::from_kernel(Ball::new(0.5)?).translated(Vector([1.0, 0.0, 0.0]))?;
    /// let mass = ball.mass(1000.0, MassLimits::default())?;
    /// let volume = std::f64::consts::PI / 6.0;
    /// assert!((mass.volume - volume).abs() <= mass.volume_error);
    /// assert!(mass.volume_error <= 1e-3 * volume);
    /// assert!((mass.centroid[0] - 1.0).abs() <= mass.centroid_error);
    /// assert!(mass.to_string().starts_with(&format!("{} ± ", mass.mass())));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the shape has no bounds, or its steepness is known in a region alone, or the density or
    /// the tolerance is not positive.
    pub fn mass(&self, density: f64, limits: MassLimits) -> Result<Mass<D>, ShapeError> {
        let density = positive("density", density, Unit::One)?;
        let tolerance = positive("tolerance", limits.tolerance, Unit::One)?;
        let needs = |needs: &'static str| ShapeError::Unsuitable {
            operator: "mass",
            needs: needs.into(),
        };
        let Some(bounds) = self.promise().bounds else {
            return Err(needs("a shape with bounds"));
        };
        if self.promise().region.is_some() {
            return Err(needs("a shape whose steepness is known everywhere"));
        }
        if !self.promise().has_interior {
            return Ok(Total::new(&bounds.aabb).mass(density, &bounds.aabb.centre().0));
        }
        // Far from the origin a box may be smaller than the last place of its coordinates.
        let far = bounds.aabb.radius_about_origin();
        let moved = MIDDLE_ROUNDINGS * f64::EPSILON * far * D as f64;
        let slack = self.promise().rounding.within(far) + self.promise().lipschitz * moved;
        let aabb = bounds.aabb.grown(slack.max(moved));
        let middle = aabb.centre().0;
        let mut total = Total::new(&aabb);
        let mut faces = 0;
        if self.faces(&mut |_| faces += 1) {
            self.faces(&mut |face| total.take_face(&face, &middle, (slack, faces)));
            return Ok(total.mass(density, &middle));
        }
        let mut cells = vec![MassCell { centre: [0.0; D], half: aabb.half_extents().0 }];
        loop {
            let fillings = filled(self, &middle, slack, &cells);
            total.cells += cells.len();
            let unsure: f64 = fillings.iter().map(|filling| filling.unsure).sum();
            let volume: f64 = fillings.iter().map(|filling| filling.moments.volume).sum();
            let goal = tolerance * (total.moments.volume + volume);
            let left = 2.0 * goal - total.unsure;
            let most = limits.cells.saturating_sub(total.cells) >> D;
            let least = worth_cutting(&fillings, 0.5 * left, most);
            let is_done = unsure <= left || least.is_infinite();
            cells.clear();
            for filling in &fillings {
                if is_done || filling.unsure < least {
                    total.take(filling);
                } else {
                    cells.extend(filling.cell.parts());
                }
            }
            if is_done {
                return Ok(total.mass(density, &middle));
            }
        }
    }
}

/// The unsure volume from which on cells are cut, so that the other cells together have
/// at most `left` and no more than `most` are cut; infinity if none is.
fn worth_cutting<const D: usize>(fillings: &[Filling<D>], left: f64, most: usize) -> f64 {
    let mut unsure: Vec<f64> =
        fillings.iter().map(|filling| filling.unsure).filter(|unsure| *unsure > 0.0).collect();
    unsure.sort_by(f64::total_cmp);
    let mut kept = 0.0;
    let is_kept = |unsure: &&f64| {
        kept += **unsure;
        kept <= left
    };
    let small = unsure.iter().take_while(is_kept).count();
    // Cells that are equally unsure are cut together, or not at all if they are too many.
    let first = small.max(unsure.len().saturating_sub(most));
    let Some(least) = unsure.get(first).copied() else { return f64::INFINITY };
    if unsure.len() - unsure.partition_point(|unsure| *unsure < least) <= most {
        return least;
    }
    let larger = unsure.partition_point(|unsure| *unsure <= least);
    unsure.get(larger).copied().unwrap_or(f64::INFINITY)
}

/// The sum over the cells that are done.
struct Total<const D: usize> {
    moments: Moments<D>,
    unsure: f64,
    /// `∫ |p|` and `∫ |p|²` over what is unsure, at most.
    unsure_first: f64,
    unsure_second: f64,
    /// The largest distance from the middle of the box.
    reach: f64,
    cells: usize,
}

impl<const D: usize> Total<D> {
    fn new(aabb: &Aabb<D>) -> Self {
        Self {
            moments: Moments::ZERO,
            unsure: 0.0,
            unsure_first: 0.0,
            unsure_second: 0.0,
            reach: aabb.half_extents().norm(),
            cells: 0,
        }
    }

    fn take(&mut self, filling: &Filling<D>) {
        self.add(&filling.moments, filling.unsure, filling.cell.farthest());
    }

    /// Adds moments, of which so much volume is unsure, not farther than `farthest` from the middle.
    fn add(&mut self, moments: &Moments<D>, unsure: f64, farthest: f64) {
        self.moments.add(moments, 1.0);
        self.unsure += unsure;
        self.unsure_first += unsure * farthest;
        self.unsure_second += unsure * farthest * farthest;
    }

    /// The result, with the error of sums of so many terms.
    fn mass(&self, density: f64, middle: &[f64; D]) -> Mass<D> {
        let Moments { volume, first, second } = self.moments;
        let summed = self.cells as f64 * f64::EPSILON * volume.abs();
        let volume_error = 0.5 * self.unsure + summed;
        let first_error = 0.5 * self.unsure_first + summed * self.reach;
        let second_error = 0.5 * self.unsure_second + summed * self.reach * self.reach;
        let least = volume - volume_error;
        let about: [f64; D] =
            first.map(|first| if volume > 0.0 { first / volume } else { 0.0 });
        let offset = Vector(about).norm();
        let centroid_error = if least > 0.0 {
            (first_error + offset * volume_error) / least
        } else {
            f64::INFINITY
        };
        // S − V c cᵀ: the errors of S, of V and of both factors c.
        let shift = if volume + volume_error > 0.0 {
            volume_error * offset * offset
                + volume * centroid_error * (2.0 * offset + centroid_error)
        } else {
            0.0
        };
        Mass {
            volume,
            volume_error,
            density,
            centroid: Vector(std::array::from_fn(|i| middle[i] + about[i])),
            centroid_error,
            second_moments: std::array::from_fn(|i| {
                std::array::from_fn(|k| density * (second[i][k] - volume * about[i] * about[k]))
            }),
            second_moments_error: density * (second_error + shift),
            cells: self.cells,
        }
    }
}

/// Rounded operations of the volume of one simplex.
const OPERATIONS: f64 = 32.0;

impl<const D: usize> Total<D> {
    /// Adds the simplex of a face and the middle, negative if the middle is on the face's outer side. The corners may
    /// be off by `slack` [m], and `faces` are added in all.
    fn take_face(
        &mut self,
        face: &[Point<D>; D],
        middle: &[f64; D],
        (slack, faces): (f64, usize),
    ) {
        let corners = face.map(|corner| corner - Vector(*middle));
        let mut cells = 1.0;
        for i in 2..=D {
            cells *= i as f64;
        }
        let volume = corners[0].dot(Vector::across(face)) / cells;
        let mut sum = [0.0; D];
        for (i, sum) in sum.iter_mut().enumerate() {
            *sum = corners.iter().map(|corner| corner[i]).sum();
        }
        let products =
            |i: usize, k: usize| corners.iter().map(|corner| corner[i] * corner[k]).sum();
        let moments = Moments::of_corners((D + 1) as f64, volume, &sum, products);
        let longest = face.iter().fold(0.0_f64, |longest, corner| {
            longest.max((*corner - face[0]).norm()).max((*corner - face[D - 1]).norm())
        });
        let farthest = corners.iter().fold(0.0_f64, |far, corner| far.max(corner.norm()));
        // Of the determinant, and of a sum of so many terms.
        let rounding = (OPERATIONS + faces as f64) * f64::EPSILON;
        let across = |reach: f64| reach.powi(D as i32 - 1);
        let rounded = rounding * farthest * across(longest);
        // What the face sweeps if its corners move.
        let swept = slack * across(longest + 2.0 * slack);
        self.add(&moments, 2.0 * (rounded + swept), farthest + slack);
    }
}
