// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Formulas as data.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt;
use std::mem::{Discriminant, discriminant};

use super::{Circular, Cubic, Exponential, Quadratic, Quartic, Root, Scalar};

/// What a step of an [`Expression`] does with its arguments: the operations of [`Scalar`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Operation {
    /// A coordinate of the point [m], by the number of its axis.
    Coordinate(usize),
    /// A number.
    Constant(f64),
    /// `a + b`.
    Add,
    /// `a − b`.
    Sub,
    /// `a · b`.
    Mul,
    /// `a / b`.
    Div,
    /// `−a`.
    Neg,
    /// `|a|`.
    Abs,
    /// `a²`.
    Squared,
    /// `√a`.
    Sqrt,
    /// The smaller of two, the first at a tie.
    Min,
    /// The larger of two, the first at a tie.
    Max,
    /// Of `a, b, c, d`: `c` where `a < b`, else `d`.
    SelectLess,
    /// The sine of an angle [rad]: [`Scalar::sin`].
    Sin,
    /// The cosine of an angle [rad]: [`Scalar::cos`].
    Cos,
    /// The angle of the point `(a, b)` as a part of a turn: [`Scalar::turn`].
    Turn,
    /// The Euclidean norm: [`Scalar::norm`].
    Norm,
    /// The signed distance to an orthant: [`Scalar::orthant`].
    Orthant,
    /// The smooth minimum of two: [`Scalar::smooth_min`].
    SmoothMin {
        /// The name of the [`Blend`](super::Blend).
        profile: &'static str,
        /// Its length unit [m].
        unit: f64,
    },
    /// The nearest multiple: [`Scalar::nearest_multiple`].
    NearestMultiple {
        /// From one multiple to the next.
        spacing: f64,
        /// The lowest factor.
        low: f64,
        /// The highest factor.
        high: f64,
    },
}

/// An operation and its arguments.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// The operation.
    pub operation: Operation,
    /// The numbers of the steps that give its arguments, all before this one.
    pub arguments: Vec<usize>,
}

impl Step {
    /// Whether it is short enough to be written again wherever it is used.
    fn is_short(&self) -> bool {
        matches!(self.operation, Operation::Coordinate(_) | Operation::Constant(_))
    }
}

/// A formula as data: steps in an order in which they can be evaluated. What occurs twice
/// is one step.
///
/// [`Shape::formula`](crate::Shape::formula) gives that of a shape, for a shader or
/// another compiler. Evaluated with the operations of [`f64`], it has the bits of
/// [`Shape::distance`](crate::Shape::distance).
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    steps: Vec<Step>,
    result: usize,
}

impl Expression {
    /// The steps, each after those that give its arguments.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The number of the step that gives the result.
    #[must_use]
    pub fn result(&self) -> usize {
        self.result
    }

    /// The value at a point in double precision, by the operations of [`Scalar`].
    ///
    /// # Panics
    ///
    /// If the point has fewer coordinates than the expression uses.
    #[must_use]
    pub fn evaluate(&self, point: &[f64]) -> f64 {
        let mut values: Vec<f64> = Vec::with_capacity(self.steps.len());
        let mut x = Vec::new();
        for step in &self.steps {
            x.clear();
            x.extend(step.arguments.iter().map(|argument| values[*argument]));
            values.push(step.operation.apply(&x, point));
        }
        values[self.result]
    }

    /// How often the result uses each step.
    fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.steps.len()];
        uses[self.result] = 1;
        for (i, step) in self.steps.iter().enumerate().rev() {
            if uses[i] > 0 {
                step.arguments.iter().for_each(|a| uses[*a] += 1);
            }
        }
        uses
    }
}

impl Operation {
    fn apply(self, x: &[f64], point: &[f64]) -> f64 {
        match self {
            Self::Coordinate(axis) => point[axis],
            Self::Constant(value) => value,
            Self::Add => x[0] + x[1],
            Self::Sub => x[0] - x[1],
            Self::Mul => x[0] * x[1],
            Self::Div => x[0] / x[1],
            Self::Neg => -x[0],
            Self::Abs => x[0].abs(),
            Self::Squared => x[0].squared(),
            Self::Sqrt => Scalar::sqrt(x[0]),
            Self::Min => Scalar::min(x[0], x[1]),
            Self::Max => Scalar::max(x[0], x[1]),
            Self::SelectLess => f64::select_less(x[0], x[1], x[2], x[3]),
            Self::Sin => Scalar::sin(x[0]),
            Self::Cos => Scalar::cos(x[0]),
            Self::Turn => Scalar::turn(x[0], x[1]),
            Self::Norm => match *x {
                [a] => f64::norm([a]),
                [a, b] => f64::norm([a, b]),
                [a, b, c] => f64::norm([a, b, c]),
                _ => unreachable!("the norm of {} numbers", x.len()),
            },
            Self::Orthant => match *x {
                [a] => f64::orthant([a]),
                [a, b] => f64::orthant([a, b]),
                [a, b, c] => f64::orthant([a, b, c]),
                _ => unreachable!("the orthant of {} numbers", x.len()),
            },
            Self::SmoothMin { profile, unit } => smooth_min(profile, x[0], x[1], unit),
            Self::NearestMultiple { spacing, low, high } => {
                x[0].nearest_multiple(spacing, low, high)
            }
        }
    }

    /// Whether it holds numbers of a shape.
    fn has_numbers(self) -> bool {
        matches!(
            self,
            Self::Constant(_) | Self::SmoothMin { .. } | Self::NearestMultiple { .. }
        )
    }

    /// What tells operations of one kind apart: a negative zero is not a zero.
    fn parameters(self) -> (&'static str, [u64; 3]) {
        match self {
            Self::Coordinate(axis) => ("", [axis as u64, 0, 0]),
            Self::Constant(value) => ("", [value.to_bits(), 0, 0]),
            Self::SmoothMin { profile, unit } => (profile, [unit.to_bits(), 0, 0]),
            Self::NearestMultiple { spacing, low, high } => {
                ("", [spacing, low, high].map(f64::to_bits))
            }
            _ => ("", [0; 3]),
        }
    }
}

/// The smooth minimum by the name of its profile.
fn smooth_min(profile: &str, a: f64, b: f64, unit: f64) -> f64 {
    use super::Blend;
    match profile {
        Quadratic::NAME => a.smooth_min::<Quadratic>(b, unit),
        Cubic::NAME => a.smooth_min::<Cubic>(b, unit),
        Quartic::NAME => a.smooth_min::<Quartic>(b, unit),
        Circular::NAME => a.smooth_min::<Circular>(b, unit),
        Root::NAME => a.smooth_min::<Root>(b, unit),
        Exponential::NAME => a.smooth_min::<Exponential>(b, unit),
        _ => unreachable!("no profile {profile}"),
    }
}

/// What makes two steps the same.
type Key = (Discriminant<Operation>, (&'static str, [u64; 3]), Vec<usize>);

/// The steps recorded so far.
#[derive(Debug, Default)]
pub(super) struct Graph {
    steps: Vec<Step>,
    known: HashMap<Key, usize>,
    /// Whether equal constants are steps of their own.
    has_slots: bool,
}

impl Graph {
    /// A graph in which each constant is a step of its own, and each operation with numbers of
    /// its own too.
    pub(super) fn with_slots() -> Self {
        Self { has_slots: true, ..Self::default() }
    }

    /// The number of the step that does this, a new one if there is none.
    pub(super) fn place(&mut self, operation: Operation, arguments: Vec<usize>) -> usize {
        if self.has_slots && operation.has_numbers() {
            self.steps.push(Step { operation, arguments });
            return self.steps.len() - 1;
        }
        let key = (discriminant(&operation), operation.parameters(), arguments.clone());
        match self.known.entry(key) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(place) => {
                self.steps.push(Step { operation, arguments });
                *place.insert(self.steps.len() - 1)
            }
        }
    }

    /// The expression whose value is that of step `result`.
    pub(super) fn finish(self, result: usize) -> Expression {
        Expression { steps: self.steps, result }
    }
}

impl fmt::Display for Expression {
    /// Writes the formula; what is used more than once has a name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let uses = self.uses();
        let mut texts: Vec<String> = Vec::new();
        let mut names = 0;
        for (step, uses) in self.steps.iter().zip(uses) {
            let mut text = text(step, &texts);
            if uses > 1 && !step.is_short() {
                writeln!(f, "let v{names} = {}", without_brackets(&text))?;
                text = format!("v{names}");
                names += 1;
            }
            texts.push(text);
        }
        f.write_str(without_brackets(&texts[self.result]))
    }
}

/// A step as text, from the texts of those before it.
fn text(step: &Step, texts: &[String]) -> String {
    let all: Vec<&str> = step.arguments.iter().map(|a| texts[*a].as_str()).collect();
    let call = |name: &str| {
        let plain: Vec<&str> = all.iter().map(|text| without_brackets(text)).collect();
        format!("{name}({})", plain.join(", "))
    };
    let infix = |operator: &str| format!("({} {operator} {})", all[0], all[1]);
    match step.operation {
        Operation::Coordinate(axis) => ["x", "y", "z"][axis].into(),
        Operation::Constant(value) => format!("{value:?}"),
        Operation::Add => infix("+"),
        Operation::Sub => infix("-"),
        Operation::Mul => infix("*"),
        Operation::Div => infix("/"),
        Operation::Neg => format!("-{}", all[0]),
        Operation::Abs => call("abs"),
        Operation::Squared => call("squared"),
        Operation::Sqrt => call("sqrt"),
        Operation::Min => call("min"),
        Operation::Max => call("max"),
        Operation::SelectLess => call("select_less"),
        Operation::Sin => call("sin"),
        Operation::Cos => call("cos"),
        Operation::Turn => call("turn"),
        Operation::Norm => call("norm"),
        Operation::Orthant => call("orthant"),
        Operation::SmoothMin { profile, unit } => {
            call(&format!("smooth_min<{profile}, {unit:?}>"))
        }
        Operation::NearestMultiple { spacing, low, high } => {
            call(&format!("nearest_multiple<{spacing:?}, {low:?}, {high:?}>"))
        }
    }
}

/// `text` without the brackets around all of it.
fn without_brackets(text: &str) -> &str {
    // Only operators put a bracket first, and it ends with them.
    text.strip_prefix('(').and_then(|text| text.strip_suffix(')')).unwrap_or(text)
}
