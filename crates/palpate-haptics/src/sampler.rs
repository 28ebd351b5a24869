// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Evaluation of near bodies within a budget, and the safe motion that each evaluation proves.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::nearby::{Nearby, Punctured};

/// How far below the offset surface a proxy may rest, as a part of the size of the scene. Far
/// above the rounding of a kernel, far below what a hand can feel (0.1 nm at 1 m).
const TOLERANCE: f64 = 2.5e-10;

/// Evaluations may err by this multiple of the promised rounding before a point counts as
/// inside: once for the value, once for the point it is compared with, doubled.
const ROUNDINGS: f64 = 4.0;

/// The skin of a probe without a radius, as a part of the size of the scene. A larger skin
/// speeds up slides along creases, but such a probe crosses walls thinner than two skins.
const POINT_SKIN: f64 = 5e-5;

/// A probe smaller than this part of the scene is treated as a point: a skin as small as its
/// radius would allow only tiny steps, and a fast hand would leave its proxy behind. With a larger
/// part, probes that a hand feels as balls could cross thin walls.
const POINT_RADIUS: f64 = 2e-5;

/// Gaps between bodies narrower than this part of the size of the scene are closed to a point.
const CRACK: f64 = 1e-6;

/// A gradient shorter than this part of the Lipschitz constant says nothing about the surface:
/// it belongs to a ridge, a blend or a centre.
const LEAST_SLOPE: f64 = 0.01;

/// A goal beyond the region of the field's promise is moved this part of the radius inside the
/// region, so that rounding cannot carry it out again.
const REGION_EDGE: f64 = 1e-9;

/// Evaluations reserved for the end of a tick that used up its budget.
const IN_RESERVE: u32 = 1;

/// An evaluated point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// The place [m].
    pub(crate) point: Point<3>,
    /// The field's value minus the probe's radius [m]: zero on the offset surface.
    pub(crate) gap: f64,
    /// The tangent plane; `None` if no gradient was evaluated.
    pub(crate) tangent: Option<Tangent>,
    /// The index of the body whose field is least.
    pub(crate) body: u32,
}

/// The tangent plane of the offset surface, to first order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent {
    /// The unit normal; zero if the gradient is too small to have a direction.
    pub(crate) normal: Vector<f64, 3>,
    /// How far the plane lies below the point, along the normal [m].
    pub(crate) gap: f64,
}

/// Bodies with a budget of evaluations, and the lengths that follow from bodies and probe.
///
/// The *offset surface* is `f = r` with the probe's radius `r`. The centre of the probe may dip
/// below it during a move, by less than a *skin*, and never rests there. With a radius the skin
/// is the radius: the centre never enters the shape itself.
///
/// If a field promises its Lipschitz constant outside the surface only in a region, points
/// beyond the region are not evaluated: no bound holds there. The region is a ball and so
/// convex: straight moves between evaluated points stay inside, and the constant holds along
/// them.
#[derive(Debug)]
pub(crate) struct Sampler<'a> {
    nearby: &'a Nearby<'a>,
    punctured: Punctured,
    radius: f64,
    skin: f64,
    tolerance: f64,
    /// The width of a crack between bodies that the probe cannot enter [m]; zero if its radius
    /// keeps it out.
    crack: f64,
    /// The inverse of the Lipschitz constant.
    per_slope: f64,
    budget: u32,
    evaluations: u32,
}

impl<'a> Sampler<'a> {
    /// A sampler for a probe of `radius` [m] that moves between points at most `extent` [m]
    /// from the origin.
    pub(crate) fn new(
        nearby: &'a Nearby<'a>,
        punctured: Punctured,
        radius: f64,
        budget: u32,
        extent: f64,
    ) -> Self {
        // Unbounded bodies have no size, so the extent of the motion takes its place.
        let size = nearby.size().unwrap_or(extent);
        let rounding = ROUNDINGS * nearby.rounding_within(extent);
        let tolerance = f64::max(TOLERANCE * size, rounding);
        let skin =
            if radius > POINT_RADIUS * size { radius } else { radius.max(POINT_SKIN * size) };
        let skin = skin.max(4.0 * tolerance);
        let per_slope = 1.0 / nearby.lipschitz();
        let crack = CRACK * size;
        let is_open = radius < crack && nearby.bodies.bodies().len() > 1;
        let crack = if is_open { crack } else { 0.0 };
        let evaluations = 0;
        Self {
            nearby,
            punctured,
            radius,
            skin,
            tolerance,
            crack,
            per_slope,
            budget,
            evaluations,
        }
    }

    /// The near bodies.
    pub(crate) fn nearby(&self) -> &'a Nearby<'a> {
        self.nearby
    }

    /// This sampler, with the budget that it has left, among other bodies.
    pub(crate) fn among<'b>(&self, nearby: &'b Nearby<'b>) -> Sampler<'b>
    where
        'a: 'b,
    {
        Sampler { nearby, ..*self }
    }

    /// Runs `work` with at most so many evaluations.
    pub(crate) fn at_most<T>(&mut self, most: u32, work: impl FnOnce(&mut Self) -> T) -> T {
        let budget = self.budget;
        self.budget = budget.min(self.evaluations + most + IN_RESERVE);
        let done = work(self);
        self.budget = budget;
        done
    }

    /// Counts an evaluation beside the budget.
    pub(crate) fn count(&mut self) {
        self.evaluations += 1;
    }

    /// Counts the evaluations of a sampler that began with this one's budget.
    pub(crate) fn spent_by(&mut self, other: &Sampler<'_>) {
        self.evaluations = self.evaluations.max(other.evaluations);
    }

    /// Sets the punctured layers.
    pub(crate) fn puncture(&mut self, punctured: Punctured) {
        self.punctured = punctured;
    }

    /// The probe's radius [m].
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether the probe is so small that it moves as a point.
    pub(crate) fn is_point(&self) -> bool {
        self.radius < self.skin
    }

    /// The inverse of the Lipschitz constant: the least way along which a gap changes by a metre.
    pub(crate) fn per_slope(&self) -> f64 {
        self.per_slope
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

    /// The number of evaluations so far.
    pub(crate) fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// The point closest to `goal` at which the promises of the near bodies hold.
    pub(crate) fn within_region(&self, goal: Point<3>) -> Point<3> {
        self.nearby.within_regions(goal, REGION_EDGE)
    }

    /// The value at `point`; `None` if the budget is spent, the value is not finite, or no
    /// promise holds there.
    pub(crate) fn distance(&mut self, point: Point<3>) -> Option<Sample> {
        self.spend(point)?;
        let (value, body) = self.value(point);
        let gap = value - self.radius;
        gap.is_finite().then_some(Sample { point, gap, tangent: None, body })
    }

    /// The value and the gradient at `point`; `None` in the cases of
    /// [`distance`](Self::distance).
    #[inline(always)]
    pub(crate) fn gradient(&mut self, point: Point<3>) -> Option<Sample> {
        self.spend(point)?;
        let seen = if self.crack > 0.0 {
            self.nearby.gradient_filled(point, &self.punctured, self.crack)
        } else {
            self.nearby.gradient(point, &self.punctured)
        };
        let gap = seen.distance - self.radius;
        let slope = seen.gradient.norm();
        // Written so that NaN is refused.
        if !(gap + slope).is_finite() {
            return None;
        }
        // Dividing by a smaller slope would throw the proxy far away.
        let tangent = if slope * self.per_slope > LEAST_SLOPE {
            let per_slope = 1.0 / slope;
            Tangent { normal: seen.gradient * per_slope, gap: gap * per_slope }
        } else {
            Tangent { normal: Vector::ZERO, gap: gap * self.per_slope }
        };
        Some(Sample { point, gap, tangent: Some(tangent), body: seen.body })
    }

    /// The field at a point, and the body whose field is least.
    fn value(&self, point: Point<3>) -> (f64, u32) {
        if self.crack > 0.0 {
            let seen = self.nearby.gradient_filled(point, &self.punctured, self.crack);
            return (seen.distance, seen.body);
        }
        self.nearby.distance(point, &self.punctured)
    }

    /// Counts an evaluation at `point`; `None` if the budget is spent or no promise holds
    /// there.
    pub(crate) fn spend(&mut self, point: Point<3>) -> Option<()> {
        if self.evaluations + IN_RESERVE >= self.budget || !self.nearby.is_proven(point) {
            return None;
        }
        self.evaluations += 1;
        Some(())
    }

    /// Whether a point is below the offset surface. This uses the evaluation in reserve, which
    /// serves no other purpose; `None` if no promise holds there.
    pub(crate) fn is_below(&mut self, point: Point<3>) -> Option<bool> {
        if !self.nearby.is_proven(point) {
            return None;
        }
        self.evaluations += 1;
        let (value, _) = self.value(point);
        Some(value < self.radius - self.tolerance)
    }

    /// The safe radius [m]: a straight move in the region by less than this does not reach the
    /// offset surface.
    ///
    /// `(f − r − ε) / L` with the rounding `ε`.
    pub(crate) fn free_radius(&self, sample: &Sample) -> f64 {
        (sample.gap - self.tolerance) * self.per_slope
    }

    /// How far the probe's centre may move from the sample in any direction [m] and still
    /// return to the offset surface without having crossed the shape.
    ///
    /// Far from the surface: down to half a skin below it. From below: half of the way to a
    /// whole skin, so that repeated moves never arrive there.
    pub(crate) fn reach(&self, sample: &Sample) -> f64 {
        let to_half = sample.gap + 0.5 * self.skin;
        let half_way = 0.5 * (sample.gap + self.skin);
        to_half.max(half_way) * self.per_slope
    }

    /// A straight move in the region by less than this length stays less than a skin deep [m].
    pub(crate) fn clear_radius(&self, sample: &Sample) -> f64 {
        ((sample.gap + self.skin) * self.per_slope).max(0.0)
    }

    /// The unit normal and the signed distance to the offset surface along it [m], to first
    /// order: `(f − r) / ‖∇f‖`. `previous` replaces the normal if the gradient is too small or
    /// was not evaluated.
    #[inline]
    pub(crate) fn tangent(
        &self,
        sample: &Sample,
        previous: Vector<f64, 3>,
    ) -> (Vector<f64, 3>, f64) {
        match sample.tangent {
            Some(Tangent { normal, gap }) if normal != Vector::ZERO => (normal, gap),
            Some(Tangent { gap, .. }) => (previous, gap),
            None => (previous, sample.gap * self.per_slope),
        }
    }
}
