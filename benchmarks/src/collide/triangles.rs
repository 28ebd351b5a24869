// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Triangles near a surface, and segments in the plane: whether they touch it, and how
//! deep.

use std::error::Error;
use std::hint::black_box;

use palpate::field::{Point, Shape, Vector};
use palpate::query::{
    Certified, Element, ElementWorkspace, Limits, QueryError, minimum, touches,
};

use super::{TimedRows, fastest};
use crate::random::Random;
use crate::scenes::{self, Work};

/// How large elements are: their corners lie in balls of these radii [m].
pub(super) const SIZES: [f64; 2] = [0.05, 0.3];

/// Elements of each size.
const COUNT: usize = 400;

/// How far from the surface the balls' centres are at most, as a share of the size.
const NEAR: f64 = 0.7;

/// A way of asking.
type Ask<const N: usize, const D: usize> = fn(
    &Shape<D>,
    &Element<N, D>,
    &Limits,
    &mut ElementWorkspace<N, D>,
) -> Result<Certified<Point<D>>, QueryError>;

/// Adds the rows of triangles in space and of segments in the plane.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    scenes::spatial()?.iter().try_for_each(|work| of::<3, 3>("triangle", work, rows))?;
    scenes::planar()?.iter().try_for_each(|work| of::<2, 2>("segment", work, rows))
}

/// Adds the rows of a work.
fn of<const N: usize, const D: usize>(
    name: &str,
    work: &Work<D>,
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error>> {
    // A touch is looked for up to 1e-4 of the size; a minimum to 1 % of it.
    let questions: [(&str, Ask<N, D>, f64); 2] =
        [("hit", touches, 1e-4), ("minimum_1pc", minimum, 1e-2)];
    for (question, ask, tolerance) in questions {
        let mut times = Vec::new();
        let (mut evaluations, mut undecided) = (0, 0);
        for size in SIZES {
            let limits = Limits::new(tolerance * size);
            let mut workspace = ElementWorkspace::new();
            for element in near(&work.shape, size)? {
                let answer = ask(&work.shape, &element, &limits, &mut workspace)?;
                evaluations += answer.evaluations;
                undecided += u32::from(match question {
                    "hit" => answer.is_hit().is_none(),
                    _ => answer.upper - answer.lower > limits.tolerance,
                });
                times.push(fastest(|| {
                    let _ = black_box(ask(
                        &work.shape,
                        black_box(&element),
                        &limits,
                        &mut workspace,
                    ));
                }));
            }
        }
        let key = format!("{name}.{question}.{}", work.name);
        let count = times.len() as f64;
        rows.add_times(&key, times);
        rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / count);
        rows.insert(format!("{key}.undecided"), f64::from(undecided));
    }
    Ok(())
}

/// Elements near the surface: points of a cube moved along the gradient to at most
/// [`NEAR`] sizes from it, and corners about each.
pub(super) fn near<const N: usize, const D: usize>(
    shape: &Shape<D>,
    size: f64,
) -> Result<Vec<Element<N, D>>, Box<dyn Error>> {
    let mut random = Random::new(7);
    let mut elements = Vec::with_capacity(COUNT);
    while elements.len() < COUNT {
        let start = Vector(random.point([0.0; D], 1.0));
        let (distance, gradient) = shape.distance_gradient(start);
        let height = random.between(-NEAR * size, NEAR * size);
        let steepness = gradient.norm().max(1e-9);
        let middle = start - gradient * ((distance - height) / steepness);
        if shape.distance(middle).abs() > 2.0 * NEAR * size {
            continue;
        }
        let mut corner = || loop {
            let offset: Point<D> = Vector(random.point([0.0; D], 1.0));
            if offset.norm() < 1.0 {
                return middle + offset * size;
            }
        };
        elements.push(Element::new(std::array::from_fn(|_| corner()))?);
    }
    Ok(elements)
}
