// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Our own subjects.

use palpate::field::scalar::Float;
use palpate::field::{BLOCK, Block, Column, Gradients, Shape, Vector};

use super::points::{Points, SINGLE};
use crate::rounds::Subject;

/// Our ways of asking, in a dimension.
pub(crate) trait Ours<const D: usize> {
    /// Adds one subject for each way.
    fn ours<'a>(&'a self, work: &str, shape: &'a Shape<D>, subjects: &mut Vec<Subject<'a>>);
}

/// A number too small to move a point: it makes each question wait for the answer
/// before, as a servo does.
const NOTHING: f64 = 1e-30;

macro_rules! ours {
    ($dimension:literal) => {
        impl Ours<$dimension> for Points<$dimension> {
            fn ours<'a>(
                &'a self,
                work: &str,
                shape: &'a Shape<$dimension>,
                subjects: &mut Vec<Subject<'a>>,
            ) {
                let single = &self.scattered[..SINGLE];
                let double: Vec<Vector<f64, $dimension>> =
                    single.iter().map(|p| Vector(p.0.map(f64::from))).collect();
                let points = double.clone();
                subjects.push(Subject::new(
                    format!("{work}.distance.point"),
                    SINGLE,
                    move || {
                        points.iter().fold(0.0, |last, p| shape.distance(waiting(*p, last)))
                    },
                ));
                subjects.push(Subject::new(
                    format!("{work}.distance.point_f32"),
                    SINGLE,
                    move || {
                        let ask = |last: f32, p: &Vector<f32, $dimension>| {
                            shape.distance_f32(waiting(*p, last))
                        };
                        f64::from(single.iter().fold(0.0, ask))
                    },
                ));
                subjects.push(Subject::new(
                    format!("{work}.distance_gradient.point"),
                    SINGLE,
                    move || {
                        double.iter().fold(0.0, |last, p| {
                            let (distance, gradient) =
                                shape.distance_gradient(waiting(*p, last));
                            distance + gradient[0] * NOTHING
                        })
                    },
                ));
                subjects.push(Subject::new(
                    format!("{work}.distance_gradient.point_f32"),
                    SINGLE,
                    move || {
                        f64::from(single.iter().fold(0.0, |last, p| {
                            let p = waiting(*p, last);
                            let (distance, gradient) = shape.distance_gradient_f32(p);
                            distance + gradient[0] * NOTHING as f32
                        }))
                    },
                ));
                for count in [64, 1024, 65_536] {
                    let asked = (shape, &self.scattered[..count]);
                    in_single(work, &count.to_string(), asked, subjects);
                    in_double(work, &count.to_string(), asked, subjects);
                }
                let clustered = (shape, &self.clustered[..]);
                in_single(work, "clustered", clustered, subjects);
                in_double(work, "clustered", clustered, subjects);

                let cells = Self::cells(&self.scattered[..SINGLE]);
                subjects.push(Subject::new(format!("{work}.model.64"), SINGLE, move || {
                    let mut out = Column::zero();
                    for block in &cells {
                        shape.block_distances(block, BLOCK, &mut out);
                    }
                    out.get(0).value
                }));
            }
        }
    };
}

ours!(2);
ours!(3);

/// `p`, moved by nothing that depends on `last`.
fn waiting<T: Float, const D: usize>(p: Vector<T, D>, last: T) -> Vector<T, D> {
    let mut p = p;
    p.0[0] = p.0[0] + last * T::constant(NOTHING);
    p
}

/// Adds a slice of points in single precision.
pub(super) fn in_single<'a, const D: usize>(
    work: &str,
    case: &str,
    (shape, points): (&'a Shape<D>, &'a [Vector<f32, D>]),
    subjects: &mut Vec<Subject<'a>>,
) {
    let count = points.len();
    let mut out = vec![0.0; count];
    subjects.push(Subject::new(format!("{work}.distance.{case}"), count, move || {
        shape.distances_f32(points, &mut out);
        f64::from(out[0])
    }));
    let (mut out, mut slopes) = (vec![0.0; count], vec![Vector([0.0; D]); count]);
    subjects.push(Subject::new(format!("{work}.distance_gradient.{case}"), count, move || {
        shape.distances_gradients_f32(points, &mut out, &mut slopes);
        f64::from(out[0])
    }));
}

/// Adds a slice of points in double precision, in blocks.
pub(super) fn in_double<'a, const D: usize>(
    work: &str,
    case: &str,
    (shape, points): (&'a Shape<D>, &[Vector<f32, D>]),
    subjects: &mut Vec<Subject<'a>>,
) {
    let units = points.len();
    let blocks: std::rc::Rc<Vec<Block<f64, D>>> = Points::<D>::blocks(points).into();
    let again = std::rc::Rc::clone(&blocks);
    subjects.push(Subject::new(format!("{work}.distance_f64.{case}"), units, move || {
        let mut out = Column::zero();
        for block in blocks.iter() {
            shape.block_distances(block, BLOCK, &mut out);
        }
        out.get(0)
    }));
    let key = format!("{work}.distance_gradient_f64.{case}");
    subjects.push(Subject::new(key, units, move || {
        let mut out = Gradients::zero();
        for block in again.iter() {
            shape.block_gradients(block, BLOCK, &mut out);
        }
        out.distance.get(0)
    }));
}
