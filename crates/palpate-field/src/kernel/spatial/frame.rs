// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The frame of a box.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::{Vector, array};

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 6.0;

/// The twelve edges of a box as bars with a square section, within the box. Exact.
///
/// # Derivation
///
/// A point is in a bar if it is in the box and less than the thickness behind at least two of
/// its faces. Folded into the positive octant, the three bars there are boxes, and outside the
/// nearest of them counts. From inside, the exterior is outside the box or in one of three
/// tunnels, one along each axis: the distance is that to a face of the box, or to the rectangle
/// of a tunnel's cross-section.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CuboidFrame};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let crate_of_bars = CuboidFrame::new(Vector([10.0, 8.0, 6.0]), 1.0)?;
/// let frame = Shape::from_kernel(crate_of_bars);
/// assert_eq!(frame.distance(Vector([0.0, 0.0, 0.0])), 13.0_f64.sqrt()); // (3, 2) away
/// assert_eq!(frame.distance(Vector([8.0, 8.0, 0.0])), 5.0); // from an edge: 3-4-5
/// assert_eq!(frame.distance(Vector([4.5, 3.5, 0.0])), -0.5); // in a bar
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CuboidFrame {
    half_extents: [f64; 3],
    thickness: f64,
    /// From the centre to the middle of the bars.
    middle: [f64; 3],
}

impl CuboidFrame {
    /// The frame of a box with the given edge lengths, its bars of `thickness` [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the thickness not less than half the shortest
    /// length.
    pub fn new(size: Vector<f64, 3>, thickness: f64) -> Result<Self, ShapeError> {
        let mut shortest = f64::INFINITY;
        for length in size.0 {
            shortest = shortest.min(0.5 * positive("size", length, Unit::Metre)?);
        }
        positive("thickness", thickness, Unit::Metre)?;
        if thickness >= shortest {
            let rule = format!("less than half the shortest edge, {shortest} m");
            return Err(ShapeError::number("thickness", rule, thickness, Unit::Metre));
        }
        let half_extents = size.0.map(|length| 0.5 * length);
        let middle = half_extents.map(|half| half - 0.5 * thickness);
        Ok(Self { half_extents, thickness, middle })
    }
}

impl Kernel<3> for CuboidFrame {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let zero = S::constant(0.0);
        let p = p.abs().0;
        let faces = array!(i < 3 => p[i] - S::constant(self.half_extents[i]));
        let across = array!(i < 3 => {
            (p[i] - S::constant(self.middle[i])).abs() - S::constant(0.5 * self.thickness)
        });
        let bars = S::orthant([faces[0], across[1], across[2]])
            .min(S::orthant([across[0], faces[1], across[2]]))
            .min(S::orthant([across[0], across[1], faces[2]]));

        let walls = array!(i < 3 => faces[i] + S::constant(self.thickness));
        let tunnels = S::orthant([walls[0], walls[1]])
            .min(S::orthant([walls[1], walls[2]]))
            .min(S::orthant([walls[2], walls[0]]));
        let inside = faces[0].max(faces[1]).max(faces[2]).max(-tunnels);
        S::select_less(bars, zero, inside, bars)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: Vector(self.half_extents).norm() })
    }

    fn promise(&self) -> Promise<3> {
        let half = Vector(self.half_extents);
        let radius = half.norm() * (1.0 + 4.0 * f64::EPSILON);
        Promise::exact(Some(Bounds::centred(half, radius)), OPERATIONS, radius).symmetric()
    }
}

primitive! {
    CuboidFrame, cuboid_frame, 3,
    about: "The twelve edges of a box as square bars.",
    origin: "centred; edges along the axes",
    parameters: {
        size: Vector = "the edge lengths" => |kernel| Vector(kernel.half_extents) * 2.0,
        thickness: Length = "the thickness of the bars, less than half the shortest edge",
    },
    marks: |kernel| {
        let (size, thickness) = (kernel.size(), kernel.thickness());
        let corner = size * 0.5;
        let [from, to] = [corner[0] - thickness, corner[0]].map(|x| at(x, corner[1]));
        let mut marks = Mark::edges(size, 0.0);
        marks.push(Mark::length_between("thickness", from, to).above());
        marks
    },
    example: (Vector([1.4, 1.1, 0.8]), 0.2),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row};
    use crate::vector::Point;

    impl Evidence<3> for CuboidFrame {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.08, 0.06], "thickness": 0.01 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Box Frame", "`size`, `thickness`", "exact")];

        fn definition(&self) -> Definition<3> {
            frame(self.size() * 0.5, self.thickness())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 0.5, 2.0]), 0.25)]
        }
    }

    /// The bars along the edges of a box: in each octant, the four rectangles across each axis that
    /// bound them.
    fn frame(half: Point<3>, thickness: f64) -> Definition<3> {
        let hole = half - Vector([thickness; 3]);
        let mut boundary = Vec::new();
        for octant in 0..8_u8 {
            let sign = move |axis: usize| if octant >> axis & 1 == 1 { 1.0 } else { -1.0 };
            for axis in 0..3 {
                let others = [(axis + 1) % 3, (axis + 2) % 3];
                let mut rectangle = |at: f64, ranges: [[f64; 2]; 2]| {
                    let [[a, b], [c, d]] = ranges;
                    boundary.push(Patch::surface([b - a, d - c], move |u, v| {
                        let mut p = Vector::ZERO;
                        p[axis] = at * sign(axis);
                        p[others[0]] = (a + (b - a) * u) * sign(others[0]);
                        p[others[1]] = (c + (d - c) * v) * sign(others[1]);
                        p
                    }));
                };
                let [i, j] = others;
                // The face of the box, without its window.
                rectangle(half[axis], [[hole[i], half[i]], [0.0, half[j]]]);
                rectangle(half[axis], [[0.0, hole[i]], [hole[j], half[j]]]);
                // Behind it, the faces of the bars that are visible through another window.
                rectangle(hole[axis], [[hole[i], half[i]], [0.0, hole[j]]]);
                rectangle(hole[axis], [[0.0, hole[i]], [hole[j], half[j]]]);
            }
        }
        Definition::new(boundary, move |p| {
            let in_box = (0..3).all(|i| p[i].abs() < half[i]);
            in_box && (0..3).filter(|i| p[*i].abs() > hole[*i]).count() >= 2
        })
    }
}
