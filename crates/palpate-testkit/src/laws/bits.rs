// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scalar calls and blocks agree bit for bit.

use palpate_field::{BLOCK, Block, Column, Gradients, Point, SHORT, Shape, Vector};

/// Every way to evaluate `points` gives the bits of the scalar call: blocks of [`BLOCK`] and
/// [`SHORT`], values alone and with gradients, in both precisions. Uses only the first
/// [`BLOCK`] points.
///
/// # Errors
///
/// Says which way differs, and where.
pub fn bits_agree<const D: usize>(shape: &Shape<D>, points: &[Point<D>]) -> Result<(), String> {
    let points = &points[..points.len().min(BLOCK)];
    let mut long = Block::<f64, D, BLOCK>::zero();
    let mut single = Block::<f32, D, BLOCK>::zero();
    for (i, p) in points.iter().enumerate() {
        long.set(i, *p);
        single.set(i, Vector(p.0.map(|x| x as f32)));
    }
    let count = points.len();

    let mut values = Column::<f64, BLOCK>::zero();
    let mut slopes = Gradients::<f64, D, BLOCK>::zero();
    shape.block_distances(&long, count, &mut values);
    shape.block_gradients(&long, count, &mut slopes);
    let mut values32 = Column::<f32, BLOCK>::zero();
    let mut slopes32 = Gradients::<f32, D, BLOCK>::zero();
    shape.block_distances(&single, count, &mut values32);
    shape.block_gradients(&single, count, &mut slopes32);

    for (i, p) in points.iter().enumerate() {
        let f = shape.distance(*p);
        let (with, g) = shape.distance_gradient(*p);
        same("value with gradient", *p, f, with)?;
        same("block value", *p, f, values.get(i))?;
        same("block value with gradient", *p, f, slopes.distance.get(i))?;
        let q = single.get(i);
        let f32 = shape.distance_f32(q);
        let (with32, g32) = shape.distance_gradient_f32(q);
        same("single value with gradient", *p, f32.into(), with32.into())?;
        same("single block value", *p, f32.into(), values32.get(i).into())?;
        same(
            "single block value with gradient",
            *p,
            f32.into(),
            slopes32.distance.get(i).into(),
        )?;
        for k in 0..D {
            same("block gradient", *p, g[k], slopes.gradient.get(i)[k])?;
            let block = slopes32.gradient.get(i)[k];
            same("single block gradient", *p, g32[k].into(), block.into())?;
        }
    }
    for chunk in points.chunks(SHORT) {
        let mut short = Block::<f64, D, SHORT>::zero();
        chunk.iter().enumerate().for_each(|(i, p)| short.set(i, *p));
        let mut values = Column::<f64, SHORT>::zero();
        let mut slopes = Gradients::<f64, D, SHORT>::zero();
        shape.block_distances(&short, chunk.len(), &mut values);
        shape.block_gradients(&short, chunk.len(), &mut slopes);
        for (i, p) in chunk.iter().enumerate() {
            let (f, g) = shape.distance_gradient(*p);
            same("short block value", *p, f, values.get(i))?;
            same("short block value with gradient", *p, f, slopes.distance.get(i))?;
            for k in 0..D {
                same("short block gradient", *p, g[k], slopes.gradient.get(i)[k])?;
            }
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
