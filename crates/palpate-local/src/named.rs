// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Names of methods on command lines.

/// A name that no method has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no method {name:?}; there are {known}")]
#[non_exhaustive]
pub struct UnknownMethod {
    /// The name.
    pub name: String,
    /// The names of the methods, separated by commas.
    pub known: String,
}

/// Writes the names of methods, and reads them.
macro_rules! named {
    ($method:ident: $($variant:ident = $name:literal),+) => {
        impl $method {
            /// All there are.
            pub const ALL: &[Self] = &[$(Self::$variant),+];

            /// The name on command lines.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }
        }

        impl std::fmt::Display for $method {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        impl std::str::FromStr for $method {
            type Err = $crate::UnknownMethod;

            fn from_str(name: &str) -> Result<Self, $crate::UnknownMethod> {
                let is_meant = |method: &&Self| method.name() == name;
                Self::ALL.iter().find(is_meant).copied().ok_or_else(|| {
                    let known: Vec<_> = Self::ALL.iter().map(|method| method.name()).collect();
                    $crate::UnknownMethod { name: name.to_owned(), known: known.join(", ") }
                })
            }
        }
    };
}
