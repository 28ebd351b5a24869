// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A grid of NanoVDB, a tree of cubes of voxels, as samples on a lattice.
//!
//! The root lists cubes of 4096³ voxels, which have 32³ cubes of 128³, which have 16³ of 8³: the leaves. A cube is
//! one value or has children, and is active or not. A grid tells how many nodes its tree has; more are refused, so
//! that the walk of a tree whose places are wrong ends.

use std::collections::HashSet;

use palpate_field::Vector;

use super::{Bytes, wrong};
use crate::volume::{Inside, Volume, VolumeProblem};

/// The bytes of a grid before its tree, and of the tree before its nodes.
const GRID: usize = 672;
pub(super) const HEAD: usize = GRID + 64;

/// Samples of a volume that NanoVDB may become, at most; four bytes of each are as much as the largest file.
const MOST: u64 = super::LARGEST_VOLUME / 4;

/// Samples whatever the size of the grid, and beyond them for each byte. A band of three voxels about a surface of
/// 500 voxels has 5 to a byte, with half a byte a voxel 20; without this rule a small file takes all memory.
const FREE: u64 = 1 << 24;
const RATE: u64 = 32;

/// Voxels along the edge of a leaf, and in a leaf.
const LEAF: i64 = 8;
const VOXELS: usize = 512;

/// The names of the kinds, by number.
const NAMES: [&str; 27] = [
    "unknown",
    "float",
    "double",
    "int16",
    "int32",
    "int64",
    "vec3f",
    "vec3d",
    "mask",
    "half",
    "uint32",
    "bool",
    "rgba8",
    "fp4",
    "fp8",
    "fp16",
    "fpN",
    "vec4f",
    "vec4d",
    "index",
    "onIndex",
    "indexMask",
    "onIndexMask",
    "pointIndex",
    "vec3u8",
    "vec3u16",
    "uint8",
];

/// How voxels are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Float,
    Double,
    /// So many bits a voxel, in steps from the least value of its leaf.
    Fixed(usize),
    /// The same, with the bits that the leaf tells.
    Variable,
}

pub(super) fn name(kind: u32) -> String {
    let known = NAMES.get(kind as usize).map(|name| (*name).to_owned());
    known.unwrap_or_else(|| format!("type {kind}"))
}

impl Kind {
    pub(super) fn of(number: u32) -> Result<Self, VolumeProblem> {
        match number {
            1 => Ok(Self::Float),
            2 => Ok(Self::Double),
            13 => Ok(Self::Fixed(4)),
            14 => Ok(Self::Fixed(8)),
            15 => Ok(Self::Fixed(16)),
            16 => Ok(Self::Variable),
            other => Err(wrong(format!(
                "its voxels are {}; float, double, fp4, fp8, fp16 and fpN are read: make it a grid of float in \
                 OpenVDB and convert that",
                name(other)
            ))),
        }
    }

    const fn is_double(self) -> bool {
        matches!(self, Self::Double)
    }

    /// Byte offsets in the root: of the tile list, of the background value, of the value within a tile.
    const fn root(self) -> [usize; 3] {
        if self.is_double() { [96, 32, 24] } else { [64, 28, 20] }
    }

    /// The bytes of a leaf before its voxels.
    const fn leaf_head(self) -> usize {
        if self.is_double() { 128 } else { 96 }
    }

    /// The bytes of the smallest leaf.
    const fn least_leaf(self) -> usize {
        let bits = match self {
            Self::Float => 32,
            Self::Double => 64,
            Self::Fixed(bits) => bits,
            Self::Variable => 1,
        };
        self.leaf_head() + VOXELS / 8 * bits
    }

    fn value(self, bytes: Bytes<'_>, place: usize) -> Result<f32, VolumeProblem> {
        if self.is_double() {
            return Ok(bytes.f64(place)? as f32);
        }
        bytes.at(place).map(f32::from_le_bytes)
    }
}

/// The nodes between root and leaves.
struct Level {
    /// Children along each axis, as a power of two.
    log: u32,
    /// Voxels along the edge of a child.
    side: i64,
    /// The bytes before the list of children.
    table: usize,
    bytes: usize,
}

const LEVELS: [Level; 2] = [
    Level { log: 5, side: 128, table: 8256, bytes: 270_400 },
    Level { log: 4, side: LEAF, table: 1088, bytes: 33_856 },
];

/// An entry of the root's list, and the edge of its cube [voxels].
const ENTRY: usize = 32;
const ROOT: i64 = 4096;

/// A cube without children, or a leaf.
struct Part<'a> {
    /// Its first voxel.
    first: [i64; 3],
    /// Voxels along its edge.
    side: i64,
    what: What<'a>,
}

enum What<'a> {
    Tile { value: f32, is_active: bool },
    Leaf(&'a [u8]),
}

/// The tree of a grid.
struct Tree<'a> {
    bytes: Bytes<'a>,
    kind: Kind,
    root: usize,
    /// Nodes of each level and leaves, as the grid tells.
    counts: [usize; 3],
}

pub(super) fn volume(bytes: Bytes<'_>, kind: Kind) -> Result<Volume, VolumeProblem> {
    let tree = Tree::new(bytes, kind)?;
    let [least, most] = tree.active()?;
    // A voxel around the active ones, so that a surface ends at values that the grid tells.
    let [first, last] = [least.map(|i| i - 1), most.map(|i| i + 1)];
    let spans: [u64; 3] = std::array::from_fn(|axis| last[axis].abs_diff(first[axis]) + 1);
    let nodes = spans.iter().try_fold(1_u64, |all, span| all.checked_mul(*span));
    let size = bytes.0.len() as u64;
    let allowed = MOST.min(FREE.max(size.saturating_mul(RATE)));
    if nodes.is_none_or(|nodes| nodes > allowed) {
        return Err(VolumeProblem::TooWide { spans, allowed });
    }
    let background = kind.value(bytes, tree.root + kind.root()[1])?;
    // Spans are below 2^28 here.
    let mut dense = Dense::new(first, spans.map(|span| span as usize), background);
    tree.walk(Which::All, &mut |part| dense.fill(&part, kind))?;
    // World = matrix · index + translation, the matrix row by row.
    let at = |place: usize, i: usize| bytes.f64(place + 8 * i);
    let mut steps = [Vector::ZERO; 3];
    let mut origin: Vector<f64, 3> = Vector::ZERO;
    for row in 0..3 {
        for (axis, step) in steps.iter_mut().enumerate() {
            step[row] = at(384, 3 * row + axis)?;
        }
        origin[row] = at(528, row)?;
    }
    for (step, first) in steps.iter().zip(first) {
        origin += *step * first as f64;
    }
    let volume = Volume::new(dense.counts, origin, steps, dense.samples)?;
    let is_level_set = bytes.u32(632)? == 1;
    Ok(if is_level_set { volume.with_inside(Inside::Below) } else { volume })
}

impl<'a> Tree<'a> {
    fn new(bytes: Bytes<'a>, kind: Kind) -> Result<Self, VolumeProblem> {
        let size = bytes.0.len();
        // Leaves are told first.
        let mut counts = [0; 3];
        for (level, count) in counts.iter_mut().enumerate() {
            *count = bytes.u32(GRID + 40 - 4 * level)? as usize;
            let each = LEVELS.get(level).map_or(kind.least_leaf(), |level| level.bytes);
            if *count > size / each {
                return Err(wrong(format!(
                    "{count} nodes of {each} bytes do not fit in its {size} bytes"
                )));
            }
        }
        let root = bytes.size(GRID + 24)?.checked_add(GRID);
        let root = root.ok_or_else(|| wrong("its root lies beyond its end"))?;
        Ok(Self { bytes, kind, root, counts })
    }

    /// Goes through all leaves and cubes without children, or the active ones of those cubes alone.
    fn walk(
        &self,
        which: Which,
        visit: &mut dyn FnMut(Part<'a>) -> Result<(), VolumeProblem>,
    ) -> Result<(), VolumeProblem> {
        let count = self.bytes.u32(self.root.saturating_add(24))? as usize;
        let [head, _, value] = self.kind.root();
        let list = self.root.saturating_add(head);
        let entries = Bytes(self.bytes.part(list, count.saturating_mul(ENTRY))?);
        let mut cubes = HashSet::new();
        let mut walk = Walk { which, seen: [0; 3], visit };
        for place in (0..count).map(|number| number * ENTRY) {
            let key = entries.u64(place)?;
            // 21 bits for each axis, the last axis first, of which 20 are used.
            let parts = [key >> 42, key >> 21 & 0x1f_ffff, key & 0x1f_ffff];
            if parts.iter().any(|part| *part >> 20 != 0) || !cubes.insert(key) {
                return Err(wrong(format!(
                    "the root lists the cube {key:#x}, which is none or listed before"
                )));
            }
            let first = parts.map(|part| i64::from(((part as u32) << 12) as i32));
            let child = i64::from_le_bytes(entries.at(place + 8)?);
            if child == 0 {
                let is_active = entries.u32(place + 16)? != 0;
                let value = self.kind.value(entries, place + value)?;
                (walk.visit)(Part {
                    first,
                    side: ROOT,
                    what: What::Tile { value, is_active },
                })?;
            } else {
                let node = Node { level: 0, place: beside(self.root, child)?, first };
                self.node(&node, &mut walk)?;
            }
        }
        Ok(())
    }

    fn node(&self, node: &Node, walk: &mut Walk<'_, 'a>) -> Result<(), VolumeProblem> {
        let Node { level, place, first } = *node;
        walk.seen[level] += 1;
        if walk.seen[level] > self.counts[level] {
            return Err(wrong(format!(
                "its tree reaches more than its {} nodes of level {level}: places are damaged",
                self.counts[level]
            )));
        }
        let Some(Level { log, side, table, bytes }) = LEVELS.get(level) else {
            let length = self.leaf_bytes(place)?;
            let bytes = self.bytes.part(place, length)?;
            return (walk.visit)(Part { first, side: LEAF, what: What::Leaf(bytes) });
        };
        let bytes = Bytes(self.bytes.part(place, *bytes)?);
        let mask = (1_usize << (3 * log)) / 8;
        let (active, children) = (bytes.part(32, mask)?, bytes.part(32 + mask, mask)?);
        let is_set = |mask: &[u8], number: usize| mask[number >> 3] >> (number & 7) & 1 == 1;
        for number in 0..1_usize << (3 * log) {
            let (is_active, has_child) = (is_set(active, number), is_set(children, number));
            if !is_active && !has_child && walk.which == Which::Active {
                continue;
            }
            let ways = [number >> (2 * log), number >> log, number];
            let first = std::array::from_fn(|axis| {
                first[axis] + side * (ways[axis] & ((1 << log) - 1)) as i64
            });
            let entry = table + 8 * number;
            if has_child {
                let child = i64::from_le_bytes(bytes.at(entry)?);
                let node = Node { level: level + 1, place: beside(place, child)?, first };
                self.node(&node, walk)?;
            } else {
                let value = self.kind.value(bytes, entry)?;
                (walk.visit)(Part {
                    first,
                    side: *side,
                    what: What::Tile { value, is_active },
                })?;
            }
        }
        Ok(())
    }

    /// The bytes of the leaf at a place.
    fn leaf_bytes(&self, place: usize) -> Result<usize, VolumeProblem> {
        if self.kind != Kind::Variable {
            return Ok(self.kind.least_leaf());
        }
        let head = self.bytes.part(place, self.kind.leaf_head())?;
        Ok(self.kind.leaf_head() + VOXELS / 8 * bits(head)?)
    }

    /// The first and the last active voxel along each axis.
    fn active(&self) -> Result<[[i64; 3]; 2], VolumeProblem> {
        let (mut least, mut most) = ([i64::MAX; 3], [i64::MIN; 3]);
        let mut add = |first: [i64; 3], last: [i64; 3]| {
            for axis in 0..3 {
                least[axis] = least[axis].min(first[axis]);
                most[axis] = most[axis].max(last[axis]);
            }
        };
        self.walk(Which::Active, &mut |Part { first, side, what }| {
            match what {
                What::Tile { is_active: true, .. } => add(first, first.map(|i| i + side - 1)),
                What::Tile { .. } => {}
                What::Leaf(bytes) => {
                    // A byte has the eight voxels along the last axis.
                    let rows = bytes[16..80].iter().enumerate().filter(|(_, row)| **row != 0);
                    for (number, row) in rows {
                        let [x, y] = [number >> 3, number & 7].map(|i| i as i64);
                        let [near, far] =
                            [row.trailing_zeros(), 7 - row.leading_zeros()].map(i64::from);
                        let from = |z: i64| [first[0] + x, first[1] + y, first[2] + z];
                        add(from(near), from(far));
                    }
                }
            }
            Ok(())
        })?;
        if least[0] > most[0] {
            return Err(wrong("none of its voxels is active: there is nothing to read"));
        }
        Ok([least, most])
    }
}

/// The cubes without children that are visited.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Which {
    All,
    Active,
}

/// A way through a tree.
struct Walk<'v, 'a> {
    which: Which,
    /// Nodes of each level so far, and leaves.
    seen: [usize; 3],
    visit: &'v mut dyn FnMut(Part<'a>) -> Result<(), VolumeProblem>,
}

/// A node at a place.
struct Node {
    level: usize,
    place: usize,
    first: [i64; 3],
}

/// A place so many bytes from another.
fn beside(place: usize, way: i64) -> Result<usize, VolumeProblem> {
    let there = isize::try_from(way).ok().and_then(|way| place.checked_add_signed(way));
    there.ok_or_else(|| {
        wrong(format!("a node lies {way} bytes from byte {place}, outside of the file"))
    })
}

/// The bits of a voxel in a leaf that tells them.
fn bits(leaf: &[u8]) -> Result<usize, VolumeProblem> {
    match leaf[15] >> 5 {
        log @ 0..=4 => Ok(1 << log),
        log => Err(wrong(format!("a leaf has 2^{log} bits a voxel, 16 at most"))),
    }
}

/// Samples on a lattice.
struct Dense {
    first: [i64; 3],
    counts: [usize; 3],
    /// The first axis first.
    samples: Vec<f32>,
}

impl Dense {
    fn new(first: [i64; 3], counts: [usize; 3], value: f32) -> Self {
        Self { first, counts, samples: vec![value; counts.iter().product()] }
    }

    /// Takes the values of a cube as far as it lies in the lattice.
    fn fill(&mut self, part: &Part<'_>, kind: Kind) -> Result<(), VolumeProblem> {
        let (mut begin, mut end) = ([0; 3], [0; 3]);
        for axis in 0..3 {
            let (from, most) = (part.first[axis] - self.first[axis], self.counts[axis] as i64);
            let [first, last] = [from, from + part.side].map(|i| i.clamp(0, most) as usize);
            if first == last {
                return Ok(());
            }
            (begin[axis], end[axis]) = (first, last);
        }
        let values = match part.what {
            What::Tile { .. } => None,
            What::Leaf(bytes) => Some(voxels(bytes, kind)?),
        };
        // The voxel of a leaf along an axis, whose first one may lie before the lattice.
        let local =
            |i: usize, axis: usize| (i as i64 + self.first[axis] - part.first[axis]) as usize;
        for z in begin[2]..end[2] {
            for y in begin[1]..end[1] {
                let row = self.counts[0] * (y + self.counts[1] * z);
                let row = &mut self.samples[row + begin[0]..row + end[0]];
                match (&part.what, &values) {
                    (What::Tile { value, .. }, _) => row.fill(*value),
                    (_, Some(values)) => {
                        for (x, sample) in (begin[0]..).zip(row) {
                            *sample = values[local(x, 0) << 6 | local(y, 1) << 3 | local(z, 2)];
                        }
                    }
                    (What::Leaf(_), None) => {}
                }
            }
        }
        Ok(())
    }
}

/// The voxels of a leaf, the last axis first.
fn voxels(leaf: &[u8], kind: Kind) -> Result<[f32; VOXELS], VolumeProblem> {
    let stored = Bytes(&leaf[kind.leaf_head()..]);
    let mut values = [0.0; VOXELS];
    let bits = match kind {
        Kind::Float | Kind::Double => {
            let each = if kind.is_double() { 8 } else { 4 };
            for (number, value) in values.iter_mut().enumerate() {
                *value = kind.value(stored, each * number)?;
            }
            return Ok(values);
        }
        Kind::Fixed(bits) => bits,
        Kind::Variable => bits(leaf)?,
    };
    let [least, step] = [80, 84].map(|place| Bytes(leaf).at(place).map(f32::from_le_bytes));
    let (least, step) = (least?, step?);
    for (number, value) in values.iter_mut().enumerate() {
        let place = number * bits;
        let steps = if bits == 16 {
            stored.u16(place / 8)?
        } else {
            let [byte] = stored.at(place / 8)?;
            u16::from(byte) >> (place % 8) & ((1 << bits) - 1)
        };
        *value = f32::from(steps) * step + least;
    }
    Ok(values)
}
