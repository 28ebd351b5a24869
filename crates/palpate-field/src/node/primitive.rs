// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A primitive with its arguments.

use std::any::Any;
use std::fmt;

use crate::catalogue::Entry;
use crate::error::ShapeError;
use crate::field::SharedField;
use crate::kernel::{Argument, Parameter};

/// A primitive of the catalogue with one argument for each parameter, as given.
///
/// ```
/// use palpate_field::kernel::{Argument, Torus};
/// use palpate_field::{Node, Shape};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let torus = Shape::from_kernel(Torus::new(0.6, 0.2)?);
/// let Node::Primitive(torus) = torus.node() else { unreachable!() };
/// assert_eq!(torus.name(), "torus");
/// assert_eq!(torus.argument("ring_radius"), Some(&Argument::Number(0.6)));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Primitive<const D: usize> {
    entry: Entry<D>,
    arguments: Vec<Argument>,
}

impl<const D: usize> Primitive<D> {
    /// The primitive `name` of the catalogue, or of an alias there, with one argument for
    /// each parameter in their order. [`Shape::from_node`](crate::Shape::from_node) checks
    /// the arguments.
    ///
    /// # Errors
    ///
    /// If the catalogue has no such primitive in this dimension.
    pub fn new(name: &str, arguments: Vec<Argument>) -> Result<Self, ShapeError> {
        let entry = *Entry::find(name).ok_or_else(|| ShapeError::Unsuitable {
            operator: "primitive",
            needs: format!("a name of the catalogue in {D}D, got `{name}`").into(),
        })?;
        Ok(Self { entry, arguments })
    }

    /// The primitive of an entry.
    pub(crate) fn of_entry(entry: Entry<D>, arguments: Vec<Argument>) -> Self {
        Self { entry, arguments }
    }

    /// The primitive that a kernel is; `None` for a kernel of a user.
    pub(crate) fn of_kernel(kernel: &dyn Any) -> Option<Self> {
        let (entry, arguments) = Entry::of_kernel(kernel)?;
        Some(Self { entry, arguments })
    }

    /// The name in the catalogue.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.entry.name
    }

    /// The entry of the catalogue, with the parameters.
    #[must_use]
    pub fn entry(&self) -> &Entry<D> {
        &self.entry
    }

    /// The arguments in the order of the parameters.
    #[must_use]
    pub fn arguments(&self) -> &[Argument] {
        &self.arguments
    }

    /// The argument for the parameter called `parameter`.
    #[must_use]
    pub fn argument(&self, parameter: &str) -> Option<&Argument> {
        self.named().find_map(|(known, value)| (known.name == parameter).then_some(value))
    }

    /// Each parameter with its argument.
    pub fn named(&self) -> impl Iterator<Item = (&'static Parameter, &Argument)> {
        self.entry.parameters.iter().zip(&self.arguments)
    }

    /// The field of the primitive, after its arguments are checked.
    pub(super) fn field(&self) -> Result<SharedField<D>, ShapeError> {
        self.entry.field(&self.arguments)
    }
}

impl<const D: usize> fmt::Debug for Primitive<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl<const D: usize> PartialEq for Primitive<D> {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.arguments == other.arguments
    }
}
