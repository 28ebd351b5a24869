// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Friction: a proxy that is held back on its way along a surface.
//!
//! Let `N` be the depth of the device below the surface and `t` the tangential part of the
//! stretch from device to proxy. The force lies in Coulomb's friction cone if `‖t‖ ≤ μN`. A
//! proxy within the cone of static friction sticks: it does not move at all, so friction never
//! creeps. Beyond the cone, the proxy slips to where `‖t‖ = μ_d N`, the point where a proxy
//! without friction would rest if the device were `μ_d N` closer to the old place of the proxy.
//! Slipping is therefore a [slide](crate::contact::slide) towards a shifted device point, and
//! crosses no surface. The friction cone is that of Harwin and Melder, "Improved haptic
//! rendering for multi-finger manipulation using friction cone based god-objects" (2002).

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::contact::{Goal, LocalSurface, Place, slide};
use crate::sampler::Sampler;
use crate::surface::Friction;

/// The most of the stretch that lies along the surface when a single wall holds the proxy. A
/// larger part means a crease, where the depth below one wall is not the normal force.
const ONE_WALL: f64 = 1e-3;

/// A proxy that moves towards a wall by more than this part of its displacement was not at the
/// wall before. Along a curved crease the part is smaller.
const BESIDE: f64 = 0.05;

/// How a surface holds a proxy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) enum Hold {
    /// No contact, or no friction.
    #[default]
    None,
    /// The proxy does not move along the surface.
    Stick,
    /// The proxy moves along the surface against friction.
    Slip,
}

/// The friction of the surface that holds a proxy, and its effect in the tick before.
#[derive(Clone, Copy)]
pub(crate) struct Held {
    pub(crate) friction: Friction,
    pub(crate) hold: Hold,
}

/// What became of a dragged proxy.
#[derive(Clone, Copy)]
pub(crate) struct Dragged {
    /// Whether the surface keeps the proxy from the device.
    pub(crate) contact: bool,
    pub(crate) hold: Hold,
    /// The part of the stretch from device to proxy that friction holds [m]; `None` if static
    /// friction leaves it open, because the proxy sticks or several walls hold it.
    pub(crate) held: Option<Vector<f64, 3>>,
}

/// [Slides](slide) the proxy from `here` towards the point closest to `device`, as far as
/// `friction` permits; `device` moved by `motion` [m] in this tick.
///
/// Real-time: allocates nothing, takes no lock, cannot panic; at most the sampler's budget of
/// evaluations.
pub(crate) fn drag(
    sampler: &mut Sampler<'_>,
    place: Place<'_>,
    goal: Goal,
    held: Held,
    local: &mut LocalSurface,
) -> Dragged {
    let Place { here, normal } = place;
    let Goal { device, motion } = goal;
    let Held { friction, hold } = held;
    if here.tangent.is_none() || friction.fixed <= 0.0 {
        let contact = slide(sampler, Place { here, normal }, goal, local);
        return Dragged { contact, hold: Hold::None, held: Some(Vector::ZERO) };
    }
    let start = *here;
    let (first_normal, gap) = sampler.tangent(&start, *normal);
    let stretch = start.point - device;
    let height = stretch.dot(first_normal);
    let depth = height - gap;
    *normal = first_normal;
    if depth <= 0.0 || gap > sampler.near() {
        let contact = slide(sampler, Place { here, normal }, goal, local);
        return Dragged { contact, hold: Hold::None, held: Some(Vector::ZERO) };
    }
    let stuck = Dragged { contact: true, hold: Hold::Stick, held: None };
    let most = if hold == Hold::Slip { friction.slipping } else { friction.fixed };
    let Some(goal) =
        held_back(device, stretch - first_normal * height, depth, most, friction.slipping)
    else {
        return stuck;
    };
    let slipped = |contact| Dragged { contact, hold: Hold::Slip, held: Some(goal - device) };
    let contact = slide(sampler, Place { here, normal }, Goal { device: goal, motion }, local);
    let pull = here.point - goal;
    let along = pull - *normal * pull.dot(*normal);
    if !contact || along.dot(along) <= ONE_WALL * ONE_WALL * pull.dot(pull) {
        return slipped(contact);
    }
    // A crease. A proxy that was in the crease may stick; one that was beside it, on one wall,
    // slid in.
    let Some(across) = along.normalized() else { return slipped(contact) };
    let way = start.point - here.point;
    let beside = way.dot(*normal).max(way.dot(across));
    if beside > sampler.tolerance().max(BESIDE * way.norm()) {
        return slipped(contact);
    }
    // The walls together press with the part of the stretch across the crease.
    let pressed = *normal * stretch.dot(*normal) + across * stretch.dot(across);
    match held_back(device, stretch - pressed, pressed.norm(), most, friction.slipping) {
        None => {
            (*here, *normal) = (start, first_normal);
            stuck
        }
        Some(goal) => {
            let way = Goal { device: goal, motion };
            let contact = slide(sampler, Place { here, normal }, way, local);
            Dragged { contact, hold: Hold::Slip, held: None }
        }
    }
}

/// The device point shifted by friction towards the proxy's old place; `along` is the
/// displacement along the surface without friction. `None` if `most` times the depth is enough
/// to hold the proxy.
fn held_back(
    device: Point<3>,
    along: Vector<f64, 3>,
    depth: f64,
    most: f64,
    slipping: f64,
) -> Option<Point<3>> {
    let squared = along.dot(along);
    // Written so that NaN sticks.
    let is_loose = squared > most * most * depth * depth;
    is_loose.then(|| device + along * (slipping * depth / squared.sqrt()))
}
