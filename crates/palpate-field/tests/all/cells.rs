// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of primitives over cells that are hard to bound: next to edges, where the
//! direction to the nearest point is rounding, and large ones.

use arbitrary::{Result, Unstructured};
use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Point, Shape, Vector};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;
use palpate_testkit::kernels::{Dimension, Space};
use palpate_testkit::laws::{self, Cell};

/// Sets of arguments drawn for each primitive.
const ARGUMENTS: u64 = 100;

/// Cells for each set.
const CELLS: usize = 40;

/// Samples of each cell.
const SAMPLES: usize = 24;

type Outcome = Result<std::result::Result<(), String>>;

/// Checks cells of each primitive, with arguments of all kinds.
fn on_primitives<const D: usize>(
    law: impl Fn(&mut Unstructured<'_>, &str, &Shape<D>) -> Outcome,
) where
    Space: Dimension<D>,
{
    let catalogue = <Space as Dimension<D>>::CATALOGUE;
    cases::numbered(ARGUMENTS * catalogue.len() as u64, |seed, u| {
        let entry = &catalogue[seed % catalogue.len()];
        let drawn = draw::arguments::<D>(u, entry.name, entry.parameters)?;
        let Some(Ok(shape)) = drawn.as_ref().map(|all| entry.build(all)) else {
            return Ok(Err(format!("no arguments found for {}", entry.name)));
        };
        for _ in 0..CELLS {
            if let Err(complaint) = law(u, entry.name, &shape)? {
                return Ok(Err(format!("{}: {complaint} of {drawn:?}", entry.name)));
            }
        }
        Ok(Ok(()))
    });
}

/// A point next to the surface, often next to an edge or corner, which is nearest to more
/// points outside than any of a face; out of it along any direction, or along what may be
/// the normal of a face, where the edge's normals begin.
fn next_to_an_edge<const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
) -> Result<Point<D>> {
    let size = draw::size(shape);
    let mut p = draw::point(u, shape)?;
    for _ in 0..4 {
        let (f, g) = shape.distance_gradient(p);
        p -= g * f;
    }
    let step = size * 10.0_f64.powf(draw::within(u, -16.5, -2.0)?);
    let out = if u.ratio(1_u8, 3_u8)? {
        draw::direction(u)?
    } else {
        // As seen from within.
        let inside = p - shape.distance_gradient(p).1 * (1e-3 * size);
        let beside = inside + draw::direction(u)? * (1e-3 * size);
        shape.distance_gradient(beside).1
    };
    p += out * step;
    if u.arbitrary()? {
        for x in &mut p.0 {
            *x += f64::EPSILON * x.abs() * f64::from(u.int_in_range(-4..=4_i32)?);
        }
    }
    Ok(p)
}

fn models_enclose_at_edges<const D: usize>()
where
    Space: Dimension<D>,
{
    on_primitives::<D>(|u, _, shape| {
        let centre = next_to_an_edge(u, shape)?;
        let half = draw::size(shape) * 10.0_f64.powf(draw::within(u, -9.0, 1.0)?);
        let mut samples = [[0.0; D]; SAMPLES];
        for x in samples.as_flattened_mut() {
            *x = draw::within(u, -1.0, 1.0)?;
        }
        let cell = Cell { centre, half: Vector::constant(half) };
        Ok(laws::model_encloses(shape, None, &[cell], &samples))
    });
}

#[test]
fn models_of_planar_primitives_enclose_at_edges() {
    models_enclose_at_edges::<2>();
}

#[test]
fn models_of_spatial_primitives_enclose_at_edges() {
    models_enclose_at_edges::<3>();
}

/// Its model is its formula's, up to three times as wide next to the axis: it is asked so
/// often, and is so short, that the comparison would cost more than it gives.
const UNCOMPARED: &str = "torus";

fn models_say_as_much_as_the_steepness<const D: usize>()
where
    Space: Dimension<D>,
{
    on_primitives::<D>(|u, name, shape| {
        if name == UNCOMPARED {
            return Ok(Ok(()));
        }
        let centre = draw::point(u, shape)?;
        let mut half = Vector::constant(10.0_f64.powf(draw::within(u, -6.0, 1.0)?));
        for x in &mut half.0 {
            *x *= draw::unit(u)?;
        }
        Ok(laws::model_says_as_much_as_the_steepness(shape, &Cell { centre, half }))
    });
}

#[test]
fn models_of_planar_primitives_say_as_much_as_their_steepness() {
    models_say_as_much_as_the_steepness::<2>();
}

#[test]
fn models_of_spatial_primitives_say_as_much_as_their_steepness() {
    models_say_as_much_as_the_steepness::<3>();
}

/// Half the side of small cells, as a share of the shape.
const SMALL: f64 = 1e-4;

/// Of small cells next to the surface, so many have models whose remainders are small beside the
/// cell. The others are at edges and corners, where the surface has no plane, and where points
/// are often drawn.
const SMOOTH: f64 = 0.5;

/// Remainders that are small, as a share of half the side of a cell.
const SECOND_ORDER: f64 = 0.05;

/// Remainders of small cells next to the surface are of second order.
fn models_follow_the_surface<const D: usize>()
where
    Space: Dimension<D>,
{
    let mut complaints = Vec::new();
    for entry in <Space as Dimension<D>>::CATALOGUE {
        let shape = entry.example().unwrap_or_else(|error| panic!("{}: {error}", entry.name));
        let half = SMALL * draw::size(&shape);
        let (mut asked, mut close) = (0, 0);
        // A share of few cases says little.
        cases::in_full(200, |u| {
            let mut p = draw::point(u, &shape)?;
            for _ in 0..4 {
                let (f, g) = shape.distance_gradient(p);
                p -= g * f;
            }
            let p = p + draw::direction(u)? * (draw::within(u, 0.0, 20.0)? * half);
            let mut block = Block::<Model, D, BLOCK>::zero();
            let mut models = Column::<Model, BLOCK>::zero();
            block.fill_boxes(1, None, |_| (p, Vector::constant(half)));
            shape.block_distances(&block, 1, &mut models);
            let model = models.get(0);
            asked += 1;
            close += u32::from(model.lower + model.upper <= SECOND_ORDER * half);
            Ok(Ok(()))
        });
        if f64::from(close) < SMOOTH * f64::from(asked) {
            complaints.push(format!("{close} of {asked} cells of {}", entry.name));
        }
    }
    assert!(complaints.is_empty(), "{complaints:#?}");
}

#[test]
fn models_of_planar_primitives_follow_the_surface() {
    models_follow_the_surface::<2>();
}

#[test]
fn models_of_spatial_primitives_follow_the_surface() {
    models_follow_the_surface::<3>();
}

/// The model of a shape over a box.
fn model_over(shape: &Shape<2>, centre: [f64; 2], half: f64) -> Model {
    let mut block = Block::<Model, 2, BLOCK>::zero();
    let mut models = Column::<Model, BLOCK>::zero();
    block.fill_boxes(1, None, |_| (Vector(centre), Vector::constant(half)));
    shape.block_distances(&block, 1, &mut models);
    models.get(0)
}

#[test]
fn the_model_of_a_polygon_follows_its_nearest_edges() {
    // A wheel of 96 edges with a wave, so that groups of edges are ruled out.
    let corner = |i: u32| {
        let angle = f64::from(i) / 96.0 * std::f64::consts::TAU;
        let radius = 1.0 + 0.2 * libm::sin(5.0 * angle);
        Vector([radius * libm::cos(angle), radius * libm::sin(angle)])
    };
    let wheel = Shape::polygon([(0..96).map(corner).collect::<Vec<_>>()]).unwrap();
    for i in -13..=13 {
        for j in -13..=13 {
            let centre = [f64::from(i) * 0.1017, f64::from(j) * 0.0983];
            let model = model_over(&wheel, centre, 1e-3);
            assert_eq!(model.value, wheel.distance(centre), "{centre:?}");
        }
    }
    // Across one edge, the distance is linear; next to a corner, it is bounded by a constant.
    let square =
        Shape::polygon([[[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]]).unwrap();
    for (centre, half, slope) in
        [([1.01, 0.3], 0.1, 0.1), ([0.99, 0.3], 0.1, 0.1), ([1.01, 0.95], 0.1, 0.0)]
    {
        let model = model_over(&square, centre, half);
        assert!((model.gradient[0] - slope).abs() < 1e-15, "{model:?}");
        assert_eq!(model.lower < 1e-12, slope > 0.0, "{model:?}");
    }
}
