// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many questions of a kind, which threads share: one pair of bodies at many poses, rays.

use palpate_field::{Pose, Shape};
#[cfg(feature = "parallel")]
use rayon::prelude::*;

use crate::certified::{Certified, Limits};
use crate::error::QueryError;
use crate::pair::{Nearest, PairWorkspace, overlap, separation};
use crate::placed::{Placed, check_pose};
use crate::pool::Pool;
use crate::ray::{Ray, RayHit, cast_ray};

/// Questions that one thread takes at a time: enough that fetching a workspace costs nothing
/// beside them, few enough that threads end together.
const CHUNK: usize = 16;

/// The question about each pose.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asked {
    Separation,
    Overlap,
}

/// A question about a pair of bodies at many poses.
#[derive(Debug)]
pub(super) struct Batch<'a, const D: usize> {
    pub(super) bodies: [&'a Shape<D>; 2],
    pub(super) asked: Asked,
    pub(super) limits: Limits,
    pub(super) pool: &'a Pool<D>,
}

impl<const D: usize> Batch<'_, D> {
    /// Writes the answers for `poses`; `true` if `goes_on` let all be asked.
    pub(super) fn run(
        &self,
        poses: &[Pose<D>],
        answers: &mut [Option<Certified<Nearest<D>>>],
        goes_on: impl Fn() -> bool + Sync,
    ) -> Result<bool, QueryError> {
        self.check(poses, answers.len())?;
        Ok(share(poses, answers, |poses, answers| {
            self.pool.with(|workspace| {
                fill(poses, answers, &goes_on, |pose| self.ask(pose, workspace));
            });
        }))
    }

    /// Refuses all that a single question would refuse.
    fn check(&self, poses: &[Pose<D>], places: usize) -> Result<(), QueryError> {
        check_places(poses.len(), places)?;
        self.limits.check()?;
        if self.bodies.iter().all(|body| body.promise().bounds.is_none()) {
            return Err(QueryError::Unbounded);
        }
        poses.iter().enumerate().try_for_each(|(i, pose)| check_pose(i, pose))
    }

    fn ask(
        &self,
        pose: &Pose<D>,
        workspace: &mut PairWorkspace<D>,
    ) -> Option<Certified<Nearest<D>>> {
        let [a, b] = self.bodies;
        let b = Placed::new(b, *pose);
        match self.asked {
            Asked::Separation => separation(a, b, &self.limits, workspace),
            Asked::Overlap => overlap(a, b, &self.limits, workspace),
        }
        .ok()
    }
}

/// The first surface along each of many rays; `true` if `goes_on` let all be asked.
pub(super) fn cast_rays<const D: usize>(
    shape: &Shape<D>,
    rays: &[Ray<D>],
    answers: &mut [Option<Certified<Option<RayHit<D>>>>],
    limits: impl Fn(&Ray<D>) -> Limits + Sync,
    goes_on: impl Fn() -> bool + Sync,
) -> Result<bool, QueryError> {
    check_places(rays.len(), answers.len())?;
    rays.iter().try_for_each(|ray| limits(ray).check())?;
    Ok(share(rays, answers, |rays, answers| {
        fill(rays, answers, &goes_on, |ray| cast_ray(shape, ray, &limits(ray)).ok());
    }))
}

fn check_places(questions: usize, places: usize) -> Result<(), QueryError> {
    if questions == places { Ok(()) } else { Err(QueryError::Places { questions, places }) }
}

/// Asks parts of all questions, on rayon's threads if there are; `true` if all were answered.
fn share<T: Sync, A: Send>(
    all: &[T],
    answers: &mut [Option<A>],
    ask: impl Fn(&[T], &mut [Option<A>]) + Sync,
) -> bool {
    #[cfg(feature = "parallel")]
    let parts = all.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK));
    #[cfg(not(feature = "parallel"))]
    let parts = all.chunks(CHUNK).zip(answers.chunks_mut(CHUNK));
    parts.for_each(|(all, answers)| ask(all, answers));
    answers.iter().all(Option::is_some)
}

/// Asks one question after the other, while `goes_on` says so.
fn fill<T, A>(
    all: &[T],
    answers: &mut [Option<A>],
    goes_on: &impl Fn() -> bool,
    mut ask: impl FnMut(&T) -> Option<A>,
) {
    for (one, answer) in all.iter().zip(answers) {
        *answer = if goes_on() { ask(one) } else { None };
    }
}
