// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Finds the type of a kernel by its name in the catalogue.

use super::{Definition, Evidence, Row};
use crate::catalogue::Entry;
use crate::error::ShapeError;
use crate::kernel::*;
use crate::shape::Shape;

/// A function of a kernel whose type is only known by name.
pub trait Visit<const D: usize> {
    /// The result.
    type Output;

    /// Called with the kernel.
    fn visit<K: Evidence<D>>(self, kernel: K) -> Self::Output;
}

/// The evidence of a primitive that needs no arguments.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The name of the primitive.
    pub name: &'static str,
    /// [`Evidence::SAMPLE`].
    pub sample: &'static str,
    /// [`Evidence::GUIDE`].
    pub guide: &'static [Row],
    /// The messages of [`Evidence::refused`].
    pub messages: fn() -> Vec<String>,
}

impl Sample {
    const fn of<K: Evidence<D>, const D: usize>() -> Self {
        Self {
            name: K::NAME,
            sample: K::SAMPLE,
            guide: K::GUIDE,
            messages: || {
                let refused = K::refused().into_iter();
                refused
                    .map(|kernel| kernel.map_or_else(|e| e.to_string(), |_| "no error".into()))
                    .collect()
            },
        }
    }
}

/// The catalogue of the plane or of space.
pub trait Dimension<const D: usize> {
    /// The catalogue.
    const CATALOGUE: &'static [Entry<D>];
    /// The evidence of its primitives.
    const SAMPLES: &'static [Sample];

    /// Calls `visit` with the kernel `name` of `arguments`.
    ///
    /// # Errors
    ///
    /// If the arguments break a rule.
    ///
    /// # Panics
    ///
    /// If there is no such kernel.
    fn with_kernel<V: Visit<D>>(
        name: &str,
        arguments: &[Argument],
        visit: V,
    ) -> Result<V::Output, ShapeError>;
}

/// The one implementor of [`Dimension`], for 2 and 3.
#[derive(Clone, Copy, Debug)]
pub struct Space;

macro_rules! dimension {
    ($dimension:literal: $($kernel:ty),* $(,)?) => {
        impl Dimension<$dimension> for Space {
            const CATALOGUE: &'static [Entry<$dimension>] = Entry::<$dimension>::ALL;
            const SAMPLES: &'static [Sample] = &[$(Sample::of::<$kernel, $dimension>()),*];

            fn with_kernel<V: Visit<$dimension>>(
                name: &str,
                arguments: &[Argument],
                visit: V,
            ) -> Result<V::Output, ShapeError> {
                $(
                    if name == <$kernel as NamedKernel<$dimension>>::NAME {
                        let kernel =
                            <$kernel as NamedKernel<$dimension>>::from_arguments(arguments)?;
                        return Ok(visit.visit(kernel));
                    }
                )*
                panic!("there is no kernel {name}");
            }
        }
    };
}

planar::primitives!(dimension, 2:);
spatial::primitives!(dimension, 3:);

/// A [`Visit`] that makes a shape of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct IntoShape;

impl<const D: usize> Visit<D> for IntoShape {
    type Output = Shape<D>;

    fn visit<K: Evidence<D>>(self, kernel: K) -> Shape<D> {
        Shape::from_kernel(kernel)
    }
}

/// A [`Visit`] that defines the shape of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Defined;

impl<const D: usize> Visit<D> for Defined {
    type Output = Definition<D>;

    fn visit<K: Evidence<D>>(self, kernel: K) -> Definition<D> {
        kernel.definition()
    }
}
