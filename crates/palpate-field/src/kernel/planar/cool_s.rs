// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The Cool S.

use super::line::Edge;
use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::Mark;
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 24.0;

/// The S that every pupil draws: fourteen strokes, two fifths as wide as high.
/// Exact.
///
/// Inside its outline, the strokes are part of the surface: the distance is
/// that to the nearest stroke, negative inside the outline.
///
/// # Derivation
///
/// In units of half the height, folded to `x, y ≥ 0`, the outline has the edges
/// (0, 1)–(0.4, 0.6)–(0.4, 0.2)–(0.2, 0); there is a stroke down the middle from
/// 0.6 to 0.2. The strokes that cross are not mirror images but half turns of
/// each other: one runs from (0, 0.2) to (0.2, 0), in x times the sign of y.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CoolS};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let s = Shape::from_kernel(CoolS::new(2.0)?);
/// assert!((s.distance(Vector([0.0, 1.5])) - 0.5).abs() < 1e-15); // above the tip
/// assert!((s.distance(Vector([0.2, 0.4])) + 0.2).abs() < 1e-15); // in a stripe
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CoolS {
    half_height: f64,
    roof: Edge,
    side: Edge,
    waist: Edge,
    middle: Edge,
    crossing: Edge,
}

impl CoolS {
    /// A Cool S of full `height` [m].
    ///
    /// # Errors
    ///
    /// If the height is not positive.
    pub fn new(height: f64) -> Result<Self, ShapeError> {
        let half_height = 0.5 * positive("height", height, Unit::Metre)?;
        // Counter-clockwise around the outline: outside is to the right.
        let edge = |from: [f64; 2], to: [f64; 2]| {
            Edge::new(Vector(from) * half_height, Vector(to) * half_height)
        };
        Ok(Self {
            half_height,
            roof: edge([0.4, 0.6], [0.0, 1.0]),
            side: edge([0.4, 0.2], [0.4, 0.6]),
            waist: edge([0.2, 0.0], [0.4, 0.2]),
            middle: edge([0.0, 0.2], [0.0, 0.6]),
            crossing: edge([0.2, 0.0], [0.0, 0.2]),
        })
    }
}

impl Kernel<2> for CoolS {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let folded = p.abs();
        let turned = S::select_less(p.0[1], zero, -p.0[0], p.0[0]);
        // The nearest edge of the outline also decides the sign.
        let nearer = |a: S, b: S| S::select_less(b.abs(), a.abs(), b, a);
        let outline = nearer(
            nearer(self.side.signed_distance(folded), self.roof.signed_distance(folded)),
            self.waist.signed_distance(folded),
        );
        // Near the waist the crossing stroke of the other half may be nearer.
        let here = self.crossing.distance(Vector([turned, folded.0[1]]));
        let there = self.crossing.distance(Vector([-turned, -folded.0[1]]));
        let strokes = self.middle.distance(folded).min(here).min(there);
        // Inside, the larger of two negative distances is the nearer stroke; outside, no stroke
        // is nearer than the outline.
        S::select_less(outline, zero, outline.max(-strokes), outline)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.half_height })
    }

    fn promise(&self) -> Promise<2> {
        let half = Vector([0.4, 1.0]) * self.half_height;
        let bounds = Bounds::centred(half, self.half_height);
        Promise::exact(Some(bounds), OPERATIONS, self.half_height)
    }
}

primitive! {
    CoolS, cool_s, 2,
    about: "The S that every pupil draws, two fifths as wide as high.",
    origin: "centred; a tip up, a tip down",
    parameters: {
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_height,
    },
    marks: |kernel| vec![Mark::height(kernel.height(), 0.0, 0.0)],
    example: (1.8),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, even_odd};

    impl Evidence<2> for CoolS {
        const SAMPLE: &'static str = r#"{ "height": 0.1 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Cool S", "`height`", "exact")];

        fn definition(&self) -> Definition<2> {
            cool_s(self.height())
        }
    }

    /// The fourteen strokes of the Cool S, two units high, as drawn on paper: three lines above,
    /// three below, each joined to the next, and roofs.
    fn cool_s(height: f64) -> Definition<2> {
        let at = |x: f64, y: f64| Vector([x, y]) * (0.5 * height);
        let columns = [-0.4, 0.0, 0.4];
        let mut strokes = Vec::new();
        for x in columns {
            strokes.push((at(x, 0.2), at(x, 0.6)));
            strokes.push((at(x, -0.2), at(x, -0.6)));
        }
        for side in [1.0, -1.0] {
            for x in [-0.4, 0.4] {
                strokes.push((at(x, 0.6 * side), at(0.0, side)));
            }
        }
        strokes.push((at(-0.4, 0.2), at(0.0, -0.2)));
        strokes.push((at(0.0, 0.2), at(0.4, -0.2)));
        // The visible parts of the two strokes that pass behind.
        strokes.push((at(0.4, 0.2), at(0.2, 0.0)));
        strokes.push((at(-0.4, -0.2), at(-0.2, 0.0)));
        let outline = [
            (0.0, 1.0),
            (0.4, 0.6),
            (0.4, 0.2),
            (0.2, 0.0),
            (0.4, -0.2),
            (0.4, -0.6),
            (0.0, -1.0),
            (-0.4, -0.6),
            (-0.4, -0.2),
            (-0.2, 0.0),
            (-0.4, 0.2),
            (-0.4, 0.6),
        ];
        let outline = vec![outline.map(|(x, y)| at(x, y)).to_vec()];
        let boundary = strokes.into_iter().map(|(a, b)| Patch::segment(a, b)).collect();
        Definition::new(boundary, move |p| even_odd(&outline, p))
    }
}
