// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Baking: fields sampled on grids.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use palpate_field::kernel::Cuboid;
use palpate_field::{
    Aabb, BLOCK, Block, Column, Deviation, LARGEST_LENGTH, Point, Pose, Quality, Quantity,
    SMALLEST_LENGTH, Shape, ShapeError, Unit, Vector,
};

use crate::certificate::{Cells, Certificate};
use crate::error::GridError;
use crate::grid::{Compared, Far, Grid, Known, Lattice, unravelled};
use crate::samples::{
    BRICK, Brick, Codes, Order, Samples, Store, WIDE, strides, wide_brick, wide_node,
};
use crate::spline::{GridKernel, OfTaps, QUADRATIC, Spline, TRILINEAR};

/// Nodes that one thread samples in a row.
const RUN: usize = 4096;

/// Cells along the longest side of the bounds with which a tolerance is tried first.
const FIRST_TRY: f64 = 24.0;

/// Cells along it at least, however large a tolerance is.
const FEWEST_CELLS: f64 = 4.0;

/// How often cells are made smaller for a tolerance.
const MOST_TRIES: usize = 12;

/// The largest step of one try to the next.
const MOST_REFINED: f64 = 4.0;

/// Tries end when cells this many times as large fail.
const MOST_APART: f64 = 1.5;

/// If the cell is given, a deviation below this share of it is not bounded more closely.
const ENOUGH: f64 = 0.25;

/// How far a grid is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridProgress {
    /// The size of a cell of the grid that is made now [m]; for a tolerance, cells grow smaller from try to try.
    pub cell: f64,
    /// Pieces of work done.
    pub done: usize,
    /// Pieces of work in all.
    pub of: usize,
}

impl<const D: usize> Grid<D> {
    /// The grid of a shape.
    ///
    /// # Errors
    ///
    /// If the shape has no bounds, is thinner than a cell everywhere, or has a value that is no number; if a
    /// number of the options breaks its rule; if more nodes are needed than the options allow.
    pub fn bake(shape: &Shape<D>, options: &GridOptions) -> Result<Self, GridError> {
        Self::bake_with(shape, options, &|_| ControlFlow::Continue(()))
    }

    /// As [`bake`](Self::bake). `progress` is called by the threads that work, and can stop them.
    ///
    /// # Errors
    ///
    /// Also if `progress` breaks.
    #[inline(never)]
    pub fn bake_with(
        shape: &Shape<D>,
        options: &GridOptions,
        progress: &(dyn Fn(GridProgress) -> ControlFlow<()> + Sync),
    ) -> Result<Self, GridError> {
        let mut grid = Self::made_of(shape, options, progress)?;
        grid.source = Some(Arc::new((shape.clone(), options.clone())));
        Ok(grid)
    }

    fn made_of(
        shape: &Shape<D>,
        options: &GridOptions,
        progress: &(dyn Fn(GridProgress) -> ControlFlow<()> + Sync),
    ) -> Result<Self, GridError> {
        options.check()?;
        let bounds = shape.promise().bounds.ok_or(GridError::Unbounded)?.aabb;
        if !shape.promise().has_interior {
            let (Resolution::Cell(cell) | Resolution::Tolerance(cell)) = options.resolution;
            return Err(GridError::NoInside { cell });
        }
        let source = raised(shape, &bounds)?;
        let around = options.band.unwrap_or(options.certified) + 3.0;
        let bake_as = |cell, options| {
            Bake { source: &source, bounds, options, cell, around, progress }.grid()
        };
        let tolerance = match options.resolution {
            Resolution::Cell(cell) => return bake_as(cell, options),
            Resolution::Tolerance(tolerance) => tolerance,
        };
        // Far f32 samples do not change the deviation; the steps of whole numbers depend on all.
        let tried = match options.store {
            Store::F32 => options.with_narrow_band::<D>(source.promise().lipschitz),
            Store::I16 | Store::I8 => options.clone(),
        };
        let bake = |cell| bake_as(cell, &tried);
        let whole = |grid: Self| {
            if tried == *options { Ok(grid) } else { bake_as(grid.lattice().cell, options) }
        };
        let longest = bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        // A cell as large as the shape finds no inside.
        let mut cell = (longest / FIRST_TRY).max(tolerance.min(longest / FEWEST_CELLS));
        // The cell and the deviation of the try before; the smallest cell that was too large.
        let mut last: Option<[f64; 2]> = None;
        let mut coarse: Option<f64> = None;
        let mut best: Option<Self> = None;
        for _ in 0..MOST_TRIES {
            let reached = match bake(cell) {
                Ok(grid) if grid.deviation() <= tolerance => {
                    let has_room = coarse.is_some_and(|coarse| coarse > MOST_APART * cell);
                    if !has_room {
                        return whole(grid);
                    }
                    best = Some(grid);
                    cell = (cell * coarse.unwrap_or(cell)).sqrt();
                    continue;
                }
                Ok(grid) => {
                    let (reached, limit) = (grid.deviation(), options.most_nodes);
                    // An error shrinks with the square of a cell; a factor of 2 is left for what is not resolved yet.
                    let finest =
                        Lattice::over(&bounds, 0.5 * cell * (tolerance / reached).sqrt());
                    if options.band.is_none() && !finest.has_at_most(limit) {
                        return Err(GridError::TooFine { tolerance, limit, cell, reached });
                    }
                    Some(reached)
                }
                Err(GridError::NoInside { .. }) => None,
                Err(GridError::TooLarge { cell, nodes, limit }) => {
                    return Err(match last {
                        Some([cell, reached]) => {
                            GridError::TooFine { tolerance, limit, cell, reached }
                        }
                        None if coarse.is_some() => GridError::NoInside { cell },
                        None => GridError::TooLarge { cell, nodes, limit },
                    });
                }
                Err(error) => return Err(error),
            };
            coarse = Some(cell);
            if let Some(best) = best.as_ref().map(|best| best.lattice().cell) {
                if cell <= MOST_APART * best {
                    break;
                }
                cell = (cell * best).sqrt();
                continue;
            }
            let finer = reached.map_or(0.5, |reached| {
                // The order of the last two tries; smooth shapes have 2, edges 1.
                let order = last.map_or(2.0, |[before, worse]| {
                    ((worse / reached).ln() / (before / cell).ln()).clamp(0.75, 2.0)
                });
                (0.95 * tolerance / reached).powf(1.0 / order)
            });
            last = reached.map(|reached| [cell, reached]).or(last);
            cell *= finer.max(1.0 / MOST_REFINED);
        }
        match (best, last) {
            (Some(best), _) => whole(best),
            (None, Some([cell, reached])) => {
                Err(GridError::NotReached { tolerance, cell, reached })
            }
            (None, None) => Err(GridError::NoInside { cell }),
        }
    }

    /// The grid of given samples [m], one for each node, the first axis first: a field for itself.
    ///
    /// ```
    /// use palpate_field::{CustomField, Vector};
    /// use palpate_grid::{Grid, GridKernel, Lattice, Store};
    ///
    /// # fn main() -> Result<(), palpate_grid::GridError> {
    /// // |x| + |y| − 1, which is √2 times as steep as a distance.
    /// let lattice = Lattice { origin: Vector([-2.0, -2.0]), cell: 0.5, counts: [9, 9] };
    /// let mut samples = Vec::new();
    /// for y in 0..9 {
    ///     for x in 0..9 {
    ///         let p = lattice.node([x, y]);
    ///         samples.push(p[0].abs() + p[1].abs() - 1.0);
    ///     }
    /// }
    /// let grid = Grid::from_samples(lattice, &samples, GridKernel::Trilinear, Store::F32)?;
    /// assert_eq!(grid.distance(Vector([0.75, 1.0])), 0.75);
    /// assert!((grid.promise().lipschitz - 2.0_f64.sqrt()).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If there are not as many samples as nodes, one is not finite, none is inside, or one at the border is.
    #[inline(never)]
    pub fn from_samples(
        lattice: Lattice<D>,
        samples: &[f64],
        kernel: GridKernel,
        store: Store,
    ) -> Result<Self, GridError> {
        GridOptions::with_cell(lattice.cell).check()?;
        let (counts, least) = (lattice.counts.to_vec(), kernel.taps());
        if counts.iter().any(|count| *count < least) {
            return Err(GridError::TooFew { counts, least });
        }
        if lattice.nodes() != Some(samples.len()) {
            return Err(GridError::Samples { counts, samples: samples.len() });
        }
        lattice.check()?;
        if let Some(wrong) = samples.iter().position(|sample| !fits(*sample)) {
            let point = lattice.node(unravelled(wrong, lattice.counts)).0.to_vec();
            return Err(GridError::NotFinite { point });
        }
        let largest = samples.iter().fold(0.0_f64, |largest, sample| largest.max(sample.abs()));
        let scale = store.scale(largest);
        let samples = Samples {
            codes: Codes::encode(store, scale, samples),
            scale,
            band: f64::INFINITY,
            order: Order::Dense { strides: strides(lattice.counts) },
            bricks: lattice.counts.map(|count| count.div_ceil(BRICK)),
        };
        let cells = Cells::without_source(&lattice);
        let certificates = each(samples.bricks.iter().product(), |number| {
            let brick = unravelled(number, samples.bricks);
            Ok(match kernel {
                GridKernel::Quadratic => cells.of_brick::<QUADRATIC>(&samples, brick),
                GridKernel::Trilinear => cells.of_brick::<TRILINEAR>(&samples, brick),
            })
        })?;
        Self::assemble(lattice, kernel, samples, certificates, Known::default())
    }

    /// Samples the bricks again whose values change when the shape changes within `region` alone.
    ///
    /// The samples are those of a new grid on the same lattice, to the bit. Values that are bounds may change far
    /// away from what changed: unless the shape is exact on both sides, every brick is sampled again. The shape that the
    /// grid was made of must have been exact too. The deviation is certified to a quarter of a cell, also where the grid
    /// was made by a smaller tolerance.
    ///
    /// # Errors
    ///
    /// As [`bake`](Self::bake); if the grid has no band, for then every value may change; if the shape has grown out
    /// of the lattice. The grid is then as before.
    #[inline(never)]
    pub fn rebuild(&mut self, shape: &Shape<D>, region: &Aabb<D>) -> Result<(), GridError> {
        let bounds = shape.promise().bounds.ok_or(GridError::Unbounded)?.aabb;
        let band = self.samples.band;
        if band.is_infinite() {
            return Err(GridError::NoBand);
        }
        let source = raised(shape, &bounds)?;
        let lattice = *self.lattice();
        let room = lattice.region();
        let needed = bounds.grown(2.0 * lattice.cell);
        if (0..D).any(|i| needed.min[i] < room.min[i] || needed.max[i] > room.max[i]) {
            return Err(GridError::Outgrown);
        }
        let options = GridOptions {
            kernel: self.kernel(),
            store: self.store(),
            band: Some(band / lattice.cell),
            ..GridOptions::with_cell(lattice.cell)
        };
        let bake = Bake {
            source: &source,
            bounds,
            options: &options,
            cell: lattice.cell,
            // The lattice is the old one.
            around: 0.0,
            progress: &|_| ControlFlow::Continue(()),
        };
        *self = match self.kernel() {
            GridKernel::Quadratic => bake.again::<QUADRATIC>(self, region)?,
            GridKernel::Trilinear => bake.again::<TRILINEAR>(self, region)?,
        };
        Ok(())
    }
}

/// A shape whose values are at least the distances to its bounds, as the grid's are outside its lattice.
fn raised<const D: usize>(shape: &Shape<D>, bounds: &Aabb<D>) -> Result<Shape<D>, GridError> {
    if shape.promise().above_bounds {
        return Ok(shape.clone());
    }
    let cuboid = Cuboid::new(bounds.half_extents() * 2.0)?;
    let around = Shape::from_kernel_at(cuboid, &Pose::translation(bounds.centre()))?;
    Ok(shape.clone() & around)
}

/// One grid with cells of one size.
struct Bake<'a, const D: usize> {
    source: &'a Shape<D>,
    bounds: Aabb<D>,
    options: &'a GridOptions,
    cell: f64,
    /// Cells around the bounds on each side.
    around: f64,
    progress: &'a (dyn Fn(GridProgress) -> ControlFlow<()> + Sync),
}

impl<const D: usize> Bake<'_, D> {
    fn grid(&self) -> Result<Grid<D>, GridError> {
        match self.options.kernel {
            GridKernel::Quadratic => self.grid_of::<QUADRATIC>(),
            GridKernel::Trilinear => self.grid_of::<TRILINEAR>(),
        }
    }

    fn grid_of<const K: usize>(&self) -> Result<Grid<D>, GridError>
    where
        OfTaps<K>: Spline<K>,
    {
        let lattice = self.lattice()?;
        let bricks = lattice.counts.map(|count| count.div_ceil(BRICK));
        let done = AtomicUsize::new(0);
        let count = bricks.iter().product::<usize>();
        let pieces = match self.options.band {
            Some(_) => count,
            None => lattice.counts.iter().product::<usize>().div_ceil(RUN),
        };
        let step = || {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            match (self.progress)(GridProgress {
                cell: self.cell,
                done,
                of: pieces + 2 * count,
            }) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => Err(GridError::Stopped),
            }
        };
        let samples = match self.options.band {
            Some(band) => {
                let band = self.options.store.band(band * self.cell);
                self.bricks(&lattice, bricks, band, &step)?
            }
            None => self.dense(&lattice, bricks, &step)?,
        };
        self.certified::<K>(lattice, samples, &step)
    }

    /// The grid with the bricks near `region` made again.
    fn again<const K: usize>(
        &self,
        old: &Grid<D>,
        region: &Aabb<D>,
    ) -> Result<Grid<D>, GridError>
    where
        OfTaps<K>: Spline<K>,
    {
        let lattice = *old.lattice();
        let band = old.samples.band;
        let bricks = old.samples.bricks;
        let promise = self.source.promise();
        let is_exact = promise.outside == Quality::Exact && promise.inside == Quality::Exact;
        // A distance changes if it was, or is, within the band.
        let changed = region.grown(band);
        let is_near = |brick: [usize; D]| {
            !is_exact
                || (0..D).all(|i| {
                    let along = |index: f64| lattice.origin[i] + index * lattice.cell;
                    let start = (brick[i] * BRICK) as f64 - 1.0;
                    along(start) <= changed.max[i]
                        && changed.min[i] <= along(start + WIDE as f64)
                })
        };
        let made = each(bricks.iter().product(), |number| {
            let brick = unravelled(number, bricks);
            if !is_near(brick) {
                return Ok(old.samples.codes_of(brick));
            }
            let brick = self.brick(&lattice, brick, band)?;
            Ok(brick.map(|samples| Codes::encode(old.store(), old.samples.scale, &samples)))
        })?;
        let samples = Samples::of_bricks(&made, old.samples.scale, band, bricks);
        let cells = self.cells::<K>(&lattice, &samples);
        let certificates = each(bricks.iter().product(), |number| {
            let brick = unravelled(number, bricks);
            let known = &old.certificates[number];
            Ok(if is_near(brick) {
                cells.of_brick::<K>(&samples, brick)
            } else {
                known.clone()
            })
        })?;
        let value = cells.deviation::<K>(&samples, &certificates, &|| Ok(()))?;
        let reach = cells.reach;
        let deviation = Deviation { value, within: cells.within };
        self.assembled(lattice, samples, certificates, (deviation, reach))
    }

    /// The lattice with room for the values that are compared with the source, and for the samples that the
    /// outermost of them take.
    fn lattice(&self) -> Result<Lattice<D>, GridError> {
        let lattice = Lattice::over(&self.bounds.grown(self.around * self.cell), self.cell);
        let nodes = lattice.counts.iter().map(|count| *count as f64).product::<f64>();
        let limit = self.options.most_nodes;
        if nodes > limit as f64 {
            return Err(GridError::TooLarge { cell: self.cell, nodes, limit });
        }
        Ok(lattice)
    }

    /// All nodes.
    fn dense(
        &self,
        lattice: &Lattice<D>,
        bricks: [usize; D],
        step: &(impl Fn() -> Result<(), GridError> + Sync),
    ) -> Result<Samples<D>, GridError> {
        let nodes = lattice.counts.iter().product::<usize>();
        let runs = each(nodes.div_ceil(RUN), |run| {
            let first = run * RUN;
            let count = RUN.min(nodes - first);
            let at = |i| lattice.node(unravelled(first + i, lattice.counts));
            let samples = distances(self.source, count, at)?;
            step()?;
            Ok(samples)
        })?;
        let largest =
            runs.iter().flatten().fold(0.0_f64, |largest, sample| largest.max(sample.abs()));
        let scale = self.options.store.scale(largest);
        let codes: Vec<_> =
            runs.iter().map(|run| Codes::encode(self.options.store, scale, run)).collect();
        let codes = Codes::joined(codes.iter());
        let order = Order::Dense { strides: strides(lattice.counts) };
        Ok(Samples { codes, scale, band: f64::INFINITY, order, bricks })
    }

    /// The bricks with values within the band.
    fn bricks(
        &self,
        lattice: &Lattice<D>,
        bricks: [usize; D],
        band: f64,
        step: &(impl Fn() -> Result<(), GridError> + Sync),
    ) -> Result<Samples<D>, GridError> {
        let scale = self.options.store.scale(band);
        let made = each(bricks.iter().product(), |number| {
            let brick = self.brick(lattice, unravelled(number, bricks), band)?;
            step()?;
            Ok(brick.map(|samples| Codes::encode(self.options.store, scale, &samples)))
        })?;
        Ok(Samples::of_bricks(&made, scale, band, bricks))
    }

    /// The samples that a brick's cells take, clamped to the band.
    fn brick(
        &self,
        lattice: &Lattice<D>,
        brick: [usize; D],
        band: f64,
    ) -> Result<Brick<Vec<f64>>, GridError> {
        let start = Vector(brick.map(|i| (i * BRICK) as f64 - 1.0));
        let half = 0.5 * (WIDE - 1) as f64;
        let middle = lattice.at(start + Vector([half; D]));
        let promise = self.source.promise();
        let reach = promise.lipschitz * half * (D as f64).sqrt() * lattice.cell * (1.0 + 1e-9);
        let far = |value: f64| {
            if value > 0.0 { Brick::FarOutside } else { Brick::FarInside }
        };
        let value = self.source.distance(middle);
        let rounding = promise.rounding.within(middle.norm());
        if promise.region.is_none() && value.abs() - reach - rounding > band {
            return Ok(far(value));
        }
        let index = |i: usize| -> [usize; D] {
            let own: [usize; D] = unravelled(i, [WIDE; D]);
            std::array::from_fn(|axis| wide_node(brick[axis], own[axis], lattice.counts[axis]))
        };
        let mut samples = distances(self.source, wide_brick(D), |i| lattice.node(index(i)))?;
        if samples.iter().all(|sample| *sample >= band) || samples.iter().all(|s| *s <= -band) {
            return Ok(far(samples[0]));
        }
        for sample in &mut samples {
            *sample = sample.clamp(-band, band);
        }
        Ok(Brick::Near(samples))
    }

    /// The grid of samples, with its certificates.
    fn certified<const K: usize>(
        &self,
        lattice: Lattice<D>,
        samples: Samples<D>,
        step: &(impl Fn() -> Result<(), GridError> + Sync),
    ) -> Result<Grid<D>, GridError>
    where
        OfTaps<K>: Spline<K>,
    {
        let cells = self.cells::<K>(&lattice, &samples);
        let certificates = each(samples.bricks.iter().product(), |number| {
            step()?;
            Ok(cells.of_brick::<K>(&samples, unravelled(number, samples.bricks)))
        })?;
        let value = cells.deviation::<K>(&samples, &certificates, step)?;
        let reach = cells.reach;
        let deviation = Deviation { value, within: cells.within };
        self.assembled(lattice, samples, certificates, (deviation, reach))
    }

    fn assembled(
        &self,
        lattice: Lattice<D>,
        samples: Samples<D>,
        certificates: Vec<Certificate<D>>,
        (deviation, reach): (Deviation, f64),
    ) -> Result<Grid<D>, GridError> {
        let compared = Compared { deviation, bounds: self.bounds };
        // Beyond the band nothing is known where the source's steepness holds in a part of space alone.
        let far = match self.source.promise().region {
            None if samples.band.is_finite() => {
                Some(Far::of(self.source, &lattice, reach + 2e-6 * samples.band)?)
            }
            _ => None,
        };
        Grid::assemble(
            lattice,
            self.options.kernel,
            samples,
            certificates,
            Known { compared: Some(compared), far },
        )
    }

    fn cells<'a, const K: usize>(
        &'a self,
        lattice: &'a Lattice<D>,
        samples: &Samples<D>,
    ) -> Cells<'a, D> {
        let cell = lattice.cell;
        let lipschitz = self.source.promise().lipschitz;
        let diagonal = lipschitz * (D as f64).sqrt() * cell;
        let largest = match &samples.order {
            Order::Bricks { .. } => samples.band,
            Order::Dense { .. } => samples.codes.largest() * samples.scale,
        };
        let stored = self.options.store.error(largest, samples.scale);
        // The samples that a value takes lie at most so far away.
        let reach = diagonal * 0.5 * K as f64 + stored;
        // The variance of the weights along an axis is at most a quarter of a cell's square.
        let worst = if self.source.promise().region.is_none() {
            0.5 * diagonal + stored
        } else {
            f64::INFINITY
        };
        let within = match self.options.band {
            // Where the steepness holds in a part of space alone, so do the models.
            _ if self.source.promise().region.is_some() => 0.0,
            None => self.options.certified * cell,
            // None of the samples that these values take is clamped.
            Some(_) => (samples.band - (reach + worst) * (1.0 + 1e-9)).max(0.0),
        };
        let enough = match self.options.resolution {
            Resolution::Cell(_) => ENOUGH * cell,
            Resolution::Tolerance(tolerance) => tolerance.min(ENOUGH * cell),
        };
        Cells { lattice, source: Some(self.source), within, reach, stored, worst, enough }
    }
}

/// Whether a sample is a number in single precision too.
pub(crate) fn fits(sample: f64) -> bool {
    sample.abs() <= f64::from(f32::MAX)
}

/// The distances at `count` points [m].
fn distances<const D: usize>(
    shape: &Shape<D>,
    count: usize,
    at: impl Fn(usize) -> Point<D>,
) -> Result<Vec<f64>, GridError> {
    let mut samples = Vec::with_capacity(count);
    let (mut points, mut values) = (Block::zero(), Column::zero());
    for first in (0..count).step_by(BLOCK) {
        let lanes = BLOCK.min(count - first);
        points.fill(lanes, |i| at(first + i));
        shape.block_distances(&points, lanes, &mut values);
        for i in 0..lanes {
            let value = values.get(i);
            if !fits(value) {
                return Err(GridError::NotFinite { point: at(first + i).0.to_vec() });
            }
            samples.push(value);
        }
    }
    Ok(samples)
}

/// The most samples of a cell, and the most control values.
pub(crate) const MOST_TAPS: usize = QUADRATIC.pow(3);

/// Writes a cell's samples, the first axis first.
#[inline]
pub(crate) fn gather<const K: usize, const D: usize>(
    samples: &[f64],
    place: usize,
    taps: &mut [f64],
) {
    let ways = strides([WIDE; D]);
    for row in 0..K.pow(D as u32 - 1) {
        let mut rest = row;
        let mut from = place;
        for way in ways.iter().skip(1) {
            from += (rest % K) * way;
            rest /= K;
        }
        taps[row * K..][..K].copy_from_slice(&samples[from..from + K]);
    }
}

/// Replaces samples along an axis by their shares in control values.
#[inline]
pub(crate) fn apply<const K: usize, const D: usize>(
    numbers: &mut [f64],
    axis: usize,
    shares: &[[f64; K]; K],
) {
    let way = K.pow(axis as u32);
    for line in 0..K.pow(D as u32 - 1) {
        let first = line % way + (line / way) * way * K;
        let old: [f64; K] = std::array::from_fn(|tap| numbers[first + tap * way]);
        for (tap, shares) in shares.iter().enumerate() {
            numbers[first + tap * way] = (0..K).map(|i| shares[i] * old[i]).sum();
        }
    }
}

/// How fine a grid is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// The size of a cell [m].
    Cell(f64),
    /// The largest difference from the source's values near the surface [m]: cells are made small enough.
    Tolerance(f64),
}

/// What a grid is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct GridOptions {
    /// How fine it is.
    pub resolution: Resolution,
    /// How samples are interpolated.
    pub kernel: GridKernel,
    /// How samples are stored.
    pub store: Store,
    /// `None` keeps every sample. With `Some`, values are clamped to so many cells on both sides of the surface,
    /// and only bricks of samples with smaller ones are stored: a seventh of the memory at 256 cells along each
    /// axis. Beyond the band a coarser lattice gives values that are smaller than the distance.
    pub band: Option<f64>,
    /// Without a band, values up to so many cells are compared with the source. A smooth union whose fill reaches as far
    /// as r from the surfaces needs r / cell.
    pub certified: f64,
    /// More nodes than these are refused.
    pub most_nodes: usize,
}

impl GridOptions {
    /// The smallest band: within less, values take clamped samples, and nothing would be certified.
    pub const SMALLEST_BAND: f64 = 4.5;

    /// Quadratic splines of samples in single precision, all of them, with cells of a size [m].
    #[must_use]
    pub const fn with_cell(cell: f64) -> Self {
        Self::with_resolution(Resolution::Cell(cell))
    }

    /// The same, with cells as small as a deviation takes [m].
    #[must_use]
    pub const fn with_tolerance(tolerance: f64) -> Self {
        Self::with_resolution(Resolution::Tolerance(tolerance))
    }

    /// The same, with either.
    #[must_use]
    pub const fn with_resolution(resolution: Resolution) -> Self {
        Self {
            resolution,
            kernel: GridKernel::Quadratic,
            store: Store::F32,
            band: None,
            certified: 1.0,
            most_nodes: 1 << 26,
        }
    }

    /// The same with a band, if there is none: wider than what is certified by half the diagonal of three cells for
    /// the samples that a value takes, by half that of one for its deviation, and by some room; for a source in `D`
    /// dimensions with a Lipschitz constant.
    pub(crate) fn with_narrow_band<const D: usize>(&self, lipschitz: f64) -> Self {
        let narrow = self.certified + 2.1 * (D as f64).sqrt() * lipschitz.max(1.0);
        Self { band: self.band.or(Some(narrow)), ..self.clone() }
    }

    pub(crate) fn check(&self) -> Result<(), GridError> {
        let (name, size) = match self.resolution {
            Resolution::Cell(cell) => ("cell", cell),
            Resolution::Tolerance(tolerance) => ("tolerance", tolerance),
        };
        let wrong = |parameter: &'static str, rule: &'static str, value: f64, unit: Unit| {
            Err(GridError::Number(ShapeError::Number {
                parameter: parameter.into(),
                rule: rule.into(),
                value: Quantity(value, unit),
            }))
        };
        if !(SMALLEST_LENGTH..=LARGEST_LENGTH).contains(&size) {
            return wrong(name, "from 1e-15 to 1e15 m", size, Unit::Metre);
        }
        if let Some(band) = self.band.filter(|band| !(Self::SMALLEST_BAND..=1e6).contains(band))
        {
            return wrong("band", "from 4.5 to 1e6 cells", band, Unit::One);
        }
        if !(0.0..=1e6).contains(&self.certified) {
            return wrong("certified", "from 0 to 1e6 cells", self.certified, Unit::One);
        }
        Ok(())
    }
}

/// The results of `work` for each of `count` numbers, in their order, or an error of one of them.
pub(crate) fn each<T: Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T, GridError> + Send + Sync,
) -> Result<Vec<T>, GridError> {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().map(work).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).map(work).collect()
    }
}
