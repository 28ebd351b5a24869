// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sweeps of two bodies.
//!
//! Conservative advancement (Mirtich 1996): bodies that are apart by a distance stay apart until their
//! motion has closed it.
//!
//! It goes on where boxes of space and time end early: bodies that pass at a small distance over large
//! parts of their surfaces need more boxes than memory holds, but few steps of time.

use palpate_field::{Aabb, Point, Pose, Vector};
use palpate_mesh::{FAN, Mesh};

use super::axes::Turned;
use super::boxes::{BoxFrontier, BoxMemory, BoxSweep, SpaceCell, frontier};
use super::first_touch::{FREE, FirstTouch, FreeBox, Start, SweepSettings};
use super::motion::{Moving, Path, Place, Stay, WayBounds, bend, corners, exit};
use crate::certified::{Limits, Stop};
use crate::contact::NormalSource;
use crate::element_search::{Element, parts_of_one};
use crate::engine::{self, Bounded};
use crate::error::QueryError;
use crate::manifold::deepest;
use crate::pair::distance_bound::DistanceBound;
use crate::pair::{PairWorkspace, separation};

/// After so many evaluations without a time, a touch at the start is asked for.
const SOON: u32 = 1 << 14;

/// Advancement, the samples, and each search at the contact may use a share of the budget after the search:
/// one of so many.
const AFTERWARDS: u32 = 4;

/// After a search that ended early a touch is looked for at so many times.
const SAMPLES: u32 = 32;

/// The separation at a touch is searched to this share of the gap.
const SHARE: f64 = 0.25;

/// When two bodies that move touch first. Before `lower` they are proven to be apart by more than half of
/// `settings.gap`; at `upper` their [`separation`] is at most the gap.
///
/// Each box of space advances through time on its own, by models of both fields over it and over a
/// span of time. So no motion is too fast and no body too thin. What passes at a small distance takes
/// many boxes: where their memory is full or the budget spent, the bodies go on by conservative advancement.
/// If that ends early too, `lower` says until when the bodies are proven apart, and `upper` is the earliest
/// touch that samples of the time find.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape};
/// use palpate_query::{Moving, SweepSettings, SweepWorkspace, sweep};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // 10 m in one step, at a plate of 0.1 mm.
/// let plate = Shape::<3>::cuboid([1.0, 1e-4, 1.0])?;
/// let cube = Shape::<3>::cuboid([0.1, 0.1, 0.1])?;
/// let [from, to] = [5.0, -5.0].map(|y| Pose::translation([0.0, y, 0.0]));
/// let falling = Moving::new(&cube, Screw::new(from, to, 0)?);
/// let settings = SweepSettings::of_size(0.1);
/// let touch = sweep(&plate, falling, &settings, &mut SweepWorkspace::new())?;
/// assert_eq!(touch.touches(), Some(true));
/// let truth = 0.494_995; // 4.949 95 m of 10 m
/// assert!(touch.lower <= truth && touch.upper >= truth - 1e-8 && touch.upper <= truth + 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded, a pose is NaN or out of range, or the gap or the tolerance of times is NaN, not
/// positive or above 1e15.
pub fn sweep<'a, const D: usize>(
    a: impl Into<Moving<'a, D>>,
    b: impl Into<Moving<'a, D>>,
    settings: &SweepSettings,
    workspace: &mut SweepWorkspace<D>,
) -> Result<FirstTouch<D>, QueryError> {
    Ok(swept([a.into(), b.into()], settings, workspace, None)?.0)
}

/// The first touch, and the body in whose coordinates the boxes are, which are added to `boxes`.
#[inline(never)]
pub(crate) fn swept<const D: usize>(
    bodies: [Moving<'_, D>; 2],
    settings: &SweepSettings,
    workspace: &mut SweepWorkspace<D>,
    boxes: Option<&mut Vec<FreeBox<D>>>,
) -> Result<(FirstTouch<D>, usize), QueryError> {
    let SweepWorkspace { frontier, memory, pair } = workspace;
    // The first is that whose coordinates are searched: the smaller one.
    let size = |body: &Moving<'_, D>| {
        body.shape.promise().bounds.map_or(f64::INFINITY, |b| b.aabb.half_extents().norm())
    };
    let is_swapped = size(&bodies[1]) < size(&bodies[0]);
    let [a, b] = bodies;
    let [still, moving] = if is_swapped { [b, a] } else { [a, b] };
    if still.shape.promise().bounds.is_none() {
        return Err(QueryError::Unbounded);
    }
    settings.check()?;
    bodies.iter().enumerate().try_for_each(|(i, body)| body.motion.check(i))?;
    // Where both fields are at most half of the gap, the separation is at most the gap.
    let touch = 0.5 * settings.gap;
    let turned;
    let region = Region::of([still, moving], touch)?;
    memory.begin(&region.root, frontier);
    let keeps_boxes = boxes.is_some();
    let mut search = BoxSweep {
        bodies: region.bodies,
        bounds: region.bounds,
        path: region.path,
        way: region.way,
        level: FREE * touch + region.slack,
        touch,
        slack: region.slack,
        size: region.root.half_extents().norm(),
        settings,
        budget: settings.budget.min(SOON),
        memory,
        evaluations: 0,
        horizon: None,
        upper: f64::INFINITY,
        place: Vector::ZERO,
        dropped: f64::INFINITY,
        ruled_out: boxes,
    };
    let mut end = engine::search(&mut search, frontier);
    if end.stop().is_early() {
        let may_touch_now =
            search.upper == f64::INFINITY && frontier.lower(search.dropped) <= 0.0;
        if may_touch_now && touches_at(0.0, bodies, settings, pair, &mut search.evaluations)? {
            // Places at which bodies lie on each other are as small as the gap, and many.
            search.upper = 0.0;
        } else {
            search.budget = settings.budget;
            // Boxes that are kept are in the body's own coordinates.
            if !keeps_boxes {
                search.evaluations += Turned::<D>::EVALUATIONS;
                turned = Turned::of(&still, &region.root);
                if let Some(turned) = &turned
                    && let Some(body) = turned.moving(&still)
                {
                    let region = Region::of([body, moving], touch)?;
                    search.memory.begin(&region.root, frontier);
                    search.place = turned.point(search.place);
                    search.go_on_in(region);
                }
            }
            end = engine::search(&mut search, frontier);
        }
    }
    let way = search.way;
    let mut lower = frontier.lower(search.dropped).min(search.upper).min(1.0);
    if search.upper < f64::INFINITY {
        search.refine(lower);
    }
    let (mut upper, mut evaluations) = (search.upper, search.evaluations);
    let mut stop = end.stop();
    if stop.is_early() && upper > lower {
        let budget =
            settings.budget.saturating_sub(evaluations).max(settings.budget / AFTERWARDS);
        let advancement = Advancement { bodies, way, size: search.size, settings, budget };
        let advanced = advancement.run(lower, pair)?;
        evaluations = evaluations.saturating_add(advanced.evaluations);
        lower = advanced.lower.min(upper);
        upper = upper.min(advanced.upper);
        if let Some(decided) = settings.decided(lower, upper) {
            stop = decided;
        } else if upper == f64::INFINITY {
            upper = sampled_touch(lower, bodies, settings, pair, &mut evaluations)?;
        }
    }
    if let Some(boxes) = search.ruled_out {
        boxes.extend(frontier.queue.cells().map(|space: SpaceCell<D>| space.free()));
        boxes.extend(frontier.pending.iter().map(|space| space.free()));
    }
    let stop = if upper == 0.0 { Stop::Converged } else { stop };
    let upper = if stop == Stop::SignKnown { 1.0 } else { upper };
    let mut found = FirstTouch { lower, upper, contact: None, start: None, stop, evaluations };
    if stop != Stop::SignKnown && upper.is_finite() {
        touch_at(bodies, settings, pair, &mut found)?;
    }
    Ok((found, usize::from(is_swapped)))
}

/// What is searched: a body that stays, in its coordinates, and one that goes by.
pub(super) struct Region<'a, const D: usize> {
    pub(super) bodies: [Moving<'a, D>; 2],
    pub(super) bounds: [DistanceBound<'a, D>; 2],
    pub(super) path: Path<D>,
    pub(super) way: WayBounds,
    /// The rounding of values and places [m].
    pub(super) slack: f64,
    pub(super) root: Aabb<D>,
}

impl<'a, const D: usize> Region<'a, D> {
    /// All places that are at most so far from the body that stays [m].
    fn of([still, moving]: [Moving<'a, D>; 2], touch: f64) -> Result<Self, QueryError> {
        let bounds = still.shape.promise().bounds.ok_or(QueryError::Unbounded)?;
        let path = Path { field: moving.motion, body: still.motion };
        let root = bounds.aabb.grown(touch);
        let way = path.bounds(&corners(&root).collect::<Vec<_>>());
        let bounds =
            [still, moving].map(|body| DistanceBound::new(body.shape, Pose::identity()));
        let slack = bounds[0].slack(root.radius_about_origin()).max(bounds[1].slack(way.far))
            + way.rounding;
        Ok(Self { bodies: [still, moving], bounds, path, way, slack, root })
    }
}

/// Whether the separation at a time is found to be at most the gap.
fn touches_at<const D: usize>(
    time: f64,
    bodies: [Moving<'_, D>; 2],
    settings: &SweepSettings,
    workspace: &mut PairWorkspace<D>,
    evaluations: &mut u32,
) -> Result<bool, QueryError> {
    let [a, b] = bodies.map(|body| body.at(time));
    let limits =
        Limits::new(SHARE * settings.gap).with_budget(settings.budget / (AFTERWARDS * SAMPLES));
    let near = separation(a, b, &limits, workspace)?;
    *evaluations = evaluations.saturating_add(near.evaluations);
    Ok(near.upper <= settings.gap)
}

/// A time after `lower` at which the bodies touch, by samples: what a search that ended early did not
/// come to. Infinite if they touch at none of them.
fn sampled_touch<const D: usize>(
    lower: f64,
    bodies: [Moving<'_, D>; 2],
    settings: &SweepSettings,
    workspace: &mut PairWorkspace<D>,
    evaluations: &mut u32,
) -> Result<f64, QueryError> {
    let mut touches = |time| touches_at(time, bodies, settings, workspace, evaluations);
    let mut before = lower;
    for sample in 1..=SAMPLES {
        let time = lower + (1.0 - lower) * f64::from(sample) / f64::from(SAMPLES);
        if touches(time)? {
            let mut upper = time;
            while upper - before > settings.time_tolerance {
                let middle = 0.5 * (before + upper);
                if middle <= before || middle >= upper {
                    break;
                }
                if touches(middle)? {
                    upper = middle;
                } else {
                    before = middle;
                }
            }
            return Ok(upper);
        }
        before = time;
    }
    Ok(f64::INFINITY)
}

/// Adds the contact at the time of a touch.
fn touch_at<const D: usize>(
    bodies: [Moving<'_, D>; 2],
    settings: &SweepSettings,
    workspace: &mut PairWorkspace<D>,
    found: &mut FirstTouch<D>,
) -> Result<(), QueryError> {
    let limits = Limits::new(SHARE * settings.gap).with_budget(settings.budget / AFTERWARDS);
    let mut near = |time: f64| -> Result<_, QueryError> {
        let [a, b] = bodies.map(|body| body.at(time));
        let near = separation(a, b, &limits, workspace)?;
        found.evaluations = found.evaluations.saturating_add(near.evaluations);
        Ok(([a, b], near))
    };
    let mut time = found.upper;
    let ([mut a, mut b], mut best) = near(time)?;
    if found.lower == 0.0 && time > 0.0 {
        // A touch soon after the start may be one at the start.
        let ([first_a, first_b], first) = near(0.0)?;
        if first.upper <= settings.gap {
            (time, a, b, best) = (0.0, first_a, first_b, first);
            found.stop = Stop::Converged;
        }
    }
    found.upper = time;
    let (contact, evaluations) = deepest(a, b, &best.best, settings.gap)?;
    found.evaluations = found.evaluations.saturating_add(evaluations);
    found.contact = Some(contact);
    if time == 0.0 && contact.normal_from != NormalSource::Assumed {
        let [of_a, of_b] = bodies.map(|body| body.velocity(0.0, best.best.point));
        found.start = Some(Start::of(of_b - of_a, contact.normal));
    }
    Ok(())
}

/// Memory of sweeps of bodies, kept from one to the next.
#[derive(Debug)]
pub struct SweepWorkspace<const D: usize> {
    frontier: BoxFrontier<D>,
    memory: BoxMemory<D>,
    pair: PairWorkspace<D>,
}

impl<const D: usize> SweepWorkspace<D> {
    /// Room for sweeps in `D` dimensions.
    #[must_use]
    #[inline(never)]
    pub fn new() -> Self {
        Self { frontier: frontier(), memory: BoxMemory::new(), pair: PairWorkspace::new() }
    }
}

impl<const D: usize> Default for SweepWorkspace<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// What a part is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// An element of the mesh, or the only one.
    Element(u32),
    /// The ball of a node of the mesh's tree: its level and index.
    Node(u32, u32),
}

/// How parts of an element are alike: all are similar to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form<const N: usize> {
    /// The weights of the vertices in the centre.
    pub(super) weights: [f64; N],
    /// The number of halves.
    parts: usize,
    /// The vertex across from the longest edge; the first of a segment.
    pub(super) apex: usize,
}

/// An element, a part of one, or the ball of a node, and the time until which it is free.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<const N: usize, const D: usize> {
    /// In the coordinates of the body; all vertices in the centre of a ball.
    pub(super) element: Element<N, D>,
    pub(super) form: Form<N>,
    pub(super) of: Of,
    /// The radius of a ball; zero of an element [m].
    pub(super) radius: f64,
    /// Before this time it is free.
    pub(super) free: f64,
    /// How far samples are lifted [m].
    pub(super) height: f64,
    /// How often the element was halved.
    pub(super) level: u32,
    /// Whether it goes on undivided.
    pub(super) is_whole: bool,
}

impl<const N: usize, const D: usize> Bounded for Part<N, D> {
    #[inline]
    fn lower(&self) -> f64 {
        self.free
    }
}

impl<const N: usize, const D: usize> Part<N, D> {
    /// An element of which nothing is known before a time.
    pub(super) fn whole(element: &Element<N, D>, name: u32, free: f64) -> Self {
        let weights = element.centre_weights();
        let flat = element.flattened(&weights);
        let parts = if flat.is_some() { 2 } else { parts_of_one::<N>() };
        let element = flat.unwrap_or(*element);
        let weights = element.centre_weights();
        let height = element.farthest(element.at(&weights));
        let form = Form { weights, parts, apex: apex(&element) };
        let of = Of::Element(name);
        Self { element, form, of, radius: 0.0, free, height, level: 0, is_whole: true }
    }

    /// The root of a mesh's tree, around all elements.
    pub(super) fn root(mesh: &Mesh<N, D>) -> Self {
        let aabb = mesh.bounds();
        let level = mesh.tree().levels().len() as u32;
        Self::ball(aabb.centre(), aabb.half_extents().norm(), Of::Node(level, 0), 0.0)
    }

    fn ball(centre: Point<D>, radius: f64, of: Of, free: f64) -> Self {
        let element = Element { vertices: [centre; N] };
        let form = Form { weights: [1.0 / N as f64; N], parts: 1, apex: 0 };
        // A node that is evaluated anew would give the same step.
        Self { element, form, of, radius, free, height: radius, level: 0, is_whole: true }
    }

    /// Whether it is an element of area or length, or a part of one.
    pub(super) fn is_of_element(&self) -> bool {
        matches!(self.of, Of::Element(_))
    }

    /// Appends its parts; of a node those that `mesh` has, of which the lowest are elements.
    pub(super) fn divide(&self, mesh: Option<&Mesh<N, D>>, parts: &mut Vec<Self>) {
        match (self.of, mesh) {
            (Of::Node(0, node), Some(mesh)) => {
                let name = mesh.tree().order()[node as usize];
                let element = Element { vertices: mesh.corners(name as usize) };
                parts.push(Self::whole(&element, name, self.free));
            }
            (Of::Node(above, node), Some(mesh)) => {
                let level = above - 1;
                let balls = &mesh.tree().levels()[level as usize];
                let first = node as usize * FAN;
                let radii = &balls.radii()[first..][..FAN];
                for (i, (centre, radius)) in
                    balls.children(node as usize).into_iter().zip(radii).enumerate()
                {
                    // Padding of a group has a negative radius.
                    if *radius >= 0.0 {
                        let of = Of::Node(level, (first + i) as u32);
                        parts.push(Self::ball(centre, *radius, of, self.free));
                    }
                }
            }
            _ => {
                let level = self.level + 1;
                let halves = self.element.halves();
                let halves = halves[..self.form.parts].iter();
                parts.extend(halves.map(|&element| Self { element, level, ..*self }));
            }
        }
    }

    /// The part on its way at a place.
    #[inline]
    pub(super) fn way(&self, path: &Path<D>, place: &Place<D>) -> Way<N, D> {
        let mut way = Way {
            places: [Vector::ZERO; N],
            velocities: [Vector::ZERO; N],
            centre: Vector::ZERO,
            mean: Vector::ZERO,
            radius: self.radius,
        };
        for (k, p) in self.element.vertices.iter().enumerate() {
            let q = place.point(*p);
            let v = path.velocity(place, *p, q);
            (way.places[k], way.velocities[k]) = (q, v);
            way.centre += q * self.form.weights[k];
            way.mean += v * self.form.weights[k];
        }
        way
    }
}

/// A part on its way, in the field's coordinates.
#[derive(Clone, Copy)]
pub(super) struct Way<const N: usize, const D: usize> {
    pub(super) places: [Point<D>; N],
    pub(super) velocities: [Vector<f64, D>; N],
    /// The centre, and the velocity there.
    pub(super) centre: Point<D>,
    pub(super) mean: Vector<f64, D>,
    /// Of a ball [m].
    radius: f64,
}

impl<const N: usize, const D: usize> Way<N, D> {
    /// How long the part stays in a ball of a `radius` about `p`, on a way of at most this
    /// `acceleration` [m].
    #[inline]
    pub(super) fn stays(&self, p: Point<D>, radius: f64, acceleration: f64) -> Stay {
        let radius = radius - self.radius;
        let mut far = 0.0_f64;
        for place in &self.places {
            let apart = *place - p;
            far = far.max(apart.dot(apart));
        }
        let centre = exit(self.centre - p, self.mean, radius + self.radius);
        let spare = radius - far.sqrt();
        let (bend, most) = bend(spare, acceleration);
        // NaN is no time.
        let mut part = if spare > 0.0 { most } else { 0.0 };
        for (place, velocity) in self.places.iter().zip(&self.velocities) {
            let exit = exit(*place - p, *velocity, radius - bend);
            part = if exit < part { exit } else { part };
        }
        let centre = if spare > 0.0 { centre.min(most) } else { centre };
        Stay { part: part * (1.0 - 1e-12), centre }
    }
}

/// The vertex across from the longest edge; the first of a segment.
fn apex<const N: usize, const D: usize>(element: &Element<N, D>) -> usize {
    let v = element.vertices();
    let edge = |k: usize| (v[(k + 1) % N] - v[(k + 2) % N]).norm();
    if N == 2 {
        0
    } else {
        (0..N).fold(0, |long, k| if edge(k) > edge(long) { k } else { long })
    }
}

/// The separation is known well enough for a step if its lower bound is at least this share of the
/// upper one.
const KNOWN: f64 = 0.5;

/// The tolerance of the separation begins at `COARSEST` of the size, and is multiplied by `FINER` until the
/// separation is known well enough, down to `FINEST` of the gap.
const FINER: f64 = 0.25;
const COARSEST: f64 = 1e-2;
const FINEST: f64 = 0.25;

/// Two bodies that advance.
pub(super) struct Advancement<'a, const D: usize> {
    pub(super) bodies: [Moving<'a, D>; 2],
    /// The way of one as the other sees it.
    pub(super) way: WayBounds,
    /// Half the diagonal of the smaller body's box [m].
    pub(super) size: f64,
    pub(super) settings: &'a SweepSettings,
    /// How often fields may be evaluated.
    pub(super) budget: u32,
}

/// How far bodies have advanced: until `lower` they are apart, and at `upper` they touch; infinite if no
/// touch was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Advanced {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) evaluations: u32,
}

impl<const D: usize> Advancement<'_, D> {
    /// From a time until which they are apart.
    pub(super) fn run(
        &self,
        from: f64,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<Advanced, QueryError> {
        let gap = self.settings.gap;
        let finest = FINEST * gap;
        let mut tolerance = finest.max(COARSEST * self.size);
        let mut advanced = Advanced { lower: from, upper: f64::INFINITY, evaluations: 0 };
        while advanced.lower < 1.0 && advanced.evaluations < self.budget {
            let [a, b] = self.bodies.map(|body| body.at(advanced.lower));
            let limits = Limits::new(tolerance).with_budget(self.budget - advanced.evaluations);
            let near = separation(a, b, &limits, workspace)?;
            advanced.evaluations = advanced.evaluations.saturating_add(near.evaluations.max(1));
            if near.upper <= gap {
                advanced.upper = advanced.lower;
                break;
            }
            let free = near.lower - FREE * gap - self.way.rounding;
            let is_finest = tolerance <= finest;
            if free > 0.0 && (is_finest || near.lower >= KNOWN * near.upper) {
                let next =
                    advanced.lower + free / (self.way.speed * (1.0 + 4.0 * f64::EPSILON));
                if next <= advanced.lower {
                    break;
                }
                advanced.lower = next.min(1.0);
            } else if is_finest {
                break;
            } else {
                tolerance = finest.max(FINER * tolerance);
            }
        }
        Ok(advanced)
    }
}
