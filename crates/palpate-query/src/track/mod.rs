// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies that move: what was proven of them is kept from step to step.

mod manifold;
mod names;

use palpate_field::{Aabb, BLOCK, Point, Pose, Shape, Vector};

use crate::certified::{Certified, Limits};
use crate::engine::{Frontier, Heap, Queue};
use crate::error::QueryError;
use crate::goal::Goal;
use crate::pair::Nearest;
use crate::pair::body_pair::BodyPair;
use crate::pair::cell::BoxCell;
use crate::pair::distance_bound::DistanceBound;
use crate::pair::search::{PairSearch, PairWorkspace, ROOM};
use crate::placed::Placed;
use names::Names;

/// Margin around the searched box, as a share of its size: the search begins anew for a body
/// that moves farther.
const MARGIN: f64 = 0.05;

/// The search begins anew once the kept boxes are this many times as many as at first.
const GROWTH: usize = 2;

/// Models improve the bounds that this many motions like the last would undo.
const RESERVE: f64 = 6.0;

/// A pair of shapes that moves: each search starts from what the last one proved.
///
/// The track keeps the boxes that cover all places that matter, each with a lower bound. A
/// motion that moves no point of a box by more than δ lowers no bound by more than δ, since
/// distances are nowhere steeper than one. After a small motion most bounds still suffice; a
/// pose that jumps costs a search from the start.
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
    cover: Option<Cover<D>>,
    names: Names<D>,
}

/// Boxes in the frame of the first shape that hold all places where the separation may be
/// found, with their bounds at the last pose.
#[derive(Clone, Debug)]
struct Cover<const D: usize> {
    cells: Heap<BoxCell<D>>,
    root: Aabb<D>,
    best: Point<D>,
    second_from_frame: Pose<D>,
    /// How many boxes the first search needed.
    first: usize,
}

impl<const D: usize> Track<D> {
    /// A track of these shapes that knows nothing yet.
    #[must_use]
    pub fn new(a: Shape<D>, b: Shape<D>) -> Self {
        Self { shapes: [a, b], cover: None, names: Names::new() }
    }

    /// The shapes.
    #[must_use]
    pub fn shapes(&self) -> &[Shape<D>; 2] {
        &self.shapes
    }

    /// Forgets all bounds: the next search begins anew.
    pub fn forget(&mut self) {
        self.cover = None;
    }

    /// The separation of both shapes at these poses, `world_from_body`, as
    /// [`separation`](crate::separation) finds it.
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    pub fn separation(
        &mut self,
        poses: [Pose<D>; 2],
        limits: &Limits,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let goal = Goal::least(0.5 * limits.tolerance);
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
        let mut search = PairSearch::new(pair, goal, limits)?;
        if let Some(answer) = search.told_by_boxes() {
            return Ok((answer, search.best));
        }
        search.keeps_all = true;
        let mut cover = self.cover.take();
        let is_known = cover.as_mut().is_some_and(|cover| cover.resume(&mut search, workspace));
        let answer = match &cover {
            Some(cover) if is_known => search.refine(&cover.root, workspace),
            _ => {
                let size = pair.root(0.0).half_extents().norm();
                let (answer, root) = search.run_within(MARGIN * size, workspace);
                let first = workspace.frontier.queue.len() + workspace.frontier.pending.len();
                let (best, second_from_frame) = (search.best, pair.second_from_frame);
                let cells = cover.take().map_or_else(|| Heap::new(ROOM, first), |c| c.cells);
                cover = Some(Cover { cells, root, best, second_from_frame, first });
                answer
            }
        };
        if let Some(cover) = &mut cover {
            (cover.best, cover.second_from_frame) = (search.best, pair.second_from_frame);
            let Frontier { queue, pending, .. } = &mut workspace.frontier;
            pending.drain(..).for_each(|cell| queue.push(&cell));
            std::mem::swap(&mut cover.cells, queue);
        }
        self.cover = cover;
        Ok((answer, search.best))
    }
}

impl<const D: usize> Cover<D> {
    /// Moves the boxes into `workspace` with the bounds that hold at the new pose; `false` if
    /// the bodies moved too far.
    fn resume(
        &mut self,
        search: &mut PairSearch<'_, D>,
        workspace: &mut PairWorkspace<D>,
    ) -> bool {
        // A region where a steepness holds moves with its body.
        let is_known = search.pair.bodies.iter().all(DistanceBound::is_known_everywhere);
        if !is_known || self.cells.len() > GROWTH * self.first + BLOCK {
            return false;
        }
        // Each step's slack covers the rounding of bounds only while the drift is no longer than
        // the coordinates.
        if self.cells.drift() > self.root.radius_about_origin() {
            return false;
        }
        // The best point has moved as little as the bodies have.
        search.descend(self.best, Some(search.goal.tolerance));
        let root = search.root(0.0);
        if !(self.root.contains(root.min) && self.root.contains(root.max)) {
            return false;
        }
        let slack = search.pair.slack(self.root.radius_about_origin());
        let moved = self.displacement(&search.pair.second_from_frame) + slack;
        self.cells.lower_all(moved);
        search.reserve = RESERVE * moved;
        std::mem::swap(&mut self.cells, &mut workspace.frontier.queue);
        search.resume(&self.root, workspace);
        true
    }

    /// An upper bound of how far points of the root moved in the second shape [m].
    fn displacement(&self, now: &Pose<D>) -> f64 {
        let before = &self.second_from_frame;
        let (centre, radius) = (self.root.centre(), self.root.half_extents().norm());
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
}
