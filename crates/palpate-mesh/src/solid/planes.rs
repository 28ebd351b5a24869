// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Planes that bound the field of a solid over a cell.
//!
//! Beside a flat side, an edge or a corner of a solid, the field is at least the height over a plane, as it is over a
//! half-space. This holds however large the cell is and however many faces the flat side has.

use palpate_field::scalar::AffineModel;
use palpate_field::{Aabb, Point, Vector};

use super::field::foot;
use super::{MOST_GROUPS, Solid};
use crate::tree::FAN;

/// A plane is taken if its remainder is at most this share of the other model's: its upper one is larger, at most twice.
const SHARE: f64 = 0.5;

/// Another plane is taken if the cell is at most this share as far below it.
const LESS_DEEP: f64 = 0.75;

/// A plane is looked for between a cell and at most this many faces near it.
pub(super) const MOST_FACES: usize = MOST_GROUPS * FAN;

/// The most directions in which all faces are looked at.
const MOST_DIRECTIONS: usize = 12;

/// The centre of a cell, and the field there.
pub(super) struct Middle<const D: usize> {
    pub(super) centre: Point<D>,
    /// No point of the cell is farther from the centre [m].
    pub(super) radius: f64,
    /// Of the field in the cell [m].
    pub(super) rounding: f64,
    pub(super) f: f64,
    pub(super) gradient: Vector<f64, D>,
}

impl<const N: usize, const D: usize> Solid<N, D> {
    /// A model that is at least twice as close below as another: the height over a plane square to the gradient `n` at
    /// the centre, above which no near face rises. `None` if there is none.
    ///
    /// Near is what is in a [`Region`] about the cell. Three things must hold:
    ///
    /// - All of the surface in the region is at `n·q ≤ c`.
    /// - What is in the region beyond this plane is outside.
    /// - A point of the cell above the plane is no farther from it than the region reaches beyond the cell all around,
    ///   and a point below it no farther than the region reaches along `n`.
    ///
    /// Then the field is at least `n·p − c` at each point `p` of the cell:
    ///
    /// - Outside, with `q` nearest to `p`, either `q` is in the region, and the distance is
    ///   `|p − q| ≥ n·(p − q) ≥ n·p − c`; or it is farther than the region reaches, so farther than the plane.
    /// - Inside, the way from `p` along `n` leaves the solid at the plane or before. If the surface were farther than
    ///   `c − n·p`, the end of the way would be within the solid, and in the region.
    ///
    /// No face need be nearest, and none need bound the solid: the sign changes at faces alone.
    pub(super) fn model_of_plane<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        middle: &Middle<D>,
        model: &AffineModel<M>,
    ) -> Option<AffineModel<M>> {
        let Middle { rounding, f, gradient: normal, .. } = *middle;
        let own: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        // Once for the field and once for the plane.
        let error = 2.0 * rounding + own * (1.0 + 16.0 * f64::EPSILON);
        let region = Region::along(cell, middle, normal);
        let most = (SHARE * model.lower - error).min(region.farthest + f);
        let least = (most > 0.0).then_some(f - most)?;
        let height = self.height(middle, &region, normal, least)?;
        let rise = (f - height).max(0.0);
        let is_beyond =
            f > rise + rounding || self.is_outside_beyond(middle, &region, (f - rise, normal));
        let (gradient, _) = reach(cell, normal);
        let between: f64 =
            gradient.iter().zip(model.gradient).map(|(a, b)| (a - b).abs()).sum();
        let upper = (model.upper + between) * (1.0 + 16.0 * f64::EPSILON) + rounding;
        is_beyond.then_some(AffineModel { value: f, gradient, lower: rise + error, upper })
    }

    /// The height of the centre over the plane square to a direction above which no face in a region rises [m]; `None`
    /// if it is less than `least`, or too many faces are near.
    fn height(
        &self,
        middle: &Middle<D>,
        region: &Region<D>,
        direction: Vector<f64, D>,
        least: f64,
    ) -> Option<f64> {
        let Middle { centre, .. } = *middle;
        let (mut height, mut faces) = (region.farthest, 0);
        self.surface.boxes.try_overlapping(&region.aabb, |group| {
            for (face, _) in self.surface.faces.near(group, centre, [region.reach; 2]) {
                let corners = self.surface.faces.corners(face);
                if -highest(corners, centre, direction) < height {
                    let inside = highest_within(&region.aabb, corners, centre, direction);
                    height = height.min(-inside);
                }
            }
            faces += FAN;
            // Written so that NaN is none.
            (faces <= MOST_FACES && height >= least).then_some(())
        })?;
        Some(height)
    }

    /// Whether the far end of a region along a direction is outside, and with it all of the region that is beyond a plane
    /// at this height under the centre: if no face rises above the plane, the sign is the same all over.
    fn is_outside_beyond(
        &self,
        middle: &Middle<D>,
        region: &Region<D>,
        (height, direction): (f64, Vector<f64, D>),
    ) -> bool {
        let Middle { centre, rounding, .. } = *middle;
        let end = region.end + direction * region.beyond;
        height + direction.dot(end - centre) > rounding && self.at(end, &mut None).0 > rounding
    }
}

/// What is near a cell: all that is in a ball about its centre, and in a box about it.
struct Region<const D: usize> {
    /// It holds all within the largest height of the cell's points over the plane, and the ways from them along the
    /// direction to the plane.
    aabb: Aabb<D>,
    /// The radius of the ball: the centre's distance to the surface and two radii of the cell [m].
    reach: f64,
    /// A plane may be so far from the centre [m].
    farthest: f64,
    /// The cell's last point along the direction, and how far the region goes on from there at least [m].
    end: Point<D>,
    beyond: f64,
}

impl<const D: usize> Region<D> {
    /// That for planes square to a direction.
    fn along<const M: usize>(
        cell: &[AffineModel<M>; D],
        middle: &Middle<D>,
        direction: Vector<f64, D>,
    ) -> Self {
        let Middle { centre, radius, rounding, f, .. } = *middle;
        let (sides, extent) = reach(cell, direction);
        let farthest = f.abs() + extent;
        let along = farthest + extent;
        let mut aabb = around(cell, middle, (f + extent).max(0.0));
        for k in 0..D {
            let shift = direction[k] * along * (1.0 + 16.0 * f64::EPSILON);
            aabb.min[k] += shift.min(0.0);
            aabb.max[k] += shift.max(0.0);
        }
        let end = centre
            + Vector(std::array::from_fn(|k| {
                cell[k].gradient.iter().zip(sides).map(|(x, side)| x * side.signum()).sum()
            }));
        Self {
            aabb,
            reach: f.abs() + 2.0 * radius + rounding,
            farthest,
            end,
            beyond: along.min(f.abs() + radius) * (1.0 - 1e-9),
        }
    }
}

/// A box around all points at most so far from a cell [m].
pub(super) fn around<const M: usize, const D: usize>(
    cell: &[AffineModel<M>; D],
    middle: &Middle<D>,
    grown: f64,
) -> Aabb<D> {
    let half: Vector<f64, D> = Vector(cell.map(|x| {
        let along: f64 = x.gradient.iter().map(|side| side.abs()).sum();
        (along + x.lower.max(x.upper) + grown) * (1.0 + 16.0 * f64::EPSILON)
            + 4.0 * middle.rounding
    }));
    Aabb { min: middle.centre - half, max: middle.centre + half }
}

/// A box around all nearest points of a cell's points, as a model bounds their distance.
pub(super) fn feet<const M: usize, const D: usize>(
    cell: &[AffineModel<M>; D],
    middle: &Middle<D>,
    model: &AffineModel<M>,
) -> Aabb<D> {
    let most = model.maximum().max(-model.minimum()) + middle.rounding;
    around(cell, middle, most.min(middle.f.abs() + middle.radius))
}

/// The largest height over a point, along a direction, of the part of a face that is in a box [m]; minus infinity if none
/// is.
///
/// Roundings move a cut by less than the box is wider than it need be.
pub(super) fn highest_within<const N: usize, const D: usize>(
    aabb: &Aabb<D>,
    corners: &[Point<D>; N],
    p: Point<D>,
    along: Vector<f64, D>,
) -> f64 {
    let mut part = [corners[0]; MOST_CORNERS];
    part[..N].copy_from_slice(corners);
    let mut count = N;
    for (k, side) in (0..D).flat_map(|k| [(k, -1.0), (k, 1.0)]) {
        let end = if side < 0.0 { -aabb.min[k] } else { aabb.max[k] };
        let beyond = |q: Point<D>| side * q[k] - end;
        if part[..count].iter().all(|q| beyond(*q) <= 0.0) {
            continue;
        }
        let (whole, corners) = (part, count);
        count = 0;
        for i in 0..corners {
            let (from, to) = (whole[i], whole[(i + 1) % corners]);
            let [before, after] = [from, to].map(beyond);
            if before <= 0.0 {
                part[count] = from;
                count += 1;
            }
            if (before <= 0.0) != (after <= 0.0) {
                part[count] = from + (to - from) * (before / (before - after));
                count += 1;
            }
        }
    }
    let heights = part[..count].iter().map(|q| along.dot(*q - p));
    heights.fold(f64::NEG_INFINITY, f64::max)
}

/// A triangle that is cut at the six sides of a box has at most one corner more for each; a segment that is cut counts as
/// a polygon of two sides, each cut twice at most.
const MOST_CORNERS: usize = 12;

impl<const N: usize, const D: usize> Solid<N, D> {
    /// A model by planes square to normals of near faces, for a cell that another model does not prove to be outside;
    /// `None` if there is none that says more.
    ///
    /// The plane through the nearest point need not be the one that tells. A cell beside a flat side keeps its distance
    /// from the plane of that side while an edge goes by and is nearer.
    pub(super) fn model_of_sides<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        middle: &Middle<D>,
        model: &AffineModel<M>,
    ) -> Option<AffineModel<M>> {
        let Middle { centre, radius, rounding, f, gradient, .. } = *middle;
        if f < -radius || model.minimum() > 0.0 {
            return None;
        }
        let near = Near::of(self, centre, f.abs() + 2.0 * radius + rounding)?;
        let mut directions = Directions::new();
        directions.add(cell, gradient);
        for face in near.faces() {
            directions.add(cell, self.normals.of_face(*face as usize).0);
        }
        let apart = self.apart(cell, middle, &near, &mut directions);
        if let Some(apart) = apart {
            let lower = (f - apart) * (1.0 + 4.0 * f64::EPSILON) + rounding;
            let upper = radius * (1.0 + 16.0 * f64::EPSILON) + rounding;
            return Some(AffineModel { value: f, gradient: [0.0; M], lower, upper });
        }
        let feet = feet(cell, middle, model);
        let mut directions = Directions::new();
        directions.add(cell, gradient);
        for face in near.faces() {
            let face = *face as usize;
            let corners = self.surface.faces.corners(face);
            if highest_within(&feet, corners, centre, Vector::ZERO) >= 0.0 {
                directions.add(cell, self.normals.of_face(face).0);
            }
        }
        directions.add_between(cell);
        self.model_of_side(cell, middle, model, &directions)
    }

    /// How far a cell that is outside is from each near face, along directions [m]; `None` if it may not be apart from
    /// one.
    ///
    /// Neither the size of the cell nor that of the faces matters. Where all faces are apart from the cell it holds no
    /// surface, and the sign is that of the centre.
    fn apart<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        middle: &Middle<D>,
        near: &Near,
        directions: &mut Directions<D>,
    ) -> Option<f64> {
        let Middle { centre, rounding, f, .. } = *middle;
        let mut least = (f > rounding).then_some(f)?;
        for face in near.faces() {
            let corners = self.surface.faces.corners(*face as usize);
            let mut apart = directions.apart(corners, centre, least);
            if apart <= rounding {
                let away = (centre - foot(corners, centre).point).normalized()?;
                apart = -highest(corners, centre, away) - reach(cell, away).1;
            }
            // NaN is not apart.
            least = least.min((apart > rounding).then_some(apart - rounding)?);
        }
        Some(least)
    }

    /// The height over the plane of a direction above which no near face rises, if a cell is much less far below that
    /// plane than another model says. As of [`model_of_plane`](Self::model_of_plane), what is beyond must be outside.
    fn model_of_side<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        middle: &Middle<D>,
        model: &AffineModel<M>,
        directions: &Directions<D>,
    ) -> Option<AffineModel<M>> {
        let Middle { rounding, f, .. } = *middle;
        let mut best = (LESS_DEEP * model.minimum(), None);
        for (direction, extent) in &directions.all[..directions.count] {
            let region = Region::along(cell, middle, *direction);
            let least = (best.0 + extent).max(-region.farthest);
            let height = self.height(middle, &region, *direction, least);
            if let Some(height) = height.filter(|height| height - extent > best.0) {
                best = (height - extent, Some((height, *direction, region)));
            }
        }
        let (height, direction, region) = best.1?;
        let is_beyond = if height > rounding {
            f > 0.0
        } else {
            self.is_outside_beyond(middle, &region, (height, direction))
        };
        let (gradient, _) = reach(cell, direction);
        let own: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        let between: f64 =
            gradient.iter().zip(model.gradient).map(|(a, b)| (a - b).abs()).sum();
        let upper = (model.upper + between) * (1.0 + 16.0 * f64::EPSILON) + rounding;
        let lower = (f - height).max(0.0) + 2.0 * rounding + own * (1.0 + 16.0 * f64::EPSILON);
        is_beyond.then_some(AffineModel { value: f, gradient, lower, upper })
    }
}

/// The faces near a cell.
struct Near {
    faces: [u32; MOST_FACES],
    count: usize,
}

impl Near {
    /// Those at most so far from a point [m], and perhaps some a little farther; `None` if they are too many.
    fn of<const N: usize, const D: usize>(
        solid: &Solid<N, D>,
        centre: Point<D>,
        reach: f64,
    ) -> Option<Self> {
        let mut near = Self { faces: [0; MOST_FACES], count: 0 };
        let mut walk = solid.surface.boxes.from(centre);
        while let Some(group) = walk.next(reach * reach) {
            for (face, _) in solid.surface.faces.near(group, centre, [reach; 2]) {
                *near.faces.get_mut(near.count)? = face as u32;
                near.count += 1;
            }
        }
        Some(near)
    }

    fn faces(&self) -> &[u32] {
        &self.faces[..self.count]
    }
}

/// Directions, each with how far a cell reaches along it [m]; the one that told the last face apart is the first.
struct Directions<const D: usize> {
    all: [(Vector<f64, D>, f64); MOST_DIRECTIONS],
    count: usize,
}

impl<const D: usize> Directions<D> {
    fn new() -> Self {
        let none = (Vector::ZERO, f64::INFINITY);
        Self { all: [none; MOST_DIRECTIONS], count: 0 }
    }

    /// Adds a direction, if it is another and there is room. A face without area has none.
    fn add<const M: usize>(&mut self, cell: &[AffineModel<M>; D], direction: Vector<f64, D>) {
        let is_known = |(other, _): &(Vector<f64, D>, f64)| other.dot(direction) > 1.0 - SAME;
        let has_room = self.count < MOST_DIRECTIONS && direction.dot(direction) > 0.5;
        if has_room && !self.all[..self.count].iter().any(is_known) {
            self.all[self.count] = (direction, reach(cell, direction).1);
            self.count += 1;
        }
    }

    /// Adds those between two of them: along a groove, the plane that leans on both of its sides is the closest.
    fn add_between<const M: usize>(&mut self, cell: &[AffineModel<M>; D]) {
        let first = self.count;
        for i in 0..first {
            for k in i + 1..first {
                let sum = self.all[i].0 + self.all[k].0;
                if let Some(between) = sum.normalized() {
                    self.add(cell, between);
                }
            }
        }
    }

    /// How far a face is from the cell about a point along the best direction, or along one that is enough [m].
    fn apart<const N: usize>(
        &mut self,
        corners: &[Point<D>; N],
        centre: Point<D>,
        enough: f64,
    ) -> f64 {
        let mut best = (f64::NEG_INFINITY, 0);
        for (i, (direction, extent)) in self.all[..self.count].iter().enumerate() {
            let apart = -highest(corners, centre, *direction) - extent;
            if apart > best.0 {
                best = (apart, i);
            }
            if best.0 >= enough {
                break;
            }
        }
        self.all.swap(0, best.1);
        best.0
    }
}

/// How far the sides of a cell reach along a direction, and how far all of it does from its centre [m].
fn reach<const M: usize, const D: usize>(
    cell: &[AffineModel<M>; D],
    along: Vector<f64, D>,
) -> ([f64; M], f64) {
    let (mut sides, mut extent) = ([0.0; M], 0.0);
    for (x, along) in cell.iter().zip(along.0) {
        extent += along.abs() * x.lower.max(x.upper);
        for (sum, side) in sides.iter_mut().zip(x.gradient) {
            *sum += along * side;
        }
    }
    let extent = sides.iter().fold(extent, |sum, side| sum + side.abs());
    (sides, extent)
}

/// The largest height of a face over a point, along a direction [m].
#[inline]
pub(super) fn highest<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    p: Point<D>,
    along: Vector<f64, D>,
) -> f64 {
    let heights = corners.iter().map(|corner| along.dot(*corner - p));
    heights.fold(f64::NEG_INFINITY, f64::max)
}

/// Unit vectors farther apart than this are different, as a share of one less their cosine.
const SAME: f64 = 1e-14;

/// The most different normals of a corner.
const MOST_NORMALS: usize = 3;

/// The different normals near a corner or an edge, if they are few.
pub(super) struct Corner<const D: usize> {
    normals: [Vector<f64, D>; MOST_NORMALS],
    count: usize,
    /// The least cosine between two of them.
    least: f64,
    are_few: bool,
}

impl<const D: usize> Corner<D> {
    pub(super) fn new() -> Self {
        Self { normals: [Vector::ZERO; MOST_NORMALS], count: 0, least: 1.0, are_few: true }
    }

    /// Takes a unit normal, which is known to an error.
    #[inline]
    pub(super) fn take(&mut self, normal: Vector<f64, D>, error: f64) {
        if !self.are_few {
            return;
        }
        let mut least = self.least;
        for other in &self.normals[..self.count] {
            let cosine = normal.dot(*other);
            if cosine > 1.0 - SAME {
                return;
            }
            least = least.min(cosine);
        }
        self.are_few = self.count < MOST_NORMALS && error < SAME.sqrt();
        if self.are_few {
            self.normals[self.count] = normal;
            (self.count, self.least) = (self.count + 1, least);
        }
    }

    /// How short a mean of the normals may be; zero if they are not few.
    ///
    /// With weights `wᵢ` that sum up to one, `|Σwᵢnᵢ|² ≥ κ + (1 − κ)Σwᵢ²`, where `κ` is the least cosine, and `Σwᵢ²` is
    /// at least one over their number.
    #[inline]
    pub(super) fn shortest(&self) -> f64 {
        let share = 1.0 / self.count.max(1) as f64;
        let squared = self.least + (1.0 - self.least) * share;
        // What normals that are taken for the same are apart.
        let apart = 8.0 * SAME.sqrt();
        if self.are_few { squared.max(0.0).sqrt() - apart } else { 0.0 }
    }
}
