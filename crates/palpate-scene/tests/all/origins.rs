// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The table of primitives in the documentation is that of the catalogue.

use palpate_field::catalogue::Entry;

/// Set to write the table instead of comparing it.
const RENEW: &str = "PALPATE_RENEW";

/// The lines around the table.
const AROUND: [&str; 2] = ["<!-- origins -->\n", "<!-- end of origins -->\n"];

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

#[test]
fn the_documented_origins_are_those_of_the_catalogue() {
    let path = crate::common::repository().join("docs/formats.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let [before, after] =
        AROUND.map(|line| text.find(line).expect("the lines around the table"));
    let (head, rest) = text.split_at(before + AROUND[0].len());
    let written = &rest[..after - head.len()];
    if std::env::var_os(RENEW).is_some() {
        let renewed = [head, &table(), &text[after..]].concat();
        std::fs::write(&path, renewed).unwrap();
        return;
    }
    assert!(
        written == table(),
        "the table of origins in docs/formats.md is stale; `cargo xtask renew` renews it"
    );
}

#[test]
fn primitives_of_both_dimensions_say_the_same_of_their_origin() {
    for planar in Entry::<2>::ALL {
        if let Some(spatial) = Entry::<3>::ALL.iter().find(|e| e.name == planar.name) {
            assert_eq!(planar.origin, spatial.origin, "{}", planar.name);
        }
    }
}
