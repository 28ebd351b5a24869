// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Seams: where the level surfaces of two bodies meet, one stiffness blends into the other.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::bodies::Body;
use crate::crease::Place;
use crate::nearby::{Nearby, Punctured};

/// The most sideways force of a seam under the largest force of the hand, as a part of the normal
/// force: less is felt as a change of stiffness, more as a step.
const SIDEWAYS: f64 = 0.2;

/// The steepest slope of [`share`].
const STEEPEST: f64 = 0.75;

/// A seam that stiffness alone makes wide reaches this far into the smaller body, as a part of the
/// radius of its bounding ball: its middle keeps its own stiffness.
const INTO: f64 = 0.5;

/// Surfaces are level if they meet to this part of the probe's radius and of the seam's length: at
/// a higher step the probe has two contacts, and each body pushes with its own stiffness.
const LEVEL_OF_PROBE: f64 = 0.05;
const LEVEL_OF_LENGTH: f64 = 0.01;

/// The least part of a way to a seam that is along the surface: a body below another is no
/// neighbour.
const ALONG: f64 = 0.5;

/// What bodies beside the touched one change of its force.
///
/// The potential of the springs is `U = Σ sᵢ Uᵢ(d)`, with the depth `d`, the energy `Uᵢ` that the
/// springs of body i store there, and the shares `sᵢ` of the bodies at the surface below the proxy,
/// whose sum is 1. The force is its downhill slope: `Σ sᵢ Nᵢ` along the stretch, with `Nᵢ = Uᵢ'`,
/// and `−Σ Uᵢ ∇sᵢ` along the surface. For springs of stiffness `Kᵢ` these are `K d` and `−½ d² ∇K`,
/// with `K = Σ sᵢ Kᵢ`. On flat surfaces a closed path thus gives no energy.
///
/// Two bodies whose seam is at the distance `x` have the shares `1 − b(x/ℓ)` and `b(x/ℓ)`, with
/// [`share`] for `b` and the [length](length) `ℓ` of the seam. With more bodies, the weight of each
/// against the touched one is that of the two alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seam {
    /// What the springs push more along the stretch [N].
    pub(crate) springs: f64,
    /// The force along the surface [N].
    pub(crate) sideways: Vector<f64, 3>,
}

/// The share of a body whose seam is `part` of the seam's length away, and its slope: from a half
/// at the seam to none, as a cubic curve without kinks.
fn share(part: f64) -> (f64, f64) {
    let squared = part * part;
    (0.5 - 0.25 * part * (3.0 - squared), -STEEPEST * (1.0 - squared))
}

/// How far a seam reaches into each of two bodies [m]: the probe's radius at least, and so far that
/// the sideways force `½ K' d²` is at most [`SIDEWAYS`] of `K d` at the depth `d` where the stiffer
/// body gives the largest force, but no farther than [`INTO`] the smaller body; more if a material asks
/// for it.
fn length(pair: [&Body; 2], radius: f64, most_force: f64) -> f64 {
    let [a, b] = pair.map(|body| body.surface().strata.stiffness());
    let stiffer = a.max(b);
    // K' is at most STEEPEST |a − b| / length.
    let gentle = 0.5 * STEEPEST / SIDEWAYS * most_force * (a - b).abs() / (stiffer * stiffer);
    let smaller = pair.iter().filter_map(|body| body.ball).map(|ball| ball.radius);
    let room = INTO * smaller.fold(f64::INFINITY, f64::min);
    let own = gentle.min(room).max(radius);
    let asked = pair.iter().filter_map(|body| body.surface().seam);
    // Without bounds, for body and force, only the probe's radius is known.
    asked.fold(if own.is_finite() { own } else { radius }, f64::max)
}

/// A neighbour of the touched body.
struct Neighbour {
    /// How far the seam is away [m].
    distance: f64,
    /// The unit vector along the surface away from the seam.
    away: Vector<f64, 3>,
    /// Whether its surface is level with the touched one: 1, less, or 0.
    level: f64,
}

impl Neighbour {
    /// A body beside the touched one, as seen from the `foot` of the proxy on the surface.
    fn seen(body: &Body, foot: Point<3>, place: &Place, length: f64) -> Option<Self> {
        let Place { normal, radius, .. } = *place;
        let level = LEVEL_OF_PROBE * radius + LEVEL_OF_LENGTH * length;
        // Just below the surface, the way to the neighbour is the way to its side.
        let below = foot - normal * level;
        let (distance, way) = body.distance_gradient(below);
        let way = way.normalized()?;
        let along = way - normal * way.dot(normal);
        // From above, the nearest point of a level neighbour is its rim; that of a wall is higher.
        let above = foot + normal * length;
        let (height, up) = body.distance_gradient(above);
        let rim = above - up.normalized()? * height;
        let side = below - way * distance + normal * level;
        let off = (rim - side).norm() + (rim - foot).dot(normal).abs();
        let (part, _) = share((off / level - 1.0).clamp(0.0, 1.0));
        let is_beside = along.norm() >= ALONG && distance < length && part > 0.0;
        let away = along.normalized()?;
        is_beside.then_some(Self { distance: distance.max(0.0), away, level: 2.0 * part })
    }
}

/// The neighbours of the touched body at `place` that have other springs, each with the length of
/// its seam [m]. Each evaluation adds to `evaluations`.
fn beside<'a>(
    nearby: &'a Nearby<'_>,
    place: &'a Place,
    punctured: &'a Punctured,
    most_force: f64,
    evaluations: &'a mut u32,
) -> impl Iterator<Item = (&'a Body, Neighbour, f64)> {
    let foot = place.proxy - place.normal * place.radius;
    let touched = nearby.body(place.body);
    nearby.all().filter_map(move |(index, body)| {
        let touched = touched?;
        let own = &touched.surface().strata;
        let has_own_springs = body.surface().strata.has_springs_of(own);
        if index == place.body || has_own_springs || punctured.level(index) > 0 {
            return None;
        }
        let length = length([touched, body], place.radius, most_force);
        // Written so that NaN is no seam.
        let is_near = body.above_ball(foot) < length;
        if !is_near {
            return None;
        }
        *evaluations += 2;
        let seen = Neighbour::seen(body, foot, place, length)?;
        Some((body, seen, length))
    })
}

/// The mean of a number of the touched body and of its neighbours, each with the weight of its share
/// at `place`. Each evaluation adds to `evaluations`.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn blended(
    nearby: &Nearby<'_>,
    place: &Place,
    most_force: f64,
    evaluations: &mut u32,
    of: impl Fn(&Body) -> f64,
) -> f64 {
    let own = nearby.body(place.body).map_or(0.0, &of);
    let (mut whole, mut more) = (1.0, 0.0);
    let none = Punctured::default();
    for (body, seen, length) in beside(nearby, place, &none, most_force, evaluations) {
        let (share, _) = share(seen.distance / length);
        let weight = seen.level * share / (1.0 - share);
        whole += weight;
        more += weight * (of(body) - own);
    }
    own + more / whole
}

impl Seam {
    /// The seam at `place`, where the hand feels at most `most_force` [N]; `None` if all bodies near
    /// have the same springs. Each evaluation adds to `evaluations`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn at(
        nearby: &Nearby<'_>,
        place: &Place,
        punctured: &Punctured,
        most_force: f64,
        evaluations: &mut u32,
    ) -> Option<Self> {
        let touched = nearby.body(place.body)?;
        let own = &touched.surface().strata;
        if punctured.level(place.body) > 0 {
            return None;
        }
        let depth = place.stretch.norm();
        let (force, energy) = (own.force(0, depth), own.energy(depth));
        // Sums over the neighbours of weights w = b / (1 − b), with the touched body's weight of 1.
        let (mut whole, mut springs, mut energies) = (1.0, 0.0, 0.0);
        let (mut slope, mut sideways) = (Vector::ZERO, Vector::ZERO);
        for (body, seen, length) in beside(nearby, place, punctured, most_force, evaluations) {
            let strata = &body.surface().strata;
            let (share, steepness) = share(seen.distance / length);
            let weight = seen.level * share / (1.0 - share);
            let steepness = seen.level * steepness / (length * (1.0 - share) * (1.0 - share));
            let stored = strata.energy(depth) - energy;
            whole += weight;
            springs += weight * (strata.force(0, depth) - force);
            energies += weight * stored;
            slope += seen.away * steepness;
            sideways += seen.away * (steepness * stored);
        }
        let per_whole = 1.0 / whole;
        (whole > 1.0).then(|| Self {
            springs: springs * per_whole,
            sideways: (slope * (energies * per_whole) - sideways) * per_whole,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Surface;
    use palpate_field::Shape;

    #[test]
    fn the_share_falls_from_a_half_to_none() {
        assert_eq!([0.0, 0.5, 1.0].map(|part| share(part).0), [0.5, 0.15625, 0.0]);
        for step in 0..100 {
            let part = 0.01 * f64::from(step);
            let slope = (share(part + 1e-6).0 - share(part).0) / 1e-6;
            assert!((slope - share(part).1).abs() < 1e-5, "{part}");
        }
    }

    #[test]
    fn a_seam_is_as_long_as_its_sideways_force_needs() {
        let plate = |stiffness| {
            Body::new(Shape::sphere(0.05).unwrap(), Surface::smooth(stiffness, 0.0).unwrap())
                .unwrap()
        };
        let (foam, steel) = (plate(120.0), plate(1000.0));
        let of = |force| length([&foam, &steel], 0.002, force);
        // 0.75 · 880 / ℓ is 2 · 0.2 · K² / F.
        assert!((of(7.9) - 0.75 * 880.0 * 7.9 / (0.4 * 1e6)).abs() < 1e-15);
        assert_eq!(of(7.9), length([&steel, &foam], 0.002, 7.9));
        // The probe at least, half of a body at most.
        assert_eq!([of(0.1), of(100.0), of(f64::INFINITY)], [0.002, 0.025, 0.025]);
    }
}
