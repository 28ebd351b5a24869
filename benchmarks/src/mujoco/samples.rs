// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a plugin's field and ours are of one body, and whether the plugin's is a distance.

use palpate::field::{Point, Shape, Vector};

use super::exchange::FieldValues;
use crate::random::Random;

/// Points at which both fields are compared.
const POINTS: usize = 20_000;

/// Where signs are not compared, as a share of the body's size: the band about the surface.
const BAND: f64 = 1e-5;

/// How far from the surface half of the points are at most, as a share of the body's size.
const NEAR: f64 = 0.01;

/// What the points show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Comparison {
    /// The share of signs that differ, outside the band.
    pub(super) disagree: f64,
    /// The least, the median and the largest norm of the gradient of the plugin's field, but for
    /// one in a hundred at either end; 1 for a distance.
    pub(super) steepness: [f64; 3],
}

/// The diagonal of a shape's box [m].
pub(super) fn size(shape: &Shape<3>) -> Option<f64> {
    let bounds = shape.promise().bounds?;
    Some((bounds.aabb.max - bounds.aabb.min).norm())
}

/// Points in a shape's box, and as many near its surface; none if it is unbounded.
pub(super) fn points(shape: &Shape<3>) -> Vec<Point<3>> {
    let Some((bounds, size)) = shape.promise().bounds.zip(size(shape)) else {
        return Vec::new();
    };
    let mut random = Random::new(17);
    let (low, high) = (bounds.aabb.min, bounds.aabb.max);
    let mut points = Vec::with_capacity(POINTS);
    while points.len() < POINTS {
        let p = Vector([0, 1, 2].map(|i| {
            let beyond = 0.05 * (high[i] - low[i]);
            random.between(low[i] - beyond, high[i] + beyond)
        }));
        points.push(p);
        let Some(on) = shape.surface_point(p) else { continue };
        points.push(on + Vector(random.point([0.0; 3], NEAR * size)));
    }
    points.truncate(POINTS);
    points
}

/// Compares a shape with the plugin's field at its points.
pub(super) fn compare(
    shape: &Shape<3>,
    points: &[Point<3>],
    theirs: &FieldValues,
) -> Comparison {
    let band = BAND * size(shape).unwrap_or(0.0);
    let values =
        points.iter().zip(&theirs.values).map(|(p, theirs)| (shape.distance(*p), theirs));
    let outside: Vec<_> = values.filter(|(ours, _)| ours.abs() > band).collect();
    let differ = outside.iter().filter(|(ours, theirs)| (*ours < 0.0) != (**theirs < 0.0));
    let disagree = differ.count() as f64 / outside.len() as f64;
    let mut steepness = theirs.steepness.clone();
    steepness.sort_by(f64::total_cmp);
    let at = |hundredth: usize| {
        steepness.get(steepness.len() * hundredth / 100).copied().unwrap_or(f64::NAN)
    };
    Comparison { disagree, steepness: [at(1), at(50), at(99)] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate::field::kernel::Ball;
    use std::error::Error;

    #[test]
    fn the_same_field_agrees_everywhere() -> Result<(), Box<dyn Error>> {
        let ball = Shape::from_kernel(Ball::new(0.1)?);
        let points = points(&ball);
        assert_eq!(points.len(), POINTS);
        let values = points.iter().map(|p| ball.distance(*p)).collect();
        let theirs = FieldValues { values, steepness: vec![1.0; POINTS] };
        let compared = compare(&ball, &points, &theirs);
        assert_eq!(compared, Comparison { disagree: 0.0, steepness: [1.0; 3] });
        Ok(())
    }

    #[test]
    fn a_body_a_little_larger_disagrees_near_its_surface() -> Result<(), Box<dyn Error>> {
        let ball = Shape::from_kernel(Ball::new(0.1)?);
        let points = points(&ball);
        let larger = points.iter().map(|p| ball.distance(*p) - 1e-4).collect();
        let theirs = FieldValues { values: larger, steepness: vec![2.0; POINTS] };
        let compared = compare(&ball, &points, &theirs);
        // Half of the points are within 3.5 mm of the surface, one in fifty of them in the shell.
        assert!((0.005..0.05).contains(&compared.disagree), "{compared:?}");
        assert_eq!(compared.steepness, [2.0; 3]);
        Ok(())
    }
}
