// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A trait for both kinds of servo.

use std::sync::Arc;

use super::{Renderer, Servo, UnprotectedServo};
use crate::protection::Protection;

/// A [`Servo`] or an [`UnprotectedServo`]. Sealed: no other type implements it.
///
/// The trait is not exported, so that no other crate can replace the renderer of a [`Servo`].
pub trait AnyServo<const D: usize> {
    #[doc(hidden)]
    fn renderer(&self) -> &Renderer<D>;

    #[doc(hidden)]
    fn renderer_mut(&mut self) -> &mut Renderer<D>;

    #[doc(hidden)]
    fn any_protection(&self) -> Option<&Arc<Protection<D>>>;
}

impl<const D: usize> AnyServo<D> for Servo<D> {
    fn renderer(&self) -> &Renderer<D> {
        &self.renderer
    }

    fn renderer_mut(&mut self) -> &mut Renderer<D> {
        &mut self.renderer
    }

    fn any_protection(&self) -> Option<&Arc<Protection<D>>> {
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

    fn any_protection(&self) -> Option<&Arc<Protection<D>>> {
        None
    }
}
