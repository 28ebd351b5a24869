// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Either kind of servo, where the kind does not matter.

use super::{Renderer, Servo, UnprotectedServo};
use crate::protection::Protection;

/// A [`Servo`] or an [`UnprotectedServo`]. Sealed: there is no other.
///
/// This trait is not exported, so that nobody outside the crate reaches the renderer of a
/// [`Servo`] to exchange it.
pub trait AnyServo<const D: usize> {
    #[doc(hidden)]
    fn renderer(&self) -> &Renderer<D>;

    #[doc(hidden)]
    fn renderer_mut(&mut self) -> &mut Renderer<D>;

    #[doc(hidden)]
    fn any_protection(&self) -> Option<&Protection<D>>;
}

impl<const D: usize> AnyServo<D> for Servo<D> {
    fn renderer(&self) -> &Renderer<D> {
        &self.renderer
    }

    fn renderer_mut(&mut self) -> &mut Renderer<D> {
        &mut self.renderer
    }

    fn any_protection(&self) -> Option<&Protection<D>> {
        Some(&self.protection)
    }
}

impl<const D: usize> AnyServo<D> for UnprotectedServo<D> {
    fn renderer(&self) -> &Renderer<D> {
        &self.renderer
    }

    fn renderer_mut(&mut self) -> &mut Renderer<D> {
        &mut self.renderer
    }

    fn any_protection(&self) -> Option<&Protection<D>> {
        None
    }
}
