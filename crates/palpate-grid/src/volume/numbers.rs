// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Samples as files store them.

use std::io::Read;

use flate2::read::{MultiGzDecoder, ZlibDecoder};

use super::VolumeProblem;

/// Deflate makes at most so many bytes of one.
const MOST_INFLATED: usize = 1040;

/// The most samples of a volume: a gigabyte in memory.
pub(super) const MOST_SAMPLES: usize = 1 << 28;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// How bytes are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Raw,
    Gzip,
    Zlib,
}

impl Kind {
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A number's samples of a format.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored {
    pub(super) format: &'static str,
    pub(super) kind: Kind,
    pub(super) is_big: bool,
    pub(super) packing: Packing,
    pub(super) count: usize,
}

impl Stored {
    /// The samples at the beginning of `bytes`.
    pub(super) fn read(&self, bytes: &[u8]) -> Result<Vec<f32>, VolumeProblem> {
        let wrong = |problem: String| VolumeProblem::Malformed { format: self.format, problem };
        let length = self
            .count
            .checked_mul(self.kind.bytes())
            .ok_or_else(|| wrong("it has too many samples".to_owned()))?;
        let short =
            |found: usize| wrong(format!("its samples take {length} bytes, it has {found}"));
        if self.count > MOST_SAMPLES {
            return Err(wrong(format!(
                "it has {} samples, {MOST_SAMPLES} at most: cut it, or resample it coarser",
                self.count
            )));
        }
        let unpacked = match self.packing {
            Packing::Raw => None,
            _ if length > bytes.len().saturating_mul(MOST_INFLATED) => {
                return Err(short(bytes.len()));
            }
            Packing::Gzip => Some(inflated(MultiGzDecoder::new(bytes), length)),
            Packing::Zlib => Some(inflated(ZlibDecoder::new(bytes), length)),
        };
        let unpacked = unpacked.transpose().map_err(|error| wrong(error.to_string()))?;
        let bytes = unpacked.as_deref().unwrap_or(bytes);
        if bytes.len() > length {
            return Err(wrong(format!("its samples take {length} bytes, and more follow")));
        }
        let bytes = bytes.get(..length).ok_or_else(|| short(bytes.len()))?;
        Ok(self.numbers(bytes))
    }

    fn numbers(&self, bytes: &[u8]) -> Vec<f32> {
        macro_rules! all {
            ($t:ty) => {
                bytes
                    .as_chunks()
                    .0
                    .iter()
                    .map(|b| {
                        if self.is_big {
                            <$t>::from_be_bytes(*b)
                        } else {
                            <$t>::from_le_bytes(*b)
                        }
                    })
                    .map(|number| number as f32)
                    .collect()
            };
        }
        match self.kind {
            Kind::I8 => all!(i8),
            Kind::U8 => all!(u8),
            Kind::I16 => all!(i16),
            Kind::U16 => all!(u16),
            Kind::I32 => all!(i32),
            Kind::U32 => all!(u32),
            Kind::F32 => all!(f32),
            Kind::F64 => all!(f64),
        }
    }
}

/// The unpacked bytes, at most `length + 1`: one byte more shows that they are more than is said, and reading to the end
/// compares the checksum.
pub(super) fn inflated(from: impl Read, length: usize) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(length as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The numbers of a text, `N` of them.
pub(super) fn list<T: std::str::FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let parsed: Option<Vec<T>> = text
        .split(|c: char| c.is_whitespace() || c == ',')
        .filter(|part| !part.is_empty())
        .map(|part| part.parse().ok())
        .collect();
    parsed?.try_into().ok()
}
