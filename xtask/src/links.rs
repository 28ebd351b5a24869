// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rules on documents: a relative link leads to a file, and so does every path of the map in
//! ARCHITECTURE.md.

use std::path::{Path, PathBuf};

use crate::command::{Failure, root};
use crate::tree::{self, Text};

/// Where the map is.
const MAP: &str = "ARCHITECTURE.md";

/// Lines of the map that are so far to the right go on with a description.
const DESCRIPTION: usize = 12;

/// Checks every Markdown file.
pub(crate) fn check() -> Result<(), Failure> {
    let exists = |path: &Path| root().join(path).exists();
    let mut wrong = Vec::new();
    for text in tree::texts(&["md"])? {
        wrong.extend(dead_links(&text, exists));
        if text.path == Path::new(MAP) {
            wrong.extend(missing_in_map(&text.text, exists));
        }
    }
    Failure::any(wrong)
}

/// The relative links of a document that lead nowhere.
fn dead_links(text: &Text, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let folder = text.path.parent().unwrap_or(Path::new(""));
    let mut dead = Vec::new();
    for (i, line) in text.text.lines().enumerate() {
        for target in line.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let file = target.split(['#', ' ']).next().unwrap_or_default();
            let is_relative = !file.is_empty() && !file.contains(':');
            if is_relative && !exists(&folder.join(file)) {
                let place = format!("{}, line {}", text.path.display(), i + 1);
                dead.push(format!("{place}: the link {target} leads nowhere"));
            }
        }
    }
    dead
}

/// The paths of the map that are not there.
fn missing_in_map(text: &str, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let Some(map) = text.split("```text\n").nth(1).and_then(|rest| rest.split("```").next())
    else {
        return vec![format!("{MAP} has no map")];
    };
    let mut folders: Vec<PathBuf> = Vec::new();
    let mut missing = Vec::new();
    for line in map.lines() {
        let depth = line.len() - line.trim_start().len();
        if depth >= DESCRIPTION || line.trim().is_empty() {
            continue;
        }
        folders.truncate(depth / 2);
        let parent = folders.last().cloned().unwrap_or_default();
        let names = line.trim_start().split("  ").next().unwrap_or_default();
        // Names after the first are beside it.
        let mut beside = parent.clone();
        for (i, name) in names.split(' ').enumerate() {
            let path = if i == 0 { parent.join(name) } else { beside.join(name) };
            if !exists(&path) {
                missing.push(format!("{MAP}: {} is on the map, but not there", path.display()));
            }
            if i == 0 {
                beside = path.parent().map(Path::to_owned).unwrap_or_default();
                folders.push(path);
            }
        }
    }
    missing
}

#[cfg(test)]
mod tests {
    use super::*;

    fn only<'a>(there: &'a [&str]) -> impl Fn(&Path) -> bool + 'a {
        |path| there.contains(&path.to_string_lossy().trim_end_matches('/'))
    }

    #[test]
    fn a_link_that_leads_nowhere_is_refused() {
        let text = "[a](b.md), [c](../d.md#part)\n[e](https://f.org) [g](#here) ![h](i.png)\n";
        let text = Text { path: "docs/x.md".into(), text: text.to_owned() };
        let dead = dead_links(&text, only(&["docs/b.md", "docs/i.png"]));
        assert_eq!(dead, ["docs/x.md, line 1: the link ../d.md#part leads nowhere"]);
        assert_eq!(dead_links(&text, only(&["docs/b.md", "docs/../d.md"])).len(), 1);
        assert_eq!(dead_links(&text, |_| true), [""; 0]);
    }

    #[test]
    fn a_path_of_the_map_that_is_not_there_is_refused() {
        let map = "# Map\n\n```text\ncrates/\n  one/          the first\n    src/a.rs b.rs\n             \
                   which are\n    src/c/ d/    folders\nlast.toml\n```\n";
        let all = [
            "crates",
            "crates/one",
            "crates/one/src/a.rs",
            "crates/one/src/b.rs",
            "crates/one/src/c",
            "crates/one/src/d",
            "last.toml",
        ];
        assert_eq!(missing_in_map(map, only(&all)), [""; 0]);
        for gone in all {
            let rest: Vec<_> = all.into_iter().filter(|path| *path != gone).collect();
            let missing = missing_in_map(map, only(&rest));
            assert_eq!(missing.len(), 1, "{missing:?}");
            assert!(missing[0].contains(gone), "{missing:?}");
        }
        assert_eq!(missing_in_map("no map", |_| true), ["ARCHITECTURE.md has no map"]);
    }
}
