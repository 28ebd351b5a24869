// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reading and writing with serde. Arrays of `D` items are tuples, which serde's derive does
//! not know for a `D` that is not yet given.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeTuple, Serializer};

use crate::pose::Rotation;
use crate::vector::Vector;

/// Writes an array as a tuple.
pub(crate) fn serialize<S: Serializer, T: Serialize, const N: usize>(
    items: &[T; N],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut tuple = serializer.serialize_tuple(N)?;
    for item in items {
        tuple.serialize_element(item)?;
    }
    tuple.end()
}

/// Writes a matrix as a tuple of its rows.
pub(crate) fn rows<S: Serializer, const N: usize>(
    rows: &[[f64; N]; N],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serialize(&rows.map(Vector), serializer)
}

/// Reads an array from a tuple.
pub(crate) fn deserialize<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    deserializer: D,
) -> Result<[T; N], D::Error> {
    deserializer.deserialize_tuple(N, Items(PhantomData))
}

/// Takes exactly `N` items.
struct Items<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for Items<T, N> {
    type Value = [T; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{N} items")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<[T; N], A::Error> {
        let mut items = Vec::with_capacity(N);
        while let Some(item) = sequence.next_element()? {
            items.push(item);
        }
        let count = items.len();
        items.try_into().map_err(|_| A::Error::invalid_length(count, &self))
    }
}

impl<T: Serialize, const N: usize> Serialize for Vector<T, N> {
    /// As the tuple of its components.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serialize(&self.0, serializer)
    }
}

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Vector<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserialize(deserializer).map(Self)
    }
}

impl<const N: usize> Serialize for Rotation<N> {
    /// As the rows of its matrix.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        rows(self.matrix(), serializer)
    }
}

impl<'de, const N: usize> Deserialize<'de> for Rotation<N> {
    /// Refuses rows that are no rotation.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rows: [Vector<f64, N>; N] = deserialize(deserializer)?;
        Self::from_rows(rows.map(|row| row.0)).map_err(D::Error::custom)
    }
}
