// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When the bodies of a world touch first.

use palpate_field::Aabb;

use super::{Body, BodyId, World, near::pairs_near};
use crate::error::QueryError;
use crate::sweep::{FirstTouch, Motion, Moving, SweepSettings, SweepWorkspace, corners, sweep};

/// Two bodies of a world that touch, or of which it is not known whether they do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyImpact<const D: usize> {
    /// The bodies; the first was added before the second.
    pub bodies: [BodyId; 2],
    /// When they touch.
    pub touch: FirstTouch<D>,
}

impl<const D: usize> World<D> {
    /// When bodies touch first, while those of `motions` move over the time from 0 to 1 and the
    /// others stay: all pairs that are not proven to be apart all the time, the earliest first.
    /// Before the first one's [`lower`](FirstTouch::lower), no bodies touch. The world stays as it
    /// is; groups and pairs to be ignored count.
    ///
    /// ```
    /// use palpate_field::{Pose, Screw, Shape};
    /// use palpate_query::{SweepSettings, World, WorldSettings};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let mut world = World::new(WorldSettings::of_size(1.0))?;
    /// let at = |y: f64| Pose::translation([0.0, y, 0.0]);
    /// let floor = world.add(Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0)?, at(0.0))?;
    /// let shelf = world.add(Shape::cuboid([1.0, 0.1, 1.0])?, at(2.0))?;
    /// let ball = world.add(Shape::ball(0.5)?, at(4.0))?;
    /// let falls = Screw::new(at(4.0), at(0.0), 0)?;
    /// let impacts = world.first_impact(&[(ball, falls.into())], &SweepSettings::of_size(1.0))?;
    /// assert_eq!(impacts.iter().map(|it| it.bodies).collect::<Vec<_>>(), [[shelf, ball], [floor, ball]]);
    /// // 4 − 0.5 − 2.05 m of 4 m.
    /// assert!((impacts[0].touch.upper - 0.3625).abs() < 1e-4);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If there is no such body, a pose is NaN or out of range, or a setting is not positive.
    #[inline(never)]
    pub fn first_impact(
        &self,
        motions: &[(BodyId, Motion<D>)],
        settings: &SweepSettings,
    ) -> Result<Vec<BodyImpact<D>>, QueryError> {
        settings.check()?;
        let mut ways: Vec<Option<(Body<D>, Motion<D>)>> = self
            .bodies
            .iter()
            .map(|body| body.as_ref().map(|body| (body.clone(), body.pose.into())))
            .collect();
        for way in ways.iter_mut().flatten() {
            way.0.has_moved = false;
        }
        for (id, motion) in motions {
            motion.check(id.0)?;
            let way = ways.get_mut(id.0).and_then(Option::as_mut);
            let (body, way) = way.ok_or(QueryError::NoBody { body: id.0 })?;
            *way = *motion;
            body.has_moved = true;
            body.aabb = body.way_box(motion);
        }
        let bodies: Vec<_> =
            ways.iter().map(|way| way.as_ref().map(|(body, _)| body.clone())).collect();
        let mut workspace = SweepWorkspace::new();
        let mut impacts = Vec::new();
        for [one, other] in pairs_near(&bodies) {
            let (Some((a, from)), Some((b, to))) = (&ways[one], &ways[other]) else { continue };
            if !self.is_asked([one, other], [a, b]) {
                continue;
            }
            let moving = [Moving::new(&a.shape, *from), Moving::new(&b.shape, *to)];
            let touch = match sweep(moving[0], moving[1], settings, &mut workspace) {
                // Of bodies without bounds nothing is known, as in a step.
                Err(QueryError::Unbounded) => FirstTouch::unknown(),
                found => found?,
            };
            if touch.touches() != Some(false) {
                impacts.push(BodyImpact { bodies: [BodyId(one), BodyId(other)], touch });
            }
        }
        impacts.sort_by(|a, b| {
            let time = |it: &BodyImpact<D>| it.touch.lower;
            time(a).total_cmp(&time(b)).then(a.bodies.cmp(&b.bodies))
        });
        Ok(impacts)
    }
}

impl<const D: usize> Body<D> {
    /// A box around all of a motion: no point is farther from its place in the middle of it than half
    /// of its way.
    fn way_box(&self, motion: &Motion<D>) -> Option<Aabb<D>> {
        let bounds = self.shape.promise().bounds?;
        let speed = corners(&bounds.aabb)
            .map(|corner| motion.velocity(corner).norm())
            .fold(0.0, f64::max);
        let middle = bounds.aabb.placed(&motion.pose(0.5));
        let rounding = super::ROUNDINGS * f64::EPSILON * middle.radius_about_origin();
        Some(middle.grown(0.5 * speed * (1.0 + 1e-9) + rounding))
    }
}
