// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lists that a tick fills without allocating.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::{Deref, DerefMut};

/// A list with a fixed capacity that its clones keep; a cloned `Vec` has capacity only for its
/// content.
#[derive(Debug, Default)]
pub(super) struct FixedList<T>(Vec<T>);

impl<T> FixedList<T> {
    /// An empty list with this capacity.
    pub(super) fn with_capacity(count: usize) -> Self {
        Self(Vec::with_capacity(count))
    }
}

impl<T: Clone> Clone for FixedList<T> {
    fn clone(&self) -> Self {
        let mut list = Self::with_capacity(self.capacity());
        list.extend_from_slice(self);
        list
    }
}

impl<T> Deref for FixedList<T> {
    type Target = Vec<T>;

    fn deref(&self) -> &Vec<T> {
        &self.0
    }
}

impl<T> DerefMut for FixedList<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        &mut self.0
    }
}

impl<'a, T> IntoIterator for &'a FixedList<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}
