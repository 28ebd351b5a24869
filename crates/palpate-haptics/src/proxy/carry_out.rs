// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that changed under a proxy carry it out of them.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::FRAC_1_SQRT_2;

use palpate_field::{Point, Vector};
use palpate_query::constraints::PlaneConstraint;

use super::Proxy;
use crate::nearby::{Nearby, Punctured};
use crate::planes::Planes;
use crate::sampler::{Sample, Sampler};

/// How far an edit carries a probe that moves as a point [m], where the hand holds it. With more,
/// edits would push the hand over ways that it does not take for one touch; with less, a large step
/// of a slider would end a touch.
pub(crate) const MOST_OF_POINT: f64 = 0.005;

/// The bodies before may use one of so many parts of the probe's budget, those after the rest.
const PARTS: u32 = 2;

/// A way that meets the surface with a cosine below this is not extrapolated.
const LEAST_COSINE: f64 = 0.1;

/// A way out counts as the shortest if it is longer than the proven least one by at most this part.
const SHORTEST: f64 = 1e-6;

/// A step along a free way is this multiple of the way that is done: where that leaves a flat surface
/// at 26 degrees or more, the step is provable.
const GROWTH: f64 = 1.5;

/// A way grazes a surface if its middle is nearer to it than this part of its length.
const GRAZING: f64 = 0.25;

/// The most steps along a way: nine that each lead 2.5 times as far reach some thousand skins. A
/// way that grazes a surface needs more, and would use up the budget of the others.
const MOST_STEPS: u32 = 11;

/// The most samples from a place outside to the nearest one: a flat wall takes one, a corner three, a
/// curved surface a few more.
const MOST_PLANES: u32 = 8;

/// Where an edit carries a proxy.
#[derive(Clone, Copy, Debug)]
pub(super) struct CarriedOut {
    /// The place, evaluated in the bodies after the edit.
    pub(super) sample: Sample,
    /// The unit normal of the surface there.
    normal: Vector<f64, 3>,
    /// Where the proxy was in the last tick [m].
    from: Point<3>,
    /// How far the place is from there [m].
    pub(super) distance: f64,
}

impl Proxy {
    /// Forgets the bodies `before`, which changed to those of `after`. If these cover the proxy, they
    /// carry it out in the next tick, the shortest way. Returns how far [m]; `None` if they do not
    /// cover it, or if the way is longer than the probe's radius. For a probe that moves as a
    /// [point](super::Probe::new) the way may be as long as `most_of_point` [m].
    ///
    /// The place is on or outside the offset surface of all bodies, and on the side where the hand
    /// was: the way to it was free in the bodies before. So a plate that is thinner than the way
    /// carries a proxy out on the old side, also if it passed over the proxy as a whole. Of several
    /// ways out the shortest found is taken; where the distance inside is exact, it is proven to be the
    /// shortest.
    ///
    /// Friction holds on as it did. Layers stay punctured in a body of the same index with as many
    /// layers. If a body also [moves](crate::Bodies::set_pose) before the next tick, the motion alone
    /// counts.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; evaluates the fields at most
    /// [`Probe::budget`](super::Probe::budget) times.
    ///
    /// # Examples
    ///
    /// A point is pressed 2 mm into the ground, which then rises by 1 mm:
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::HalfSpace};
    /// use palpate_haptics::{Bodies, Probe, Proxy};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ground = |y| HalfSpace::new(Vector([0.0, 1.0, 0.0]), y).map(Shape::from_kernel);
    /// let (before, after) = (Bodies::from(ground(0.0)?), Bodies::from(ground(0.001)?));
    /// let mut proxy = Proxy::new(Probe::new(0.0)?);
    /// proxy.follow(&before.everything(), Vector([0.0, 0.1, 0.0]));
    /// let device = Vector([0.0, -0.002, 0.0]);
    /// proxy.follow(&before.everything(), device);
    ///
    /// let way = proxy.carry_out(&before.everything(), &after.everything(), 0.005);
    /// assert!(way.is_some_and(|way| (way - 0.001).abs() < 1e-9));
    /// let following = proxy.follow(&after.everything(), device);
    /// assert!(following.contact && !following.placed);
    /// assert!((following.proxy - Vector([0.0, 0.001, 0.0])).norm() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    #[inline(never)]
    pub fn carry_out(
        &mut self,
        before: &Nearby<'_>,
        after: &Nearby<'_>,
        most_of_point: f64,
    ) -> Option<f64> {
        let (at, is_stale, last) = (self.at, self.is_stale, self.carried_out);
        let punctured = self.punctured;
        self.forget_bodies();
        self.punctured = punctured;
        self.punctured.restore(|body, _| layers(before, body) != layers(after, body));
        let at = at?;
        let place = last.map_or(at.point, |last| last.sample.point);
        let radius = self.probe.radius;
        let extent = place.norm() + 2.0 * radius + most_of_point;
        let budget = self.probe.budget;
        let sampler = |nearby, punctured: Punctured, budget| {
            Sampler::new(nearby, punctured, radius, budget, extent)
        };
        let mut before = sampler(before, punctured, budget / PARTS);
        let mut after = sampler(after, self.punctured, budget - budget / PARTS);
        let gap = match last {
            Some(last) => last.sample.gap,
            None if is_stale => before.distance(place)?.gap,
            None => at.gap,
        };
        let origin = last.map_or(at.point, |last| last.from);
        let covered = after.gradient(place)?;
        let most = if after.is_point() { most_of_point } else { radius };
        // Along z planar shapes are endless, and there is no way out.
        let axes = if after.nearby().is_flat() { 2 } else { 3 };
        let mut way_out = WayOut { before, after, gap, covered, origin, most, best: None };
        // The known planes may lack a wall of a crease; the pull of the hand is between all of them.
        let pull = (at.point - self.device).normalized().unwrap_or(Vector::ZERO);
        let up = self.local.up().unwrap_or(self.normal) + pull;
        let up = up.normalized().unwrap_or(self.normal);
        if way_out.is_covered() {
            let side = if self.contact { self.normal } else { way_out.outwards() };
            let up = if self.contact { up } else { side };
            // The way up is likely to be one that was free, so it comes before all that may use up
            // the budget.
            way_out.leave(up, up);
            way_out.leave(side, up);
            if !way_out.is_shortest()
                && let Some(near) = way_out.nearest(covered, up)
            {
                way_out.take(near, up);
            }
            for axis in 0..axes {
                let across = Vector::unit(axis) - up * up.dot(Vector::unit(axis));
                for across in across.normalized().into_iter().flat_map(|way| [way, -way]) {
                    way_out.leave((up + across) * FRAC_1_SQRT_2, up);
                }
            }
        } else if last.is_some() {
            way_out.take(covered, up);
        } else if self.contact && covered.gap > way_out.after.skin() {
            // A thin body may have passed over the proxy that it held.
            way_out.over(up, at.body);
        }
        self.carried_out = way_out.best;
        self.carried_out.map(|out| out.distance)
    }

    /// Takes the proxy to where an edit carries it; `None` if none does, or if the body that does
    /// moves in this tick.
    pub(super) fn take_out(&mut self, nearby: &Nearby<'_>) -> Option<CarriedOut> {
        let out = self.carried_out.take()?;
        nearby.body(out.sample.body).filter(|body| !body.has_moved())?;
        (self.at, self.normal) = (Some(out.sample), out.normal);
        self.is_stale = false;
        self.local.forget();
        Some(out)
    }
}

/// The number of layers of a body.
fn layers(nearby: &Nearby<'_>, body: u32) -> Option<usize> {
    nearby.body(body).map(|body| body.surface().strata.count())
}

/// A point with its gap in the bodies before.
type Known = (Point<3>, f64);

/// The place outside all bodies that is nearest to `place`, near the sample `start`; `None` if none is
/// found soon. `up` replaces the normal where there is none.
///
/// As in a [slide](crate::contact), each sample is the point nearest to `place` above the tangent
/// planes of those before. Here the way between them need not be free.
pub(super) fn nearest_free(
    sampler: &mut Sampler<'_>,
    place: Point<3>,
    start: Sample,
    up: Vector<f64, 3>,
) -> Option<Sample> {
    let tolerance = sampler.tolerance();
    let (mut planes, mut here, mut best) = (Planes::new(), start, None::<Sample>);
    for _ in 0..MOST_PLANES {
        let (normal, gap) = sampler.tangent(&here, up);
        let wall = PlaneConstraint { point: here.point - normal * gap, normal };
        if planes.is_empty() {
            planes.add(wall);
        } else {
            planes.learn(here.point, wall, gap);
        }
        let Some(next) = planes.closest(place) else { break };
        let way = (next - here.point).norm();
        let is_there = here.gap >= -tolerance && way <= SHORTEST * (next - place).norm();
        if is_there {
            return Some(here);
        }
        let Some(next) = sampler.gradient(next) else { break };
        here = next;
        let distance = |sample: &Sample| (sample.point - place).norm();
        let is_better = best.is_none_or(|best| distance(&here) < distance(&best));
        if here.gap >= -tolerance && is_better {
            best = Some(here);
        }
    }
    best
}

/// The search for the shortest way out.
struct WayOut<'a> {
    /// The bodies before and after.
    before: Sampler<'a>,
    after: Sampler<'a>,
    /// The proxy's gap in the bodies before [m].
    gap: f64,
    /// The proxy in the bodies after.
    covered: Sample,
    /// From where the way counts [m].
    origin: Point<3>,
    /// The longest way [m].
    most: f64,
    best: Option<CarriedOut>,
}

impl WayOut<'_> {
    fn is_covered(&self) -> bool {
        self.covered.gap < -self.after.tolerance()
    }

    /// The length below which no way leads out [m].
    fn least(&self) -> f64 {
        -self.covered.gap * self.after.per_slope()
    }

    /// The direction away from the bodies before; zero if there is none.
    fn outwards(&mut self) -> Vector<f64, 3> {
        let sample = self.before.gradient(self.covered.point);
        sample.map_or(Vector::ZERO, |sample| self.before.tangent(&sample, Vector::ZERO).0)
    }

    /// Whether the best way out is proven to be the shortest.
    fn is_shortest(&self) -> bool {
        let proven = self.least() * (1.0 + SHORTEST) + 2.0 * self.after.tolerance();
        self.best.is_some_and(|best| best.distance <= proven)
    }

    /// Looks for a way out that begins along a unit vector, unless the shortest is known; `up` is
    /// away from the bodies before.
    fn leave(&mut self, along: Vector<f64, 3>, up: Vector<f64, 3>) {
        if along == Vector::ZERO || self.is_shortest() {
            return;
        }
        if let Some(exit) = self.exit(along, self.covered, 0.0) {
            self.try_near(exit, up);
        }
    }

    /// Looks beyond the body `touched` for the place of a proxy that it passed over, along a unit
    /// vector.
    fn over(&mut self, along: Vector<f64, 3>, touched: u32) {
        let (place, mut here, mut way) = (self.covered.point, self.covered, 0.0);
        // Conservative advancement to the body (Mirtich 1996).
        while here.gap >= -self.after.tolerance() {
            way += (here.gap * self.after.per_slope()).max(self.after.near());
            if way > self.most {
                return;
            }
            let Some(next) = self.after.gradient(place + along * way) else { return };
            here = next;
        }
        if here.body == touched
            && let Some(exit) = self.exit(along, here, way)
            && exit.gap >= -self.after.tolerance()
        {
            self.try_near(exit, along);
        }
    }

    /// The first sample outside on a way along a unit vector that is inside at its length `way` [m];
    /// the last one inside if the way becomes too long, or after [`MOST_STEPS`]. `None` if that is not
    /// known.
    ///
    /// No surface is within `−f / L` of a point inside. A step to the tangent plane goes farther.
    fn exit(
        &mut self,
        along: Vector<f64, 3>,
        mut here: Sample,
        mut way: f64,
    ) -> Option<Sample> {
        let (place, tolerance) = (self.covered.point, self.after.tolerance());
        for _ in 0..MOST_STEPS {
            let sure = -here.gap * self.after.per_slope();
            let (normal, gap) = self.after.tangent(&here, Vector::ZERO);
            let cosine = normal.dot(along);
            let likely = if cosine > LEAST_COSINE { -gap / cosine } else { 0.0 };
            let likely = if way + likely <= self.most { likely } else { 0.0 };
            way += sure.max(likely).max(tolerance);
            // Written so that NaN ends the way.
            let is_near = way <= self.most + tolerance;
            if !is_near {
                break;
            }
            here = self.after.gradient(place + along * way)?;
            if here.gap >= -tolerance {
                return Some(here);
            }
        }
        Some(here)
    }

    /// Takes the place nearest to the proxy near `exit`, or `exit` itself if it is outside.
    fn try_near(&mut self, exit: Sample, up: Vector<f64, 3>) {
        let near = self.nearest(exit, up);
        if !near.is_some_and(|near| self.take(near, up))
            && near.is_none_or(|near| near.point != exit.point)
        {
            self.take(exit, up);
        }
    }

    /// The place nearest to the proxy near a sample; `None` if none is found soon. Whether the way to
    /// it was free, [`was_free`](Self::was_free) tells.
    fn nearest(&mut self, start: Sample, up: Vector<f64, 3>) -> Option<Sample> {
        nearest_free(&mut self.after, self.covered.point, start, up)
    }

    /// Takes a sample if it is the best so far, and the way to it was free.
    fn take(&mut self, sample: Sample, up: Vector<f64, 3>) -> bool {
        let (distance, tolerance) =
            ((sample.point - self.origin).norm(), self.after.tolerance());
        // What is as good is likely to be the same place, whose proof would cost once more.
        let most = self
            .best
            .map_or(self.most + tolerance, |best| best.distance * (1.0 - SHORTEST) - tolerance);
        let is_better = distance <= most && sample.gap >= -tolerance;
        if !is_better || !self.was_free(sample.point, up) {
            return false;
        }
        let (normal, _) = self.after.tangent(&sample, up);
        self.best = Some(CarriedOut { sample, normal, from: self.origin, distance });
        true
    }

    /// Whether the way from the proxy to a point was free in the bodies before: straight, or where that
    /// grazes a surface over a point beside its middle, which takes fewer steps to prove.
    fn was_free(&mut self, to: Point<3>, up: Vector<f64, 3>) -> bool {
        let from = (self.covered.point, self.gap);
        let Some(end) = self.known(to) else { return false };
        let length = (to - from.0).norm();
        if self.is_proven([from, end], length) {
            return true;
        }
        let middle = (from.0 + to) * 0.5;
        let Some(beside) = self.before.gradient(middle) else { return false };
        if beside.gap > GRAZING * length {
            return self.is_free(from, end);
        }
        // Beyond an edge the surface leads the way along, and at a crease it is up that may do so.
        let (away, _) = self.before.tangent(&beside, up);
        let away = (away + up).normalized().unwrap_or(away);
        let above = self.known(middle + away * length);
        above.is_some_and(|above| self.is_free(from, above) && self.is_free(end, above))
    }

    /// A point with its gap in the bodies before; `None` inside them, or if it is not known.
    fn known(&mut self, point: Point<3>) -> Option<Known> {
        let sample = self.before.distance(point)?;
        (sample.gap >= -0.5 * self.before.skin()).then_some((point, sample.gap))
    }

    /// Whether the gaps at both ends prove that the bodies before leave a straight way free, but for
    /// dips of half a skin.
    ///
    /// With the gaps `a` and `b` at its ends and the Lipschitz constant `L`, no point of a way of
    /// length `l` has a gap below `(a + b − L l) / 2`.
    fn is_proven(&self, [(_, a), (_, b)]: [Known; 2], length: f64) -> bool {
        (a + b + self.before.skin()) * self.before.per_slope() >= length
    }

    /// Whether the bodies before leave a straight way free, but for dips of half a skin.
    ///
    /// Away from a surface, provable steps grow in proportion to the way that is done. `false` after
    /// [`MOST_STEPS`].
    fn is_free(&mut self, from: Known, to: Known) -> bool {
        let way = to.0 - from.0;
        let length = way.norm();
        let (mut done, mut here) = (0.0, from);
        let mut step = (here.1 + self.before.skin()) * self.before.per_slope();
        for _ in 0..MOST_STEPS {
            if self.is_proven([here, to], length - done) {
                return true;
            }
            step = step.min(length - done);
            let Some(next) = self.known(from.0 + way * ((done + step) / length)) else {
                return false;
            };
            if self.is_proven([here, next], step) {
                (done, here) = (done + step, next);
                let sure = (here.1 + self.before.skin()) * self.before.per_slope();
                step = sure.max(GROWTH * done);
            } else {
                step *= 0.5;
            }
        }
        false
    }
}
