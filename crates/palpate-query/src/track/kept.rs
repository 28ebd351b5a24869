// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The contacts of an earlier step, carried with the bodies.

use palpate_field::Pose;

use super::displacement;
use crate::manifold::{Manifold, ManifoldSettings, SeparatedPair, Spanned};
use crate::pair::PairWorkspace;

/// Contacts are kept while the bodies stay within this share of the margin of the poses at which their
/// region was searched.
const FARTHER: f64 = 0.25;

/// Of bodies that move on slowly, the region is searched up to a gap that is larger by this share of the
/// margin, too, and its contacts are kept while the bodies stay within as much of those poses.
const WIDER: f64 = 1.5;

/// A search that goes farther costs two: it is worth that if it lasts for so many more steps. After one
/// that does not, so many go no farther, and twice as many each time.
const WORTH: u32 = 2;
const MANIFOLD_ALONE: u32 = 4;

/// Contacts of an earlier step, in the first body's coordinates.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

impl<const D: usize> Kept<D> {
    /// The contacts of bodies that touch, from those of an earlier step if they last.
    pub(super) fn spanning(
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
        let (mut is_slow, mut alone, mut next_alone) = (false, 0, MANIFOLD_ALONE);
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
            let went_farther = kept.reach > FARTHER * settings.margin;
            if went_farther && kept.lasted < WORTH {
                (alone, next_alone) = (next_alone, next_alone.saturating_mul(2));
            } else if went_farther {
                next_alone = MANIFOLD_ALONE;
            }
            is_slow =
                alone == 0 && displacement(&kept.last, &now, &root) <= WIDER * settings.margin;
        }
        let (spanned, share) = if is_slow {
            let spanned =
                Spanned::find_farther(&mut separated, settings, farther, budget, workspace);
            (spanned, WIDER)
        } else {
            (Spanned::find(&mut separated, settings, budget, workspace), FARTHER)
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
