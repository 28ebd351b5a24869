// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Properties that panic where they fail, on the same cases every time.

use arbitrary::Unstructured;

/// Checks a property on `count` cases. A case that cannot be drawn is skipped.
pub(crate) fn cases(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<()>,
) {
    let mut drawn = 0;
    palpate_testkit::cases::check(count, |u| {
        property(u)?;
        drawn += 1;
        Ok(Ok(()))
    });
    assert!(2 * drawn > count, "only {drawn} of {count} cases could be drawn");
}
