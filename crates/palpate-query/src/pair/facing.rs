// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The normal between two bodies: along both gradients, or along that of a face at which the other
//! body has an edge.

use palpate_field::{Point, Vector};

use super::body_pair::BodyPair;
use crate::sampler::normal;

/// The cosine from which on gradients count as opposite, 0.8°.
const OPPOSITE: f64 = 0.9999;

/// The cosine from which on the gradients of a face count as one, 8°.
const ALIKE: f64 = 0.99;

/// The cosine below which a gradient has turned as at an edge, 26°.
const TURNED: f64 = 0.9;

/// How far around a point a body is asked for edges, as a share of the smaller body; four times the
/// gap where that is more.
const AROUND: f64 = 1e-4;

/// A face of one body at which the other has an edge or a corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face<const D: usize> {
    /// The body that has the face.
    pub(crate) body: usize,
    /// The unit vector from the first body to the second.
    pub(crate) normal: Vector<f64, D>,
}

impl<const D: usize> BodyPair<'_, D> {
    /// The normal at a point between the bodies, and the values of both there [m]. `None` where the
    /// gradients of both are equal or vanish.
    pub(crate) fn normal(&mut self, p: Point<D>) -> (Option<Vector<f64, D>>, [f64; 2]) {
        let slopes = self.slopes(p);
        let [(a, slope_a), (b, slope_b)] = slopes;
        let face = self.face(p, slopes).map(|face| face.normal);
        (face.or_else(|| normal(slope_a - slope_b)), [a, b])
    }

    /// The face at a point with these slopes, if one of the bodies alone has an edge there: at an
    /// edge the gradient may point along the normal of either adjacent face.
    pub(crate) fn face(
        &mut self,
        p: Point<D>,
        [(a, slope_a), (b, slope_b)]: [(f64, Vector<f64, D>); 2],
    ) -> Option<Face<D>> {
        let units = [normal(slope_a)?, normal(slope_b)?];
        if units[0].dot(units[1]) < -OPPOSITE {
            return None;
        }
        let far = (8.0 * a.max(b).abs()).max(AROUND * self.smaller_size());
        let mut least = [1.0_f64; 2];
        for k in 0..D {
            for side in [-far, far] {
                let around = self.slopes(p + Vector::unit(k) * side);
                for body in 0..2 {
                    let cosine = normal(around[body].1).map_or(-1.0, |u| u.dot(units[body]));
                    least[body] = least[body].min(cosine);
                }
            }
        }
        let is_face = |body: usize| least[body] > ALIKE && least[1 - body] < TURNED;
        match [is_face(0), is_face(1)] {
            [true, _] => Some(Face { body: 0, normal: units[0] }),
            [_, true] => Some(Face { body: 1, normal: -units[1] }),
            _ => None,
        }
    }
}
