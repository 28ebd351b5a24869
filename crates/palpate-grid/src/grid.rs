// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A grid: its samples, what is certified of them, and how they are interpolated.

use std::sync::Arc;

use palpate_field::{Aabb, Bounds, Deviation, Point, Promise, Rounding, Shape, Vector};

use crate::certificate::Certificate;
use crate::control::{MOST_TAPS, gather};
use crate::curvature::Curvature;
use crate::error::GridError;
use crate::far::Far;
use crate::lattice::{Lattice, indices, raveled};
use crate::options::GridOptions;
use crate::outside::{at_border, outside};
use crate::samples::{BRICK, Codes, Order, Samples, Store, WIDE};
use crate::slopes::{SLOPE_BLOCK, Slopes};
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
