// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A thousand primitives in a cube.

/// How many.
const COUNT: usize = 1000;

/// Draws the same scene on every machine.
const SEED: u64 = 1000;

/// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators,
/// 2014, figure 2).
struct Numbers(u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A multiple of a step from `least` to `most` steps, as it is written: the
    /// division makes 0.021 of 21, which a product with 0.001 would not.
    fn between(&mut self, least: i64, most: i64, steps_in_one: f64) -> f64 {
        let choices = (most - least + 1) as u64;
        (least + (self.bits() % choices) as i64) as f64 / steps_in_one
    }

    /// A length from 10 mm to 40 mm [m].
    fn length(&mut self) -> f64 {
        self.between(10, 40, 1e3)
    }
}

/// The scene's text.
pub(crate) fn scene() -> String {
    let mut numbers = Numbers(SEED);
    let placed: Vec<_> = (0..COUNT)
        .map(|i| {
            let [x, y, z] = [0; 3].map(|_| numbers.between(-500, 500, 1e3));
            let turn = turn(&mut numbers);
            let shape = primitive(i % KINDS, &mut numbers);
            format!(r#"{{ "translate": [{x}, {y}, {z}], {turn} "of": {{ {shape} }} }}"#)
        })
        .collect();
    format!(
        r#"{{ "palpate": 1, "dimension": 3,
        "description": "A thousand small primitives of eight kinds in a cube of 1 m.",
        "bodies": [{{ "name": "thousand", "shape": {{ "union": [{}] }} }}] }}"#,
        placed.join(",")
    )
}

/// A rotation about an axis of small whole numbers, for half of the shapes.
fn turn(numbers: &mut Numbers) -> String {
    let [x, y] = [0; 2].map(|_| numbers.between(-3, 3, 1.0));
    let angle = numbers.between(5, 175, 1.0);
    if numbers.bits().is_multiple_of(2) {
        return String::new();
    }
    format!(r#""rotate_degrees": {{ "axis": [{x}, {y}, 1], "angle": {angle} }},"#)
}

/// How many kinds there are.
const KINDS: usize = 8;

/// A primitive, its measures such that each builds.
fn primitive(kind: usize, numbers: &mut Numbers) -> String {
    let [a, b, c] = [0; 3].map(|_| numbers.length());
    match kind {
        0 => format!(r#""ball": {{ "radius": {a} }}"#),
        1 => format!(r#""cuboid": {{ "size": [{a}, {b}, {c}] }}"#),
        2 => format!(r#""rounded_cuboid": {{ "size": [{a}, {b}, {c}], "rounding": 0.003 }}"#),
        // Longer than thick.
        3 => {
            format!(r#""capsule": {{ "radius": 0.01, "height": {} }}"#, super::short(0.02 + a))
        }
        4 => format!(r#""cylinder": {{ "radius": {a}, "height": {b} }}"#),
        5 => format!(r#""cone": {{ "radius": {a}, "height": {b} }}"#),
        6 => format!(r#""torus": {{ "ring_radius": {a}, "radius": 0.005 }}"#),
        _ => format!(r#""octahedron": {{ "radius": {a} }}"#),
    }
}
