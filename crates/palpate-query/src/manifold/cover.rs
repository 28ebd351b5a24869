// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! That the contacts leave out no part of the region by more than two spacings.

use palpate_field::Point;

use super::patch::Patches;
use super::region::distance;
use super::{LIKE, Member, Touch};
use crate::pair::search::BoxCell;

/// No part of the region is farther than this many spacings from the convex hull of the contacts.
const MOST: f64 = 2.0;

/// No candidate is farther than this many spacings from the hull. Parts of the region in doubtful boxes may be
/// farther from a candidate than the rest, and contacts move a little to the surfaces.
const CANDIDATES: f64 = 1.4;

/// The most steps to the nearest point of a hull. A place that is still undecided then is near the limit. It
/// counts as left out.
const STEPS: usize = 16;

/// Whether a place is farther than `far` from the convex hull of the contacts [m], by Gilbert's algorithm.
fn is_left_out<const D: usize>(place: Point<D>, contacts: &[Member<D>], far: f64) -> bool {
    let Some(nearest) = nearest(place, contacts) else { return true };
    let mut here = nearest.touch.point;
    for _ in 0..STEPS {
        let away = place - here;
        let apart = away.norm();
        if apart <= far {
            return false;
        }
        let points = contacts.iter().map(|member| member.touch.point);
        let farthest = points.max_by(|one, other| away.dot(*one).total_cmp(&away.dot(*other)));
        let Some(farthest) = farthest else { return true };
        if away.dot(place - farthest) > far * apart {
            return true;
        }
        let way = farthest - here;
        here += way * (away.dot(way) / way.dot(way)).clamp(0.0, 1.0);
    }
    true
}

/// Whether a part of a box is farther than promised from the convex hull of the contacts.
pub(super) fn is_box_left_out<const D: usize>(
    cell: &BoxCell<D>,
    contacts: &[Member<D>],
    spacing: f64,
) -> bool {
    is_left_out(cell.centre, contacts, MOST * spacing - cell.radius())
}

/// Whether a place is farther than promised from the convex hull of the contacts.
pub(super) fn is_place_left_out<const D: usize>(
    place: Point<D>,
    contacts: &[Member<D>],
    spacing: f64,
) -> bool {
    is_left_out(place, contacts, MOST * spacing)
}

fn nearest<const D: usize>(place: Point<D>, contacts: &[Member<D>]) -> Option<&Member<D>> {
    let apart = |member: &Member<D>| distance(member.touch.point, place);
    contacts.iter().min_by(|one, other| apart(one).total_cmp(&apart(other)))
}

impl<const D: usize> Patches<'_, '_, D> {
    /// Appends contacts until none of these touches is left out. The touch that is farthest from all contacts
    /// comes next, moved to the end of its part; and as it is, if it is left out even so.
    pub(super) fn cover(&mut self, touches: &[Touch<D>], contacts: &mut Vec<Member<D>>) {
        let spacing = self.settings.spacing;
        let mut left: Vec<&Touch<D>> = touches.iter().collect();
        loop {
            left.retain(|touch| is_left_out(touch.point, contacts, CANDIDATES * spacing));
            let apart = |touch: &Touch<D>| {
                let nearest = nearest(touch.point, contacts);
                nearest.map_or(f64::INFINITY, |it| distance(it.touch.point, touch.point))
            };
            let farthest = (0..left.len())
                .max_by(|&i, &k| apart(left[i]).total_cmp(&apart(left[k])).then(k.cmp(&i)));
            let Some(farthest) = farthest else { return };
            let touch = self.by_values(*left.swap_remove(farthest));
            let like = |member: &&Member<D>| member.touch.normal.dot(touch.normal) > LIKE;
            let new = contacts.iter().map(|member| member.group + 1).max().unwrap_or(0);
            let alike: Vec<_> = contacts.iter().filter(like).copied().collect();
            let next = nearest(touch.point, &alike).copied();
            let (group, end) = next.map_or((new, touch), |next| {
                let deepest = &contacts[0].touch;
                (next.group, self.corner(touch, deepest, next.touch.point))
            });
            let is_out = |touch: &Touch<D>, contacts: &[Member<D>]| {
                is_left_out(touch.point, contacts, CANDIDATES * spacing)
            };
            if is_out(&end, contacts) {
                contacts.push(Member { touch: end, group });
            }
            if is_out(&touch, contacts) {
                contacts.pop_if(|last| last.touch.point == end.point);
                contacts.push(Member { touch, group });
            }
        }
    }
}
