// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bad input is an error with the number and its unit; good input of any size
//! gives numbers. Nothing panics.

use palpate_field::catalogue::Entry;
use palpate_field::kernel::{Argument, Ball, Parameter, ParameterKind};
use palpate_field::operator::Profile;
use palpate_field::scalar::Model;
use palpate_field::{
    BLOCK, Block, Column, Gradients, MAX_DEPTH, Point, Pose, Rotation, Shape, ShapeError,
    Vector,
};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;
use palpate_testkit::kernels::{Dimension, Space};

const NAN: f64 = f64::NAN;
const INFINITY: f64 = f64::INFINITY;

type Outcome = Result<(), ShapeError>;

fn ball() -> Result<Shape<3>, ShapeError> {
    Ok(Shape::from_kernel(Ball::new(0.5)?))
}

fn message<T>(result: Result<T, ShapeError>) -> String {
    result.map_or_else(|error| error.to_string(), |_| "no error".into())
}

#[test]
fn messages_of_primitives_name_the_number_and_its_unit() {
    let samples = [<Space as Dimension<2>>::SAMPLES, <Space as Dimension<3>>::SAMPLES].concat();
    let messages: Vec<_> = samples.iter().flat_map(|sample| (sample.messages)()).collect();
    insta::assert_snapshot!("primitives", messages.join("\n"));
}

#[test]
fn messages_of_operators_name_the_number_and_its_unit() -> Outcome {
    let far = Pose::translation(Vector([0.0, 1e300, 0.0]));
    let none: [Shape<3>; 0] = [];
    let messages = [
        message(ball()?.offset(-0.5)),
        message(ball()?.offset(NAN)),
        message(ball()?.shell(-0.02)),
        message(ball()?.shell(0.0)),
        message(Shape::smooth_union([ball()?, ball()?], Profile::Quadratic, -0.02)),
        message(Shape::smooth_union([ball()?], Profile::Cubic, NAN)),
        message(ball()?.scaled(0.0)),
        message(ball()?.scaled(-1.0)),
        message(ball()?.stretched([1.0, NAN, 1.0])),
        message(ball()?.elongated([0.1, -0.1, 0.0])),
        message(ball()?.mirrored(3)),
        message(ball()?.placed(&far)),
        message(ball()?.translated(Vector([NAN, 0.0, 0.0]))),
        message(Shape::<2>::from_kernel(Ball::new(0.5)?).extruded(-0.02)),
        message(Shape::union(none.clone())),
        message(Shape::intersection(none.clone())),
        message(Shape::symmetric_difference(none.clone())),
        message(Shape::smooth_union(none, Profile::Cubic, 0.1)),
        message(Rotation::from_angle(INFINITY)),
        message(Rotation::from_axis_angle(Vector([0.0; 3]), 1.0)),
        message(Rotation::from_quaternion([0.0; 4])),
    ];
    insta::assert_snapshot!("operators", messages.join("\n"));
    Ok(())
}

/// What no parameter of its kind accepts.
fn bad(parameter: &Parameter, dimension: usize) -> Vec<Argument> {
    let numbers = |list: &[f64]| list.iter().map(|x| Argument::Number(*x)).collect::<Vec<_>>();
    let vectors = |list: &[f64]| -> Vec<Vec<f64>> {
        let one_bad = |x: &f64, axis: usize| {
            let mut components = vec![0.5; dimension];
            components[axis] = *x;
            components
        };
        let axes = 0..dimension;
        let mut all: Vec<_> =
            axes.flat_map(|axis| list.iter().map(move |x| one_bad(x, axis))).collect();
        all.extend([vec![], vec![0.5; dimension + 1]]);
        all
    };
    let never = [NAN, INFINITY, -INFINITY, 1e300, -1e300];
    match parameter.kind {
        ParameterKind::Length => {
            numbers(&[-0.02, 0.0, -0.0, NAN, INFINITY, -INFINITY, 1e300, 1e-300])
        }
        ParameterKind::LengthOrZero => numbers(&[-0.02, NAN, INFINITY, -INFINITY, 1e300]),
        ParameterKind::Coordinate => numbers(&never),
        ParameterKind::Angle => numbers(&[0.0, -0.02, NAN, INFINITY, 6.3, 1e300]),
        ParameterKind::Count => {
            let mut list = vec![0, 1_000_000, u32::MAX];
            // A polygon needs three sides, a star three branches.
            let least_is_less = ["steps", "ring_exponent", "tube_exponent", "starts"];
            if !least_is_less.contains(&parameter.name) {
                list.push(2);
            }
            list.into_iter().map(Argument::Count).collect()
        }
        ParameterKind::Vector => {
            let mut list = never.to_vec();
            if matches!(parameter.name, "size" | "radii") {
                list.extend([-0.02, 0.0, 1e-300]);
            }
            vectors(&list).into_iter().map(Argument::Vector).collect()
        }
        ParameterKind::Direction => {
            let mut all = vectors(&never);
            all.extend([vec![0.0; dimension], vec![-0.0; dimension], vec![1e-310; dimension]]);
            all.into_iter().map(Argument::Vector).collect()
        }
        ParameterKind::Points => {
            let mut all = vec![vec![], vec![vec![0.5; dimension]; dimension + 1]];
            all.extend(vectors(&never).into_iter().map(|p| vec![p; dimension + 1]));
            all.into_iter().map(Argument::Points).collect()
        }
        ParameterKind::Rings => {
            let mut all = vec![vec![], vec![vec![]], vec![vec![vec![0.5; dimension]; 2]]];
            all.extend(vectors(&never).into_iter().map(|p| vec![vec![p; 3]]));
            all.into_iter().map(Argument::Rings).collect()
        }
    }
}

/// One of another kind.
fn of_another_kind(parameter: &Parameter) -> Argument {
    match parameter.kind {
        ParameterKind::Count => Argument::Vector(vec![0.5; 2]),
        _ => Argument::Count(5),
    }
}

fn bad_arguments_are_refused<const D: usize>()
where
    Space: Dimension<D>,
{
    for (seed, entry) in <Space as Dimension<D>>::CATALOGUE.iter().enumerate() {
        let bytes = cases::entropy(seed as u64);
        let mut u = arbitrary::Unstructured::new(&bytes);
        let good = draw::arguments::<D>(&mut u, entry.name, entry.parameters);
        let good =
            good.ok().flatten().unwrap_or_else(|| panic!("{} has no example", entry.name));
        assert!(entry.build(&good).is_ok(), "{} of {good:?}", entry.name);
        for (i, parameter) in entry.parameters.iter().enumerate() {
            let mut wrong = bad(parameter, D);
            wrong.push(of_another_kind(parameter));
            for argument in wrong {
                let mut arguments = good.clone();
                arguments[i] = argument.clone();
                let Err(error) = entry.build(&arguments) else {
                    panic!("{} takes {argument:?} for {}", entry.name, parameter.name);
                };
                let text = error.to_string();
                assert!(!text.is_empty() && !text.contains("inf m m"), "{text}");
            }
        }
        assert!(entry.build(&[]).is_err(), "{} of nothing", entry.name);
        let mut many = good.clone();
        many.push(Argument::Number(1.0));
        assert!(entry.build(&many).is_err(), "{} of too many", entry.name);
    }
}

#[test]
fn bad_arguments_of_every_primitive_are_refused() {
    bad_arguments_are_refused::<2>();
    bad_arguments_are_refused::<3>();
}

#[test]
fn bad_arguments_of_every_operator_are_refused() -> Outcome {
    for x in [NAN, INFINITY, -INFINITY, 1e300, -1e300, -0.02, 0.0] {
        let pair =
            || Ok::<_, ShapeError>([ball()?, ball()?.translated(Vector([1.0, 0.0, 0.0]))?]);
        let flat = Shape::<2>::from_kernel(Ball::new(0.5)?);
        assert!(ball()?.shell(x).is_err(), "shell {x}");
        assert!(ball()?.scaled(x).is_err(), "scaled {x}");
        assert!(flat.extruded(x).is_err(), "extruded {x}");
        for smooth in [Profile::Quadratic, Profile::Root, Profile::CircularGeometrical] {
            assert!(Shape::smooth_union(pair()?, smooth, x).is_err(), "smooth union {x}");
        }
        for axis in 0..3 {
            let mut factors = [1.0; 3];
            factors[axis] = x;
            assert!(ball()?.stretched(factors).is_err(), "stretched {factors:?}");
        }
        if x != 0.0 {
            for axis in 0..3 {
                let mut lengths = [0.0; 3];
                lengths[axis] = x;
                assert!(ball()?.elongated(lengths).is_err(), "elongated {lengths:?}");
            }
        }
        if x.is_nan() || x.abs() > 1.0 {
            assert!(ball()?.offset(x).is_err(), "offset {x}");
            for axis in 0..3 {
                let offset = Vector::unit(axis) * x;
                assert!(ball()?.translated(offset).is_err(), "translated {offset:?}");
            }
        }
    }
    assert!(ball()?.mirrored(3).is_err() && ball()?.mirrored(usize::MAX).is_err());
    Ok(())
}

#[test]
fn nesting_beyond_the_limit_is_refused() -> Outcome {
    let mut shape = ball()?;
    // Operators that no other of them can absorb.
    for level in shape.depth()..MAX_DEPTH {
        shape =
            if level % 2 == 0 { shape.offset(0.001)? } else { Shape::union([shape, ball()?])? };
        assert_eq!(shape.depth(), level + 1);
    }
    assert!(shape.distance(Vector([3.0, 0.0, 0.0])).is_finite());
    assert!(shape.distance_gradient(Vector([3.0, 0.0, 0.0])).1.is_finite());
    let mut column = Gradients::<f64, 3, BLOCK>::zero();
    shape.block_gradients(&Block::zero(), BLOCK, &mut column);
    let too_deep = shape.clone().offset(0.001);
    assert_eq!(message(too_deep), "shapes are nested 65 deep, at most 64 are allowed");
    let both = || [shape.clone(), shape.clone()];
    for (what, result) in [
        ("shell", shape.clone().shell(0.1)),
        ("intersection", Shape::intersection(both())),
        ("difference", shape.clone().difference([ball()?])),
        ("symmetric difference", Shape::symmetric_difference(both())),
        ("smooth union", Shape::smooth_union(both(), Profile::Cubic, 0.1)),
        ("scaled", shape.clone().scaled(2.0)),
        ("stretched", shape.clone().stretched([1.0, 2.0, 1.0])),
        ("elongated", shape.clone().elongated([0.1; 3])),
        ("mirrored", shape.mirrored(0)),
    ] {
        assert!(matches!(result, Err(ShapeError::TooDeep { .. })), "{what}: {result:?}");
    }
    Ok(())
}

#[test]
fn a_thousand_nested_unions_are_one() -> Outcome {
    let mut shape = ball()?;
    for i in 1..=1000 {
        let next = ball()?.translated(Vector([f64::from(i), 0.0, 0.0]))?;
        shape = Shape::union([shape, next])?;
    }
    assert_eq!(shape.depth(), 2);
    assert_eq!(shape.distance(Vector([1002.0, 0.0, 0.0])), 1.5);
    assert_eq!(shape.distance(Vector([500.0, 2.0, 0.0])), 1.5);
    Ok(())
}

/// Beyond this many sizes of the shape, squares leave the range of single precision.
const SINGLE: f64 = 1e18;

/// Evaluates a shape of `size` in every way; all must be numbers.
fn assert_numbers<const D: usize>(shape: &Shape<D>, size: f64, p: Point<D>, what: &str) {
    let (f, g) = shape.distance_gradient(p);
    assert!(f.is_finite() && g.is_finite(), "{what}: {f:e}, {g:?} at {p:?}");
    assert_eq!(f.to_bits(), shape.distance(p).to_bits(), "{what} at {p:?}");
    let single = Vector(p.0.map(|x| x as f32));
    let (f, g) = shape.distance_gradient_f32(single);
    let finite = f.is_finite() && g.0.iter().all(|x| x.is_finite());
    let far = p.norm() > SINGLE * size.min(1.0);
    assert!(finite || far, "{what}: {f:e}, {g:?} in single precision at {p:?}");
    let mut cells = Block::<Model, D, BLOCK>::zero();
    let mut models = Column::zero();
    cells.set(0, Vector(Model::cell(p.0, p.0.map(|x| 0.1 * x.abs()))));
    shape.block_distances(&cells, 1, &mut models);
    let model = models.get(0);
    assert!(
        !model.minimum().is_nan() && !model.maximum().is_nan(),
        "{what}: {model:?} at {p:?}"
    );
    let radius = shape.safe_radius(p);
    assert!(radius >= 0.0, "{what}: a safe radius of {radius:e} at {p:?}");
}

/// Numbers of every size that a point may have.
const COORDINATES: [f64; 12] =
    [0.0, -0.0, 5e-324, 1e-310, -1e-200, 1e-30, 1e-12, -0.5, 1.0, 1e6, -1e12, 1e15];

fn extreme_points<const D: usize>() -> Vec<Point<D>> {
    let on_axes = (0..D).flat_map(|axis| COORDINATES.map(|x| Vector::unit(axis) * x));
    let diagonals = COORDINATES.map(Vector::constant);
    on_axes.chain(diagonals).collect()
}

fn scenes_of_any_size<const D: usize>()
where
    Space: Dimension<D>,
{
    for (seed, entry) in <Space as Dimension<D>>::CATALOGUE.iter().enumerate() {
        let example = entry.example().unwrap_or_else(|error| panic!("{}: {error}", entry.name));
        for exponent in [-12, -6, 0, 6, 12] {
            let size = 10.0_f64.powi(exponent);
            let bytes = cases::entropy(seed as u64);
            let mut u = arbitrary::Unstructured::new(&bytes);
            let drawn = draw::arguments::<D>(&mut u, entry.name, entry.parameters);
            let arguments = drawn.ok().flatten().map(|all| sized(&all, entry.parameters, size));
            let what = format!("{} of {size:e} m", entry.name);
            // Arguments themselves of that size, and the scaled example.
            let built = arguments.map(|arguments| entry.build(&arguments));
            let built = built.unwrap_or_else(|| panic!("{} has no example", entry.name));
            let built = built.unwrap_or_else(|error| panic!("{what}: {error}"));
            let scaled =
                example.clone().scaled(size).unwrap_or_else(|error| panic!("{what}: {error}"));
            for p in extreme_points() {
                assert_numbers(&built, size, p, &what);
                assert_numbers(&scaled, size, p, &what);
                assert_numbers(&built, size, p * size.min(1.0), &what);
                assert_numbers(&scaled, size, p * size.min(1.0), &what);
            }
        }
    }
}

/// `arguments` with all lengths times `size`.
fn sized(arguments: &[Argument], parameters: &[Parameter], size: f64) -> Vec<Argument> {
    let list = |x: &Vec<f64>| x.iter().map(|x| x * size).collect::<Vec<_>>();
    let one = |(argument, parameter): (&Argument, &Parameter)| match argument {
        Argument::Number(angle) if parameter.kind == ParameterKind::Angle => {
            Argument::Number(*angle)
        }
        Argument::Number(x) => Argument::Number(x * size),
        Argument::Count(count) => Argument::Count(*count),
        Argument::Vector(x) => Argument::Vector(list(x)),
        Argument::Points(points) => Argument::Points(points.iter().map(list).collect()),
        Argument::Rings(rings) => {
            Argument::Rings(rings.iter().map(|ring| ring.iter().map(list).collect()).collect())
        }
    };
    arguments.iter().zip(parameters).map(one).collect()
}

#[test]
fn scenes_of_any_size_give_numbers() {
    scenes_of_any_size::<2>();
    scenes_of_any_size::<3>();
}

#[test]
fn entries_are_the_catalogue() {
    assert_eq!(Entry::<2>::ALL.len(), <Space as Dimension<2>>::CATALOGUE.len());
    assert_eq!(Entry::<3>::ALL.len(), <Space as Dimension<3>>::CATALOGUE.len());
}
