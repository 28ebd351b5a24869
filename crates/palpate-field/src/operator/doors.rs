// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where operators become fields: once for the plane, once for space.
//!
//! A generic function is compiled in every crate that calls it, and an operator
//! drags its loops for every number type and instruction set along. So that those
//! are compiled in this crate alone, the last step goes through functions that are
//! not generic, found by the type of the operator.

use std::any::Any;
use std::sync::Arc;

use super::boolean::{InOne, Larger, Smaller, Without};
use super::distortion::{Bend, Twist};
use super::domain::{Elongation, Extrusion, Mirror, Revolution};
use super::guard::Guard;
use super::mixture::{Displacement, Morph};
use super::repetition::{Clearance, Tile};
use super::smooth::{Fillet, Round, SmoothMax, SmoothMin};
use super::surface::{Offset, Shell};
use super::transform::{AxisScale, UniformScale};
use crate::field::{Combined, Field, Placement, Remapped, Union, Warped};
use crate::scalar::{Circular, Cubic, Exponential, Quadratic, Quartic, Root};

/// `node` as a field.
///
/// # Panics
///
/// If an operator has no door below: a defect that every test of it shows.
pub(crate) fn open<N: Any, const D: usize>(node: N) -> Arc<dyn Field<D>> {
    let mut node = Some(node);
    let field = planar(&mut node).and_then(same_dimension);
    field.or_else(|| spatial(&mut node).and_then(same_dimension)).unwrap_or_else(|| {
        unreachable!("{} has no door", std::any::type_name::<N>());
    })
}

/// A field of `A` dimensions as one of `B`, if they are the same.
fn same_dimension<const A: usize, const B: usize>(
    field: Arc<dyn Field<A>>,
) -> Option<Arc<dyn Field<B>>> {
    let mut field = Some(field);
    let field: &mut dyn Any = &mut field;
    field.downcast_mut::<Option<Arc<dyn Field<B>>>>()?.take()
}

macro_rules! doors {
    ($name:ident, $dimension:literal, $($node:ty),* $(,)?) => {
        /// The node as a field of this dimension, if it is one of its operators.
        #[inline(never)]
        fn $name(node: &mut dyn Any) -> Option<Arc<dyn Field<$dimension>>> {
            $(
                if let Some(node) = node.downcast_mut::<Option<$node>>() {
                    return Some(Arc::new(node.take()?));
                }
            )*
            None
        }
    };
}

doors! {
    planar, 2,
    Union<2>,
    Combined<Smaller, 2>,
    Combined<Larger, 2>,
    Combined<Without, 2>,
    Combined<InOne, 2>,
    Combined<SmoothMin<Quadratic>, 2>,
    Combined<SmoothMin<Cubic>, 2>,
    Combined<SmoothMin<Quartic>, 2>,
    Combined<SmoothMin<Circular>, 2>,
    Combined<SmoothMin<Root>, 2>,
    Combined<SmoothMin<Exponential>, 2>,
    Combined<SmoothMax<Quadratic>, 2>,
    Combined<SmoothMax<Cubic>, 2>,
    Combined<SmoothMax<Quartic>, 2>,
    Combined<SmoothMax<Circular>, 2>,
    Combined<SmoothMax<Root>, 2>,
    Combined<SmoothMax<Exponential>, 2>,
    Combined<Fillet, 2>,
    Combined<Round, 2>,
    Combined<Displacement, 2>,
    Combined<Morph, 2>,
    Remapped<Guard<2>, 2>,
    Remapped<Offset, 2>,
    Remapped<Shell, 2>,
    Warped<Placement<2>, 2, 2>,
    Warped<UniformScale, 2, 2>,
    Warped<AxisScale<2>, 2, 2>,
    Warped<Mirror, 2, 2>,
    Warped<Tile<2>, 2, 2>,
    Remapped<Clearance<2>, 2>,
    Warped<Bend<2>, 2, 2>,
    Warped<Elongation<2>, 2, 2>,
}

doors! {
    spatial, 3,
    Union<3>,
    Combined<Smaller, 3>,
    Combined<Larger, 3>,
    Combined<Without, 3>,
    Combined<InOne, 3>,
    Combined<SmoothMin<Quadratic>, 3>,
    Combined<SmoothMin<Cubic>, 3>,
    Combined<SmoothMin<Quartic>, 3>,
    Combined<SmoothMin<Circular>, 3>,
    Combined<SmoothMin<Root>, 3>,
    Combined<SmoothMin<Exponential>, 3>,
    Combined<SmoothMax<Quadratic>, 3>,
    Combined<SmoothMax<Cubic>, 3>,
    Combined<SmoothMax<Quartic>, 3>,
    Combined<SmoothMax<Circular>, 3>,
    Combined<SmoothMax<Root>, 3>,
    Combined<SmoothMax<Exponential>, 3>,
    Combined<Fillet, 3>,
    Combined<Round, 3>,
    Combined<Displacement, 3>,
    Combined<Morph, 3>,
    Remapped<Guard<3>, 3>,
    Remapped<Offset, 3>,
    Remapped<Shell, 3>,
    Warped<Placement<3>, 3, 3>,
    Warped<UniformScale, 3, 3>,
    Warped<AxisScale<3>, 3, 3>,
    Warped<Mirror, 3, 3>,
    Warped<Tile<3>, 3, 3>,
    Remapped<Clearance<3>, 3>,
    Warped<Bend<3>, 3, 3>,
    Warped<Elongation<3>, 3, 3>,
    Warped<Twist, 3, 3>,
    Warped<Extrusion, 3, 2>,
    Warped<Revolution, 3, 2>,
}
