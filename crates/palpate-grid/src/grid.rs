// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Grids as fields.
//!
//! Values beyond the band of a sparse grid.
//!
//! A second lattice with cells eight times as large has samples of the same source, interpolated as well. What it
//! says, less its own deviation and less what the source may exceed the band by where values reach it, is at most
//! the source's distance, and at most the band at its border: the larger of both values is continuous.

use std::sync::Arc;

use palpate_field::scalar::AffineModel;
use palpate_field::{
    Aabb, Bounds, CustomField, Deviation, LARGEST_LENGTH, Point, Promise, Quantity, Rounding,
    Shape, ShapeError, Unit, Vector,
};

use crate::bake::{GridOptions, MOST_TAPS, apply, each, fits, gather};
use crate::certificate::{Cells, Certificate};
use crate::error::GridError;
use crate::samples::{BRICK, Codes, Order, Samples, Store, WIDE, strides};
use crate::slopes::{Curvature, SLOPE_BLOCK, Slopes};
use crate::spline::{GridKernel, OfTaps, QUADRATIC, Spline, TRILINEAR};

/// Rounded operations of an interpolated value on numbers up to `|p| + size`.
const OPERATIONS: f64 = 96.0;

/// Samples of a signed distance at the nodes of a lattice, interpolated: a field.
///
/// Within the lattice the value is a B-spline of the samples; outside it grows with the distance to the lattice,
/// and never exceeds the Lipschitz constant times the distance to the surface. The [`Promise`] holds the Lipschitz
/// constant, from the control values of every cell's gradient, and the deviation from the shape that was baked.
#[derive(Clone, Debug)]
pub struct Grid<const D: usize> {
    lattice: Lattice<D>,
    kernel: GridKernel,
    pub(crate) samples: Samples<D>,
    pub(crate) certificates: Vec<Certificate<D>>,
    slopes: Slopes<D>,
    /// The box of the cells [m].
    region: Aabb<D>,
    /// How far the formula outside takes the surface to be from the box [m].
    margin: f64,
    pub(crate) far: Option<Far<D>>,
    /// From this size on a value may be clamped [m].
    clamped: f64,
    promise: Promise<D>,
    pub(crate) source: Option<Arc<(Shape<D>, GridOptions)>>,
}

impl<const D: usize> Grid<D> {
    /// The lattice of its nodes.
    #[must_use]
    pub fn lattice(&self) -> &Lattice<D> {
        &self.lattice
    }

    /// How it interpolates.
    #[must_use]
    pub fn kernel(&self) -> GridKernel {
        self.kernel
    }

    /// How its samples are stored.
    #[must_use]
    pub fn store(&self) -> Store {
        self.samples.codes.store()
    }

    /// The samples that are stored: of sparse grids each brick's, those at its border too.
    #[must_use]
    pub fn stored_samples(&self) -> usize {
        self.samples.codes.len()
    }

    /// The samples [m], one for each node, the first axis first, where they are all that is known of the grid, as of one
    /// [of samples](Self::from_samples) in single precision; `None` of others.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_grid::{Grid, GridKernel, Lattice, Store};
    ///
    /// # fn main() -> Result<(), palpate_grid::GridError> {
    /// let lattice = Lattice { origin: Vector([-1.0, -1.0]), cell: 1.0, counts: [3, 3] };
    /// let samples = [0.5, 0.5, 0.5, 0.5, -0.25, 0.5, 0.5, 0.5, 0.5];
    /// let grid = Grid::from_samples(lattice, &samples, GridKernel::Trilinear, Store::F32)?;
    /// assert_eq!(grid.samples(), Some(samples.to_vec()));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    #[inline(never)]
    pub fn samples(&self) -> Option<Vec<f64>> {
        let is_known_by_them = self.promise.deviation.is_none() && self.far.is_none();
        match (&self.samples.codes, &self.samples.order) {
            (Codes::F32(codes), Order::Dense { .. }) if is_known_by_them => {
                Some(codes.iter().map(|code| f64::from(*code)).collect())
            }
            _ => None,
        }
    }

    /// The size to which values are clamped [m]; infinite if they are not.
    #[must_use]
    pub fn band(&self) -> f64 {
        self.samples.band
    }

    /// What its values promise.
    #[must_use]
    pub fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    /// The shape of which it was baked, and what was asked for; `None` if it was read from a file, made of samples or
    /// rebuilt.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_grid::{Grid, GridOptions};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (ball, options) = (Shape::circle(0.05)?, GridOptions::with_cell(0.01));
    /// assert_eq!(Grid::bake(&ball, &options)?.source(), Some((&ball, &options)));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn source(&self) -> Option<(&Shape<D>, &GridOptions)> {
        self.source.as_deref().map(|(shape, options)| (shape, options))
    }

    /// How far its values are certified to be off those of its source [m]; infinite if that is not known.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        let deviation = self.promise.deviation.and_then(|deviation| deviation.of_surface());
        deviation.unwrap_or(f64::INFINITY)
    }

    /// Puts certified samples together.
    pub(crate) fn assemble(
        lattice: Lattice<D>,
        kernel: GridKernel,
        samples: Samples<D>,
        certificates: Vec<Certificate<D>>,
        known: Known<D>,
    ) -> Result<Self, GridError> {
        let Known { compared, far } = known;
        let cell = lattice.cell;
        let reach = 0.5 * kernel.taps() as f64;
        let mut inside: Option<[[usize; 2]; D]> = None;
        for span in certificates.iter().filter_map(|certificate| certificate.inside) {
            let whole = inside.get_or_insert(span);
            for i in 0..D {
                whole[i] = [whole[i][0].min(span[i][0]), whole[i][1].max(span[i][1])];
            }
        }
        let inside = inside.ok_or(GridError::NoInside { cell })?;
        let first = Vector(inside.map(|span| span[0] as f64 - reach));
        let last = Vector(inside.map(|span| span[1] as f64 + reach));
        let region = region(&lattice, kernel);
        let bounds = Aabb { min: lattice.at(first), max: lattice.at(last) };
        for i in 0..D {
            if bounds.min[i] < region.min[i] || bounds.max[i] > region.max[i] {
                let mut node = lattice.region().centre();
                let at_start = bounds.min[i] < region.min[i];
                node[i] = lattice.node(inside.map(|span| span[usize::from(!at_start)]))[i];
                return Err(GridError::AtBorder { cell, node: node.0.to_vec() });
            }
        }
        // Codes of the band are rounded.
        let clamped = samples.band * (1.0 - 1e-6);
        let lipschitz =
            certificates.iter().fold(0.0_f64, |l, certificate| l.max(certificate.steepness));
        let far = far.map(|far| far.no_steeper(lipschitz));
        let parts = BRICK / SLOPE_BLOCK;
        let slopes = Slopes::new(samples.bricks, parts, |brick| {
            &certificates[raveled(brick, samples.bricks)].slopes
        });
        let size = region.radius_about_origin();
        // The compared source is at least the distance to its own box. The bounds include that box, so that a guard
        // raises the grid no further.
        let all = compared.map_or(bounds, |source| bounds.union(&source.bounds));
        // The place in a cell is rounded, and so are the products with samples.
        let largest = samples.codes.largest() * samples.scale;
        let of_samples =
            Rounding { constant: OPERATIONS * f64::EPSILON * largest, per_metre: 0.0 };
        let rounding = Rounding::of_operations(OPERATIONS, size)
            .times(lipschitz.max(1.0))
            .plus(&of_samples);
        let promise =
            Promise::lipschitz(Some(Bounds::of_box(all)), lipschitz).with_rounding(rounding);
        let mut grid = Self {
            lattice,
            kernel,
            samples,
            certificates,
            slopes,
            region,
            margin: 0.0,
            far,
            clamped,
            promise,
            source: None,
        };
        let [least, margin] = match kernel {
            GridKernel::Quadratic => grid.border::<QUADRATIC>(&bounds),
            GridKernel::Trilinear => grid.border::<TRILINEAR>(&bounds),
        };
        // What is beyond the band may be as steep along the box as the grid at all.
        grid.margin = if grid.far.is_some() { 0.0 } else { margin };
        grid.promise.deviation = compared.map(|source| Deviation {
            // Outside, values are at least the least at the border, and the source's at least the distance to its bounds.
            within: source.deviation.within.min(least).min(grid.gap(&source.bounds)),
            ..source.deviation
        });
        Ok(grid)
    }

    /// How far the region goes beyond bounds, at least [m].
    fn gap(&self, bounds: &Aabb<D>) -> f64 {
        let gaps = (0..D).flat_map(|i| {
            [bounds.min[i] - self.region.min[i], self.region.max[i] - bounds.max[i]]
        });
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// The least value at the border of the region, and how far the formula outside may take the surface to be from
    /// it without being steeper than the grid [m].
    fn border<const K: usize>(&self, bounds: &Aabb<D>) -> [f64; 2]
    where
        OfTaps<K>: Spline<K>,
    {
        let mut margin = self.gap(bounds);
        let mut least = f64::INFINITY;
        let last = self.lattice.counts.map(|count| count - K);
        let mut samples = Vec::new();
        let mut taps = [0.0; MOST_TAPS];
        let taps = &mut taps[..K.pow(D as u32)];
        for brick in indices([0; D], self.samples.bricks) {
            let keys = |i: usize| [brick[i] * BRICK, brick[i] * BRICK + BRICK - 1];
            let is_at_border =
                (0..D).any(|i| keys(i)[0] <= K - 2 || keys(i)[1] >= last[i] + K - 2);
            if !is_at_border {
                continue;
            }
            self.samples.brick(brick, self.lattice.counts, &mut samples);
            for own in indices([0; D], [BRICK; D]) {
                let key: [usize; D] = std::array::from_fn(|i| brick[i] * BRICK + own[i]);
                if (0..D).any(|i| key[i] < K - 2 || key[i] > last[i] + K - 2) {
                    continue;
                }
                let first = key.map(|key| key + 2 - K);
                let side = |i: usize| match first[i] {
                    0 => Some(0),
                    index if index == last[i] => Some(K - 1),
                    _ => None,
                };
                let sides: [Option<usize>; D] = std::array::from_fn(side);
                if sides.iter().all(Option::is_none) {
                    continue;
                }
                let place = raveled(own.map(|own| own + 3 - K), [WIDE; D]);
                gather::<K, D>(&samples, place, taps);
                let lipschitz = self.promise.lipschitz;
                let here = at_border::<K, D>(taps, sides, self.lattice.cell, lipschitz);
                least = least.min(here[0]);
                margin = margin.min(here[1]);
            }
        }
        [least, margin.max(0.0)]
    }

    /// The value [m] and the gradient at a point of the region.
    #[inline]
    fn inner_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let (value, slope) = match self.kernel {
            GridKernel::Quadratic => {
                let (first, local) = self.lattice.locate::<QUADRATIC>(p);
                self.samples.value_slope::<QUADRATIC>(first, local)
            }
            GridKernel::Trilinear => {
                let (first, local) = self.lattice.locate::<TRILINEAR>(p);
                self.samples.value_slope::<TRILINEAR>(first, local)
            }
        };
        let found = (value, slope * (1.0 / self.lattice.cell));
        match &self.far {
            Some(far) if value.abs() >= self.clamped => far.or_larger(p, found),
            _ => found,
        }
    }

    #[inline]
    fn inner(&self, p: Point<D>) -> f64 {
        let value = match self.kernel {
            GridKernel::Quadratic => {
                let (first, local) = self.lattice.locate::<QUADRATIC>(p);
                self.samples.value::<QUADRATIC>(first, local)
            }
            GridKernel::Trilinear => {
                let (first, local) = self.lattice.locate::<TRILINEAR>(p);
                self.samples.value::<TRILINEAR>(first, local)
            }
        };
        match &self.far {
            Some(far) if value.abs() >= self.clamped => {
                far.or_larger(p, (value, Vector::ZERO)).0
            }
            _ => value,
        }
    }

    /// `true` where a value that the samples give may be clamped, and what is beyond the band tells more.
    #[inline]
    pub(crate) fn may_be_clamped(&self, value: f64) -> bool {
        self.far.is_some() && value.abs() >= self.clamped
    }

    /// The box of the cells [m].
    #[inline]
    pub(crate) fn region(&self) -> &Aabb<D> {
        &self.region
    }

    #[inline]
    fn nearest_inside(&self, p: Point<D>) -> Point<D> {
        Vector(std::array::from_fn(|i| p[i].max(self.region.min[i]).min(self.region.max[i])))
    }

    /// The value at a point [m].
    #[inline]
    pub(crate) fn value_at(&self, p: Point<D>) -> f64 {
        let q = self.nearest_inside(p);
        let away = p - q;
        if away == Vector::ZERO {
            return self.inner(q);
        }
        outside(away, (self.inner(q), Vector::ZERO), self.promise.lipschitz, self.margin).0
    }

    /// The value at a point [m] and its gradient.
    #[inline]
    pub(crate) fn at(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let q = self.nearest_inside(p);
        let away = p - q;
        let inner = self.inner_gradient(q);
        if away == Vector::ZERO {
            return inner;
        }
        outside(away, inner, self.promise.lipschitz, self.margin)
    }

    /// The tangent plane at the centre of a box of half sides [m]; `None` where it is not known how far values are off it,
    /// as of large boxes.
    pub(crate) fn tangent(
        &self,
        centre: Point<D>,
        around: &Aabb<D>,
        half: Vector<f64, D>,
    ) -> Option<Tangent<D>> {
        if !self.is_within(around) {
            return None;
        }
        let curvature = match self.kernel {
            GridKernel::Quadratic => self.curvature::<QUADRATIC>(around),
            GridKernel::Trilinear => self.curvature::<TRILINEAR>(around),
        }?;
        let at = self.at(centre);
        let reach = self.promise.lipschitz * half.norm();
        let is_spline = self.far.is_none() || at.0.abs() + reach < self.clamped;
        is_spline.then(|| Tangent { at, off: curvature.off_tangent(self.lattice.cell, half.0) })
    }

    fn curvature<const K: usize>(&self, around: &Aabb<D>) -> Option<Curvature<D>> {
        let [first, last] = [around.min, around.max].map(|p| self.lattice.locate::<K>(p).0);
        self.samples.curvature::<K>(first, last)
    }

    fn is_within(&self, around: &Aabb<D>) -> bool {
        (0..D)
            .all(|i| self.region.min[i] <= around.min[i] && around.max[i] <= self.region.max[i])
    }

    /// The middle and half the range of each derivative over a box, at whose centre the value has a size [m]; `None`
    /// where the box leaves the region.
    pub(crate) fn slopes_over(&self, around: &Aabb<D>, size: f64) -> Option<[[f64; 2]; D]> {
        if !self.is_within(around) {
            return None;
        }
        let mut slopes = match self.kernel {
            GridKernel::Quadratic => self.slopes.of_box::<QUADRATIC>(&self.lattice, around),
            GridKernel::Trilinear => self.slopes.of_box::<TRILINEAR>(&self.lattice, around),
        };
        let reach = self.promise.lipschitz * around.half_extents().norm();
        if let Some(far) = self.far.as_ref().filter(|_| size + reach >= self.clamped) {
            for (slope, far) in slopes.iter_mut().zip(far.slopes_over(around)) {
                *slope = [slope[0].min(far[0]), slope[1].max(far[1])];
            }
        }
        Some(slopes.map(|[least, largest]| {
            let half = 0.5 * (largest - least) * (1.0 + 8.0 * f64::EPSILON);
            [0.5 * (least + largest), half]
        }))
    }
}

/// A plane that values over a box are near.
pub(crate) struct Tangent<const D: usize> {
    /// The value at the centre of the box [m], and its gradient.
    pub(crate) at: (f64, Vector<f64, D>),
    /// How far values are below the plane and above it, at most [m].
    pub(crate) off: [f64; 2],
}

/// What is known of the source of a grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compared<const D: usize> {
    pub(crate) deviation: Deviation,
    pub(crate) bounds: Aabb<D>,
}

/// What is known of a grid beside its samples.
#[derive(Clone, Debug, Default)]
pub(crate) struct Known<const D: usize> {
    /// `None` if it has no source.
    pub(crate) compared: Option<Compared<D>>,
    /// Values beyond the band; `None` if all are within, or nothing is known beyond.
    pub(crate) far: Option<Far<D>>,
}

/// The box of the cells: every point of it has all the samples that its value takes.
pub(crate) fn region<const D: usize>(lattice: &Lattice<D>, kernel: GridKernel) -> Aabb<D> {
    let start = 0.5 * kernel.taps() as f64 - 1.0;
    Aabb {
        min: lattice.at(Vector([start; D])),
        max: lattice.at(Vector(lattice.counts.map(|count| (count - 1) as f64 - start))),
    }
}

impl<const D: usize> CustomField<D> for Grid<D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.value_at(p)
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.at(p)
    }

    fn distances(&self, points: &[Point<D>], distances: &mut [f64]) {
        self.values_at(points, distances);
    }

    fn distances_gradients(
        &self,
        points: &[Point<D>],
        distances: &mut [f64],
        gradients: &mut [Vector<f64, D>],
    ) {
        self.all_at(points, distances, gradients);
    }

    fn promise(&self) -> &Promise<D> {
        self.promise()
    }

    /// Over a few cells the tangent plane at the centre, and how far second derivatives lead off it. Over more the mean
    /// value form: the value at the centre, the middle of the range of each derivative over the box around the cell,
    /// and half the range times half the box for what it leaves open.
    fn model<const M: usize>(&self, cell: &[AffineModel<M>; D]) -> AffineModel<M> {
        let centre = Vector(cell.map(|x| x.value));
        let half = Vector(cell.map(|x| x.deviation()));
        let rounding = self.promise().rounding.within(centre.norm() + half.norm());
        let around = Aabb { min: centre - half, max: centre + half };
        let tangent = self.tangent(centre, &around, half);
        let (value, slopes, [below, above]) = match tangent {
            Some(Tangent { at: (value, slope), off }) => (value, slope, off),
            None => {
                let value = self.value_at(centre);
                let Some(slopes) = self.slopes_over(&around, value.abs()) else {
                    let lipschitz = self.promise().lipschitz;
                    return AffineModel::lipschitz(value, lipschitz, cell, rounding);
                };
                let off = (0..D).map(|i| slopes[i][1] * half[i]).sum();
                (value, Vector(slopes.map(|[middle, _]| middle)), [off; 2])
            }
        };
        let mut gradient = [0.0; M];
        // The slopes are rounded too.
        let mut remainder = 2.0 * rounding;
        for i in 0..D {
            for (k, gradient) in gradient.iter_mut().enumerate() {
                *gradient += slopes[i] * cell[i].gradient[k];
            }
            let bent = cell[i].lower.max(cell[i].upper);
            remainder += slopes[i].abs() * (bent + 4.0 * f64::EPSILON * half[i]);
        }
        let [lower, upper] =
            [below, above].map(|off| (off + remainder) * (1.0 + 16.0 * f64::EPSILON));
        AffineModel { value, gradient, lower, upper }
    }

    /// The bytes of its file.
    #[cfg(feature = "files")]
    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        self.put(Sink(sink)).is_ok()
    }
}

/// What is fed as what is written.
#[cfg(feature = "files")]
struct Sink<'a>(&'a mut dyn FnMut(&[u8]));

#[cfg(feature = "files")]
impl std::io::Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        (self.0)(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl<const D: usize> From<Grid<D>> for Shape<D> {
    #[inline(never)]
    fn from(grid: Grid<D>) -> Self {
        Self::custom(grid)
    }
}

/// Nodes at `origin + cell·i`, with `counts` of them along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice<const D: usize> {
    /// The first node [m].
    pub origin: Point<D>,
    /// The distance of neighbours along each axis [m].
    pub cell: f64,
    /// How many nodes there are along each axis.
    pub counts: [usize; D],
}

impl<const D: usize> Lattice<D> {
    /// The nodes of a box that is grown to whole cells about its centre.
    #[must_use]
    pub fn over(region: &Aabb<D>, cell: f64) -> Self {
        let counts =
            std::array::from_fn(|i| ((region.max[i] - region.min[i]) / cell).ceil() as usize);
        let counts = counts.map(|cells: usize| cells.saturating_add(1));
        let size = Vector(std::array::from_fn(|i| (counts[i] - 1) as f64 * cell));
        Self { origin: region.centre() - size * 0.5, cell, counts }
    }

    /// A node's place [m].
    #[must_use]
    #[inline]
    pub fn node(&self, index: [usize; D]) -> Point<D> {
        self.at(Vector(index.map(|i| i as f64)))
    }

    /// The place of an index that need not be whole [m].
    #[inline]
    pub(crate) fn at(&self, index: Vector<f64, D>) -> Point<D> {
        self.origin + index * self.cell
    }

    /// The first sample of the cell that a point lies in, and where in the cell it lies, from 0 to 1 along each axis.
    #[inline(always)]
    pub(crate) fn locate<const K: usize>(&self, p: Point<D>) -> ([usize; D], [f64; D]) {
        let inverse = 1.0 / self.cell;
        let (mut first, mut local) = ([0; D], [0.0; D]);
        for i in 0..D {
            let along = (p[i] - self.origin[i]) * inverse - (0.5 * K as f64 - 1.0);
            first[i] = (along as usize).min(self.counts[i] - K);
            local[i] = along - first[i] as f64;
        }
        (first, local)
    }

    /// How many nodes there are, if a number can say it.
    #[must_use]
    pub fn nodes(&self) -> Option<usize> {
        self.counts.iter().try_fold(1_usize, |product, count| product.checked_mul(*count))
    }

    /// Whether there are at most so many nodes.
    pub(crate) fn has_at_most(&self, limit: usize) -> bool {
        self.nodes().is_some_and(|nodes| nodes <= limit)
    }

    /// Refuses nodes that are farther from the origin than [`LARGEST_LENGTH`] along an axis.
    pub(crate) fn check(&self) -> Result<(), GridError> {
        let region = self.region();
        let beyond = [region.min, region.max]
            .into_iter()
            .flat_map(|corner| corner.0)
            .find(|x| x.is_nan() || x.abs() > LARGEST_LENGTH);
        beyond.map_or(Ok(()), |value| {
            Err(GridError::Number(ShapeError::Number {
                parameter: "a coordinate of a node".into(),
                rule: "at most 1e15 m in size".into(),
                value: Quantity(value, Unit::Metre),
            }))
        })
    }

    /// The box between the first and the last node [m].
    #[must_use]
    pub fn region(&self) -> Aabb<D> {
        Aabb { min: self.origin, max: self.node(self.counts.map(|count| count - 1)) }
    }
}

/// The index along each axis of the `number`th of as many as the product of `counts`, the first axis first.
#[inline]
pub(crate) fn unravelled<const D: usize>(number: usize, counts: [usize; D]) -> [usize; D] {
    let mut rest = number;
    counts.map(|count| {
        let index = rest % count;
        rest /= count;
        index
    })
}

/// The number of an index among as many as the product of `counts`, the first axis first.
#[inline]
pub(crate) fn raveled<const D: usize>(index: [usize; D], counts: [usize; D]) -> usize {
    (0..D).rev().fold(0, |number, i| number * counts[i] + index[i])
}

/// Every index with coordinates from `first` to one less than `end`, the first axis first.
pub(crate) fn indices<const D: usize>(
    first: [usize; D],
    end: [usize; D],
) -> impl Iterator<Item = [usize; D]> {
    let counts: [usize; D] = std::array::from_fn(|i| end[i].saturating_sub(first[i]));
    (0..counts.iter().product()).map(move |number| {
        let index = unravelled(number, counts);
        std::array::from_fn(|i| first[i] + index[i])
    })
}

/// How many times as large its cells are.
const COARSER: f64 = 8.0;

/// A lattice of large cells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Far<const D: usize> {
    lattice: Lattice<D>,
    pub(crate) samples: Samples<D>,
    slopes: Slopes<D>,
    lipschitz: f64,
    /// What its values are multiplied by, so that they are no steeper than the grid's own.
    share: f64,
    /// What is taken off its values [m].
    pub(crate) reach: f64,
}

impl<const D: usize> Far<D> {
    /// The lattice beside a fine one.
    pub(crate) fn lattice(fine: &Lattice<D>) -> Lattice<D> {
        let cell = COARSER * fine.cell;
        // Values reach to half a cell from the first node and the last.
        Lattice::over(&fine.region().grown(0.5 * cell), cell)
    }

    /// Of a source, which exceeds the band by at most `reach` [m] where the fine lattice has a value within it.
    pub(crate) fn of(
        source: &Shape<D>,
        fine: &Lattice<D>,
        reach: f64,
    ) -> Result<Self, GridError> {
        let lattice = Self::lattice(fine);
        let nodes = lattice.counts.iter().product::<usize>();
        let samples = each(nodes, |number| {
            let node = lattice.node(unravelled(number, lattice.counts));
            match source.distance(node) {
                sample if fits(sample) => Ok(sample as f32),
                _ => Err(GridError::NotFinite { point: node.0.to_vec() }),
            }
        })?;
        let largest = samples.iter().fold(0.0_f32, |largest, sample| largest.max(sample.abs()));
        let own = 0.5 * source.promise().lipschitz * (D as f64).sqrt() * lattice.cell;
        let stored = Store::F32.error(largest.into(), 1.0);
        Self::of_samples(fine, samples, (reach + own + stored) * (1.0 + 1e-9))
    }

    /// Of samples, as a file holds them.
    pub(crate) fn of_samples(
        fine: &Lattice<D>,
        samples: Vec<f32>,
        reach: f64,
    ) -> Result<Self, GridError> {
        let lattice = Self::lattice(fine);
        let bricks = lattice.counts.map(|count| count.div_ceil(BRICK));
        let samples = Samples {
            codes: Codes::F32(samples),
            scale: 1.0,
            band: f64::INFINITY,
            order: Order::Dense { strides: strides(lattice.counts) },
            bricks,
        };
        let cells = Cells::without_source(&lattice);
        let certificates = each(bricks.iter().product(), |number| {
            Ok(cells.of_brick::<QUADRATIC>(&samples, unravelled(number, bricks)))
        })?;
        let lipschitz =
            certificates.iter().fold(0.0_f64, |l, certificate| l.max(certificate.steepness));
        let slopes = Slopes::new(bricks, BRICK / SLOPE_BLOCK, |brick| {
            &certificates[raveled(brick, bricks)].slopes
        });
        Ok(Self { lattice, samples, slopes, lipschitz, share: 1.0, reach })
    }

    /// The same, no steeper than `lipschitz`.
    pub(crate) fn no_steeper(self, lipschitz: f64) -> Self {
        // A flat lattice is no steeper than any.
        let steep = self.lipschitz.max(f64::MIN_POSITIVE);
        let share = (lipschitz / steep).min(1.0) * (1.0 - 1e-12);
        Self { share, ..self }
    }

    /// The value, or the one given if that is larger in size, and its gradient.
    #[cold]
    pub(crate) fn or_larger(
        &self,
        p: Point<D>,
        (value, slope): (f64, Vector<f64, D>),
    ) -> (f64, Vector<f64, D>) {
        let (first, local) = self.lattice.locate::<QUADRATIC>(p);
        let (far, steep) = self.samples.value_slope::<QUADRATIC>(first, local);
        let size = self.share * far.abs() - self.reach;
        if size <= value.abs() {
            return (value, slope);
        }
        (size.copysign(value), steep * (self.share / self.lattice.cell))
    }

    /// The least and the largest of each derivative over a box.
    pub(crate) fn slopes_over(&self, around: &Aabb<D>) -> [[f64; 2]; D] {
        let slopes = self.slopes.of_box::<QUADRATIC>(&self.lattice, around);
        slopes.map(|ends| ends.map(|slope| slope * self.share))
    }
}

/// The value at `a` from the nearest point of the box [m], where the grid has `value` [m] and gradient `slope`:
///
/// ```text
/// √(L²(|a|² + 2m·|a|₁) + value²)
/// ```
///
/// `L` is the grid's Lipschitz constant, and `m` a distance that the surface keeps from every face. A point s of
/// the surface has `a·(q − s) ≥ m·|a|₁` for the nearest point q of the box, so `|p − s|² ≥ |a|² + 2m·|a|₁ +
/// |q − s|²`: the value is at most `L` times the distance to the surface.
pub(crate) fn outside<const D: usize>(
    away: Vector<f64, D>,
    (value, slope): (f64, Vector<f64, D>),
    lipschitz: f64,
    margin: f64,
) -> (f64, Vector<f64, D>) {
    let sum: f64 = away.0.iter().map(|a| a.abs()).sum();
    let square = lipschitz * lipschitz;
    let result = (square * (away.dot(away) + 2.0 * margin * sum) + value * value).sqrt();
    if !result.is_finite() {
        // NaN, or too far away for squares.
        return (result, Vector::ZERO);
    }
    let gradient = std::array::from_fn(|i| {
        if away[i] == 0.0 {
            value * slope[i] / result
        } else {
            square * (away[i] + margin.copysign(away[i])) / result
        }
    });
    (result, Vector(gradient))
}

/// Of a cell with faces on the border of the box, the least value on these, and the largest `m` with which no value
/// outside next to them is steeper than `lipschitz`. `sides` has the index of the control values on these faces.
///
/// Where n coordinates are outside, the square of the steepness is `(L²(g² − f²) + L⁴n·m² + f²|∇ₜf|²)/g²`, with
/// g the value outside, f that at the box, and ∇ₜf the gradient along the box. That is at most L² if
/// `L²n·m² ≤ f²(1 − |∇ₜf|²/L²)`.
pub(crate) fn at_border<const K: usize, const D: usize>(
    taps: &[f64],
    sides: [Option<usize>; D],
    cell: f64,
    lipschitz: f64,
) -> [f64; 2]
where
    OfTaps<K>: Spline<K>,
{
    let controls = |slope: Option<usize>| {
        let mut control = [0.0; MOST_TAPS];
        let numbers = &mut control[..taps.len()];
        numbers.copy_from_slice(taps);
        for axis in 0..D {
            let shares =
                if Some(axis) == slope { &OfTaps::<K>::SLOPES } else { &OfTaps::<K>::VALUES };
            apply::<K, D>(numbers, axis, shares);
        }
        control
    };
    let values = controls(None);
    let slopes: [[f64; MOST_TAPS]; D] = std::array::from_fn(|axis| controls(Some(axis)));
    let (mut least, mut margin) = (f64::INFINITY, f64::INFINITY);
    // Each face, edge and corner of the box that the cell touches.
    for outside in 1..1_usize << D {
        let is_outside = |axis: usize| (outside >> axis) & 1 == 1;
        if (0..D).any(|axis| is_outside(axis) && sides[axis].is_none()) {
            continue;
        }
        let mut value = f64::INFINITY;
        let mut tangents = [0.0_f64; D];
        for number in 0..taps.len() {
            let index: [usize; D] = unravelled(number, [K; D]);
            if (0..D).any(|axis| is_outside(axis) && sides[axis] != Some(index[axis])) {
                continue;
            }
            value = value.min(values[number]);
            for axis in (0..D).filter(|axis| !is_outside(*axis)) {
                tangents[axis] = tangents[axis].max(slopes[axis][number].abs());
            }
        }
        let steep = tangents.iter().map(|t| t * t).sum::<f64>().sqrt() / (cell * lipschitz);
        let rest = (1.0 - steep * steep).max(0.0);
        let axes = f64::from((outside as u32).count_ones());
        least = least.min(value);
        margin = margin.min(value * (rest / axes).sqrt() / lipschitz);
    }
    [least, margin * (1.0 - 1e-12)]
}
