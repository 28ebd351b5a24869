// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles grids in this crate, for the plane and for space.
//! [`compile`] says why.

use palpate_field::Shape;
use palpate_field::compile;

use crate::Grid;

fn in_dimension<const D: usize>() {
    compile![
        Grid::<D>::bake_with,
        Grid::<D>::from_samples,
        Grid::<D>::rebuild,
        Grid::<D>::samples,
        <Shape<D> as From<Grid<D>>>::from,
    ];
    #[cfg(feature = "files")]
    compile![
        Grid::<D>::from_bytes,
        Grid::<D>::open_at,
        Grid::<D>::save_at,
        crate::GridCache::bake::<D>,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    in_dimension::<2>();
    in_dimension::<3>();
}
