// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A kernel evaluated with a number that records what is done to it gives its
//! formula: what a shader generator needs.
//!
//! The recorded formulas are printed, and evaluated again, which must give the
//! bits of the kernel.

use palpate_field::field::Placement;
use palpate_field::kernel::{
    Ball, CappedCone, Cuboid, Kernel, NamedKernel, RegularStar, Torus,
};
use palpate_field::scalar::{Expression, Quadratic, Recorded, Scalar};
use palpate_field::{Point, Pose, Promise, Rotation, Shape, ShapeError, Vector};
use palpate_testkit::arbitrary::Turn;
use palpate_testkit::kernels::{Dimension, Space, Visit};
use palpate_testkit::tree::Solid;
use palpate_testkit::{arbitrary as draw, cases};

fn recorded<const D: usize>(
    formula: impl FnOnce(Vector<Recorded, D>) -> Recorded,
) -> Expression {
    Expression::record(|p| Some(formula(p))).expect("a formula that always gives a result")
}

fn formula<K: Kernel<D>, const D: usize>(kernel: &K) -> String {
    recorded(|p| kernel.distance(p)).to_string()
}

#[test]
fn formulas_of_kernels() -> Result<(), ShapeError> {
    insta::assert_snapshot!("ball", formula::<_, 3>(&Ball::new(0.5)?));
    insta::assert_snapshot!("cuboid", formula(&Cuboid::new(Vector([1.0, 2.0, 3.0]))?));
    insta::assert_snapshot!("torus", formula(&Torus::new(0.5, 0.125)?));
    insta::assert_snapshot!("capped_cone", formula(&CappedCone::new(1.5, 0.0, 2.0)?));
    insta::assert_snapshot!("regular_star", formula(&RegularStar::new(5, 1.0, 0.5)?));
    Ok(())
}

#[test]
fn formulas_of_operators() -> Result<(), ShapeError> {
    let (ball, cube) = (Ball::new(0.5)?, Cuboid::new(Vector([1.0; 3]))?);
    let blend = |p: Vector<Recorded, 3>| {
        let (a, b): (Recorded, Recorded) = (ball.distance(p), cube.distance(p));
        a.smooth_min::<Quadratic>(b, 0.25)
    };
    insta::assert_snapshot!("smooth_union", recorded(blend).to_string());

    let third = Rotation::from_matrix([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])?;
    let placement = Placement::new(Pose::new(third, Vector([1.0, 2.0, 3.0])));
    let placed = |p: Vector<Recorded, 3>| cube.distance(placement.to_body(p));
    insta::assert_snapshot!("placed_cuboid", recorded(placed).to_string());
    Ok(())
}

/// The recorded formula has the bits of the kernel at a few points.
struct Agrees<const D: usize>(Vec<Point<D>>);

impl<const D: usize> Visit<D> for Agrees<D> {
    type Output = Result<(), String>;

    fn visit<K: NamedKernel<D>>(self, kernel: K) -> Result<(), String> {
        let formula = recorded(|p| kernel.distance(p));
        for p in self.0 {
            let direct: f64 = kernel.distance(p);
            let recorded = formula.evaluate(&p.0);
            if direct.to_bits() != recorded.to_bits() {
                return Err(format!("{direct:e}, recorded {recorded:e} at {p:?}: {kernel:?}"));
            }
        }
        Ok(())
    }
}

fn formulas_agree<const D: usize>()
where
    Space: Dimension<D>,
{
    let catalogue = <Space as Dimension<D>>::CATALOGUE;
    let mut which = 0;
    cases::check(2 * catalogue.len() as u64, |u| {
        let entry = &catalogue[which % catalogue.len()];
        which += 1;
        let points = (0..64).map(|_| draw::vector(u)).collect::<Result<_, _>>()?;
        let drawn = draw::arguments::<D>(u, entry.name, entry.parameters)?;
        let Some(arguments) = drawn else {
            return Ok(Err(format!("no arguments found for {}", entry.name)));
        };
        Ok(Space::with_kernel(entry.name, &arguments, Agrees(points))
            .unwrap_or_else(|error| Err(error.to_string())))
    });
}

#[test]
fn every_primitive_can_be_recorded() {
    formulas_agree::<2>();
    formulas_agree::<3>();
}

fn formulas_of_trees_agree<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    cases::on_trees(count, 6, |u, _, shape: &Shape<D>| {
        let Some(formula) = shape.formula() else {
            return Ok(Err(format!("no formula of {shape}")));
        };
        for _ in 0..32 {
            let p = draw::point(u, shape)?;
            let (direct, recorded) = (shape.distance(p), formula.evaluate(&p.0));
            if direct.to_bits() != recorded.to_bits() {
                return Ok(Err(format!("{direct:e}, recorded {recorded:e} at {p:?}: {shape}")));
            }
        }
        Ok(Ok(()))
    });
}

#[test]
fn formulas_of_shapes_have_the_bits_of_their_distances() {
    formulas_of_trees_agree::<2>(600);
    formulas_of_trees_agree::<3>(600);
}

#[test]
fn what_occurs_twice_is_recorded_once() -> Result<(), ShapeError> {
    let ball = Shape::sphere(0.5)?;
    let one = ball.formula().map(|formula| formula.steps().len());
    let two = (&ball - &ball.clone().offset(-0.25)?).formula();
    // The offset's constant and subtraction, a negation and a maximum.
    assert_eq!(two.map(|formula| formula.steps().len()), one.map(|steps| steps + 4));
    Ok(())
}

#[test]
fn closures_have_no_formula() -> Result<(), ShapeError> {
    let floor = Shape::from_fn(Promise::lipschitz(None, 1.0), |p| p[1]);
    assert_eq!(floor.formula(), None);
    assert_eq!((floor | Shape::circle(0.5)?).formula(), None);
    Ok(())
}
