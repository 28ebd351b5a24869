// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The circles around an element, and whether they exclude it: memoir 3.2, last paragraph.

use palpate::field::{BoundingBall, Shape};
use palpate::query::Element;
use serde_json::{Value, json};

use palpate::scene::text::joined;

/// The smallest ball around an element and the one through its corners; circles in the plane.
#[derive(Debug)]
pub(super) struct Circles<const D: usize> {
    smallest: Circle<D>,
    /// `None` of a segment, for which it is the smallest, and of corners on a line.
    circumscribed: Option<Circle<D>>,
}

/// A ball around an element, and what the field says at its centre.
#[derive(Debug)]
pub(super) struct Circle<const D: usize> {
    pub(super) name: &'static str,
    pub(super) ball: BoundingBall<D>,
    /// The field at the centre [m].
    value: f64,
    /// Whether the field's promise proves that the ball does not meet the shape.
    is_proven: bool,
}

impl<const D: usize> Circles<D> {
    pub(super) fn of<const N: usize>(shape: &Shape<D>, element: &Element<N, D>) -> Self {
        let [smallest, circumscribed] = if D == 2 {
            ["smallest circle", "circumscribed circle"]
        } else {
            ["smallest ball", "circumscribed ball"]
        };
        let around = element.circumscribed_ball().filter(|_| N == 3);
        Self {
            smallest: Circle::of(smallest, shape, element.smallest_ball()),
            circumscribed: around.map(|ball| Circle::of(circumscribed, shape, ball)),
        }
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Circle<D>> {
        [&self.smallest].into_iter().chain(&self.circumscribed)
    }

    /// As JSON.
    pub(super) fn described(&self) -> Value {
        json!({
            "smallest": self.smallest.described(),
            "circumscribed": self.circumscribed.as_ref().map(Circle::described),
        })
    }
}

impl<const D: usize> Circle<D> {
    fn of(name: &'static str, shape: &Shape<D>, ball: BoundingBall<D>) -> Self {
        let value = shape.distance(ball.centre);
        let is_proven = value > 0.0 && shape.safe_radius(ball.centre) > ball.radius;
        Self { name, ball, value, is_proven }
    }

    /// The memoir's test, f(C) > r.
    fn excludes(&self) -> bool {
        self.value > self.ball.radius
    }

    fn described(&self) -> Value {
        json!({
            "centre_m": self.ball.centre.0.to_vec(),
            "radius_m": self.ball.radius,
            "value_m": self.value,
            "excludes": self.excludes(),
            "proven": self.is_proven,
        })
    }

    /// The comparison in words, with lengths as `length` writes them.
    pub(super) fn in_words(&self, what: &str, length: impl Fn(f64) -> String) -> String {
        let sign = if self.excludes() { ">" } else { "≤" };
        let [value, radius] = [self.value, self.ball.radius].map(length);
        let verdict = match (self.excludes(), self.is_proven) {
            (true, true) => "excludes",
            // Too steep a field, or a difference within rounding.
            (true, false) => "excludes, without a proof,",
            _ => "does not exclude",
        };
        format!("f(C) = {value} {sign} r = {radius}: {verdict} the {what}")
    }

    /// The centre as text.
    pub(super) fn centre(&self) -> String {
        joined(&self.ball.centre.0)
    }
}
