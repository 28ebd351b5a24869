// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many points at once: slices and arrays with strides, through whole blocks.

use super::Shape;
use crate::machine::{BLOCK, Block, Column, Gradients, Wide, wide};
use crate::scalar::Float;
use crate::strided::{Strided, StridedMut};
use crate::vector::{Point, Vector, array, unrolled};

impl<const D: usize> Shape<D> {
    /// The signed distances at `points` [m].
    ///
    /// Points are evaluated in blocks; the bits are those of
    /// [`distance`](Self::distance).
    ///
    /// # Panics
    ///
    /// If `distances` is not as long as `points`.
    pub fn distances(&self, points: &[Point<D>], distances: &mut [f64]) {
        assert_eq!(points.len(), distances.len(), "one distance for each point");
        self.in_chunks(points, distances);
    }

    /// The signed distances at `points` [m] and their gradients.
    ///
    /// The bits are those of [`distance_gradient`](Self::distance_gradient).
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let points = [[0.0, 2.0], [-5.0, 0.0]].map(Vector);
    /// let (mut distances, mut gradients) = ([0.0; 2], [Vector::ZERO; 2]);
    /// Shape::circle(1.0)?.distances_gradients(&points, &mut distances, &mut gradients);
    /// assert_eq!(distances, [1.0, 4.0]);
    /// assert_eq!(gradients, [Vector([0.0, 1.0]), Vector([-1.0, 0.0])]);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Panics
    ///
    /// If `distances` or `gradients` is not as long as `points`.
    pub fn distances_gradients(
        &self,
        points: &[Point<D>],
        distances: &mut [f64],
        gradients: &mut [Vector<f64, D>],
    ) {
        assert_eq!(points.len(), distances.len(), "one distance for each point");
        assert_eq!(points.len(), gradients.len(), "one gradient for each point");
        self.gradients_in_chunks(points, distances, gradients);
    }

    /// As [`distances`](Self::distances) at points in single precision, each number rounded once: the
    /// bits of [`distance_f32`](Self::distance_f32).
    ///
    /// # Panics
    ///
    /// If `distances` is not as long as `points`.
    pub fn distances_f32(&self, points: &[Vector<f32, D>], distances: &mut [f32]) {
        assert_eq!(points.len(), distances.len(), "one distance for each point");
        self.in_chunks(points, distances);
    }

    /// As [`distances_gradients`](Self::distances_gradients) at points in single precision, each number
    /// rounded once: the bits of [`distance_gradient_f32`](Self::distance_gradient_f32).
    ///
    /// # Panics
    ///
    /// If `distances` or `gradients` is not as long as `points`.
    pub fn distances_gradients_f32(
        &self,
        points: &[Vector<f32, D>],
        distances: &mut [f32],
        gradients: &mut [Vector<f32, D>],
    ) {
        assert_eq!(points.len(), distances.len(), "one distance for each point");
        assert_eq!(points.len(), gradients.len(), "one gradient for each point");
        self.gradients_in_chunks(points, distances, gradients);
    }

    /// The signed distances at points in an array with strides [m], in `f64` or `f32`, with
    /// the bits of the call for one point.
    ///
    /// ```
    /// use palpate_field::{Layout, Shape, Strided, StridedMut};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// // One array for x and one for y, as columns of a table have them.
    /// let coordinates = [0.0, 3.0, 2.0, 4.0];
    /// let layout = Layout { start: 0, rows: 2, row_stride: 1, column_stride: 2 };
    /// let points = Strided::new(&coordinates, layout)?;
    /// let mut out = [0.0; 2];
    /// let distances = StridedMut::new(&mut out, Layout::contiguous(2, 1))?;
    /// Shape::circle(1.0)?.distances_strided(points, distances);
    /// assert_eq!(out, [1.0, 4.0]);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Panics
    ///
    /// If `distances` has not as many rows as `points`.
    pub fn distances_strided<T: Float>(
        &self,
        points: Strided<'_, T, D>,
        mut distances: StridedMut<'_, T, 1>,
    ) {
        assert_eq!(points.rows(), distances.rows(), "one distance for each point");
        self.each(
            points.rows(),
            |i| Vector(points.row(i)),
            |i, distance| distances.set_row(i, [distance]),
        );
    }

    /// The signed distances [m] and gradients at points in an array with strides, in `f64`
    /// or `f32`, with the bits of the call for one point.
    ///
    /// # Panics
    ///
    /// If `distances` or `gradients` has not as many rows as `points`.
    pub fn distances_gradients_strided<T: Float>(
        &self,
        points: Strided<'_, T, D>,
        mut distances: StridedMut<'_, T, 1>,
        mut gradients: StridedMut<'_, T, D>,
    ) {
        assert_eq!(points.rows(), distances.rows(), "one distance for each point");
        assert_eq!(points.rows(), gradients.rows(), "one gradient for each point");
        let point = |i| Vector(points.row(i));
        self.each_gradient(points.rows(), point, |i, distance, gradient| {
            distances.set_row(i, [distance]);
            gradients.set_row(i, gradient.0);
        });
    }

    /// The distances at points, as many in each number type.
    fn in_chunks<T: Float>(&self, points: &[Vector<T, D>], distances: &mut [T]) {
        let (mut block, mut column) = (Block::scratch(), Column::scratch());
        let chunks = points.chunks(BLOCK).zip(distances.chunks_mut(BLOCK));
        for (points, distances) in chunks {
            wide(Gather { points, block: &mut block });
            self.block_distances(&block, points.len(), &mut column);
            wide(Scatter { column: &column, numbers: distances });
        }
    }

    /// As [`in_chunks`](Self::in_chunks), with gradients.
    fn gradients_in_chunks<T: Float>(
        &self,
        points: &[Vector<T, D>],
        distances: &mut [T],
        gradients: &mut [Vector<T, D>],
    ) {
        let (mut block, mut answers) = (Block::scratch(), Gradients::scratch());
        let out = distances.chunks_mut(BLOCK).zip(gradients.chunks_mut(BLOCK));
        for (points, (distances, gradients)) in points.chunks(BLOCK).zip(out) {
            wide(Gather { points, block: &mut block });
            self.block_gradients(&block, points.len(), &mut answers);
            wide(Scatter { column: &answers.distance, numbers: distances });
            let columns = answers.gradient.columns().map(Column::<f64>::as_slice);
            wide(ScatterVectors { columns, vectors: gradients });
        }
    }

    /// Gives `put` the distance at each of `count` points, block by block.
    #[inline(always)]
    fn each<T: Float>(
        &self,
        count: usize,
        point: impl Fn(usize) -> Vector<T, D>,
        mut put: impl FnMut(usize, T),
    ) {
        let mut block = Block::scratch();
        let mut column = Column::scratch();
        for first in (0..count).step_by(BLOCK) {
            let lanes = BLOCK.min(count - first);
            block.fill(lanes, |lane| in_double(point(first + lane)));
            self.block_distances(&block, lanes, &mut column);
            (0..lanes).for_each(|lane| put(first + lane, T::constant(column.get(lane))));
        }
    }

    /// As [`each`](Self::each), with gradients.
    #[inline(always)]
    fn each_gradient<T: Float>(
        &self,
        count: usize,
        point: impl Fn(usize) -> Vector<T, D>,
        mut put: impl FnMut(usize, T, Vector<T, D>),
    ) {
        let mut block = Block::scratch();
        let mut answers = Gradients::scratch();
        for first in (0..count).step_by(BLOCK) {
            let lanes = BLOCK.min(count - first);
            block.fill(lanes, |lane| in_double(point(first + lane)));
            self.block_gradients(&block, lanes, &mut answers);
            for lane in 0..lanes {
                let gradient = Vector::of(&answers.gradient.get(lane).0);
                put(first + lane, T::constant(answers.distance.get(lane)), gradient);
            }
        }
    }
}

/// Puts points into a block.
struct Gather<'a, T, const D: usize> {
    points: &'a [Vector<T, D>],
    block: &'a mut Block<f64, D>,
}

impl<T: Float, const D: usize> Wide for Gather<'_, T, D> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Self { points, block } = self;
        // The compiler makes better code where it knows the count.
        match points.len() {
            BLOCK => gather(BLOCK, points, block),
            count => gather(count, points, block),
        }
    }
}

#[inline(always)]
fn gather<T: Float, const D: usize>(
    count: usize,
    points: &[Vector<T, D>],
    block: &mut Block<f64, D>,
) {
    let points = &points[..count];
    block.fill(count, |i| in_double(points[i]));
}

/// Takes the numbers of a column.
struct Scatter<'a, T> {
    column: &'a Column<f64>,
    numbers: &'a mut [T],
}

impl<T: Float> Wide for Scatter<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for (number, answer) in self.numbers.iter_mut().zip(self.column.as_slice()) {
            *number = T::constant(*answer);
        }
    }
}

/// Takes vectors whose components are columns.
struct ScatterVectors<'a, T, const D: usize> {
    columns: [&'a [f64]; D],
    vectors: &'a mut [Vector<T, D>],
}

impl<T: Float, const D: usize> Wide for ScatterVectors<'_, T, D> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Self { columns, vectors } = self;
        match vectors.len() {
            BLOCK => scatter(BLOCK, columns, vectors),
            count => scatter(count, columns, vectors),
        }
    }
}

#[inline(always)]
fn scatter<T: Float, const D: usize>(
    count: usize,
    columns: [&[f64]; D],
    vectors: &mut [Vector<T, D>],
) {
    let (columns, vectors) = (columns.map(|column| &column[..count]), &mut vectors[..count]);
    for i in 0..count {
        unrolled!(k < D => vectors[i].0[k] = T::constant(columns[k][i]));
    }
}

/// A point in double precision.
#[inline(always)]
fn in_double<T: Float, const D: usize>(p: Vector<T, D>) -> Point<D> {
    Vector(array!(k < D => p.0[k].to_f64()))
}
