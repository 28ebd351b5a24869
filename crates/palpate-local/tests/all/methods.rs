// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The comparison of the example `methods`, and the page that shows its tables.

#[path = "../../examples/methods/comparison.rs"]
mod comparison;
#[path = "../../examples/methods/inputs.rs"]
mod inputs;

#[test]
fn the_guide_shows_what_the_example_prints_but_for_times() {
    let page = include_str!("../../../../docs/guide/local-methods.md");
    for table in comparison::all().unwrap() {
        for (k, line) in table.lines().enumerate() {
            let text = table.with_times();
            assert!(page.contains(&line), "put this into docs/guide/local-methods.md:\n{text}");
            assert!(k > 0 || line.contains("(palpate) | 0.0 % |"), "the proof fails: {line}");
        }
    }
}
