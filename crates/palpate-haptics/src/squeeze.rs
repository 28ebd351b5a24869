// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The force of bodies that closed on a proxy and left it no room.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::crease::{Crease, Wall};
use crate::nearby::{Nearby, Punctured, Yielding};

/// What a squeezed hand presses against.
#[derive(Clone, Copy)]
pub(crate) struct Against {
    /// The device point [m].
    pub(crate) device: Point<3>,
    /// The probe's radius [m].
    pub(crate) radius: f64,
    /// The force of the bodies that stand still [N].
    pub(crate) wanted: Vector<f64, 3>,
}

/// The bodies that a proxy lies in, because they moved and left it no room.
///
/// Each gives the force of its springs at its own depth at the device point, `r − f`, along its
/// gradient there, and at most what the bodies that stand still give against it. Their sum never
/// pushes the hand into the bodies that stand still.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Squeeze {
    /// The first of the bodies; `None` if the proxy has room.
    body: Option<u32>,
    /// Those that push.
    walls: Crease,
    /// Twice the energy in their springs [J].
    stored: f64,
}

impl Squeeze {
    pub(crate) const NONE: Self = Self { body: None, walls: Crease::NONE, stored: 0.0 };

    /// A squeeze by a body; `None` if there is room.
    pub(crate) fn by(body: Option<u32>) -> Self {
        Self { body, ..Self::NONE }
    }

    /// The first of the bodies; `None` if the proxy has room.
    pub(crate) fn body(&self) -> Option<u32> {
        self.body
    }

    /// The bodies that push.
    pub(crate) fn walls(&self) -> impl Iterator<Item = &Wall> + Clone {
        self.walls.walls()
    }

    /// Twice the energy in the springs of the bodies that push [J].
    pub(crate) fn stored(&self) -> f64 {
        self.stored
    }

    /// The sum of the forces [N].
    pub(crate) fn force(&self) -> Vector<f64, 3> {
        self.walls().fold(Vector::ZERO, |sum, wall| sum + wall.force)
    }

    /// Sets the forces of this tick. Each evaluation adds to `evaluations`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn press(
        &mut self,
        everything: &Nearby<'_>,
        yielding: &Yielding,
        against: &Against,
        evaluations: &mut u32,
    ) {
        let &Against { device, radius, wanted } = against;
        (self.walls, self.stored) = (Crease::NONE, 0.0);
        let Some(along) = wanted.normalized() else { return };
        let most = |body| yielding.bodies().any(|it| it == body).then_some(radius);
        for seen in everything.each_within(device, &Punctured::default(), most) {
            *evaluations += 1;
            let depth = radius - seen.distance;
            let body = everything.body(seen.body);
            let Some((normal, body)) = seen.gradient.normalized().zip(body) else { continue };
            let resisted = -wanted.dot(normal);
            // Written so that NaN does not push.
            if depth > 0.0 && resisted > 0.0 {
                let strata = &body.surface().strata;
                let pushed = strata.force(0, depth).min(resisted);
                let force = normal * pushed;
                self.walls.add_pushing(Wall { body: seen.body, normal, push: depth, force });
                self.stored += pushed * pushed / strata.secant(0, depth);
            }
        }
        let back = -self.force().dot(along);
        let most = wanted.norm();
        if back > most {
            self.walls.scale_forces(most / back);
        }
    }
}
