// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NanoVDB: sparse grids in segments, each with a list of its grids, or as they lie in memory.
//! Layout: `NanoVDB.h` and `PNanoVDB.h` of <https://github.com/AcademySoftwareFoundation/openvdb>.
//!
//! Every place and count of a file is checked against its bytes before it is followed.

mod tree;

use std::borrow::Cow;

use flate2::read::ZlibDecoder;

use super::{LARGEST_VOLUME, Volume, VolumeProblem, inflated};

const FORMAT: &str = "NanoVDB";

/// What OpenVDB's files begin with.
const OPEN_VDB: [u8; 8] = 0x5644_4220_u64.to_le_bytes();

/// The layout that is read; another number means other places.
const MAJOR: u32 = 32;

/// The bytes before the list of a segment, and of an entry of the list before the grid's name.
const SEGMENT: usize = 16;
const ENTRY: usize = 176;

/// Names that an error lists at most, and the characters of each, so that it can be read.
const NAMES: usize = 8;
const NAME: usize = 64;

/// What a grid may unpack to whatever it is packed in, and beyond that for each packed byte. Numbers of a field pack
/// to a fifth at the least, and empty tables hardly count beside them; a larger rate lets a small file take memory.
const FREE: usize = 1 << 25;
const RATE: usize = 64;

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

/// Bytes in which every place is looked up with a check.
#[derive(Clone, Copy)]
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn part(self, place: usize, length: usize) -> Result<&'a [u8], VolumeProblem> {
        let end = place.checked_add(length);
        end.and_then(|end| self.0.get(place..end)).ok_or_else(|| {
            let all = self.0.len();
            wrong(format!(
                "{length} bytes at {place} lie beyond its {all}: it is cut off or damaged"
            ))
        })
    }

    fn at<const N: usize>(self, place: usize) -> Result<[u8; N], VolumeProblem> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.part(place, N)?);
        Ok(bytes)
    }

    fn u16(self, place: usize) -> Result<u16, VolumeProblem> {
        self.at(place).map(u16::from_le_bytes)
    }

    fn u32(self, place: usize) -> Result<u32, VolumeProblem> {
        self.at(place).map(u32::from_le_bytes)
    }

    fn u64(self, place: usize) -> Result<u64, VolumeProblem> {
        self.at(place).map(u64::from_le_bytes)
    }

    fn f64(self, place: usize) -> Result<f64, VolumeProblem> {
        self.at(place).map(f64::from_le_bytes)
    }

    /// A count of bytes, which no machine's memory need hold.
    fn size(self, place: usize) -> Result<usize, VolumeProblem> {
        Ok(usize::try_from(self.u64(place)?).unwrap_or(usize::MAX))
    }
}

/// How a grid is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Codec {
    Raw,
    Zip,
}

/// A grid of a file.
struct Entry<'a> {
    name: &'a [u8],
    kind: u32,
    codec: Codec,
    /// What the file holds of it.
    stored: &'a [u8],
    /// Its size, unpacked [bytes].
    size: usize,
}

/// The grid of a name, or the only one of a kind that is read.
pub(super) fn read(bytes: &[u8], name: Option<&str>) -> Result<Volume, VolumeProblem> {
    if bytes.starts_with(&OPEN_VDB) {
        return Err(VolumeProblem::OpenVdb);
    }
    let bytes = Bytes(bytes);
    let is_old = match bytes.0.first_chunk() {
        Some(b"NanoVDB0") => true,
        Some(b"NanoVDB1") => return chosen(&grids(bytes)?, name)?.volume(),
        Some(b"NanoVDB2") => false,
        _ => return Err(wrong("it does not begin with NanoVDB0, NanoVDB1 or NanoVDB2")),
    };
    // Segments and grids in memory once began alike; only a segment has its version here and in its first entry.
    let has_version = |place| bytes.u32(place).is_ok_and(|version| major(version) == MAJOR);
    if is_old && has_version(16) && !(has_version(8) && has_version(SEGMENT + ENTRY - 4)) {
        return chosen(&grids(bytes)?, name)?.volume();
    }
    chosen(&segments(bytes)?, name)?.volume()
}

/// The grids of a file that holds them as memory does, one after the other.
fn grids(bytes: Bytes<'_>) -> Result<Vec<Entry<'_>>, VolumeProblem> {
    let mut entries = Vec::new();
    let mut place = 0;
    while place < bytes.0.len() {
        let rest = Bytes(bytes.part(place, bytes.0.len() - place)?);
        let size = rest.size(32)?;
        if size < tree::HEAD {
            return Err(wrong(format!("the grid at byte {place} has {size} bytes")));
        }
        let (stored, kind, name) = (rest.part(0, size)?, rest.u32(636)?, rest.part(40, 256)?);
        entries.push(Entry { name, kind, codec: Codec::Raw, stored, size });
        place += size;
    }
    Ok(entries)
}

/// The grids of all segments of a file.
fn segments(bytes: Bytes<'_>) -> Result<Vec<Entry<'_>>, VolumeProblem> {
    let mut entries = Vec::new();
    let mut place = 0;
    while place < bytes.0.len() {
        if !matches!(&bytes.at(place)?, b"NanoVDB0" | b"NanoVDB2") {
            return Err(wrong(format!("no segment begins at byte {place}")));
        }
        known_version(bytes.u32(place + 8)?)?;
        let (count, codec) = (bytes.u16(place + 12)?, codec(bytes.u16(place + 14)?)?);
        if count == 0 {
            return Err(wrong(format!("the segment at byte {place} has no grids")));
        }
        place += SEGMENT;
        let first = entries.len();
        let mut lengths = Vec::new();
        for _ in 0..count {
            let length = bytes.u32(place + 136)? as usize;
            let (size, kind) = (bytes.size(place)?, bytes.u32(place + 32)?);
            lengths.push(bytes.size(place + 8)?);
            let name = bytes.part(place + ENTRY, length)?;
            entries.push(Entry { name, kind, codec, stored: &[], size });
            place += ENTRY + length;
        }
        for (entry, length) in entries[first..].iter_mut().zip(lengths) {
            entry.stored = bytes.part(place, length)?;
            place += length;
        }
    }
    Ok(entries)
}

fn codec(number: u16) -> Result<Codec, VolumeProblem> {
    match number {
        0 => Ok(Codec::Raw),
        1 => Ok(Codec::Zip),
        2 => Err(wrong(
            "it is packed with BLOSC, which is not read; `nanovdb_convert --zip in.vdb out.nvdb` \
             packs as is read, without `--zip` and `--blosc` it is not packed",
        )),
        other => {
            Err(wrong(format!("it is packed in the way {other}; 0 (not) and 1 (zip) are read")))
        }
    }
}

const fn major(version: u32) -> u32 {
    version >> 21
}

/// Refuses other layouts than the one read.
fn known_version(version: u32) -> Result<(), VolumeProblem> {
    let (major, minor, patch) = (major(version), version >> 10 & 0x7ff, version & 0x3ff);
    if major == MAJOR {
        return Ok(());
    }
    Err(wrong(format!(
        "it has version {major}.{minor}.{patch}, {MAJOR}.x is read; convert it again with a `nanovdb_convert` of \
         OpenVDB 9 or later"
    )))
}

/// The grid of this name, or else the only one of a kind that is read.
fn chosen<'a, 'b>(
    entries: &'b [Entry<'a>],
    name: Option<&str>,
) -> Result<&'b Entry<'a>, VolumeProblem> {
    let is_meant = |entry: &&Entry<'_>| match name {
        Some(name) => entry.name() == name,
        None => tree::Kind::of(entry.kind).is_ok(),
    };
    let mut meant = entries.iter().filter(is_meant);
    match (meant.next(), meant.next(), entries) {
        (Some(only), None, _) => Ok(only),
        (None, _, [single]) if name.is_none() => {
            Err(tree::Kind::of(single.kind).err().unwrap_or_else(|| wrong("no grid")))
        }
        (found, _, _) => Err(wrong(match (name, found) {
            (None, None) => format!("none of its grids is one of numbers: {}", listed(entries)),
            (None, Some(_)) => format!(
                "it has several grids: {}; say which one, in a scene by \"grid\": \"NAME\" beside \"file\"",
                listed(entries)
            ),
            (Some(name), None) => format!("it has no grid {name:?}, only {}", listed(entries)),
            (Some(name), Some(_)) => format!(
                "several of its grids have the name {name:?}: {}; write the one meant to a file of its own",
                listed(entries)
            ),
        })),
    }
}

/// The grids of a file, as many as an error can list.
fn listed(entries: &[Entry<'_>]) -> String {
    let most = entries.len().min(NAMES);
    let mut names: Vec<String> = entries[..most]
        .iter()
        .map(|entry| format!("{} ({})", entry.said(), tree::name(entry.kind)))
        .collect();
    if most < entries.len() {
        names.push(format!("{} more", entries.len() - most));
    }
    names.join(", ")
}

impl Entry<'_> {
    /// The name, which ends at a zero.
    fn name(&self) -> Cow<'_, str> {
        let name = self.name.split(|byte| *byte == 0).next().unwrap_or_default();
        String::from_utf8_lossy(name)
    }

    /// The beginning of the name, in quotes and without what a terminal would obey.
    fn said(&self) -> String {
        format!("{:?}", self.name().chars().take(NAME).collect::<String>())
    }

    fn volume(&self) -> Result<Volume, VolumeProblem> {
        let grid = self.unpacked()?;
        let head = Bytes(&grid);
        if !matches!(&head.at(0)?, b"NanoVDB0" | b"NanoVDB1") {
            return Err(wrong(format!(
                "the grid {} does not begin with NanoVDB0 or NanoVDB1",
                self.said()
            )));
        }
        known_version(head.u32(16)?)?;
        if head.u32(636)? != self.kind || head.size(32)? != self.size {
            return Err(wrong(format!(
                "the grid {} has {} bytes of {}, the list of grids says {} of {}",
                self.said(),
                head.u64(32)?,
                tree::name(head.u32(636)?),
                self.size,
                tree::name(self.kind)
            )));
        }
        tree::volume(head, tree::Kind::of(self.kind)?)
    }

    /// The grid as it lies in memory.
    fn unpacked(&self) -> Result<Cow<'_, [u8]>, VolumeProblem> {
        let short = |found: usize| {
            wrong(format!("the grid {} takes {} bytes, it has {found}", self.said(), self.size))
        };
        if self.codec == Codec::Raw {
            let bytes = self.stored.get(..self.size).ok_or_else(|| short(self.stored.len()))?;
            return Ok(Cow::Borrowed(bytes));
        }
        let stored = Bytes(self.stored);
        let packed = stored.part(8, stored.size(0)?)?;
        let most = FREE.max(packed.len().saturating_mul(RATE));
        if self.size > most || self.size as u64 > LARGEST_VOLUME {
            return Err(wrong(format!(
                "the grid {} says that its {} bytes unpack to {}, {} at most are unpacked: write it without `--zip`",
                self.said(),
                packed.len(),
                self.size,
                (most as u64).min(LARGEST_VOLUME)
            )));
        }
        let bytes = inflated(ZlibDecoder::new(packed), self.size)
            .map_err(|error| wrong(error.to_string()))?;
        if bytes.len() == self.size { Ok(Cow::Owned(bytes)) } else { Err(short(bytes.len())) }
    }
}
