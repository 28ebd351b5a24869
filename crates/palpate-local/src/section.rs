// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Golden sections of a function of one variable (Kiefer 1953).

/// 1/φ: what is left of a bracket after a section, so that one of its two points is
/// used again.
const LEFT: f64 = 0.618_033_988_749_894_9;

/// The share from 0 to 1 at which `at` is least of those that `sections` sections ask, and its value.
/// `at` is asked once more often than there are sections.
///
/// It is the minimum of what first falls and then grows, and some local one elsewhere.
pub(crate) fn least_on_unit(sections: u32, mut at: impl FnMut(f64) -> f64) -> (f64, f64) {
    let (mut low, mut high) = (0.0, 1.0);
    let (mut left, mut right) = (1.0 - LEFT, LEFT);
    let (mut at_left, mut at_right) = (at(left), at(right));
    for _ in 1..sections {
        if at_left <= at_right {
            high = right;
            (right, at_right) = (left, at_left);
            left = high - LEFT * (high - low);
            at_left = at(left);
        } else {
            low = left;
            (left, at_left) = (right, at_right);
            right = low + LEFT * (high - low);
            at_right = at(right);
        }
    }
    if at_left <= at_right { (left, at_left) } else { (right, at_right) }
}

/// What `sections` sections leave of the bracket from 0 to 1, where both points of each section are
/// asked anew.
pub(crate) fn golden_bracket(sections: u32, mut at: impl FnMut(f64) -> f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..sections {
        let part = LEFT * (high - low);
        let (left, right) = (high - part, low + part);
        if at(left) < at(right) { high = right } else { low = left }
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_close_in_on_the_minimum() {
        let mut asked = 0;
        let (share, value) = least_on_unit(30, |s| {
            asked += 1;
            (s - 0.3) * (s - 0.3)
        });
        assert!((share - 0.3).abs() < 1e-6 && value < 1e-12);
        assert_eq!(asked, 31);
    }
}
