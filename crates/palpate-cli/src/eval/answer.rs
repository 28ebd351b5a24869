// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The answer for one point as a row.

use palpate::query::AtPoint;
use palpate::scene::BallAnswer;

use crate::input::AXES;

/// The columns of a row.
pub(crate) fn header<const D: usize>() -> Vec<String> {
    let axes = &AXES[..D];
    let mut header: Vec<String> = axes.iter().map(|axis| format!("{axis}_m")).collect();
    header.push("distance_m".to_owned());
    header.extend(axes.iter().map(|axis| format!("gradient_{axis}")));
    header.extend(axes.iter().map(|axis| format!("surface_{axis}_m")));
    header.extend(["inside".to_owned(), "safe_radius_m".to_owned()]);
    header
}

/// The row of an answer; the surface point is empty where none was found.
pub(crate) fn row<const D: usize>(answer: &AtPoint<D>) -> Vec<String> {
    let mut row: Vec<String> = answer.point.0.iter().map(f64::to_string).collect();
    row.push(answer.distance.to_string());
    row.extend(answer.gradient.0.iter().map(f64::to_string));
    match answer.surface {
        Some(surface) => row.extend(surface.0.iter().map(f64::to_string)),
        None => row.extend(vec![String::new(); D]),
    }
    row.extend([answer.is_inside.to_string(), answer.safe_radius.to_string()]);
    row
}

/// The columns of a ball.
pub(super) fn header_of_ball<const D: usize>() -> Vec<String> {
    let axes = &AXES[..D];
    let mut header =
        ["radius_m", "meets", "gap_lower_m", "gap_upper_m"].map(str::to_owned).to_vec();
    header.extend(axes.iter().map(|axis| format!("nearest_{axis}_m")));
    header.extend(axes.iter().map(|axis| format!("ball_{axis}_m")));
    header.extend(["memoir_test", "memoir_test_is_right"].map(str::to_owned));
    header
}

/// The row of a ball; what is not known is empty, and `meets` is `undecided`.
pub(super) fn row_of_ball<const D: usize>(ball: &BallAnswer<D>) -> Vec<String> {
    let meets = match ball.touches {
        Some(true) => "yes",
        Some(false) => "no",
        None => "undecided",
    };
    let mut row = vec![ball.radius.to_string(), meets.to_owned()];
    row.extend([ball.lower, ball.upper].map(|gap| gap.to_string()));
    match ball.contact {
        Some(contact) => {
            row.extend(contact.point_a.0.iter().map(f64::to_string));
            row.extend(contact.point_b.0.iter().map(f64::to_string));
        }
        None => row.extend(vec![String::new(); 2 * D]),
    }
    row.push(ball.memoir_test.to_string());
    row.push(ball.memoir_test_is_right.map_or_else(String::new, |right| right.to_string()));
    row
}
