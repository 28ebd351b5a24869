// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Ways to the direction of a gradient: those of the memoir's section 2.3, beside the library's
//! own.
//!
//! Sines come from `libm`, so that directions are the same on every machine.

use palpate_field::{Point, Shape, Vector};
use palpate_query::{BallWorkspace, Limits, QueryError, contact_ball};

/// A way to the direction of a field's gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GradientMethod {
    /// [`closest_vector`], to within the offset: as the memoir prints it, the direction of the
    /// gradient outside, its opposite inside, none on the surface.
    ///
    /// The memoir has formulas of g for a circle and a rectangle; here g is searched for, for
    /// every field.
    ClosestVector,
    /// [`central_differences`].
    Differences,
    /// [`dichotomy`] at a fixed offset; in the plane alone.
    Dichotomy,
    /// [`dichotomy`] at the [`adaptive_offset`]; in the plane alone.
    AdaptiveDichotomy,
    /// The gradient of the formula, evaluated in dual numbers: what
    /// [`Shape::distance_gradient`] gives.
    Exact,
}

named!(GradientMethod:
    ClosestVector = "closest_vector",
    Differences = "differences",
    Dichotomy = "dichotomy",
    AdaptiveDichotomy = "adaptive_dichotomy",
    Exact = "exact"
);

impl GradientMethod {
    /// Whether the method turns in a plane, and has no direction in space.
    #[must_use]
    pub const fn is_planar(self) -> bool {
        matches!(self, Self::Dichotomy | Self::AdaptiveDichotomy)
    }

    /// Whether the method compares values around the point, so that their offset and their
    /// rounding matter.
    #[must_use]
    pub const fn samples(self) -> bool {
        matches!(self, Self::Differences | Self::Dichotomy | Self::AdaptiveDichotomy)
    }
}

/// The direction that a method found, and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FoundDirection<const D: usize> {
    /// The direction, of length one; `None` where the method finds none.
    pub direction: Option<Vector<f64, D>>,
    /// How often the field was asked; a gradient in dual numbers counts twice.
    pub evaluations: u32,
}

/// Finds directions of gradients by any [`GradientMethod`].
///
/// Above a disc the gradient points up. Central differences ask 4 values; a dichotomy asks 12,
/// and is off by up to 120°/2¹⁰. −g/‖g‖ points up too, and down inside:
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_local::{GradientMethod, GradientSampler, angle_between};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let disc = Shape::<2>::ball(1.0)?;
/// let sampler = GradientSampler::new(1e-6)?;
/// let up = Vector([0.0, 1.0]);
/// let of = |method, y| sampler.find(method, &disc, Vector([0.0, y]));
/// let error = |method, y| {
///     let direction = of(method, y).direction.ok_or("there is no direction")?;
///     Ok::<f64, &str>(angle_between(direction, up).to_degrees())
/// };
/// assert!(error(GradientMethod::Differences, 2.0)? < 1e-6);
/// assert!(error(GradientMethod::Dichotomy, 2.0)? < 120.0 / 1024.0);
/// assert!(error(GradientMethod::ClosestVector, 2.0)? < 1e-6);
/// assert!(error(GradientMethod::ClosestVector, 0.5)? > 179.999);
/// assert_eq!(error(GradientMethod::Exact, 0.5)?, 0.0);
/// assert_eq!(of(GradientMethod::Differences, 2.0).evaluations, 4);
/// assert_eq!(of(GradientMethod::AdaptiveDichotomy, 2.0).evaluations, 13);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientSampler {
    offset: f64,
    is_single: bool,
}

impl GradientSampler {
    /// The memoir's offset as a share of what is drawn: its 0.005 pixels, of 1000.
    pub const OFFSET_SHARE: f64 = 5e-6;

    /// A sampler that asks values at `offset` [m] around the point.
    ///
    /// # Errors
    ///
    /// If the offset is not positive, or beyond 1e15 m.
    pub fn new(offset: f64) -> Result<Self, QueryError> {
        QueryError::check_length(offset)?;
        if offset > 0.0 {
            Ok(Self { offset, is_single: false })
        } else {
            Err(QueryError::Setting { what: "an offset", value: offset })
        }
    }

    /// The same sampler, which rounds the values that it compares to single precision, as the
    /// memoir's program does.
    #[must_use]
    pub const fn in_single_precision(self) -> Self {
        Self { is_single: true, ..self }
    }

    /// Whether it rounds values to single precision.
    #[must_use]
    pub const fn is_single(&self) -> bool {
        self.is_single
    }

    /// The offset [m].
    #[must_use]
    pub const fn offset(&self) -> f64 {
        self.offset
    }

    /// The direction of the gradient of `shape` at `p` [m]; none by a
    /// [planar](GradientMethod::is_planar) method in space.
    #[must_use]
    pub fn find<const D: usize>(
        &self,
        method: GradientMethod,
        shape: &Shape<D>,
        p: Point<D>,
    ) -> FoundDirection<D> {
        let mut evaluations = 0;
        let mut value = |p| {
            evaluations += 1;
            let value = shape.distance(p);
            if self.is_single { f64::from(value as f32) } else { value }
        };
        let direction = match method {
            GradientMethod::ClosestVector => {
                return closest_vector(shape, p, self.offset, &mut BallWorkspace::new());
            }
            GradientMethod::Exact => {
                let direction = shape.distance_gradient(p).1.normalized();
                return FoundDirection { direction, evaluations: 2 };
            }
            GradientMethod::Differences => central_differences(value, p, self.offset),
            GradientMethod::Dichotomy => dichotomy(value, p, self.offset),
            GradientMethod::AdaptiveDichotomy => {
                let offset = adaptive_offset(value(p), self.offset);
                dichotomy(value, p, offset)
            }
        };
        FoundDirection { direction, evaluations }
    }
}

/// −g/‖g‖ of the vector g from `p` [m] to the nearest point of the surface, whose distance is known
/// to within `tolerance` [m] ([`contact_ball`] with no radius).
///
/// `None` on the surface, where g has no length, and where no surface was found.
#[must_use]
pub fn closest_vector<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
    tolerance: f64,
    workspace: &mut BallWorkspace<D>,
) -> FoundDirection<D> {
    // A point that cannot be asked about has no nearest point.
    let found = contact_ball(shape, p, 0.0, &Limits::new(tolerance), workspace).ok();
    let evaluations = found.as_ref().map_or(0, |found| found.evaluations);
    let surface = found.and_then(|found| found.best);
    let direction = surface.and_then(|contact| (p - contact.point_a).normalized());
    FoundDirection { direction, evaluations }
}

/// The direction of the differences of a field's values on both sides of `p`, along each axis:
/// the memoir's `d₀ − d₁` for any dimension, from 2·D values at `offset` [m].
///
/// `None` where all differences are zero.
#[must_use]
pub fn central_differences<const D: usize>(
    mut value: impl FnMut(Point<D>) -> f64,
    p: Point<D>,
    offset: f64,
) -> Option<Vector<f64, D>> {
    let mut differences = Vector::ZERO;
    for axis in 0..D {
        let step = Vector::unit(axis) * offset;
        differences[axis] = value(p + step) - value(p - step);
    }
    differences.normalized()
}

/// The memoir's offset where the field has this `value` [m]: `max(o, f·0.005/20)`, whose factor
/// 1/4000 has no unit.
///
/// Inside, values are negative and the offset is the least one.
#[must_use]
pub fn adaptive_offset(value: f64, least: f64) -> f64 {
    /// 0.005 pixels at a value of 20 pixels.
    const GROWTH: f64 = 0.005 / 20.0;
    least.max(value * GROWTH)
}

/// The direction in the plane in which a field is greatest at `offset` [m] around `p`, by the
/// memoir's dichotomy: of three directions the better two, whose angle is then halved nine
/// times.
///
/// Twelve values; the direction is off by up to 120°/2¹⁰ = 0.117° even where they are exact.
/// `None` in space, where directions do not lie on a circle.
#[must_use]
pub fn dichotomy<const D: usize>(
    mut value: impl FnMut(Point<D>) -> f64,
    p: Point<D>,
    offset: f64,
) -> Option<Vector<f64, D>> {
    const HALVINGS: usize = 9;
    if D != 2 {
        return None;
    }
    let direction = |degrees: f64| {
        let angle = degrees.to_radians();
        Vector([libm::cos(angle), libm::sin(angle), 0.0]).truncated()
    };
    let mut ask = |degrees: f64| (value(p + direction(degrees) * offset), degrees);
    let three = [60.0, 180.0, 300.0].map(&mut ask);
    let worst = if three[0].0 <= three[1].0 && three[0].0 <= three[2].0 {
        0
    } else if three[1].0 <= three[2].0 {
        1
    } else {
        2
    };
    let mut low = three[(worst + 1) % 3];
    let mut high = three[(worst + 2) % 3];
    if high.1 < low.1 {
        high.1 += 360.0;
    }
    for _ in 0..HALVINGS {
        let middle = ask(0.5 * (low.1 + high.1));
        if low.0 < high.0 { low = middle } else { high = middle }
    }
    Some(direction(if low.0 < high.0 { high.1 } else { low.1 }))
}

/// The angle between two directions of length one [rad], from 0 to π.
///
/// `2·atan2(‖a − b‖, ‖a + b‖)`, which keeps its digits for directions that nearly agree (Kahan,
/// "How Futile are Mindless Assessments of Roundoff in Floating-Point Computation?", 2006).
///
/// ```
/// use palpate_field::Vector;
/// use palpate_local::angle_between;
///
/// let angle = angle_between(Vector([1.0, 0.0]), Vector([0.0, -1.0]));
/// assert!((angle - 0.5 * std::f64::consts::PI).abs() < 1e-15);
/// ```
#[must_use]
pub fn angle_between<const D: usize>(a: Vector<f64, D>, b: Vector<f64, D>) -> f64 {
    2.0 * libm::atan2((a - b).norm(), (a + b).norm())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_adaptive_offset_grows_from_where_the_value_is_four_thousand_offsets() {
        // In the memoir's pixels: 0.005 up to a value of 20, and in proportion beyond.
        for (value, offset) in [(-300.0, 0.005), (20.0, 0.005), (40.0, 0.01), (500.0, 0.125)] {
            assert!((adaptive_offset(value, 0.005) - offset).abs() < 1e-15, "{value}");
        }
    }

    #[test]
    fn a_plane_has_its_normal_by_differences_and_none_by_a_dichotomy_in_space() {
        let normal = Vector([0.48, -0.6, 0.64]);
        let value = |p: Point<3>| normal.dot(p);
        let p = Vector([0.25, 0.5, -0.125]);
        let found = central_differences(value, p, 0.5).unwrap_or(Vector::ZERO);
        assert!(angle_between(found, normal) < 1e-15);
        assert_eq!(dichotomy(value, p, 0.5), None);
        assert_eq!(central_differences(|_: Point<3>| 1.0, p, 0.5), None);
    }

    #[test]
    fn a_dichotomy_ends_at_the_nearest_of_its_angles() {
        // The angles are multiples of 120°/2⁹ from 60°; this one is a third past the fifth.
        let step: f64 = 120.0 / 512.0;
        let angle = (60.0 + (5.0 + 1.0 / 3.0) * step).to_radians();
        let towards = Vector([libm::cos(angle), libm::sin(angle)]);
        let found = dichotomy(|p: Point<2>| towards.dot(p), Vector::ZERO, 1.0);
        let off = angle_between(found.unwrap_or(Vector::ZERO), towards).to_degrees();
        assert!((off - step / 3.0).abs() < 1e-10, "{off}");
    }

    #[test]
    fn an_offset_is_a_length() {
        for (offset, said) in [
            (0.0, "an offset must be positive and at most 1e15, got 0.0"),
            (-1.0, "a length must be from 0 m to 1e15 m, got -1.0 m"),
        ] {
            let error = GradientSampler::new(offset).err().map(|error| error.to_string());
            assert_eq!(error.as_deref(), Some(said));
        }
        assert!(GradientSampler::new(f64::NAN).is_err());
    }
}
