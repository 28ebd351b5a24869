// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What methods have in common beside their loop: names on command lines, and starts.

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

/// Gives a method over elements its two public searches, from its own `search`.
macro_rules! element_search {
    ($method:ident, $start:literal) => {
        impl $method {
            #[doc = concat!("The search for the least value of a field over an element", $start, ".")]
            #[must_use]
            pub fn descend<const N: usize, const D: usize>(
                &self,
                shape: &Shape<D>,
                element: &Element<N, D>,
            ) -> Descent<D> {
                self.search(shape, element, None)
            }

            /// The same search from another point of the element.
            #[must_use]
            pub fn descend_from<const N: usize, const D: usize>(
                &self,
                shape: &Shape<D>,
                element: &Element<N, D>,
                start: &Weights<N>,
            ) -> Descent<D> {
                self.search(shape, element, Some(start))
            }
        }
    };
}
