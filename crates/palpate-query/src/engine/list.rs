// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A queue that is scanned: the fastest for the few cells of an element.

use super::{Bounded, Queue, smaller};

impl<C: Bounded + Copy> Queue for Vec<C> {
    type Cell = C;

    #[inline]
    fn least(&self) -> f64 {
        self.iter().fold(f64::INFINITY, |least, cell| smaller(least, cell.lower()))
    }

    #[inline]
    fn take_least(&mut self, then: impl FnOnce(&C)) -> bool {
        let Some(last) = self.len().checked_sub(1) else { return false };
        let least = (0..last)
            .fold(last, |low, i| if self[i].lower() < self[low].lower() { i } else { low });
        self.swap(least, last);
        then(&self[last]);
        self.truncate(last);
        true
    }

    #[inline]
    fn push(&mut self, cell: &C) {
        self.push(*cell);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Bounded for f64 {
        fn lower(&self) -> f64 {
            *self
        }
    }

    #[test]
    fn the_least_cell_is_taken_and_the_last_of_equal_ones() {
        let mut list = vec![3.0, -0.0, 2.0, 0.0];
        let mut taken = Vec::new();
        assert_eq!(list.least(), 0.0);
        while list.take_least(|cell: &f64| taken.push(cell.to_bits())) {}
        assert_eq!(taken, [0.0_f64, -0.0, 2.0, 3.0].map(f64::to_bits));
        assert_eq!(list.least(), f64::INFINITY);
    }
}
