// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lines that show a guide in a picture. They are no part of a tick: they allocate.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use palpate_field::{Aabb, Point, Vector};

use super::target::Target;
use super::well::Well;
use super::{Guide, Kind};

/// The size of the cross at a point, as a part of the half diagonal of the box.
const CROSS: f64 = 0.03;

/// Corners of a circle: smooth at the size of a picture.
const CORNERS: u32 = 96;

impl Guide {
    /// What reports call the guide: `"point"`, `"line"`, `"plane"`, `"curve"` (segments too),
    /// `"well"` or `"slope"`.
    ///
    /// ```
    /// use palpate_haptics::{Guide, GuideOptions};
    /// let well = Guide::well([0.0, 0.1, 0.0], 0.05, GuideOptions::default())?;
    /// assert_eq!(well.kind_name(), "well");
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    #[must_use]
    pub fn kind_name(&self) -> &'static str {
        match &self.kind {
            Kind::Target(Target::Point(_)) => "point",
            Kind::Target(Target::Line { .. }) => "line",
            Kind::Target(Target::Plane { .. }) => "plane",
            Kind::Target(Target::Curve(_)) => "curve",
            Kind::Well(_) => "well",
            Kind::Slope(_) => "slope",
        }
    }

    /// Lines that show where the guide is [m], each a list of its corners: a cross at a point, of
    /// 6 % of the diagonal of the box `within`; a line and the lines of a plane, cut off at that
    /// box; a curve, and circles at the reach of a well, whole. A slope has none. The box of a planar
    /// scene has no extent along z, and no lines go along z.
    ///
    /// ```
    /// use palpate_field::{Aabb, Vector};
    /// use palpate_haptics::{Guide, GuideOptions};
    /// let options = GuideOptions::default();
    /// let guide = Guide::along_line([0.0, 0.5, 0.0], [2.0, 0.0, 0.0], options)?;
    /// let lines = guide.lines_within(&Aabb::centred(Vector([1.0, 2.0, 0.0])));
    /// assert_eq!(lines, [[Vector([-1.0, 0.5, 0.0]), Vector([1.0, 0.5, 0.0])]]);
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    #[must_use]
    #[inline(never)]
    pub fn lines_within(&self, within: &Aabb<3>) -> Vec<Vec<Point<3>>> {
        match &self.kind {
            Kind::Target(Target::Point(point)) => {
                let arm = CROSS * within.half_extents().norm();
                let cross = |axis| {
                    vec![*point - Vector::unit(axis) * arm, *point + Vector::unit(axis) * arm]
                };
                axes_of(within).map(cross).collect()
            }
            Kind::Target(Target::Line { through, direction }) => {
                clipped(*through, *direction, within).into_iter().collect()
            }
            Kind::Target(Target::Plane { through, normal }) => {
                let along = in_plane(*normal);
                let lines =
                    along.into_iter().filter_map(|axis| clipped(*through, axis, within));
                lines.collect()
            }
            Kind::Target(Target::Curve(curve)) => vec![curve.corners()],
            Kind::Well(well) => circles(well, within),
            Kind::Slope(_) => Vec::new(),
        }
    }
}

/// Directions in the plane with this normal, those nearest to axes: one in 2D, two in 3D.
fn in_plane(normal: Vector<f64, 3>) -> Vec<Vector<f64, 3>> {
    let mut known = vec![normal];
    for axis in 0..3 {
        let rest = known.iter().fold(Vector::unit(axis), |rest, k| rest - *k * rest.dot(*k));
        // Of at least one axis half or more is left; a rest of rounding has no direction.
        if rest.norm() > 0.5 && known.len() < 3 {
            known.extend(rest.normalized());
        }
    }
    known.split_off(1)
}

/// The part of a line in a box; `None` if there is none.
fn clipped(
    through: Point<3>,
    direction: Vector<f64, 3>,
    within: &Aabb<3>,
) -> Option<Vec<Point<3>>> {
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    let (min, max) = (within.min.0, within.max.0);
    for (((at, along), low), high) in through.0.iter().zip(direction.0).zip(min).zip(max) {
        if along.abs() < f64::MIN_POSITIVE {
            // Written so that NaN is outside.
            let is_between = *at >= low && *at <= high;
            if !is_between {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - at) / along, (high - at) / along);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from < to).then(|| vec![through + direction * from, through + direction * to])
}

/// The axes along which a box has an extent: two for that of a planar scene.
fn axes_of(within: &Aabb<3>) -> impl Iterator<Item = usize> + Clone + use<> {
    let half = within.half_extents();
    (0..3).filter(move |axis| half[*axis] > 0.0)
}

/// Circles at the reach of a well, one in each plane of two axes along which the box has an extent.
fn circles(well: &Well, within: &Aabb<3>) -> Vec<Vec<Point<3>>> {
    let (centre, radius) = (well.centre, well.reach);
    let axes = axes_of(within);
    let after = |a| axes.clone().filter(move |b| *b > a);
    let pairs = axes.clone().flat_map(|a| after(a).map(move |b| (a, b)));
    let circle = |(a, b): (usize, usize)| {
        let corner = |i: u32| {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(CORNERS));
            centre + (Vector::unit(a) * cos + Vector::unit(b) * sin) * radius
        };
        (0..=CORNERS).map(corner).collect()
    };
    pairs.map(circle).collect()
}
