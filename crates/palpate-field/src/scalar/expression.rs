// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Formulas as data.

use std::fmt;

use crate::machine::Tape;

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
    pub(super) steps: Vec<Step>,
    pub(super) result: usize,
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
        Tape::of_expression(self).at(point)
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
    /// Whether it holds numbers of a shape.
    pub(super) fn has_numbers(self) -> bool {
        matches!(
            self,
            Self::Constant(_) | Self::SmoothMin { .. } | Self::NearestMultiple { .. }
        )
    }

    /// What tells operations of one kind apart: a negative zero is not a zero.
    pub(super) fn parameters(self) -> (&'static str, [u64; 3]) {
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
