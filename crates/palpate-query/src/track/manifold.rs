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
/// margin, too, and its contacts are kept while the bodies stay within as much of those poses.
const WIDER: f64 = 1.5;

/// A search that goes farther costs two: it is worth that if it lasts for so many more steps. After one
/// that does not, so many go no farther, and twice as many each time.
const WORTH: u32 = 2;
const ALONE: u32 = 4;

/// Contacts of an earlier step, in the first body's coordinates.
#[derive(Clone, Debug)]
pub(super) struct Kept<const D: usize> {
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
    /// separation is searched. Parts of the region that are new meanwhile have a gap of more than three
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
        let is_of_these = |kept: &Self| {
            kept.settings == *settings && !(kept.spanned.is_cut_off() && kept.budget < budget)
        };
        let kept = last.take().filter(is_of_these);
        let farther = 1.0 + WIDER;
        let root = separated.pair.root(farther * settings.margin);
        let (mut is_slow, mut alone, mut next_alone) = (false, 0, ALONE);
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
            let went_farther = kept.reach > NEAR * settings.margin;
            if went_farther && kept.lasted < WORTH {
                (alone, next_alone) = (next_alone, next_alone.saturating_mul(2));
            } else if went_farther {
                next_alone = ALONE;
            }
            is_slow =
                alone == 0 && displacement(&kept.last, &now, &root) <= WIDER * settings.margin;
        }
        let (spanned, share) = if is_slow {
            let spanned =
                Spanned::find_farther(&mut separated, settings, farther, budget, workspace);
            (spanned, WIDER)
        } else {
            (Spanned::find(&mut separated, settings, budget, workspace), NEAR)
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
