// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The catalogue of operators on one shape with one argument; each is declared beside its
//! formula.

use super::{domain, surface};
use crate::error::ShapeError;
use crate::field::SharedField;
use crate::kernel::{Argument, ParameterKind};
#[cfg(feature = "oracle")]
use crate::{scalar::Scalar, vector::Vector};

/// An operator of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Operator {
    /// The key in scene files.
    pub name: &'static str,
    /// The method of [`Shape`](crate::Shape), in Rust and Python.
    pub method: &'static str,
    /// What it does, in one sentence.
    pub about: &'static str,
    /// The kind of its numbers.
    pub kind: ParameterKind,
    /// `true` if it has a number for each axis.
    pub is_per_axis: bool,
    /// The numbers to begin with, on a shape 1 m wide; the first one if it has one number.
    pub first: [f64; 3],
}

impl Operator {
    /// The operator called `name` in scene files.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|operator| operator.name == name).copied()
    }

    /// The error for an argument of another form.
    pub(crate) fn unsuitable<T>(&self) -> Result<T, ShapeError> {
        let needs = if self.is_per_axis { "a number for each axis" } else { "a number" };
        Err(ShapeError::Unsuitable { operator: self.name, needs: needs.into() })
    }
}

/// A declared operator.
pub(crate) trait Declared {
    const OPERATOR: Operator;

    /// The field, after the argument is checked.
    fn field<const D: usize>(
        child: SharedField<D>,
        argument: &Argument,
    ) -> Result<SharedField<D>, ShapeError>;
}

/// The values of a child at any point.
#[cfg(feature = "oracle")]
#[allow(missing_debug_implementations, reason = "it holds closures")]
pub struct Child<'a, S, const D: usize> {
    /// Its value.
    pub value: &'a dyn Fn(Vector<S, D>) -> S,
    /// The same, but at least the distance to its box where its promise says that the value may
    /// be less: what operators that grow a child take.
    pub guarded: &'a dyn Fn(Vector<S, D>) -> S,
}

/// What tests need of a declared operator.
#[cfg(feature = "oracle")]
pub(crate) trait Evidence: Declared {
    /// The value at `p` by the definition.
    fn definition<S: Scalar, const D: usize>(
        child: &Child<'_, S, D>,
        argument: &Argument,
        p: Vector<S, D>,
    ) -> S;
}

macro_rules! catalogue {
    ($($declared:ty),* $(,)?) => {
        impl Operator {
            /// All operators of the catalogue.
            pub const ALL: &'static [Self] = &[$(<$declared>::OPERATOR),*];
        }

        /// The field that an operator makes of a child.
        pub(crate) fn field<const D: usize>(
            operator: &Operator,
            child: SharedField<D>,
            argument: &Argument,
        ) -> Result<SharedField<D>, ShapeError> {
            match operator.name {
                $(name if name == <$declared>::OPERATOR.name => {
                    <$declared>::field(child, argument)
                })*
                _ => operator.unsuitable(),
            }
        }

        #[cfg(feature = "oracle")]
        impl Operator {
            /// The value at `p` by the definition, for tests.
            ///
            /// # Panics
            ///
            /// If the argument is of another form.
            pub fn definition<S: Scalar, const D: usize>(
                &self,
                child: &Child<'_, S, D>,
                argument: &Argument,
                p: Vector<S, D>,
            ) -> S {
                match self.name {
                    $(name if name == <$declared>::OPERATOR.name => {
                        <$declared as Evidence>::definition(child, argument, p)
                    })*
                    _ => unreachable!("an operator of the catalogue"),
                }
            }
        }
    };
}

catalogue! { surface::Shell, domain::Elongate }
