// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The public interface as a list under review: `docs/public-api/` names every public item with
//! its fields, variants and methods, one file a crate.
//!
//! The list is taken from the pages that rustdoc made: those name what a user can reach.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::command::{Failure, root};

/// The crates whose interface is listed: those that a user depends on.
const CRATES: &[&str] = &[
    "palpate",
    "palpate-cli",
    "palpate-device",
    "palpate-field",
    "palpate-grid",
    "palpate-haptics",
    "palpate-local",
    "palpate-mesh",
    "palpate-plot",
    "palpate-query",
    "palpate-render",
    "palpate-safety",
    "palpate-scene",
    "palpate-sim",
    "palpate-vibration",
];

/// Where a page stops to show what the item itself declares.
const END_OF_OWN: &str = "id=\"trait-implementations\"";

/// The kinds of items that are types.
const TYPES: &[&str] = &["struct", "enum", "union", "trait", "type"];

/// What the ids of members begin with.
const MEMBERS: &[&str] = &[
    "structfield.",
    "variant.",
    "method.",
    "tymethod.",
    "associatedconstant.",
    "associatedtype.",
];

/// Fails if the documentation of a crate names other items than its list.
pub(crate) fn check() -> Result<(), Failure> {
    let mut failures = Vec::new();
    let mut types = BTreeMap::new();
    for name in CRATES {
        let (now, path) = (listing(&pages(name))?, list(name));
        // The facade exports the types of the others.
        if *name != "palpate" {
            failures.extend(shared_names(&mut types, name, &now));
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        failures.extend(difference(&kept, &now).map(|difference| {
            Failure(format!(
                "docs/public-api/{name}.txt {difference}; `cargo xtask api` renews the lists"
            ))
            .0
        }));
    }
    Failure::any(failures)
}

/// The types of a crate that have the name of a type in `types`, where those of the other crates are
/// with their crate. Adds the types of the crate.
fn shared_names(
    types: &mut BTreeMap<String, &'static str>,
    name: &'static str,
    list: &str,
) -> Vec<String> {
    let mut shared = Vec::new();
    for line in list.lines() {
        let Some((kind, path)) = line.split_once(' ') else { continue };
        if !TYPES.contains(&kind) {
            continue;
        }
        let last = path.rsplit("::").next().unwrap_or(path);
        if let Some(other) = types.get(last).filter(|other| **other != name) {
            shared.push(format!("{name} and {other} both have a public type {last}"));
        }
        types.insert(last.to_owned(), name);
    }
    shared
}

/// Writes the lists.
pub(crate) fn renew() -> Result<(), Failure> {
    for name in CRATES {
        let (now, path) = (listing(&pages(name))?, list(name));
        std::fs::write(&path, now).map_err(|error| cannot("written", &path, &error))?;
    }
    Ok(())
}

/// Makes the folders of the pages of all crates.
pub(crate) fn make_folders() -> Result<(), Failure> {
    CRATES.iter().map(|name| pages(name)).try_for_each(|folder| {
        std::fs::create_dir_all(&folder).map_err(|error| cannot("made", &folder, &error))
    })
}

fn list(name: &str) -> PathBuf {
    root().join("docs/public-api").join(format!("{name}.txt"))
}

fn pages(name: &str) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root().join("target"), PathBuf::from);
    target.join("doc").join(name.replace('-', "_"))
}

fn cannot(verb: &str, path: &Path, error: &std::io::Error) -> Failure {
    Failure(format!("{} cannot be {verb}: {error}", path.display()))
}

/// A page, whose links within the project lead somewhere: rustdoc's own lint also takes units in
/// brackets for links, and is off.
fn page(path: &Path) -> Result<String, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| cannot("read", path, &error))?;
    match dead_link(&text) {
        None => Ok(text),
        Some(link) => Err(Failure(format!("{}: {link} is not there", path.display()))),
    }
}

/// The path of an item that rustdoc did not find.
fn dead_link(page: &str) -> Option<&str> {
    attributes(page, "href=\"").into_iter().find(|link| link.contains("::"))
}

/// What the list lacks, or has too much.
fn difference(kept: &str, now: &str) -> Option<String> {
    let (kept_lines, now_lines) = (with_items(kept), with_items(now));
    let added = now_lines.difference(&kept_lines).next();
    let removed = kept_lines.difference(&now_lines).next();
    match (added, removed) {
        (Some(added), _) => Some(format!("lacks {added}")),
        (None, Some(removed)) => Some(format!("has {removed}, which is gone")),
        (None, None) => (kept != now).then(|| "has another order".to_owned()),
    }
}

/// The items of a list, and their members with their items: many items have a `new`.
fn with_items(list: &str) -> BTreeSet<String> {
    let mut item = "";
    let named = list.lines().map(|line| {
        if let Some(member) = line.strip_prefix("    ") {
            return format!("`{member}` of `{item}`");
        }
        item = line;
        format!("`{item}`")
    });
    named.collect()
}

/// The items of the crate whose pages are in `folder`, a line each, with their members indented.
fn listing(folder: &Path) -> Result<String, Failure> {
    let mut items = BTreeSet::new();
    for item in attributes(&page(&folder.join("all.html"))?, "<li><a href=\"") {
        let Some((kind, name)) = item_of(item) else { continue };
        items.insert((name, kind, item.to_owned()));
    }
    let mut text = String::new();
    for export in re_exports(folder, "")? {
        let _ = writeln!(text, "use {export}");
    }
    for (name, kind, item) in items {
        let _ = writeln!(text, "{kind} {name}");
        for member in members(&page(&folder.join(item))?) {
            let _ = writeln!(text, "    {member}");
        }
    }
    Ok(text)
}

/// The kind and the path of the item at `catalogue/struct.Entry.html`.
fn item_of(href: &str) -> Option<(String, String)> {
    let (module, file) = href.rsplit_once('/').unwrap_or(("", href));
    let (kind, name) = file.strip_suffix(".html")?.split_once('.')?;
    let path = module.split('/').filter(|step| !step.is_empty()).chain([name]);
    Some((kind.to_owned(), path.collect::<Vec<_>>().join("::")))
}

/// What the modules of a crate export from elsewhere without a page of its own.
fn re_exports(folder: &Path, module: &str) -> Result<BTreeSet<String>, Failure> {
    let index = page(&folder.join("index.html"))?;
    let path = |name: &str| format!("{module}{name}");
    let mut found: BTreeSet<_> =
        attributes(&index, "id=\"reexport.").into_iter().map(path).collect();
    for inner in attributes(&index, "class=\"mod\" href=\"") {
        // Another crate's pages have their own list.
        if inner.starts_with("../") {
            continue;
        }
        let Some(name) = inner.strip_suffix("/index.html") else { continue };
        found.extend(re_exports(&folder.join(name), &format!("{module}{name}::"))?);
    }
    Ok(found)
}

/// The members that an item declares, by their kinds.
fn members(page: &str) -> BTreeSet<String> {
    let own = page.split(END_OF_OWN).next().unwrap_or(page);
    let ids = attributes(own, "id=\"").into_iter();
    let member = |id: &str| {
        let prefix = MEMBERS.iter().find(|prefix| id.starts_with(**prefix))?;
        let name = id.get(prefix.len()..)?;
        // A name that is there again, as in another impl, has a number at its end.
        let name = match name.rsplit_once('-') {
            Some((name, number)) if number.bytes().all(|b| b.is_ascii_digit()) => name,
            _ => name,
        };
        let kind = match *prefix {
            "structfield." => "field",
            "tymethod." => "method",
            "associatedconstant." => "const",
            "associatedtype." => "type",
            other => other.trim_end_matches('.'),
        };
        Some(format!("{kind} {name}"))
    };
    ids.filter_map(member).collect()
}

/// The attributes that begin with `prefix`, each up to its closing quote.
fn attributes<'p>(page: &'p str, prefix: &str) -> Vec<&'p str> {
    page.split(prefix).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_are_those_that_the_item_declares() {
        let page = r#"<span id="structfield.rate"></span><section id="method.new">
            <section id="method.new-1"><div id="impl-Limits"><h2 id="trait-implementations">
            <section id="method.clone">"#;
        assert_eq!(members(page).into_iter().collect::<Vec<_>>(), ["field rate", "method new"]);
    }

    #[test]
    fn a_link_to_an_item_that_is_not_there_is_refused() {
        assert_eq!(dead_link(r#"<a href="struct.Shape.html">"#), None);
        assert_eq!(dead_link(r#"<a href="crate::Tool">"#), Some("crate::Tool"));
    }

    #[test]
    fn items_have_their_module() {
        let entry = item_of("catalogue/struct.Entry.html");
        assert_eq!(entry, Some(("struct".to_owned(), "catalogue::Entry".to_owned())));
    }

    #[test]
    fn an_addition_that_is_not_in_the_list_is_refused() {
        let kept = "struct Ball\n    method new\n";
        assert_eq!(difference(kept, kept), None);
        let added = "struct Ball\n    method new\n    method radius\n";
        let lacks = difference(kept, added);
        assert_eq!(lacks.as_deref(), Some("lacks `method radius` of `struct Ball`"));
        let gone = difference(added, kept);
        let said = "has `method radius` of `struct Ball`, which is gone";
        assert_eq!(gone.as_deref(), Some(said));
    }

    #[test]
    fn two_types_of_one_name_are_refused() {
        let mut types = BTreeMap::new();
        assert!(
            shared_names(&mut types, "palpate-plot", "struct Body\n    method new\n")
                .is_empty()
        );
        let shared = shared_names(&mut types, "palpate-render", "use Body\nenum cut::Body\n");
        assert_eq!(shared, ["palpate-render and palpate-plot both have a public type Body"]);
    }

    #[test]
    fn a_member_that_another_item_has_too_is_named() {
        let kept = "struct Ball\n    method new\nstruct Cube\n";
        let lacks =
            difference(kept, "struct Ball\n    method new\nstruct Cube\n    method new\n");
        assert_eq!(lacks.as_deref(), Some("lacks `method new` of `struct Cube`"));
        let other = difference(kept, "struct Cube\nstruct Ball\n    method new\n");
        assert_eq!(other.as_deref(), Some("has another order"));
    }
}
