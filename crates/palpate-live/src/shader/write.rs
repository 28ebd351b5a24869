// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The text of a shader.

use std::fmt::Write as _;

use palpate::field::scalar::Operation;

use super::numbering::{Number, Numbering, Value};

/// The functions that formulas call.
const LIBRARY: &str = include_str!("library.glsl");

/// A value whose text is longer gets a name: compilers refuse expressions that are nested more
/// than 256 deep.
const LONGEST: usize = 160;

/// Stands for infinity, which GLSL cannot write.
const FAR: &str = "1e38";

pub(super) fn glsl(numbering: &Numbering<'_>, results: &[usize], dimension: usize) -> String {
    let mut out = String::new();
    if numbering.uniforms() > 0 {
        // Writing to a string has no way to fail.
        let _ = writeln!(out, "uniform float u[{}];", numbering.uniforms());
    }
    out.push_str(LIBRARY);
    let _ = writeln!(out, "vec2 field(vec{dimension} p, int only) {{");
    let mut uses = vec![0_usize; numbering.values().len()];
    results.iter().for_each(|result| uses[*result] += 1);
    for (index, value) in numbering.values().iter().enumerate().rev() {
        if uses[index] > 0 {
            value.arguments.iter().for_each(|argument| uses[*argument] += 1);
        }
    }
    let mut texts: Vec<String> = Vec::with_capacity(uses.len());
    for (index, value) in numbering.values().iter().enumerate() {
        let mut text = if uses[index] > 0 { text(value, &texts) } else { String::new() };
        if !value.is_short() && (uses[index] > 1 || text.len() > LONGEST) {
            let _ = writeln!(out, "  float v{index} = {text};");
            text = format!("v{index}");
        }
        texts.push(text);
    }
    let _ = writeln!(out, "  float d = {FAR}, b = 0.0;");
    for (body, result) in results.iter().enumerate() {
        let is_asked = format!("only < 0 || only == {body}");
        let _ = writeln!(out, "  float d{body} = mix({FAR}, {}, {is_asked});", texts[*result]);
        let _ = writeln!(out, "  b = mix(b, {body}.0, d{body} < d);");
        let _ = writeln!(out, "  d = min(d, d{body});");
    }
    out.push_str("  return vec2(d, b);\n}\n");
    out
}

/// A value as text, from the texts of those before it.
fn text(value: &Value, texts: &[String]) -> String {
    let all: Vec<&str> =
        value.arguments.iter().map(|argument| texts[*argument].as_str()).collect();
    let numbers: Vec<String> = value.numbers.iter().map(|number| literal(*number)).collect();
    let call = |name: &str| {
        let numbers = numbers.iter().map(String::as_str);
        let arguments: Vec<&str> = all.iter().copied().chain(numbers).collect();
        format!("{name}({})", arguments.join(", "))
    };
    let infix = |operator: &str| format!("({} {operator} {})", all[0], all[1]);
    match value.operation {
        Operation::Coordinate(axis) => format!("p.{}", ["x", "y", "z"][axis]),
        Operation::Constant(_) => numbers[0].clone(),
        Operation::Add => infix("+"),
        Operation::Sub => infix("-"),
        Operation::Mul => infix("*"),
        Operation::Div => infix("/"),
        Operation::Neg => format!("(-{})", all[0]),
        Operation::Abs => call("abs"),
        Operation::Squared => call("squared"),
        Operation::Sqrt => call("sqrt"),
        Operation::Min => call("min"),
        Operation::Max => call("max"),
        Operation::SelectLess => call("select_less"),
        Operation::Sin => call("sine"),
        Operation::Cos => call("cosine"),
        Operation::Turn => call("turn"),
        Operation::Norm => call("norm"),
        Operation::Orthant => call("orthant"),
        Operation::SmoothMin { profile, .. } => call(&format!("smooth_min_{profile}")),
        Operation::NearestMultiple { .. } => call("nearest_multiple"),
        other => unreachable!("no GLSL for {other:?}"),
    }
}

/// A number as GLSL reads it.
fn literal(number: Number) -> String {
    let value = match number {
        Number::Uniform(place) => return format!("u[{place}]"),
        Number::Literal(bits) => f32::from_bits(bits),
    };
    match value {
        f32::INFINITY => FAR.to_owned(),
        f32::NEG_INFINITY => format!("(-{FAR})"),
        _ if value.is_sign_negative() => format!("({value:?})"),
        _ => format!("{value:?}"),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use palpate::field::Shape;

    use super::super::Formulas;
    use super::*;

    #[test]
    fn numbers_are_as_glsl_reads_them() {
        let literal = |value: f32| literal(Number::Literal(value.to_bits()));
        assert_eq!(literal(1.0), "1.0");
        assert_eq!(literal(-2.5e-9), "(-2.5e-9)");
        assert_eq!(literal(-0.0), "(-0.0)");
        assert_eq!(literal(f32::NEG_INFINITY), "(-1e38)");
        assert_eq!(literal(f32::MAX), "3.4028235e38");
    }

    #[test]
    fn what_two_bodies_share_is_written_once() {
        let ball = Shape::sphere(0.5).unwrap();
        let larger = ball.clone().offset(0.25).unwrap();
        let shader = Formulas::of([&ball, &larger]).unwrap().shader(&BTreeSet::new());
        assert_eq!(shader.glsl.matches("norm(p.x, p.y, p.z)").count(), 1);
        assert_eq!(shader.glsl.matches(';').count(), LIBRARY.matches(';').count() + 9);
        assert!(shader.uniforms.is_empty());
    }

    #[test]
    fn other_shapes_are_not_alike() {
        let formulas = |shape: Shape<2>| Formulas::of([&shape]).unwrap();
        let circle = formulas(Shape::circle(1.0).unwrap());
        let square = formulas(Shape::square(1.0).unwrap());
        assert_eq!(circle.slots_that_differ(&square), None);
        assert_eq!(circle.slots_that_differ(&circle), Some(BTreeSet::new()));
        let closure = Shape::from_fn(palpate::field::Promise::lipschitz(None, 1.0), |p| p[1]);
        assert_eq!(Formulas::of([&Shape::circle(1.0).unwrap(), &closure]), None);
    }
}
