// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts on bodies that have moved a little since their region was searched.

use palpate_field::{Point, Pose, Vector};

use super::grid::distance;
use super::patch::settled;
use super::{
    COPIES, LIKE, ManifoldSettings, Member, SAME_DEPTH, SeparatedPair, Spanned, Touch,
    drop_copies, is_copy,
};
use crate::pair::body_pair::BodyPair;

/// A point is drawn to where the gap is this share of the margin, in so many steps at most.
const WITHIN: f64 = 0.9;
const DRAWN: usize = 4;

/// Where the bodies face each other no longer at a point of a rim, they may so many spacings farther
/// inwards.
const INWARDS: [f64; 3] = [1.0 / 16.0, 1.0 / 4.0, 1.0];

impl<const D: usize> Spanned<D> {
    /// These points, found when the second body was at `found_at` in the pair's frame, on the surface
    /// between the bodies as they are now, with the best point of the search. `None` where the bodies do
    /// not face each other any more at a point as they did: what spans the region now must be found anew.
    pub(crate) fn moved(
        &self,
        separated: &mut SeparatedPair<'_, D>,
        found_at: &Pose<D>,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        let SeparatedPair { pair, best, .. } = separated;
        let second_to_frame = pair.second_from_frame.inverse();
        let with_second =
            |p: Point<D>| second_to_frame.transform_point(found_at.transform_point(p));
        let mut carry = |member: &Member<D>| {
            let Touch { point, normal, .. } = member.touch;
            let touch = carried(pair, [point, with_second(point)], normal, settings)?;
            Some(Member { touch, ..*member })
        };
        let mut members: Vec<_> = self.members.iter().map(&mut carry).collect::<Option<_>>()?;
        let beyond: Vec<_> = self.beyond.iter().filter_map(&mut carry).collect();
        for member in &mut members {
            if member.touch.gap > settings.margin
                && let Some(touch) = drawn_within(pair, &member.touch, settings)
            {
                member.touch = touch;
            }
        }
        members.extend(beyond);
        members.retain(|member| member.touch.gap <= settings.margin);
        let deepest = Touch::at(pair, *best);
        add_deepest(&mut members, deepest, settings);
        // Those that have come nearer to each other than the spacing.
        drop_copies(&mut members, settings.spacing / COPIES);
        Some(Self { members, beyond: Vec::new(), stop: self.stop })
    }
}

/// The deepest touch with a normal like `normal` next to the places to which the bodies carried a point;
/// or farther inwards, where the bodies face each other likewise at none of them.
fn carried<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    places: [Point<D>; 2],
    normal: Vector<f64, D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let found = places.map(|place| like(pair, place, normal, settings));
    let deeper = found.into_iter().flatten().min_by(|one, other| one.gap.total_cmp(&other.gap));
    deeper.or_else(|| {
        places.into_iter().find_map(|place| {
            let inwards = inwards(pair, place, normal)?;
            let mut ways =
                INWARDS.into_iter().map(|share| inwards * (share * settings.spacing));
            ways.find_map(|way| like(pair, place + way, normal, settings))
        })
    })
}

/// The way inwards from a point at the rim of a region where the gradient of a body leads out of a side of
/// it: along the region, against that gradient.
fn inwards<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    normal: Vector<f64, D>,
) -> Option<Vector<f64, D>> {
    let [(_, slope_a), (_, slope_b)] = pair.slopes(p);
    let sum = slope_a + slope_b;
    (normal * sum.dot(normal) - sum).normalized()
}

/// The touch next to a point, if it has a normal like `normal`.
fn like<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    normal: Vector<f64, D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    settled(pair, p, settings.spacing, settings).filter(|touch| touch.normal.dot(normal) > LIKE)
}

/// A touch whose gap is within the margin, by steps of Newton's method along the surface between the
/// bodies from a touch whose gap is larger.
fn drawn_within<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    from: &Touch<D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let mut here = from.point;
    for _ in 0..DRAWN {
        let [(a, slope_a), (b, slope_b)] = pair.slopes(here);
        // On the surface between, the gap is the sum of both values.
        let (across, sum) = (slope_a - slope_b, slope_a + slope_b);
        let along = sum - across * (sum.dot(across) / across.dot(across));
        let next = here - along * ((a + b - WITHIN * settings.margin) / along.dot(along));
        let touch = like(pair, next, from.normal, settings)?;
        if touch.gap <= settings.margin {
            return Some(touch);
        }
        here = touch.point;
    }
    None
}

/// Adds the certified deepest touch, unless one of the members is as deep.
fn add_deepest<const D: usize>(
    members: &mut Vec<Member<D>>,
    deepest: Touch<D>,
    settings: &ManifoldSettings,
) {
    let is_as_deep =
        |touch: &Touch<D>| touch.gap - deepest.gap <= SAME_DEPTH * settings.precision_length();
    if let Some(member) = members.iter_mut().find(|member| is_as_deep(&member.touch)) {
        // No less deep than what is certified.
        member.touch.gap = member.touch.gap.min(deepest.gap);
        return;
    }
    let is_like = |member: &&mut Member<D>| member.touch.normal.dot(deepest.normal) > LIKE;
    let apart = |member: &Member<D>| distance(member.touch.point, deepest.point);
    let nearest = members
        .iter_mut()
        .filter(is_like)
        .min_by(|one, other| apart(one).total_cmp(&apart(other)));
    match nearest {
        Some(member) if is_copy(&member.touch, &deepest, settings.spacing) => {
            member.touch = deepest;
        }
        nearest => {
            let group = nearest.map(|member| member.group);
            let new = || members.iter().map(|member| member.group + 1).max().unwrap_or(0);
            let group = group.unwrap_or_else(new);
            members.push(Member { touch: deepest, group });
        }
    }
}
