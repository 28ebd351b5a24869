// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A trait for both kinds of servo.

use std::sync::Arc;

use super::{Renderer, Servo, UnprotectedServo};
use crate::protection::Protection;

/// Opens the methods of [`AnyServo`]. Only this crate makes one: no other type implements the
/// trait, and no other crate replaces the renderer of a [`Servo`].
#[derive(Debug)]
pub struct Key(pub(crate) ());

/// A [`Servo`] or an [`UnprotectedServo`]. Sealed: no other type implements the trait, and its
/// methods are this crate's own.
pub trait AnyServo<const D: usize> {
    #[doc(hidden)]
    fn renderer(&self, key: Key) -> &Renderer<D>;

    #[doc(hidden)]
    fn renderer_mut(&mut self, key: Key) -> &mut Renderer<D>;

    #[doc(hidden)]
    fn any_protection(&self, key: Key) -> Option<&Arc<Protection<D>>>;
}

impl<const D: usize> AnyServo<D> for Servo<D> {
    fn renderer(&self, _: Key) -> &Renderer<D> {
        &self.renderer
    }

    fn renderer_mut(&mut self, _: Key) -> &mut Renderer<D> {
        &mut self.renderer
    }

    fn any_protection(&self, _: Key) -> Option<&Arc<Protection<D>>> {
        Some(&self.protection)
    }
}

impl<const D: usize> AnyServo<D> for UnprotectedServo<D> {
    fn renderer(&self, _: Key) -> &Renderer<D> {
        &self.renderer
    }

    fn renderer_mut(&mut self, _: Key) -> &mut Renderer<D> {
        &mut self.renderer
    }

    fn any_protection(&self, _: Key) -> Option<&Arc<Protection<D>>> {
        None
    }
}
