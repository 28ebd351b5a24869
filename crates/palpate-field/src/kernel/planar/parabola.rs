// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Parabolas.

use super::parabola_foot::Quadratic;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at, sets};
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Float, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance from a parabola.
const OPERATIONS: f64 = 5.0;

/// The same for a segment.
const SEGMENT_OPERATIONS: f64 = 5.0;

/// The region above a parabola, `y ≥ x²/4F` with F the focal length. Exact, without
/// bounds.
///
/// The nearest point is a zero of a cubic, which Newton's method finds from above;
/// the distance is taken along the normal there.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Parabola};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let bowl = Shape::from_kernel(Parabola::new(0.25)?); // y = x²
/// assert_eq!(bowl.distance(Vector([0.0, -3.0])), 3.0);
/// assert_eq!(bowl.distance(Vector([0.0, 0.5])), -0.5); // the centre of curvature
/// // Out of (1, 1) along its normal (2, −1).
/// let five = 5.0_f64.sqrt();
/// assert!((bowl.distance(Vector([5.0, -1.0])) - 2.0 * five).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Parabola {
    focal_length: f64,
    curve: Quadratic,
}

impl Parabola {
    /// The parabola with its vertex at the origin and its focus `focal_length` above
    /// [m].
    ///
    /// # Errors
    ///
    /// If the focal length is not positive.
    pub fn new(focal_length: f64) -> Result<Self, ShapeError> {
        positive("focal_length", focal_length, Unit::Metre)?;
        // (4Fτ)²/4F = 4Fτ².
        let latus = 4.0 * focal_length;
        Ok(Self { focal_length, curve: Quadratic::new(latus, latus) })
    }
}

impl Kernel<2> for Parabola {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.curve.nearest(p.0[0].abs(), p.0[1]).below
    }

    /// The gradient is the normal at the nearest point, inside and outside.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, 2>) -> (T, Vector<T, 2>) {
        let nearest = self.curve.nearest(p.0[0].abs(), p.0[1]);
        (nearest.below, unfolded(p.0[0], nearest.normal))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.focal_length)
    }

    fn promise(&self) -> Promise<2> {
        Promise {
            symmetric: [true, false],
            ..Promise::exact_convex(None, OPERATIONS, self.focal_length)
        }
    }
}

/// A gradient at `(|x|, y)` as one at `(x, y)`.
#[inline(always)]
fn unfolded<T: Float>(x: T, [across, up]: [T; 2]) -> Vector<T, 2> {
    Vector([T::select_less(x, T::constant(0.0), -across, across), up])
}

primitive! {
    Parabola, parabola, 2,
    about: "What is above a parabola.",
    origin: "endless; at its vertex, opening upwards",
    parameters: { focal_length: Length = "from the vertex to the focus" },
    marks: |kernel| vec![Mark::from_origin("focal_length", at(0.0, kernel.focal_length()))],
    example: (0.2),
}

/// The region between a parabolic arch and its chord, centred at half its height.
/// Exact.
///
/// # Derivation
///
/// Fold to x ≥ 0. The nearest point is that of the arch's parabola, that of the chord, or their
/// corner. If the parabola's nearest point is on the arch, the distance is the larger of the
/// signed distances to parabola and chord: inside, the larger is the nearer boundary's;
/// outside, the smaller is negative. If not, the corner is the nearest right of it, else the
/// chord: what is below the chord or inside is never right of the corner.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::ParabolaSegment};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let arch = Shape::from_kernel(ParabolaSegment::new(4.0, 2.0)?);
/// assert_eq!(arch.distance(Vector([0.0, 3.0])), 2.0); // above the top
/// assert_eq!(arch.distance(Vector([1.0, -3.0])), 2.0); // below the chord
/// assert_eq!(arch.distance(Vector([-5.0, -5.0])), 5.0); // past a corner: 3-4-5
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ParabolaSegment {
    half_width: f64,
    height: f64,
    /// The arch, from its top down.
    curve: Quadratic,
}

impl ParabolaSegment {
    /// An arch of full `width` and `height` [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive.
    pub fn new(width: f64, height: f64) -> Result<Self, ShapeError> {
        let half_width = 0.5 * positive("width", width, Unit::Metre)?;
        positive("height", height, Unit::Metre)?;
        Ok(Self { half_width, height, curve: Quadratic::new(half_width, height) })
    }

    fn size(&self) -> f64 {
        self.half_width.max(self.height)
    }

    /// The distance and the gradient at `(|x|, y)`.
    #[inline(always)]
    fn solve<S: Scalar>(&self, p: Vector<S, 2>) -> (S, [S; 2]) {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let [x, y] = [p.0[0].abs(), p.0[1]];
        let half_height = S::constant(0.5 * self.height);
        let chord = -y - half_height;
        let nearest = self.curve.nearest(x, half_height - y);
        let arch = [nearest.normal[0], -nearest.normal[1]];
        let under = S::select_less(nearest.below, chord, chord, nearest.below);
        let slope = |i: usize, down: S| S::select_less(nearest.below, chord, down, arch[i]);

        let past = x - S::constant(self.half_width);
        let corner = S::norm([past, chord]);
        let on_it = S::constant(4.0 * S::epsilon() * self.size());
        // At the corner the offset has no direction; there the chord's normal is the gradient.
        let right = S::select_less(zero, past, S::select_less(corner, on_it, zero, one), zero);
        let inverse = one / S::select_less(corner, on_it, one, corner);
        let beside = |i: usize, towards: S, down: S| {
            let there = S::select_less(zero, right, towards * inverse, down);
            S::select_less(one, nearest.tau, there, slope(i, down))
        };
        let ended = S::select_less(zero, right, corner, chord);
        let distance = S::select_less(one, nearest.tau, ended, under);
        (distance, [beside(0, past, zero), beside(1, -chord, -one)])
    }
}

impl Kernel<2> for ParabolaSegment {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.solve(p).0
    }

    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, 2>) -> (T, Vector<T, 2>) {
        let (distance, gradient) = self.solve(p);
        (distance, unfolded(p.0[0], gradient))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, SEGMENT_OPERATIONS, self.size())
    }

    fn promise(&self) -> Promise<2> {
        let (w, h) = (self.half_width, self.height);
        // The ball through the corners and the top, or the one about the chord if the arch is
        // no higher.
        let (radius, middle) = if h < w {
            (w, -0.5 * h)
        } else {
            let radius = 0.5 * (w * (w / h) + h);
            (radius, 0.5 * h - radius)
        };
        let ball = BoundingBall { centre: Vector([0.0, middle]), radius };
        let bounds = Bounds { aabb: Aabb::centred(Vector([w, 0.5 * h])), ball };
        Promise {
            symmetric: [true, false],
            ..Promise::exact_convex(
                Some(bounds.grown(4.0 * f64::EPSILON * self.size())),
                SEGMENT_OPERATIONS,
                self.size(),
            )
        }
    }
}

primitive! {
    ParabolaSegment, parabola_segment, 2,
    about: "What is under a parabolic arch and above its chord.",
    origin: "centred, at half its height; a flat side down",
    parameters: {
        width: Length = "the length of the chord" => |kernel| 2.0 * kernel.half_width,
        height: Length = "the full height",
    },
    marks: |kernel| sets::arch("width", kernel.width(), kernel.height()),
    example: (1.3, 1.7),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, FAR, Patch, Row, over};

    impl Evidence<2> for Parabola {
        const SAMPLE: &'static str = r#"{ "focal_length": 0.01 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Parabola",
            "y = kx² has the `focal_length` 1/4k",
            "exact, convex, unbounded",
        )];

        fn definition(&self) -> Definition<2> {
            let focal = self.focal_length();
            let reach = FAR.min((4.0 * focal * FAR).sqrt());
            over(move |x| x * x / (4.0 * focal), reach, reach / (2.0 * focal))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.0)]
        }
    }

    impl Evidence<2> for ParabolaSegment {
        const SAMPLE: &'static str = r#"{ "width": 0.08, "height": 0.1 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Parabola Segment",
            "`width`, `height`; closed by its chord",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<2> {
            parabola_segment(self.width(), self.height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(1.0, f64::NAN)]
        }
    }

    fn parabola_segment(width: f64, height: f64) -> Definition<2> {
        let half = 0.5 * width;
        let top = move |x: f64| height * (0.5 - (x / half) * (x / half));
        let speed = 2.0 * half.hypot(2.0 * height);
        let ends = [-half, half].map(|x| Vector([x, -0.5 * height]));
        let boundary = vec![
            Patch::segment(ends[0], ends[1]),
            Patch::curve(speed, move |t| {
                let x = half * (2.0 * t - 1.0);
                Vector([x, top(x)])
            }),
        ];
        Definition::new(boundary, move |p| -0.5 * height < p[1] && p[1] < top(p[0]))
    }
}
