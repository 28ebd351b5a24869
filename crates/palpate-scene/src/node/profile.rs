// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The names of the profiles of smooth booleans.

use std::fmt;

use palpate_field::operator::Profile;
use serde::Deserialize;
use serde::de::{Deserializer, EnumAccess, Error, VariantAccess, Visitor};

/// The names in files, in the order of [`PROFILES`].
pub(crate) const NAMES: [&str; 7] = [
    "quadratic",
    "cubic",
    "quartic",
    "circular",
    "root",
    "exponential",
    "circular_geometrical",
];

const PROFILES: [Profile; 7] = [
    Profile::Quadratic,
    Profile::Cubic,
    Profile::Quartic,
    Profile::Circular,
    Profile::Root,
    Profile::Exponential,
    Profile::CircularGeometrical,
];

/// The name of a profile in files.
pub(super) fn name(profile: Profile) -> &'static str {
    NAMES[profile as usize]
}

/// A profile that is read by its name.
pub(super) struct ByName(pub(super) Profile);

impl<'de> Deserialize<'de> for ByName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("Profile", &NAMES, NameVisitor)
    }
}

struct NameVisitor;

impl<'de> Visitor<'de> for NameVisitor {
    type Value = ByName;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a profile")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<ByName, A::Error> {
        let (name, content) = data.variant::<String>()?;
        content.unit_variant()?;
        let known = NAMES.iter().zip(PROFILES).find(|(known, _)| **known == name);
        let (_, profile) = known.ok_or_else(|| A::Error::unknown_variant(&name, &NAMES))?;
        Ok(ByName(profile))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_profile_has_its_name() {
        for (profile, known) in PROFILES.into_iter().zip(NAMES) {
            assert_eq!(name(profile), known);
            let debug = format!("{profile:?}").to_lowercase();
            assert_eq!(debug, known.replace('_', ""));
        }
    }
}
