// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tables of the guide name primitives, with their parameters, as the catalogue
//! does.

use palpate_field::catalogue::Entry;
use palpate_field::kernel::Parameter;

const GUIDE: &str = include_str!("../../../../docs/guide/shapes.md");

/// A row of a table: cells without the bars.
fn rows(section: &str) -> Vec<Vec<&str>> {
    let start = GUIDE.find(section).unwrap_or_else(|| panic!("no section {section}"));
    let after = &GUIDE[start + section.len()..];
    let text = after.find("\n## ").map_or(after, |end| &after[..end]);
    let row = |line: &'static str| line.trim_matches('|').split('|').map(str::trim).collect();
    // Without the head and the line under it.
    text.lines().filter(|line| line.starts_with('|')).skip(2).map(row).collect()
}

/// What stands between backticks.
fn quoted(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// The rows of a section are as many as the list has, and each names a primitive whose
/// parameters are the first ones quoted in the next cell; promises begin as they should.
fn check<const D: usize>(section: &str, catalogue: &[Entry<D>]) {
    let rows = rows(section);
    assert!(rows.len() > 30, "rows{section}");
    let mut unknown = Vec::new();
    for row in rows {
        let [name] = quoted(row[1])[..] else { panic!("one primitive in {row:?}") };
        let Some(entry) = catalogue.iter().find(|entry| entry.name == name) else {
            unknown.push(name);
            continue;
        };
        let is_parameter =
            |quote: &&str| entry.parameters.iter().any(|p: &Parameter| p.name == *quote);
        let named = quoted(row[2]);
        let other = ["rounded_cuboid", "ring", "mirrored", "placed"];
        let wrong: Vec<_> =
            named.iter().filter(|q| !is_parameter(q) && !other.contains(q)).collect();
        assert!(wrong.is_empty(), "{name} has no {wrong:?}");
        let promise = if BOUNDS.contains(&name) { "bound" } else { "exact" };
        assert!(row[3].starts_with(promise), "{name}: {}", row[3]);
    }
    assert!(unknown.is_empty(), "not in the catalogue: {unknown:?}");
}

/// Primitives that are no more than a bound; all others in the guide are exact.
const BOUNDS: [&str; 4] = ["power_ball", "power_cuboid", "power_torus", "screw_thread"];

#[test]
fn the_guide_names_primitives_of_the_plane_that_there_are() {
    check("\n## Of the plane\n", Entry::<2>::ALL);
}

#[test]
fn the_guide_names_primitives_of_space_that_there_are() {
    check("\n## Of space\n", Entry::<3>::ALL);
}
