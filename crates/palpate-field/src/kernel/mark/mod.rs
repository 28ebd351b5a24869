// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a primitive shows its parameters, for pictures.

pub(crate) mod sets;

use crate::vector::Vector;

/// The points of an arc that shows an angle.
const ARC: usize = 33;

/// What a [`Mark`] shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MarkKind {
    /// A position: one point.
    Position,
    /// A length: from one point to another.
    Length,
    /// A direction: from one point to another, of any length.
    Direction,
    /// An angle: the points of an arc.
    Angle,
}

/// Where a parameter, or one number of it, can be seen in a primitive.
///
/// ```
/// use palpate_field::catalogue::Entry;
/// use palpate_field::kernel::Argument;
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let torus = Entry::<3>::find("torus").unwrap();
/// let marks = torus.marks(&[Argument::Number(0.6), Argument::Number(0.2)])?;
/// assert_eq!((marks[0].name(), marks[0].length()), ("ring_radius".to_owned(), 0.6));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Mark<const D: usize> {
    /// The name of the parameter.
    pub parameter: &'static str,
    /// Which number or point of it: empty where it is one, `[2]` for the third, `[0, 2]` for the
    /// third of the first list.
    pub index: Vec<usize>,
    /// What it shows.
    pub kind: MarkKind,
    /// Its points, from one end to the other [m].
    pub points: Vec<Vector<f64, D>>,
    /// A length that is drawn beside the primitive is measured across this unit vector, which
    /// points out of the primitive.
    pub outwards: Option<Vector<f64, D>>,
}

impl<const D: usize> Mark<D> {
    /// As in a scene file: `radius`, `size[1]`, `rings[0][2]`.
    #[must_use]
    pub fn name(&self) -> String {
        let index = self.index.iter().map(|index| format!("[{index}]"));
        std::iter::once(self.parameter.to_owned()).chain(index).collect()
    }

    /// From the first point to the last [m]; beside the primitive, without the part outwards.
    #[must_use]
    pub fn length(&self) -> f64 {
        let [first, .., last] = self.points[..] else { return 0.0 };
        let span = last - first;
        self.outwards.map_or(span, |out| span - out * span.dot(out)).norm()
    }

    fn new(parameter: &'static str, kind: MarkKind, points: Vec<Vector<f64, D>>) -> Self {
        Self { parameter, index: Vec::new(), kind, points, outwards: None }
    }

    pub(crate) fn position(parameter: &'static str, at: Vector<f64, D>) -> Self {
        Self::new(parameter, MarkKind::Position, vec![at])
    }

    /// Each of some positions.
    pub(crate) fn positions(parameter: &'static str, all: &[Vector<f64, D>]) -> Vec<Self> {
        let position = |(i, at): (usize, &Vector<f64, D>)| Self::position(parameter, *at).of(i);
        all.iter().enumerate().map(position).collect()
    }

    pub(crate) fn length_between(
        parameter: &'static str,
        from: Vector<f64, D>,
        to: Vector<f64, D>,
    ) -> Self {
        Self::new(parameter, MarkKind::Length, vec![from, to])
    }

    /// A length along `to`, from the origin.
    pub(crate) fn from_origin(parameter: &'static str, to: Vector<f64, D>) -> Self {
        Self::length_between(parameter, Vector::ZERO, to)
    }

    pub(crate) fn direction(
        parameter: &'static str,
        from: Vector<f64, D>,
        to: Vector<f64, D>,
    ) -> Self {
        Self::new(parameter, MarkKind::Direction, vec![from, to])
    }

    /// The angle through which `place` goes while its argument goes from −½ to ½.
    pub(crate) fn angle(
        parameter: &'static str,
        place: impl Fn(f64) -> Vector<f64, D>,
    ) -> Self {
        let share = |i: usize| i as f64 / (ARC - 1) as f64 - 0.5;
        Self::new(parameter, MarkKind::Angle, (0..ARC).map(|i| place(share(i))).collect())
    }

    /// The number or point `index` of a list.
    pub(crate) fn of(mut self, index: usize) -> Self {
        self.index.insert(0, index);
        self
    }

    /// Drawn beside the primitive, across `outwards`, a unit vector.
    pub(crate) fn beside(self, outwards: Vector<f64, D>) -> Self {
        Self { outwards: Some(outwards), ..self }
    }

    pub(crate) fn left(self) -> Self {
        self.beside(-Vector::unit(0))
    }

    pub(crate) fn right(self) -> Self {
        self.beside(Vector::unit(0))
    }

    pub(crate) fn below(self) -> Self {
        self.beside(-Vector::unit(1))
    }

    pub(crate) fn above(self) -> Self {
        self.beside(Vector::unit(1))
    }

    /// A length along x, centred at the height `y`, from `-half` to `half`; drawn below.
    pub(crate) fn width(parameter: &'static str, half: f64, y: f64) -> Self {
        Self::length_between(parameter, at(-half, y), at(half, y)).below()
    }

    /// The full `height` of what is as wide as `2 bottom` below and `2 top` above, centred at
    /// half its height; drawn to the left.
    pub(crate) fn height(height: f64, bottom: f64, top: f64) -> Self {
        let half = 0.5 * height;
        Self::length_between("height", at(-bottom, -half), at(-top, half)).left()
    }

    /// The edge lengths of a box about the origin, whose faces are flat up to `rounding` from its
    /// edges.
    pub(crate) fn edges(size: Vector<f64, D>, rounding: f64) -> Vec<Self> {
        let half = size * 0.5;
        let edge = |i: usize| {
            let other = usize::from(i == 0);
            let beside = Vector::unit(other) * (rounding - half[other]);
            let end = Vector::unit(i) * half[i];
            let out = -Vector::unit(other);
            Self::length_between("size", beside - end, beside + end).of(i).beside(out)
        };
        (0..D).map(edge).collect()
    }

    /// The radius of the edges of a box of this `size` about the origin.
    pub(crate) fn rounding(size: Vector<f64, D>, rounding: f64) -> Self {
        let centre = at(0.5 * size[0] - rounding, 0.5 * size[1] - rounding);
        Self::length_between("rounding", centre, centre + diagonal() * rounding)
    }

    /// Radii along the axes.
    pub(crate) fn radii(radii: Vector<f64, D>) -> Vec<Self> {
        let radius = |i| Self::from_origin("radii", Vector::unit(i) * radii[i]).of(i);
        (0..D).map(radius).collect()
    }
}

/// The point at `x` and `y`.
pub(crate) fn at<const D: usize>(x: f64, y: f64) -> Vector<f64, D> {
    Vector::unit(0) * x + Vector::unit(1) * y
}

/// The point at `radius` from the origin, turned by `angle` from +y towards +x.
pub(crate) fn turned<const D: usize>(angle: f64, radius: f64) -> Vector<f64, D> {
    at(radius * libm::sin(angle), radius * libm::cos(angle))
}

/// The unit vector between +x and +y.
pub(crate) fn diagonal<const D: usize>() -> Vector<f64, D> {
    at(std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2)
}

/// An upright line is within so much of y [1].
const UPRIGHT: f64 = 0.999;

/// A unit vector across `line`: as far up as it goes, or along x if `line` is upright.
pub(crate) fn across<const D: usize>(line: Vector<f64, D>) -> Vector<f64, D> {
    let along = line.normalized().unwrap_or(Vector::unit(0));
    let axis = usize::from(along[1].abs() < UPRIGHT);
    let part = Vector::unit(axis) - along * along[axis];
    part.normalized().unwrap_or(Vector::unit(0))
}
