// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts of bodies that move.

use palpate_field::Pose;

use super::{Track, displacement};
use crate::certified::Limits;
use crate::error::QueryError;
use crate::manifold::{Manifold, ManifoldSettings, SeparatedPair, Spanned};
use crate::pair::PairWorkspace;
use crate::pair::body_pair::BodyPair;
use crate::placed::Placed;

/// Contacts are kept while the bodies stay within this share of the margin of the poses at which their
/// region was searched.
const NEAR: f64 = 0.25;

/// Contacts of an earlier step, in the first body's coordinates.
#[derive(Clone, Debug)]
pub(super) struct Kept<const D: usize> {
    /// The second body in these coordinates.
    at: Pose<D>,
    settings: ManifoldSettings,
    spanned: Spanned<D>,
}

impl<const D: usize> Track<D> {
    /// The contacts of both shapes at these poses, `world_from_body`, as
    /// [`manifold`](crate::manifold) finds them, with lasting ids: a contact near one of the
    /// last step, on either body, keeps its `id`.
    ///
    /// While the bodies stay within a quarter of the margin of the poses at which the region of contact
    /// was searched, its points are put back on the surfaces, and only the separation is searched. Parts
    /// of the region that are new meanwhile have a gap of more than three quarters of the margin.
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
        let [a, b] = &self.shapes;
        let pair = BodyPair::new(Placed::new(a, poses[0]), Placed::new(b, poses[1]))?;
        let separated = SeparatedPair { pair, best, separation };
        let mut found = if separation.lower > settings.margin {
            Manifold::apart(separation)
        } else {
            Kept::spanning(&mut self.kept, separated, (settings, limits.budget), workspace)
        };
        self.names.name(&mut found.contacts, poses, settings.spacing);
        found.separation.evaluations +=
            self.history.follow(&mut found.contacts, pair, poses, settings);
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
        let root = separated.pair.root(settings.margin);
        let lasts = |kept: &&Self| {
            kept.settings == *settings
                && displacement(&kept.at, &now, &root) <= NEAR * settings.margin
        };
        if let Some(kept) = last.as_ref().filter(lasts) {
            let spanned = kept.spanned.moved(&mut separated, settings);
            return spanned.manifold(&separated, settings);
        }
        let spanned = Spanned::find(&mut separated, settings, budget, workspace);
        let found = spanned.manifold(&separated, settings);
        *last = Some(Self { at: now, settings: *settings, spanned });
        found
    }
}
