// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Planar shapes in space, where they are endless along z.

use std::any::Any;

use super::Shape;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::field::CustomField;
use crate::machine::BLOCK;
use crate::promise::Promise;
use crate::vector::{Point, Vector};

impl Shape<2> {
    /// This shape in space, endless along z: at each point the value and the gradient of this shape
    /// at the point's x and y, to the bit. Along z the gradient is zero.
    ///
    /// It promises all that this shape promises, but it has no bounds. Bounds of this shape's part of
    /// the plane are those of [`SpaceShape`].
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let pipe = Shape::circle(0.5)?.endless();
    /// let (distance, gradient) = pipe.distance_gradient([2.0, 0.0, 70.0]);
    /// assert_eq!((distance, gradient), (1.5, Vector([1.0, 0.0, 0.0])));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn endless(self) -> Shape<3> {
        endless(self)
    }
}

/// The shape in space, endless along the axes that it lacks.
fn endless<const D: usize>(flat: Shape<D>) -> Shape<3> {
    let of = *flat.promise();
    let promise = Promise {
        outside: of.outside,
        inside: of.inside,
        lipschitz: of.lipschitz,
        // The steepness is known in a cylinder, of which this is a part.
        region: of.region.map(|ball| ball_in_space(&ball)),
        bounds: None,
        above_bounds: of.above_bounds,
        convex: of.convex,
        symmetric: std::array::from_fn(|axis| of.symmetric.get(axis).copied().unwrap_or(true)),
        has_interior: of.has_interior,
        reach: of.reach,
        rounding: of.rounding,
        deviation: of.deviation,
    };
    Shape::custom(Endless { flat, promise })
}

/// A shape of fewer dimensions, endless along those that it lacks.
#[derive(Debug)]
struct Endless<const D: usize> {
    flat: Shape<D>,
    promise: Promise<3>,
}

impl<const D: usize> CustomField<3> for Endless<D> {
    fn distance(&self, p: Point<3>) -> f64 {
        self.flat.distance(p.truncated::<D>())
    }

    fn distance_gradient(&self, p: Point<3>) -> (f64, Vector<f64, 3>) {
        let (distance, gradient) = self.flat.distance_gradient(p.truncated::<D>());
        (distance, gradient.in_space())
    }

    fn distances(&self, points: &[Point<3>], distances: &mut [f64]) {
        let mut flat = [Vector::ZERO; BLOCK];
        for (points, distances) in points.chunks(BLOCK).zip(distances.chunks_mut(BLOCK)) {
            self.flat.distances(flattened(points, &mut flat), distances);
        }
    }

    fn distances_gradients(
        &self,
        points: &[Point<3>],
        distances: &mut [f64],
        gradients: &mut [Vector<f64, 3>],
    ) {
        let (mut flat, mut slopes) = ([Vector::ZERO; BLOCK], [Vector::ZERO; BLOCK]);
        let answers = distances.chunks_mut(BLOCK).zip(gradients.chunks_mut(BLOCK));
        for (points, (distances, gradients)) in points.chunks(BLOCK).zip(answers) {
            let slopes = &mut slopes[..points.len()];
            self.flat.distances_gradients(flattened(points, &mut flat), distances, slopes);
            for (gradient, slope) in gradients.iter_mut().zip(slopes) {
                *gradient = slope.in_space();
            }
        }
    }

    fn promise(&self) -> &Promise<3> {
        &self.promise
    }

    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        self.flat.content(sink)
    }
}

/// The first coordinates of the points, in `flat`.
fn flattened<'a, const D: usize>(
    points: &[Point<3>],
    flat: &'a mut [Point<D>; BLOCK],
) -> &'a [Point<D>] {
    for (flat, point) in flat.iter_mut().zip(points) {
        *flat = point.truncated();
    }
    &flat[..points.len()]
}

fn ball_in_space<const D: usize>(ball: &BoundingBall<D>) -> BoundingBall<3> {
    BoundingBall { centre: ball.centre.in_space(), radius: ball.radius }
}

/// A shape in space: one of space, or a planar one, which is endless along z.
///
/// ```
/// use palpate_field::{Shape, SpaceShape};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let disc = SpaceShape::from(Shape::circle(0.5)?);
/// assert!(disc.is_endless() && disc.shape().promise().bounds.is_none());
/// assert_eq!(disc.bounds().map(|bounds| bounds.aabb.max.0), Some([0.5, 0.5, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SpaceShape {
    shape: Shape<3>,
    /// The planar shape that is endless.
    flat: Option<Shape<2>>,
}

impl SpaceShape {
    /// The shape in space.
    #[must_use]
    pub fn shape(&self) -> &Shape<3> {
        &self.shape
    }

    /// The planar shape; `None` for a shape of space.
    #[must_use]
    pub fn flat(&self) -> Option<&Shape<2>> {
        self.flat.as_ref()
    }

    /// Whether the shape is a planar one.
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.flat.is_some()
    }

    /// As [`Shape::prepare`].
    pub fn prepare(&self) {
        self.shape.prepare();
        self.flat.iter().for_each(Shape::prepare);
    }

    /// Bounds of a shape of space, or of a planar shape's part of the plane z = 0; `None` if it has
    /// none.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds<3>> {
        let Some(flat) = &self.flat else { return self.shape.promise().bounds };
        flat.promise().bounds.map(|bounds| Bounds {
            aabb: bounds.aabb.in_space(),
            ball: ball_in_space(&bounds.ball),
        })
    }
}

impl<const D: usize> Aabb<D> {
    /// The same box in space: one of the plane lies in the plane z = 0.
    #[must_use]
    pub fn in_space(&self) -> Aabb<3> {
        Aabb { min: self.min.in_space(), max: self.max.in_space() }
    }
}

impl<const D: usize> From<Shape<D>> for SpaceShape {
    fn from(shape: Shape<D>) -> Self {
        let any: &dyn Any = &shape;
        if let Some(shape) = any.downcast_ref::<Shape<3>>() {
            return Self { shape: shape.clone(), flat: None };
        }
        let flat = any.downcast_ref::<Shape<2>>().cloned();
        Self { shape: endless(shape), flat }
    }
}

impl<const D: usize> From<&Shape<D>> for SpaceShape {
    fn from(shape: &Shape<D>) -> Self {
        shape.clone().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_endless_shape_answers_as_its_cross_section() {
        let star = Shape::circle(0.5).unwrap() - Shape::rectangle([0.2, 2.0]).unwrap();
        let endless = star.clone().endless();
        let points: Vec<Point<3>> = (0..150)
            .map(|i| {
                let t = f64::from(i);
                Vector([libm::sin(t), libm::cos(1.7 * t), 3.0 * libm::sin(0.3 * t)])
            })
            .collect();
        let mut distances = vec![0.0; points.len()];
        let mut gradients = vec![Vector::ZERO; points.len()];
        endless.distances_gradients(&points, &mut distances, &mut gradients);
        let mut alone = vec![0.0; points.len()];
        endless.distances(&points, &mut alone);
        assert_eq!(alone, distances);
        for (point, (distance, gradient)) in points.iter().zip(distances.iter().zip(&gradients))
        {
            let (flat, slope) = star.distance_gradient(point.truncated::<2>());
            assert_eq!((flat, slope.in_space()), (*distance, *gradient));
            assert_eq!((flat, slope.in_space()), endless.distance_gradient(*point));
            assert_eq!(gradient[2].to_bits(), 0);
        }
        let (flat, promise) = (star.promise(), endless.promise());
        assert_eq!((promise.outside, promise.inside), (flat.outside, flat.inside));
        assert_eq!(promise.lipschitz.to_bits(), flat.lipschitz.to_bits());
        assert_eq!(promise.bounds, None);
    }
}
