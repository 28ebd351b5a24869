// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Several bodies that hold one proxy: each gives the force of its own material.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};
use palpate_query::constraints::{CAPACITY, pushes};

use crate::contact::Walls;
use crate::nearby::{FieldValue, Nearby, Punctured};
use crate::surface::{Friction, Stratum};

/// A body touches the proxy if its gap is at most this part of the stretch.
const NEAR: f64 = 1e-3;

/// The same for a body that touched in the tick before: a hand that trembles does not leave.
const STILL_NEAR: f64 = 0.02;

/// Walls whose normals have at least this cosine are level: the hand cannot tell them apart.
const ALIGNED: f64 = 0.99;

/// A body begins to push with this part of the stretch: less is rounding.
const LEAST_PUSH: f64 = 1e-6;

/// A body that touches the proxy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    pub(crate) body: u32,
    /// The unit normal of its surface at the proxy, pointing out.
    pub(crate) normal: Vector<f64, 3>,
    /// How far it pushes the proxy along its normal from the device point [m]; zero if other
    /// bodies keep the proxy there.
    pub(crate) push: f64,
    /// Its part of the force on the hand [N].
    pub(crate) force: Vector<f64, 3>,
}

impl Wall {
    const NONE: Self = Self { body: 0, normal: Vector::ZERO, push: 0.0, force: Vector::ZERO };
}

/// The bodies that touch a proxy: at a crease more than one.
///
/// With the unit normals `nᵢ` of the bodies at the proxy, the stretch from the device point to the
/// proxy, but for what friction holds, is `Σ λᵢ nᵢ` with the pushes `λᵢ ≥ 0`: the conditions of
/// Karush, Kuhn and Tucker of the closest point above all walls (Zilles and Salisbury 1995).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crease {
    walls: [Wall; CAPACITY],
    count: usize,
}

/// A proxy that is held by the body whose field is least there, and by others perhaps.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) proxy: Point<3>,
    /// From the device point to the proxy, but for what friction holds [m].
    pub(crate) stretch: Vector<f64, 3>,
    /// The body whose field is least.
    pub(crate) body: u32,
    /// The unit normal of its surface.
    pub(crate) normal: Vector<f64, 3>,
    /// The probe's radius [m].
    pub(crate) radius: f64,
}

impl Crease {
    pub(crate) const NONE: Self = Self { walls: [Wall::NONE; CAPACITY], count: 0 };

    /// A proxy that one body holds.
    pub(crate) fn of_one(body: u32, normal: Vector<f64, 3>) -> Self {
        let mut crease = Self::NONE;
        crease.add(body, normal);
        crease
    }

    /// The bodies that touch the proxy at `place`. `was_touched` tells those of the tick before,
    /// and `punctured` the layers that do not count. Each evaluation adds to `evaluations`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn at(
        nearby: &Nearby<'_>,
        place: &Place,
        punctured: &Punctured,
        was_touched: impl Fn(u32) -> bool,
        evaluations: &mut u32,
    ) -> Self {
        let mut found = Self::of_one(place.body, place.normal);
        let stretch = place.stretch.norm();
        let near = |body| {
            let part = if was_touched(body) { STILL_NEAR } else { NEAR };
            place.radius + part * stretch
        };
        let of_others = |body| (body != place.body).then(|| near(body));
        for FieldValue { distance, gradient, body } in
            nearby.each_within(place.proxy, punctured, of_others)
        {
            *evaluations += 1;
            if distance <= near(body)
                && let Some(normal) = gradient.normalized()
            {
                found.add(body, normal);
            }
        }
        found.push(place.stretch);
        found.retain(was_touched);
        found
    }

    fn add(&mut self, body: u32, normal: Vector<f64, 3>) {
        if let Some(wall) = self.walls.get_mut(self.count) {
            *wall = Wall { body, normal, ..Wall::NONE };
            self.count += 1;
        }
    }

    /// Adds a wall whose push and force are known, if there is room.
    pub(crate) fn add_pushing(&mut self, wall: Wall) {
        if let Some(place) = self.walls.get_mut(self.count) {
            *place = wall;
            self.count += 1;
        }
    }

    /// Multiplies all forces by `factor`.
    pub(crate) fn scale_forces(&mut self, factor: f64) {
        self.walls_mut().for_each(|wall| wall.force = wall.force * factor);
    }

    /// Parts `stretch` among the walls.
    fn push(&mut self, stretch: Vector<f64, 3>) {
        let length = stretch.norm();
        if self.count < 2 {
            self.walls_mut().for_each(|wall| wall.push = length);
            return;
        }
        let pushes = pushes(stretch, self.walls.map(|wall| wall.normal), self.count);
        for (wall, push) in self.walls_mut().zip(pushes) {
            wall.push = if push > LEAST_PUSH * length { push } else { 0.0 };
        }
    }

    pub(crate) fn walls(&self) -> impl Iterator<Item = &Wall> + Clone {
        self.walls.iter().take(self.count)
    }

    /// The number of bodies that touch the proxy.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    fn walls_mut(&mut self) -> impl Iterator<Item = &mut Wall> {
        self.walls.iter_mut().take(self.count)
    }

    /// The bodies that push.
    pub(crate) fn pushing_mut(&mut self) -> impl Iterator<Item = &mut Wall> {
        self.walls_mut().filter(|wall| wall.push > 0.0)
    }

    /// The walls that push, with their friction.
    pub(crate) fn walls_with(&self, friction: Friction) -> Walls {
        let mut walls = Walls { friction, normals: [Vector::ZERO; CAPACITY], count: 0 };
        let pushing = self.walls().filter(|wall| wall.push > 0.0);
        for (place, wall) in walls.normals.iter_mut().zip(pushing) {
            *place = wall.normal;
            walls.count += 1;
        }
        walls
    }

    /// Whether a body touches the proxy.
    pub(crate) fn has(&self, body: u32) -> bool {
        self.walls().any(|wall| wall.body == body)
    }

    /// Whether a body pushes the proxy.
    pub(crate) fn pushes(&self, body: u32) -> bool {
        self.walls().any(|wall| wall.body == body && wall.push > 0.0)
    }

    /// Drops the bodies that neither push nor pushed before: they are only near.
    fn retain(&mut self, was_touched: impl Fn(u32) -> bool) {
        let mut kept = Self::NONE;
        for wall in self.walls().filter(|wall| wall.push > 0.0 || was_touched(wall.body)) {
            if let Some(place) = kept.walls.get_mut(kept.count) {
                *place = *wall;
                kept.count += 1;
            }
        }
        *self = kept;
    }

    /// The body that pushes hardest.
    pub(crate) fn hardest(&self) -> Option<&Wall> {
        self.walls().max_by(|a, b| a.push.total_cmp(&b.push)).filter(|wall| wall.push > 0.0)
    }

    /// Whether all bodies that push are level with one another.
    pub(crate) fn is_level(&self) -> bool {
        let Some(hardest) = self.hardest() else { return true };
        let mut pushing = self.walls().filter(|wall| wall.push > 0.0);
        pushing.all(|wall| wall.normal.dot(hardest.normal) >= ALIGNED)
    }

    /// How much two bodies that push face each other: the largest `−cos` between two of their
    /// normals, or zero.
    pub(crate) fn facing(&self) -> f64 {
        let mut facing = 0.0_f64;
        let mut pushing = self.walls().filter(|wall| wall.push > 0.0);
        while let Some(wall) = pushing.next() {
            let against = pushing.clone().map(|other| -wall.normal.dot(other.normal));
            facing = against.fold(facing, f64::max);
        }
        facing
    }

    /// The sum of all pushes [m].
    pub(crate) fn whole(&self) -> f64 {
        self.walls().map(|wall| wall.push).sum()
    }
}

/// What bodies that hold a proxy together have in common: each property with the weight of the
/// body's part of all pushes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shared {
    /// The sum of the squared weights.
    squared_weights: f64,
    /// The sum of the squared products of weight and force [N²].
    squared_forces: f64,
    pub(crate) friction: Friction,
    damping: f64,
    viscosity: f64,
}

impl Shared {
    /// Adds a body's layer and its force at the depth of the whole stretch [N], with the weight
    /// `part`.
    pub(crate) fn add(&mut self, layer: &Stratum, force: f64, part: f64) {
        self.squared_weights += part * part;
        self.squared_forces += (part * force).powi(2);
        self.friction.fixed += layer.friction.fixed * part;
        self.friction.slipping += layer.friction.slipping * part;
        self.damping += layer.damping * part;
        self.viscosity += layer.viscosity * part;
    }

    /// The largest force of the springs together [N]: the root mean square of the bodies' forces at
    /// the depth of the whole stretch, weighted by the squares of their pushes. Springs at right
    /// angles give just that.
    pub(crate) fn most(&self) -> f64 {
        (self.squared_forces / self.squared_weights).sqrt()
    }

    /// The force of the dampers [N] at the `velocity` of the device point relative to the bodies
    /// [m/s], along the part of the `stretch` [m] that friction does not hold; as for one
    /// [`Surface`](crate::Surface).
    pub(crate) fn dampers(
        &self,
        velocity: Vector<f64, 3>,
        stretch: Vector<f64, 3>,
        held: Vector<f64, 3>,
    ) -> Vector<f64, 3> {
        // Without friction, what is held is rounding.
        let pressed = if self.friction.fixed > 0.0 { stretch - held } else { stretch };
        let along = pressed.normalized().unwrap_or(Vector::ZERO);
        let approach = (-velocity.dot(along)).max(0.0);
        along * (self.damping * approach) - velocity * self.viscosity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The crease of walls with these normals.
    fn crease(stretch: [f64; 3], normals: &[[f64; 3]]) -> Crease {
        let mut crease = Crease::NONE;
        for (body, normal) in (0..).zip(normals) {
            crease.add(body, Vector(*normal).normalized().unwrap());
        }
        crease.push(Vector(stretch));
        crease
    }

    #[test]
    fn walls_at_right_angles_push_by_their_depths() {
        let pushed = crease([3.0, 4.0, 0.0], &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(pushed.walls().map(|wall| wall.push).collect::<Vec<_>>(), [3.0, 4.0]);
        assert_eq!(pushed.hardest().map(|wall| wall.body), Some(1));
        assert_eq!(pushed.whole(), 7.0);
    }

    #[test]
    fn a_wall_that_only_stands_by_does_not_push() {
        let mut alone = crease([-1.0, 2.0, 0.0], &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(alone.walls().map(|wall| wall.push).collect::<Vec<_>>(), [0.0, 2.0]);
        alone.retain(|_| false);
        assert!(alone.has(1) && !alone.has(0));
    }

    #[test]
    fn pushes_along_oblique_normals_add_up_to_the_stretch() {
        let normals = [[1.0, 0.2, 0.1], [-0.9, 0.5, 0.3], [0.1, 0.3, -0.8]];
        let unit = normals.map(|n| Vector(n).normalized().unwrap());
        let stretch = unit[0] * 2.0 + unit[1] * 3.0 + unit[2] * 0.5;
        let pushed = crease(stretch.0, &normals);
        for (wall, push) in pushed.walls().zip([2.0, 3.0, 0.5]) {
            assert!((wall.push - push).abs() < 1e-13, "{wall:?}");
        }
    }
}
