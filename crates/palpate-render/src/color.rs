// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Colours: as files hold them, and as light that can be added.

use std::ops::{Add, AddAssign, Mul};

/// A colour of sRGB (IEC 61966-2-1): red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SrgbColor(pub [u8; 3]);

impl SrgbColor {
    /// The colours of bodies, in their order; a thirteenth body has the first again.
    ///
    /// The first eight are those of Okabe and Ito ("Color Universal Design", 2008), ordered so that
    /// neighbours differ most, and lightened where shading would make them black. The last four lie
    /// between their hues, and differ in lightness too.
    pub const BODIES: [Self; 12] = [
        Self([0x4A, 0x9B, 0xD4]),
        Self([0xE8, 0xA3, 0x1E]),
        Self([0x1F, 0xA5, 0x7E]),
        Self([0xD0, 0x80, 0xAC]),
        Self([0xEE, 0xE0, 0x5C]),
        Self([0xDC, 0x67, 0x2A]),
        Self([0x33, 0x62, 0xA8]),
        Self([0xA4, 0xA7, 0xAB]),
        Self([0x7A, 0x4F, 0x9E]),
        Self([0x9C, 0xC9, 0x5A]),
        Self([0x8F, 0x5B, 0x3A]),
        Self([0x6F, 0xD0, 0xD2]),
    ];

    /// What lies behind the bodies.
    pub const BACKGROUND: Self = Self([0xF5, 0xF6, 0xF8]);

    /// A point that the budget left undecided.
    pub const UNDECIDED: Self = Self([0xFF, 0x00, 0xFF]);

    /// The colour of body number `index`.
    #[must_use]
    pub fn of_body(index: usize) -> Self {
        Self::BODIES[index % Self::BODIES.len()]
    }

    /// The colour as light.
    pub(crate) fn light(self) -> Light {
        Light(self.0.map(|c| decoded(f64::from(c) / 255.0)))
    }
}

/// An amount of red, green and blue light; 1 is the brightest that a file holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Light(pub(crate) [f64; 3]);

impl Light {
    pub(crate) const NONE: Self = Self([0.0; 3]);

    /// The light of `self` for a share of 0, of `other` for 1.
    pub(crate) fn mixed(self, other: Self, share: f64) -> Self {
        self * (1.0 - share) + other * share
    }

    /// The same amount of every colour.
    pub(crate) fn white(amount: f64) -> Self {
        Self([amount; 3])
    }

    /// The colour; light brighter than a file holds is as bright as it holds.
    pub(crate) fn color(self) -> SrgbColor {
        SrgbColor(self.encoded().map(|c| (255.0 * c).round() as u8))
    }

    /// The numbers of sRGB, from 0 to 1.
    pub(crate) fn encoded(self) -> [f64; 3] {
        self.0.map(|c| encoded(c.clamp(0.0, 1.0)))
    }
}

impl Add for Light {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl AddAssign for Light {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Light {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

/// The transfer of sRGB; `libm` gives the same bits on every system.
fn encoded(c: f64) -> f64 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * libm::pow(c, 1.0 / 2.4) - 0.055 }
}

fn decoded(c: f64) -> f64 {
    if c <= 0.040_45 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_is_light_and_back() {
        for c in 0..=255 {
            let color = SrgbColor([c, 255 - c, c / 2]);
            assert_eq!(color.light().color(), color);
        }
        assert_eq!(Light([2.0, -1.0, 0.0]).color(), SrgbColor([255, 0, 0]));
    }
}
