// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scans of a shell.
//!
//! The distances of a shell's points from the bodies, and how long each remains valid.
//!
//! A rigid motion that moves the tool's origin by `v` and rotates the tool by `ω` moves a point
//! `ρ` from the origin by at most `‖v‖ + ‖ω‖ρ`. So a cluster whose least gap was `g` cannot
//! touch before the sum of these motions has grown by `g / L`, and is not evaluated until then
//! (Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996, section 2.3; for
//! shells, Johnson, Willemsen and Cohen, "Six degree-of-freedom haptic rendering using
//! spatialized normal cone search", 2005, also keep the near points). Within such a cluster,
//! only those points are evaluated that could touch by their own gaps and their own motions,
//! which are often shorter.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::{Deref, DerefMut};

use palpate_field::{BLOCK, Block, Gradients, Point, Pose, Vector};

use super::coupling::Twist;
use super::shell::{Cluster, Shell};
use super::sweep::SweptPoint;
use crate::nearby::Nearby;

/// When a point was evaluated.
#[derive(Clone, Copy, Debug)]
struct PointMark {
    /// The number of the pose.
    stamp: u64,
    /// The reading of the cluster's clock before which the point cannot touch.
    free_until: f64,
}

impl PointMark {
    const NONE: Self = Self { stamp: 0, free_until: f64::NEG_INFINITY };

    /// `true` if the point was evaluated since the bodies last changed.
    fn is_known(&self) -> bool {
        self.stamp > 0
    }
}

/// The validity of a cluster's evaluations: until when none of its points can touch.
#[derive(Clone, Copy, Debug)]
struct ClusterMark {
    /// The number of the pose at which the cluster was evaluated.
    stamp: u64,
    /// The clock reading before which none of its points can touch.
    free_until: f64,
    /// The same for the points that were not evaluated at that pose because they were too far
    /// away.
    rest_until: f64,
}

impl ClusterMark {
    const NONE: Self =
        Self { stamp: 0, free_until: f64::NEG_INFINITY, rest_until: f64::NEG_INFINITY };

    /// The clock reading before which no point can touch that was not evaluated at the present
    /// pose.
    fn unseen_until(&self, stamp: u64) -> f64 {
        if self.stamp == stamp { self.rest_until } else { self.free_until }
    }
}

/// The shell that moves, and the bodies near it.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) shell: &'a Shell,
    pub(super) nearby: &'a Nearby<'a>,
}

/// A motion of the tool.
#[derive(Clone, Copy)]
pub(super) struct Path<'a> {
    /// The pose at the start.
    pub(super) pose: &'a Pose<3>,
    /// The motion from there.
    pub(super) twist: &'a Twist,
}

/// A cluster to evaluate now.
#[derive(Clone, Copy, Debug)]
struct DueCluster {
    cluster: u32,
    /// The end of this cluster's points in the list of near points.
    end: usize,
    /// The clock reading before which the points evaluated earlier at this pose cannot touch.
    seen_until: f64,
    /// The same for the points that are not evaluated.
    rest_until: f64,
}

/// The total translation and rotation of the tool so far, which only grow.
#[derive(Clone, Copy, Debug, Default)]
struct Clock {
    way: f64,
    turn: f64,
}

impl Clock {
    /// The translation and rotation of one motion.
    fn of(twist: &Twist) -> Self {
        Self { way: twist.linear.norm(), turn: twist.angular.norm() }
    }

    /// The largest total motion of a point at distance `arm` from the origin.
    fn at(&self, arm: f64) -> f64 {
        self.way + self.turn * arm
    }
}

/// The evaluations of a shell.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    points: Vec<Evaluation>,
    marks: Vec<PointMark>,
    /// Where the points were evaluated, in the frame that rides on the body: see [`Scan::ride`].
    places: Vec<Point<3>>,
    /// From that frame to the world; `None` while no body carries the tool.
    frame: Option<Pose<3>>,
    looks: Vec<ClusterMark>,
    clock: Clock,
    /// The number of the present pose.
    stamp: u64,
    /// Clusters to evaluate now.
    due: FixedList<DueCluster>,
    /// The points that were evaluated at the present pose.
    near: FixedList<u32>,
    /// Levels of the shell that are evaluated in this tick.
    levels: usize,
    budget: u32,
    evaluations: u32,
    /// Points whose motion is swept.
    pub(super) swept_points: FixedList<SweptPoint>,
    pub(super) batch: Box<Batch>,
}

impl Scan {
    pub(super) fn new(shell: &Shell) -> Self {
        let zero = Vector::ZERO;
        let nothing =
            Evaluation { centre: zero, gap: f64::NEG_INFINITY, gradient: zero, body: 0 };
        Self {
            points: vec![nothing; shell.points().len()],
            marks: vec![PointMark::NONE; shell.points().len()],
            places: vec![Vector::ZERO; shell.points().len()],
            frame: None,
            looks: vec![ClusterMark::NONE; shell.clusters.len()],
            clock: Clock::default(),
            stamp: 1,
            due: FixedList::with_capacity(shell.clusters.len()),
            near: FixedList::with_capacity(shell.points().len()),
            levels: shell.levels.len(),
            budget: 0,
            evaluations: 0,
            swept_points: FixedList::with_capacity(shell.points().len()),
            batch: Batch::boxed(),
        }
    }

    /// Begins a tick with all levels and a budget.
    pub(super) fn begin(&mut self, shell: &Shell, budget: u32) {
        (self.levels, self.budget, self.evaluations) = (shell.levels.len(), budget, 0);
    }

    /// Keeps all evaluations of a tool that rides on the only body near: this moved by `motion` in the
    /// world, and the tool with it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn ride(&mut self, motion: &Pose<3>) {
        if self.frame.is_none() {
            self.places
                .iter_mut()
                .zip(&self.points)
                .for_each(|(place, seen)| *place = seen.centre);
        }
        self.frame = Some(self.frame.map_or(*motion, |frame| *motion * frame));
        for number in &self.near {
            if let Some(seen) = self.points.get_mut(*number as usize) {
                seen.centre = motion.transform_point(seen.centre);
                seen.gradient = motion.transform_vector(seen.gradient);
            }
        }
    }

    /// Discards all evaluations, because the bodies changed.
    pub(super) fn forget(&mut self) {
        self.frame = None;
        self.looks.fill(ClusterMark::NONE);
        self.marks.fill(PointMark::NONE);
        self.leave();
    }

    /// Records a motion of the tool.
    pub(super) fn moved(&mut self, twist: &Twist) {
        let motion = Clock::of(twist);
        self.clock.way += motion.way;
        self.clock.turn += motion.turn;
        self.leave();
    }

    /// Begins a new pose, at which no point is evaluated yet.
    fn leave(&mut self) {
        self.stamp += 1;
        self.near.clear();
    }

    /// The number of evaluations in this tick.
    pub(super) fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// The number of levels that are evaluated in this tick.
    pub(super) fn levels(&self) -> usize {
        self.levels
    }

    /// Evaluations that are left in this tick.
    pub(super) fn left(&self) -> u32 {
        self.budget.saturating_sub(self.evaluations)
    }

    /// Counts evaluations.
    pub(super) fn spend(&mut self, evaluations: u32) {
        self.evaluations += evaluations;
    }

    /// The last evaluation of a point.
    pub(super) fn point(&self, number: u32) -> Option<&Evaluation> {
        self.points.get(number as usize)
    }

    /// Evaluates all points that could touch a body if the tool makes a motion like `path`,
    /// limited to `horizon` [m] for every point. If these points need more than `share` of the
    /// remaining budget, fewer levels are evaluated; `false` if the budget does not suffice for
    /// the first level.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn look(
        &mut self,
        surroundings: Surroundings<'_>,
        path: Path<'_>,
        horizon: f64,
        share: f64,
    ) -> bool {
        let Surroundings { shell, nearby } = surroundings;
        let Path { pose, twist } = path;
        self.due.clear();
        let (left, begin, stamp) = (f64::from(self.left()), self.near.len(), self.stamp);
        let mut is_enough = true;
        let motion = Clock::of(twist);
        let lipschitz = nearby.lipschitz().max(f64::MIN_POSITIVE);
        for (index, (cluster, look)) in (0..).zip(shell.clusters.iter().zip(&self.looks)) {
            if cluster.level >= self.levels {
                break;
            }
            let now = self.clock.at(cluster.arm);
            let until = now + motion.at(cluster.arm).min(horizon);
            if look.unseen_until(stamp) > until {
                continue;
            }
            let before = self.near.len();
            let (mut seen_until, mut rest_until) = (f64::INFINITY, f64::INFINITY);
            for number in shell.members(cluster) {
                let Some(mark) = self.marks.get_mut(number as usize) else { continue };
                if mark.stamp == stamp {
                    seen_until = least(seen_until, mark.free_until);
                    continue;
                }
                // Written so that NaN is evaluated, here and below.
                let is_free = |until_then: f64| until_then > until;
                if !is_free(mark.free_until) && mark.is_known() {
                    let i = number as usize;
                    let known = shell.points().get(i).zip(self.points.get(i));
                    let known = known.zip(self.places.get(i));
                    let went = known.map_or(f64::INFINITY, |((point, seen), place)| {
                        let frame = self.frame.as_ref();
                        let was = frame.map_or(seen.centre, |it| it.transform_point(*place));
                        let way = pose.transform_point(point.centre) - was;
                        way.norm() - seen.gap / lipschitz
                    });
                    mark.free_until = mark.free_until.max(now - went);
                }
                if is_free(mark.free_until) {
                    rest_until = least(rest_until, mark.free_until);
                } else {
                    self.near.push(number);
                }
            }
            let allowed = if cluster.level == 0 { left } else { left * share };
            if (self.near.len() - begin) as f64 > allowed {
                self.near.truncate(before);
                self.levels = cluster.level;
                is_enough = cluster.level > 0;
                break;
            }
            let (cluster, end) = (index, self.near.len());
            self.due.push(DueCluster { cluster, end, seen_until, rest_until });
        }
        self.evaluate(shell, nearby, pose, begin);
        is_enough
    }

    /// Evaluates the near points from index `begin` on, of the clusters that are due.
    fn evaluate(&mut self, shell: &Shell, nearby: &Nearby<'_>, pose: &Pose<3>, begin: usize) {
        let lipschitz = nearby.lipschitz().max(f64::MIN_POSITIVE);
        let mut numbers = self.near.iter().skip(begin).copied();
        let batch = &mut *self.batch;
        let to_frame = self.frame.map(|frame| frame.inverse());
        loop {
            batch.gather(shell, pose, &mut numbers);
            if batch.count == 0 {
                break;
            }
            batch.evaluate(nearby);
            self.evaluations += batch.count as u32;
            for (number, seen) in batch.results() {
                let i = number as usize;
                if let Some(point) = self.points.get_mut(i) {
                    *point = *seen;
                }
                if let Some((to_frame, place)) = to_frame.as_ref().zip(self.places.get_mut(i)) {
                    *place = to_frame.transform_point(seen.centre);
                }
            }
        }
        let mut near = self.near.iter().skip(begin);
        let mut begin = begin;
        for DueCluster { cluster: index, end, seen_until, rest_until } in &self.due {
            let cluster = shell.clusters.get(*index as usize);
            let look = self.looks.get_mut(*index as usize);
            let Some((cluster, look)) = cluster.zip(look) else { continue };
            let (now, mut free_until) =
                (self.clock.at(cluster.arm), least(*seen_until, *rest_until));
            for number in near.by_ref().take(end - begin) {
                let place = *number as usize;
                let known = self.points.get(place).zip(self.marks.get_mut(place));
                let Some((point, mark)) = known else { continue };
                *mark =
                    PointMark { stamp: self.stamp, free_until: now + point.gap / lipschitz };
                free_until = least(free_until, mark.free_until);
            }
            begin = *end;
            *look = ClusterMark { stamp: self.stamp, free_until, rest_until: *rest_until };
        }
    }

    /// The points that were evaluated at the present pose, with their numbers.
    pub(super) fn seen(&self) -> impl Iterator<Item = (u32, &Evaluation)> {
        self.near.iter().filter_map(|i| Some((*i, self.points.get(*i as usize)?)))
    }

    /// The least gap of the points evaluated at the present pose [m].
    pub(super) fn least_gap(&self) -> f64 {
        self.seen().fold(f64::INFINITY, |gap, (_, point)| least(gap, point.gap))
    }

    /// The part of a motion in which no point can touch that was not evaluated at the present
    /// pose.
    pub(super) fn free_part(&self, shell: &Shell, twist: &Twist) -> f64 {
        let (mut part, motion) = (1.0_f64, Clock::of(twist));
        for (cluster, look) in shell.clusters.iter().zip(&self.looks) {
            if cluster.level >= self.levels {
                break;
            }
            let until = look.unseen_until(self.stamp);
            // Written so that NaN allows no motion.
            let remaining = (until - self.clock.at(cluster.arm)).max(0.0);
            let way = motion.at(cluster.arm);
            if way > remaining {
                part = part.min(remaining / way);
            }
        }
        part
    }

    /// The number of points that are proven outside at the present pose.
    pub(super) fn known(&self, shell: &Shell) -> u32 {
        let known = shell.clusters.iter().zip(&self.looks).filter(|(cluster, look)| {
            look.stamp == self.stamp || look.free_until >= self.clock.at(cluster.arm)
        });
        known.map(|(cluster, _)| cluster.members.len() as u32).sum()
    }
}

/// The lesser of two numbers; NaN if either is.
#[inline]
fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || b >= a { a } else { b }
}

impl Shell {
    /// The numbers of the points of a cluster.
    fn members(&self, cluster: &Cluster) -> impl Iterator<Item = u32> + '_ {
        self.order.get(cluster.members.clone()).unwrap_or(&[]).iter().copied()
    }
}

/// The last evaluation of a shell point, in world coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluation {
    /// Its centre [m].
    pub(super) centre: Point<3>,
    /// The field less the point's radius [m].
    pub(super) gap: f64,
    pub(super) gradient: Vector<f64, 3>,
    pub(super) body: u32,
}

/// Points that are evaluated together.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pub(super) count: usize,
    numbers: [u32; BLOCK],
    radii: [f64; BLOCK],
    seen: [Evaluation; BLOCK],
    block: Block<f64, 3, BLOCK>,
    answers: Gradients<f64, 3, BLOCK>,
    /// The points for which a body is evaluated.
    lanes: [usize; BLOCK],
}

impl Batch {
    pub(super) fn boxed() -> Box<Self> {
        let nothing =
            Evaluation { centre: Vector::ZERO, gap: 0.0, gradient: Vector::ZERO, body: 0 };
        Box::new(Self {
            count: 0,
            numbers: [0; BLOCK],
            radii: [0.0; BLOCK],
            seen: [nothing; BLOCK],
            block: Block::zero(),
            answers: Gradients::zero(),
            lanes: [0; BLOCK],
        })
    }

    /// Takes the next points.
    pub(super) fn gather(
        &mut self,
        shell: &Shell,
        pose: &Pose<3>,
        numbers: &mut impl Iterator<Item = u32>,
    ) {
        self.count = 0;
        let places = self.numbers.iter_mut().zip(&mut self.radii).zip(&mut self.seen);
        // Places come first in the zip: otherwise a number would be consumed when no place is
        // left.
        for (((number, radius), seen), next) in places.zip(numbers) {
            let Some(point) = shell.points().get(next as usize) else { continue };
            (*number, *radius) = (next, point.radius);
            seen.centre = pose.transform_point(point.centre);
            self.count += 1;
        }
    }

    /// Evaluates all near bodies with gradients: [`Nearby::gradient`] in blocks.
    pub(super) fn evaluate(&mut self, nearby: &Nearby<'_>) {
        self.evaluate_with(nearby, true);
    }

    /// Evaluates gaps only, which costs less; gradients are left undefined.
    pub(super) fn evaluate_gaps(&mut self, nearby: &Nearby<'_>) {
        self.evaluate_with(nearby, false);
    }

    fn evaluate_with(&mut self, nearby: &Nearby<'_>, has_gradients: bool) {
        let is_all = nearby.horizon == f64::INFINITY;
        for seen in self.seen.iter_mut().take(self.count) {
            (seen.gap, seen.gradient, seen.body) = (f64::INFINITY, Vector::ZERO, 0);
            if !is_all {
                let way = seen.centre - nearby.centre;
                seen.gap = nearby.horizon - way.norm();
                seen.gradient = -way.normalized().unwrap_or(Vector::ZERO);
            }
        }
        for (index, body) in nearby.all() {
            let mut asked = 0;
            let points = self.seen.iter().take(self.count).enumerate();
            for (lane, seen) in points {
                // Written so that NaN is evaluated.
                if seen.gap < f64::INFINITY && body.above_ball(seen.centre) >= seen.gap {
                    continue;
                }
                self.block.set(asked, body.in_body(seen.centre));
                if let Some(place) = self.lanes.get_mut(asked) {
                    *place = lane;
                }
                asked += 1;
            }
            if asked == 0 {
                continue;
            }
            if has_gradients {
                body.shape().block_gradients(&self.block, asked, &mut self.answers);
            } else {
                body.shape().block_distances(&self.block, asked, &mut self.answers.distance);
            }
            let turn = body.world_from_body();
            for (answer, lane) in self.lanes.iter().take(asked).enumerate() {
                let Some(seen) = self.seen.get_mut(*lane) else { continue };
                let distance = self.answers.distance.get(answer);
                let beyond =
                    body.region.is_some_and(|r| (seen.centre - r.centre).norm() > r.radius);
                let is_bounded = body.is_below_ball || beyond;
                let above = is_bounded.then(|| body.above_ball(seen.centre));
                let (gap, gradient) = match above.filter(|above| *above > distance) {
                    Some(above) => {
                        let outwards = body.off_centre(seen.centre);
                        (above, outwards.and_then(Vector::normalized).unwrap_or(Vector::ZERO))
                    }
                    None if !has_gradients => (distance, Vector::ZERO),
                    None => {
                        let gradient = self.answers.gradient.get(answer);
                        (distance, turn.transform_vector(gradient))
                    }
                };
                // Written so that NaN stays.
                if gap.is_nan() || gap < seen.gap {
                    (seen.gap, seen.gradient, seen.body) = (gap, gradient, index);
                }
            }
        }
        for (seen, radius) in self.seen.iter_mut().zip(&self.radii).take(self.count) {
            seen.gap -= radius;
        }
    }

    pub(super) fn results(&self) -> impl Iterator<Item = (u32, &Evaluation)> {
        self.numbers.iter().copied().zip(&self.seen).take(self.count)
    }
}

/// A list with a fixed capacity that its clones keep; a cloned `Vec` has capacity only for its
/// content.
#[derive(Debug, Default)]
pub(super) struct FixedList<T>(Vec<T>);

impl<T> FixedList<T> {
    /// An empty list with this capacity.
    pub(super) fn with_capacity(count: usize) -> Self {
        Self(Vec::with_capacity(count))
    }
}

impl<T: Clone> Clone for FixedList<T> {
    fn clone(&self) -> Self {
        let mut list = Self::with_capacity(self.capacity());
        list.extend_from_slice(self);
        list
    }
}

impl<T> Deref for FixedList<T> {
    type Target = Vec<T>;

    fn deref(&self) -> &Vec<T> {
        &self.0
    }
}

impl<T> DerefMut for FixedList<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        &mut self.0
    }
}

impl<'a, T> IntoIterator for &'a FixedList<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number after NaN must not hide it: a tool would count as outside although the field
    /// gave no value.
    #[test]
    fn a_gap_that_is_no_number_stays_the_least() {
        let gaps = [1.0, f64::NAN, 2.0];
        assert!(gaps.into_iter().fold(f64::INFINITY, least).is_nan());
        assert_eq!([1.0, -0.5, 2.0].into_iter().fold(f64::INFINITY, least), -0.5);
    }
}
