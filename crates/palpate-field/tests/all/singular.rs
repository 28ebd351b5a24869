// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values and gradients are numbers where formulas divide by zero: at centres, on
//! axes, at corners and on surfaces.

use palpate_field::catalogue::Entry;
use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Point, Shape, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Sets of arguments drawn for each primitive.
const ARGUMENTS: u64 = 12;

/// Random trees.
const TREES: u64 = 200;

/// Room for the length of a gradient, in ulp.
const GRADIENT_ULP: f64 = 64.0;

/// Every combination of one of `choices[k]` along each axis `k`.
fn grid<const D: usize>(choices: &[Vec<f64>; D]) -> Vec<Point<D>> {
    let mut points = vec![Vector::ZERO];
    for (axis, values) in choices.iter().enumerate() {
        let with = |p: &Point<D>| {
            let p = *p;
            values.iter().map(move |x| {
                let mut q = p;
                q[axis] = *x;
                q
            })
        };
        points = points.iter().flat_map(with).collect();
    }
    points
}

/// The origin, the axes through it and through the centre, the corners, edges and
/// faces of the box, and points beyond each of them.
fn places<const D: usize>(shape: &Shape<D>) -> Vec<Point<D>> {
    let choices = std::array::from_fn(|axis| {
        let (low, high) = shape
            .promise()
            .bounds
            .map_or((-1.0, 1.0), |bounds| (bounds.aabb.min[axis], bounds.aabb.max[axis]));
        let centre = 0.5 * (low + high);
        let mut all = vec![-0.0, 0.0, low, centre, high, low - (high - low), 5e-324];
        all.dedup();
        all
    });
    let mut all = grid(&choices);
    // Each with the point of the surface near it, and what is an ulp away.
    for i in 0..all.len() {
        if let Some(on) = shape.surface_point(all[i]) {
            let ulp = |sign: f64| Vector(on.0.map(|x| x + sign * f64::EPSILON * x.abs()));
            all.extend([on, ulp(1.0), ulp(-1.0)]);
        }
    }
    all
}

fn numbers_at<const D: usize>(shape: &Shape<D>, p: Point<D>) -> Result<(), String> {
    let (f, g) = shape.distance_gradient(p);
    if !f.is_finite() || !g.is_finite() {
        return Err(format!("{f:e} with gradient {g:?} at {p:?}"));
    }
    let promise = shape.promise();
    let longest = promise.lipschitz * (1.0 + GRADIENT_ULP * f64::EPSILON);
    if promise.region.is_none() && g.norm() > longest {
        return Err(format!("gradient {g:?} of length {} at {p:?}", g.norm()));
    }
    let single = Vector(p.0.map(|x| x as f32));
    let (f, g) = shape.distance_gradient_f32(single);
    if !f.is_finite() || !g.0.iter().all(|x| x.is_finite()) {
        return Err(format!("{f:e} with gradient {g:?} in single precision at {p:?}"));
    }
    let mut cells = Block::<Model, D, BLOCK>::zero();
    let mut models = Column::zero();
    // A point, a flat cell and a box.
    let flat = std::array::from_fn(|axis| if axis == 0 { 0.0 } else { 0.1 });
    for (lane, half) in [[0.0; D], flat, [0.1; D]].into_iter().enumerate() {
        cells.set(lane, Vector(Model::cell(p.0, half)));
    }
    shape.block_distances(&cells, 3, &mut models);
    for model in (0..3).map(|lane| models.get(lane)) {
        let numbers = [model.value, model.lower, model.upper];
        let finite = numbers.iter().chain(&model.gradient).all(|x| x.is_finite());
        if !finite || model.lower < 0.0 || model.upper < 0.0 {
            return Err(format!("{model:?} at {p:?}"));
        }
    }
    Ok(())
}

fn numbers_everywhere<const D: usize>(shape: &Shape<D>) -> Result<(), String> {
    places(shape).into_iter().try_for_each(|p| numbers_at(shape, p))
}

fn primitives<const D: usize>(catalogue: &[Entry<D>])
where
    Space: Solid<D>,
{
    for entry in catalogue {
        let example = entry.example().unwrap_or_else(|error| panic!("{}: {error}", entry.name));
        assert_eq!(numbers_everywhere(&example), Ok(()), "{}", entry.name);
        cases::check(ARGUMENTS, |u| {
            let drawn = draw::arguments::<D>(u, entry.name, entry.parameters)?;
            let Some(Ok(shape)) = drawn.as_ref().map(|all| entry.build(all)) else {
                return Ok(Err(format!("no arguments found for {}", entry.name)));
            };
            Ok(numbers_everywhere(&shape)
                .map_err(|complaint| format!("{complaint}: {} of {drawn:?}", entry.name)))
        });
    }
}

fn trees<const D: usize>()
where
    Space: Solid<D> + Turn<D>,
{
    cases::on_trees(TREES, 6, |_, _, shape: &Shape<D>| Ok(numbers_everywhere(shape)));
}

#[test]
fn primitives_of_the_plane_have_numbers_everywhere() {
    primitives(Entry::<2>::ALL);
}

#[test]
fn primitives_of_space_have_numbers_everywhere() {
    primitives(Entry::<3>::ALL);
}

#[test]
fn trees_of_the_plane_have_numbers_everywhere() {
    trees::<2>();
}

#[test]
fn trees_of_space_have_numbers_everywhere() {
    trees::<3>();
}
