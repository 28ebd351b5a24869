// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The peers' subjects.

use std::cell::RefCell;
use std::error::Error;

use fidget::eval::MathFunction;
use fidget::types::Grad;
use palpate::field::{BLOCK, Shape, Vector};

use super::points::{Points, SINGLE};
use crate::peers::{Body, Tape};
use crate::rounds::Subject;

/// The peers by the names that keys give them.
pub(crate) const PEERS: &[&str] = &["fidget_jit", "fidget_vm", "parry"];

/// How far two single-precision evaluations of a formula may be apart, as a share
/// of the scene: both round every operation.
const TOLERANCE: f32 = 1e-5;

/// As in `ours`: too small to move a point.
const NOTHING: f32 = 1e-30;

/// Checks that a peer computes the same distances.
pub(crate) fn agree<F: MathFunction, const D: usize>(
    shape: &Shape<D>,
    points: &Points<D>,
    tape: &mut Tape<F>,
) -> Result<(), Box<dyn Error>> {
    for p in &points.scattered[..SINGLE] {
        let (ours, theirs) = (shape.distance_f32(*p), tape.distance(coordinates(*p)));
        if (ours - theirs).abs() > TOLERANCE * (1.0 + ours.abs()) {
            return Err(format!("at {p:?} we say {ours} m, fidget says {theirs} m").into());
        }
    }
    Ok(())
}

fn coordinates<const D: usize>(p: Vector<f32, D>) -> [f32; 3] {
    std::array::from_fn(|k| p.0.get(k).copied().unwrap_or(0.0))
}

/// Adds the subjects of a tape.
pub(crate) fn tape<'a, F: MathFunction + 'a, const D: usize>(
    work: &str,
    peer: &str,
    points: &'a Points<D>,
    tape: &'a RefCell<Tape<F>>,
    subjects: &mut Vec<Subject<'a>>,
) {
    let key = |operation: &str, case: &str| format!("{work}.{operation}.{case}.{peer}");
    let single = &points.scattered[..SINGLE];
    subjects.push(Subject::new(key("distance", "point"), SINGLE, move || {
        let mut tape = tape.borrow_mut();
        f64::from(single.iter().fold(0.0, |last, p| {
            let [x, y, z] = coordinates(*p);
            tape.distance([x + last * NOTHING, y, z])
        }))
    }));
    subjects.push(Subject::new(key("distance_gradient", "point"), SINGLE, move || {
        let mut tape = tape.borrow_mut();
        f64::from(single.iter().fold(0.0, |last, p| {
            let [x, y, z] = coordinates(*p);
            let [x, y, z] = variables([x + last * NOTHING, y, z]);
            tape.gradients([&[x], &[y], &[z]]).v
        }))
    }));
    for count in [64, 1024, 65_536] {
        let columns = Points::columns(&points.scattered[..count]);
        let duals = dual_columns(&columns);
        let case = count.to_string();
        subjects.push(Subject::new(key("distance", &case), count, move || {
            let [x, y, z] = &columns;
            f64::from(tape.borrow_mut().distances([x, y, z]))
        }));
        subjects.push(Subject::new(key("distance_gradient", &case), count, move || {
            let [x, y, z] = &duals;
            f64::from(tape.borrow_mut().gradients([x, y, z]).v)
        }));
    }
    let clusters: Vec<_> = points.clustered.chunks(BLOCK).map(Points::columns).collect();
    let duals: Vec<_> = clusters.iter().map(dual_columns).collect();
    let again = clusters.clone();
    let units = points.clustered.len();
    subjects.push(Subject::new(key("distance", "clustered"), units, move || {
        let mut tape = tape.borrow_mut();
        f64::from(clusters.iter().fold(0.0, |_, [x, y, z]| tape.distances([x, y, z])))
    }));
    subjects.push(Subject::new(key("distance_gradient", "clustered"), units, move || {
        let mut tape = tape.borrow_mut();
        f64::from(duals.iter().fold(0.0, |_, [x, y, z]| tape.gradients([x, y, z]).v))
    }));
    if peer == "fidget_jit" {
        subjects.push(Subject::new(
            key("distance", "clustered_simplified"),
            units,
            move || {
                let mut tape = tape.borrow_mut();
                let ask = |_, [x, y, z]: &[Vec<f32>; 3]| tape.simplified_distances([x, y, z]);
                f64::from(again.iter().fold(0.0, ask))
            },
        ));
    }
}

/// Each coordinate with itself as its derivative.
fn variables([x, y, z]: [f32; 3]) -> [Grad; 3] {
    [Grad::new(x, 1.0, 0.0, 0.0), Grad::new(y, 0.0, 1.0, 0.0), Grad::new(z, 0.0, 0.0, 1.0)]
}

fn dual_columns(columns: &[Vec<f32>; 3]) -> [Vec<Grad>; 3] {
    let column =
        |k: usize| columns[k].iter().map(|x| variables([*x; 3])[k]).collect::<Vec<_>>();
    [column(0), column(1), column(2)]
}

/// Adds the subject of a body of parry.
pub(crate) fn parry<'a, const D: usize>(
    work: &str,
    points: &'a Points<D>,
    body: &'a Body,
    subjects: &mut Vec<Subject<'a>>,
) {
    let single = &points.scattered[..SINGLE];
    subjects.push(Subject::new(format!("{work}.distance.point.parry"), SINGLE, move || {
        single.iter().fold(0.0, |last, p| {
            let [x, y, z] = coordinates(*p).map(f64::from);
            body.distance([x + last * f64::from(NOTHING), y, z])
        })
    }));
}

#[cfg(test)]
mod tests {
    use fidget::vm::VmFunction;

    use super::*;
    use crate::peers::{Dimensions, Space, formula};
    use crate::scenes::{self, Work};

    fn check<const D: usize>(work: &Work<D>)
    where
        Dimensions: Space<D>,
    {
        let formula = formula(&work.shape).unwrap_or_else(|error| panic!("{error}"));
        let mut tape = Tape::<VmFunction>::new(&formula);
        agree(&work.shape, &Points::new(work.half), &mut tape)
            .unwrap_or_else(|error| panic!("{}: {error}", work.name));
    }

    #[test]
    fn fidget_computes_the_distances_of_every_scene() {
        let spatial = scenes::spatial().unwrap_or_else(|error| panic!("{error}"));
        spatial.iter().for_each(check);
        let wrench = scenes::wrench().unwrap_or_else(|error| panic!("{error}"));
        check(&wrench);
        assert!(Body::of(&wrench.shape).is_none());
    }

    #[test]
    fn a_union_is_built_again_from_its_members() {
        let spatial = scenes::spatial().unwrap_or_else(|error| panic!("{error}"));
        let Some(s4) = spatial.last() else { panic!("no scenes") };
        let members = scenes::members(&s4.shape).unwrap_or_else(|error| panic!("{error}"));
        let built = scenes::build(&members).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(built, s4.shape);
    }
}
