// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Worlds of many bodies.
//!
//! Many bodies, and where any two of them touch.
//!
//! An R-tree of the bodies' boxes, grown by half the margin, finds the near pairs. A pair is
//! searched again only when one of its bodies has moved, from what its track has proven.
//! Pairs are independent, so that the number of threads changes no bit of the answer.

use std::collections::{BTreeMap, BTreeSet};

use palpate_field::{Aabb, Pose, Shape};
#[cfg(feature = "parallel")]
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::certified::{Limits, Verdict};
use crate::contact::Contact;
use crate::error::QueryError;
use crate::manifold::{Manifold, ManifoldSettings};
use crate::sampler::{Pool, check_pose};
use crate::sweep::{FirstTouch, Motion, Moving, SweepSettings, SweepWorkspace, corners, sweep};
use crate::track::Track;

/// Roundings of a placed box, relative to its largest coordinate.
const ROUNDINGS: f64 = 16.0;

/// A body of a world, as [`World::add`] names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyId(usize);

impl BodyId {
    /// How many bodies were added before it.
    #[must_use]
    pub fn index(self) -> usize {
        self.0
    }
}

/// How a world searches each pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WorldSettings {
    /// The contacts of each pair: margin, spacing and largest number.
    pub manifold: ManifoldSettings,
    /// The tolerance and the budget of each pair.
    pub limits: Limits,
}

impl WorldSettings {
    /// These settings for each pair.
    #[must_use]
    pub fn new(manifold: ManifoldSettings, limits: Limits) -> Self {
        Self { manifold, limits }
    }

    /// For bodies of about `size` [m].
    #[must_use]
    pub fn of_size(size: f64) -> Self {
        let manifold = ManifoldSettings::of_size(size);
        let limits = Limits::new(manifold.usual_tolerance());
        Self { manifold, limits }
    }
}

/// Two bodies near each other, and their contacts.
#[derive(Clone, Debug)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Neighbours<const D: usize> {
    /// The bodies; the first was added before the second.
    pub bodies: [BodyId; 2],
    /// Their contacts; `None` if neither is bounded.
    pub manifold: Option<Manifold<D>>,
}

impl<const D: usize> Neighbours<D> {
    /// The bounds of the separation [m]; infinite if neither body is bounded.
    #[must_use]
    pub fn bounds(&self) -> [f64; 2] {
        let separation = self.manifold.as_ref().map(|manifold| &manifold.separation);
        separation.map_or([f64::NEG_INFINITY, f64::INFINITY], |separation| {
            [separation.lower, separation.upper]
        })
    }

    /// Whether they touch, up to `margin` [m]: what the bounds prove.
    #[must_use]
    pub fn verdict(&self, margin: f64) -> Verdict {
        let of = |manifold: &Manifold<D>| manifold.verdict(margin);
        self.manifold.as_ref().map_or(Verdict::Undecided, of)
    }

    /// The contacts.
    #[must_use]
    pub fn contacts(&self) -> &[Contact<D>] {
        self.manifold.as_ref().map_or(&[], |manifold| &manifold.contacts)
    }
}

/// Bodies and which of them touch.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::{Cuboid, HalfSpace}};
/// use palpate_query::{World, WorldSettings};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut world = World::new(WorldSettings::of_size(1.0))?;
/// let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
/// let cube = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 1.0]))?);
/// let floor = world.add(floor, Pose::identity())?;
/// let cube = world.add(cube, Pose::translation(Vector([0.0, 0.4995, 0.0])))?;
/// let touching = world.step();
/// assert_eq!(touching.len(), 1);
/// assert_eq!(touching[0].bodies, [floor, cube]);
/// for contact in touching[0].contacts() {
///     assert!((contact.gap + 0.0005).abs() < 1e-6);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct World<const D: usize> {
    settings: WorldSettings,
    /// Empty places are those of removed bodies.
    bodies: Vec<Option<Body<D>>>,
    ignored: BTreeSet<[usize; 2]>,
    pairs: BTreeMap<[usize; 2], Pair<D>>,
    pool: Pool<D>,
}

#[derive(Clone, Debug)]
struct Body<const D: usize> {
    shape: Shape<D>,
    pose: Pose<D>,
    groups: u32,
    mask: u32,
    /// A box around the body, grown by half the margin; `None` if the body is unbounded.
    aabb: Option<Aabb<D>>,
    /// Whether the body has moved since the last step.
    has_moved: bool,
}

/// Two bodies near each other, and the last answer.
#[derive(Debug)]
struct Pair<const D: usize> {
    track: Track<D>,
    found: Neighbours<D>,
    /// Whether the bodies are near in this step, and whether they must be searched again.
    is_near: bool,
    is_stale: bool,
}

impl<const D: usize> World<D> {
    /// A world without bodies.
    ///
    /// # Errors
    ///
    /// If a setting is not finite or beyond 1e15 m, the margin or the tolerance negative,
    /// or the spacing not positive.
    #[inline(never)]
    pub fn new(settings: WorldSettings) -> Result<Self, QueryError> {
        settings.manifold.check()?;
        settings.limits.check()?;
        Ok(Self {
            settings,
            bodies: Vec::new(),
            ignored: BTreeSet::new(),
            pairs: BTreeMap::new(),
            pool: Pool::new(),
        })
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &WorldSettings {
        &self.settings
    }

    /// Adds a body at `world_from_body`, in group 1 and asked with all groups.
    ///
    /// # Errors
    ///
    /// If the pose is not finite.
    #[inline(never)]
    pub fn add(
        &mut self,
        shape: Shape<D>,
        world_from_body: Pose<D>,
    ) -> Result<BodyId, QueryError> {
        let mut body = Body {
            shape,
            pose: world_from_body,
            groups: 1,
            mask: u32::MAX,
            aabb: None,
            has_moved: true,
        };
        check_pose(self.bodies.len(), &world_from_body)?;
        body.place(world_from_body, self.settings.manifold.margin);
        self.bodies.push(Some(body));
        Ok(BodyId(self.bodies.len() - 1))
    }

    /// The bodies that are there, in the order in which they were added.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> {
        let bodies = self.bodies.iter().enumerate();
        bodies.filter(|(_, body)| body.is_some()).map(|(i, _)| BodyId(i))
    }

    /// Removes a body; its id is not used again.
    ///
    /// # Errors
    ///
    /// If there is no such body.
    #[inline(never)]
    pub fn remove(&mut self, body: BodyId) -> Result<(), QueryError> {
        self.body(body)?;
        self.bodies[body.0] = None;
        self.pairs.retain(|pair, _| !pair.contains(&body.0));
        Ok(())
    }

    /// Where a body is.
    ///
    /// # Errors
    ///
    /// If there is no such body.
    pub fn pose(&self, body: BodyId) -> Result<Pose<D>, QueryError> {
        let found = self.bodies.get(body.0).and_then(Option::as_ref);
        found.map(|body| body.pose).ok_or(QueryError::NoBody { body: body.0 })
    }

    /// Moves bodies to new poses: all of them, or none if one is refused.
    ///
    /// # Errors
    ///
    /// If a pose is not finite or beyond 1e15 m, or there is no such body.
    #[inline(never)]
    pub fn set_poses(&mut self, poses: &[(BodyId, Pose<D>)]) -> Result<(), QueryError> {
        for (body, pose) in poses {
            self.body(*body)?;
            check_pose(body.0, pose)?;
        }
        let margin = self.settings.manifold.margin;
        for (body, pose) in poses {
            self.body(*body)?.place(*pose, margin);
        }
        Ok(())
    }

    /// Puts a body into `groups`, one bit each, and lets it touch only groups in `mask`. A
    /// pair is searched if each body is in a group of the other's mask.
    ///
    /// # Errors
    ///
    /// If there is no such body.
    pub fn set_groups(
        &mut self,
        body: BodyId,
        groups: u32,
        mask: u32,
    ) -> Result<(), QueryError> {
        let body = self.body(body)?;
        (body.groups, body.mask, body.has_moved) = (groups, mask, true);
        Ok(())
    }

    /// Never searches two bodies again, such as those of a joint.
    ///
    /// # Errors
    ///
    /// If there is no such body.
    pub fn ignore(&mut self, one: BodyId, other: BodyId) -> Result<(), QueryError> {
        self.body(one)?;
        self.body(other)?;
        let pair = [one.0.min(other.0), one.0.max(other.0)];
        self.pairs.remove(&pair);
        self.ignored.insert(pair);
        Ok(())
    }

    /// Finds the contacts at the current poses: of all pairs that are not proven to be farther
    /// apart than the margin, in the order of their bodies.
    ///
    /// With the feature `parallel` rayon's threads share the pairs; the bits do not depend on
    /// how many there are.
    #[inline(never)]
    pub fn step(&mut self) -> Vec<&Neighbours<D>> {
        self.find_near();
        let (bodies, settings, pool) = (&self.bodies, &self.settings, &self.pool);
        let ask = |([one, other], pair): (&[usize; 2], &mut Pair<D>)| {
            if let (Some(a), Some(b)) = (&bodies[*one], &bodies[*other]) {
                pool.with(|workspace| {
                    let poses = [a.pose, b.pose];
                    let WorldSettings { manifold, limits } = settings;
                    let asked = pair.track.manifold(poses, manifold, limits, workspace);
                    pair.found.manifold = asked.ok();
                });
            }
            pair.is_stale = false;
        };
        #[cfg(feature = "parallel")]
        self.pairs.par_iter_mut().filter(|(_, pair)| pair.is_stale).for_each(ask);
        #[cfg(not(feature = "parallel"))]
        self.pairs.iter_mut().filter(|(_, pair)| pair.is_stale).for_each(ask);
        for body in self.bodies.iter_mut().flatten() {
            body.has_moved = false;
        }
        let margin = self.settings.manifold.margin;
        let found = self.pairs.values().map(|pair| &pair.found);
        found.filter(|found| found.verdict(margin) != Verdict::Apart).collect()
    }

    /// A proven lower bound of the separation of two bodies, as of the last [`step`](Self::step)
    /// [m]: that of their search, or the gap of their boxes if they were not searched; minus
    /// infinity if that is unknown too. A pair that `step` left out although it was not to be
    /// ignored has a bound above the margin.
    ///
    /// # Errors
    ///
    /// If there is no such body.
    #[inline(never)]
    pub fn lower_bound(&self, one: BodyId, other: BodyId) -> Result<f64, QueryError> {
        let found = |body: BodyId| {
            let body_at = self.bodies.get(body.0).and_then(Option::as_ref);
            body_at.ok_or(QueryError::NoBody { body: body.0 })
        };
        let boxes = [found(one)?.aabb, found(other)?.aabb];
        let pair = [one.0.min(other.0), one.0.max(other.0)];
        if let Some(pair) = self.pairs.get(&pair) {
            return Ok(pair.found.bounds()[0]);
        }
        let [Some(a), Some(b)] = boxes else { return Ok(f64::NEG_INFINITY) };
        // The boxes are grown by half the margin each, and by more than rounding.
        let gaps = (0..D).map(|k| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]));
        let gap = gaps.fold(f64::NEG_INFINITY, f64::max);
        Ok(if gap > 0.0 { gap + self.settings.manifold.margin } else { f64::NEG_INFINITY })
    }

    /// Updates which pairs are near, and which of them must be searched again.
    fn find_near(&mut self) {
        for pair in self.pairs.values_mut() {
            pair.is_near = false;
        }
        for [one, other] in pairs_near(&self.bodies) {
            let (Some(a), Some(b)) = (&self.bodies[one], &self.bodies[other]) else { continue };
            if !self.is_asked([one, other], [a, b]) {
                continue;
            }
            let pair = self.pairs.entry([one, other]).or_insert_with(|| Pair {
                track: Track::new(a.shape.clone(), b.shape.clone()),
                found: Neighbours { bodies: [BodyId(one), BodyId(other)], manifold: None },
                is_near: true,
                is_stale: true,
            });
            pair.is_near = true;
            pair.is_stale |= a.has_moved || b.has_moved;
        }
        // The R-tree is not asked about bodies that rest: their pairs stay near.
        let bodies = &self.bodies;
        let is_still = |i: usize| bodies[i].as_ref().is_some_and(|body| !body.has_moved);
        self.pairs
            .retain(|[one, other], pair| pair.is_near || is_still(*one) && is_still(*other));
    }

    /// Whether two bodies are to be asked about.
    fn is_asked(&self, pair: [usize; 2], [a, b]: [&Body<D>; 2]) -> bool {
        let are_in_groups = a.groups & b.mask != 0 && b.groups & a.mask != 0;
        are_in_groups && !self.ignored.contains(&pair)
    }

    fn body(&mut self, body: BodyId) -> Result<&mut Body<D>, QueryError> {
        let found = self.bodies.get_mut(body.0).and_then(Option::as_mut);
        found.ok_or(QueryError::NoBody { body: body.0 })
    }
}

impl<const D: usize> Body<D> {
    /// Moves the body to a pose that was checked.
    fn place(&mut self, pose: Pose<D>, margin: f64) {
        (self.pose, self.has_moved) = (pose, true);
        let bounds = self.shape.promise().bounds;
        self.aabb = bounds.map(|bounds| {
            let placed = bounds.aabb.placed(&pose);
            placed.grown(0.5 * margin + ROUNDINGS * f64::EPSILON * placed.radius_about_origin())
        });
    }
}

/// Two bodies of a world that touch, or of which it is not known whether they do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyImpact<const D: usize> {
    /// The bodies; the first was added before the second.
    pub bodies: [BodyId; 2],
    /// When they touch.
    pub touch: FirstTouch<D>,
}

impl<const D: usize> World<D> {
    /// When bodies touch first, while those of `motions` move over the time from 0 to 1 and the
    /// others stay: all pairs that are not proven to be apart all the time, the earliest first.
    /// Before the first one's [`lower`](FirstTouch::lower), no bodies touch. The world stays as it
    /// is; groups and pairs to be ignored count.
    ///
    /// ```
    /// use palpate_field::{Pose, Screw, Shape};
    /// use palpate_query::{SweepSettings, World, WorldSettings};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let mut world = World::new(WorldSettings::of_size(1.0))?;
    /// let at = |y: f64| Pose::translation([0.0, y, 0.0]);
    /// let floor = world.add(Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0)?, at(0.0))?;
    /// let shelf = world.add(Shape::cuboid([1.0, 0.1, 1.0])?, at(2.0))?;
    /// let ball = world.add(Shape::ball(0.5)?, at(4.0))?;
    /// let falls = Screw::new(at(4.0), at(0.0), 0)?;
    /// let impacts = world.first_impact(&[(ball, falls.into())], &SweepSettings::of_size(1.0))?;
    /// assert_eq!(impacts.iter().map(|it| it.bodies).collect::<Vec<_>>(), [[shelf, ball], [floor, ball]]);
    /// // 4 − 0.5 − 2.05 m of 4 m.
    /// assert!((impacts[0].touch.upper - 0.3625).abs() < 1e-4);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If there is no such body, a pose is NaN or out of range, or a setting is not positive.
    #[inline(never)]
    pub fn first_impact(
        &self,
        motions: &[(BodyId, Motion<D>)],
        settings: &SweepSettings,
    ) -> Result<Vec<BodyImpact<D>>, QueryError> {
        settings.check()?;
        let mut ways: Vec<Option<(Body<D>, Motion<D>)>> = self
            .bodies
            .iter()
            .map(|body| body.as_ref().map(|body| (body.clone(), body.pose.into())))
            .collect();
        for way in ways.iter_mut().flatten() {
            way.0.has_moved = false;
        }
        for (id, motion) in motions {
            motion.check(id.0)?;
            let way = ways.get_mut(id.0).and_then(Option::as_mut);
            let (body, way) = way.ok_or(QueryError::NoBody { body: id.0 })?;
            *way = *motion;
            body.has_moved = true;
            body.aabb = body.way_box(motion);
        }
        let bodies: Vec<_> =
            ways.iter().map(|way| way.as_ref().map(|(body, _)| body.clone())).collect();
        let mut workspace = SweepWorkspace::new();
        let mut impacts = Vec::new();
        for [one, other] in pairs_near(&bodies) {
            let (Some((a, from)), Some((b, to))) = (&ways[one], &ways[other]) else { continue };
            if !self.is_asked([one, other], [a, b]) {
                continue;
            }
            let moving = [Moving::new(&a.shape, *from), Moving::new(&b.shape, *to)];
            let touch = match sweep(moving[0], moving[1], settings, &mut workspace) {
                // Of bodies without bounds nothing is known, as in a step.
                Err(QueryError::Unbounded) => FirstTouch::unknown(),
                found => found?,
            };
            if touch.touches() != Some(false) {
                impacts.push(BodyImpact { bodies: [BodyId(one), BodyId(other)], touch });
            }
        }
        impacts.sort_by(|a, b| {
            let time = |it: &BodyImpact<D>| it.touch.lower;
            time(a).total_cmp(&time(b)).then(a.bodies.cmp(&b.bodies))
        });
        Ok(impacts)
    }
}

impl<const D: usize> Body<D> {
    /// A box around all of a motion: no point is farther from its place in the middle of it than half
    /// of its way.
    fn way_box(&self, motion: &Motion<D>) -> Option<Aabb<D>> {
        let bounds = self.shape.promise().bounds?;
        let speed = corners(&bounds.aabb)
            .map(|corner| motion.velocity(corner).norm())
            .fold(0.0, f64::max);
        let middle = bounds.aabb.placed(&motion.pose(0.5));
        let rounding = ROUNDINGS * f64::EPSILON * middle.radius_about_origin();
        Some(middle.grown(0.5 * speed * (1.0 + 1e-9) + rounding))
    }
}

/// A body's box and its number.
type Boxed<const D: usize> = GeomWithData<Rectangle<[f64; D]>, usize>;

/// The pairs of bodies of which one has moved and whose boxes meet, each with the lower
/// number first. A body without bounds is near all.
fn pairs_near<const D: usize>(bodies: &[Option<Body<D>>]) -> Vec<[usize; 2]> {
    let present = || bodies.iter().enumerate().filter_map(|(i, b)| Some((i, b.as_ref()?)));
    let boxed =
        present().filter_map(|(i, body)| Some(GeomWithData::new(rectangle(&body.aabb?), i)));
    let tree: RTree<Boxed<D>> = RTree::bulk_load(boxed.collect());
    let mut pairs = Vec::new();
    for (i, body) in present().filter(|(_, body)| body.has_moved) {
        let mut meet = |k: usize| {
            // Two that have both moved meet twice: once is enough.
            let is_first = bodies[k].as_ref().is_some_and(|other| !other.has_moved || i < k);
            if k != i && is_first {
                pairs.push([i.min(k), i.max(k)]);
            }
        };
        match &body.aabb {
            Some(aabb) => {
                let place = AABB::from_corners(aabb.min.0, aabb.max.0);
                let others = tree.locate_in_envelope_intersecting(place);
                others.for_each(|other| meet(other.data));
                present().filter(|(_, other)| other.aabb.is_none()).for_each(|(k, _)| meet(k));
            }
            None => present().for_each(|(k, _)| meet(k)),
        }
    }
    pairs
}

fn rectangle<const D: usize>(aabb: &Aabb<D>) -> Rectangle<[f64; D]> {
    Rectangle::from_corners(aabb.min.0, aabb.max.0)
}
