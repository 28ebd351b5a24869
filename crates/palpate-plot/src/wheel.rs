// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Directions as colours, and the disc that explains them.
//!
//! The plane of directions is laid into Oklab as a flat ellipse: lightness grows to the right,
//! yellow upwards and blue downwards, and a green part to the right and a red one to the left
//! set the hues further apart. For readers who do not tell red from green, a circle of
//! lightness against blue and yellow is left, which is even too. The tests simulate the
//! deficiencies by Machado, Oliveira and Fernandes, "A Physiologically-based Model for
//! Simulation of Color Vision Deficiency" (2009).

use std::f64::consts::FRAC_PI_2;

use crate::drawing::{Drawing, Image, Path, Stroke, TextStyle};
use crate::geometry::{Point, Rect};
use crate::legend::draw_arrow;
use crate::palette::Color;
use crate::text::{Anchor, CAP_HEIGHT};

/// Lightness of a zero gradient.
const MIDDLE: f64 = 0.69;
/// The change of Oklab's lightness, red and yellow over one unit to the right. The red part is
/// 0.06 times cos 195°.
const RIGHT: [f64; 3] = [0.12, -0.057_955_5, 0.0];
/// The same over one unit up; the red part is −0.06 times sin 195°.
const UP: [f64; 3] = [0.0, 0.015_529_1, 0.12];

/// The colour of a gradient with these parts in the plane: grey if they are zero, saturated if
/// their length is one, darker if it is larger.
pub(crate) fn color([x, y]: [f64; 2]) -> Color {
    let length = x.hypot(y);
    let beyond = length.max(1.0);
    let [x, y] = [x / beyond, y / beyond];
    let shade = 1.0 / beyond;
    let [l, a, b] = [0, 1, 2].map(|i| RIGHT[i] * x + UP[i] * y);
    Color::from_oklab([(MIDDLE + l) * shade, a * shade, b * shade])
}

/// Room for the disc in a legend [px].
pub(crate) const SIZE: f64 = 116.0;
/// Radius of the disc [px].
const RADIUS: f64 = 40.0;
/// Where arrows begin, within the disc, and end, outside, over its radius.
const ARROW: [f64; 2] = [0.25, 1.16];
/// From an arrow's tip to the middle of its axis's name, over the disc's radius.
const NAME: f64 = 1.36;
/// Pixels along the edge of the disc's image: two a pixel of the figure.
const PIXELS: usize = 160;

/// The name and sense of an axis beside the disc.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AxisArrow {
    pub(crate) name: String,
    /// 1 if the axis runs to the right or up in the picture, −1 if against that.
    pub(crate) sign: f64,
}

/// Draws the disc around `center` [px], with the directions of both axes.
pub(crate) fn draw(drawing: &mut Drawing, center: Point, axes: &[AxisArrow; 2]) {
    let side = 2.0 * RADIUS;
    let square = Rect::new(center[0] - RADIUS, center[1] - RADIUS, side, side);
    drawing.image(square, disc());
    drawing.stroke(Path::circle(center, RADIUS), Stroke::new(Color::MUTED, 1.5));
    let style = TextStyle::LEGEND;
    for (axis, towards) in axes.iter().zip([0.0, FRAC_PI_2]) {
        let at = |share: f64| place(center, towards, axis.sign * share * RADIUS);
        draw_arrow(drawing, at(ARROW[0]), at(ARROW[1]), Color::INK);
        let [x, y] = at(NAME);
        let baseline = y + CAP_HEIGHT * style.size / 2.0;
        drawing.label(&axis.name, [x, baseline], Anchor::Middle, style);
    }
}

/// The colours of all gradients of length up to one, on white.
fn disc() -> Image {
    let at = |i: usize| 2.0 * (i as f64 + 0.5) / PIXELS as f64 - 1.0;
    let pixel = |i: usize| {
        let [x, y] = [at(i % PIXELS), -at(i / PIXELS)];
        if x.hypot(y) > 1.0 { Color::WHITE } else { color([x, y]) }
    };
    Image { width: PIXELS, pixels: (0..PIXELS * PIXELS).map(pixel).collect() }
}

/// The point at an angle counter-clockwise from the right, in pixels with y down.
fn place(center: Point, angle: f64, radius: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [center[0] + radius * cos, center[1] - radius * sin]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const COUNT: usize = 24;

    /// Full deficiencies, as matrices on linear sRGB (Machado and others 2009, table 1).
    const DEFICIENCIES: [(&str, [[f64; 3]; 3]); 3] = [
        (
            "protanopia",
            [
                [0.152286, 1.052583, -0.204868],
                [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998],
            ],
        ),
        (
            "deuteranopia",
            [
                [0.367322, 0.860646, -0.227968],
                [0.280085, 0.672501, 0.047413],
                [-0.011820, 0.042940, 0.968881],
            ],
        ),
        (
            "tritanopia",
            [
                [1.255528, -0.076749, -0.178779],
                [-0.078411, 0.930809, 0.147602],
                [0.004733, 0.691367, 0.303900],
            ],
        ),
    ];

    fn colors() -> Vec<Color> {
        (0..COUNT)
            .map(|i| i as f64 * TAU / COUNT as f64)
            .map(|angle| color([angle.cos(), angle.sin()]))
            .collect()
    }

    fn seen(color: Color, matrix: &[[f64; 3]; 3]) -> Color {
        let linear = [color.red, color.green, color.blue].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        let [red, green, blue] = matrix.map(|row| {
            let c = (0..3).map(|i| row[i] * linear[i]).sum::<f64>().clamp(0.0, 1.0);
            let c =
                if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
            (255.0 * c).round() as u8
        });
        Color::rgb(red, green, blue)
    }

    fn apart(a: Color, b: Color) -> f64 {
        let (a, b) = (a.to_oklab(), b.to_oklab());
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    }

    /// The distances between neighbours, shortest and longest, and the shortest between colours
    /// of directions 60° apart or more.
    fn spread(colors: &[Color]) -> [f64; 3] {
        let mut spread = [f64::INFINITY, 0.0, f64::INFINITY];
        for i in 0..COUNT {
            for steps in 1..=COUNT / 2 {
                let d = apart(colors[i], colors[(i + steps) % COUNT]);
                if steps == 1 {
                    spread = [spread[0].min(d), spread[1].max(d), spread[2]];
                } else if steps >= COUNT / 6 {
                    spread[2] = spread[2].min(d);
                }
            }
        }
        spread
    }

    #[test]
    fn colours_of_directions_are_even() {
        let [shortest, longest, far] = spread(&colors());
        // 11 % of the ellipse, and half a grey of 255 in each component of both colours.
        assert!(longest / shortest < 1.25, "{shortest} {longest}");
        assert!(far > 0.11, "{far}");
    }

    #[test]
    fn colours_of_directions_differ_for_all_eyes() {
        for (name, matrix) in &DEFICIENCIES {
            let seen = Vec::from_iter(colors().into_iter().map(|color| seen(color, matrix)));
            let [_, _, far] = spread(&seen);
            // The just noticeable difference is about 0.02.
            assert!(far > if *name == "tritanopia" { 0.07 } else { 0.11 }, "{name}: {far}");
        }
    }

    #[test]
    fn known_directions_have_their_colours() {
        let [right, up, left, down] =
            [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(|v| color(v).to_oklab());
        let near = |x: f64, y: f64| (x - y).abs() < 0.004; // half a grey of 255
        assert!(near(right[0], 0.81) && near(left[0], 0.57));
        assert!(near(up[2], 0.12) && near(down[2], -0.12) && near(up[0], 0.69));
    }

    #[test]
    fn flat_is_grey_and_steep_is_dark() {
        let Color { red, green, blue } = color([0.0, 0.0]);
        assert!(red == green && green == blue);
        assert_eq!(color([1.0, 0.0]), color([1.0 + 1e-12, 0.0]));
        let steep = color([0.0, 2.0]).to_oklab()[0];
        assert!((steep - 0.345).abs() < 0.004, "{steep}");
    }
}
