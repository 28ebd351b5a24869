// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Planes in space, and the way a picture looks at them.

use crate::error::{PlotError, finite};

/// A plane in space with coordinates `(s, t)` \[m\]: `s` to the right, `t` up in the picture.
///
/// The two axes are orthonormal, so lengths in the picture are lengths in space, and the frame
/// `(right, up, towards the viewer)` is right-handed: no slice shows a mirror image.
///
/// | slice | right | up | seen from |
/// |---|---|---|---|
/// | [`xy`](Self::xy) | +x | +y | +z |
/// | [`xz`](Self::xz) | +x | −z | +y, above |
/// | [`yz`](Self::yz) | +z | +y | −x |
/// | [`free`](Self::free) | `u` | `v` | `u × v` |
/// | [`planar`](Self::planar), for 2D fields | +x | +y | – |
///
/// Where the axis of the picture runs against the axis of space, as z does in [`xz`](Self::xz),
/// the labels follow space: z grows down the page, as on a map that lies on the table.
///
/// # Examples
///
/// ```
/// use palpate_plot::Slice;
///
/// let table = Slice::xz(0.1)?;
/// assert_eq!(table.point([0.3, 0.2]), [0.3, 0.1, -0.2]);
/// assert_eq!(table.project([0.3, 0.7, -0.2]), [0.3, 0.2]);
/// assert!((table.elevation([0.3, 0.7, -0.2]) - 0.6).abs() < 1e-15);
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    origin: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    axes: [SliceAxis; 2],
}

/// How one axis of a slice is labelled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SliceAxis {
    /// Name with unit.
    pub(crate) name: &'static str,
    /// The label is `sign` times the plane coordinate.
    pub(crate) sign: f64,
}

const fn axis(name: &'static str, sign: f64) -> SliceAxis {
    SliceAxis { name, sign }
}

impl Slice {
    /// The plane at height `z` \[m\], seen from +z: x to the right, y up.
    ///
    /// # Errors
    ///
    /// [`PlotError::NotFinite`].
    pub fn xy(z: f64) -> Result<Self, PlotError> {
        Ok(Self {
            origin: [0.0, 0.0, finite("z of an XY slice", z)?],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
            axes: [axis("x [m]", 1.0), axis("y [m]", 1.0)],
        })
    }

    /// The level plane at `y` \[m\], seen from above: x to the right, z down the page.
    ///
    /// # Errors
    ///
    /// [`PlotError::NotFinite`].
    pub fn xz(y: f64) -> Result<Self, PlotError> {
        Ok(Self {
            origin: [0.0, finite("y of an XZ slice", y)?, 0.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 0.0, -1.0],
            axes: [axis("x [m]", 1.0), axis("z [m]", -1.0)],
        })
    }

    /// The plane at `x` \[m\], seen from −x: z to the right, y up.
    ///
    /// # Errors
    ///
    /// [`PlotError::NotFinite`].
    pub fn yz(x: f64) -> Result<Self, PlotError> {
        Ok(Self {
            origin: [finite("x of a YZ slice", x)?, 0.0, 0.0],
            right: [0.0, 0.0, 1.0],
            up: [0.0, 1.0, 0.0],
            axes: [axis("z [m]", 1.0), axis("y [m]", 1.0)],
        })
    }

    /// The plane through `origin` \[m\] along `u` and `v`, seen from `u × v`.
    ///
    /// `u` and `v` need not be of unit length or perpendicular: `u` is scaled to unit length
    /// and points right; the part of `v` perpendicular to it points up.
    ///
    /// # Errors
    ///
    /// [`PlotError::NotFinite`], or [`PlotError::DegeneratePlane`] if the angle between `u` and
    /// `v` is under 1e-6 rad or one of them is zero.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// let diagonal = Slice::free([0.0; 3], [3.0, 0.0, 0.0], [1.0, 2.0, 2.0])?;
    /// let [x, y, z] = diagonal.point([0.5, 2.0]);
    /// assert!((x - 0.5).abs() < 1e-15 && (y - 2.0_f64.sqrt()).abs() < 1e-15 && y == z);
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn free(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Result<Self, PlotError> {
        for x in origin {
            finite("the origin of a plane", x)?;
        }
        for x in u.into_iter().chain(v) {
            finite("a direction of a plane", x)?;
        }
        let degenerate = PlotError::DegeneratePlane { u, v };
        let right = unit(u).ok_or(degenerate.clone())?;
        let v = unit(v).ok_or(degenerate.clone())?;
        let along = dot(v, right);
        let across: [f64; 3] = std::array::from_fn(|i| v[i] - along * right[i]);
        // Both are unit vectors here: the length of `across` is the sine of their angle.
        if dot(across, across).sqrt() < SMALLEST_SINE {
            return Err(degenerate);
        }
        // Subtract once more: the first difference loses digits at small angles.
        let up = unit(across).ok_or(degenerate.clone())?;
        let along = dot(up, right);
        let up = unit(std::array::from_fn(|i| up[i] - along * right[i])).ok_or(degenerate)?;
        Ok(Self { origin, right, up, axes: [axis("s [m]", 1.0), axis("t [m]", 1.0)] })
    }

    /// The plane of a 2D field: plane coordinates are its own `(x, y)`.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// assert_eq!(Slice::planar().point([0.3, 0.2]), [0.3, 0.2, 0.0]);
    /// ```
    #[must_use]
    pub fn planar() -> Self {
        Self {
            origin: [0.0; 3],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
            axes: [axis("x [m]", 1.0), axis("y [m]", 1.0)],
        }
    }

    /// The point of space at plane coordinates `(s, t)`; all in metres.
    #[must_use]
    pub fn point(&self, [s, t]: [f64; 2]) -> [f64; 3] {
        std::array::from_fn(|i| self.origin[i] + s * self.right[i] + t * self.up[i])
    }

    /// Plane coordinates of the point of the plane closest to `point`; all in metres.
    #[must_use]
    pub fn project(&self, point: [f64; 3]) -> [f64; 2] {
        self.project_vector(self.offset(point))
    }

    /// The part of `vector` that lies in the plane: a force \[N\], a normal, a difference \[m\].
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// assert_eq!(Slice::yz(0.0)?.project_vector([5.0, 1.0, 2.0]), [2.0, 1.0]);
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    #[must_use]
    pub fn project_vector(&self, vector: [f64; 3]) -> [f64; 2] {
        [dot(vector, self.right), dot(vector, self.up)]
    }

    /// The parts of `gradient` to the right, up, and towards the viewer.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// assert_eq!(Slice::xz(0.0)?.project_gradient([0.6, 0.8, 0.0]), [0.6, 0.0, 0.8]);
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    #[must_use]
    pub fn project_gradient(&self, gradient: [f64; 3]) -> [f64; 3] {
        self.directions().map(|axis| dot(gradient, axis) + 0.0) // no −0
    }

    /// Where the plane cuts a box \[m\]: the corners of the cut in plane coordinates,
    /// counter-clockwise; none if it misses the box.
    ///
    /// Bit k of a corner's number says on which side of the box's own axis k it is.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// let side = |code: usize, k: usize| f64::from(u8::from(code >> k & 1 == 1));
    /// let corners: [[f64; 3]; 8] =
    ///     std::array::from_fn(|code| [side(code, 0), 2.0 * side(code, 1), side(code, 2)]);
    /// let cut = Slice::xy(0.5)?.cut(corners);
    /// assert_eq!(cut, [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]);
    /// assert!(Slice::xy(1.5)?.cut(corners).is_empty());
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    #[must_use]
    pub fn cut(&self, corners: [[f64; 3]; 8]) -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = Vec::new();
        let edges = (0..8).flat_map(|i: usize| (0..3).map(move |k| (i, i | 1 << k)));
        for (a, b) in edges.filter(|(a, b)| a != b) {
            let [below, above] = [a, b].map(|i| self.elevation(corners[i]));
            if below * above <= 0.0 && below != above {
                let share = below / (below - above);
                let [a, b] = [corners[a], corners[b]];
                let cut = std::array::from_fn(|k| a[k] + share * (b[k] - a[k]));
                let cut = self.project(cut);
                if !points.contains(&cut) {
                    points.push(cut);
                }
            }
        }
        let number = points.len().max(1) as f64;
        let middle = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / number);
        let angle = |p: &[f64; 2]| (p[1] - middle[1]).atan2(p[0] - middle[0]);
        points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        points
    }

    /// Signed distance of `point` from the plane \[m\], positive towards the viewer.
    #[must_use]
    pub fn elevation(&self, point: [f64; 3]) -> f64 {
        dot(self.offset(point), self.normal())
    }

    /// Unit normal of the plane, towards the viewer.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// assert_eq!(Slice::xz(0.0)?.normal(), [0.0, 1.0, 0.0]); // from above
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    #[must_use]
    pub fn normal(&self) -> [f64; 3] {
        let ([a, b, c], [d, e, f]) = (self.right, self.up);
        [b * f - c * e, c * d - a * f, a * e - b * d].map(|x| x + 0.0) // no −0
    }

    /// The unit vectors to the right, up, and towards the viewer.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// let [right, up, towards] = Slice::xz(0.1)?.directions();
    /// assert_eq!((right, up, towards), ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]));
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    #[must_use]
    pub fn directions(&self) -> [[f64; 3]; 3] {
        [self.right, self.up, self.normal()]
    }

    /// Names of the picture's two axes with their unit, as in `["x [m]", "z [m]"]`.
    #[must_use]
    pub fn axis_names(&self) -> [&'static str; 2] {
        self.axes.map(|axis| axis.name)
    }

    pub(crate) fn axes(&self) -> [SliceAxis; 2] {
        self.axes
    }

    /// From the origin of the plane to `point` [m].
    fn offset(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| point[i] - self.origin[i])
    }
}

/// The least sine of the angle between two directions that span a plane [1]: below it, an error
/// of one part in 1e16 would turn the plane by more than 1e-10.
const SMALLEST_SINE: f64 = 1e-6;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `v` at unit length, or `None` if it is zero; safe from overflow and underflow.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 {
        return None;
    }
    let v = v.map(|x| x / largest);
    let length = dot(v, v).sqrt();
    Some(v.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slices() -> Vec<Slice> {
        vec![
            Slice::xy(0.3).unwrap(),
            Slice::xz(-2.0).unwrap(),
            Slice::yz(1e3).unwrap(),
            Slice::planar(),
            Slice::free([1.0, 2.0, 3.0], [1e-9, 2e-9, 0.0], [0.0, 5.0, 1e200]).unwrap(),
            Slice::free([0.0; 3], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0001]).unwrap(),
        ]
    }

    #[test]
    fn maps_there_and_back() {
        for slice in slices() {
            for st in [[0.0, 0.0], [0.25, -3.0], [-1e-6, 1e4]] {
                let back = slice.project(slice.point(st));
                for i in 0..2 {
                    assert!((back[i] - st[i]).abs() < 1e-11 * (1.0 + st[i].abs()), "{slice:?}");
                }
                assert!(slice.elevation(slice.point(st)).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for slice in slices() {
            assert!((dot(slice.right, slice.right) - 1.0).abs() < 1e-15);
            assert!((dot(slice.up, slice.up) - 1.0).abs() < 1e-15);
            assert!(dot(slice.right, slice.up).abs() < 1e-15);
        }
        assert_eq!(Slice::xy(0.0).unwrap().normal(), [0.0, 0.0, 1.0]);
        assert_eq!(Slice::yz(0.0).unwrap().normal(), [-1.0, 0.0, 0.0]);
    }

    #[test]
    fn refuses_planes_that_are_none() {
        let degenerate = [
            ([0.0; 3], [1.0, 0.0, 0.0]),
            ([1.0, 2.0, 3.0], [-2.0, -4.0, -6.0]),
            ([1.0, 0.0, 0.0], [1.0, 1e-7, 0.0]),
        ];
        for (u, v) in degenerate {
            let error = Slice::free([0.0; 3], u, v).unwrap_err();
            assert_eq!(error, PlotError::DegeneratePlane { u, v });
        }
        let error = Slice::xy(f64::NAN).unwrap_err().to_string();
        assert_eq!(error, "z of an XY slice must be finite, got NaN");
        assert!(Slice::free([0.0; 3], [f64::INFINITY, 0.0, 0.0], [0.0, 1.0, 0.0]).is_err());
    }
}
