// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles the searches in this crate.
//! [`compile`] says why.

use palpate_field::compile;

use crate::element_search::{self, ElementWorkspace};
use crate::mesh::{MeshWorkspace, contacts_of, find};
use crate::pair::{BodyPair, PairSearch, PairWorkspace, penetration_of, prove, rates_of};
use crate::sweep::{ElementSweep, SweepWorkspace, swept};
use crate::{BallWorkspace, Track, any_point, ball, cast_ball, cast_ray, contacts, manifold};

/// Compiles the searches of `D` dimensions.
fn in_dimension<const D: usize>() {
    compile![
        BodyPair::<D>::new,
        PairSearch::<D>::new,
        PairSearch::<D>::run,
        PairSearch::<D>::run_from,
        PairWorkspace::<D>::new,
        penetration_of::<D>,
        prove::<D>,
        rates_of::<D>,
        any_point::<D>,
        manifold::spanning::<D>,
        manifold::deepest::<D>,
        Track::<D>::new,
        Track::<D>::separation,
        Track::<D>::manifold,
        ball::search::<D>,
        BallWorkspace::<D>::new,
        cast_ray::<D>,
        cast_ball::<D>,
        contacts::at::<D>,
        swept::<D>,
        SweepWorkspace::<D>::new,
    ];
    #[cfg(feature = "world")]
    {
        use crate::World;
        compile![
            World::<D>::new,
            World::<D>::add,
            World::<D>::remove,
            World::<D>::set_poses,
            World::<D>::step,
            World::<D>::lower_bound,
            World::<D>::first_impact,
        ];
    }
}

/// Compiles the searches over elements with `N` corners in `D` dimensions.
fn of_elements<const N: usize, const D: usize>() {
    compile![
        element_search::search::<N, D>,
        ElementWorkspace::<N, D>::new,
        contacts::find::<N, D>,
        find::<N, D>,
        contacts_of::<N, D>,
        MeshWorkspace::<N, D>::new,
        ElementSweep::<N, D>::new,
        ElementSweep::<N, D>::run,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    in_dimension::<2>();
    in_dimension::<3>();
    of_elements::<2, 2>();
    of_elements::<2, 3>();
    of_elements::<3, 2>();
    of_elements::<3, 3>();
}
