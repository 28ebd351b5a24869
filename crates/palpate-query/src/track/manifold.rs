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

/// Of bodies that move on slowly, the region is searched up to a gap that is larger by this share of the
/// margin, and its contacts are kept while the bodies stay within as much of those poses.
const WIDER: f64 = 1.5;

/// Contacts of an earlier step, in the first body's coordinates.
#[derive(Clone, Debug)]
pub(super) struct Kept<const D: usize> {
    /// The second body in these coordinates when the region was searched, and in the last step.
    found_at: Pose<D>,
    last: Pose<D>,
    /// How far the bodies may move from there [m].
    reach: f64,
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
    /// of the region that are new meanwhile have a gap of more than three quarters of the margin. Of
    /// bodies that move on by no more than 1.5 margins in a step, the region is searched up to 2.5
    /// margins, and lasts while they stay within 1.5 of those poses: no part within the margin is
    /// new meanwhile.
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
        let kept = last.take().filter(|kept| kept.settings == *settings);
        let wider = settings.with_margin((1.0 + WIDER) * settings.margin);
        let root = separated.pair.root(wider.margin);
        let mut is_slow = false;
        if let Some(mut kept) = kept {
            if displacement(&kept.found_at, &now, &root) <= kept.reach {
                let spanned = kept.spanned.moved(&mut separated, &kept.found_at, settings);
                kept.last = now;
                *last = Some(kept);
                return spanned.manifold(&separated, settings);
            }
            is_slow = displacement(&kept.last, &now, &root) <= WIDER * settings.margin;
        }
        let (searched, share) = if is_slow { (&wider, WIDER) } else { (settings, NEAR) };
        let spanned = Spanned::find(&mut separated, searched, budget, workspace);
        let within = spanned.clone().within(&mut separated, settings);
        let found = within.manifold(&separated, settings);
        let reach = share * settings.margin;
        *last = Some(Self { found_at: now, last: now, reach, settings: *settings, spanned });
        found
    }
}
