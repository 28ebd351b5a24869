// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Which bodies are near each other.

use palpate_field::Aabb;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::Body;

/// A body's box and its number.
type Boxed<const D: usize> = GeomWithData<Rectangle<[f64; D]>, usize>;

/// The pairs of bodies of which one has moved and whose boxes meet, each with the lower
/// number first. A body without bounds is near all.
pub(super) fn pairs_near<const D: usize>(bodies: &[Option<Body<D>>]) -> Vec<[usize; 2]> {
    let present = || bodies.iter().enumerate().filter_map(|(i, b)| Some((i, b.as_ref()?)));
    let boxed =
        present().filter_map(|(i, body)| Some(GeomWithData::new(rectangle(&body.aabb?), i)));
    let tree: RTree<Boxed<D>> = RTree::bulk_load(boxed.collect());
    let mut pairs = Vec::new();
    for (i, body) in present().filter(|(_, body)| body.has_moved) {
        let mut meet = |k: usize| {
            // Two that have both moved meet twice: once is enough.
            let is_first = bodies[k].as_ref().is_some_and(|other| !other.has_moved || i < k);
            if k != i && is_first {
                pairs.push([i.min(k), i.max(k)]);
            }
        };
        match &body.aabb {
            Some(aabb) => {
                let place = AABB::from_corners(aabb.min.0, aabb.max.0);
                let others = tree.locate_in_envelope_intersecting(place);
                others.for_each(|other| meet(other.data));
                present().filter(|(_, other)| other.aabb.is_none()).for_each(|(k, _)| meet(k));
            }
            None => present().for_each(|(k, _)| meet(k)),
        }
    }
    pairs
}

fn rectangle<const D: usize>(aabb: &Aabb<D>) -> Rectangle<[f64; D]> {
    Rectangle::from_corners(aabb.min.0, aabb.max.0)
}
