// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One pair of bodies at many poses.

use palpate_field::{Pose, Shape};
#[cfg(feature = "parallel")]
use rayon::prelude::*;

use crate::certified::{Certified, Limits};
use crate::error::QueryError;
use crate::pair::{Nearest, PairWorkspace, overlap, separation};
use crate::placed::{Placed, check_pose};
use crate::pool::Pool;

/// Poses that one thread takes at a time: enough that fetching a workspace costs nothing
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
        let ask = |(poses, answers): (&[Pose<D>], &mut [Option<_>])| {
            self.pool.with(|workspace| {
                for (pose, answer) in poses.iter().zip(answers) {
                    *answer = if goes_on() { self.ask(pose, workspace) } else { None };
                }
            });
        };
        #[cfg(feature = "parallel")]
        poses.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).for_each(ask);
        #[cfg(not(feature = "parallel"))]
        poses.chunks(CHUNK).zip(answers.chunks_mut(CHUNK)).for_each(ask);
        Ok(answers.iter().all(Option::is_some))
    }

    /// Refuses all that a single question would refuse.
    fn check(&self, poses: &[Pose<D>], places: usize) -> Result<(), QueryError> {
        if poses.len() != places {
            return Err(QueryError::Places { poses: poses.len(), places });
        }
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
