// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Names of methods on command lines.

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
            type Err = palpate_field::UnknownName;

            fn from_str(name: &str) -> Result<Self, palpate_field::UnknownName> {
                let is_meant = |method: &&Self| method.name() == name;
                let known = || Self::ALL.iter().map(|method| method.name());
                let found = Self::ALL.iter().find(is_meant).copied();
                found.ok_or_else(|| palpate_field::UnknownName::new("method", name, known()))
            }
        }
    };
}
