// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers of degrees that stand for an angle in radians.

/// A number of degrees that is `angle` [rad] to the bit; `None` if there is none.
pub(crate) fn degrees(angle: f64) -> Option<f64> {
    let same = |degrees: &f64| degrees.to_radians().to_bits() == angle.to_bits();
    degrees_near(angle).into_iter().find(same)
}

/// Numbers of degrees that may stand for an angle [rad]: rounded to 14 digits, as people write
/// them, then the nearest numbers.
pub(crate) fn degrees_near(angle: f64) -> [f64; 4] {
    let near = angle.to_degrees();
    let rounded = format!("{near:.13e}").parse().unwrap_or(near);
    [rounded, near, near.next_up(), near.next_down()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_angles_have_degrees() {
        let mut found = 0;
        for i in 0..10_000 {
            let angle = (f64::from(i) * 0.618_034).fract() * 8.0 - 4.0;
            if let Some(degrees) = degrees(angle) {
                assert_eq!(degrees.to_radians().to_bits(), angle.to_bits());
                found += 1;
            }
        }
        assert!((5000..9500).contains(&found), "{found}");
        assert_eq!(degrees(-0.0).map(f64::to_bits), Some((-0.0_f64).to_bits()));
        assert_eq!(degrees(f64::MAX), None);
    }

    #[test]
    fn whole_degrees_stay_whole() {
        for whole in -720..=720 {
            let whole = f64::from(whole);
            assert_eq!(degrees(whole.to_radians()), Some(whole));
        }
    }
}
