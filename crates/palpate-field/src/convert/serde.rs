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
        serialize(&self.matrix().map(Vector), serializer)
    }
}

impl<'de, const N: usize> Deserialize<'de> for Rotation<N> {
    /// Refuses rows that are no rotation.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rows: [Vector<f64, N>; N] = deserialize(deserializer)?;
        Self::from_rows(rows.map(|row| row.0)).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::Pose;
    use crate::promise::Promise;
    use crate::shape::Shape;

    #[test]
    fn poses_and_promises_are_read_back_to_the_bit() -> Result<(), Box<dyn std::error::Error>> {
        let turn = Rotation::from_axis_angle(Vector([1.0, 2.0, -0.5]), 0.8)?;
        let pose = Pose::new(turn * turn, Vector([0.1, 0.2, 0.3]));
        let text = serde_json::to_string(&pose)?;
        assert_eq!(serde_json::from_str::<Pose<3>>(&text)?, pose);
        let promise = *Shape::torus(0.5, 0.1)?.placed(&pose)?.promise();
        let text = serde_json::to_string(&promise)?;
        assert_eq!(serde_json::from_str::<Promise<3>>(&text)?, promise);
        Ok(())
    }

    #[test]
    fn a_vector_is_a_list_of_its_components() -> Result<(), serde_json::Error> {
        assert_eq!(serde_json::to_string(&Vector([0.5, -2.0]))?, "[0.5,-2.0]");
        assert!(serde_json::from_str::<Vector<f64, 2>>("[1.0]").is_err());
        assert!(serde_json::from_str::<Vector<f64, 2>>("[1.0,2.0,3.0]").is_err());
        Ok(())
    }

    #[test]
    fn what_is_no_rotation_is_not_read() {
        assert!(serde_json::from_str::<Rotation<2>>("[[1.0,0.0],[0.0,1.0]]").is_ok());
        assert!(serde_json::from_str::<Rotation<2>>("[[2.0,0.0],[0.0,2.0]]").is_err());
    }
}
