// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Planes that bound the field of a solid over a cell.
//!
//! Beside a flat side, an edge or a corner of a solid, the field is at least the height over a plane, as it is over a
//! half-space. This holds however large the cell is and however many faces the flat side has.

use palpate_field::scalar::AffineModel;
use palpate_field::{Point, Vector};

use super::field::foot;
use super::{MOST_GROUPS, Solid};
use crate::tree::FAN;

/// A plane is taken if its remainder is at most this share of the other model's: its upper one is larger, at most twice.
const SHARE: f64 = 0.5;

/// How far beyond the nearest point it is asked on which side of the surface the plane's far side is, in radii of the
/// cell. The faces within two radii are known.
const BEYOND: f64 = 1.5;

/// Another plane is taken if the cell is at most this share as far below it.
const LESS_DEEP: f64 = 0.75;

/// A plane is looked for between a cell and at most this many faces near it.
const MOST_FACES: usize = MOST_GROUPS * FAN;

/// The most directions in which all faces are looked at.
const MOST_DIRECTIONS: usize = 8;

/// The centre of a cell, and the field there.
pub(super) struct Middle<const D: usize> {
    pub(super) centre: Point<D>,
    /// No point of the cell is farther from the centre [m].
    pub(super) radius: f64,
    /// Of the field in the cell [m].
    pub(super) rounding: f64,
    pub(super) f: f64,
    pub(super) gradient: Vector<f64, D>,
    /// The nearest point of the surface.
    pub(super) foot: Point<D>,
}

impl<const N: usize, const D: usize> Solid<N, D> {
    /// A model that is at least twice as close below as another: the height over a plane square to the gradient `n` at
    /// the centre, above which no near face rises. `None` if there is none.
    ///
    /// Near is what is in the ball `B` about the centre whose radius is `|f|` there and two radii of the cell. Let all
    /// of the surface in `B` be at `n·q ≤ c`, and what is in `B` beyond this plane be outside. Then the field is at least
    /// `n·p − c` at each point `p` of the cell:
    ///
    /// - Outside, with `q` nearest to `p`, the distance is `|p − q| ≥ n·(p − q) ≥ n·p − c`.
    /// - Inside, the way from `p` along `n` leaves the solid at the plane or before. If the surface were farther than
    ///   `c − n·p`, the end of the way would be within the solid, and in `B`.
    ///
    /// No face need be nearest, and none need bound the solid: the sign changes at faces alone.
    pub(super) fn model_of_plane<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        middle: &Middle<D>,
        model: &AffineModel<M>,
    ) -> Option<AffineModel<M>> {
        let Middle { radius, rounding, f, gradient: normal, foot, .. } = *middle;
        let (gradient, _) = reach(cell, normal);
        let own: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        // Once for the field and once for the plane.
        let error = 2.0 * rounding + own * (1.0 + 16.0 * f64::EPSILON);
        let most = (SHARE * model.lower - error).min(radius);
        let rise = (most > 0.0).then(|| self.rise(middle, most)).flatten()?;
        let is_beyond = f > rise + rounding || {
            let beyond = foot + normal * (BEYOND * radius);
            self.at(beyond, &mut None).0 > rounding
        };
        let between: f64 =
            gradient.iter().zip(model.gradient).map(|(a, b)| (a - b).abs()).sum();
        let upper = (model.upper + between) * (1.0 + 16.0 * f64::EPSILON) + rounding;
        is_beyond.then_some(AffineModel { value: f, gradient, lower: rise + error, upper })
    }

    /// How far the near faces rise above the plane through the nearest point of the surface, square to the gradient [m];
    /// `None` if that is more than `most`, or there are too many.
    fn rise(&self, middle: &Middle<D>, most: f64) -> Option<f64> {
        let Middle { centre, radius, rounding, f, gradient, .. } = *middle;
        let reach = f.abs() + 2.0 * radius + rounding;
        let (mut rise, mut groups) = (0.0_f64, 0);
        let mut walk = self.surface.boxes.from(centre);
        while let Some(group) = walk.next(reach * reach) {
            groups += 1;
            for (face, _) in self.surface.faces.near(group, centre, [reach; 2]) {
                let corners = self.surface.faces.corners(face);
                rise = rise.max(f + highest(corners, centre, gradient));
            }
            // Written so that NaN is none.
            if !(groups <= MOST_GROUPS && rise <= most) {
                return None;
            }
        }
        (rise <= most).then_some(rise)
    }
}

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
        self.model_of_side(cell, middle, model, (&near, &directions))
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
        (near, directions): (&Near, &Directions<D>),
    ) -> Option<AffineModel<M>> {
        let Middle { centre, radius, rounding, f, .. } = *middle;
        // Many directions are those of a curved side, where none tells more.
        if directions.count == MOST_DIRECTIONS {
            return None;
        }
        let mut best = (LESS_DEEP * model.minimum(), None);
        for (direction, extent) in &directions.all[..directions.count] {
            let mut height = f64::INFINITY;
            for face in near.faces() {
                let corners = self.surface.faces.corners(*face as usize);
                height = height.min(-highest(corners, centre, *direction));
                if height - extent <= best.0 {
                    break;
                }
            }
            if height - extent > best.0 {
                best = (height - extent, Some((height, *direction)));
            }
        }
        let (height, direction) = best.1?;
        let is_beyond = if height > rounding {
            f > 0.0
        } else {
            let far = 0.5 * radius - height;
            let is_near = far <= f.abs() + BEYOND * radius;
            is_near && self.at(centre + direction * far, &mut None).0 > rounding
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
