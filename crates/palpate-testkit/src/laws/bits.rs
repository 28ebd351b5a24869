// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scalar calls and blocks agree bit for bit.

use palpate_field::{BLOCK, Block, Column, Gradients, Point, Shape, Vector};

/// Blocks of `points` have the bits of the scalar call, values alone and with gradients, and answers in
/// single precision are those in double precision, rounded once. Uses only the first [`BLOCK`] points.
///
/// # Errors
///
/// Says which way differs, and where.
pub fn bits_agree<const D: usize>(shape: &Shape<D>, points: &[Point<D>]) -> Result<(), String> {
    let points = &points[..points.len().min(BLOCK)];
    let count = points.len();
    let mut block = Block::zero();
    points.iter().enumerate().for_each(|(i, p)| block.set(i, *p));
    let (mut values, mut slopes) = (Column::zero(), Gradients::zero());
    shape.block_distances(&block, count, &mut values);
    shape.block_gradients(&block, count, &mut slopes);

    let single = |p: &Point<D>| Vector(p.0.map(|x| x as f32));
    let singles: Vec<_> = points.iter().map(single).collect();
    let mut single_values = vec![0.0_f32; count];
    let mut single_slopes = (vec![0.0_f32; count], vec![Vector([0.0_f32; D]); count]);
    shape.distances_f32(&singles, &mut single_values);
    shape.distances_gradients_f32(&singles, &mut single_slopes.0, &mut single_slopes.1);

    for (i, p) in points.iter().enumerate() {
        let f = shape.distance(*p);
        let (with, g) = shape.distance_gradient(*p);
        same("value with gradient", *p, f, with)?;
        same("block value", *p, f, values.get(i))?;
        same("block value with gradient", *p, f, slopes.distance.get(i))?;
        for k in 0..D {
            same("block gradient", *p, g[k], slopes.gradient.get(i)[k])?;
        }
        let (f, g) = shape.distance_gradient(Vector(singles[i].0.map(f64::from)));
        let rounded = |x: f64| f64::from(x as f32);
        let (with, slope) = shape.distance_gradient_f32(singles[i]);
        same("single value", *p, rounded(f), shape.distance_f32(singles[i]).into())?;
        same("single value with gradient", *p, rounded(f), with.into())?;
        same("value in a single slice", *p, rounded(f), single_values[i].into())?;
        same(
            "value with gradient in a single slice",
            *p,
            rounded(f),
            single_slopes.0[i].into(),
        )?;
        for k in 0..D {
            same("single gradient", *p, rounded(g[k]), slope[k].into())?;
            let slope = single_slopes.1[i][k];
            same("gradient in a single slice", *p, rounded(g[k]), slope.into())?;
        }
    }
    Ok(())
}

fn same<const D: usize>(
    what: &str,
    p: Point<D>,
    scalar: f64,
    other: f64,
) -> Result<(), String> {
    if scalar.to_bits() == other.to_bits() {
        return Ok(());
    }
    Err(format!(
        "{what} {other:e} ({:x}), scalar {scalar:e} ({:x}), at {p:?}",
        other.to_bits(),
        scalar.to_bits()
    ))
}
