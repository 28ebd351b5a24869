// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The pairs, with bodies that are thin, long, hollow, pierced, smooth, bent, or only bounds.

use palpate_field::kernel::{
    Ball, CappedCone, Capsule, Cuboid, CuboidFrame, CutHollowSphere, Cylinder, Ellipsoid,
    HalfSpace, Heart, HexagonalPrism, Link, Moon, Octahedron, Polygon, RegularPolygon,
    RegularStar, Ring, RoundCone, RoundedCross, RoundedCuboid, Segment, Simplex, Torus,
};
use palpate_field::operator::{Copies, Profile};
use palpate_field::{Rotation, Shape, ShapeError, Vector};

use super::Pair;

type Result<T> = std::result::Result<T, ShapeError>;

/// Pairs in space.
///
/// # Errors
///
/// If a shape of this module is refused.
pub fn in_space() -> Result<Vec<Pair<3>>> {
    let needle = || Ok::<_, ShapeError>(Shape::from_kernel(Capsule::new(0.005, 1.0)?));
    let torus = || Ok::<_, ShapeError>(Shape::from_kernel(Torus::new(0.35, 0.15)?));
    let plate = || cuboid([1.0, 1.0, 0.02]);
    let pair = |name, a: Shape<3>, b: Shape<3>, rows| Pair { name, bodies: [a, b], rows };
    Ok(vec![
        pair("ball_ball", ball(0.4)?, ball(0.3)?, 500),
        pair("plate_torus", plate()?, torus()?, 600),
        pair("plate_plate", plate()?, cuboid([0.8, 0.03, 0.6])?, 600),
        pair("needle_needle", needle()?, needle()?, 700),
        pair("needle_perforated_plate", needle()?, perforated_plate()?, 500),
        pair("ball_in_a_hollow_sphere", hollow_sphere()?, ball(0.15)?, 500),
        pair("simplex_in_a_hollow_box", hollow_box()?, simplex()?, 600),
        pair("peg_drilled_block", drilled_block()?, peg()?, 500),
        pair("smooth_union_link", blob()?, link()?, 500),
        pair("twisted_bar_box", twisted_bar()?, cuboid([0.4, 0.5, 0.3])?, 500),
        pair("bent_bar_torus", bent_bar()?, torus()?, 500),
        pair("stretched_ball_stretched_prism", stretched_ball()?, stretched_prism()?, 500),
        pair("bumpy_ball_frame", bumpy_ball()?, frame()?, 500),
        pair("ellipsoid_cone", ellipsoid()?, cone()?, 500),
        pair("morphed_bowl", morphed()?, bowl()?, 500),
        pair("octahedron_round_cone", octahedron()?, round_cone()?, 500),
        pair("pile_pile", pile()?, pile()?, 500),
        pair("floor_simplex", floor()?, simplex()?, 500),
        pair("blade_bitten_cube", blade()?, bitten_cube()?, 500),
    ])
}

/// Pairs in the plane.
///
/// # Errors
///
/// If a shape of this module is refused.
pub fn in_the_plane() -> Result<Vec<Pair<2>>> {
    let pair = |name, a: Shape<2>, b: Shape<2>| Pair { name, bodies: [a, b], rows: 400 };
    let bar = Shape::from_kernel(Cuboid::new(Vector([1.0, 0.01]))?);
    let star = Shape::from_kernel(RegularStar::new(5, 0.5, 0.2)?);
    let ring = Shape::from_kernel(Ring::new(0.4, 0.41)?);
    let hexagon = Shape::from_kernel(RegularPolygon::new(6, 0.2)?);
    let heart = Shape::from_kernel(Heart::new(0.8)?).stretched([1.3, 0.6])?;
    let cross = Shape::from_kernel(RoundedCross::new(Vector([0.8, 0.6]), 0.7)?);
    let moon = Shape::from_kernel(Moon::new(0.4, 0.35, 0.15)?);
    let bent = Shape::from_kernel(Cuboid::new(Vector([1.0, 0.1]))?).bent(1.5)?;
    let row = Copies::Between { spacing: 0.2, first: -2, last: 2 };
    let comb = Shape::from_kernel(Cuboid::new(Vector([0.05, 0.4]))?)
        .repeated([row, Copies::One])?
        .translated(Vector([0.03, 0.2]))?;
    let comb = Shape::smooth_union([comb, bar.clone()], Profile::Root, 0.01)?;
    let window = Shape::from_kernel(Polygon::new(vec![
        [[-0.5, -0.4], [0.5, -0.3], [0.4, 0.5], [-0.3, 0.4]].map(Vector).to_vec(),
        [[-0.3, -0.2], [0.2, -0.15], [0.1, 0.3], [-0.2, 0.25]].map(Vector).to_vec(),
    ])?);
    Ok(vec![
        pair("bar_star", bar, star.clone()),
        pair("hexagon_in_a_ring", ring, hexagon),
        pair("stretched_heart_cross", heart, cross),
        pair("bent_bar_moon", bent, moon.clone()),
        pair("comb_star", comb, star),
        pair("window_moon", window, moon),
    ])
}

fn ball(radius: f64) -> Result<Shape<3>> {
    Ok(Shape::from_kernel(Ball::new(radius)?))
}

fn cuboid(size: [f64; 3]) -> Result<Shape<3>> {
    Ok(Shape::from_kernel(Cuboid::new(Vector(size))?))
}

fn hollow_sphere() -> Result<Shape<3>> {
    ball(0.5)?.shell(0.01)
}

fn hollow_box() -> Result<Shape<3>> {
    cuboid([1.0, 0.8, 0.6])?.shell(0.02)
}

fn simplex() -> Result<Shape<3>> {
    let corners =
        [[0.2, -0.1, -0.1], [-0.15, -0.12, 0.1], [-0.05, 0.25, 0.02], [0.0, 0.0, 0.3]];
    Ok(Shape::from_kernel(Simplex::new(corners.map(Vector).to_vec())?))
}

/// A plate with holes in an unbounded grid.
fn perforated_plate() -> Result<Shape<3>> {
    let row = Copies::Endless { spacing: 0.12 };
    let holes = Shape::from_kernel(Ball::new(0.045)?).repeated([row, Copies::One, row])?;
    cuboid([1.0, 0.04, 0.8])?.difference([holes])
}

fn drilled_block() -> Result<Shape<3>> {
    let hole = Shape::from_kernel(Cylinder::new(0.13, 2.0)?);
    let across = hole.clone().rotated(Rotation::from_axis_angle(
        Vector([1.0, 0.0, 0.3]),
        std::f64::consts::FRAC_PI_2,
    )?)?;
    cuboid([0.8, 0.6, 0.5])?.difference([hole.translated(Vector([0.2, 0.0, 0.05]))?, across])
}

fn peg() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(Cylinder::new(0.125, 0.9)?))
}

fn blob() -> Result<Shape<3>> {
    let parts = [([0.3, 0.0, 0.0], 0.2), ([-0.2, 0.2, 0.1], 0.25), ([0.0, -0.3, -0.1], 0.15)];
    let parts: Vec<_> = parts
        .into_iter()
        .map(|(place, radius)| ball(radius)?.translated(Vector(place)))
        .collect::<Result<_>>()?;
    Shape::smooth_union(parts, Profile::Cubic, 0.05)
}

fn link() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(Link::new(0.2, 0.06, 0.4)?))
}

fn twisted_bar() -> Result<Shape<3>> {
    cuboid([0.15, 1.0, 0.08])?.twisted(3.0)
}

fn bent_bar() -> Result<Shape<3>> {
    cuboid([1.0, 0.08, 0.1])?.bent(1.2)
}

fn stretched_ball() -> Result<Shape<3>> {
    ball(0.5)?.stretched([1.0, 0.2, 0.6])
}

fn stretched_prism() -> Result<Shape<3>> {
    let prism = Shape::from_kernel(HexagonalPrism::new(0.3, 0.4)?);
    prism.stretched([0.5, 1.8, 1.1])
}

fn bumpy_ball() -> Result<Shape<3>> {
    let row = Copies::Endless { spacing: 0.25 };
    let bumps = ball(0.08)?.repeated([row, row, row])?;
    ball(0.4)?.displaced(bumps, 0.05)
}

fn frame() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(CuboidFrame::new(Vector([0.9, 0.7, 0.5]), 0.02)?))
}

fn ellipsoid() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(Ellipsoid::new(Vector([0.5, 0.05, 0.3]))?))
}

fn cone() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(CappedCone::new(0.3, 0.01, 0.7)?))
}

fn morphed() -> Result<Shape<3>> {
    let rounded = Shape::from_kernel(RoundedCuboid::new(Vector([0.8, 0.3, 0.5]), 0.05)?);
    rounded.morphed(Shape::from_kernel(Torus::new(0.3, 0.1)?), 0.4)
}

fn bowl() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(CutHollowSphere::new(0.4, 0.1, 0.015)?))
}

fn octahedron() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(Octahedron::new(0.5)?))
}

fn round_cone() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(RoundCone::new(0.2, 0.02, 0.5)?))
}

/// A union of bodies at many places.
fn pile() -> Result<Shape<3>> {
    Shape::union([
        cuboid([0.5, 0.1, 0.3])?.translated(Vector([0.1, -0.2, 0.0]))?,
        Shape::from_kernel(Torus::new(0.2, 0.05)?).translated(Vector([-0.2, 0.1, 0.1]))?,
        simplex()?.translated(Vector([0.2, 0.1, 0.1]))?,
        Shape::from_kernel(Segment::new(
            Vector([-0.4, -0.3, -0.3]),
            Vector([0.3, 0.4, 0.2]),
            0.01,
        )?),
        ellipsoid()?.rotated(Rotation::from_quaternion([0.3, 0.1, -0.2, 0.9])?)?,
    ])
}

fn floor() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(HalfSpace::new(Vector([0.2, 1.0, -0.1]), 0.0)?))
}

fn blade() -> Result<Shape<3>> {
    Ok(Shape::from_kernel(Simplex::new(
        [[0.6, 0.0, 0.0], [-0.5, 0.1, 0.01], [-0.5, -0.1, 0.0], [0.0, 0.0, -0.02]]
            .map(Vector)
            .to_vec(),
    )?))
}

/// A cube without a ball, with the rim filled.
fn bitten_cube() -> Result<Shape<3>> {
    let bite = ball(0.3)?.translated(Vector([0.25, 0.2, 0.25]))?;
    cuboid([0.5, 0.5, 0.5])?.smooth_difference([bite], Profile::Quadratic, 0.02)
}
