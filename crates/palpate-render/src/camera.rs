// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a picture is seen from. The y axis points up.

use std::f64::consts::{FRAC_PI_2, PI};

use palpate_field::{Aabb, Point, Rotation, Vector};
use palpate_query::QueryError;

use crate::beam::{Beam, COVER};
use crate::render::RenderError;

/// Room around what a camera fits into a picture, as a share of the picture's sides.
const MARGIN: f64 = 0.06;

/// The direction of sight, as the frame of the picture: unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    right: Vector<f64, 3>,
    up: Vector<f64, 3>,
    back: Vector<f64, 3>,
}

impl Sight {
    /// Towards the origin from `azimuth`, the angle about y from z towards x, and from
    /// `elevation` above the plane of x and z [rad].
    ///
    /// ```
    /// use palpate_render::Sight;
    ///
    /// let front = Sight::from_angles(0.0, 0.0)?;
    /// assert_eq!(front.back().0, [0.0, 0.0, 1.0]);
    /// # Ok::<(), palpate_render::RenderError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the azimuth is not finite, or the elevation not between −π/2 and π/2.
    pub fn from_angles(azimuth: f64, elevation: f64) -> Result<Self, RenderError> {
        let wrong = |what, rule, value| RenderError::Number { what, rule, value, unit: " rad" };
        if !azimuth.is_finite() {
            return Err(wrong("azimuth", "finite", azimuth));
        }
        if elevation.is_nan() || elevation.abs() > FRAC_PI_2 {
            return Err(wrong("elevation", "from -pi/2 to pi/2", elevation));
        }
        let (sin_a, cos_a) = (libm::sin(azimuth), libm::cos(azimuth));
        let (sin_e, cos_e) = (libm::sin(elevation), libm::cos(elevation));
        Ok(Self {
            right: Vector([cos_a, 0.0, -sin_a]),
            up: Vector([-sin_e * sin_a, cos_e, -sin_e * cos_a]),
            back: Vector([cos_e * sin_a, sin_e, cos_e * cos_a]),
        })
    }

    /// From one point towards another, with y up; along y, with −z up.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15, or the points are equal.
    pub fn between(from: Point<3>, at: Point<3>) -> Result<Self, RenderError> {
        QueryError::check_point("the camera", from)?;
        QueryError::check_point("what the camera looks at", at)?;
        let back = (from - at).normalized().ok_or(RenderError::NoSight { at: at.0 })?;
        let right = Vector::unit(1).cross(back).normalized().unwrap_or(Vector::unit(0));
        Ok(Self { right, up: back.cross(right), back })
    }

    /// Perpendicular to the plane of `right` and `up`, which may have any length; of `up`, the part
    /// across `right` counts.
    ///
    /// ```
    /// use palpate_render::Sight;
    ///
    /// let sight = Sight::onto_plane([2.0, 0.0, 0.0], [1.0, 1.0, 0.0])?;
    /// assert_eq!(sight, Sight::from_angles(0.0, 0.0)?);
    /// # Ok::<(), palpate_render::RenderError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a direction has no length, or both lie on one line.
    pub fn onto_plane(
        right: impl Into<Vector<f64, 3>>,
        up: impl Into<Vector<f64, 3>>,
    ) -> Result<Self, RenderError> {
        let (right, up) = (right.into(), up.into());
        let wrong = |what, got: Vector<f64, 3>| RenderError::NoPlane { what, got: got.0 };
        let right = right.normalized().ok_or(wrong("the right of a camera", right))?;
        let back = up.normalized().and_then(|up| right.cross(up).normalized());
        let back = back.ok_or(wrong("the up of a camera, across its right,", up))?;
        Ok(Self { right, up: back.cross(right), back })
    }

    /// The unit vector towards the viewer.
    #[must_use]
    pub fn back(&self) -> Vector<f64, 3> {
        self.back
    }

    pub(crate) fn right(&self) -> Vector<f64, 3> {
        self.right
    }

    pub(crate) fn up(&self) -> Vector<f64, 3> {
        self.up
    }

    /// The parts of a vector to the right, up and towards the viewer.
    fn parts(&self, v: Vector<f64, 3>) -> [f64; 3] {
        [self.right, self.up, self.back].map(|axis| v.dot(axis))
    }
}

/// How a camera shows depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// What is nearer is larger. The field of view is the angle that the picture's height
    /// spans [rad].
    Perspective(f64),
    /// All is as large, wherever it is.
    Orthographic,
}

impl Lens {
    /// As a reader holds a small thing before the eyes: 28°.
    pub const USUAL: Self = Self::Perspective(28.0 / 180.0 * PI);
}

/// A camera: an eye, a direction of sight and a lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Point<3>,
    sight: Sight,
    /// The height of what the picture shows: over its distance from the eye, or, if
    /// `is_parallel`, itself [m].
    height: f64,
    is_parallel: bool,
    /// The distance of what is looked at from the eye [m].
    distance: f64,
    /// Where the line of sight is in the picture: from its upper edge, as a share of its height.
    middle: f64,
}

/// The line of sight in the middle of the picture.
const MIDDLE: f64 = 0.5;

impl Camera {
    /// From `eye` towards `at`. With an orthographic lens the picture shows, at `at`, as much as
    /// one with the [usual](Lens::USUAL) field of view.
    ///
    /// # Errors
    ///
    /// As [`Sight::between`]; if the field of view is not between 0 and π.
    pub fn looking(eye: Point<3>, at: Point<3>, lens: Lens) -> Result<Self, RenderError> {
        let sight = Sight::between(eye, at)?;
        let distance = (eye - at).norm();
        let (slope, is_parallel) = (slope(lens)?, lens == Lens::Orthographic);
        let height = 2.0 * slope * if is_parallel { distance } else { 1.0 };
        Ok(Self { eye, sight, height, is_parallel, distance, middle: MIDDLE })
    }

    /// In the direction of `sight`, as near as the picture shows all of `points` with a margin.
    /// The picture is `aspect` times as wide as high.
    ///
    /// # Derivation
    ///
    /// Seen from the frame of sight, the point (x, y, z) is in the picture of an eye at
    /// (a, b, D) if `|x − a| ≤ k (D − z)`, k being half the width over the distance. So D is at
    /// least `z ± (x − a)/k` of every point; the least D is half the sum of the largest
    /// `z + x/k` and the largest `z − x/k`, and a is half of k times their difference. The
    /// height gives another D, and the larger one holds.
    ///
    /// # Errors
    ///
    /// If there is no point, or one is not finite or beyond 1e15; if the aspect is not positive;
    /// if the field of view is not between 0 and π.
    pub fn fitting(
        points: &[Point<3>],
        sight: Sight,
        lens: Lens,
        aspect: f64,
    ) -> Result<Self, RenderError> {
        RenderError::check_positive("the aspect of a picture", aspect, "")?;
        for point in points {
            QueryError::check_point("what the camera shows", *point)?;
        }
        let box_of = Aabb::around(points.iter().map(|p| Vector(sight.parts(*p))));
        let seen = box_of.ok_or(RenderError::NoBody)?;
        let slope = slope(lens)?;
        let within = 1.0 - 2.0 * MARGIN;
        let (middle, half) = (seen.centre(), seen.half_extents());
        let in_world = |[x, y, z]: [f64; 3]| sight.right * x + sight.up * y + sight.back * z;
        if lens == Lens::Orthographic {
            let shown = 2.0 * half[1].max(half[0] / aspect).max(f64::MIN_POSITIVE) / within;
            let distance = 2.0 * half[2] + shown;
            let eye = in_world([middle[0], middle[1], middle[2] + distance]);
            let (height, is_parallel) = (shown, true);
            return Ok(Self { eye, sight, height, is_parallel, distance, middle: MIDDLE });
        }
        let along = |axis: usize, k: f64| {
            let largest = |sign: f64| {
                let reach = |p: &Point<3>| {
                    let p = sight.parts(*p);
                    p[2] + sign * p[axis] / k
                };
                points.iter().map(reach).fold(f64::NEG_INFINITY, f64::max)
            };
            let (plus, minus) = (largest(1.0), largest(-1.0));
            (0.5 * k * (plus - minus), 0.5 * (plus + minus))
        };
        let (x, wide) = along(0, slope * aspect * within);
        let (y, high) = along(1, slope * within);
        // A point, or points on a line of sight, are seen from a metre.
        let depth = wide.max(high);
        let depth = if depth > seen.max[2] { depth } else { seen.max[2] + 1.0 };
        let eye = in_world([x, y, depth]);
        let distance = depth - middle[2];
        let (height, is_parallel) = (2.0 * slope, false);
        Ok(Self { eye, sight, height, is_parallel, distance, middle: MIDDLE })
    }

    /// Perpendicular to the plane of `sight`, so that the picture shows `height` [m] around
    /// `centre`; from `distance` in front of it [m].
    ///
    /// ```
    /// use palpate_render::{Camera, Sight};
    ///
    /// let front = Sight::from_angles(0.0, 0.0)?;
    /// let camera = Camera::facing(front, [0.0, 0.1, 0.0].into(), 0.3, 2.0)?;
    /// assert_eq!((camera.eye().0, camera.is_orthographic()), ([0.0, 0.1, 2.0], true));
    /// # Ok::<(), palpate_render::RenderError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If height or distance is not positive, or the centre not finite or beyond 1e15.
    pub fn facing(
        sight: Sight,
        centre: Point<3>,
        height: f64,
        distance: f64,
    ) -> Result<Self, RenderError> {
        QueryError::check_point("what the camera shows", centre)?;
        RenderError::check_positive("the height of what a picture shows", height, " m")?;
        RenderError::check_positive("the distance of a camera", distance, " m")?;
        let eye = centre + sight.back * distance;
        Ok(Self { eye, sight, height, is_parallel: true, distance, middle: MIDDLE })
    }

    /// What the camera sees, in the upper part of a higher picture: `share` of its height, from 0
    /// to 0.9, is below. A share beyond these counts as the nearer of them.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_render::{Camera, Lens};
    ///
    /// # fn main() -> Result<(), palpate_render::RenderError> {
    /// let (eye, at) = (Vector([0.0, 0.0, 3.0]), Vector([0.0, 0.0, 0.0]));
    /// let camera = Camera::looking(eye, at, Lens::USUAL)?;
    /// assert_eq!(camera.projected(at, [400, 300]), Some([200.0, 150.0]));
    /// let higher = camera.with_room_below(0.25);
    /// assert_eq!(higher.projected(at, [400, 400]), Some([200.0, 150.0]));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_room_below(&self, share: f64) -> Self {
        let above = 1.0 - share.clamp(0.0, 0.9);
        Self { height: self.height / above, middle: self.middle * above, ..*self }
    }

    /// The camera turned by `angle` [rad] about the vertical through `centre`.
    #[must_use]
    pub fn turned(&self, angle: f64, centre: Point<3>) -> Self {
        let turn = Rotation::identity().turned([0.0, angle, 0.0]);
        let Sight { right, up, back } = self.sight;
        Self {
            eye: centre + turn.rotate(self.eye - centre),
            sight: Sight {
                right: turn.rotate(right),
                up: turn.rotate(up),
                back: turn.rotate(back),
            },
            ..*self
        }
    }

    /// Where the camera is [m].
    #[must_use]
    pub fn eye(&self) -> Point<3> {
        self.eye
    }

    /// The direction of sight.
    #[must_use]
    pub fn sight(&self) -> &Sight {
        &self.sight
    }

    /// `true` for an orthographic lens.
    #[must_use]
    pub fn is_orthographic(&self) -> bool {
        self.is_parallel
    }

    /// The size of a pixel at the distance of what is looked at, in a picture of `height`
    /// pixels [m].
    #[must_use]
    pub fn pixel(&self, height: u32) -> f64 {
        let shown = if self.is_parallel { self.height } else { self.height * self.distance };
        shown / f64::from(height)
    }

    /// Where a point is in a picture of `width` by `height` pixels: from its left and upper edge
    /// [pixels]; `None` for a point behind the camera.
    #[must_use]
    pub fn projected(&self, point: Point<3>, [width, height]: [u32; 2]) -> Option<[f64; 2]> {
        let [x, y, z] = self.sight.parts(point - self.eye);
        let depth = if self.is_parallel { 1.0 } else { -z };
        let scale = f64::from(height) / (self.height * depth);
        let middle = [0.5 * f64::from(width), self.middle * f64::from(height)];
        (depth > 0.0).then(|| [middle[0] + scale * x, middle[1] - scale * y])
    }

    /// The cone of a pixel about the ray through a place of the picture; both in pixels from the
    /// left and upper edge. Not yet cut at what the scene holds.
    pub(crate) fn beam(&self, [x, y]: [f64; 2], [width, height]: [u32; 2]) -> Beam {
        let size = self.height / f64::from(height);
        let Sight { right, up, back } = self.sight;
        let aside = right * ((x - 0.5 * f64::from(width)) * size)
            + up * ((self.middle * f64::from(height) - y) * size);
        let radius = COVER * size;
        if self.is_parallel {
            let (near, far) = (f64::NEG_INFINITY, f64::INFINITY);
            let origin = self.eye + aside;
            return Beam { origin, direction: -back, near, far, radius, spread: 0.0 };
        }
        let way = aside - back;
        Beam {
            origin: self.eye,
            direction: way * (1.0 / way.norm()),
            near: 0.0,
            far: f64::INFINITY,
            radius: 0.0,
            spread: radius,
        }
    }
}

/// Half the height of what a lens shows, over its distance; of an orthographic lens, as the
/// usual one shows.
fn slope(lens: Lens) -> Result<f64, RenderError> {
    match lens {
        Lens::Orthographic => slope(Lens::USUAL),
        // Written so that NaN is refused.
        Lens::Perspective(angle) if angle > 0.0 && angle < PI => Ok(libm::tan(0.5 * angle)),
        Lens::Perspective(value) => {
            let (what, rule) = ("the field of view", "between 0 and pi");
            Err(RenderError::Number { what, rule, value, unit: " rad" })
        }
    }
}
