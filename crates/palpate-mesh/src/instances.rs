// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles meshes in this crate, for the plane and for space.
//! [`compile`] says why.

use palpate_field::Shape;
use palpate_field::compile;

use crate::{Mesh, MeshSheet, Solid};

/// Compiles meshes of elements with `N` corners in `D` dimensions.
fn of_elements<const N: usize, const D: usize>() {
    compile![
        Mesh::<N, D>::new,
        Mesh::<N, D>::tree,
        Mesh::<N, D>::bounds,
        Mesh::<N, D>::scaled,
        Mesh::<N, D>::welded,
        Mesh::<N, D>::report,
        MeshSheet::<N, D>::from_mesh,
        <Shape<D> as From<MeshSheet<N, D>>>::from,
        Solid::<N, D>::from_mesh,
        <Shape<D> as From<Solid<N, D>>>::from,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    of_elements::<2, 2>();
    of_elements::<3, 3>();
}
