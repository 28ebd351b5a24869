// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A kernel evaluated with a number that records what is done to it gives its
//! formula: what a shader generator needs.
//!
//! The recorded formulas are printed, and evaluated again, which must give the
//! bits of the kernel.

use std::cell::RefCell;
use std::fmt::Write;
use std::ops::{Add, Div, Mul, Neg, Sub};

use palpate_field::field::Placement;
use palpate_field::kernel::{Ball, CappedCone, Cuboid, Kernel, Primitive, RegularStar, Torus};
use palpate_field::scalar::{
    Blend, Circular, Cubic, Exponential, Quadratic, Quartic, Root, Scalar,
};
use palpate_field::{Point, Pose, Rotation, ShapeError, Vector};
use palpate_testkit::kernels::{Dimension, Space, Visit};
use palpate_testkit::{arbitrary as draw, cases};

/// What a node of a formula does with its arguments.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    /// A coordinate of the point, by its number.
    Coordinate(usize),
    /// By its bits: a negative zero is not a zero.
    Constant(u64),
    Add,
    Sub,
    Mul,
    Div,
    Neg,
    Abs,
    Squared,
    Sqrt,
    Min,
    Max,
    SelectLess,
    Sin,
    Cos,
    Norm,
    Orthant,
    /// By the name of the profile, with its unit.
    SmoothMin(&'static str, f64),
    /// With the spacing and the limits.
    NearestMultiple(f64, f64, f64),
}

/// An operation and its arguments, earlier nodes of the same formula.
#[derive(Clone, Debug, PartialEq)]
struct Node {
    operation: Operation,
    arguments: Vec<usize>,
}

impl Node {
    /// Whether it is short enough to be written again wherever it is used.
    fn is_short(&self) -> bool {
        matches!(self.operation, Operation::Coordinate(_) | Operation::Constant(_))
    }
}

thread_local! {
    /// The nodes recorded so far: a [`Recorded`] must be `Copy`.
    static NODES: RefCell<Vec<Node>> = const { RefCell::new(Vec::new()) };
}

/// A number of which only its formula is known.
#[derive(Clone, Copy, Debug)]
struct Recorded(usize);

impl Recorded {
    fn new<const N: usize>(operation: Operation, arguments: [Self; N]) -> Self {
        let node = Node { operation, arguments: arguments.iter().map(|x| x.0).collect() };
        NODES.with_borrow_mut(|nodes| {
            // What is already there is shared.
            let known = nodes.iter().position(|other| *other == node);
            Self(known.unwrap_or_else(|| {
                nodes.push(node);
                nodes.len() - 1
            }))
        })
    }
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident),*) => {
        $(impl $operator for Recorded {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                Self::new(Operation::$operator, [self, other])
            }
        })*
    };
}

arithmetic!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Recorded {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(Operation::Neg, [self])
    }
}

impl Scalar for Recorded {
    const EPSILON: f64 = f64::EPSILON;

    fn constant(value: f64) -> Self {
        Self::new(Operation::Constant(value.to_bits()), [])
    }

    fn scale(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }

    fn abs(self) -> Self {
        Self::new(Operation::Abs, [self])
    }

    fn squared(self) -> Self {
        Self::new(Operation::Squared, [self])
    }

    fn sqrt(self) -> Self {
        Self::new(Operation::Sqrt, [self])
    }

    fn min(self, other: Self) -> Self {
        Self::new(Operation::Min, [self, other])
    }

    fn max(self, other: Self) -> Self {
        Self::new(Operation::Max, [self, other])
    }

    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
        Self::new(Operation::SelectLess, [a, b, if_less, otherwise])
    }

    fn sin(self) -> Self {
        Self::new(Operation::Sin, [self])
    }

    fn cos(self) -> Self {
        Self::new(Operation::Cos, [self])
    }

    fn norm<const N: usize>(x: [Self; N]) -> Self {
        Self::new(Operation::Norm, x)
    }

    fn orthant<const N: usize>(q: [Self; N]) -> Self {
        Self::new(Operation::Orthant, q)
    }

    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
        Self::new(Operation::NearestMultiple(spacing, low, high), [self])
    }

    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
        Self::new(Operation::SmoothMin(B::NAME, unit), [self, other])
    }
}

/// A recorded formula: its nodes, each after its arguments.
struct Formula {
    nodes: Vec<Node>,
    result: usize,
}

impl Formula {
    fn record<const D: usize>(distance: impl Fn(Vector<Recorded, D>) -> Recorded) -> Self {
        NODES.take();
        let coordinate = |i| Recorded::new(Operation::Coordinate(i), []);
        let result = distance(Vector(std::array::from_fn(coordinate))).0;
        Self { nodes: NODES.take(), result }
    }

    /// How often the result uses each node.
    fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.nodes.len()];
        uses[self.result] = 1;
        for (i, node) in self.nodes.iter().enumerate().rev() {
            if uses[i] > 0 {
                node.arguments.iter().for_each(|a| uses[*a] += 1);
            }
        }
        uses
    }

    /// The formula as text: what is used more than once has a name.
    fn print(&self) -> String {
        let uses = self.uses();
        let mut texts: Vec<String> = Vec::new();
        let mut lines = String::new();
        let mut names = 0;
        for (i, node) in self.nodes.iter().enumerate() {
            let mut text = self.text(node, &texts);
            if uses[i] > 1 && !node.is_short() {
                let _ = writeln!(lines, "let v{names} = {}", without_brackets(&text));
                text = format!("v{names}");
                names += 1;
            }
            texts.push(text);
        }
        lines + without_brackets(&texts[self.result])
    }

    fn text(&self, node: &Node, texts: &[String]) -> String {
        let all: Vec<&str> = node.arguments.iter().map(|a| texts[*a].as_str()).collect();
        let call = |name: &str| {
            let plain: Vec<&str> = all.iter().map(|text| without_brackets(text)).collect();
            format!("{name}({})", plain.join(", "))
        };
        match node.operation {
            Operation::Coordinate(i) => ["x", "y", "z"][i].into(),
            Operation::Constant(bits) => format!("{:?}", f64::from_bits(bits)),
            Operation::Add => format!("({} + {})", all[0], all[1]),
            Operation::Sub => format!("({} - {})", all[0], all[1]),
            Operation::Mul => format!("({} * {})", all[0], all[1]),
            Operation::Div => format!("({} / {})", all[0], all[1]),
            Operation::Neg => format!("-{}", all[0]),
            Operation::Abs => call("abs"),
            Operation::Squared => call("squared"),
            Operation::Sqrt => call("sqrt"),
            Operation::Min => call("min"),
            Operation::Max => call("max"),
            Operation::SelectLess => call("select_less"),
            Operation::Sin => call("sin"),
            Operation::Cos => call("cos"),
            Operation::Norm => call("norm"),
            Operation::Orthant => call("orthant"),
            Operation::NearestMultiple(spacing, low, high) => {
                call(&format!("nearest_multiple<{spacing:?}, {low:?}, {high:?}>"))
            }
            Operation::SmoothMin(profile, unit) => {
                call(&format!("smooth_min<{profile}, {unit:?}>"))
            }
        }
    }

    /// The formula at a point.
    fn evaluate<const D: usize>(&self, p: Point<D>) -> f64 {
        let mut values: Vec<f64> = Vec::new();
        for node in &self.nodes {
            let x: Vec<f64> = node.arguments.iter().map(|a| values[*a]).collect();
            values.push(match node.operation {
                Operation::Coordinate(i) => p[i],
                Operation::Constant(bits) => f64::from_bits(bits),
                Operation::Add => x[0] + x[1],
                Operation::Sub => x[0] - x[1],
                Operation::Mul => x[0] * x[1],
                Operation::Div => x[0] / x[1],
                Operation::Neg => -x[0],
                Operation::Abs => x[0].abs(),
                Operation::Squared => x[0].squared(),
                Operation::Sqrt => x[0].sqrt(),
                Operation::Min => Scalar::min(x[0], x[1]),
                Operation::Max => Scalar::max(x[0], x[1]),
                Operation::SelectLess => f64::select_less(x[0], x[1], x[2], x[3]),
                Operation::Sin => Scalar::sin(x[0]),
                Operation::Cos => Scalar::cos(x[0]),
                Operation::Norm => match x[..] {
                    [a, b] => f64::norm([a, b]),
                    [a, b, c] => f64::norm([a, b, c]),
                    _ => panic!("the norm of {} numbers", x.len()),
                },
                Operation::Orthant => match x[..] {
                    [a, b] => f64::orthant([a, b]),
                    [a, b, c] => f64::orthant([a, b, c]),
                    _ => panic!("the orthant of {} numbers", x.len()),
                },
                Operation::NearestMultiple(spacing, low, high) => {
                    x[0].nearest_multiple(spacing, low, high)
                }
                Operation::SmoothMin(profile, unit) => smooth_min(profile, x[0], x[1], unit),
            });
        }
        values[self.result]
    }
}

/// The smooth minimum by the name of its profile.
fn smooth_min(profile: &str, a: f64, b: f64, unit: f64) -> f64 {
    match profile {
        Quadratic::NAME => a.smooth_min::<Quadratic>(b, unit),
        Cubic::NAME => a.smooth_min::<Cubic>(b, unit),
        Quartic::NAME => a.smooth_min::<Quartic>(b, unit),
        Circular::NAME => a.smooth_min::<Circular>(b, unit),
        Root::NAME => a.smooth_min::<Root>(b, unit),
        Exponential::NAME => a.smooth_min::<Exponential>(b, unit),
        _ => panic!("no profile {profile}"),
    }
}

/// `text` without the brackets around all of it.
fn without_brackets(text: &str) -> &str {
    // Only operators put a bracket first, and it ends with them.
    text.strip_prefix('(').and_then(|text| text.strip_suffix(')')).unwrap_or(text)
}

fn formula<K: Kernel<D>, const D: usize>(kernel: &K) -> String {
    Formula::record(|p| kernel.distance(p)).print()
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
    let blend = |p| {
        let (a, b): (Recorded, Recorded) = (ball.distance(p), cube.distance(p));
        a.smooth_min::<Quadratic>(b, 0.25)
    };
    insta::assert_snapshot!("smooth_union", Formula::record(blend).print());

    let third = Rotation::from_matrix([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])?;
    let placement = Placement::new(Pose::new(third, Vector([1.0, 2.0, 3.0])));
    let placed = |p| cube.distance(placement.to_body(p));
    insta::assert_snapshot!("placed_cuboid", Formula::record(placed).print());
    Ok(())
}

/// The recorded formula has the bits of the kernel at a few points.
struct Agrees<const D: usize>(Vec<Point<D>>);

impl<const D: usize> Visit<D> for Agrees<D> {
    type Output = Result<(), String>;

    fn visit<K: Primitive<D>>(self, kernel: K) -> Result<(), String> {
        let formula = Formula::record(|p| kernel.distance(p));
        for p in self.0 {
            let direct: f64 = kernel.distance(p);
            let recorded = formula.evaluate(p);
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
