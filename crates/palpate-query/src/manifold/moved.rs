// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts on bodies that have moved a little since their region was searched.

use palpate_field::{Point, Pose, Vector};

use super::{ManifoldSettings, Member, SAME_DEPTH, SeparatedPair, Spanned, Touch, is_copy};
use crate::pair::body_pair::BodyPair;

/// A point is drawn to where the gap is this share of the margin, in so many steps at most.
const WITHIN: f64 = 0.9;
const DRAWN: usize = 4;

impl<const D: usize> Spanned<D> {
    /// These points, found when the second body was at `found_at` in the pair's frame, on the surface
    /// between the bodies as they are now, with the best point of the search.
    pub(crate) fn moved(
        &self,
        separated: &mut SeparatedPair<'_, D>,
        found_at: &Pose<D>,
        settings: &ManifoldSettings,
    ) -> Self {
        let SeparatedPair { pair, best, .. } = separated;
        let second_to_frame = pair.second_from_frame.inverse();
        let renewed = |member: &Member<D>| {
            let there = member.touch.point;
            let touch = put_back(pair, there, settings);
            if touch.gap <= settings.margin {
                return Member { touch, ..*member };
            }
            // A corner of the second body, which has slid over the first one.
            let with_second = second_to_frame.transform_point(found_at.transform_point(there));
            let other = put_back(pair, with_second, settings);
            Member { touch: if other.gap < touch.gap { other } else { touch }, ..*member }
        };
        let mut members: Vec<_> = self.members.iter().map(renewed).collect();
        let deepest = Touch::at(pair, *best);
        let near = members
            .iter_mut()
            .find(|member| is_copy(&member.touch, &deepest, settings.spacing));
        match near {
            Some(member) => {
                let is_deeper = SAME_DEPTH * settings.precision_length();
                if deepest.gap < member.touch.gap - is_deeper {
                    member.touch = deepest;
                }
            }
            None => {
                let group = members.iter().map(|member| member.group + 1).max().unwrap_or(0);
                members.push(Member { touch: deepest, group });
            }
        }
        members.sort_by(|one, other| one.touch.gap.total_cmp(&other.touch.gap));
        Self { members, stop: self.stop }.within(separated, settings)
    }

    /// The same region where the gap is within the margin of `settings`, which may be less than that of
    /// the search: points beyond the margin are drawn to where the gap is the margin.
    pub(crate) fn within(
        mut self,
        separated: &mut SeparatedPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Self {
        let is_within = |member: &Member<D>| member.touch.gap <= settings.margin;
        let count = self.members.partition_point(is_within);
        for i in count..self.members.len() {
            let Some(touch) =
                drawn_within(&mut separated.pair, self.members[i].touch.point, settings)
            else {
                continue;
            };
            let is_new = |other: &Member<D>| {
                !is_within(other) || !is_copy(&other.touch, &touch, settings.spacing)
            };
            if self.members.iter().all(is_new) {
                self.members[i].touch = touch;
            }
        }
        self.members[count..].sort_by(|one, other| one.touch.gap.total_cmp(&other.touch.gap));
        self
    }
}

/// The touch on the surface between the bodies, one step of Newton's method from a point near it.
fn put_back<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    settings: &ManifoldSettings,
) -> Touch<D> {
    let [(a, slope_a), (b, slope_b)] = pair.slopes(p);
    let between = slope_a - slope_b;
    let squared = between.dot(between);
    let step = if squared > 0.0 { between * ((a - b) / squared) } else { Vector::ZERO };
    // A step that is long is none towards the surface near the point.
    let is_near = step.norm() <= settings.spacing;
    Touch::at(pair, if is_near { p - step } else { p })
}

/// A touch whose gap is within the margin, by steps of Newton's method along the surface between the
/// bodies from a point of it whose gap is larger.
fn drawn_within<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let mut here = p;
    for _ in 0..DRAWN {
        let [(a, slope_a), (b, slope_b)] = pair.slopes(here);
        // On the surface between, the gap is the sum of both values.
        let (across, sum) = (slope_a - slope_b, slope_a + slope_b);
        let along = sum - across * (sum.dot(across) / across.dot(across));
        let next = here - along * ((a + b - WITHIN * settings.margin) / along.dot(along));
        if !next.is_finite() {
            return None;
        }
        let touch = put_back(pair, next, settings);
        if touch.gap <= settings.margin {
            return Some(touch);
        }
        here = touch.point;
    }
    None
}
