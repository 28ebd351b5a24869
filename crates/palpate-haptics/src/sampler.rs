// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Metered evaluation of what is near, and how far a probe may move after it.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::nearby::{Nearby, Pierced};

/// How deep the proxy's offset may be violated at rest, as a part of the size of the scene.
/// Far above the rounding of a kernel, far below what a hand can feel (0.1 nm at 1 m).
const TOLERANCE: f64 = 2.5e-10;

/// Evaluations may err by this multiple of the promised rounding before a point counts as
/// inside: once for the value, once for the point it is compared with, doubled.
const ROUNDINGS: f64 = 4.0;

/// The skin of a probe without a radius, as a part of the size of the scene. Larger slides
/// faster along creases; walls thinner than two skins would not hold it.
const POINT_SKIN: f64 = 5e-5;

/// A probe smaller than this part of the scene is treated as a point: its own radius would make
/// it crawl.
const POINT_RADIUS: f64 = 1e-6;

/// Below this part of the Lipschitz constant a gradient says nothing about the surface: it is
/// that of a ridge, a blend or a centre.
const LEAST_SLOPE: f64 = 0.01;

/// A goal beyond the region of the field's promise is sought this part of its radius within it:
/// far more than rounding can carry it out again.
const REGION_EDGE: f64 = 1e-9;

/// Evaluations that are kept for the end of a tick that spent its budget.
const IN_RESERVE: u32 = 1;

/// An evaluated point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<const D: usize> {
    /// Where [m].
    pub(crate) point: Point<D>,
    /// The field's value minus the probe's radius [m]: zero on the offset surface.
    pub(crate) gap: f64,
    /// The plane that the offset surface lies along; none if no gradient was asked for.
    pub(crate) tangent: Option<Tangent<D>>,
    /// Whose surface is nearest, as far as the field says.
    pub(crate) body: u32,
}

/// The plane that the offset surface lies along, to first order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent<const D: usize> {
    /// The unit normal; zero if the gradient is too small to have a direction.
    pub(crate) normal: Vector<f64, D>,
    /// How far the plane is below the point, along its normal [m].
    pub(crate) gap: f64,
}

/// Bodies with a budget of evaluations and the lengths that follow from them and the probe.
///
/// The *offset surface* is `f = r` with the probe's radius `r`. The centre of the probe may dip
/// below it during a move, by less than a *skin*, and never rests there. With a radius the skin
/// is the radius: the centre never enters the shape itself.
///
/// Of a field that outside its surface promises a Lipschitz constant in a region only, points
/// beyond the region are not evaluated: nothing is proven there. A ball is convex, so straight
/// moves between evaluated points stay in the region, and the constant holds all along them.
#[derive(Debug)]
pub(crate) struct Sampler<'a, const D: usize> {
    nearby: &'a Nearby<'a, D>,
    pierced: Pierced,
    radius: f64,
    skin: f64,
    tolerance: f64,
    /// The inverse of the Lipschitz constant.
    per_slope: f64,
    budget: u32,
    evaluations: u32,
}

impl<'a, const D: usize> Sampler<'a, D> {
    /// For a probe of `radius` [m] that moves between points at most `extent` [m] from the
    /// origin.
    pub(crate) fn new(
        (nearby, pierced): (&'a Nearby<'a, D>, Pierced),
        radius: f64,
        budget: u32,
        extent: f64,
    ) -> Self {
        // Bodies without bounds have no size; the place where they are touched has.
        let size = nearby.size().unwrap_or(extent);
        let rounding = ROUNDINGS * nearby.rounding_within(extent);
        let tolerance = f64::max(TOLERANCE * size, rounding);
        let skin =
            if radius > POINT_RADIUS * size { radius } else { radius.max(POINT_SKIN * size) };
        let skin = skin.max(4.0 * tolerance);
        let per_slope = 1.0 / nearby.lipschitz();
        Self { nearby, pierced, radius, skin, tolerance, per_slope, budget, evaluations: 0 }
    }

    /// What is near.
    pub(crate) fn nearby(&self) -> &'a Nearby<'a, D> {
        self.nearby
    }

    /// From now on a hand is through these layers.
    pub(crate) fn pierce(&mut self, pierced: Pierced) {
        self.pierced = pierced;
    }

    /// The probe's radius [m].
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// How deep below the offset surface a point may rest [m].
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// How deep below the offset surface the probe's centre may dip on its way [m].
    pub(crate) fn skin(&self) -> f64 {
        self.skin
    }

    /// Gaps below this are better crossed along the surface than along a line [m].
    pub(crate) fn near(&self) -> f64 {
        0.25 * self.skin
    }

    /// How often the field was evaluated.
    pub(crate) fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// The point closest to `goal` of which something is proven.
    pub(crate) fn within_region(&self, goal: Point<D>) -> Point<D> {
        self.nearby.within_regions(goal, REGION_EDGE)
    }

    /// The value at `point`; `None` if the budget is spent, the field is not finite there, or
    /// nothing is proven of it.
    pub(crate) fn distance(&mut self, point: Point<D>) -> Option<Sample<D>> {
        self.spend(point)?;
        let (value, body) = self.nearby.distance(point, &self.pierced);
        let gap = value - self.radius;
        gap.is_finite().then_some(Sample { point, gap, tangent: None, body })
    }

    /// The value and gradient at `point`, likewise.
    #[inline(always)]
    pub(crate) fn gradient(&mut self, point: Point<D>) -> Option<Sample<D>> {
        self.spend(point)?;
        let seen = self.nearby.gradient(point, &self.pierced);
        let gap = seen.distance - self.radius;
        let slope = seen.gradient.norm();
        // Written so that NaN is refused.
        if !(gap + slope).is_finite() {
            return None;
        }
        // Dividing by less would throw the proxy far away.
        let tangent = if slope * self.per_slope > LEAST_SLOPE {
            let per_slope = 1.0 / slope;
            Tangent { normal: seen.gradient * per_slope, gap: gap * per_slope }
        } else {
            Tangent { normal: Vector::ZERO, gap: gap * self.per_slope }
        };
        Some(Sample { point, gap, tangent: Some(tangent), body: seen.body })
    }

    /// Counts an evaluation at `point`, if there is one left and something is proven there.
    pub(crate) fn spend(&mut self, point: Point<D>) -> Option<()> {
        if self.evaluations + IN_RESERVE >= self.budget || !self.nearby.is_proven(point) {
            return None;
        }
        self.evaluations += 1;
        Some(())
    }

    /// Whether a point is below the offset surface, as the evaluation in reserve tells, which
    /// is for this alone; none if nothing is proven there.
    pub(crate) fn is_below(&mut self, point: Point<D>) -> Option<bool> {
        if !self.nearby.is_proven(point) {
            return None;
        }
        self.evaluations += 1;
        let (value, _) = self.nearby.distance(point, &self.pierced);
        Some(value < self.radius - self.tolerance)
    }

    /// How far any straight move in the region is sure not to reach the offset surface [m].
    ///
    /// `(f − r − ε) / L` with the rounding `ε`.
    pub(crate) fn free_radius(&self, sample: &Sample<D>) -> f64 {
        (sample.gap - self.tolerance) * self.per_slope
    }

    /// How far the probe's centre may move from the sample in any direction [m], so that it
    /// can return to the offset surface afterwards without having crossed the shape.
    ///
    /// Far from the surface: down to half a skin below it. From below: half of the way to a
    /// whole skin, so that repeated moves never arrive there.
    pub(crate) fn reach(&self, sample: &Sample<D>) -> f64 {
        let to_half = sample.gap + 0.5 * self.skin;
        let half_way = 0.5 * (sample.gap + self.skin);
        to_half.max(half_way) * self.per_slope
    }

    /// How far any straight move in the region is sure to be less than a skin deep [m].
    pub(crate) fn clear_radius(&self, sample: &Sample<D>) -> f64 {
        ((sample.gap + self.skin) * self.per_slope).max(0.0)
    }

    /// The unit normal and the signed distance to the offset surface along it [m], to first
    /// order: `(f − r) / ‖∇f‖`. `previous` replaces the direction of a gradient too small to
    /// have one, and of one that was not asked for.
    #[inline]
    pub(crate) fn tangent(
        &self,
        sample: &Sample<D>,
        previous: Vector<f64, D>,
    ) -> (Vector<f64, D>, f64) {
        match sample.tangent {
            Some(Tangent { normal, gap }) if normal != Vector::ZERO => (normal, gap),
            Some(Tangent { gap, .. }) => (previous, gap),
            None => (previous, sample.gap * self.per_slope),
        }
    }
}
