// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bent sides: the pieces of a quadratic Bézier curve that are near a cell.

use super::line::Edge;
use super::sides::Side;
use crate::vector::{Point, Vector};

/// Parts of a curve that are looked at for one cell: enough for one that is a millionth as long.
const MOST_PARTS: usize = 200;

/// The most pieces that are found.
const MOST_PIECES: usize = 4;

/// The deepest nesting of halves: beyond, numbers between the ends of a part run out.
const DEEPEST: usize = 48;

/// The curve `B(t) = from + 2td + t²c` for t in [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    /// B(0).
    pub(super) from: Point<2>,
    /// d.
    pub(super) step: Vector<f64, 2>,
    /// c.
    pub(super) bend: Vector<f64, 2>,
}

/// A disc around which a curve is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    pub(super) centre: Point<2>,
    pub(super) radius: f64,
    /// The distance from the centre to the nearest curve; perhaps another.
    pub(super) distance: f64,
}

/// The pieces of curves that hold the nearest points of all points of a disc.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pieces {
    /// Where each begins and ends on its curve, and which curve that is.
    found: [(f64, f64, usize); MOST_PIECES],
    count: usize,
}

impl Pieces {
    /// Adds a part of curve number `curve`, which may go on from the last; `None` if there are
    /// too many.
    fn add(&mut self, from: f64, to: f64, curve: usize) -> Option<()> {
        if let Some((_, end, of)) = self.found[..self.count].last_mut()
            && *of == curve
            && *end >= from
        {
            *end = to;
            return Some(());
        }
        *self.found.get_mut(self.count)? = (from, to, curve);
        self.count += 1;
        Some(())
    }

    /// The pieces as sides of an outline of `curves`.
    pub(super) fn sides(&self, curves: &[Bent]) -> impl Iterator<Item = Side> {
        let side = |&(from, to, curve): &(f64, f64, usize)| curves[curve].side(from, to);
        self.found[..self.count].iter().map(side)
    }
}

impl Bent {
    /// The curve with these ends and control point.
    pub(super) fn new(from: Point<2>, control: Point<2>, to: Point<2>) -> Self {
        let step = control - from;
        Self { from, step, bend: to - control - step }
    }

    /// The point at a parameter.
    fn at(&self, t: f64) -> Point<2> {
        self.from + self.step * (2.0 * t) + self.bend * (t * t)
    }

    /// A piece, as an edge that it is nearly on.
    ///
    /// From the chord's point at the same share of the way, that of the curve is `−c·u` away,
    /// with u from 0 to a quarter of the square of the piece: the edge is half of that off the
    /// chord.
    fn side(&self, from: f64, to: f64) -> Side {
        let eighth = 0.125 * (to - from) * (to - from);
        let shift = self.bend * eighth;
        let edge = Edge::new(self.at(from) - shift, self.at(to) - shift);
        Side { edge, off: eighth * self.bend.norm() }
    }

    /// Adds the pieces of this curve, number `curve` of several, that may be nearest to a point
    /// of a disc; `None` if they are not found soon.
    ///
    /// What is nearest to a point of the disc is at most 2r farther from the centre than the
    /// nearest of all. Unless it is an end, the way from it to the point is across the curve, so
    /// the way to the centre goes at most r along it. Halves of the curve are looked at until
    /// they are ruled out, or are no longer than the disc is wide.
    pub(super) fn add_near(&self, disc: &Disc, curve: usize, found: &mut Pieces) -> Option<()> {
        let Disc { centre, radius, distance } = *disc;
        let reach = distance + 2.0 * radius;
        // An end: of a point that is beyond it, as seen along the curve.
        let is_end = |t: f64, outwards: f64| {
            let (offset, speed) = (centre - self.at(t), self.step + self.bend * t);
            let beyond = outwards * offset.dot(speed);
            offset.norm() <= reach && beyond >= -radius * speed.norm()
        };
        if is_end(0.0, -1.0) {
            found.add(0.0, 0.0, curve)?;
        }
        // Parts by their middle and half length, the next one last.
        let (mut parts, mut waiting) = ([(0.5, 0.5); DEEPEST + 1], 1);
        for _ in 0..MOST_PARTS {
            if waiting == 0 {
                if is_end(1.0, 1.0) {
                    found.add(1.0, 1.0, curve)?;
                }
                return Some(());
            }
            waiting -= 1;
            let (middle, half) = parts[waiting];
            let (offset, speed) = (centre - self.at(middle), self.step + self.bend * middle);
            // Half of |B'| at most, and how far the part goes from its middle.
            let fastest = speed.norm() + half * self.bend.norm();
            let (away, far) = (offset.norm(), 2.0 * half * fastest);
            // The product of the offset with B'/2, its largest slope, and what it may be.
            let along = offset.dot(speed).abs();
            let steepest = 2.0 * fastest * fastest + (away + far) * self.bend.norm();
            if away - far > reach || along - half * steepest > radius * fastest {
                continue;
            }
            if far <= radius {
                found.add(middle - half, middle + half, curve)?;
            } else {
                let quarter = 0.5 * half;
                *parts.get_mut(waiting + 1)? = (middle - quarter, quarter);
                parts[waiting] = (middle + quarter, quarter);
                waiting += 2;
            }
        }
        None
    }
}
