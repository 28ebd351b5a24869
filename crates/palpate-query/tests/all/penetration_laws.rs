// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Penetrations of random bodies against oracles that share no code with the search: convex
//! polygons by their Minkowski difference, boxes by the separating axes of both, and bodies that are
//! not convex by many translations. All bodies are turned and far from the origin.

use arbitrary::Unstructured;
use palpate_field::{Point, Pose, Rotation, Shape, Vector};
use palpate_query::{Limits, PairWorkspace, Placed, Stop, overlap, penetration};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;

/// How far bodies are from the origin along an axis at most [m].
const FAR: f64 = 100.0;

/// What places and oracles may round by [m].
const ROUNDING: f64 = 1e-10;

/// How far apart bounds of convex bodies may be [m]. Rounding allows about 1e-6 of the size.
const TOLERANCES: [f64; 3] = [1e-2, 1e-4, 1e-5];

type Verdict = arbitrary::Result<Result<(), String>>;

/// A pose at which a body is that overlaps one at `near`, as often as not.
fn nearby<const D: usize>(
    u: &mut Unstructured<'_>,
    near: &Pose<D>,
    size: f64,
) -> arbitrary::Result<Pose<D>>
where
    Space: Turn<D>,
{
    let beside = draw::direction::<D>(u)? * (size * draw::unit(u)?);
    let rotation = match u.ratio(1, 4)? {
        true => near.rotation,
        false => <Space as Turn<D>>::rotation(u)?,
    };
    let beside = if u.ratio(1, 8)? { Vector::ZERO } else { beside };
    Ok(Pose::new(rotation, near.translation + beside))
}

fn far<const D: usize>(u: &mut Unstructured<'_>) -> arbitrary::Result<Pose<D>>
where
    Space: Turn<D>,
{
    let rotation = <Space as Turn<D>>::rotation(u)?;
    Ok(Pose::new(rotation, draw::direction::<D>(u)? * (FAR * draw::unit(u)?)))
}

/// The corners of the convex hull of points, counter-clockwise.
fn hull(mut points: Vec<Point<2>>) -> Vec<Point<2>> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turns = |a: Point<2>, b: Point<2>, c: Point<2>| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let half = |points: &mut dyn Iterator<Item = Point<2>>| {
        let mut chain: Vec<Point<2>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if turns(a, b, p) {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let lower = half(&mut points.iter().copied());
    let upper = half(&mut points.iter().rev().copied());
    [lower, upper].concat()
}

/// Corners of a convex polygon of up to twelve sides, about 1 m wide, or flat.
fn corners(u: &mut Unstructured<'_>) -> arbitrary::Result<Vec<Point<2>>> {
    let flat = [1.0, 0.3, 0.03][u.choose_index(3)?];
    let count = u.int_in_range(3..=12)?;
    let mut points = Vec::new();
    for _ in 0..count {
        let p = draw::direction::<2>(u)? * draw::unit(u)?.sqrt();
        points.push(Vector([p[0], flat * p[1]]));
    }
    Ok(hull(points))
}

/// The distance of the origin from the border of the Minkowski difference of two convex polygons,
/// negative outside: the penetration.
fn depth_of_polygons(a: &[Point<2>], b: &[Point<2>]) -> f64 {
    let differences = a.iter().flat_map(|p| b.iter().map(move |q| *p - *q)).collect();
    let all = hull(differences);
    let edges = all.iter().zip(all.iter().cycle().skip(1));
    let heights = edges.map(|(p, q)| {
        let edge = *q - *p;
        Vector([edge[1], -edge[0]]).dot(*p) / edge.norm()
    });
    heights.fold(f64::INFINITY, f64::min)
}

/// Compares bounds with the truth, which is zero for bodies that are apart.
fn verdict<const D: usize>(
    [a, b]: [Placed<'_, D>; 2],
    truth: f64,
    tolerance: f64,
) -> Result<(), String> {
    let limits = Limits::new(tolerance);
    let found = penetration(a, b, &limits, &mut PairWorkspace::new());
    let found = found.map_err(|error| error.to_string())?;
    let truth = truth.max(0.0);
    let holds = found.lower <= truth + ROUNDING && truth <= found.upper + ROUNDING;
    let is_close = found.upper - found.lower <= tolerance;
    let ends = matches!(found.stop, Stop::Converged | Stop::SignKnown);
    if holds && is_close && ends {
        return Ok(());
    }
    Err(format!("{truth} is not {found:?} of {:?} and {:?}", a.shape, b.shape))
}

#[test]
fn convex_polygons_penetrate_as_their_minkowski_difference_says() {
    cases::check(2000, |u| -> Verdict {
        let (first, second) = (corners(u)?, corners(u)?);
        let pose = far::<2>(u)?;
        let other = nearby(u, &pose, 1.5)?;
        let tolerance = TOLERANCES[u.choose_index(3)?];
        let place = |pose: &Pose<2>, points: &[Point<2>]| -> Vec<_> {
            points.iter().map(|p| pose.transform_point(*p) - other.translation).collect()
        };
        let truth = depth_of_polygons(&place(&pose, &first), &place(&other, &second));
        let [Ok(a), Ok(b)] = [first, second].map(|points| Shape::polygon(vec![points])) else {
            return Ok(Ok(()));
        };
        Ok(verdict([Placed::new(&a, pose), Placed::new(&b, other)], truth, tolerance))
    });
}

/// The least overlap of two boxes along the normals of both and the cross products of their edges:
/// the penetration, negative if they are apart.
fn depth_of_boxes(halves: [Vector<f64, 3>; 2], poses: &[Pose<3>; 2]) -> f64 {
    let axes = poses
        .each_ref()
        .map(|pose| [0, 1, 2].map(|k| pose.transform_vector(Vector::<f64, 3>::unit(k))));
    let between = poses[1].translation - poses[0].translation;
    let crossed = axes[0].iter().flat_map(|x| axes[1].iter().map(|y| x.cross(*y)));
    let normals = axes.iter().flatten().copied();
    // Cross products of nearly parallel edges say what the normals say.
    let all = normals.chain(crossed).filter(|axis| axis.norm() > 1e-6);
    let depths = all.map(|axis| {
        let axis = axis * (1.0 / axis.norm());
        let reach = |i: usize| -> f64 {
            (0..3).map(|k| halves[i][k] * axes[i][k].dot(axis).abs()).sum()
        };
        reach(0) + reach(1) - between.dot(axis).abs()
    });
    depths.fold(f64::INFINITY, f64::min)
}

#[test]
fn boxes_penetrate_as_fifteen_axes_say() {
    cases::check(500, |u| -> Verdict {
        let mut size = || -> arbitrary::Result<Vector<f64, 3>> {
            let mut side =
                || Ok([1.0, 0.5, 0.3, 0.05][u.choose_index(4)?] * draw::within(u, 0.5, 1.0)?);
            Ok(Vector([side()?, side()?, side()?]))
        };
        let sizes = [size()?, size()?];
        let pose = far::<3>(u)?;
        let other = nearby(u, &pose, 1.0)?;
        let tolerance = TOLERANCES[u.choose_index(3)?];
        let truth = depth_of_boxes(sizes.map(|size| size * 0.5), &[pose, other]);
        let [Ok(a), Ok(b)] = sizes.map(Shape::<3>::cuboid) else { return Ok(Ok(())) };
        Ok(verdict([Placed::new(&a, pose), Placed::new(&b, other)], truth, tolerance))
    });
}

/// Unions of a few convex shapes, about 1 m wide.
fn heap<const D: usize>(u: &mut Unstructured<'_>) -> arbitrary::Result<Option<Shape<D>>>
where
    Space: Turn<D>,
{
    let mut whole: Option<Shape<D>> = None;
    for _ in 0..u.int_in_range(2..=3)? {
        let rotation: Rotation<D> = <Space as Turn<D>>::rotation(u)?;
        let place = draw::direction::<D>(u)? * (0.5 * draw::unit(u)?);
        let mut sides = Vector::constant(0.0);
        for k in 0..D {
            sides[k] = draw::within(u, 0.1, 0.8)?;
        }
        let part = match u.ratio(1, 3)? {
            true => Shape::<D>::ball(0.5 * sides[0]),
            false => Shape::<D>::cuboid(sides),
        };
        let part = part.and_then(|part| part.placed(&Pose::new(rotation, place)));
        let Ok(part) = part else { return Ok(None) };
        whole = Some(match whole {
            Some(whole) => whole | part,
            None => part,
        });
    }
    Ok(whole)
}

/// Translations that are tried in each case.
const TRIED: u32 = 40;

/// No translation shorter than the lower bound separates the bodies, the one of the answer does, and
/// no translation that does is much shorter than the upper bound.
fn by_many_translations<const D: usize>(u: &mut Unstructured<'_>) -> Verdict
where
    Space: Turn<D>,
{
    let (Some(a), Some(b)) = (heap::<D>(u)?, heap::<D>(u)?) else { return Ok(Ok(())) };
    let pose = far::<D>(u)?;
    let other = nearby(u, &pose, 0.6)?;
    let mut workspace = PairWorkspace::new();
    let (first, second) = (Placed::new(&a, pose), Placed::new(&b, other));
    let limits = Limits::new(0.01).with_budget(60_000);
    let found = match penetration(first, second, &limits, &mut workspace) {
        Ok(found) => found,
        Err(error) => return Ok(Err(error.to_string())),
    };
    let mut after = |t: Vector<f64, D>| {
        let moved = Pose::new(other.rotation, other.translation + t);
        overlap(first, Placed::new(&b, moved), &Limits::new(1e-6), &mut workspace)
    };
    let complain = |what: &str| Ok(Err(format!("{what}: {found:?} of {a:?} and {b:?}")));
    if let Some(direction) = found.best.direction {
        let Ok(end) = after(direction * found.upper) else { return complain("refused") };
        if end.upper < -ROUNDING {
            return complain("the end is not free");
        }
    }
    let tried = if found.lower > 0.0 { TRIED } else { 0 };
    for _ in 0..tried {
        let direction = draw::direction::<D>(u)?;
        // Most next to the bound, where it is wrong first.
        let length = found.lower * (1.0 - draw::unit(u)?.powi(3));
        let Ok(end) = after(direction * length) else { return complain("refused") };
        if end.lower > ROUNDING {
            return complain(&format!("{length} along {direction:?} separates"));
        }
    }
    if found.upper - found.lower > 0.01 + ROUNDING && found.stop == Stop::Converged {
        return complain("the bounds are far apart");
    }
    Ok(Ok(()))
}

#[test]
fn no_shorter_translation_than_the_lower_bound_separates_heaps_in_the_plane() {
    cases::check(100, by_many_translations::<2>);
}

#[test]
fn no_shorter_translation_than_the_lower_bound_separates_heaps_in_space() {
    cases::check(50, by_many_translations::<3>);
}
