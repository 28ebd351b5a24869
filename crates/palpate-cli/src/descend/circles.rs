// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The circles around an element, and whether they exclude it: memoir 3.2, last paragraph.

use palpate::field::{BoundingBall, Point, Shape};
use palpate::query::Element;
use serde::Serialize;

use palpate::scene::text::joined;

/// Balls around an element; circles in the plane.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Circles<const D: usize> {
    /// The smallest ball.
    smallest: Circle<D>,
    /// The ball through the corners; `null` of a segment, for which it is the smallest, and of
    /// corners on a line.
    circumscribed: Option<Circle<D>>,
}

/// A ball around an element, and what the field says at its centre.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Circle<const D: usize> {
    #[serde(skip)]
    pub(super) name: &'static str,
    /// The centre [m].
    pub(super) centre: Point<D>,
    /// The radius [m].
    pub(super) radius: f64,
    /// The field's value at the centre [m].
    value: f64,
    /// The memoir's test, f(C) > r: `true` if the value exceeds the radius.
    excludes: bool,
    /// `true` if the field's promise proves that the ball does not meet the shape.
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
}

impl<const D: usize> Circle<D> {
    fn of(name: &'static str, shape: &Shape<D>, ball: BoundingBall<D>) -> Self {
        let BoundingBall { centre, radius } = ball;
        let value = shape.distance(centre);
        let is_proven = value > 0.0 && shape.safe_radius(centre) > radius;
        Self { name, centre, radius, value, excludes: value > radius, is_proven }
    }

    /// The comparison in words, with lengths as `length` writes them.
    pub(super) fn in_words(&self, what: &str, length: impl Fn(f64) -> String) -> String {
        let sign = if self.excludes { ">" } else { "≤" };
        let [value, radius] = [self.value, self.radius].map(length);
        let verdict = match (self.excludes, self.is_proven) {
            (true, true) => "excludes",
            // Too steep a field, or a difference within rounding.
            (true, false) => "excludes, without a proof,",
            _ => "does not exclude",
        };
        format!("f(C) = {value} {sign} r = {radius}: {verdict} the {what}")
    }

    /// The centre as text.
    pub(super) fn centre(&self) -> String {
        joined(&self.centre.0)
    }
}
