// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of two bodies that move.

use palpate_field::{Pose, Vector};

use super::advancement::Advancement;
use super::boxes::{BoxFrontier, BoxMemory, BoxSweep, SpaceCell, frontier};
use super::first_touch::{FirstTouch, Start};
use super::moving::{Moving, corners};
use super::path::Path;
use super::proof::FreeBox;
use super::settings::{FREE, SweepSettings};
use crate::certified::{Limits, Stop};
use crate::contact::NormalSource;
use crate::engine;
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
    let bounds = still.shape.promise().bounds.ok_or(QueryError::Unbounded)?;
    settings.check()?;
    bodies.iter().enumerate().try_for_each(|(i, body)| body.motion.check(i))?;
    let path = Path { field: moving.motion, body: still.motion };
    // Where both fields are at most half of the gap, the separation is at most the gap.
    let touch = 0.5 * settings.gap;
    let root = bounds.aabb.grown(touch);
    let way = path.bounds(&corners(&root).collect::<Vec<_>>());
    let bounds = [still, moving].map(|body| DistanceBound::new(body.shape, Pose::identity()));
    let slack = bounds[0].slack(root.radius_about_origin()).max(bounds[1].slack(way.far))
        + way.rounding;
    memory.begin(&root, frontier);
    let mut search = BoxSweep {
        bodies: [still, moving],
        bounds,
        path,
        way,
        level: FREE * touch + slack,
        touch,
        slack,
        size: root.half_extents().norm(),
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
            end = engine::search(&mut search, frontier);
        }
    }
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
