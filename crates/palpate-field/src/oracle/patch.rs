// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Parametrised pieces of a boundary, and the distance to them.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

use crate::vector::{Point, Vector};

/// The most samples for one distance.
const MOST_SAMPLES: usize = 40_000;

/// A piece of a boundary: a map from the unit square, or from the unit interval
/// where the second speed is zero.
pub struct Patch<const D: usize> {
    at: Box<dyn Fn(f64, f64) -> Point<D>>,
    /// The largest speed of a point along each parameter [m].
    speed: [f64; 2],
}

impl<const D: usize> std::fmt::Debug for Patch<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Patch").field("speed", &self.speed).finish_non_exhaustive()
    }
}

impl<const D: usize> Patch<D> {
    /// A surface.
    pub fn surface(speed: [f64; 2], at: impl Fn(f64, f64) -> Point<D> + 'static) -> Self {
        Self { at: Box::new(at), speed }
    }

    /// A curve.
    pub fn curve(speed: f64, at: impl Fn(f64) -> Point<D> + 'static) -> Self {
        Self { at: Box::new(move |t, _| at(t)), speed: [speed, 0.0] }
    }

    /// The straight line from `a` to `b`.
    #[must_use]
    pub fn segment(a: Point<D>, b: Point<D>) -> Self {
        Self::curve((b - a).norm(), move |t| a + (b - a) * t)
    }

    /// The flat triangle of three points.
    #[must_use]
    pub fn triangle([a, b, c]: [Point<D>; 3]) -> Self {
        let across = (b - a).norm().max((c - a).norm());
        Self::surface([across, (c - b).norm()], move |u, v| a + (b - a + (c - b) * v) * u)
    }

    /// The part of a circle about `centre`, spanned by the orthonormal `x` and
    /// `y`, between two angles [rad].
    #[must_use]
    pub fn arc(centre: Point<D>, axes: [Point<D>; 2], radius: f64, angles: [f64; 2]) -> Self {
        let [from, to] = angles;
        Self::curve(radius * (to - from).abs(), move |t| {
            let angle = from + (to - from) * t;
            centre + axes[0] * (radius * angle.cos()) + axes[1] * (radius * angle.sin())
        })
    }
}

impl Patch<2> {
    /// This curve, and its mirror image on the other side of the y axis.
    #[must_use]
    pub fn mirrored(self) -> (Self, Self) {
        let at = Rc::new(self.at);
        let image = Rc::clone(&at);
        let mirrored = move |u: f64, v: f64| {
            let [x, y] = image(u, v).0;
            Vector([-x, y])
        };
        let speed = self.speed;
        let kept = Self { at: Box::new(move |u, v| at(u, v)), speed };
        (kept, Self { at: Box::new(mirrored), speed })
    }

    /// The surface that this curve, no further than `widest` [m] from the axis,
    /// sweeps when turned about y.
    #[must_use]
    pub fn turned(self, widest: f64) -> Patch<3> {
        let at = self.at;
        Patch::surface([self.speed[0], widest * std::f64::consts::TAU], move |t, v| {
            let [rho, y] = at(t, 0.0).0;
            let angle = v * std::f64::consts::TAU;
            Vector([rho * angle.cos(), y, rho * angle.sin()])
        })
    }

    /// The wall that this curve in (x, z) sweeps along y.
    #[must_use]
    pub fn raised(self, half_height: f64) -> Patch<3> {
        let at = self.at;
        Patch::surface([self.speed[0], 2.0 * half_height], move |t, v| {
            let [x, z] = at(t, 0.0).0;
            Vector([x, half_height * (2.0 * v - 1.0), z])
        })
    }
}

impl Patch<3> {
    /// This surface after a rigid motion.
    #[must_use]
    pub fn moved(self, motion: impl Fn(Point<3>) -> Point<3> + 'static) -> Self {
        let at = self.at;
        Self { at: Box::new(move |u, v| motion(at(u, v))), speed: self.speed }
    }
}

/// A part of a patch, with a lower bound of its distance.
struct Part {
    lower: f64,
    patch: usize,
    middle: [f64; 2],
    half: [f64; 2],
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    /// The nearest is the greatest, so that a heap gives it first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower.total_cmp(&self.lower)
    }
}

/// A lower and an upper bound of the distance of `p` from the patches. The upper bound is that
/// of a sample; the lower one is at most `spacing` less, unless that takes more than
/// [`MOST_SAMPLES`].
pub(super) fn distance<const D: usize>(
    patches: &[Patch<D>],
    p: Point<D>,
    spacing: f64,
) -> (f64, f64) {
    let mut nearest = f64::INFINITY;
    let mut samples = 0;
    let mut heap = BinaryHeap::new();
    let mut sample = |patch: usize, middle: [f64; 2], half: [f64; 2]| {
        let piece = &patches[patch];
        let distance = (p - (piece.at)(middle[0], middle[1])).norm();
        let radius = piece.speed[0] * half[0] + piece.speed[1] * half[1];
        samples += 1;
        let lower = f64::max(0.0, distance - radius);
        (distance, samples, Part { lower, patch, middle, half })
    };
    for patch in 0..patches.len() {
        let (distance, _, part) = sample(patch, [0.5; 2], [0.5; 2]);
        nearest = f64::min(nearest, distance);
        heap.push(part);
    }
    while let Some(part) = heap.pop() {
        if part.lower >= nearest - spacing {
            return (part.lower.min(nearest), nearest);
        }
        let speed = patches[part.patch].speed;
        let axis = usize::from(speed[1] * part.half[1] > speed[0] * part.half[0]);
        let mut half = part.half;
        half[axis] *= 0.5;
        let mut taken = 0;
        for side in [-1.0, 1.0] {
            let mut middle = part.middle;
            middle[axis] += side * half[axis];
            let (distance, samples, child) = sample(part.patch, middle, half);
            nearest = f64::min(nearest, distance);
            heap.push(Part { lower: child.lower.max(part.lower), ..child });
            taken = samples;
        }
        if taken > MOST_SAMPLES {
            return (part.lower, nearest);
        }
    }
    (nearest, nearest)
}
