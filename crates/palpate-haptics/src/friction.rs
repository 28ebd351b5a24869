// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Friction: a proxy that is held back on its way along a surface.
//!
//! With the depth `N` of the device below the surface and the tangential part `t` of the
//! stretch from device to proxy, the force is in the cone of Coulomb where `‖t‖ ≤ μN`. A
//! proxy within the cone of static friction sticks: it does not move at all, so friction
//! never creeps. Beyond it, it slips to where `‖t‖ = μ_d N`: to the point that a proxy without
//! friction would rest at if the device were `μ_d N` closer to where the proxy was. So slipping
//! is a [slide](crate::contact::slide) of its own and crosses no more than one. The cone is
//! that of Harwin and Melder, "Improved haptic rendering for multi-finger manipulation using
//! friction cone based god-objects" (2002).

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::contact::{Ground, slide};
use crate::sampler::{Sample, Sampler};
use crate::surface::Friction;

/// Part of the stretch that lies along the surface where one wall alone holds the proxy. More
/// of it tells of a crease, of which one wall does not know how hard it is pressed.
const ONE_WALL: f64 = 1e-3;

/// Part of its way that a proxy goes towards a wall if it was not there before: along a crease
/// that bends it goes by less.
const BESIDE: f64 = 0.05;

/// How a surface holds a proxy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) enum Hold {
    /// It is not in the way, or has no friction.
    #[default]
    None,
    /// The proxy does not move along it.
    Stick,
    /// It slows the proxy down.
    Slip,
}

/// [Slides](slide) from `here`, where the proxy was held, as far as `friction` lets it, to the
/// point closest to `device`, which moved by `motion` [m] in this tick. Whether the surface keeps
/// it from the device, and how.
///
/// Real-time: allocates nothing, takes no lock, cannot panic; at most the sampler's budget of
/// evaluations.
pub(crate) fn drag<const D: usize>(
    sampler: &mut Sampler<'_, D>,
    (here, normal): (&mut Sample<D>, &mut Vector<f64, D>),
    (device, motion): (Point<D>, f64),
    (friction, hold): (Friction, Hold),
    ground: &mut Ground<D>,
) -> (bool, Hold) {
    if here.tangent.is_none() || friction.fixed <= 0.0 {
        return (slide(sampler, (here, normal), (device, motion), ground), Hold::None);
    }
    let start = *here;
    let (first_normal, gap) = sampler.tangent(&start, *normal);
    let stretch = start.point - device;
    let height = stretch.dot(first_normal);
    let depth = height - gap;
    *normal = first_normal;
    if depth <= 0.0 || gap > sampler.near() {
        return (slide(sampler, (here, normal), (device, motion), ground), Hold::None);
    }
    let most = if hold == Hold::Slip { friction.slipping } else { friction.fixed };
    let Some(goal) =
        held_back(device, stretch - first_normal * height, depth, (most, friction.slipping))
    else {
        return (true, Hold::Stick);
    };
    let contact = slide(sampler, (here, normal), (goal, motion), ground);
    let pull = here.point - goal;
    let along = pull - *normal * pull.dot(*normal);
    if !contact || along.dot(along) <= ONE_WALL * ONE_WALL * pull.dot(pull) {
        return (contact, Hold::Slip);
    }
    // A crease. It holds a proxy that was in it; one that was beside it, on one wall, slid in.
    let Some(across) = along.normalized() else { return (contact, Hold::Slip) };
    let way = start.point - here.point;
    let beside = way.dot(*normal).max(way.dot(across));
    if beside > sampler.tolerance().max(BESIDE * way.norm()) {
        return (contact, Hold::Slip);
    }
    // All its walls together press with the part of the stretch across it.
    let pressed = *normal * stretch.dot(*normal) + across * stretch.dot(across);
    match held_back(device, stretch - pressed, pressed.norm(), (most, friction.slipping)) {
        None => {
            (*here, *normal) = (start, first_normal);
            (true, Hold::Stick)
        }
        Some(goal) => (slide(sampler, (here, normal), (goal, motion), ground), Hold::Slip),
    }
}

/// The device moved towards where the proxy was, `along` the surface from where it would be
/// without friction; none if `most` times the depth holds the proxy there.
fn held_back<const D: usize>(
    device: Point<D>,
    along: Vector<f64, D>,
    depth: f64,
    (most, slipping): (f64, f64),
) -> Option<Point<D>> {
    let squared = along.dot(along);
    // Written so that NaN is held.
    let is_loose = squared > most * most * depth * depth;
    is_loose.then(|| device + along * (slipping * depth / squared.sqrt()))
}
