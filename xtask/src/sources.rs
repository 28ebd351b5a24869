// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rules on Rust files: how they begin, and where `unsafe` may be.

use std::path::Path;

use crate::command::Failure;
use crate::tree::{self, Text};

/// How every Rust file begins.
const HEADER: &str = "// SPDX-FileCopyrightText: The palpate authors\n\
                      // SPDX-License-Identifier: MIT OR Apache-2.0\n";

/// The modules where `unsafe` is allowed, and why.
const UNSAFE_MODULES: &[(&str, &str)] = &[
    ("crates/palpate-field/src/machine", "instruction sets and unwritten scratch memory"),
    (
        "crates/palpate-field/tests/all/allocation.rs",
        "an allocator that counts, to prove that none happens",
    ),
];

/// The lint that denies unsafe code, as attributes name it.
const LINT: &str = concat!("unsafe", "_code");

/// What follows the keyword where it opens something.
const UNSAFE_USES: &[&str] = &["{", "fn", "impl", "trait", "extern"];

/// Checks every Rust file of the repository, and that every crate inherits the lints.
pub(crate) fn check() -> Result<(), Failure> {
    let texts = tree::texts(&["rs", "toml"])?;
    let mut wrong = Vec::new();
    for Text { path, text } in &texts {
        if path.extension().is_some_and(|ending| ending == "rs") {
            wrong.extend(problems(path, text));
        } else {
            wrong.extend(manifest_problems(path, text));
        }
    }
    for (module, why) in UNSAFE_MODULES {
        println!("unsafe is allowed in {module}: {why}");
        let mut inside = texts.iter().filter(|text| text.path.starts_with(module));
        if !inside.any(|text| text.text.contains(LINT)) {
            wrong.push(format!("{module} is listed for unsafe code, but has none"));
        }
    }
    Failure::any(wrong)
}

/// What is wrong with a Rust file.
fn problems(path: &Path, text: &str) -> Vec<String> {
    let shown = path.display();
    let mut wrong = Vec::new();
    if !text.starts_with(HEADER) {
        wrong.push(format!("{shown} does not begin with the two SPDX lines"));
    }
    let is_listed = UNSAFE_MODULES.iter().any(|(module, _)| path.starts_with(module));
    // Whether it is allowed or expected: an attribute over several lines names it too.
    if !is_listed && text.contains(LINT) {
        wrong.push(format!("{shown} names the lint {LINT}; it is not a listed module"));
    }
    if !is_listed && text.lines().any(is_unsafe) {
        wrong.push(format!("{shown} has unsafe code; it is not a listed module"));
    }
    wrong
}

/// `true` if a line of code, not of comment, opens something unsafe.
fn is_unsafe(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    let mut words = code.split_whitespace().peekable();
    while let Some(word) = words.next() {
        let is_keyword = word.trim_start_matches(['(', '{', '|', '=']) == "unsafe";
        if is_keyword && words.peek().is_some_and(|next| UNSAFE_USES.contains(next)) {
            return true;
        }
    }
    false
}

/// What is wrong with a manifest: a crate that does not inherit the lints may have anything.
fn manifest_problems(path: &Path, text: &str) -> Option<String> {
    let is_fuzz = path.starts_with("fuzz");
    if text.contains("[package]") && !is_fuzz && !text.contains("[lints]\nworkspace = true\n") {
        return Some(format!("{} does not inherit the lints of the workspace", path.display()));
    }
    if text.contains("[workspace.lints") && !text.contains(&format!("{LINT} = \"deny\"")) {
        return Some(format!("{} does not deny {LINT}", path.display()));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(path: &str, body: &str) -> Vec<String> {
        problems(Path::new(path), &format!("{HEADER}{body}"))
    }

    #[test]
    fn a_good_file_has_no_problem() {
        let body = "//! Unsafe is a word.\nfn f() {} // unsafe { } is not here\n";
        assert_eq!(of("crates/a/src/lib.rs", body), [""; 0]);
    }

    #[test]
    fn a_file_without_its_licence_is_refused() {
        let wrong = problems(Path::new("a.rs"), "//! A file.\n");
        assert_eq!(wrong, ["a.rs does not begin with the two SPDX lines"]);
    }

    #[test]
    fn what_is_unsafe_outside_listed_modules_is_refused() {
        // Attributes that the rule must refuse, in parts, so that they are none of this file.
        for attribute in [
            concat!("#!", "[allow(L)]"),
            concat!("#", "[expect(L, reason = \"fast\")]"),
            concat!("#!", "[warn(\n    L,\n)]"),
        ] {
            let body = attribute.replace('L', LINT);
            assert_eq!(of("crates/a/src/lib.rs", &body).len(), 1, "{body}");
            assert_eq!(of("crates/palpate-field/src/machine/lanes.rs", &body), [""; 0]);
        }
        let keyword = concat!("un", "safe");
        for code in ["let x = K { f() };", "K fn f() {}", "K impl Send for A {}", "(K { 1 })"] {
            let body = code.replace('K', keyword);
            let wrong = of("crates/a/src/lib.rs", &body);
            assert!(wrong[0].ends_with("has unsafe code; it is not a listed module"), "{body}");
        }
    }

    #[test]
    fn a_crate_that_does_not_inherit_lints_is_refused() {
        let path = Path::new("crates/a/Cargo.toml");
        let package = "[package]\nname = \"a\"\n";
        assert!(manifest_problems(path, package).is_some());
        let inherits = format!("{package}\n[lints]\nworkspace = true\n");
        assert_eq!(manifest_problems(path, &inherits), None);
        let lints = |level: &str| format!("[workspace.lints.rust]\n{LINT} = \"{level}\"\n");
        assert!(manifest_problems(Path::new("Cargo.toml"), &lints("warn")).is_some());
        assert_eq!(manifest_problems(Path::new("Cargo.toml"), &lints("deny")), None);
    }
}
