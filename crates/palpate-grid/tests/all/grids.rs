// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Grids of shapes: what they promise, against the shapes, and the numbers of their splines.

use std::ops::ControlFlow;

use palpate_field::operator::Profile;
use palpate_field::scalar::Model;
use palpate_field::{Aabb, CustomField, Point, Rotation, Shape, Vector};
use palpate_grid::{Grid, GridError, GridKernel, GridOptions, Lattice, Store};
use palpate_testkit::arbitrary::{coordinate, direction, within};
use palpate_testkit::cases;
use palpate_testkit::laws::bits_agree;

const KERNELS: [GridKernel; 2] = [GridKernel::Quadratic, GridKernel::Trilinear];
const STORES: [Store; 3] = [Store::F32, Store::I16, Store::I8];

fn options(cell: f64, kernel: GridKernel) -> GridOptions {
    GridOptions { kernel, ..GridOptions::with_cell(cell) }
}

/// Solids with edges, a thin wall, a crease, holes.
fn solids() -> Vec<(&'static str, Shape<3>)> {
    let turn = Rotation::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let cuboid = Shape::cuboid([0.5, 0.3, 0.4]).unwrap();
    let ball = Shape::sphere(0.3).unwrap();
    let torus = Shape::torus(0.3, 0.1).unwrap();
    vec![
        ("ball", ball.clone()),
        ("torus", torus.clone()),
        ("turned box", cuboid.clone().rotated(turn).unwrap()),
        ("plate", Shape::cuboid([0.5, 0.5, 0.03]).unwrap().rotated(turn).unwrap()),
        ("box less ball", cuboid.clone() - ball.translated([0.2, 0.1, 0.1]).unwrap()),
        ("blend", Shape::smooth_union([cuboid, torus], Profile::Quadratic, 0.1).unwrap()),
    ]
}

/// A point in the box of a grid, or around it.
fn point<const D: usize>(
    u: &mut arbitrary::Unstructured<'_>,
    grid: &Grid<D>,
    out: f64,
) -> arbitrary::Result<Point<D>> {
    let region = grid.lattice().region().grown(out);
    let mut p = Vector([0.0; D]);
    for i in 0..D {
        p[i] = within(u, region.min[i], region.max[i])?;
    }
    Ok(p)
}

#[test]
fn blocks_have_the_bits_of_points() {
    let disc = Shape::<2>::circle(0.3).unwrap();
    let torus = Shape::torus(0.3, 0.1).unwrap();
    for kernel in KERNELS {
        for (store, band) in STORES.into_iter().flat_map(|s| [(s, None), (s, Some(5.0))]) {
            let mut options = GridOptions { store, ..options(0.03, kernel) };
            options.band = band;
            let planar = Grid::bake(&disc, &options).unwrap();
            let spatial = Grid::bake(&torus, &options).unwrap();
            cases::check(20, |u| {
                let points = (0..64).map(|_| point(u, &planar, 0.1));
                let points = points.collect::<arbitrary::Result<Vec<_>>>()?;
                Ok(bits_agree(&planar.clone().into(), &points))
            });
            cases::check(20, |u| {
                let points = (0..61).map(|_| point(u, &spatial, 0.1));
                let points = points.collect::<arbitrary::Result<Vec<_>>>()?;
                Ok(bits_agree(&spatial.clone().into(), &points))
            });
        }
    }
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn a_grid_is_no_steeper_than_it_promises_and_deviates_no_more() {
    for (name, shape) in solids() {
        for (kernel, store, band) in [
            (GridKernel::Quadratic, Store::F32, None),
            (GridKernel::Quadratic, Store::I16, Some(5.0)),
            (GridKernel::Trilinear, Store::F32, Some(5.0)),
            (GridKernel::Trilinear, Store::I8, None),
        ] {
            let mut options = GridOptions { store, ..options(0.03, kernel) };
            options.band = band;
            let grid = Grid::bake(&shape, &options).unwrap();
            let promise = *grid.promise();
            let deviation = promise.deviation.unwrap();
            let clamped = |f: f64| f.clamp(-deviation.within, deviation.within);
            let what = format!("{name}, {kernel:?}, {store:?}, {band:?}");
            cases::check(2000, |u| {
                let (p, q) = (point(u, &grid, 0.3)?, point(u, &grid, 0.3)?);
                // Nearby points see the steepest cells.
                let q = p + (q - p) * within(u, 0.0, 1.0)?.powi(6);
                let (f, g) = (grid.distance(p), grid.distance(q));
                let rounding = promise.rounding.within(p.norm() + q.norm());
                assert!(
                    (f - g).abs() <= promise.lipschitz * (p - q).norm() + 2.0 * rounding,
                    "{what}: {f} at {p:?}, {g} at {q:?}"
                );
                let source = shape.distance(p).max(match shape.promise().above_bounds {
                    true => f64::NEG_INFINITY,
                    false => beyond(&shape.promise().bounds.unwrap().aabb, p),
                });
                let apart = (clamped(f) - clamped(source)).abs();
                assert!(apart <= deviation.value + rounding, "{what}: {f}, {source} at {p:?}");
                Ok(Ok(()))
            });
        }
    }
}

/// The distance to a box outside it.
fn beyond(aabb: &Aabb<3>, p: Point<3>) -> f64 {
    let away = Vector::<f64, 3>(std::array::from_fn(|i| {
        (aabb.min[i] - p[i]).max(p[i] - aabb.max[i]).max(0.0)
    }));
    if away == Vector::ZERO { f64::NEG_INFINITY } else { away.norm() }
}

#[test]
fn outside_a_grid_values_are_at_most_the_distance_to_its_surface() {
    for (name, shape) in solids() {
        for kernel in KERNELS {
            let grid = Grid::bake(&shape, &options(0.03, kernel)).unwrap();
            let lipschitz = grid.promise().lipschitz;
            let surface: Vec<Point<3>> = surface_of(&grid);
            assert!(surface.len() > 50, "{name}");
            cases::check(300, |u| {
                let p = point(u, &grid, 1.0)?;
                let f = grid.distance(p);
                let nearest =
                    surface.iter().map(|s| (*s - p).norm()).fold(f64::INFINITY, f64::min);
                assert!(
                    f.abs() <= lipschitz * nearest + 1e-9,
                    "{name}: {f}, {nearest} at {p:?}"
                );
                Ok(Ok(()))
            });
        }
    }
}

/// Points of a grid's surface, by bisection between nodes.
fn surface_of(grid: &Grid<3>) -> Vec<Point<3>> {
    let lattice = grid.lattice();
    let mut found = Vec::new();
    for node in nodes(lattice) {
        let (mut a, mut b) = (lattice.node(node), lattice.node(node));
        b[0] += lattice.cell;
        if (grid.distance(a) > 0.0) == (grid.distance(b) > 0.0) {
            continue;
        }
        for _ in 0..40 {
            let middle = (a + b) * 0.5;
            if (grid.distance(a) > 0.0) == (grid.distance(middle) > 0.0) {
                a = middle;
            } else {
                b = middle;
            }
        }
        found.push(a);
    }
    found
}

fn nodes(lattice: &Lattice<3>) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = lattice.counts;
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx - 1).map(move |x| [x, y, z])))
}

#[test]
fn models_hold_every_value_of_their_cells() {
    for (name, shape) in solids() {
        for kernel in KERNELS {
            let grid = Grid::bake(&shape, &options(0.03, kernel)).unwrap();
            cases::check(2000, |u| {
                let centre = point(u, &grid, 0.1)?;
                // From parts of a cell to many cells.
                let size = *u.choose(&[1.0, 0.3, 0.03])?;
                let half: [f64; 3] =
                    [0.2 * coordinate(u)?.abs().min(1.0), 0.01, within(u, 0.0, 0.05)?];
                let half = half.map(|half| size * half);
                let cell = Model::cell(centre.0, half);
                let model = grid.model(&cell);
                for _ in 0..16 {
                    let side: [f64; 3] =
                        [within(u, -1.0, 1.0)?, within(u, -1.0, 1.0)?, within(u, -1.0, 1.0)?];
                    let p = Vector(std::array::from_fn(|i| centre[i] + half[i] * side[i]));
                    let affine =
                        model.value + (0..3).map(|k| model.gradient[k] * side[k]).sum::<f64>();
                    let f = grid.distance(p);
                    assert!(
                        affine - model.lower <= f && f <= affine + model.upper,
                        "{name}, {kernel:?}: {f} of {affine} − {} + {} at {p:?}",
                        model.lower,
                        model.upper
                    );
                }
                Ok(Ok(()))
            });
        }
    }
}

#[test]
fn gradients_are_those_of_the_values() {
    for kernel in KERNELS {
        let shape = Shape::torus(0.3, 0.1).unwrap();
        for band in [None, Some(5.0)] {
            let mut options = options(0.03, kernel);
            options.band = band;
            let grid = Grid::bake(&shape, &options).unwrap();
            cases::check(500, |u| {
                let p = point(u, &grid, 0.3)?;
                let (f, gradient) = grid.distance_gradient(p);
                assert_eq!(f, grid.distance(p));
                let d = direction::<3>(u)?;
                let step = 1e-7;
                let change =
                    (grid.distance(p + d * step) - grid.distance(p - d * step)) / (2.0 * step);
                // The slope of linear pieces steps at the sides of cells.
                let room = if kernel == GridKernel::Quadratic { 1e-5 } else { 2.0 };
                assert!((change - gradient.dot(d)).abs() <= room, "{change} at {p:?}");
                Ok(Ok(()))
            });
        }
    }
}

/// A cone's tip in the middle of a cell is the largest deviation, √3/2 of a cell for both kernels.
#[test]
fn the_tip_of_a_cone_deviates_by_half_the_diagonal_of_a_cell() {
    for kernel in KERNELS {
        let cell = 0.25;
        let lattice = Lattice { origin: Vector([-1.0; 3]), cell, counts: [9; 3] };
        // The middle of a trilinear cell, and of a quadratic one's corner.
        let tip = lattice.node([4; 3]) + Vector([0.5 * cell; 3]);
        let samples = samples(&lattice, |p| (p - tip).norm() - 0.3);
        let grid = Grid::from_samples(lattice, &samples, kernel, Store::F32).unwrap();
        let apart = grid.distance(tip) + 0.3;
        let half_diagonal = 0.75_f64.sqrt() * cell;
        // A quadratic takes farther samples too: Σw|x| is less than √Σw|x|².
        assert!(apart <= half_diagonal * (1.0 + 1e-6), "{apart}");
        if kernel == GridKernel::Trilinear {
            assert!((apart - half_diagonal).abs() < 1e-6, "{apart} of {half_diagonal}");
        } else {
            assert!(apart > 0.97 * half_diagonal, "{apart} of {half_diagonal}");
        }
    }
}

fn samples<const D: usize>(lattice: &Lattice<D>, f: impl Fn(Point<D>) -> f64) -> Vec<f64> {
    let nodes = lattice.nodes().unwrap();
    (0..nodes)
        .map(|number| {
            let mut rest = number;
            f(lattice.node(lattice.counts.map(|count| {
                let index = rest % count;
                rest /= count;
                index
            })))
        })
        .collect()
}

/// A node that is a peak makes a trilinear grid √3 times as steep.
#[test]
fn a_peak_is_as_steep_as_the_diagonal() {
    let lattice = Lattice { origin: Vector([-1.0; 3]), cell: 0.25, counts: [9; 3] };
    let peak = lattice.node([4; 3]);
    let samples = samples(&lattice, |p| (p - peak).norm() - 0.3);
    let trilinear =
        Grid::from_samples(lattice, &samples, GridKernel::Trilinear, Store::F32).unwrap();
    assert!((trilinear.promise().lipschitz - 3.0_f64.sqrt()).abs() < 1e-6);
    let quadratic =
        Grid::from_samples(lattice, &samples, GridKernel::Quadratic, Store::F32).unwrap();
    assert!(quadratic.promise().lipschitz < 1.1, "{}", quadratic.promise().lipschitz);
}

/// The quadratic spline of a ball's distance lies h²/4R inwards of its surface.
#[test]
fn a_ball_is_smaller_by_the_curvature_of_a_cell() {
    let (radius, cell) = (0.5, 0.02);
    let grid =
        Grid::bake(&Shape::sphere(radius).unwrap(), &options(cell, GridKernel::Quadratic))
            .unwrap();
    let theory = cell * cell / (4.0 * radius);
    cases::check(200, |u| {
        let p = direction::<3>(u)? * radius;
        let value = grid.distance(p);
        assert!((value - theory).abs() < 0.05 * theory, "{value} of {theory}");
        Ok(Ok(()))
    });
}

#[test]
fn a_tolerance_chooses_the_cell() {
    for (name, shape) in solids() {
        for kernel in KERNELS {
            let asked = 1.5e-2;
            let asked_for = GridOptions { kernel, ..GridOptions::with_tolerance(asked) };
            let grid = Grid::bake(&shape, &asked_for).unwrap();
            assert!(grid.deviation() <= asked, "{name}");
            // Not finer by much than it takes.
            let cell = 2.0 * grid.lattice().cell;
            if cell > shape.promise().bounds.unwrap().aabb.half_extents()[0] / 12.0 {
                continue;
            }
            let coarse = Grid::bake(&shape, &options(cell, kernel)).unwrap();
            // How cells lie on edges changes their deviation.
            assert!(coarse.deviation() > 0.5 * asked, "{name}, {kernel:?}: {cell} m");
        }
    }
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn a_grid_with_a_band_has_the_values_of_one_without_near_the_surface() {
    let shape = Shape::sphere(0.4).unwrap();
    for kernel in KERNELS {
        let cell = 0.008;
        let all = GridOptions { certified: 5.0, ..options(cell, kernel) };
        let all = Grid::bake(&shape, &all).unwrap();
        let near = GridOptions { band: Some(5.0), ..options(cell, kernel) };
        let near = Grid::bake(&shape, &near).unwrap();
        assert_eq!(all.lattice(), near.lattice());
        assert!(near.stored_samples() < all.stored_samples());
        cases::check(2000, |u| {
            let p = point(u, &all, 0.0)?;
            let (f, g) = (all.distance_gradient(p), near.distance_gradient(p));
            if f.0.abs() < 2.0 * cell {
                assert_eq!(f, g);
            } else {
                assert!(g.0.abs() <= f.0.abs() + 1e-12 && (f.0 > 0.0) == (g.0 > 0.0));
                // Far away the coarse lattice says more than the band.
                let said = 0.8 * f.0.abs() - 20.0 * cell;
                assert!(g.0.abs() >= said, "{} of {} at {p:?}", g.0, f.0);
            }
            Ok(Ok(()))
        });
    }
}

/// A plate with a notch, exact on both sides.
fn notched(notch: f64) -> Shape<2> {
    let corners = [[-0.4, -0.25], [0.4, -0.25], [0.4, 0.25], [0.3, 0.25], [0.25, notch]];
    let corners = corners.into_iter().chain([[0.2, 0.25], [-0.4, 0.25]]);
    Shape::polygon(vec![corners.collect::<Vec<_>>()]).unwrap()
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn a_region_made_again_has_the_samples_of_a_new_grid() {
    let ball = Shape::sphere(0.1).unwrap();
    let cuboid = Shape::cuboid([0.8, 0.5, 0.5]).unwrap();
    let before = cuboid.clone() - ball.clone().translated([0.3, 0.25, 0.0]).unwrap();
    let after = cuboid - ball.clone().translated([0.3, 0.24, 0.02]).unwrap();
    for kernel in KERNELS {
        for store in STORES {
            let options = GridOptions { store, band: Some(5.0), ..options(0.03, kernel) };
            // Bounds, of which all is made again.
            let mut again = Grid::bake(&before, &options).unwrap();
            let region =
                Aabb { min: Vector([0.2, 0.13, -0.1]), max: Vector([0.4, 0.26, 0.13]) };
            again.rebuild(&after, &region).unwrap();
            let new = Grid::bake(&after, &options).unwrap();
            assert_eq!(again.promise(), new.promise());
            assert_eq!(again.stored_samples(), new.stored_samples());
            // Exact distances, of which a part is.
            let mut flat = Grid::bake(&notched(0.1), &options).unwrap();
            let region = Aabb { min: Vector([0.2, 0.0]), max: Vector([0.3, 0.25]) };
            flat.rebuild(&notched(0.03), &region).unwrap();
            let fresh = Grid::bake(&notched(0.03), &options).unwrap();
            assert_eq!(flat.promise().lipschitz, fresh.promise().lipschitz);
            assert_eq!(flat.stored_samples(), fresh.stored_samples());
            cases::check(1000, |u| {
                let p = point(u, &new, 0.1)?;
                assert_eq!(again.distance_gradient(p), new.distance_gradient(p));
                let p = point(u, &fresh, 0.1)?;
                assert_eq!(flat.distance_gradient(p), fresh.distance_gradient(p));
                Ok(Ok(()))
            });
        }
    }
    let mut grid =
        Grid::bake(&before, &GridOptions { band: Some(5.0), ..options(0.02, KERNELS[0]) })
            .unwrap();
    let grown = before | ball.translated([2.0, 0.0, 0.0]).unwrap();
    let region = Aabb { min: Vector([1.8, -0.2, -0.2]), max: Vector([2.2, 0.2, 0.2]) };
    assert_eq!(grid.rebuild(&grown, &region), Err(GridError::Outgrown));
}

/// The steepness was compared in units of cells with one in metres: grids of large cells were called steeper.
#[test]
fn a_grid_promises_the_same_in_metres_and_in_millimetres() {
    let lipschitz = |scale: f64| {
        let ball = Shape::sphere(0.5 * scale).unwrap();
        let grid = Grid::bake(&ball, &options(0.05 * scale, KERNELS[0])).unwrap();
        grid.promise().lipschitz
    };
    assert!(
        (lipschitz(1e4) - lipschitz(1.0)).abs() < 1e-6,
        "{} {}",
        lipschitz(1e4),
        lipschitz(1.0)
    );
    assert!((lipschitz(1e-3) - lipschitz(1.0)).abs() < 1e-6);
}

/// A band of fixed width left nothing to compare where the source is steep.
#[test]
fn steep_sources_have_a_tolerance_too() {
    let twisted = Shape::cuboid([0.1, 0.3, 0.2]).unwrap().twisted(3.0).unwrap();
    assert!(twisted.promise().lipschitz > 1.1);
    let grid = Grid::bake(&twisted, &GridOptions::with_tolerance(0.06)).unwrap();
    assert!(grid.deviation() <= 0.06);
    let nothing = Shape::segment([0.0, 0.0, 0.0], [0.1, 0.0, 0.0], 0.0).unwrap();
    let error = Grid::bake(&nothing, &GridOptions::with_tolerance(1e-3)).unwrap_err();
    assert!(matches!(error, GridError::NoInside { .. }), "{error}");
}

#[test]
fn what_cannot_be_a_grid_is_refused() {
    let plane = Shape::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    assert_eq!(
        Grid::<3>::bake(&plane, &GridOptions::with_cell(0.1)).unwrap_err(),
        GridError::Unbounded
    );
    let needle = Shape::cuboid([1.0, 0.003, 0.003]).unwrap();
    let needle = needle.translated([0.0, 0.05, 0.05]).unwrap();
    let error = Grid::bake(&needle, &GridOptions::with_cell(0.1)).unwrap_err();
    assert_eq!(error, GridError::NoInside { cell: 0.1 });
    let ball = Shape::sphere(0.5).unwrap();
    assert!(matches!(
        Grid::bake(&ball, &GridOptions::with_cell(1e-4)).unwrap_err(),
        GridError::TooLarge { limit: 67_108_864, .. }
    ));
    for cell in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            Grid::bake(&ball, &GridOptions::with_cell(cell)).unwrap_err(),
            GridError::Number(_)
        ));
    }
    let stopped =
        Grid::bake_with(&ball, &GridOptions::with_cell(0.05), &|_| ControlFlow::Break(()));
    assert_eq!(stopped.unwrap_err(), GridError::Stopped);
    let lattice = Lattice { origin: Vector([-0.5; 3]), cell: 0.1, counts: [11; 3] };
    let inside = vec![-1.0; 11 * 11 * 11];
    assert!(matches!(
        Grid::from_samples(lattice, &inside, GridKernel::Quadratic, Store::F32).unwrap_err(),
        GridError::AtBorder { .. }
    ));
    let mut grid = Grid::bake(&ball, &GridOptions::with_cell(0.05)).unwrap();
    let region = Aabb::centred(Vector([0.1; 3]));
    assert_eq!(grid.rebuild(&ball, &region), Err(GridError::NoBand));
}

#[test]
fn a_point_that_is_nowhere_has_no_gradient() {
    let ball = Shape::sphere(0.5).unwrap();
    for band in [None, Some(5.0)] {
        let mut options = GridOptions::with_cell(0.05);
        options.band = band;
        let grid = Grid::bake(&ball, &options).unwrap();
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (value, gradient) = grid.distance_gradient(Vector([x, 0.0, 0.0]));
            assert!(!value.is_finite());
            assert_eq!(gradient, Vector::ZERO);
        }
        let far = grid.distance(Vector([1e9, 0.0, 0.0]));
        assert!(far > 0.9e9 && far <= grid.promise().lipschitz * 1e9);
    }
}

#[test]
fn a_grid_in_the_plane() {
    let disc = Shape::circle(0.3).unwrap();
    for kernel in KERNELS {
        let grid = Grid::bake(&disc, &options(0.01, kernel)).unwrap();
        assert!(grid.deviation() < 1e-3);
        let shape: Shape<2> = grid.into();
        assert!((shape.distance([0.33, 0.0]) - 0.03).abs() < 1e-3);
        let (_, gradient) = shape.distance_gradient([0.3, 0.0]);
        assert!((gradient - Vector([1.0, 0.0])).norm() < 0.05);
    }
}
