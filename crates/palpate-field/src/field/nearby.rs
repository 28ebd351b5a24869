// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The search for members of a union near a place: a tree of two levels, with a ball
//! around each member and one around each line of members that are close together.
//!
//! Single precision is enough: the slack of the union covers its rounding.

use super::SharedField;
use crate::bounds::{Aabb, BoundingBall};
use crate::machine::{BLOCK, Block, Column, Job, run};
use crate::promise::Quality;
use crate::scalar::Scalar;
use crate::vector::{Vector, unrolled};

/// With fewer members, evaluating all is faster than searching.
const WORTH_CHOOSING: usize = 6;

/// Members in a line: a cache line of gaps.
pub(super) const LINE: usize = 16;

/// The tree of balls that is searched.
#[derive(Debug)]
pub(super) enum Nearby<const D: usize> {
    /// The balls of up to [`BLOCK`] members.
    Flat(Box<Balls<D, BLOCK>>),
    /// The balls of many members, in lines, and the ball around each line.
    Lines { around: Vec<Balls<D, BLOCK>>, lines: Vec<Balls<D, LINE>> },
}

/// Up to `W` balls.
#[derive(Debug)]
pub(super) struct Balls<const D: usize, const W: usize> {
    centres: Block<f32, D, W>,
    /// Minus infinity past the last ball.
    radii: Column<f32, W>,
    count: usize,
}

impl<const D: usize, const W: usize> Balls<D, W> {
    fn new(balls: impl ExactSizeIterator<Item = BoundingBall<D>>) -> Self {
        let count = balls.len();
        let mut all = Self { centres: Block::zero(), radii: Column::zero(), count };
        for i in count..W {
            all.radii.set(i, f32::NEG_INFINITY);
        }
        for (i, BoundingBall { centre, radius }) in balls.enumerate() {
            all.centres.set(i, Vector::of(&centre.0));
            all.radii.set(i, radius as f32);
        }
        all
    }

    /// The distance from a place to each ball; infinite past the last ball.
    #[inline(always)]
    fn gaps(&self, from: Vector<f32, D>) -> Column<f32, W> {
        let mut gaps = Column::scratch();
        run(&ToBalls(from), &self.centres, &self.radii, W, &mut gaps);
        gaps
    }
}

/// The distance of a point from balls.
struct ToBalls<const D: usize>(Vector<f32, D>);

impl<const D: usize> Job<Vector<f32, D>, f32, f32> for ToBalls<D> {
    #[inline(always)]
    fn lane(&self, centre: Vector<f32, D>, radius: f32) -> f32 {
        (centre - self.0).norm() - radius
    }
}

/// A cell, and the lower plane of a model over it, with which balls are compared.
pub(super) struct Floor<const D: usize, const N: usize> {
    /// The centre of the cell [m].
    pub(super) centre: Vector<f32, D>,
    /// From there to the cell's side along each parameter [m].
    pub(super) sides: [Vector<f32, D>; N],
    /// The model's value [m].
    pub(super) value: f32,
    /// Its gradient [m].
    pub(super) gradient: [f32; N],
    /// How far the lower plane is below the value [m].
    pub(super) lower: f32,
    /// What roundings may take away [m].
    pub(super) slack: f32,
}

/// What is foremost in the way of a [`Floor`].
pub(super) enum Foremost {
    /// This member.
    Member(usize),
    /// Nothing.
    AllClear,
    /// A member that was not found, or none.
    Unknown,
}

/// How far a ball stays clear of a [`Floor`]: at the centre its signed distance is larger than the
/// value by so much at least, and over the whole cell it is so far above the lower plane.
///
/// Above, the signed distance is replaced by its tangent plane, which is a lower bound.
struct Clearance<'a, const D: usize, const N: usize>(&'a Floor<D, N>);

impl<const D: usize, const N: usize> Job<Vector<f32, D>, f32, f32> for Clearance<'_, D, N> {
    #[inline(always)]
    fn lane(&self, centre: Vector<f32, D>, radius: f32) -> f32 {
        let floor = self.0;
        let away = floor.centre - centre;
        let distance = away.norm();
        // In the centre of a ball any direction is one of a plane below.
        let inverse = 1.0 / Scalar::max(distance, f32::MIN_POSITIVE);
        let mut tilt = 0.0;
        unrolled!(k < N => {
            let mut slope = 0.0;
            unrolled!(i < D => slope += away.0[i] * floor.sides[k].0[i]);
            tilt += f32::abs(floor.gradient[k] - slope * inverse);
        });
        (distance - radius) - floor.value - Scalar::max(tilt - floor.lower, 0.0)
    }
}

impl<const D: usize, const W: usize> Balls<D, W> {
    #[inline(always)]
    fn clearances<const N: usize>(&self, floor: &Floor<D, N>) -> Column<f32, W> {
        let mut clearances = Column::scratch();
        run(&Clearance(floor), &self.centres, &self.radii, W, &mut clearances);
        clearances
    }

    /// The balls that are not clear of a floor, one bit each.
    pub(super) fn in_the_way_of<const N: usize>(&self, floor: &Floor<D, N>) -> u64 {
        self.not_above(&self.clearances(floor), floor.slack)
    }

    /// The balls whose clearance is not above a limit, one bit each.
    #[inline(always)]
    fn not_above(&self, clearances: &Column<f32, W>, limit: f32) -> u64 {
        let (lines, _) = clearances.as_slice().as_chunks::<LINE>();
        let mut bits = 0;
        for (k, line) in lines.iter().enumerate() {
            // A number that is none is not above.
            bits |= u64::from(above(line, limit) ^ first_bits(LINE)) << (k * LINE);
        }
        bits & (u64::MAX >> (u64::BITS as usize - self.count))
    }

    /// The ball that is least clear of a floor, and by how much; `except` one.
    fn foremost<const N: usize>(&self, floor: &Floor<D, N>, except: usize) -> (usize, f32) {
        let mut clearances = self.clearances(floor);
        if except < W {
            clearances.set(except, f32::INFINITY);
        }
        nearest(&clearances)
    }
}

/// A ball whose signed distance is a lower bound of the member's values; of infinite
/// radius, and so always near, if the member promises none.
fn ball_of<const D: usize>(member: &SharedField<D>) -> BoundingBall<D> {
    let promise = member.promise();
    let skippable = promise.above_bounds && promise.inside != Quality::Lipschitz;
    match &promise.bounds {
        Some(bounds) if skippable => bounds.ball,
        _ => BoundingBall { centre: Vector::ZERO, radius: f64::INFINITY },
    }
}

/// A ball around the balls of a line, about the centre of their box.
fn ball_around<const D: usize>(line: &[SharedField<D>]) -> BoundingBall<D> {
    let boxes = line.iter().map(|member| {
        let BoundingBall { centre, radius } = ball_of(member);
        Aabb { min: centre, max: centre }.grown(radius)
    });
    let Some(whole) = boxes.reduce(|a, b| a.union(&b)) else {
        return BoundingBall { centre: Vector::ZERO, radius: f64::NEG_INFINITY };
    };
    if !whole.half_extents().is_finite() {
        return BoundingBall { centre: Vector::ZERO, radius: f64::INFINITY };
    }
    let centre = whole.centre();
    let radius = line
        .iter()
        .map(ball_of)
        .fold(0.0_f64, |reach, ball| reach.max((ball.centre - centre).norm() + ball.radius));
    BoundingBall { centre, radius }
}

/// Sorts members so that each line of them is close together: halves of whole lines
/// along the longest side of the box of their centres, again and again.
fn gather<const D: usize>(members: &mut [SharedField<D>]) {
    if members.len() <= LINE {
        return;
    }
    let centre = |member: &SharedField<D>| ball_of(member).centre;
    let Some(spread) = Aabb::around(members.iter().map(centre)) else { return };
    let sides = spread.half_extents();
    let longest =
        (1..D).fold(0, |longest, i| if sides[i] > sides[longest] { i } else { longest });
    let half = (members.len() / 2).next_multiple_of(LINE);
    let (low, _, _) = members
        .select_nth_unstable_by(half, |a, b| centre(a)[longest].total_cmp(&centre(b)[longest]));
    let half = low.len();
    let (low, high) = members.split_at_mut(half);
    gather(low);
    gather(high);
}

impl<const D: usize> Nearby<D> {
    /// The tree over `members`; `None` where evaluating all is faster.
    ///
    /// Many members are sorted, so that neighbours share a line.
    pub(super) fn new(members: &mut [SharedField<D>]) -> Option<Self> {
        if members.len() < WORTH_CHOOSING {
            return None;
        }
        if members.len() <= BLOCK {
            return Some(Self::Flat(Box::new(Balls::new(members.iter().map(ball_of)))));
        }
        // Members without a ball come first: one in a line makes the whole line near.
        members.sort_by_key(|member| ball_of(member).radius.is_finite());
        let endless = members.iter().take_while(|m| !ball_of(m).radius.is_finite()).count();
        gather(&mut members[endless..]);
        let lines: Vec<&[SharedField<D>]> = members.chunks(LINE).collect();
        let around = lines
            .chunks(BLOCK)
            .map(|lines| Balls::new(lines.iter().map(|line| ball_around(line))));
        Some(Self::Lines {
            around: around.collect(),
            lines: lines.iter().map(|line| Balls::new(line.iter().map(ball_of))).collect(),
        })
    }

    /// The member whose ball is least clear of a floor, `except` one that is in the way.
    ///
    /// Of many members only one line is looked through: if they are clear, others may not be.
    pub(super) fn foremost<const N: usize>(
        &self,
        floor: &Floor<D, N>,
        except: usize,
    ) -> Foremost {
        let (member, clearance, is_only_line) = match self {
            Self::Flat(balls) => {
                let (member, clearance) = balls.foremost(floor, except);
                (member, clearance, true)
            }
            Self::Lines { around, lines } => {
                let (mut line, mut least, mut in_the_way) = (0, f32::INFINITY, 0);
                for (block, around) in around.iter().enumerate() {
                    let clearances = around.clearances(floor);
                    let (i, clearance) = nearest(&clearances);
                    if clearance < least {
                        (line, least) = (block * BLOCK + i, clearance);
                    }
                    in_the_way += around.not_above(&clearances, floor.slack).count_ones();
                }
                let first = line * LINE;
                let (i, clearance) = lines[line].foremost(floor, except.wrapping_sub(first));
                // The line of the exception is in the way.
                (first + i, clearance, in_the_way == 1 && except / LINE == line)
            }
        };
        if clearance <= floor.slack {
            Foremost::Member(member)
        } else if is_only_line && clearance > floor.slack {
            Foremost::AllClear
        } else {
            Foremost::Unknown
        }
    }

    /// Calls `near` with the number of every member whose ball is at most as far from
    /// a place as the smallest bound so far, and `slack` on top [m]; in their order.
    ///
    /// `value` gives an upper bound for a member; `near` may return a smaller one.
    #[inline(always)]
    pub(super) fn for_each(
        &self,
        from: Vector<f32, D>,
        slack: f64,
        mut value: impl FnMut(usize) -> f64,
        mut near: impl FnMut(usize) -> f64,
    ) {
        let mut search = Search { bound: f64::INFINITY, slack };
        match self {
            Self::Flat(balls) => {
                let gaps = balls.gaps(from);
                search.lower(value(nearest(&gaps).0));
                search.each(&gaps, balls.count, |search, i| search.lower(near(i)));
            }
            Self::Lines { around, lines } => {
                for (block, around) in around.iter().enumerate() {
                    let first = block * BLOCK;
                    let gaps = around.gaps(from);
                    let (line, gap) = nearest(&gaps);
                    if search.reaches(gap) {
                        let line = first + line;
                        let (i, _) = nearest(&lines[line].gaps(from));
                        search.lower(value(line * LINE + i));
                    }
                    search.each(&gaps, around.count, |search, line| {
                        let line = first + line;
                        let (balls, first) = (&lines[line], line * LINE);
                        search.each(&balls.gaps(from), balls.count, |search, i| {
                            search.lower(near(first + i));
                        });
                    });
                }
            }
        }
    }
}

/// The smallest bound of a value so far [m].
struct Search {
    bound: f64,
    slack: f64,
}

impl Search {
    #[inline(always)]
    fn lower(&mut self, bound: f64) {
        self.bound = self.bound.min(bound);
    }

    #[inline(always)]
    fn reaches(&self, gap: f32) -> bool {
        f64::from(gap) <= self.bound + self.slack
    }

    /// Calls `visit` with each of the first `count` lanes whose gap is within reach.
    #[inline(always)]
    fn each<const W: usize>(
        &mut self,
        gaps: &Column<f32, W>,
        count: usize,
        mut visit: impl FnMut(&mut Self, usize),
    ) {
        let (lines, _) = gaps.as_slice().as_chunks::<LINE>();
        for (k, line) in lines.iter().enumerate() {
            // The lanes past the last ball are infinitely far, but so may the limit be.
            let lanes = first_bits(count.saturating_sub(k * LINE));
            let mut bits = at_most(line, (self.bound + self.slack) as f32) & lanes;
            while bits != 0 {
                let i = bits.trailing_zeros() as usize;
                bits &= bits - 1;
                // The bound may have fallen since the bits were found.
                if self.reaches(line[i]) {
                    visit(self, k * LINE + i);
                }
            }
        }
    }
}

/// The lane with the smallest gap, and that.
#[inline(always)]
fn nearest<const W: usize>(gaps: &Column<f32, W>) -> (usize, f32) {
    let (lines, _) = gaps.as_slice().as_chunks::<LINE>();
    let mut nearest = (0, f32::INFINITY);
    for (k, line) in lines.iter().enumerate() {
        let gap = smallest_of(line);
        nearest = if gap < nearest.1 { (k, gap) } else { nearest };
    }
    let (k, gap) = nearest;
    (k * LINE + at_most(&lines[k], gap).trailing_zeros() as usize % LINE, gap)
}

/// The smallest gap of a line, halving it without a branch.
#[inline(always)]
fn smallest_of(line: &[f32; LINE]) -> f32 {
    let mut least = *line;
    let mut width = LINE / 2;
    while width > 0 {
        for i in 0..width {
            least[i] = Scalar::min(least[i], least[i + width]);
        }
        width /= 2;
    }
    least[0]
}

/// The gaps of a line that are at most `limit`, one bit each.
#[inline(always)]
fn at_most(line: &[f32; LINE], limit: f32) -> u32 {
    let mut bits = 0;
    for (i, gap) in line.iter().enumerate() {
        bits |= u32::from(*gap <= limit) << i;
    }
    bits
}

/// The numbers of a line that are more than `limit`, one bit each.
#[inline(always)]
fn above(line: &[f32; LINE], limit: f32) -> u32 {
    let mut bits = 0;
    for (i, number) in line.iter().enumerate() {
        bits |= u32::from(*number > limit) << i;
    }
    bits
}

/// A word with its lowest `count` bits set, all of a line at most.
#[inline(always)]
fn first_bits(count: usize) -> u32 {
    if count >= LINE { (1 << LINE) - 1 } else { (1 << count) - 1 }
}
