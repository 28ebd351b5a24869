// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Colours that colour-blind readers, grey printers and projectors keep apart.
//!
//! Blue is inside, orange is outside: the pair differs under every common colour deficiency.
//! Lightness grows with the value of the field, from deep inside to far outside, so the bands
//! keep their order in grey. Overlays use the other hues of Okabe and Ito ("Color Universal
//! Design", 2008), darkened to stand out on the bands, and differ in dash as well as in hue.

/// An sRGB colour.
///
/// # Examples
///
/// ```
/// use palpate_plot::Color;
///
/// assert_eq!(Color::rgb(0x0B, 0x7A, 0x5E).hex(), "#0b7a5e");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color {
    pub(crate) red: u8,
    pub(crate) green: u8,
    pub(crate) blue: u8,
}

impl Color {
    /// Near-black: the surface, and text.
    pub const INK: Self = Self::rgb(0x17, 0x1A, 0x1F);
    /// Bluish green: first overlay.
    pub const GREEN: Self = Self::rgb(0x00, 0x73, 0x55);
    /// Reddish purple: second overlay.
    pub const PURPLE: Self = Self::rgb(0x9E, 0x2F, 0x78);
    /// Vermilion: third overlay.
    pub const VERMILION: Self = Self::rgb(0xC4, 0x3C, 0x00);
    /// Navy: fourth overlay.
    pub const NAVY: Self = Self::rgb(0x12, 0x3C, 0x7A);

    pub(crate) const WHITE: Self = Self::rgb(0xFF, 0xFF, 0xFF);
    pub(crate) const MUTED: Self = Self::rgb(0x59, 0x5F, 0x69);
    pub(crate) const RULE: Self = Self::rgb(0xE3, 0xE6, 0xEA);

    /// The colour with these sRGB components.
    #[must_use]
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// As `#rrggbb`.
    #[must_use]
    pub fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)
    }

    /// The colour of overlay or series number `index`, if none is given.
    pub(crate) fn of_series(index: usize) -> Self {
        [Self::GREEN, Self::PURPLE, Self::VERMILION, Self::NAVY, Self::INK][index % 5]
    }

    /// The colour of body or contact point number `number`: twelve that are told apart, which
    /// repeat.
    ///
    /// ```
    /// use palpate_plot::Color;
    ///
    /// assert_ne!(Color::numbered(3), Color::numbered(9));
    /// assert_eq!(Color::numbered(12), Color::numbered(0));
    /// ```
    #[must_use]
    pub fn numbered(number: usize) -> Self {
        NUMBERED[number % NUMBERED.len()]
    }

    /// `self` for `t` = 0, `other` for `t` = 1, with perceptually even steps between.
    pub(crate) fn mix(self, other: Self, t: f64) -> Self {
        let (a, b) = (self.to_oklab(), other.to_oklab());
        Self::from_oklab([0, 1, 2].map(|i| a[i] + t * (b[i] - a[i])))
    }

    /// `self` below a layer of `other` with an `opacity` from 0 (invisible) to 1, as renderers
    /// compose them.
    pub(crate) fn below(self, other: Self, opacity: f64) -> Self {
        let part = |below: u8, above: u8| {
            let (below, above) = (f64::from(below), f64::from(above));
            (below + opacity * (above - below)).round() as u8
        };
        Self::rgb(
            part(self.red, other.red),
            part(self.green, other.green),
            part(self.blue, other.blue),
        )
    }

    /// Perceived lightness, from 0 (black) to 1 (white).
    fn with_lightness_added(self, lightness: f64) -> Self {
        let [l, a, b] = self.to_oklab();
        Self::from_oklab([(l + lightness).clamp(0.0, 1.0), a, b])
    }

    /// Björn Ottosson, "A perceptual color space for image processing" (2020).
    pub(crate) fn to_oklab(self) -> [f64; 3] {
        let [r, g, b] = [self.red, self.green, self.blue].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
        let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
        let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
        [
            0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
        ]
    }

    pub(crate) fn from_oklab([lightness, a, b]: [f64; 3]) -> Self {
        let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
        let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
        let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
        let [red, green, blue] = [
            4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
            -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
            -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
        ]
        .map(|c| {
            let c = c.clamp(0.0, 1.0);
            let c =
                if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
            (255.0 * c).round() as u8
        });
        Self { red, green, blue }
    }
}

/// Colours far from each other, from ink and from the bands outside.
const NUMBERED: [Color; 12] = [
    Color::rgb(0x1B, 0x5F, 0xB0), // blue
    Color::rgb(0xA8, 0x2A, 0x1A), // brick
    Color::rgb(0x1A, 0x7D, 0x3C), // green
    Color::rgb(0x74, 0x3A, 0xA6), // violet
    Color::rgb(0x00, 0xA0, 0xA8), // teal
    Color::rgb(0xD6, 0x3C, 0x8C), // pink
    Color::rgb(0x8C, 0x80, 0x00), // olive
    Color::rgb(0x14, 0x14, 0x6E), // navy
    Color::rgb(0x6B, 0x44, 0x20), // brown
    Color::rgb(0x5C, 0xB8, 0xF0), // sky
    Color::rgb(0x83, 0x88, 0x8F), // grey
    Color::rgb(0x6A, 0x0A, 0x48), // plum
];

/// The side of the surface a band lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Inside,
    /// The inside, where bodies tint it in colours of their own.
    InsideBodies,
    Outside,
}

impl Side {
    /// Band colour at the surface, and as far from it as the figure goes.
    const fn ends(self) -> (Color, Color) {
        match self {
            Self::Inside => (Color::rgb(0xB4, 0xD3, 0xEC), Color::rgb(0x5F, 0x9B, 0xCE)),
            Self::InsideBodies => (Color::rgb(0xF4, 0xF4, 0xF4), Color::rgb(0xB6, 0xB8, 0xBB)),
            Self::Outside => (Color::rgb(0xF9, 0xD2, 0xA2), Color::rgb(0xFF, 0xF9, 0xF0)),
        }
    }

    /// Isolines on this side.
    pub(crate) const fn line(self) -> Color {
        match self {
            Self::Inside => Color::rgb(0x2F, 0x69, 0x9E),
            Self::InsideBodies => Color::rgb(0x6A, 0x6E, 0x74),
            Self::Outside => Color::rgb(0xC0, 0x86, 0x45),
        }
    }

    /// Labels of isolines on this side.
    pub(crate) const fn label(self) -> Color {
        match self {
            Self::Inside => Color::rgb(0x0C, 0x2C, 0x4C),
            Self::InsideBodies => Color::rgb(0x2C, 0x2F, 0x34),
            Self::Outside => Color::rgb(0x5E, 0x36, 0x06),
        }
    }
}

/// The least number of bands over which the colours of a side fade: fewer bands stay near the
/// surface's colour, so that a shallow inside does not look deep.
const FADE: usize = 6;
/// Neighbouring bands alternate by this much lightness around the ramp.
const ALTERNATION: f64 = 0.006;

/// The colour of band `index` of `count`, counted from the surface.
pub(crate) fn band(side: Side, index: usize, count: usize) -> Color {
    let (near, far) = side.ends();
    let t = index as f64 / count.max(FADE).saturating_sub(1) as f64;
    let sign = if index.is_multiple_of(2) { -1.0 } else { 1.0 };
    near.mix(far, t).with_lightness_added(sign * ALTERNATION)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_goes_there_and_back() {
        for color in [Color::GREEN, Color::WHITE, Color::INK, Color::rgb(255, 0, 7)] {
            assert_eq!(Color::from_oklab(color.to_oklab()), color);
        }
    }

    /// The just noticeable difference is about 0.02.
    #[test]
    fn numbered_colours_are_told_apart() {
        let apart = |a: Color, b: Color| {
            let (a, b) = (a.to_oklab(), b.to_oklab());
            (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
        };
        for (number, &color) in NUMBERED.iter().enumerate() {
            assert!(apart(color, Color::INK) > 0.13, "{number}");
            for &other in &NUMBERED[..number] {
                assert!(apart(color, other) > 0.1, "{number}: {}", apart(color, other));
            }
        }
    }

    #[test]
    fn bands_get_lighter_from_inside_to_outside() {
        let inside = (0..8).rev().map(|i| band(Side::Inside, i, 8));
        let outside = (0..8).map(|i| band(Side::Outside, i, 8));
        let lightness: Vec<f64> = inside.chain(outside).map(|c| c.to_oklab()[0]).collect();
        assert!(lightness.windows(2).all(|pair| pair[0] < pair[1] + 0.004), "{lightness:?}");
        // The two sides differ in grey at the surface too.
        assert!(lightness[8] - lightness[7] > 0.02, "{lightness:?}");
    }
}
