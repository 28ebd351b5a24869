// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Faces, and the distance to the nearest of them.

use palpate_field::scalar::AffineModel;
use palpate_field::{Point, Vector, Wide, wide};

use super::boxes::Boxes;
use super::faces::Faces;
use super::foot::{Foot, Part, foot};

/// The rounding of a nearest point and of its distance, as a share of coordinates and of the size of all faces.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A model looks at so many groups of eight faces at most: a cell near more is large.
pub(super) const MOST_GROUPS: usize = 32;

/// Faces in the order of their boxes.
#[derive(Clone, Debug)]
pub(super) struct Surface<const N: usize, const D: usize> {
    pub(super) faces: Faces<N, D>,
    pub(super) boxes: Boxes<D>,
}

impl<const N: usize, const D: usize> Surface<N, D> {
    /// Of faces in the order of the tree.
    pub(super) fn new(faces: &[[Point<D>; N]]) -> Self {
        Self { faces: Faces::new(faces), boxes: Boxes::new(faces) }
    }

    /// The face nearest to a point, in the order of the boxes, and its nearest point.
    ///
    /// `known` is a point of the surface, if there is one: its distance bounds the search, and the nearer it is, the
    /// shorter is the search.
    pub(super) fn nearest(&self, p: Point<D>, known: Option<Point<D>>) -> (usize, Foot<D>) {
        let least = known.map_or(f64::INFINITY, |known| {
            // Its face must still be found, whose nearest point is rounded too.
            let rounding = ROUNDING * (p.norm() + known.norm() + self.faces.size());
            ((p - known).norm() * (1.0 + ROUNDING) + rounding).powi(2)
        });
        wide(Nearest { surface: self, p, least })
    }

    /// A model of the distance to the nearest face over a cell that no face meets, from the face nearest to its centre,
    /// the distance there, and the unit vector away from the nearest point; `None` if too many faces may be nearest
    /// somewhere in it.
    ///
    /// The distance to each face is convex. So it is at least its tangent plane, and the nearest face's is
    /// largest, above a plane, at a corner of the cell.
    pub(super) fn model_of_distance<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        (face, distance, away): (usize, f64, Vector<f64, D>),
        radius: f64,
        rounding: f64,
    ) -> Option<AffineModel<M>> {
        let centre = Vector(cell.map(|x| x.value));
        let nearest = self.faces.corners(face);
        let to_nearest = |p: [f64; D]| foot(nearest, Vector(p)).squared.sqrt();
        let mut model = AffineModel::tangent(distance, away.0, to_nearest, cell, rounding);
        let own = model.lower;
        // How far the cell's own remainders move the planes apart.
        let remainders: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        let farthest = distance + 2.0 * radius + rounding;
        let mut groups = 0;
        let mut walk = self.boxes.from(centre);
        while let Some(group) = walk.next(farthest * farthest) {
            groups += 1;
            // A model no narrower than that of the Lipschitz constant is not worth the search.
            if groups > MOST_GROUPS || model.lower + model.upper > 2.0 * radius {
                return None;
            }
            self.faces.within(group, centre, farthest, |found, far| {
                let between = away - (centre - found.point) * (1.0 / far);
                let apart: f64 = (0..M)
                    .map(|k| {
                        (0..D).map(|i| between[i] * cell[i].gradient[k]).sum::<f64>().abs()
                    })
                    .sum();
                model.lower = model.lower.max(own + distance - far + apart + 2.0 * remainders);
            });
        }
        Some(model)
    }
}

/// The search of the nearest face.
struct Nearest<'a, const N: usize, const D: usize> {
    surface: &'a Surface<N, D>,
    p: Point<D>,
    /// The square of the distance is known to be less [m²].
    least: f64,
}

impl<const N: usize, const D: usize> Wide for Nearest<'_, N, D> {
    type Out = (usize, Foot<D>);

    #[inline(always)]
    fn run(self) -> (usize, Foot<D>) {
        let Self { surface: Surface { faces, boxes }, p, least } = self;
        let mut nearest = (0, Foot { point: p, part: Part::Corner(0), squared: least });
        let mut walk = boxes.from(p);
        while let Some(group) = walk.next(nearest.1.squared) {
            faces.nearer(group, p, &mut nearest);
        }
        if nearest.1.squared < least { nearest } else { (0, foot(faces.corners(0), p)) }
    }
}
