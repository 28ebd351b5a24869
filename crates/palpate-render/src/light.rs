// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The lights of a picture, and what a surface sends back of them.
//!
//! One key light, far away, from above and the viewer's left; a fill from the whole sky, less from
//! below; a faint light at the camera. A surface is matt (Lambert) with a weak gloss (Blinn 1977).
//! Light is added as light, and written as sRGB without any other curve.

use palpate_field::Vector;

use crate::camera::Sight;
use crate::color::Light;

/// The amounts of light that a white surface sends back: of the key light where it faces that, of
/// the fill where it faces up and nothing is near, of the light at the camera where it faces that.
/// Together they are little more than one, so that few places are brighter than a file holds.
const KEY: f64 = 0.70;
const FILL: f64 = 0.36;
const AT_CAMERA: f64 = 0.10;

/// The fill that a surface facing down gets, as a share of that facing up.
const FROM_BELOW: f64 = 0.45;

/// The gloss: its amount, and how narrow it is.
const GLOSS: f64 = 0.10;
const NARROWNESS: f64 = 36.0;

/// A place that light falls on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    /// The unit normal.
    pub(crate) normal: Vector<f64, 3>,
    /// The unit vector towards the viewer.
    pub(crate) view: Vector<f64, 3>,
    /// The visible share of the key light.
    pub(crate) key: f64,
    /// The open share of the sky.
    pub(crate) open: f64,
}

/// The unit vector towards the key light: from above, in front and left of what the viewer sees,
/// whether from the side or from above.
pub(crate) fn key_direction(sight: &Sight) -> Vector<f64, 3> {
    let (right, back) = (sight.right(), sight.back());
    let y = Vector::unit(1);
    let level = (back - y * back[1]).normalized().unwrap_or(-sight.up());
    // Seen from below, the light is below too.
    let above = if back[1] < -0.5 { -y } else { y };
    let direction = above * 1.0 + level * 0.62 - right * 0.62;
    direction.normalized().unwrap_or(y)
}

impl Lit {
    /// The light that a surface of this colour sends to the viewer.
    pub(crate) fn sent(&self, color: Light, towards_key: Vector<f64, 3>) -> Light {
        let Self { normal, view, key, open } = *self;
        let halfway = (towards_key + view).normalized().unwrap_or(normal);
        let gloss = libm::pow(normal.dot(halfway).max(0.0), NARROWNESS);
        color * self.matt(towards_key) + Light::white(GLOSS * key * gloss * open)
    }

    /// The same as a share of what a white surface sends at most.
    fn matt(&self, towards_key: Vector<f64, 3>) -> f64 {
        let Self { normal, view, key, open } = *self;
        let sky = FROM_BELOW + (1.0 - FROM_BELOW) * 0.5 * (1.0 + normal[1]);
        KEY * key * normal.dot(towards_key).max(0.0)
            + open * (FILL * sky + AT_CAMERA * normal.dot(view).max(0.0))
    }

    /// The share of light on a place, compared with the same place without any body near.
    pub(crate) fn share(&self, towards_key: Vector<f64, 3>) -> f64 {
        let free = Self { key: 1.0, open: 1.0, ..*self };
        self.matt(towards_key) / free.matt(towards_key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_without_bodies_near_has_all_its_light() {
        let normal = Vector::unit(1);
        let key = Vector([0.6, 0.8, 0.0]);
        let lit = Lit { normal, view: normal, key: 1.0, open: 1.0 };
        assert_eq!(lit.share(key), 1.0);
        let dark = Lit { key: 0.0, ..lit };
        assert!((dark.share(key) - 0.46 / (0.46 + 0.8 * 0.7)).abs() < 1e-15);
    }

    #[test]
    fn the_key_light_is_above_and_to_the_left() {
        for elevation in [-0.3, 0.0, 0.7, 1.5, std::f64::consts::FRAC_PI_2] {
            let sight = Sight::from_angles(0.4, elevation).unwrap();
            let key = key_direction(&sight);
            assert!(key[1] > 0.5 && key.dot(sight.right()) < -0.4, "{elevation} {key:?}");
            assert!(key.dot(sight.back()) > 0.2, "{elevation} {key:?}");
        }
    }
}
