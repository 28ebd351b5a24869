// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Slices of space, and their samples.

use crate::error::{PlotError, finite};
use crate::geometry::Point;

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

    /// The parallel plane through `point` \[m\], with the same coordinates: those of what lies
    /// one behind the other are the same.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Slice;
    ///
    /// let behind = Slice::xy(0.0)?.parallel([0.5, 0.2, -0.3]);
    /// assert_eq!(behind.point([0.1, 0.1]), [0.1, 0.1, -0.3]);
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    #[must_use]
    pub fn parallel(&self, point: [f64; 3]) -> Self {
        let (normal, elevation) = (self.normal(), self.elevation(point));
        let origin = std::array::from_fn(|k| self.origin[k] + elevation * normal[k]);
        Self { origin, ..self.clone() }
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

/// Shortest side of a window [m]. Below a nanometre there is nothing to touch.
pub(crate) const MIN_SIZE: f64 = 1e-9;
/// Longest side of a window [m].
pub(crate) const MAX_SIZE: f64 = 1e9;
/// Largest ratio of the sides: a sliver has no room for its labels.
pub(crate) const MAX_ASPECT: f64 = 20.0;
/// Largest ratio of a window's distance from the origin to its size: neighbours of 400 cells
/// then still differ by thousands of roundings.
const MAX_DISTANCE: f64 = 1e9;

/// A window of a [`Slice`]: centre, width and height in plane coordinates \[m\].
///
/// # Examples
///
/// ```
/// use palpate_plot::PlaneView;
///
/// let view = PlaneView::new([0.1, 0.0], 0.4, 0.3)?;
/// assert_eq!((view.min(), view.max()), ([-0.1, -0.15], [0.30000000000000004, 0.15]));
///
/// let error = PlaneView::new([0.0, 0.0], -0.2, 0.3).unwrap_err();
/// assert_eq!(error.to_string(), "view width must be between 1e-9 m and 1e9 m, got -0.2 m");
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneView {
    center: [f64; 2],
    size: [f64; 2],
}

impl PlaneView {
    /// The window of `width` by `height` \[m\] around `center`.
    ///
    /// # Errors
    ///
    /// [`PlotError::NotFinite`] for the centre, [`PlotError::ViewSize`] for a side outside
    /// 1e-9 m to 1e9 m, [`PlotError::ViewAspect`] for sides that differ more than 20 times,
    /// [`PlotError::ViewFar`] for a centre over 1e9 times the shorter side away.
    pub fn new(center: [f64; 2], width: f64, height: f64) -> Result<Self, PlotError> {
        for x in center {
            finite("the centre of a view", x)?;
        }
        for (side, size) in [("width", width), ("height", height)] {
            if !(MIN_SIZE..=MAX_SIZE).contains(&size) {
                return Err(PlotError::ViewSize { side, size });
            }
        }
        let shorter = width.min(height);
        if width.max(height) > MAX_ASPECT * shorter {
            return Err(PlotError::ViewAspect { width, height });
        }
        if center.iter().any(|x| x.abs() > MAX_DISTANCE * shorter) {
            return Err(PlotError::ViewFar { center, size: shorter });
        }
        Ok(Self { center, size: [width, height] })
    }

    /// The window around the box from `min` to `max` in plane coordinates \[m\], with `margin`
    /// times its longer side added on each side.
    ///
    /// A flat box is widened to a quarter of its length.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), of the window with its margin. A box whose `max` is below its
    /// `min`, or a single point, is [`PlotError::ViewSize`].
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::PlaneView;
    ///
    /// let view = PlaneView::from_bounds([0.0, 0.0], [2.0, 1.0], 0.25)?;
    /// assert_eq!((view.center(), view.width(), view.height()), ([1.0, 0.5], 3.0, 2.0));
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn from_bounds(min: [f64; 2], max: [f64; 2], margin: f64) -> Result<Self, PlotError> {
        let [width, height] = [max[0] - min[0], max[1] - min[1]];
        let longer = width.max(height);
        let side = |size: f64| {
            if size >= 0.0 { size.max(longer / 4.0) + 2.0 * margin * longer } else { size }
        };
        let center = [0, 1].map(|i| min[i] / 2.0 + max[i] / 2.0);
        Self::new(center, side(width), side(height))
    }

    /// The window of `slice` that shows the projection of the box from `min` to `max` in space
    /// \[m\], with `margin` times its longer side added on each side.
    ///
    /// # Errors
    ///
    /// As [`from_bounds`](Self::from_bounds).
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::{Slice, PlaneView};
    ///
    /// let view = PlaneView::of_box(&Slice::xz(0.0)?, [0.0; 3], [2.0, 9.0, 1.0], 0.0)?;
    /// assert_eq!(view.center(), [1.0, -0.5]); // seen from above, z runs down the page
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn of_box(
        slice: &Slice,
        min: [f64; 3],
        max: [f64; 3],
        margin: f64,
    ) -> Result<Self, PlotError> {
        for x in min.into_iter().chain(max) {
            finite("a corner of a box", x)?;
        }
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for corner in 0..8 {
            let at = |i: usize| if corner >> i & 1 == 0 { min[i] } else { max[i] };
            let p = slice.project([at(0), at(1), at(2)]);
            for i in 0..2 {
                low[i] = low[i].min(p[i]);
                high[i] = high[i].max(p[i]);
            }
        }
        Self::from_bounds(low, high, margin)
    }

    /// Centre, in plane coordinates \[m\].
    #[must_use]
    pub fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Width \[m\].
    #[must_use]
    pub fn width(&self) -> f64 {
        self.size[0]
    }

    /// Height \[m\].
    #[must_use]
    pub fn height(&self) -> f64 {
        self.size[1]
    }

    /// Lower left corner, in plane coordinates \[m\].
    #[must_use]
    pub fn min(&self) -> [f64; 2] {
        [0, 1].map(|i| self.center[i] - self.size[i] / 2.0)
    }

    /// Upper right corner, in plane coordinates \[m\].
    #[must_use]
    pub fn max(&self) -> [f64; 2] {
        [0, 1].map(|i| self.center[i] + self.size[i] / 2.0)
    }
}

/// How finely a field is sampled for a picture.
///
/// # Examples
///
/// ```
/// use palpate_plot::Sampling;
///
/// let fine = Sampling::new(1200)?;
/// let error = Sampling::new(2).unwrap_err().to_string();
/// assert_eq!(error, "a picture is sampled with 8 to 4096 cells a side, got 2");
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    cells: usize,
}

impl Sampling {
    /// Fewest cells: what a golden test can print.
    const MIN: usize = 8;
    /// Most cells: 16 million samples.
    const MAX: usize = 4096;

    /// Samples with `cells` cells along the longer side of the window.
    ///
    /// # Errors
    ///
    /// [`PlotError::Cells`] outside 8 to 4096.
    pub fn new(cells: usize) -> Result<Self, PlotError> {
        if (Self::MIN..=Self::MAX).contains(&cells) {
            Ok(Self { cells })
        } else {
            Err(PlotError::Cells { cells, min: Self::MIN, max: Self::MAX })
        }
    }
}

impl Sampling {
    /// Cells along the longer side.
    pub(crate) fn cells(self) -> usize {
        self.cells
    }
}

impl Default for Sampling {
    /// 420 cells: two pixels each at 800 px, and isolines off by well under one.
    fn default() -> Self {
        Self { cells: 420 }
    }
}

/// Values at the centres of square cells that cover a window and one cell around it.
#[derive(Debug, Clone)]
pub(crate) struct Samples {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Edge of a cell [m].
    pub(crate) cell: f64,
    /// Lower left corner of the grid, a cell outside the window [m].
    pub(crate) origin: Point,
    /// Row by row from the bottom, left to right [m].
    pub(crate) values: Vec<f64>,
}

impl Samples {
    /// Samples `field`, row by row.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is not a length.
    pub(crate) fn new(
        view: &PlaneView,
        sampling: Sampling,
        mut field: impl FnMut(&[[f64; 2]], &mut [f64]),
    ) -> Result<Self, PlotError> {
        let cell = view.width().max(view.height()) / sampling.cells as f64;
        // At least the window, and a border whose contours are clipped away.
        let count = |size: f64| (size / cell - 1e-6).ceil().max(1.0) as usize + 2;
        let (columns, rows) = (count(view.width()), count(view.height()));
        let origin = view.min().map(|x| x - cell);
        let mut values = vec![0.0; columns * rows];
        let mut points = vec![[0.0; 2]; columns];
        for (row, out) in values.chunks_exact_mut(columns).enumerate() {
            for (column, p) in points.iter_mut().enumerate() {
                *p = [
                    origin[0] + (column as f64 + 0.5) * cell,
                    origin[1] + (row as f64 + 0.5) * cell,
                ];
            }
            field(&points, out);
            for (&at, &value) in points.iter().zip(&*out) {
                PlotError::check_sample(at, value)?;
            }
        }
        Ok(Self { columns, rows, cell, origin, values })
    }

    /// The samples of the field with the other sign.
    pub(crate) fn negated(&self) -> Self {
        Self { values: self.values.iter().map(|value| -value).collect(), ..*self }
    }

    /// Whether the field is nowhere negative, but zero somewhere as far as samples can tell.
    ///
    /// Where a distance is zero, the nearest sample is at most half a cell's diagonal away.
    pub(crate) fn has_thin_surface(&self) -> bool {
        let low = self.range().0;
        low >= 0.0 && low <= std::f64::consts::FRAC_1_SQRT_2 * self.cell
    }

    /// Smallest and largest value [m].
    pub(crate) fn range(&self) -> (f64, f64) {
        self.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| {
            (low.min(v), high.max(v))
        })
    }
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

#[cfg(test)]
mod view_tests {
    use super::*;

    #[test]
    fn refuses_windows_without_extent() {
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-10, 1e10] {
            assert!(PlaneView::new([0.0; 2], size, 1.0).is_err(), "{size}");
            assert!(PlaneView::new([0.0; 2], 1.0, size).is_err(), "{size}");
        }
        assert!(PlaneView::new([f64::NAN, 0.0], 1.0, 1.0).is_err());
        assert!(PlaneView::new([1e12, 0.0], 1.0, 1.0).is_err());
        assert!(PlaneView::new([0.0; 2], 1.0, 30.0).is_err());
        assert!(PlaneView::from_bounds([1.0; 2], [0.0; 2], 0.1).is_err());
        assert!(PlaneView::from_bounds([1.0; 2], [1.0; 2], 0.1).is_err());
    }

    #[test]
    fn widens_flat_boxes() {
        let view = PlaneView::from_bounds([0.0, 1.0], [2.0, 1.0], 0.0).unwrap();
        assert_eq!((view.width(), view.height()), (2.0, 0.5));
    }
}

#[cfg(test)]
mod sampling_tests {
    use super::*;

    #[test]
    fn cells_cover_the_window() {
        let view = PlaneView::new([1.0, 2.0], 0.4, 0.3).unwrap();
        let samples = Samples::new(&view, Sampling::new(40).unwrap(), |points, out| {
            for (p, v) in points.iter().zip(out) {
                *v = p[0] + 100.0 * p[1];
            }
        })
        .unwrap();
        assert_eq!((samples.columns, samples.rows), (42, 32));
        let first = 0.795 + 100.0 * 1.845;
        assert!((samples.values[0] - first).abs() < 1e-12);
        assert!((samples.range().1 - (1.205 + 100.0 * 2.155)).abs() < 1e-9);
    }

    #[test]
    fn names_the_place_of_a_bad_sample() {
        let view = PlaneView::new([0.0, 0.0], 8.0, 8.0).unwrap();
        let sampling = Sampling::new(8).unwrap();
        let error = Samples::new(&view, sampling, |points, out| {
            for (p, v) in points.iter().zip(out) {
                *v = if p[0] > 2.0 && p[1] > 1.0 { f64::NAN } else { 0.0 };
            }
        })
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "the field is NaN at (2.5, 1.5) m of the plane; it must be finite"
        );
        for value in [f64::INFINITY, -1e200] {
            assert!(Samples::new(&view, sampling, |_, out| out.fill(value)).is_err());
        }
    }
}
