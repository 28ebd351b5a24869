// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The licence rule: what the program is built from is MIT, Apache-2.0, BSD,
//! MPL-2.0 or as free as they are.

use serde_json::Value;

use crate::command::Failure;

/// Licences that a dependency may have.
const ALLOWED: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-1-Clause",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "MPL-2.0",
    "NCSA",
    "OFL-1.1",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Checks the licence of every package of the dependency tree.
pub(crate) fn check(metadata: &Value) -> Result<(), Failure> {
    let mut wrong = Vec::new();
    let packages = metadata["packages"].as_array().into_iter().flatten();
    for package in packages {
        let name = package["name"].as_str().unwrap_or_default();
        let licence = package["license"].as_str().unwrap_or_default();
        if !is_allowed(licence) {
            wrong.push(format!("{name} has the licence {licence:?}"));
        }
    }
    Failure::any(wrong)
}

/// `true` if a licence expression can be met with allowed licences: a choice
/// (`OR`, or the older `/`) needs one, a conjunction (`AND`) all.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ");
    any_of(expression.trim())
}

fn any_of(expression: &str) -> bool {
    split_outside_parentheses(expression, " OR ").iter().any(|part| all_of(part))
}

fn all_of(expression: &str) -> bool {
    split_outside_parentheses(expression, " AND ").iter().all(|part| {
        let part = part.trim();
        match part.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) {
            Some(inner) => any_of(inner),
            None => ALLOWED.contains(&part),
        }
    })
}

/// The parts of `text` between separators that are in no parentheses.
fn split_outside_parentheses<'a>(text: &'a str, separator: &str) -> Vec<&'a str> {
    let mut parts = Vec::new();
    let (mut start, mut depth) = (0, 0_i32);
    for (i, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ if depth == 0 && text[i..].starts_with(separator) && i >= start => {
                parts.push(&text[start..i]);
                start = i + separator.len();
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_without_a_free_licence_is_refused() {
        let packages = |licence: Value| {
            serde_json::json!({
                "packages": [
                    { "name": "good", "license": "MIT" },
                    { "name": "other", "license": licence },
                ],
            })
        };
        check(&packages("ISC".into())).unwrap();
        for bad in ["GPL-3.0".into(), Value::Null] {
            let said = check(&packages(bad)).unwrap_err().0;
            assert!(said.starts_with("other has the licence"), "{said}");
        }
    }

    #[test]
    fn choices_need_one_allowed_licence_and_conjunctions_all() {
        assert!(is_allowed("MIT"));
        assert!(is_allowed("GPL-3.0 OR MIT"));
        assert!(is_allowed("MIT/Apache-2.0"));
        assert!(is_allowed("(MIT OR GPL-2.0) AND OFL-1.1"));
        assert!(!is_allowed("MIT AND GPL-3.0"));
        assert!(!is_allowed("(GPL-2.0 OR LGPL-3.0) AND MIT"));
        assert!(!is_allowed(""));
    }
}
