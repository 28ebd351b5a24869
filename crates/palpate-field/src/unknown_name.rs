// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A name that nothing has.

/// No device, material, actuator or method has this name.
///
/// ```
/// use palpate_field::UnknownName;
///
/// let error = UnknownName::new("colour", "blu", ["red", "blue"]);
/// assert_eq!(error.to_string(), "there is no colour \"blu\"; there are red, blue");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} {name:?}; there are {}", known.join(", "))]
#[non_exhaustive]
pub struct UnknownName {
    /// What has a name: "device".
    pub what: &'static str,
    /// The name that was asked for.
    pub name: String,
    /// The names that there are.
    pub known: Vec<&'static str>,
}

impl UnknownName {
    /// The error that no `what` has this `name`, but those that are `known`.
    #[must_use]
    pub fn new(
        what: &'static str,
        name: &str,
        known: impl IntoIterator<Item = &'static str>,
    ) -> Self {
        Self { what, name: name.to_owned(), known: known.into_iter().collect() }
    }
}
