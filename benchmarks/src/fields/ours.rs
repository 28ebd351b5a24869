// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Our own subjects.

use palpate::field::scalar::Float;
use palpate::field::{BLOCK, Block, Column, Gradients, Lane, SHORT, Shape, Vector};

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
                    let points = &self.scattered[..count];
                    let case = count.to_string();
                    blocks::<f32, $dimension, BLOCK>(
                        work,
                        ("", &case),
                        (shape, points),
                        subjects,
                    );
                    blocks::<f64, $dimension, BLOCK>(
                        work,
                        ("_f64", &case),
                        (shape, points),
                        subjects,
                    );
                }
                let clustered = (shape, &self.clustered[..]);
                blocks::<f32, $dimension, BLOCK>(work, ("", "clustered"), clustered, subjects);
                blocks::<f64, $dimension, BLOCK>(
                    work,
                    ("_f64", "clustered"),
                    clustered,
                    subjects,
                );
                let single = (shape, single);
                blocks::<f64, $dimension, SHORT>(work, ("_f64", "8"), single, subjects);

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

/// Adds a slice of points, in blocks of `W`.
pub(super) fn blocks<'a, T, const D: usize, const W: usize>(
    work: &str,
    (suffix, case): (&str, &str),
    (shape, points): (&'a Shape<D>, &[Vector<f32, D>]),
    subjects: &mut Vec<Subject<'a>>,
) where
    T: Float + Lane,
    dyn palpate::field::field::Field<D>: palpate::field::field::EvaluateBlock<T, D, W>
        + palpate::field::field::DifferentiateBlock<T, D, W>,
{
    let units = points.len();
    let blocks: std::rc::Rc<Vec<Block<T, D, W>>> = Points::<D>::blocks(points).into();
    let again = std::rc::Rc::clone(&blocks);
    subjects.push(Subject::new(format!("{work}.distance{suffix}.{case}"), units, move || {
        let mut out = Column::zero();
        for block in blocks.iter() {
            shape.block_distances(block, W, &mut out);
        }
        out.get(0).to_f64()
    }));
    let key = format!("{work}.distance_gradient{suffix}.{case}");
    subjects.push(Subject::new(key, units, move || {
        let mut out = Gradients::zero();
        for block in again.iter() {
            shape.block_gradients(block, W, &mut out);
        }
        out.distance.get(0).to_f64()
    }));
}
