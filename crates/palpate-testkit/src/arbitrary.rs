// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Generators of trees and points, biased towards what breaks formulas.
//!
//! They draw from [`Unstructured`], so property tests and fuzzing share them.
#![expect(clippy::missing_errors_doc, reason = "all errors are those of Unstructured")]

use arbitrary::{Result, Unstructured};
use palpate_field::kernel::{Argument, Parameter, ParameterKind};
use palpate_field::operator::{Copies, Operator, Profile};
use palpate_field::{Point, Pose, Rotation, Screw, Shape, Vector};

use crate::kernels::{Dimension, IntoShape, Space};
use crate::tree::{Boolean, Solid, Sweep, Tree};

/// How often arguments are drawn again when they break a rule.
const ATTEMPTS: usize = 32;

/// A number in `[0, 1)`.
pub fn unit(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(f64::from(u.arbitrary::<u32>()?) / 4_294_967_296.0)
}

/// A number in `[low, high)`.
pub fn within(u: &mut Unstructured<'_>, low: f64, high: f64) -> Result<f64> {
    Ok(low + (high - low) * unit(u)?)
}

/// A positive length of about 1 m, at times tiny, or equal to others.
pub fn length(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(match u.int_in_range(0..=9_u8)? {
        0 | 1 => *u.choose(&[0.25, 0.5, 1.0])?,
        2 => 10.0_f64.powf(within(u, -3.0, -1.0)?),
        3 => 0.5 * (1.0 + f64::EPSILON * f64::from(u.int_in_range(-32..=32_i32)?)),
        _ => within(u, 0.1, 1.5)?,
    })
}

/// A coordinate of at most 1.5 m, at times zero or equal to others.
pub fn coordinate(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(match u.int_in_range(0..=9_u8)? {
        0 => 0.0,
        1 => *u.choose(&[-1.0, -0.5, -0.25, 0.25, 0.5, 1.0])?,
        _ => within(u, -1.5, 1.5)?,
    })
}

/// A vector of [`coordinate`]s.
pub fn vector<const D: usize>(u: &mut Unstructured<'_>) -> Result<Vector<f64, D>> {
    let mut v = Vector::ZERO;
    for x in &mut v.0 {
        *x = coordinate(u)?;
    }
    Ok(v)
}

/// A unit vector, at times along an axis or a diagonal.
pub fn direction<const D: usize>(u: &mut Unstructured<'_>) -> Result<Vector<f64, D>> {
    let mut v = Vector::ZERO;
    let plain = u.ratio(1_u8, 4_u8)?;
    for x in &mut v.0 {
        *x = if plain { f64::from(u.int_in_range(-1..=1_i8)?) } else { within(u, -1.0, 1.0)? };
    }
    Ok(v.normalized().unwrap_or(Vector::unit(0)))
}

/// As many points as a primitive needs, in one plane if the primitive needs that.
fn points<const D: usize>(u: &mut Unstructured<'_>, primitive: &str) -> Result<Vec<Vec<f64>>> {
    if primitive == "quad_sheet" {
        // The ends of two diagonals that cross.
        let (centre, first, second) = (vector::<D>(u)?, vector::<D>(u)?, vector::<D>(u)?);
        let mut end = |diagonal: Vector<f64, D>, sign: f64| -> Result<Vec<f64>> {
            Ok((centre + diagonal * (sign * length(u)?)).0.to_vec())
        };
        return Ok(vec![
            end(first, 1.0)?,
            end(second, 1.0)?,
            end(first, -1.0)?,
            end(second, -1.0)?,
        ]);
    }
    let count = if primitive == "triangle_sheet" { 3 } else { D + 1 };
    (0..count).map(|_| Ok(vector::<D>(u)?.0.to_vec())).collect()
}

fn argument<const D: usize>(
    u: &mut Unstructured<'_>,
    primitive: &str,
    what: &Parameter,
) -> Result<Argument> {
    let components = |u: &mut Unstructured<'_>, positive: bool| -> Result<Vec<f64>> {
        (0..D).map(|_| if positive { length(u) } else { coordinate(u) }).collect()
    };
    Ok(match what.kind {
        // Walls of up to 1.5 m would mostly fill their shape.
        ParameterKind::Length if what.name == "thickness" => Argument::Number(0.2 * length(u)?),
        // A deeper dip would leave little of the shape.
        ParameterKind::Length if what.name == "dip" => Argument::Number(0.15 * length(u)?),
        ParameterKind::Length => Argument::Number(length(u)?),
        ParameterKind::LengthOrZero => {
            let zero = u.ratio(1_u8, 5_u8)?;
            Argument::Number(if zero { 0.0 } else { 0.3 * length(u)? })
        }
        ParameterKind::Coordinate => Argument::Number(coordinate(u)?),
        ParameterKind::Angle => Argument::Number(match u.int_in_range(0..=5_u8)? {
            0 => std::f64::consts::TAU,
            1 => std::f64::consts::PI,
            _ => within(u, 0.01, std::f64::consts::TAU)?,
        }),
        // Some primitives accept an exponent of two, others refuse it.
        ParameterKind::Count if what.name.ends_with("exponent") => {
            Argument::Count(*u.choose(&[2, 4, 6, 8])?)
        }
        ParameterKind::Count if what.name == "starts" => {
            Argument::Count(u.int_in_range(1..=3)?)
        }
        ParameterKind::Count => Argument::Count(match u.int_in_range(0..=3_u8)? {
            0 => u.int_in_range(3..=256)?,
            // Polygons and stars have at least three.
            _ => u.int_in_range(if what.name == "steps" { 1 } else { 3 }..=12)?,
        }),
        // Crests, roots and depths of threads are parts of their pitch and radius.
        ParameterKind::Vector if what.name == "profile" => {
            let part = |u: &mut Unstructured<'_>| -> Result<f64> {
                Ok(if u.ratio(1_u8, 5_u8)? { 0.0 } else { 0.3 * length(u)? })
            };
            Argument::Vector((0..D).map(|_| part(u)).collect::<Result<_>>()?)
        }
        ParameterKind::Vector | ParameterKind::Direction => {
            // Sizes and radii must be positive; all else may have any sign.
            let positive = what.name == "size" || what.name == "radii";
            Argument::Vector(components(u, positive)?)
        }
        ParameterKind::Points => Argument::Points(points::<D>(u, primitive)?),
        ParameterKind::Rings => {
            let rings = u.int_in_range(1..=2_usize)?;
            let ring = |u: &mut Unstructured<'_>| -> Result<Vec<Vec<f64>>> {
                let points = u.int_in_range(3..=7_usize)?;
                (0..points).map(|_| components(u, false)).collect()
            };
            Argument::Rings((0..rings).map(|_| ring(u)).collect::<Result<_>>()?)
        }
    })
}

/// Arguments that a primitive accepts.
pub fn arguments<const D: usize>(
    u: &mut Unstructured<'_>,
    name: &'static str,
    parameters: &[Parameter],
) -> Result<Option<Vec<Argument>>>
where
    Space: Dimension<D>,
{
    for _ in 0..ATTEMPTS {
        let arguments: Vec<_> =
            parameters.iter().map(|p| argument::<D>(u, name, p)).collect::<Result<_>>()?;
        if Space::with_kernel(name, &arguments, IntoShape).is_ok() {
            return Ok(Some(arguments));
        }
    }
    Ok(None)
}

/// A primitive of any kind.
pub fn leaf<const D: usize>(u: &mut Unstructured<'_>) -> Result<Tree<D>>
where
    Space: Solid<D>,
{
    let entry = u.choose(<Space as Dimension<D>>::CATALOGUE)?;
    let drawn = arguments::<D>(u, entry.name, entry.parameters)?;
    Ok(drawn.map_or_else(
        || Tree::leaf("ball", vec![Argument::Number(0.5)]),
        |arguments| Tree::leaf(entry.name, arguments),
    ))
}

/// Rotations, in either dimension.
pub trait Turn<const D: usize> {
    /// A rotation, at times along the axes.
    fn rotation(u: &mut Unstructured<'_>) -> Result<Rotation<D>>;

    /// A solid of a profile of at most `depth`; `None` in the plane, which has no solids.
    fn solid(u: &mut Unstructured<'_>, depth: usize) -> Result<Option<Tree<D>>>;
}

fn angle(u: &mut Unstructured<'_>) -> Result<f64> {
    use std::f64::consts::{FRAC_PI_2, PI};
    Ok(match u.int_in_range(0..=4_u8)? {
        0 => *u.choose(&[0.0, FRAC_PI_2, PI, -FRAC_PI_2])?,
        _ => within(u, -PI, PI)?,
    })
}

impl Turn<2> for Space {
    fn rotation(u: &mut Unstructured<'_>) -> Result<Rotation<2>> {
        let angle = angle(u)?;
        Ok(Rotation::from_angle(angle).unwrap_or_else(|_| Rotation::identity()))
    }

    fn solid(_: &mut Unstructured<'_>, _: usize) -> Result<Option<Tree<2>>> {
        Ok(None)
    }
}

impl Turn<3> for Space {
    fn rotation(u: &mut Unstructured<'_>) -> Result<Rotation<3>> {
        let (axis, angle) = (direction(u)?, angle(u)?);
        Ok(Rotation::from_axis_angle(axis, angle).unwrap_or_else(|_| Rotation::identity()))
    }

    fn solid(u: &mut Unstructured<'_>, depth: usize) -> Result<Option<Tree<3>>> {
        let profile = Box::new(tree::<2>(u, depth)?);
        let extruded = u.arbitrary()?;
        let sweep = if extruded { Sweep::Extruded(length(u)?) } else { Sweep::Revolved };
        Ok(Some(Tree::Solid(profile, sweep)))
    }
}

/// A rigid motion by at most 1.5 m along each axis.
pub fn pose<const D: usize>(u: &mut Unstructured<'_>) -> Result<Pose<D>>
where
    Space: Turn<D>,
{
    Ok(Pose::new(<Space as Turn<D>>::rotation(u)?, vector(u)?))
}

/// A motion between two poses whose translations are those of [`pose`] times `far`, with whole turns
/// where there is such a screw.
pub fn screw<const D: usize>(u: &mut Unstructured<'_>, far: f64, turns: i32) -> Result<Screw<D>>
where
    Space: Turn<D>,
{
    let mut end = || -> Result<Pose<D>> {
        let Pose { rotation, translation } = pose(u)?;
        Ok(Pose::new(rotation, translation * far))
    };
    let (from, to) = (end()?, end()?);
    // In the plane, whole turns may have no centre.
    let screw = Screw::new(from, to, turns).or_else(|_| Screw::new(from, to, 0));
    screw.map_err(|_| arbitrary::Error::IncorrectFormat)
}

fn factor(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(match u.int_in_range(0..=5_u8)? {
        0 => 10.0_f64.powf(within(u, -3.0, 3.0)?),
        1 => *u.choose(&[0.5, 1.0, 2.0])?,
        _ => within(u, 0.3, 3.0)?,
    })
}

/// A tree of at most `depth`, of which [`Tree::shape`] makes a shape.
pub fn tree<const D: usize>(u: &mut Unstructured<'_>, depth: usize) -> Result<Tree<D>>
where
    Space: Solid<D> + Turn<D>,
{
    if depth <= 1 {
        return leaf(u);
    }
    let tree = operator(u, depth - 1)?;
    // A tree that an operator refuses, such as one that shrinks to nothing, becomes a leaf.
    if tree.shape().is_ok() { Ok(tree) } else { leaf(u) }
}

fn several<const D: usize>(
    u: &mut Unstructured<'_>,
    depth: usize,
    most: usize,
) -> Result<Vec<Tree<D>>>
where
    Space: Solid<D> + Turn<D>,
{
    let count = u.int_in_range(2..=most)?;
    (0..count)
        .map(|i| {
            // One deep branch is enough.
            let depth = if i == 0 { depth } else { u.int_in_range(1..=depth.min(2))? };
            tree(u, depth)
        })
        .collect()
}

/// A row of copies of a shape of about `width` [m], few or without end.
fn copies(u: &mut Unstructured<'_>, width: f64) -> Result<Copies> {
    let spacing = width * within(u, 0.3, 2.0)?;
    Ok(match u.int_in_range(0..=3_u8)? {
        0 | 1 => Copies::One,
        2 => {
            // At times without the copy at the origin, and far from it.
            let away = if u.ratio(1, 4)? { *u.choose(&[-1000, -5, 5, 1000])? } else { 0 };
            let first = away + u.int_in_range(-3..=1_i32)?;
            Copies::Between { spacing, first, last: first + u.int_in_range(0..=4)? }
        }
        _ => Copies::Endless { spacing },
    })
}

/// The profiles of smooth booleans.
pub const PROFILES: [Profile; 7] = [
    Profile::Quadratic,
    Profile::Cubic,
    Profile::Quartic,
    Profile::Circular,
    Profile::Root,
    Profile::Exponential,
    Profile::CircularGeometrical,
];

/// The profile of a smooth boolean.
fn profile(u: &mut Unstructured<'_>) -> Result<Profile> {
    Ok(*u.choose(&PROFILES)?)
}

fn operator<const D: usize>(u: &mut Unstructured<'_>, depth: usize) -> Result<Tree<D>>
where
    Space: Solid<D> + Turn<D>,
{
    let child = |u: &mut Unstructured<'_>| tree(u, depth).map(Box::new);
    Ok(match u.int_in_range(0..=19_u8)? {
        0 => Tree::Union(several(u, depth, 9)?),
        1 => Tree::Union(several(u, depth, 3)?),
        2 => Tree::Intersection(several(u, depth, 3)?),
        3 => Tree::Difference(child(u)?, several(u, depth.min(2), 2)?),
        4 => Tree::SymmetricDifference(several(u, depth, 3)?),
        5 => {
            let shapes = several(u, depth, 3)?;
            Tree::Smooth(Boolean::Union, shapes, profile(u)?, 0.3 * length(u)?)
        }
        6 => {
            let boolean = *u.choose(&[Boolean::Intersection, Boolean::Difference])?;
            let shapes = several(u, depth, 3)?;
            Tree::Smooth(boolean, shapes, profile(u)?, 0.3 * length(u)?)
        }
        7 => {
            let sign = if u.arbitrary()? { 1.0 } else { -0.2 };
            Tree::Offset(child(u)?, sign * length(u)?)
        }
        which @ (8 | 9) => {
            // The first operator of the catalogue, or one of the others.
            let [first, others @ ..] = Operator::ALL else {
                unreachable!("there are operators")
            };
            let operator = *if which == 8 { first } else { u.choose(others)? };
            if operator.is_per_axis {
                let mut lengths = vec![0.0; D];
                for x in &mut lengths {
                    *x = if u.arbitrary()? { length(u)? } else { 0.0 };
                }
                Tree::Operated(child(u)?, operator, Argument::Vector(lengths))
            } else {
                let tree = child(u)?;
                Tree::Operated(tree, operator, Argument::Number(0.3 * length(u)?))
            }
        }
        10 => Tree::Mirrored(child(u)?, u.int_in_range(0..=D - 1)?),
        11 => Tree::Scaled(child(u)?, factor(u)?),
        12 => {
            let mut factors = [1.0; D];
            for x in &mut factors {
                *x = within(u, 0.3, 2.0)?;
            }
            Tree::Stretched(child(u)?, factors)
        }
        13 => match <Space as Turn<D>>::solid(u, depth)? {
            Some(solid) => solid,
            None => Tree::Placed(child(u)?, pose(u)?),
        },
        14 => Tree::Bent(child(u)?, within(u, -3.0, 3.0)?),
        15 => Tree::Twisted(child(u)?, within(u, -3.0, 3.0)?),
        16 => Tree::Displaced(child(u)?, child(u)?, 0.3 * length(u)?),
        17 => Tree::Morphed(child(u)?, child(u)?, unit(u)?),
        18 => {
            let tree = child(u)?;
            let width = tree.shape().ok().map_or(1.0, |shape| 2.0 * size(&shape));
            let mut rows = [Copies::One; D];
            for row in &mut rows {
                *row = copies(u, width)?;
            }
            Tree::Repeated(tree, rows)
        }
        _ => Tree::Placed(child(u)?, pose(u)?),
    })
}

/// Two shapes of trees of at most `depth`, the second placed about the first; `None` if neither
/// is bounded.
pub fn two<const D: usize>(
    u: &mut Unstructured<'_>,
    depth: usize,
) -> Result<Option<[Shape<D>; 2]>>
where
    Space: Solid<D> + Turn<D>,
{
    let (a, b): (Tree<D>, Tree<D>) = (tree(u, depth)?, tree(u, depth)?);
    let (Ok(a), Ok(b)) = (a.shape(), b.shape()) else { return Ok(None) };
    let away = direction::<D>(u)? * (size(&a) * 2.0 * unit(u)?);
    let Ok(b) = b.translated(away) else { return Ok(None) };
    let is_bounded = a.promise().bounds.is_some() || b.promise().bounds.is_some();
    Ok(is_bounded.then_some([a, b]))
}

/// The size of a scene with the shape in it [m].
#[must_use]
pub fn size<const D: usize>(shape: &Shape<D>) -> f64 {
    shape.promise().bounds.map_or(2.0, |b| b.radius_about_origin()).max(1e-12)
}

/// A point near a shape: anywhere in or around its box, on an axis or at a corner of the box,
/// on the surface, a few ulp from such a point, or far away.
pub fn point<const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
) -> Result<Vector<f64, D>> {
    let size = size(shape);
    let (centre, half) =
        shape.promise().bounds.map_or((Vector::ZERO, Vector::constant(size)), |b| {
            (b.aabb.centre(), b.aabb.half_extents())
        });
    let mut p = centre;
    match u.int_in_range(0..=9_u8)? {
        0 => {
            // The centre, corners, edges and faces of the box; the origin's axes.
            for k in 0..D {
                p[k] += half[k] * f64::from(u.int_in_range(-1..=1_i8)?);
            }
        }
        1 => {
            p = Vector::ZERO;
            p[u.int_in_range(0..=D - 1)?] = size * within(u, -2.0, 2.0)?;
        }
        2 => {
            p = Vector(vector::<D>(u)?.0.map(|x| x * size));
        }
        3 => {
            let far = 10.0_f64.powf(within(u, 0.5, 3.0)?) * size;
            p = direction::<D>(u)? * far;
        }
        _ => {
            for k in 0..D {
                p[k] += half[k].max(1e-3 * size) * within(u, -1.5, 1.5)?;
            }
        }
    }
    // Steps onto the surface, or where the field's value is zero.
    if u.ratio(1_u8, 4_u8)? {
        for _ in 0..3 {
            let (f, g) = shape.distance_gradient(p);
            p -= g * f;
        }
    }
    if u.ratio(1_u8, 6_u8)? {
        for x in &mut p.0 {
            *x += f64::EPSILON * x.abs() * f64::from(u.int_in_range(-32..=32_i32)?);
        }
    }
    Ok(if p.is_finite() { p } else { centre })
}

/// Points all over a segment or a triangle, `along` of them on each edge, its ends included.
pub fn all_over<const N: usize, const D: usize>(
    vertices: &[Point<D>; N],
    along: u32,
) -> Vec<Point<D>> {
    let mut points = Vec::new();
    for i in 0..=along {
        for k in 0..=(if N == 3 { along - i } else { 0 }) {
            let (s, t) = (f64::from(i), f64::from(k));
            let sum = vertices[0] * (f64::from(along) - s - t) + vertices[1] * s;
            points.push((sum + vertices[N - 1] * t) * (1.0 / f64::from(along)));
        }
    }
    points
}
