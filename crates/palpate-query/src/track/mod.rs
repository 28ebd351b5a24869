// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies followed from step to step.

mod contacts;
mod first_seen;
mod history;
mod kept;
mod names;

use palpate_field::{Aabb, Point, Pose, Shape, Vector};

use crate::certified::{Certified, Goal, Limits, Stop};
use crate::contact::Contact;
use crate::error::QueryError;
use crate::manifold::{Manifold, ManifoldSettings, SeparatedPair};
use crate::pair::body_pair::BodyPair;
use crate::pair::distance_bound::DistanceBound;
use crate::pair::search::PairSearch;
use crate::pair::{Nearest, PairWorkspace};
use crate::query::{size, smallest};
use crate::sampler::Placed;
use contacts::Carried;
pub use contacts::TrackedContacts;
use first_seen::contacts_outside;
use history::History;
use kept::Kept;
use names::Names;

/// A search for several steps asks for bounds that are this share of the tolerance apart.
const FINER: f64 = 1.0 / 8.0;

/// A pair that moves by more than this share of the tolerance in a step is searched for that step
/// alone.
const FAR: f64 = 1.5;

/// A proof to the tolerance may last where a pair moves by no more than this share of it.
const LITTLE: f64 = 0.05;

/// If a search for several steps served none of the later steps, this many searches are for one step each.
/// Each further failure doubles the number.
const ALONE: u32 = 8;

/// A pair of shapes that moves: each step starts from what the last search proved.
///
/// A motion that moves no point of a body by more than δ lowers no separation by more than δ: in
/// coordinates that go half of the way, each of both distances changes by at most δ/2. So a proof
/// lasts while the bodies stay near the poses of its search, and a step costs a few evaluations for
/// the upper bound. Where bodies move little, a search goes on beyond the tolerance, so that its
/// proof lasts for more steps; where they move far, each step is searched for itself, as by
/// [`separation`](crate::separation). No step of a long run costs more than that on average.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_query::{Limits, PairWorkspace, Track};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(0.5)?);
/// let mut track = Track::new(ball.clone(), ball);
/// let mut workspace = PairWorkspace::new();
/// for step in 0..100 {
///     let apart = 1.0 + 1e-4 * f64::from(step);
///     let poses = [Pose::identity(), Pose::translation(Vector([apart, 0.0, 0.0]))];
///     let answer = track.separation(poses, &Limits::new(1e-4), &mut workspace)?;
///     assert!(answer.lower <= apart - 1.0 && apart - 1.0 <= answer.upper);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Track<const D: usize> {
    shapes: [Shape<D>; 2],
    memory: TrackMemory<D>,
    /// The contacts of the last step.
    found: TrackedContacts<D>,
}

/// What a [`Track`] remembers of earlier steps, without its shapes: a snapshot of it.
///
/// A track of the same shapes that begins with it goes on as the other did, to the last bit. With the feature
/// `serde` it can be stored, in a format that keeps every bit of a number: `serde_json` needs its feature
/// `float_roundtrip`.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrackMemory<const D: usize> {
    known: Option<Known<D>>,
    /// How many of the next searches are for their steps alone, and how many after the next proof that
    /// does not last.
    alone: u32,
    next_alone: u32,
    kept: Option<Kept<D>>,
    carried: Option<Carried<D>>,
    names: Names<D>,
    history: History<D>,
}

impl<const D: usize> Default for TrackMemory<D> {
    fn default() -> Self {
        Self {
            known: None,
            alone: 0,
            next_alone: ALONE,
            kept: None,
            carried: None,
            names: Names::default(),
            history: History::default(),
        }
    }
}

/// What the last search proved, and where the bodies were.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Known<const D: usize> {
    /// A lower bound of the larger of both values at every point [m].
    lower: f64,
    /// The second body in the first one's coordinates, at that search.
    proven_at: Pose<D>,
    /// The same in the last step, and the best point then, in the first body's coordinates.
    last: Pose<D>,
    best: Point<D>,
    /// Whether the search was for several steps, and whether it was for one at least.
    is_lasting: bool,
    has_lasted: bool,
}

impl<const D: usize> Track<D> {
    /// A track of these shapes that knows nothing yet.
    #[must_use]
    #[inline(never)]
    pub fn new(a: Shape<D>, b: Shape<D>) -> Self {
        Self::with_memory(a, b, TrackMemory::default())
    }

    /// A track that goes on where one of the same shapes was.
    #[must_use]
    #[inline(never)]
    pub fn with_memory(a: Shape<D>, b: Shape<D>, memory: TrackMemory<D>) -> Self {
        Self { shapes: [a, b], memory, found: TrackedContacts::default() }
    }

    /// What the track remembers of earlier steps.
    #[must_use]
    pub fn memory(&self) -> &TrackMemory<D> {
        &self.memory
    }

    /// The shapes.
    #[must_use]
    pub fn shapes(&self) -> &[Shape<D>; 2] {
        &self.shapes
    }

    /// The diameter of the smaller body's box [m], of which tolerances and settings are shares; zero if neither is
    /// bounded.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_query::{ManifoldSettings, Track};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let track = Track::new(Shape::<2>::half_space([0.0, 1.0], 0.0)?, Shape::rectangle([0.3, 0.4])?);
    /// assert!((track.size() - 0.5).abs() < 1e-12);
    /// let settings = ManifoldSettings::of_size(track.size());
    /// assert!((settings.margin - 0.001).abs() < 1e-12);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn size(&self) -> f64 {
        smallest(self.shapes.each_ref().map(size))
    }

    /// Forgets all bounds and the sides on which contacts came in: the next search begins anew. Contacts keep
    /// their ids. Call it when a body was placed elsewhere.
    pub fn forget(&mut self) {
        self.put_down();
        let TrackMemory { known, kept, history, .. } = &mut self.memory;
        (*known, *kept, *history) = (None, None, History::default());
    }

    /// The separation of both shapes at these poses, `world_from_body`, as
    /// [`separation`](crate::separation) finds it.
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    #[inline(never)]
    pub fn separation(
        &mut self,
        poses: [Pose<D>; 2],
        limits: &Limits,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let goal = Goal::separation(limits);
        Ok(self.search(poses, goal, limits, workspace)?.0)
    }

    /// The answer, and where it is in the first shape's coordinates.
    fn search(
        &mut self,
        poses: [Pose<D>; 2],
        goal: Goal,
        limits: &Limits,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<(Certified<Nearest<D>>, Point<D>), QueryError> {
        let [a, b] = &self.shapes;
        let pair = BodyPair::new(Placed::new(a, poses[0]), Placed::new(b, poses[1]))?;
        let now = pair.second_from_frame;
        let mut search = PairSearch::new(pair, goal, limits)?;
        if let Some(answer) = search.told_by_boxes() {
            return Ok((answer, search.best));
        }
        // A region where a steepness holds moves with its body.
        let is_known = search.pair.bodies.iter().all(DistanceBound::is_known_everywhere);
        let known = self.memory.known.take().filter(|_| is_known);
        let (mut start, mut is_lasting) = (None, false);
        if let Some(known) = &known {
            let moved = displacement(&known.last, &now, &search.pair.root(0.0));
            let is_near = moved <= FAR * goal.tolerance;
            if is_near && (known.is_lasting || moved <= LITTLE * goal.tolerance) {
                let (stop, lower) = known.told(&mut search);
                if let Some(stop) = stop {
                    let best = search.best;
                    self.memory.known =
                        Some(Known { last: now, best, has_lasted: true, ..*known });
                    return Ok((search.answer(stop, lower), best));
                }
                start = Some((search.upper, search.best));
            }
            if known.is_lasting && !known.has_lasted {
                (self.memory.alone, self.memory.next_alone) =
                    (self.memory.next_alone, 2 * self.memory.next_alone);
            } else if known.is_lasting {
                self.memory.next_alone = ALONE;
            }
            is_lasting = is_near && self.memory.alone == 0;
            self.memory.alone = self.memory.alone.saturating_sub(1);
            if is_lasting {
                // The proof of a search to the tolerance would not last.
                search.go_on(FINER, (0.5 * goal.tolerance / moved).min(1.0));
            }
        }
        let (answer, _) = search.run_from(start, workspace);
        let lower = 0.5 * answer.lower;
        let (best, has_lasted) = (search.best, false);
        let known = Known { lower, proven_at: now, last: now, best, is_lasting, has_lasted };
        self.memory.known = (answer.lower > f64::NEG_INFINITY).then_some(known);
        Ok((answer, search.best))
    }
}

impl<const D: usize> Known<D> {
    /// Why nothing has to be searched, if so, and the lower bound that is left.
    fn told(&self, search: &mut PairSearch<'_, D>) -> (Option<Stop>, f64) {
        search.start_at(self.best);
        let root = search.root();
        let reach = root.radius_about_origin().max(self.best.norm());
        search.slack = search.pair.slack(reach);
        let moved = displacement(&self.proven_at, &search.pair.second_from_frame, &root);
        // The bound already holds with the rounding of its own search. Outside of the box, which may
        // have moved farther, values are above those that matter.
        let lower = (self.lower - 0.5 * moved - search.slack).min(search.dropped);
        let reached = |search: &PairSearch<'_, D>| {
            search.goal.reached(lower, search.upper + search.slack)
        };
        let mut stop = reached(search);
        if stop.is_none() {
            // The best point has moved as little as the bodies have.
            search.descend(self.best, Some(moved.max(search.goal.tolerance)));
            stop = reached(search);
        }
        (stop, lower)
    }
}

/// An upper bound of how far points of a box move in a body's coordinates, from one pose of the
/// box's frame there to another [m].
fn displacement<const D: usize>(before: &Pose<D>, now: &Pose<D>, root: &Aabb<D>) -> f64 {
    let (centre, radius) = (root.centre(), root.half_extents().norm());
    let turned = before
        .rotation
        .matrix()
        .iter()
        .zip(now.rotation.matrix())
        .map(|(before, now)| (Vector(*now) - Vector(*before)).norm().powi(2));
    let moved = now.transform_point(centre) - before.transform_point(centre);
    // A difference of two rotations stretches two directions alike, and in space no third. The
    // stretch is the square root of half the sum of the squared entries.
    let stretch = (0.5 * turned.sum::<f64>()).sqrt();
    (moved.norm() + stretch * radius) * (1.0 + 1e-12)
}

impl<const D: usize> Track<D> {
    /// The contacts of both shapes at these poses, `world_from_body`, as
    /// [`manifold`](crate::manifold) finds them, with lasting ids: a contact near one of the
    /// last step, on either body, keeps its `id`.
    ///
    /// While the bodies stay within a quarter of the margin of the poses of a search, a step carries the
    /// contacts with the bodies and puts them back on the surfaces. Only the separation is searched. A part
    /// of the region that such a step does not see has a gap of more than three quarters of the margin. If
    /// the bodies no longer face each other at the place of a carried contact, the region is searched anew.
    ///
    /// Bodies that move by at most 1.5 margins in a step are searched up to a gap of 2.5 margins. The
    /// contacts then last while the bodies stay within 1.5 margins of the poses of that search.
    ///
    /// A contact that overlaps deeper than the margin keeps the normal with which it came, unless the
    /// contacts would then all be shallower than the separation is proven to be. If two bodies overlap by
    /// more than the margin when the track first sees them, the track searches once for a short translation
    /// that separates them. The contacts push as if the second body had come along it.
    ///
    /// # Errors
    ///
    /// As of [`manifold`](crate::manifold).
    #[inline(never)]
    pub fn manifold(
        &mut self,
        poses: [Pose<D>; 2],
        settings: &ManifoldSettings,
        limits: &Limits,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<Manifold<D>, QueryError> {
        settings.check()?;
        self.put_down();
        let goal = settings.goal(limits);
        let (separation, best) = self.search(poses, goal, limits, workspace)?;
        let [a, b] = &self.shapes;
        let pair = BodyPair::new(Placed::new(a, poses[0]), Placed::new(b, poses[1]))?;
        let separated = SeparatedPair { pair, best, separation };
        let mut found = if separation.lower > settings.margin {
            Manifold::apart(separation)
        } else {
            Kept::spanning(
                &mut self.memory.kept,
                separated,
                (settings, limits.budget),
                workspace,
            )
        };
        let by_gradients = found.contacts.clone();
        let TrackMemory { names, history, .. } = &mut self.memory;
        let separation = &mut found.separation;
        if history.is_first_deep(&found.contacts, settings.margin) {
            let rest = limits.less(separation.evaluations);
            let (shapes, settings) = (&self.shapes, (settings, &rest));
            let (outside, spent) = contacts_outside(shapes, poses, settings, workspace)?;
            separation.evaluations = separation.evaluations.saturating_add(spent);
            history.came_from(outside);
        }
        let (are_known, spent) = history.follow(&mut found.contacts, pair, poses, settings);
        separation.evaluations = separation.evaluations.saturating_add(spent);
        let deepest = |contacts: &[Contact<D>]| {
            contacts.iter().fold(f64::INFINITY, |least, contact| contact.gap.min(least))
        };
        let followed = deepest(&found.contacts);
        // The bodies may be proven to overlap deeper: nothing would push them apart that far.
        if followed > separation.upper && followed > deepest(&by_gradients) {
            found.contacts = by_gradients;
            names.name(&mut found.contacts, poses, settings.spacing);
            history.refute();
            return Ok(found);
        }
        // Named by the normals that they have now.
        names.name(&mut found.contacts, poses, settings.spacing);
        history.remember(&found.contacts, &are_known, poses);
        if let Some(slop) = settings.solver_slop {
            found.regroup(settings, slop);
        }
        Ok(found)
    }
}
