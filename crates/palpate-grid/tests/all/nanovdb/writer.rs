// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files of NanoVDB, written.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use palpate_field::Vector;

/// The bytes of a grid before the root, and of the root and its list of one entry.
pub(crate) const HEAD: usize = 736;
pub(crate) const UPPER: usize = HEAD + 64 + 32;
pub(crate) const LOWER: usize = UPPER + 270_400;
pub(crate) const LEAVES: usize = LOWER + 33_856;

/// Voxels of one lower node, from 0 to 127 along each axis, by place; the rest is the background, not active.
pub(crate) struct Grid {
    pub(crate) voxels: BTreeMap<[usize; 3], f32>,
    pub(crate) background: f32,
    pub(crate) class: u32,
    pub(crate) name: &'static str,
    /// Tiles of 8³ voxels, by place in units of 8, active.
    pub(crate) tiles: Vec<([usize; 3], f32)>,
}

pub(crate) fn put(bytes: &mut [u8], place: usize, what: &[u8]) {
    bytes[place..place + what.len()].copy_from_slice(what);
}

/// The place in a table with so many children along each axis.
fn linear(place: [usize; 3], log: usize) -> usize {
    place[0] << (2 * log) | place[1] << log | place[2]
}

pub(crate) fn version(major: u32) -> [u8; 4] {
    (major << 21 | 4 << 10 | 2).to_le_bytes()
}

impl Grid {
    pub(crate) fn small() -> Self {
        let mut voxels = BTreeMap::new();
        voxels.insert([3, 4, 5], 1.5);
        voxels.insert([3, 5, 6], -2.25);
        voxels.insert([9, 4, 5], 4.0);
        Self {
            voxels,
            background: 0.5,
            class: 2,
            name: "density",
            tiles: vec![([1, 1, 0], 8.0)],
        }
    }

    /// The distance to a ball, as far as 3 voxels from it; farther inside it is -3.
    pub(crate) fn ball(middle: [f64; 3], radius: f64) -> Self {
        let mut voxels = BTreeMap::new();
        for i in 0..40_usize.pow(3) {
            let p = [i % 40, i / 40 % 40, i / 1600];
            let off: [f64; 3] = std::array::from_fn(|axis| p[axis] as f64 - middle[axis]);
            let off = Vector(off).norm() - radius;
            if off < 3.0 {
                voxels.insert(p, off.max(-3.0) as f32);
            }
        }
        Self { voxels, background: 3.0, class: 1, name: "ball", tiles: Vec::new() }
    }

    /// The grid as it lies in memory: half a metre to a voxel along x, 1 along y and 2 along z, which is turned
    /// with y by a quarter.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut leaves: BTreeMap<[usize; 3], Vec<([usize; 3], f32)>> = BTreeMap::new();
        for (place, value) in &self.voxels {
            leaves
                .entry(place.map(|i| i / 8))
                .or_default()
                .push((place.map(|i| i % 8), *value));
        }
        let size = LEAVES + 2144 * leaves.len();
        let mut all = vec![0; size];
        put(&mut all, 0, b"NanoVDB0");
        put(&mut all, 16, &version(32));
        put(&mut all, 28, &1_u32.to_le_bytes());
        put(&mut all, 32, &(size as u64).to_le_bytes());
        put(&mut all, 40, self.name.as_bytes());
        let map = [0.5, 0.0, 0.0, 0.0, 0.0, -2.0, 0.0, 1.0, 0.0];
        for (i, number) in map.into_iter().enumerate() {
            put(&mut all, 384 + 8 * i, &f64::to_le_bytes(number));
        }
        for (i, number) in [10.0, 20.0, 30.0].into_iter().enumerate() {
            put(&mut all, 528 + 8 * i, &f64::to_le_bytes(number));
        }
        put(&mut all, 632, &self.class.to_le_bytes());
        put(&mut all, 636, &1_u32.to_le_bytes());
        for (i, place) in [LEAVES, LOWER, UPPER, HEAD].into_iter().enumerate() {
            put(&mut all, 672 + 8 * i, &(place as u64 - 672).to_le_bytes());
        }
        for (i, count) in [leaves.len() as u32, 1, 1].into_iter().enumerate() {
            put(&mut all, 704 + 4 * i, &count.to_le_bytes());
        }
        put(&mut all, HEAD + 24, &1_u32.to_le_bytes());
        put(&mut all, HEAD + 28, &self.background.to_le_bytes());
        // The first cube of the root has the key 0.
        put(&mut all, HEAD + 64 + 8, &((UPPER - HEAD) as u64).to_le_bytes());
        for (node, log, children) in [(UPPER, 5, 8256), (LOWER, 4, 1088)] {
            for i in 0..1 << (3 * log) {
                put(&mut all, node + children + 8 * i, &self.background.to_le_bytes());
            }
        }
        all[UPPER + 4128] |= 1;
        put(&mut all, UPPER + 8256, &((LOWER - UPPER) as u64).to_le_bytes());
        for (place, value) in &self.tiles {
            let i = linear(*place, 4);
            all[LOWER + 32 + i / 8] |= 1 << (i % 8);
            put(&mut all, LOWER + 1088 + 8 * i, &value.to_le_bytes());
        }
        for (number, (place, voxels)) in leaves.iter().enumerate() {
            let (leaf, i) = (LEAVES + 2144 * number, linear(*place, 4));
            all[LOWER + 544 + i / 8] |= 1 << (i % 8);
            put(&mut all, LOWER + 1088 + 8 * i, &((leaf - LOWER) as u64).to_le_bytes());
            for i in 0..512 {
                put(&mut all, leaf + 96 + 4 * i, &self.background.to_le_bytes());
            }
            for (place, value) in voxels {
                let i = linear(*place, 3);
                all[leaf + 16 + i / 8] |= 1 << (i % 8);
                put(&mut all, leaf + 96 + 4 * i, &value.to_le_bytes());
            }
        }
        all
    }
}

pub(crate) fn zip(bytes: &[u8]) -> Vec<u8> {
    let mut out = ZlibEncoder::new(Vec::new(), Compression::default());
    out.write_all(bytes).unwrap();
    let packed = out.finish().unwrap();
    [&(packed.len() as u64).to_le_bytes(), &packed[..]].concat()
}

/// A file of one segment.
pub(crate) fn file(magic: &[u8; 8], grids: &[&Grid], codec: u16) -> Vec<u8> {
    let head =
        [&magic[..], &version(32), &(grids.len() as u16).to_le_bytes(), &codec.to_le_bytes()]
            .concat();
    let (mut list, mut stored) = (head, Vec::new());
    for grid in grids {
        let bytes = grid.bytes();
        let packed = if codec == 1 { zip(&bytes) } else { bytes.clone() };
        let mut entry = [0; 176];
        put(&mut entry, 0, &(bytes.len() as u64).to_le_bytes());
        put(&mut entry, 8, &(packed.len() as u64).to_le_bytes());
        put(&mut entry, 32, &bytes[636..640]);
        put(&mut entry, 36, &bytes[632..636]);
        put(&mut entry, 136, &(grid.name.len() as u32 + 1).to_le_bytes());
        put(&mut entry, 172, &version(32));
        list.extend(entry);
        list.extend(grid.name.bytes().chain([0]));
        stored.extend(packed);
    }
    list.extend(stored);
    list
}
