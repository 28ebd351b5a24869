// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where each primitive's example is, as maps that can be read: 32 × 32 signs.

use palpate_field::catalogue::Entry;
use palpate_field::{Point, ShapeError, Vector};

/// Rows and columns of a map.
const SIDE: usize = 32;

/// Half the side of the square that a map shows [m]. The centres of its cells are
/// odd multiples of 5/128 m, on which no surface of an example lies.
const HALF: f64 = 1.25;

/// The signs over a square, `#` inside and `.` outside; the first row is the top.
fn map(distance: impl Fn(f64, f64) -> f64) -> String {
    let place = |i: usize| HALF * ((2 * i + 1) as f64 / SIDE as f64 - 1.0);
    let row = |from_top: usize| -> String {
        let up = -place(from_top);
        let sign = |i| if distance(place(i), up) < 0.0 { '#' } else { '.' };
        (0..SIDE).map(sign).collect()
    };
    (0..SIDE).map(row).collect::<Vec<_>>().join("\n")
}

/// What the maps show, for the head of a snapshot.
fn title(what: &str) -> String {
    format!("{what}; {HALF} m to each side, # is inside")
}

#[test]
fn signs_in_the_plane() -> Result<(), ShapeError> {
    for entry in Entry::<2>::ALL {
        let shape = entry.example()?;
        let front = map(|x, y| shape.distance(Vector([x, y])));
        let text = format!("{}\n{front}", title("x to the right, y up"));
        insta::assert_snapshot!(format!("plane_{}", entry.name), text);
    }
    Ok(())
}

#[test]
fn signs_in_space() -> Result<(), ShapeError> {
    for entry in Entry::<3>::ALL {
        let shape = entry.example()?;
        let front = map(|x, y| shape.distance(Vector([x, y, 0.0])));
        // Seen from above, where z points towards the reader.
        let above = map(|x, away| shape.distance(Vector([x, 0.0, -away])));
        let text = format!(
            "{}\n{front}\n\n{}\n{above}",
            title("at z = 0, x to the right, y up"),
            title("at y = 0, x to the right, z down"),
        );
        insta::assert_snapshot!(format!("space_{}", entry.name), text);
    }
    Ok(())
}

/// Which way is up, for readers who do not look at the maps.
#[test]
fn tips_point_up() -> Result<(), ShapeError> {
    fn tip<const D: usize>(entries: &[Entry<D>], name: &str) -> Result<bool, ShapeError> {
        let entry = entries.iter().find(|entry| entry.name == name);
        let entry = entry.unwrap_or_else(|| panic!("there is no {name}"));
        let shape = entry.example()?;
        let top = shape.promise().bounds.map_or(1.0, |bounds| bounds.aabb.max[1]);
        let near_tip: Point<D> = Vector::unit(1) * (0.9 * top);
        // As high as the tip, as far out as the foot is wide: only below is inside.
        let mut beside = near_tip;
        beside[0] = 0.2;
        Ok(shape.distance(near_tip) < 0.0 && shape.distance(beside) > 0.0)
    }
    for name in ["regular_polygon", "regular_star", "cool_s", "isosceles_triangle"] {
        assert!(tip(Entry::<2>::ALL, name)?, "the tip of {name}");
    }
    for name in ["cone", "pyramid", "cone_approximation", "pyramid_approximation"] {
        assert!(tip(Entry::<3>::ALL, name)?, "the tip of {name}");
    }
    Ok(())
}
