// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Four ways to the gradient of a field: prints the table of `docs/guide/gradients.md`
//! and draws the pictures into the folder given:
//! `cargo run --release -p palpate-field --example gradients -- pictures`

mod comparison;

use std::error::Error;
use std::path::Path;

use comparison::{Case, Direction, Method, WINDOW};
use palpate_field::Vector;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// Pixels of the memoir's window to one of the picture.
const SHRINK: f64 = 2.0;

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", comparison::table()?);
    let Some(folder) = std::env::args().nth(1) else { return Ok(()) };
    std::fs::create_dir_all(&folder)?;
    let [.., case] = comparison::cases()?;
    let pictures = [
        ("central-differences.png", Method::CentralDifferences),
        ("dichotomy-fixed.png", Method::Dichotomy),
        ("dichotomy-adaptive.png", Method::AdaptiveDichotomy),
        ("analytic.png", Method::Analytic),
    ];
    for (name, method) in pictures {
        let path = Path::new(&folder).join(name);
        std::fs::write(&path, picture(&case, method)?)?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Hue is the direction of the gradient; values are rounded to single precision, as
/// in the memoir's program.
fn picture(case: &Case, method: Method) -> Result<Vec<u8>, Box<dyn Error>> {
    let [width, height] = WINDOW.map(|length| (length / SHRINK) as u32);
    let mut pixels = Pixmap::new(width, height).ok_or("a picture without pixels")?;
    let value = comparison::value(case, true);
    for (i, pixel) in pixels.pixels_mut().iter_mut().enumerate() {
        let (column, row) = (i as u32 % width, i as u32 / width);
        let at = [f64::from(column) + 0.5, f64::from(height - row) - 0.5];
        let p = Vector(at.map(|x| x * SHRINK));
        let direction = method.direction(case, &value, p);
        let [red, green, blue] = hue(direction, case.shape.distance(p) < 0.0);
        if let Some(color) = PremultipliedColorU8::from_rgba(red, green, blue, u8::MAX) {
            *pixel = color;
        }
    }
    Ok(pixels.encode_png()?)
}

/// A colour of the circle of hues, darker inside; black without direction.
fn hue(direction: Direction, is_inside: bool) -> [u8; 3] {
    let Some(Vector([x, y])) = direction else { return [0; 3] };
    let sixths = libm::atan2(y, x) * 3.0 / std::f64::consts::PI;
    let brightness = if is_inside { 170.0 } else { 255.0 };
    [0.0, 2.0, 4.0].map(|centre: f64| {
        let away = (sixths - centre).rem_euclid(6.0);
        let share = (2.0 - away.min(6.0 - away)).clamp(0.0, 1.0);
        (brightness * share).round() as u8
    })
}
