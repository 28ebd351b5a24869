// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values beyond the band of a sparse grid.
//!
//! A second lattice with cells eight times as large has samples of the same source, interpolated as well. What it
//! says, less its own deviation and less what the source may exceed the band by where values reach it, is at most
//! the source's distance, and at most the band at its border: the larger of both values is continuous.

use palpate_field::{Aabb, Point, Shape, Vector};

use crate::bake::fits;
use crate::certificate::Cells;
use crate::error::GridError;
use crate::lattice::{Lattice, raveled, unravelled};
use crate::samples::{BRICK, Codes, Order, Samples, Store, strides};
use crate::slopes::{SLOPE_BLOCK, Slopes};
use crate::spline::QUADRATIC;
use crate::threads::each;

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
