// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The smallest case of each bug that a law or an oracle found.

use palpate_field::kernel::{
    Arc, Ball, CoolS, CuboidFrame, CylinderApproximation, DeathStar, Ellipsoid, HalfSpace,
    HexagonalPrism, Moon, Octahedron, Polygon, Pyramid, RegularPolygon, Simplex,
};
use palpate_field::operator::{Copies, Profile};
use palpate_field::scalar::{Cubic, Dual, Model, Scalar};
use palpate_field::{
    BLOCK, Block, BoundingBall, Column, Kernel, MassLimits, Point, Promise, Quantity, Shape,
    ShapeError, Unit, Vector,
};

type Outcome = Result<(), ShapeError>;

fn steepest<const D: usize>(shape: &Shape<D>, p: Point<D>) -> f64 {
    shape.distance_gradient(p).1.norm()
}

/// The model of one cell.
fn model<const D: usize>(shape: &Shape<D>, centre: Point<D>, half: [f64; D]) -> Model {
    let mut cells = Block::<Model, D, BLOCK>::zero();
    let mut models = Column::zero();
    cells.set(0, Vector(Model::cell(centre.0, half)));
    shape.block_distances(&cells, 1, &mut models);
    models.get(0)
}

/// The crossing stroke from (−0.2, 0) to (0, −0.2) is the nearest to points just
/// above it, in the quadrant where the other crossing is not.
#[test]
fn the_cool_s_has_both_crossings_on_both_sides_of_the_waist() -> Outcome {
    let s = Shape::from_kernel(CoolS::new(2.0)?);
    for y in [-1e-9, 0.0, 1e-9] {
        let f = s.distance(Vector([-0.1, y]));
        assert!((f + 0.1 * 0.5_f64.sqrt()).abs() < 1e-8, "{f} at y = {y}");
    }
    Ok(())
}

/// At y = 0 the fold of y and the sign of y took different sides.
#[test]
fn the_cool_s_has_a_gradient_on_its_waist() -> Outcome {
    let s = Shape::from_kernel(CoolS::new(2.0)?);
    for x in [0.0, 0.05, 0.1, -0.05, -0.1] {
        let p = Vector([x, 0.0]);
        let (f, g) = s.distance_gradient(p);
        let landed = s.distance(p - g * f);
        assert!(landed.abs() < 1e-15, "{landed} after {f} along {g:?} from {p:?}");
    }
    Ok(())
}

/// With two equal coordinates the sort gave one of them twice.
#[test]
fn an_octahedron_has_a_unit_gradient_between_two_axes() -> Outcome {
    let dice = Shape::from_kernel(Octahedron::new(1.0)?);
    for p in [[0.0, -5.0, -5.0], [5.0, 5.0, 0.0], [5.0, 0.0, 5.0], [0.0, 0.0, 3.0]] {
        let length = steepest(&dice, Vector(p));
        assert!((length - 1.0).abs() < 1e-15, "{length} at {p:?}");
    }
    Ok(())
}

/// `max(p, 0) + min(p, 0)` has the derivative two at zero.
#[test]
fn elongation_by_nothing_keeps_the_gradient() -> Outcome {
    let ball = Shape::<2>::from_kernel(Ball::new(1.0)?).translated(Vector([0.6, 0.8]))?;
    let same = ball.elongated([0.5, 0.0])?;
    let length = steepest(&same, Vector([-3.0, 0.0]));
    assert!(length <= 1.0 + 1e-15, "{length}");
    Ok(())
}

/// On the line of an edge, norm and minimum both gave the edge's normal.
#[test]
fn a_regular_polygon_has_a_unit_gradient_on_its_surface() -> Outcome {
    let square = Shape::from_kernel(RegularPolygon::new(4, 1.0)?);
    for p in [[0.0, 1.0], [0.5, 0.5], [-1.0, 0.0], [0.0, -1.0]] {
        let length = steepest(&square, Vector(p));
        assert!(length <= 1.0 + 1e-15, "{length} at {p:?}");
    }
    let nut = Shape::from_kernel(HexagonalPrism::new(1.0, 1.0)?);
    let length = steepest(&nut, Vector([0.75_f64.sqrt(), 0.0, 0.0]));
    assert!(length <= 1.0 + 1e-15, "{length}");
    Ok(())
}

/// On the base the absolute value took the branch of the inside.
#[test]
fn the_base_of_a_pyramid_faces_down() -> Outcome {
    let giza = Shape::from_kernel(Pyramid::new(0.5, 1.0)?);
    let (f, g) = giza.distance_gradient(Vector([0.0, -0.5, 0.0]));
    assert_eq!((f, g), (0.0, Vector([0.0, -1.0, 0.0])));
    Ok(())
}

/// A tangent plane from a gradient that is no subgradient is no bound.
#[test]
fn models_on_the_surface_of_a_pyramid_enclose() -> Outcome {
    let giza = Shape::from_kernel(Pyramid::new(0.5, 1.0)?);
    let h = 1e-3;
    let model = model(&giza, Vector([0.0, -0.5, 0.0]), [h; 3]);
    let inside = giza.distance(Vector([0.0, -0.5 + h, 0.0]));
    let plane = model.value + model.gradient[1];
    assert!(plane - model.lower <= inside + 1e-15, "{inside} below {model:?}");
    Ok(())
}

/// At a corner the remainder of the projection is rounding or zero, and its
/// direction no normal.
#[test]
fn models_at_the_corners_of_a_triangle_enclose() -> Outcome {
    let corners = [
        [0.0, 0.297_981_519_252_061_84],
        [-0.5, -1.398_223_902_331_665_2],
        [-1.004_338_553_175_330_2, -1.137_141_467_537_731],
    ];
    let triangle = Shape::from_kernel(Simplex::new(corners.map(Vector).to_vec())?);
    let h = 1e-3;
    for corner in corners {
        let model = model(&triangle, Vector(corner), [h; 2]);
        for u in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, -1.0]] {
            let p = Vector([corner[0] + h * u[0], corner[1] + h * u[1]]);
            let f = triangle.distance(p);
            let plane = model.value + model.gradient[0] * u[0] + model.gradient[1] * u[1];
            assert!(plane - model.lower <= f + 1e-15, "{f} at {p:?} below {model:?}");
        }
    }
    Ok(())
}

/// Sixteen metres above a corner of 45°, a point a nanometre outside of one edge is as near to both
/// edges within a rounding. The gradient was that of the other edge, off by 3e-10, and models that
/// took it for a normal were too high by as much of their cell.
#[test]
fn a_triangle_in_space_has_the_right_normal_far_above_a_sharp_corner() -> Outcome {
    let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]].map(Vector);
    let shape = Shape::triangle_sheet(points.to_vec(), 0.0)?;
    let gradient = shape.distance_gradient(Vector([4.0 - 1e-8, 16.0, -1e-9])).1;
    let exact = Vector([0.0, 1.0, -1e-9 / 16.0]);
    assert!((gradient - exact).norm() <= 4.0 * f64::EPSILON, "{gradient:?}");
    Ok(())
}

/// In the plane of its widest section a thin ellipsoid needs more Newton steps
/// than it took: the pole of the thin axis is next to the start.
#[test]
fn an_ellipsoid_is_exact_in_its_plane_of_symmetry() -> Outcome {
    let radii =
        Vector([0.297_615_515_233_054_8, 0.471_314_522_437_751_3, 1.404_556_867_899_373_2]);
    let egg = Shape::from_kernel(Ellipsoid::new(radii)?);
    // On the surface, by the definition.
    for angle in [0.1_f64, 0.5, 0.9, 1.3] {
        let p = Vector([0.0, radii[1] * angle.cos(), radii[2] * angle.sin()]);
        let f = egg.distance(p);
        assert!(f.abs() < 1e-14, "{f:e} at {p:?}");
    }
    let flat = Shape::from_kernel(Ellipsoid::new(Vector([1.0, 1e-6]))?);
    for x in [0.0, 0.3, 0.999, 0.999_999] {
        let p = Vector([x, 1e-6 * f64::sqrt(1.0 - x * x)]);
        let f = flat.distance(p);
        assert!(f.abs() < 1e-14, "{f:e} at {p:?}");
    }
    Ok(())
}

/// The guard is the distance to the box; the bounding ball may be tighter.
#[test]
fn guarded_shapes_stay_in_their_ball() -> Outcome {
    let can = Shape::from_kernel(CylinderApproximation::new(1.15, 0.43)?).offset(1.24)?;
    let ball = can.promise().bounds.map(|b| b.ball);
    let p = Vector([-2.293, 0.617, 0.4422]);
    assert!(can.distance(p) < 0.0);
    assert!(ball.is_none_or(|b| (p - b.centre).norm() <= b.radius), "{p:?} outside {ball:?}");

    let flat = Shape::<2>::from_kernel(Ball::new(1.0)?).stretched([0.5, 1.0])?.offset(1.5)?;
    let ball = flat.promise().bounds.map(|b| b.ball);
    let p = Vector([1.78, 1.78]);
    assert!(flat.distance(p) < 0.0);
    assert!(ball.is_none_or(|b| (p - b.centre).norm() <= b.radius), "{p:?} outside {ball:?}");
    Ok(())
}

/// A point 2 nm along the normal of a sharp corner is outside again.
#[test]
fn a_polygon_has_the_right_normal_close_to_a_sharp_corner() -> Outcome {
    let spike = vec![Vector([0.0, 0.0]), Vector([-1.0, -0.1]), Vector([-1.0, 0.1])];
    let spike = Shape::from_kernel(Polygon::new(vec![spike])?);
    let p = Vector([-1e-10, 1e-11 + 1e-13]); // just above the upper edge
    let (f, g) = spike.distance_gradient(p);
    assert!(f > 0.0 && g[1] > 0.0, "{f:e}, {g:?}");
    Ok(())
}

/// At most 32 ulp of the largest number met are allowed.
#[test]
fn tangent_models_are_tight_to_32_ulp() -> Outcome {
    fn ulp<K: Kernel<2>>(kernel: K, size: f64) -> f64 {
        let shape = Shape::from_kernel(kernel);
        let centre = Vector([0.7 * size, 0.9 * size]);
        let model = model(&shape, centre, [1e-3 * size; 2]);
        model.lower / (f64::EPSILON * (size + centre.norm() + 2e-3 * size))
    }
    let corners = vec![Vector([0.0, -0.5]), Vector([-1.0, 0.5]), Vector([-1.444, -0.589])];
    let all = [
        ("ellipse", ulp(Ellipsoid::new(Vector([1.0, 0.5]))?, 1.0)),
        ("regular polygon", ulp(RegularPolygon::new(10, 1.0)?, 1.0)),
        ("triangle", ulp(Simplex::new(corners)?, 1.56)),
    ];
    for (name, ulp) in all {
        assert!(ulp <= 32.0, "{name}: {ulp} ulp, all: {all:?}");
    }
    Ok(())
}

/// The remainders of a choice between far values did not cover the rounding of their
/// difference.
#[test]
fn models_of_choices_enclose_both_values() {
    let x = Model {
        value: -2.0,
        gradient: [0.0, 0.011_424_605_414_110_393, 0.0],
        ..Model::default()
    };
    let limit = Model { value: -2.0, upper: 0.25, ..Model::default() };
    let either = Model::select_less(x, limit, x, -x);
    // x at u = (0, −1, 0), without rounding: 2·value cancels first.
    let plane = -either.gradient[1];
    let room = (either.lower - 2.0 * either.value) - plane;
    assert!(room >= 0.011_424_605_414_110_393, "{room:e} of {either:?}");
}

/// Where the fill takes away most of both values, the rounding is theirs and not that
/// of what is left.
#[test]
fn models_of_smooth_minima_allow_for_the_rounding_of_their_operands() {
    let (a, b) = (0.057_971_636_792_525_59, 0.057_968_758_733_569_01);
    let model = Model::constant(a).smooth_min::<Cubic>(Model::constant(b), 0.3);
    let rounding = f64::EPSILON * (a + 0.3 / 6.0);
    assert!(model.upper >= rounding && model.lower >= rounding, "{model:?}");
}

/// Numbers far from one were written with all their zeros.
#[test]
fn messages_show_huge_and_tiny_numbers_with_exponents() {
    let shown = |x| Quantity(x, Unit::Metre).to_string();
    assert_eq!(shown(1e300), "1e300 m");
    assert_eq!(shown(1e-20), "1e-20 m");
    assert_eq!(shown(-0.02), "-0.02 m");
}

/// Each scale is in range, but not all of them together.
#[test]
fn scales_of_scales_give_numbers_or_an_error() {
    let mut shape = Shape::<2>::from_kernel(Ball::new(1.0).unwrap_or_else(|e| panic!("{e}")));
    for _ in 0..12 {
        match shape.scaled(1e-15) {
            Ok(smaller) => shape = smaller,
            Err(_) => return,
        }
        let (f, g) = shape.distance_gradient(Vector([1.0, 0.0]));
        assert!(f.is_finite() && g.is_finite(), "{f}, {g:?} at depth {}", shape.depth());
    }
}

/// Far from everything the limit for skipping members is infinite, and so is the
/// distance of the lanes past the last member: they were asked too.
#[test]
fn a_union_can_be_asked_at_the_farthest_point() -> Outcome {
    let members = (0..7).map(|i| {
        let ball = Shape::<3>::from_kernel(Ball::new(1.0)?);
        ball.translated(Vector([3.0 * f64::from(i), 0.0, 0.0]))
    });
    let row = Shape::union(members.collect::<Result<Vec<_>, _>>()?)?;
    assert!(row.distance(Vector([1e15; 3])) > 1e15);
    Ok(())
}

/// At the centre the gradient led along x, where a short arc is not.
#[test]
fn an_arc_has_its_gradient_towards_itself_at_its_centre() -> Outcome {
    let arc = Shape::from_kernel(Arc::new(1.0, 0.5, 0.0)?);
    let (f, g) = arc.distance_gradient(Vector([0.0, 0.0]));
    assert_eq!((f, g), (1.0, Vector([0.0, -1.0])));
    Ok(())
}

/// Each union squared the remainder of the one in it, until it was infinite.
#[test]
fn models_of_nested_smooth_unions_stay_near_their_members() -> Outcome {
    let ball = || Ball::new(0.5).map(Shape::<3>::from_kernel);
    let mut shape = ball()?;
    for _ in 0..12 {
        shape = Shape::smooth_union([shape, ball()?], Profile::Cubic, 1e-3)?;
    }
    let over = model(&shape, Vector([3.0, 0.5, -0.5]), [1.0, 4.0, 2.0]);
    assert!(over.lower < 100.0 && over.upper < 100.0, "{over:?}");
    Ok(())
}

/// On the face of a bar behind the box's own, no tunnel was outside.
#[test]
fn the_frame_of_a_box_has_a_normal_on_its_inner_faces() -> Outcome {
    let frame = Shape::from_kernel(CuboidFrame::new(Vector([0.9, 0.7, 0.5]), 0.2)?);
    let p = Vector([0.35, 0.1, 0.05]);
    for ulp in -4..=4 {
        let q = p + Vector([0.0, 0.0, f64::from(ulp) * 1e-17]);
        assert_eq!(frame.distance_gradient(q).1, Vector([0.0, 0.0, -1.0]), "{ulp}");
    }
    Ok(())
}

/// Spheres that hardly cross share less than a rounding; the rim is far wider.
#[test]
fn a_bite_as_shallow_as_a_rounding_is_no_deeper() -> Outcome {
    let most = 0.5 + 0.75;
    let star = Shape::from_kernel(DeathStar::new(0.5, 0.75, most * (1.0 - f64::EPSILON))?);
    for x in [0.0, 1e-9, 2e-9, 5e-9, 1e-8] {
        for y in [0.5, 0.5 - 1e-16, 0.5 + 1e-16] {
            let f = star.distance(Vector([x, y, 0.0]));
            assert!(f.abs() < 1e-14, "{f} at {x}, {y}");
        }
    }
    Ok(())
}

/// At 19 fm from a corner the direction from it was rounding and no normal of the
/// triangle: over a cell of 17 m, its plane was 0.2 mm too high.
#[test]
fn models_next_to_corners_enclose() -> Outcome {
    let corners = [
        [-0.991_961_624_706_164, -0.25],
        [-1.311_968_057_183_548_8, -1.337_630_979_716_777_8],
        [-0.5, 0.480_630_857_404_321_43],
    ];
    let triangle = Shape::from_kernel(Simplex::new(corners.map(Vector).to_vec())?);
    let half = 8.417_800_482_118_864;
    for ulp in -8..=8 {
        let ulp = f64::from(ulp) * f64::EPSILON;
        let centre = Vector([-0.500_000_000_000_015_4, 0.480_630_857_404_331_8 + ulp]);
        let model = model(&triangle, centre, [half; 2]);
        for u in [[-0.505, 0.283], [-0.5, -0.2], [0.1, -0.5], [0.9, 0.4]] {
            let f = triangle.distance(centre + Vector(u) * half);
            let plane = model.value + model.gradient[0] * u[0] + model.gradient[1] * u[1];
            assert!(plane - model.lower <= f + 1e-13, "{f} below {model:?}");
        }
        assert!(model.lower < 1e-13, "{model:?}");
    }
    Ok(())
}

/// Over cells with parts of the medial axis, choices between far values added up: the
/// model was 145 m wide.
#[test]
fn models_of_a_moon_over_large_cells_say_as_much_as_its_steepness() -> Outcome {
    let moon = Shape::from_kernel(Moon::new(1.0, 0.25, 1.0)?);
    let over = model(&moon, Vector([0.92, 0.0]), [4.5, 1.5]);
    let width = over.maximum() - over.minimum();
    assert!(width < 2.0 * 4.5_f64.hypot(1.5) + 1e-12, "{width} m: {over:?}");
    Ok(())
}

/// The child was asked up to 8 km away, and its rounding counted at the point.
#[test]
fn rows_that_leave_out_the_origin_round_as_far_copies_do() -> Outcome {
    let row = Copies::Between { spacing: 1000.0, first: 5, last: 8 };
    let shape =
        Shape::from_kernel(Ball::new(0.1)?).repeated([row, Copies::One, Copies::One])?;
    for x in [0.0, 1e-3, 0.7] {
        let f = shape.distance(Vector([x, 0.3, 0.1]));
        // To the centre of copy 5, in numbers that are short enough to be exact.
        let exact = (5000.0 - x).mul_add(5000.0 - x, 0.1).sqrt() - 0.1;
        let rounding = shape.promise().rounding.within(x.hypot(0.32));
        assert!((f - exact).abs() <= rounding, "{f} {exact} {rounding:e}");
        assert!(rounding > 1e-12);
    }
    Ok(())
}

#[test]
fn a_row_that_begins_beyond_all_numbers_is_refused() -> Outcome {
    for first in [i32::MIN, -1_000_001] {
        let row = Copies::Between { spacing: 1.0, first, last: 0 };
        assert!(Shape::from_kernel(Ball::new(0.1)?).repeated([row; 2]).is_err(), "{first}");
    }
    Ok(())
}

/// More than a million copies in a row had no bounds, as if they had no end.
#[test]
fn long_rows_have_bounds() -> Outcome {
    let row = Copies::Between { spacing: 1.0, first: -600_000, last: 600_000 };
    let shape = Shape::from_kernel(Ball::new(0.1)?).repeated([row, Copies::One])?;
    assert!(shape.promise().bounds.is_some());
    Ok(())
}

/// Of a point that is no number no member of a larger union was near: a slice panicked, and a
/// single point was infinitely far.
#[test]
fn a_point_that_is_no_number_has_no_distance_to_a_union() -> Outcome {
    let members = (0..20).map(|i| {
        Shape::from_kernel(Ball::new(0.1)?).translated(Vector([f64::from(i), 0.0, 0.0]))
    });
    let union = Shape::union(members.collect::<Result<Vec<_>, _>>()?)?;
    let nan = Vector([f64::NAN, 0.0, 0.0]);
    assert!(union.distance(nan).is_nan());
    let mut distances = [0.0; 2];
    union.distances(&[nan, Vector([0.0, 1.0, 0.0])], &mut distances);
    assert!(distances[0].is_nan());
    assert!((distances[1] - 0.9).abs() < 1e-15);
    union.distances(&[nan, nan], &mut distances);
    assert!(distances[0].is_nan() && distances[1].is_nan());
    Ok(())
}

/// Far half-spaces were left out beyond the range of single precision.
#[test]
fn a_union_of_unbounded_members_is_right_far_away() -> Outcome {
    let planes = (0..8).map(|i| {
        let angle = 0.1 * f64::from(i);
        let normal = Vector([angle.cos(), angle.sin()]);
        Ok(Shape::from_kernel(HalfSpace::new(normal, 0.0)?))
    });
    let planes = planes.collect::<Result<Vec<_>, ShapeError>>()?;
    let union = Shape::union(planes.clone())?;
    for x in [1e15, 1e19, 1e20, -1e30] {
        let p = Vector([x, 0.0]);
        let by_hand =
            planes.iter().map(|plane| plane.distance(p)).fold(f64::INFINITY, f64::min);
        assert_eq!(union.distance(p), by_hand, "{x}");
    }
    Ok(())
}

/// Two wires without an inside have one where they blend.
#[test]
fn a_smooth_union_of_wires_has_an_interior() -> Outcome {
    let wire = Shape::segment([-1.0, 0.0], [1.0, 0.0], 0.0)?;
    let across = Shape::segment([0.0, -1.0], [0.0, 1.0], 0.0)?;
    let cross = Shape::smooth_union([wire, across], Profile::Quadratic, 0.1)?;
    assert!(cross.distance(Vector([0.0, 0.0])) < 0.0);
    assert!(cross.promise().has_interior);
    Ok(())
}

/// Models say nothing outside the region in which the steepness holds: what was counted there as
/// outside or inside was a guess, and the error of the volume was none.
#[test]
fn a_shape_that_is_known_in_a_region_alone_is_not_weighed() -> Outcome {
    let region = BoundingBall { centre: Vector([0.0; 2]), radius: 0.1 };
    let bounds = Shape::from_kernel(Ball::new(1.0)?).promise().bounds;
    let promise = Promise::<2>::lipschitz(bounds, 2.0).with_region(region);
    let disc = Shape::from_fn(promise, |p| p.norm() - Dual::constant(1.0));
    let error = disc.mass(1.0, MassLimits::default()).unwrap_err();
    assert!(error.to_string().contains("known everywhere"), "{error}");
    Ok(())
}

/// Above a corner of a tetrahedron, two facets' rounding let neither hold the point, and the
/// gradient was that of the corner: 8e-10 off, so that the field rose above its tangent plane by
/// less than a model allows for. The nearest point is in the facet of the first three corners.
#[test]
fn a_point_above_an_edge_has_the_gradient_of_a_facet_that_holds_it() -> Outcome {
    let corners = [
        [-0.2984058461152017, 1.0828424964565784, 0.4373288727365434],
        [0.0, -1.2348850204143673, 0.3337545753456652],
        [0.0, -1.3341569686308503, -0.0368246678262949],
        [1.067808031802997, 1.1809792772401124, 0.25],
    ];
    let [a, b, c, _] = corners.map(Vector);
    let tetrahedron = Shape::tetrahedron(corners.map(Vector).to_vec())?;
    let p = Vector([-0.00027094884556426007, -1.3341922757772948, -0.036815209635199686]);
    let (_, gradient) = tetrahedron.distance_gradient(p);
    for edge in [b - a, c - b] {
        let along = gradient.dot(edge);
        assert!(along.abs() < 1e-14, "{along:e}");
    }
    Ok(())
}
