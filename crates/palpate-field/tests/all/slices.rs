// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Slices and arrays with strides have the bits of calls for one point.

use palpate_field::{Layout, Point, Shape, ShapeError, Strided, StridedMut, Vector};

fn shape() -> Result<Shape<3>, ShapeError> {
    let bowl = Shape::sphere(0.4)?.shell(0.05)? & Shape::half_space([0.0, 1.0, 0.1], 0.1)?;
    let feet = (0..9_u32).map(|i| {
        Shape::cuboid([0.1, 0.2, 0.15])?.translated([
            0.3 * f64::from(i % 3) - 0.3,
            -0.4,
            0.35 * f64::from(i / 3) - 0.3,
        ])
    });
    Ok(bowl | Shape::union(feet.collect::<Result<Vec<_>, _>>()?)?)
}

/// Points of which no two are alike.
fn points(count: usize) -> Vec<Point<3>> {
    let spiral = |i: usize| {
        let t = 0.37 * i as f64;
        Vector([0.05 * t * t.cos(), 0.03 * t - 0.6, 0.04 * t * t.sin()])
    };
    (0..count).map(spiral).collect()
}

/// How many points: none, one, blocks that are full and that are not.
const COUNTS: [usize; 6] = [0, 1, 63, 64, 65, 150];

#[test]
fn slices_have_the_bits_of_points() -> Result<(), ShapeError> {
    let shape = shape()?;
    for count in COUNTS {
        let points = points(count);
        let mut distances = vec![0.0; count];
        shape.distances(&points, &mut distances);
        let (mut again, mut gradients) = (vec![0.0; count], vec![Vector::ZERO; count]);
        shape.distances_gradients(&points, &mut again, &mut gradients);
        for (i, p) in points.iter().enumerate() {
            assert_eq!(distances[i].to_bits(), shape.distance(*p).to_bits());
            assert_eq!((again[i], gradients[i]), shape.distance_gradient(*p));
        }
    }
    Ok(())
}

#[test]
fn slices_in_single_precision_have_the_bits_of_points() -> Result<(), ShapeError> {
    let shape = shape()?;
    for count in COUNTS {
        let single = |p: Point<3>| Vector(p.0.map(|x| x as f32));
        let points: Vec<_> = points(count).into_iter().map(single).collect();
        let mut distances = vec![0.0; count];
        shape.distances_f32(&points, &mut distances);
        let (mut again, mut gradients) = (vec![0.0; count], vec![Vector([0.0; 3]); count]);
        shape.distances_gradients_f32(&points, &mut again, &mut gradients);
        for (i, p) in points.iter().enumerate() {
            assert_eq!(distances[i].to_bits(), shape.distance_f32(*p).to_bits());
            assert_eq!((again[i], gradients[i]), shape.distance_gradient_f32(*p));
        }
    }
    Ok(())
}

#[test]
fn arrays_with_strides_have_the_bits_of_points() -> Result<(), ShapeError> {
    let shape = shape()?;
    for count in COUNTS {
        let points = points(count);
        // Backwards, four numbers a row, and the coordinates from z to x.
        let mut data = vec![f64::NAN; 4 * count];
        for (i, p) in points.iter().enumerate() {
            let row = 4 * (count - 1 - i);
            data[row..row + 3].copy_from_slice(&[p[2], p[1], p[0]]);
        }
        let start = (4 * count).saturating_sub(2);
        let layout = Layout { start, rows: count, row_stride: -4, column_stride: -1 };
        let rows = Strided::new(&data, layout)?;
        // Distance and gradient side by side in one row each.
        let (mut alone, mut distances) = (vec![0.0; count], vec![0.0; 2 * count]);
        let mut gradients = vec![0.0; 3 * count];
        let every_other = Layout { start: 0, rows: count, row_stride: 2, column_stride: 1 };
        let columns =
            Layout { start: 0, rows: count, row_stride: 1, column_stride: count.cast_signed() };
        let contiguous = Layout::contiguous(count, 1);
        shape.distances_strided(rows, StridedMut::new(&mut alone, contiguous)?);
        shape.distances_gradients_strided(
            rows,
            StridedMut::new(&mut distances, every_other)?,
            StridedMut::new(&mut gradients, columns)?,
        );
        for (i, p) in points.iter().enumerate() {
            let gradient = Vector([0, 1, 2].map(|k| gradients[i + k * count]));
            assert_eq!(alone[i].to_bits(), shape.distance(*p).to_bits());
            assert_eq!((distances[2 * i], gradient), shape.distance_gradient(*p));
        }
    }
    Ok(())
}

#[test]
fn strides_may_go_back_and_skip() -> Result<(), ShapeError> {
    let data = [0, 1, 2, 3, 4, 5, 6, 7];
    let layout = Layout { start: 7, rows: 2, row_stride: -4, column_stride: -2 };
    let table = Strided::<_, 2>::new(&data, layout)?;
    assert_eq!([table.row(0), table.row(1)], [[7, 5], [3, 1]]);
    Ok(())
}

#[test]
fn numbers_outside_the_slice_are_refused() {
    let fits = |start, rows, row_stride, column_stride| {
        let layout = Layout { start, rows, row_stride, column_stride };
        Strided::<_, 3>::new(&[0.0; 12], layout).is_ok()
    };
    assert!(fits(0, 4, 3, 1));
    assert!(!fits(1, 4, 3, 1));
    assert!(!fits(0, 5, 3, 1));
    assert!(fits(11, 4, -3, -1));
    assert!(!fits(10, 4, -3, -1));
    assert!(!fits(0, 4, isize::MAX, isize::MAX));
    assert!(fits(99, 0, 1, 1));
}
