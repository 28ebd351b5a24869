// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts of bodies that move.

use palpate_field::Pose;

use super::Track;
use crate::certified::Limits;
use crate::error::QueryError;
use crate::manifold::{Manifold, ManifoldSettings, SeparatedPair, spanning};
use crate::pair::PairWorkspace;
use crate::pair::body_pair::BodyPair;
use crate::placed::Placed;

impl<const D: usize> Track<D> {
    /// The contacts of both shapes at these poses, `world_from_body`, as
    /// [`manifold`](crate::manifold) finds them, with lasting ids: a contact near one of the
    /// last step, on either body, keeps its `id`.
    ///
    /// # Errors
    ///
    /// As of [`manifold`](crate::manifold).
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
        let [a, b] = self.shapes();
        let pair = BodyPair::new(Placed::new(a, poses[0]), Placed::new(b, poses[1]))?;
        let separated = SeparatedPair { pair, best, separation };
        let mut found = spanning(separated, settings, limits.budget, workspace);
        self.names.name(&mut found.contacts, poses, settings.spacing);
        Ok(found)
    }
}
