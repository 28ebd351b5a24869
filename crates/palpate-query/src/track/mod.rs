// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies followed from step to step.

use palpate_field::{Aabb, Point, Pose, Shape, Vector};

use crate::certified::{Certified, Goal, Limits, Stop};
use crate::contact::{Contact, NormalSource};
use crate::error::QueryError;
use crate::manifold::{Manifold, ManifoldSettings, SeparatedPair, Spanned, distance, followed};
use crate::pair::body_pair::BodyPair;
use crate::pair::distance_bound::DistanceBound;
use crate::pair::search::PairSearch;
use crate::pair::{Nearest, PairWorkspace};
use crate::query::{size, smallest};
use crate::sampler::Placed;

/// A search for several steps asks for bounds that are this share of the tolerance apart.
const FINER: f64 = 1.0 / 8.0;

/// A pair that moves by more than this share of the tolerance in a step is searched for that step
/// alone.
const FAR: f64 = 1.5;

/// A proof to the tolerance may last where a pair moves by no more than this share of it.
const LITTLE: f64 = 0.05;

/// After a proof that did not last for a step, so many searches are for their steps alone, and twice as
/// many each time.
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
    known: Option<Known<D>>,
    /// How many of the next searches are for their steps alone, and how many after the next proof that
    /// does not last.
    alone: u32,
    next_alone: u32,
    kept: Option<Kept<D>>,
    names: Names<D>,
    history: History<D>,
}

/// What the last search proved, and where the bodies were.
#[derive(Clone, Copy, Debug)]
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
        let (alone, next_alone) = (0, ALONE);
        let (known, kept, history) = (None, None, History::default());
        Self { shapes: [a, b], known, alone, next_alone, kept, names: Names::new(), history }
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

    /// Forgets all bounds: the next search begins anew.
    pub fn forget(&mut self) {
        (self.known, self.kept, self.history) = (None, None, History::default());
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
        let known = self.known.take().filter(|_| is_known);
        let (mut start, mut is_lasting) = (None, false);
        if let Some(known) = &known {
            let moved = displacement(&known.last, &now, &search.pair.root(0.0));
            let is_near = moved <= FAR * goal.tolerance;
            if is_near && (known.is_lasting || moved <= LITTLE * goal.tolerance) {
                let (stop, lower) = known.told(&mut search);
                if let Some(stop) = stop {
                    let best = search.best;
                    self.known = Some(Known { last: now, best, has_lasted: true, ..*known });
                    return Ok((search.answer(stop, lower), best));
                }
                start = Some((search.upper, search.best));
            }
            if known.is_lasting && !known.has_lasted {
                (self.alone, self.next_alone) = (self.next_alone, 2 * self.next_alone);
            } else if known.is_lasting {
                self.next_alone = ALONE;
            }
            is_lasting = is_near && self.alone == 0;
            self.alone = self.alone.saturating_sub(1);
            if is_lasting {
                // The proof of a search to the tolerance would not last.
                search.go_on(FINER, (0.5 * goal.tolerance / moved).min(1.0));
            }
        }
        let (answer, _) = search.run_from(start, workspace);
        let lower = 0.5 * answer.lower;
        let (best, has_lasted) = (search.best, false);
        let known = Known { lower, proven_at: now, last: now, best, is_lasting, has_lasted };
        self.known = (answer.lower > f64::NEG_INFINITY).then_some(known);
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

/// The cosine of how far the normal of a contact may be from that of the step before, 45°.
const SAME_SIDE: f64 = 0.7;

/// A contact that is less deep than this share of what its history says came out of another side.
const SHALLOW: f64 = 0.5;

/// A contact takes the side of the one of the step before that is nearest, up to this many spacings and
/// times its depth.
const NEAR: f64 = 2.0;

/// Contacts that have been followed since the bodies overlapped by no more than the margin.
#[derive(Clone, Debug)]
struct History<const D: usize> {
    known: Vec<KnownContact<D>>,
}

/// A contact of the last step, its points and normal in the coordinates of the first body and of the
/// second.
#[derive(Clone, Copy, Debug)]
struct KnownContact<const D: usize> {
    points: [Point<D>; 2],
    normals: [Vector<f64, D>; 2],
}

impl<const D: usize> Default for History<D> {
    fn default() -> Self {
        Self { known: Vec::new() }
    }
}

impl<const D: usize> History<D> {
    /// Gives deep contacts whose normals are not those with which they came in the normals and gaps of
    /// their history, and returns how often fields were evaluated. What was deep when it was seen first
    /// has no history until it comes out.
    fn follow(
        &mut self,
        contacts: &mut [Contact<D>],
        pair: BodyPair<'_, D>,
        poses: [Pose<D>; 2],
        settings: &ManifoldSettings,
    ) -> u32 {
        let mut pair = pair;
        pair.evaluations = 0;
        let from_world = poses.map(|pose| pose.inverse());
        let mut known = Vec::with_capacity(contacts.len());
        for contact in contacts {
            if contact.gap < -settings.margin {
                let Some((last, apart)) = self.nearest(contact, poses) else { continue };
                let normals = [0, 1].map(|i| poses[i].transform_vector(last.normals[i]));
                let points = [0, 1].map(|i| poses[i].transform_point(last.points[i]));
                // How deep the points are that touched, by how they have moved past each other.
                let carried = (points[1] - points[0]).dot(normals[0]);
                let is_other_side =
                    normals.iter().all(|normal| normal.dot(contact.normal) < SAME_SIDE);
                if is_other_side || contact.gap > SHALLOW * carried {
                    let far = NEAR * (settings.spacing - contact.gap.min(carried));
                    // Where no field gives a direction, the place says as little.
                    if apart > far && contact.normal_from != NormalSource::Assumed {
                        continue;
                    }
                    // The frame of the pair is the first body.
                    let frame = &from_world[0];
                    let found = followed(
                        &mut pair,
                        points.map(|p| frame.transform_point(p)),
                        normals.map(|normal| frame.transform_vector(normal)),
                        settings,
                    );
                    let Some(touch) = found else { continue };
                    let followed = touch.contact(&pair, settings.spacing);
                    *contact = followed.with_id(contact.id);
                }
            }
            known.push(KnownContact {
                points: [
                    from_world[0].transform_point(contact.point_a),
                    from_world[1].transform_point(contact.point_b),
                ],
                normals: from_world
                    .map(|from_world| from_world.transform_vector(contact.normal)),
            });
        }
        self.known = known;
        pair.evaluations
    }

    /// The contact of the last step that is nearest on either body, and how far it is [m].
    fn nearest(
        &self,
        contact: &Contact<D>,
        poses: [Pose<D>; 2],
    ) -> Option<(KnownContact<D>, f64)> {
        let apart = |known: &KnownContact<D>| {
            let [a, b] = [0, 1].map(|i| poses[i].transform_point(known.points[i]));
            (a - contact.point_a).norm().min((b - contact.point_b).norm())
        };
        let all = self.known.iter().map(|known| (*known, apart(known)));
        all.min_by(|one, other| one.1.total_cmp(&other.1))
    }
}

/// Contacts are kept while the bodies stay within this share of the margin of the poses at which their
/// region was searched.
const FARTHER: f64 = 0.25;

/// Of bodies that move on slowly, the region is searched up to a gap that is larger by this share of the
/// margin, too, and its contacts are kept while the bodies stay within as much of those poses.
const WIDER: f64 = 1.5;

/// A search that goes farther costs two: it is worth that if it lasts for so many more steps. After one
/// that does not, so many go no farther, and twice as many each time.
const WORTH: u32 = 2;
const MANIFOLD_ALONE: u32 = 4;

/// Contacts of an earlier step, in the first body's coordinates.
#[derive(Clone, Debug)]
struct Kept<const D: usize> {
    /// The second body in these coordinates when the region was searched, and in the last step.
    found_at: Pose<D>,
    last: Pose<D>,
    /// How far the bodies may move from there [m].
    reach: f64,
    settings: ManifoldSettings,
    budget: u32,
    spanned: Spanned<D>,
    /// For how many more steps these contacts were used.
    lasted: u32,
    /// How many of the next searches go no farther, and how many after the next one that does and is
    /// not worth it.
    alone: u32,
    next_alone: u32,
}

impl<const D: usize> Track<D> {
    /// The contacts of both shapes at these poses, `world_from_body`, as
    /// [`manifold`](crate::manifold) finds them, with lasting ids: a contact near one of the
    /// last step, on either body, keeps its `id`.
    ///
    /// While the bodies stay within a quarter of the margin of the poses at which the region of contact
    /// was searched, its points are carried with them and put back on the surfaces, and only the
    /// separation is searched. A contact that overlaps deeper than the margin keeps the normal with which
    /// it came, unless the contacts would then all be shallower than the separation is proven to be. Parts of the region that are new meanwhile have a gap of more than three
    /// quarters of the margin. Of bodies that move on by no more than 1.5 margins in a step, parts up to a
    /// gap of 2.5 margins are searched too, and all last while the bodies stay within 1.5 margins of those
    /// poses. Where the bodies face each other no longer at a point as they did, all is found anew.
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
        let goal = settings.goal(limits);
        let (separation, best) = self.search(poses, goal, limits, workspace)?;
        let [a, b] = &self.shapes;
        let pair = BodyPair::new(Placed::new(a, poses[0]), Placed::new(b, poses[1]))?;
        let separated = SeparatedPair { pair, best, separation };
        let mut found = if separation.lower > settings.margin {
            Manifold::apart(separation)
        } else {
            Kept::spanning(&mut self.kept, separated, (settings, limits.budget), workspace)
        };
        self.names.name(&mut found.contacts, poses, settings.spacing);
        let by_gradients = found.contacts.clone();
        found.separation.evaluations +=
            self.history.follow(&mut found.contacts, pair, poses, settings);
        let deepest = |contacts: &[Contact<D>]| {
            contacts.iter().fold(f64::INFINITY, |least, contact| contact.gap.min(least))
        };
        let followed = deepest(&found.contacts);
        if followed > found.separation.upper && followed > deepest(&by_gradients) {
            // The bodies are proven to overlap deeper: nothing would push them apart that far.
            (found.contacts, self.history) = (by_gradients, History::default());
        }
        Ok(found)
    }
}

impl<const D: usize> Kept<D> {
    /// The contacts of bodies that touch, from those of an earlier step if they last.
    fn spanning(
        last: &mut Option<Self>,
        mut separated: SeparatedPair<'_, D>,
        (settings, budget): (&ManifoldSettings, u32),
        workspace: &mut PairWorkspace<D>,
    ) -> Manifold<D> {
        let now = separated.pair.second_from_frame;
        let is_of_these = |kept: &Self| {
            kept.settings == *settings && !(kept.spanned.is_cut_off() && kept.budget < budget)
        };
        let kept = last.take().filter(is_of_these);
        let farther = 1.0 + WIDER;
        let root = separated.pair.root(farther * settings.margin);
        let (mut is_slow, mut alone, mut next_alone) = (false, 0, MANIFOLD_ALONE);
        if let Some(mut kept) = kept {
            if displacement(&kept.found_at, &now, &root) <= kept.reach
                && let Some(spanned) =
                    kept.spanned.moved(&mut separated, &kept.found_at, settings)
            {
                (kept.last, kept.lasted) = (now, kept.lasted.saturating_add(1));
                *last = Some(kept);
                return spanned.manifold(&separated, settings);
            }
            (alone, next_alone) = (kept.alone.saturating_sub(1), kept.next_alone);
            let went_farther = kept.reach > FARTHER * settings.margin;
            if went_farther && kept.lasted < WORTH {
                (alone, next_alone) = (next_alone, next_alone.saturating_mul(2));
            } else if went_farther {
                next_alone = MANIFOLD_ALONE;
            }
            is_slow =
                alone == 0 && displacement(&kept.last, &now, &root) <= WIDER * settings.margin;
        }
        let (spanned, share) = if is_slow {
            let spanned =
                Spanned::find_farther(&mut separated, settings, farther, budget, workspace);
            (spanned, WIDER)
        } else {
            (Spanned::find(&mut separated, settings, budget, workspace), FARTHER)
        };
        let found = spanned.manifold(&separated, settings);
        let reach = share * settings.margin;
        let settings = *settings;
        let (found_at, lasted) = (now, 0);
        *last = Some(Self {
            found_at,
            last: now,
            reach,
            settings,
            budget,
            spanned,
            lasted,
            alone,
            next_alone,
        });
        found
    }
}

/// A contact that moved farther than this many spacings on both bodies is a new one.
const SAME: f64 = 2.0;

/// The cosine of how far its normal may turn, 45°.
const TURNED: f64 = 0.7;

/// The contacts of the last step, and where they were on both bodies.
#[derive(Clone, Debug, Default)]
struct Names<const D: usize> {
    known: Vec<Named<D>>,
    next: u64,
}

#[derive(Clone, Copy, Debug)]
struct Named<const D: usize> {
    id: u64,
    points: [Point<D>; 2],
    normal: Vector<f64, D>,
}

impl<const D: usize> Names<D> {
    fn new() -> Self {
        Self { known: Vec::new(), next: 0 }
    }

    /// Gives each contact the id of the nearest contact of the last step, or a new id. Near
    /// means near on either body: a contact that slides along one may rest on the other.
    fn name(&mut self, contacts: &mut [Contact<D>], poses: [Pose<D>; 2], spacing: f64) {
        let from_world = poses.map(|pose| pose.inverse());
        let now: Vec<Named<D>> = contacts
            .iter()
            .map(|contact| Named {
                id: 0,
                points: [
                    from_world[0].transform_point(contact.point_a),
                    from_world[1].transform_point(contact.point_b),
                ],
                normal: from_world[0].transform_vector(contact.normal),
            })
            .collect();
        let mut pairs = Vec::new();
        for (i, new) in now.iter().enumerate() {
            for (k, old) in self.known.iter().enumerate() {
                let apart = distance(new.points[0], old.points[0])
                    .min(distance(new.points[1], old.points[1]));
                if apart < SAME * spacing && new.normal.dot(old.normal) > TURNED {
                    pairs.push((apart, i, k));
                }
            }
        }
        pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut names = vec![None; now.len()];
        let mut is_taken = vec![false; self.known.len()];
        for (_, i, k) in pairs {
            if names[i].is_none() && !is_taken[k] {
                (names[i], is_taken[k]) = (Some(self.known[k].id), true);
            }
        }
        self.known.clear();
        for ((contact, new), name) in contacts.iter_mut().zip(now).zip(names) {
            contact.id = name.unwrap_or(self.next);
            self.next += u64::from(name.is_none());
            self.known.push(Named { id: contact.id, ..new });
        }
    }
}
