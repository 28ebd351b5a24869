// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Stairs.

use super::line::Edge;
use super::sides::{Side, model_by_sides, or_constant};
use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector};

/// The most steps.
const MOST_STEPS: u32 = 256;

/// Halvings that find one of [`MOST_STEPS`] steps.
const HALVINGS: usize = 8;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 6.0;

/// How far the ends of an edge, and with it a model by edges, may be off, in roundings of the
/// largest number: a few for each coordinate, and those of the distance.
const OFF: f64 = 16.0;

/// A solid staircase that rises to the right, centred at the origin. Exact.
///
/// # Derivation
///
/// From its lower left corner, step `k` has a riser at `x = kw` and a tread at `y = (k + 1)h`.
/// Lines perpendicular to the slope through the inner corners divide the plane into a strip for
/// each step, which holds its riser and tread and no other part of the stairs.
///
/// Inside, the nearest point of the stairs is in the strip of the evaluated point. A tread `m`
/// steps on, which is `u` to the right of the strip's upper inner corner and `mh + v` above the
/// evaluated point, with `v ≥ uw/h` and `u ≤ mw`, has the squared distance
/// `(mh + v)² ≥ 2u² + v²`, more than the inner corner's `u² + v²`. For risers the axes are
/// exchanged.
///
/// Outside, the same holds for strips through the outer corners, each with a tread and the
/// riser after it. In terms of the strips through the inner corners, the riser and tread of the
/// point's own strip, the tread before it and the riser after it suffice.
///
/// The strip is found by halving.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Stairs};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // From (−6, −3) to (6, 3).
/// let flight = Shape::from_kernel(Stairs::new(4.0, 2.0, 3)?);
/// assert_eq!(flight.distance(Vector([-1.0, 1.5])), 0.5); // above the second tread
/// assert_eq!(flight.distance(Vector([1.5, 2.0])), 0.5); // before the third riser
/// assert_eq!(flight.distance(Vector([-1.0, 0.0])), -1.0);
/// assert_eq!(flight.distance(Vector([9.0, 7.0])), 5.0); // past the top
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Stairs {
    step: [f64; 2],
    half_extents: [f64; 2],
    /// The vector of a step over its square; the product of a point with it counts steps.
    count: [f64; 2],
    steps: u32,
    /// By how many steps a halving moves; zero when done.
    halvings: [f64; HALVINGS],
}

impl Stairs {
    /// So many `steps`, each `step_width` deep and `step_height` high [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, the whole longer than 1e15 m, or there are not 1
    /// to 256 steps.
    pub fn new(step_width: f64, step_height: f64, steps: u32) -> Result<Self, ShapeError> {
        let step = [
            positive("step_width", step_width, Unit::Metre)?,
            positive("step_height", step_height, Unit::Metre)?,
        ];
        if !(1..=MOST_STEPS).contains(&steps) {
            let rule = format!("from 1 to {MOST_STEPS}");
            return Err(ShapeError::number("steps", rule, f64::from(steps), Unit::One));
        }
        let [w, h] = step;
        let half_extents = step.map(|length| 0.5 * length * f64::from(steps));
        positive("step_width times steps", 2.0 * half_extents[0], Unit::Metre)?;
        positive("step_height times steps", 2.0 * half_extents[1], Unit::Metre)?;
        // Divided by the larger first, so that no square overflows.
        let larger = w.max(h);
        let square = larger * ((w / larger) * (w / larger) + (h / larger) * (h / larger));
        let count = [w / larger / square, h / larger / square];
        let mut left = steps;
        let halvings = std::array::from_fn(|_| {
            let half = if left > 1 { left.div_ceil(2) } else { 0 };
            left = half.max(1);
            f64::from(half)
        });
        Ok(Self { step, half_extents, count, steps, halvings })
    }

    fn size(&self) -> f64 {
        self.half_extents[0].hypot(self.half_extents[1])
    }

    /// The edges nearer to a point than `reach` [m], and perhaps some more.
    fn near(&self, p: Point<2>, reach: f64) -> impl Iterator<Item = Side> {
        let [w, h] = self.step;
        let [x, y] = self.half_extents;
        let place = move |column: u32, row: u32| {
            Vector([f64::from(column) * w - x, f64::from(row) * h - y])
        };
        // Of the steps whose boxes reach so far, along either axis; one more on each side, for
        // the roundings. A number below zero becomes zero.
        let [[first, last], rows] = [[p[0] + x, w], [p[1] + y, h]]
            .map(|[q, step]| [(q - reach) / step - 2.0, (q + reach) / step + 2.0]);
        let first = first.max(rows[0]) as u32;
        let end = (last.min(rows[1]) as u32).min(self.steps);
        let steps = (first..end).flat_map(move |k| {
            let [low, corner, high] = [place(k, k), place(k, k + 1), place(k + 1, k + 1)];
            [Edge::new(low, corner), Edge::new(corner, high)]
        });
        let foot = Vector([x, -y]);
        let ends = [Edge::new(foot, Vector([x, y])), Edge::new(Vector([-x, -y]), foot)];
        let is_near = move |edge: &Edge| {
            let [across, past] = edge.offsets(p);
            across.abs() <= reach && past <= reach
        };
        let near = steps.chain(ends).filter(is_near);
        near.map(|edge| Side { edge, off: 0.0 })
    }

    /// How many steps are before the strip that holds `q`, which is measured from
    /// the lower left corner.
    #[inline(always)]
    fn steps_before<S: Scalar>(&self, q: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        // Half a step before the end is in the last strip.
        let last = f64::from(self.steps) - 0.5;
        let mut rest = q.dot_constant(&self.count).clamp(0.0, last);
        let mut before = zero;
        for halving in self.halvings {
            let half = S::constant(halving);
            let taken = S::select_less(rest, half, zero, half);
            rest = rest - taken;
            before = before + taken;
        }
        before
    }
}

/// The distance to an edge from the offset from its line and the place along it from
/// its middle.
#[inline(always)]
fn to_edge<S: Scalar>(out: S, along: S, half_length: f64) -> S {
    let past = along.abs() - S::constant(half_length);
    S::norm([out, past.max(S::constant(0.0))])
}

impl Kernel<2> for Stairs {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let [w, h] = self.step;
        let [half_width, half_height] = self.half_extents;
        let q = p + Vector::of(&self.half_extents);
        let before = self.steps_before(q);
        // From the middle of the step's box.
        let x = q.0[0] - before.scale(w) - S::constant(0.5 * w);
        let y = q.0[1] - before.scale(h) - S::constant(0.5 * h);
        let (half_w, half_h) = (S::constant(0.5 * w), S::constant(0.5 * h));
        // Offsets out of the solid.
        let (riser, tread) = (-x - half_w, y - half_h);
        let (wall, floor) = (p.0[0] - S::constant(half_width), -q.0[1]);
        let sides = riser.max(tread).max(wall).max(floor);

        let own = to_edge(riser, y, 0.5 * h).min(to_edge(tread, x, 0.5 * w));
        let tread_before = to_edge(y + half_h, x + S::constant(w), 0.5 * w);
        let riser_after = to_edge(half_w - x, y - S::constant(h), 0.5 * h);
        let is_first = S::select_less(before, S::constant(0.5), own, tread_before);
        let last = S::constant(f64::from(self.steps) - 1.5);
        let is_last = S::select_less(last, before, own, riser_after);
        let ends = to_edge(wall, p.0[1], half_height).min(to_edge(floor, p.0[0], half_width));
        let nearest = own.min(is_first).min(is_last).min(ends);
        S::select_less(sides, zero, -nearest, nearest)
    }

    const HAS_OWN_MODEL: bool = true;

    /// By the edges near the cell: the formula chooses a strip, of which a cell may hold many.
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        let centre = Vector(cell.0.map(|x| x.value));
        let radius = AffineModel::radius(&cell.0);
        let far = f64::EPSILON * (self.size() + centre.norm() + radius);
        let value = self.distance(centre);
        let constant = AffineModel::lipschitz(value, 1.0, &cell.0, OPERATIONS * far);
        let error = OFF * far;
        // On an edge, the value does not say which side of it is inside.
        if value.abs() <= error {
            return constant;
        }
        let radius = radius + error;
        let near = self.near(centre, value.abs() + 2.0 * radius);
        or_constant(model_by_sides(cell, value, radius, near), constant, error)
    }

    fn promise(&self) -> Promise<2> {
        let radius = self.size() * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(Vector(self.half_extents), radius);
        Promise::exact(Some(bounds), OPERATIONS, radius)
    }
}

primitive! {
    Stairs, stairs, 2,
    about: "A solid staircase that rises to the right.",
    origin: "centred; rising to the right",
    parameters: {
        step_width: Length = "the depth of a step" => |kernel| kernel.step[0],
        step_height: Length = "the height of a step" => |kernel| kernel.step[1],
        steps: Count = "how many steps, 1 to 256",
    },
    marks: |kernel| {
        let [width, height] = kernel.step;
        let [x, y] = kernel.half_extents;
        vec![
            Mark::length_between("step_width", at(x - width, y), at(x, y)).above(),
            Mark::length_between("step_height", at(-x, -y), at(-x, height - y)).left(),
        ]
    },
    example: (0.42, 0.3, 4),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, polygon};

    impl Evidence<2> for Stairs {
        const SAMPLE: &'static str =
            r#"{ "step_width": 0.025, "step_height": 0.02, "steps": 4 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Stairs", "`step_width`, `step_height`, `steps`", "exact")];

        fn definition(&self) -> Definition<2> {
            stairs(self.step_width(), self.step_height(), self.steps() as usize)
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(0.25, 0.125, 0),
                Self::new(0.25, 0.125, 1000),
                Self::new(1e14, 0.125, 100),
            ]
        }
    }

    fn stairs(w: f64, h: f64, steps: usize) -> Definition<2> {
        let n = steps as f64;
        let at = |x: f64, y: f64| Vector([(x - 0.5 * n) * w, (y - 0.5 * n) * h]);
        let mut ring = vec![at(0.0, 0.0), at(n, 0.0), at(n, n)];
        for k in (0..steps).rev() {
            let k = k as f64;
            ring.push(at(k, k + 1.0));
            if k > 0.0 {
                ring.push(at(k, k));
            }
        }
        polygon(vec![ring])
    }
}
