// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The nearest point of a parabola, beside a search.

use palpate_field::internal::Quadratic;

/// Where the distance from (a, b) is the least, by looking at many points and
/// then between the best of them.
fn by_search(curve: Quadratic, a: f64, b: f64) -> f64 {
    let square = |tau: f64| {
        let x = curve.along * tau - a;
        let y = curve.up * tau * tau - b;
        x * x + y * y
    };
    let far = (a / curve.along).max((b.abs() / curve.up).sqrt()) + 1.0;
    let count = 4000;
    let at = |i: usize| far * i as f64 / count as f64;
    let best = (0..=count).min_by(|i, j| square(at(*i)).total_cmp(&square(at(*j))));
    let best = best.expect("there are points");
    let (mut low, mut high) = (at(best.saturating_sub(1)), at(best + 1));
    for _ in 0..200 {
        let third = (high - low) / 3.0;
        if square(low + third) < square(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    square(low).sqrt()
}

#[test]
fn the_root_is_the_nearest_point_also_on_the_evolute_and_the_axis() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / 9_007_199_254_740_992.0
    };
    for case in 0..20_000 {
        let curve = Quadratic::new(0.2 + 2.0 * random(), 0.2 + 2.0 * random());
        let rho = curve.along * curve.along / (2.0 * curve.up);
        // Anywhere, on the axis, on the evolute and next to it.
        let s = 2.0 * random();
        let evolute = [
            curve.along * s.powi(3) * 4.0 * curve.up * curve.up / (curve.along * curve.along),
            rho + 3.0 * curve.up * s * s,
        ];
        let [a, b] = match case % 5 {
            0 => [5.0 * random(), 10.0 * random() - 5.0],
            1 => [0.0, 6.0 * random() - 1.0],
            2 => evolute,
            3 => [evolute[0] * (1.0 + 1e-9 * (random() - 0.5)), evolute[1]],
            _ => [1e-12 * random(), rho * (1.0 + 1e-9 * (random() - 0.5))],
        };
        let nearest = curve.nearest(a, b);
        let found = by_search(curve, a, b);
        assert!(
            (nearest.below.abs() - found).abs() < 1e-12 * (1.0 + a + b.abs()),
            "{} instead of {found} at {a}, {b} of {curve:?}",
            nearest.below
        );
    }
}
