// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The comparison of the example `gradients`, and the page that shows its table.

#[path = "../../examples/gradients/comparison.rs"]
mod comparison;

use std::cell::Cell;

use comparison::{OFFSET, cases, errors, quantile, table};
use palpate_field::{Point, Vector};
use palpate_local::{GradientMethod as Method, dichotomy};

type Outcome = Result<(), Box<dyn std::error::Error>>;

#[test]
fn the_guide_shows_the_table_that_the_example_prints() -> Outcome {
    let page = include_str!("../../../../docs/guide/gradients.md");
    let table = table()?;
    assert!(page.contains(&table), "put this into docs/guide/gradients.md:\n{table}");
    Ok(())
}

#[test]
fn rounding_to_single_precision_is_what_spoils_differences() -> Outcome {
    let [.., case] = cases()?;
    for method in [Method::Differences, Method::Dichotomy] {
        let [double, _] = errors(&case, method, false)?;
        let [single, _] = errors(&case, method, true)?;
        let [double, single] = [double, single].map(|e| quantile(&e, 0.5));
        assert!(single > 5.0 * double, "{method:?}: {single} and {double} degrees");
    }
    Ok(())
}

/// The adaptive offset is for large values; inside they are negative.
#[test]
fn the_adaptive_offset_is_its_floor_inside() -> Outcome {
    let [.., case] = cases()?;
    let [_, fixed] = errors(&case, Method::Dichotomy, true)?;
    let [_, adaptive] = errors(&case, Method::AdaptiveDichotomy, true)?;
    assert_eq!(fixed, adaptive);
    Ok(())
}

#[test]
fn a_dichotomy_takes_twelve_evaluations() {
    let count = Cell::new(0);
    let value = |p: Point<2>| {
        count.set(count.get() + 1);
        p.norm()
    };
    assert!(dichotomy(&value, Vector([3.0, 4.0]), OFFSET).is_some());
    assert_eq!(count.get(), 12);
    assert_eq!(64 * (count.get() + 1), 832); // with the value, in the memoir's 64 steps
}

#[test]
fn analytic_gradients_are_right_on_both_sides() -> Outcome {
    for case in &cases()? {
        for side in errors(case, Method::Exact, false)? {
            assert!(quantile(&side, 0.99) < 1e-9, "degrees");
        }
    }
    Ok(())
}
