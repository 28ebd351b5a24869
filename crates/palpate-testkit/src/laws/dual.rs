// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Gradients written by hand are the derivatives of the formula.

use palpate_field::kernel::NamedKernel;
use palpate_field::scalar::Dual;
use palpate_field::{Point, Shape, Vector};

use super::smooth_at;
use crate::kernels::Visit;

/// How far the gradients may differ where the field is smooth.
const GRADIENT: f64 = 1e-9;

/// Distances from the surface, in sizes, within which it is singular.
const SINGULAR: f64 = 1e-6;

/// A [`Visit`] that checks the kernel's gradient against the formula in dual numbers; the
/// output says what differs.
#[derive(Clone, Debug)]
pub struct GradientIsTheDual<const D: usize> {
    /// The points to check [m].
    pub points: Vec<Point<D>>,
    /// The size of the shape [m].
    pub size: f64,
}

impl<const D: usize> Visit<D> for GradientIsTheDual<D> {
    type Output = Result<(), String>;

    fn visit<K: NamedKernel<D>>(self, kernel: K) -> Result<(), String> {
        let shape = Shape::from_kernel(kernel.clone());
        for p in self.points {
            let (f, g): (f64, Vector<f64, D>) = kernel.distance_gradient(p);
            let dual = kernel.distance(Vector(Dual::variables(p.0)));
            if f.to_bits() != dual.value.to_bits() {
                return Err(format!("{f:e}, by duals {:e}, at {p:?}: {kernel:?}", dual.value));
            }
            let apart = (g - Vector(dual.gradient)).norm();
            let near = f.abs() < SINGULAR * self.size;
            let blur = 1e-9 * (self.size + p.norm());
            if apart <= GRADIENT || near || !smooth_at(&shape, p, blur) {
                continue;
            }
            return Err(format!(
                "gradient {g:?}, by duals {:?}, at {p:?}: {kernel:?}",
                dual.gradient
            ));
        }
        Ok(())
    }
}
