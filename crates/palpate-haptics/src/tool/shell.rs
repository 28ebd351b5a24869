// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The shell of a tool: balls all over its surface, in levels of detail.
//!
//! McNeely, Puterbaugh and Troy, "Six degree-of-freedom haptic rendering using voxel sampling"
//! (1999), render a tool as a shell of points. Barbič and James, "Six-DoF haptic rendering of
//! contact between geometrically complex reduced deformable models" (2008), nest shells of
//! different density, so that a tick that runs out of time has at least evaluated a coarse one.

use std::ops::Range;

use palpate_field::{LARGEST_LENGTH, Point, Shape, Vector};
use palpate_mesh::Mesh;

use super::spread::{Samples, farthest_first, of_field, of_mesh};
use crate::error::HapticsError;
use palpate_device::NumberError;

/// The most points of a shell.
pub const MOST_POINTS: usize = 8192;

/// Points of the first level; each further level has [`FINER`] times as many as all before.
pub(super) const FIRST_LEVEL: usize = 16;
const FINER: usize = 4;

/// The most points of a cluster. Small clusters are skipped more precisely, large ones with
/// less work.
const CLUSTER: usize = 16;

/// One of the balls of a shell, in the tool's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellPoint {
    /// The centre [m].
    pub centre: Point<3>,
    /// The radius [m].
    pub radius: f64,
}

/// Neighbouring points of a level.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    /// The range of points in [`Shell::order`].
    pub(super) members: Range<usize>,
    /// The level.
    pub(super) level: usize,
    /// The farthest centre from the tool's origin [m].
    pub(super) arm: f64,
}

/// The surface of a tool as balls, ordered so that every prefix is a coarser shell.
///
/// Each point is the one farthest from all before it. The [`resolution`](Self::resolution) is
/// the largest distance of the tool's surface from the balls: if a field of Lipschitz constant
/// `L` is at least `r` at the centre of each ball of radius `r`, it is at least `(1 − L) r −
/// L·resolution` at all points of the tool.
///
/// # Examples
///
/// A box of 40 mm in 500 points:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cuboid};
/// use palpate_haptics::Shell;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let cube = Shape::from_kernel(Cuboid::new(Vector([0.04, 0.04, 0.04]))?);
/// let shell = Shell::from_field(&cube, 500, 0.0)?;
/// assert_eq!(shell.points().len(), 500);
/// assert!(shell.resolution(500) < 0.008 && shell.resolution(16) > shell.resolution(500));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Shell {
    points: Vec<ShellPoint>,
    /// The resolution of each prefix [m].
    resolutions: Vec<f64>,
    /// The number of points up to the end of each level.
    pub(super) levels: Vec<usize>,
    pub(super) clusters: Vec<Cluster>,
    /// Numbers of points, cluster by cluster.
    pub(super) order: Vec<u32>,
    /// The largest distance of a ball's far side from the tool's origin [m].
    pub(super) reach: f64,
    /// Whether the tool stays in the plane z = 0.
    pub(super) is_flat: bool,
}

impl Shell {
    /// A ball of `radius` about the tool's origin [m]: one point.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is not positive.
    ///
    /// ```
    /// let ball = palpate_haptics::Shell::ball(0.01)?;
    /// assert_eq!((ball.points().len(), ball.resolution(1)), (1, 0.0));
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    pub fn ball(radius: f64) -> Result<Self, HapticsError> {
        let radius = NumberError::check_positive("radius", radius, "m")?;
        Self::new(vec![ShellPoint { centre: Vector::ZERO, radius }], vec![0.0])
    }

    /// A capsule, all points within `radius` of the segment between two points [m], as `count`
    /// balls.
    ///
    /// With a spacing `s`, the surface is at most `√(r² + s²/4) − r` away from the balls.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is not positive, a coordinate not finite or
    /// beyond 1e15, or the count not in 2 to 8192.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_haptics::Shell;
    ///
    /// let ends = [Vector([0.0, -0.03, 0.0]), Vector([0.0, 0.03, 0.0])];
    /// let stylus = Shell::capsule(ends, 0.004, 11)?;
    /// assert!((stylus.resolution(11) - 0.001).abs() < 1e-15); // √(4² + 3²) − 4
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    #[inline(never)]
    pub fn capsule(
        ends: [Point<3>; 2],
        radius: f64,
        count: usize,
    ) -> Result<Self, HapticsError> {
        let radius = NumberError::check_positive("radius", radius, "m")?;
        check_count(count, 2)?;
        let [from, to] = ends;
        let way = (to - from) * (1.0 / (count - 1) as f64);
        let axis = Samples {
            points: (0..count).map(|i| from + way * i as f64).collect(),
            spacing: 0.5 * way.norm(),
        };
        let (points, covers) = chosen(&axis, count, radius);
        let bulge = |cover: f64| (radius * radius + cover * cover).sqrt() - radius;
        Self::new(points, covers.into_iter().map(bulge).collect())
    }

    /// The elements of a mesh, as `count` balls of `radius` [m] about points of the mesh; the
    /// tool is thicker than the mesh by the radius. A radius of zero makes points.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is negative or not finite, or the count not in 1
    /// to 8192.
    #[inline(never)]
    pub fn from_mesh<const N: usize, const D: usize>(
        mesh: &Mesh<N, D>,
        count: usize,
        radius: f64,
    ) -> Result<Self, HapticsError> {
        let radius = NumberError::check_not_negative("radius", radius, "m")?;
        check_count(count, 1)?;
        let shell = Self::sampled(&of_mesh(mesh, count), count, radius)?;
        Ok(Self { is_flat: D == 2, ..shell })
    }

    /// The surface of a field, as `count` balls of `radius` [m] about points of the surface;
    /// the tool is thicker than the shape by the radius. A radius of zero makes points.
    ///
    /// The resolution is proven for exact fields.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is negative or not finite, or the count not in 1
    /// to 8192; [`HapticsError::NothingToTouchWith`] if the field is unbounded or no surface
    /// was found.
    #[inline(never)]
    pub fn from_field<const D: usize>(
        shape: &Shape<D>,
        count: usize,
        radius: f64,
    ) -> Result<Self, HapticsError> {
        let radius = NumberError::check_not_negative("radius", radius, "m")?;
        check_count(count, 1)?;
        let bounds = shape.promise().bounds.ok_or(HapticsError::NothingToTouchWith)?;
        let shell = Self::sampled(&of_field(shape, &bounds.aabb, count), count, radius)?;
        Ok(Self { is_flat: D == 2, ..shell })
    }

    fn sampled(samples: &Samples, count: usize, radius: f64) -> Result<Self, HapticsError> {
        let (points, covers) = chosen(samples, count, radius);
        // The balls reach beyond the sampled surface by their radius.
        Self::new(points, covers.into_iter().map(|cover| (cover - radius).max(0.0)).collect())
    }

    /// A shell of points in their order, with the resolution of each prefix.
    fn new(points: Vec<ShellPoint>, resolutions: Vec<f64>) -> Result<Self, HapticsError> {
        if points.is_empty() {
            return Err(HapticsError::NothingToTouchWith);
        }
        let mut reach = 0.0_f64;
        for point in &points {
            // Written so that NaN fails.
            let is_usable = |x: &f64| x.abs() <= LARGEST_LENGTH;
            if let Some(&value) = point.centre.0.iter().find(|x| !is_usable(x)) {
                let (parameter, rule, unit) = ("a point of a tool", "at most 1e15", "m");
                return Err(HapticsError::Number(NumberError::new(
                    parameter, rule, value, unit,
                )));
            }
            reach = reach.max(point.centre.norm() + point.radius);
        }
        let (mut levels, mut begin, mut end) = (Vec::new(), 0, FIRST_LEVEL);
        let (mut clusters, mut order) = (Vec::new(), Vec::with_capacity(points.len()));
        while begin < points.len() {
            end = end.min(points.len());
            let mut numbers: Vec<u32> = (begin as u32..end as u32).collect();
            split(&points, &mut numbers, &mut |part| {
                let from = order.len();
                order.extend_from_slice(part);
                let arms = part.iter().map(|i| points[*i as usize].centre.norm());
                let (members, arm) = (from..order.len(), arms.fold(0.0, f64::max));
                clusters.push(Cluster { members, level: levels.len(), arm });
            });
            levels.push(end);
            (begin, end) = (end, end * FINER);
        }
        Ok(Self { points, resolutions, levels, clusters, order, reach, is_flat: false })
    }

    /// This shell as that of a planar tool, which friction holds in the plane z = 0 alone. All points
    /// lie in that plane.
    #[must_use]
    pub fn in_plane(self) -> Self {
        Self { is_flat: true, ..self }
    }

    /// The points, each the farthest from those before.
    #[must_use]
    pub fn points(&self) -> &[ShellPoint] {
        &self.points
    }

    /// The largest distance of the tool's surface from the first `count` balls [m]; infinite
    /// for zero balls.
    #[must_use]
    pub fn resolution(&self, count: usize) -> f64 {
        let last = count.min(self.resolutions.len()).checked_sub(1);
        last.and_then(|last| self.resolutions.get(last)).copied().unwrap_or(f64::INFINITY)
    }

    /// The largest distance of a point of the tool from its origin [m].
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }
}

fn check_count(count: usize, least: usize) -> Result<(), HapticsError> {
    if (least..=MOST_POINTS).contains(&count) {
        return Ok(());
    }
    let rule = if least == 1 { "from 1 to 8192" } else { "from 2 to 8192" };
    let (parameter, unit) = ("number of points", "points");
    Err(HapticsError::Number(NumberError::new(parameter, rule, count as f64, unit)))
}

/// Points in farthest-first order, and the distance of the surface from each prefix [m].
fn chosen(samples: &Samples, count: usize, radius: f64) -> (Vec<ShellPoint>, Vec<f64>) {
    let order = farthest_first(&samples.points, count).into_iter();
    order.map(|(centre, away)| (ShellPoint { centre, radius }, away + samples.spacing)).unzip()
}

/// Splits points along their widest axis until they fit a cluster.
fn split(points: &[ShellPoint], numbers: &mut [u32], found: &mut impl FnMut(&[u32])) {
    if numbers.len() <= CLUSTER {
        found(numbers);
        return;
    }
    let along = |i: u32, axis: usize| points[i as usize].centre.0[axis];
    let width = |axis: usize| {
        let range =
            numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), i| {
                (low.min(along(*i, axis)), high.max(along(*i, axis)))
            });
        range.1 - range.0
    };
    let widest =
        (1..3).fold(0, |best, axis| if width(axis) > width(best) { axis } else { best });
    numbers.sort_by(|a, b| along(*a, widest).total_cmp(&along(*b, widest)));
    let (low, high) = numbers.split_at_mut(numbers.len() / 2);
    split(points, low, found);
    split(points, high, found);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_in_one_cluster_of_its_level() {
        let points: Vec<_> = (0..700)
            .map(|i| {
                let t = f64::from(i);
                ShellPoint { centre: Vector([t.sin(), t.cos(), 0.01 * t]), radius: 0.1 }
            })
            .collect();
        let shell = Shell::new(points, vec![0.5; 700]).unwrap();
        let ends = shell.levels.clone();
        assert_eq!(ends, [16, 64, 256, 700]);
        let mut seen = vec![0; 700];
        for cluster in &shell.clusters {
            assert!(cluster.members.len() <= CLUSTER);
            let begin = cluster.level.checked_sub(1).map_or(0, |before| ends[before]);
            for i in &shell.order[cluster.members.clone()] {
                let number = *i as usize;
                assert!((begin..ends[cluster.level]).contains(&number));
                assert!(shell.points[number].centre.norm() <= cluster.arm);
                seen[number] += 1;
            }
        }
        assert!(seen.iter().all(|count| *count == 1));
    }

    #[test]
    fn numbers_that_make_no_tool_are_refused() {
        let error = Shell::ball(0.0).unwrap_err();
        assert_eq!(error.to_string(), "radius must be positive and finite, got 0 m");
        let ends = [Vector([f64::NAN, 0.0, 0.0]), Vector([0.0, 1.0, 0.0])];
        assert!(Shell::capsule(ends, 0.1, 3).is_err());
        let error = Shell::capsule([Vector::ZERO; 2], 0.1, 1).unwrap_err();
        assert_eq!(error.to_string(), "number of points must be from 2 to 8192, got 1 points");
    }
}
