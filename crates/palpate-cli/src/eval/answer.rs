// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The answer for one point, as JSON and as a row.

use palpate::query::AtPoint;
use serde_json::{Value, json};

use crate::input::AXES;

pub(crate) fn to_json<const D: usize>(answer: &AtPoint<D>) -> Value {
    json!({
        "point_m": answer.point.0.to_vec(),
        "distance_m": answer.distance,
        "gradient": answer.gradient.0.to_vec(),
        "surface_point_m": answer.surface.map(|p| p.0.to_vec()),
        "inside": answer.is_inside,
        "safe_radius_m": answer.safe_radius,
    })
}

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
