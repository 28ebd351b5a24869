// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tables of primitives and operators in the documents are those of the catalogue.

use palpate_field::catalogue::Entry;
use palpate_field::operator::Operator;
use palpate_testkit::kernels::{Dimension, Space};
use palpate_testkit::oracle::Row;

/// Set to write the tables instead of comparing them.
const RENEW: &str = "PALPATE_RENEW";

/// A row for each primitive, those of both dimensions once.
fn table() -> String {
    let planar = Entry::<2>::ALL.iter().map(|e| (e.name, e.origin));
    let spatial = Entry::<3>::ALL.iter().map(|e| (e.name, e.origin));
    let of_both = |name| Entry::<2>::find(name).is_some() && Entry::<3>::find(name).is_some();
    let row = |dimensions: &str, (name, origin): (&str, &str)| {
        format!("| `{name}` | {dimensions} | {origin} |\n")
    };
    let both = planar.clone().filter(|(name, _)| of_both(name)).map(|e| row("2D, 3D", e));
    let flat = planar.filter(|(name, _)| !of_both(name)).map(|e| row("2D", e));
    let solid = spatial.filter(|(name, _)| !of_both(name)).map(|e| row("3D", e));
    let head = "| primitive | in | origin |\n|---|---|---|\n".to_owned();
    std::iter::once(head).chain(both).chain(flat).chain(solid).collect()
}

/// The rows of the primitives of one dimension in the guide.
fn guide<const D: usize>() -> String
where
    Space: Dimension<D>,
{
    let rows = Space::SAMPLES.iter().flat_map(|of| of.guide.iter().map(|row| (of.name, row)));
    let row = |(name, row): (&str, &Row)| {
        format!("| {} | `{name}` | {} | {} |\n", row.listed_as, row.arguments, row.promise)
    };
    let head =
        "| in the list | primitive | arguments | promise |\n|---|---|---|---|\n".to_owned();
    std::iter::once(head).chain(rows.map(row)).collect()
}

/// The operators of the catalogue, with the argument of their example.
fn operators() -> String {
    let row = |operator: &Operator| {
        let [x, y, z] = operator.first;
        let argument =
            if operator.is_per_axis { format!("[{x}, {y}, {z}]") } else { x.to_string() };
        format!(
            "| `{{ \"{}\": {argument}, \"of\": a }}` | {} |\n",
            operator.name, operator.about
        )
    };
    let head = "| | |\n|---|---|\n".to_owned();
    std::iter::once(head).chain(Operator::ALL.iter().map(row)).collect()
}

/// Compares the table `name` in a document, or writes it.
fn assert_current(document: &str, name: &str, table: &str) {
    let path = crate::common::repository().join(document);
    let text = std::fs::read_to_string(&path).unwrap();
    let around = [format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->\n")];
    let [before, after] =
        around.each_ref().map(|line| text.find(line).expect("the lines around the table"));
    let (head, rest) = text.split_at(before + around[0].len());
    let written = &rest[..after - head.len()];
    if std::env::var_os(RENEW).is_some() {
        std::fs::write(&path, [head, table, &text[after..]].concat()).unwrap();
        return;
    }
    assert!(
        written == table,
        "the table of {name} in {document} is stale; `cargo xtask renew` renews it"
    );
}

#[test]
fn the_documented_primitives_and_operators_are_those_of_the_catalogue() {
    assert_current("docs/formats.md", "origins", &table());
    assert_current("docs/formats.md", "operators", &operators());
    assert_current("docs/guide/shapes.md", "primitives of the plane", &guide::<2>());
    assert_current("docs/guide/shapes.md", "primitives of space", &guide::<3>());
}

#[test]
fn primitives_of_both_dimensions_say_the_same_of_their_origin() {
    for planar in Entry::<2>::ALL {
        if let Some(spatial) = Entry::<3>::ALL.iter().find(|e| e.name == planar.name) {
            assert_eq!(planar.origin, spatial.origin, "{}", planar.name);
        }
    }
}
