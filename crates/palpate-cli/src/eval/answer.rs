// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The answer for one point, and how it is written.

use palpate::field::{Point, Shape, Vector};
use serde_json::{Value, json};

/// What a shape says at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer<const D: usize> {
    point: Point<D>,
    pub(crate) distance: f64,
    pub(crate) gradient: Vector<f64, D>,
    pub(crate) surface: Option<Point<D>>,
    pub(crate) inside: bool,
    pub(crate) safe_radius: f64,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl<const D: usize> Answer<D> {
    pub(crate) fn at(shape: &Shape<D>, point: Point<D>) -> Self {
        let (distance, gradient) = shape.distance_gradient(point);
        Self::of(shape, point, distance, gradient)
    }

    /// The answer where the distance and gradient are known.
    pub(crate) fn of(
        shape: &Shape<D>,
        point: Point<D>,
        distance: f64,
        gradient: Vector<f64, D>,
    ) -> Self {
        let promise = shape.promise();
        let rounding = promise.rounding.within(point.norm());
        Self {
            point,
            distance,
            gradient,
            surface: shape.surface_point(point),
            inside: distance < 0.0,
            safe_radius: (promise.safe_radius(point, distance) - rounding).max(0.0),
        }
    }

    pub(crate) fn to_json(self) -> Value {
        json!({
            "point_m": self.point.0.to_vec(),
            "distance_m": self.distance,
            "gradient": self.gradient.0.to_vec(),
            "surface_point_m": self.surface.map(|p| p.0.to_vec()),
            "inside": self.inside,
            "safe_radius_m": self.safe_radius,
        })
    }

    /// The columns of a row.
    pub(crate) fn header() -> Vec<String> {
        let axes = &AXES[..D];
        let mut header: Vec<String> = axes.iter().map(|axis| format!("{axis}_m")).collect();
        header.push("distance_m".to_owned());
        header.extend(axes.iter().map(|axis| format!("gradient_{axis}")));
        header.extend(axes.iter().map(|axis| format!("surface_{axis}_m")));
        header.extend(["inside".to_owned(), "safe_radius_m".to_owned()]);
        header
    }

    /// The row; the surface point is empty where none was found.
    pub(crate) fn row(&self) -> Vec<String> {
        let mut row: Vec<String> = self.point.0.iter().map(f64::to_string).collect();
        row.push(self.distance.to_string());
        row.extend(self.gradient.0.iter().map(f64::to_string));
        match self.surface {
            Some(surface) => row.extend(surface.0.iter().map(f64::to_string)),
            None => row.extend(vec![String::new(); D]),
        }
        row.extend([self.inside.to_string(), self.safe_radius.to_string()]);
        row
    }
}
