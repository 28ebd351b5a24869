// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Binary messages: frames, grids, pictures. Little-endian.

use half::f16;
use tungstenite::Bytes;

use super::VERSION;

/// The version as binary messages write it.
const BYTE_VERSION: u8 = VERSION as u8;

/// A moment of the servo.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frame {
    pub(crate) dimension: u8,
    pub(crate) is_stopped: bool,
    pub(crate) is_held: bool,
    pub(crate) has_acted: bool,
    pub(crate) is_recording: bool,
    pub(crate) is_touring: bool,
    pub(crate) is_replaying: bool,
    pub(crate) is_lifted: bool,
    pub(crate) revision: u32,
    pub(crate) ticks: u64,
    pub(crate) time: f64,
    pub(crate) force: f64,
    pub(crate) depth: f64,
    pub(crate) cost: f64,
    pub(crate) lateness: f64,
    /// Taken from the hand, given to it, kept back [J].
    pub(crate) energy: [f64; 3],
    pub(crate) evaluations: u32,
    pub(crate) lost: u64,
    /// Counts while the program is alive, whether the servo's time goes on or not.
    pub(crate) beat: u16,
    pub(crate) points: Vec<FramePoint>,
}

/// A contact point in a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FramePoint {
    /// Device point, proxy, force, wanted force, normal.
    pub(crate) vectors: [[f64; 3]; 5],
    pub(crate) depth: f64,
    pub(crate) largest_force: f64,
    pub(crate) body: u32,
    pub(crate) is_in_contact: bool,
    pub(crate) is_slipping: bool,
}

impl Frame {
    /// The same moment after its servo has ended.
    pub(crate) fn without_forces(mut self) -> Self {
        (self.force, self.has_acted) = (0.0, false);
        for point in &mut self.points {
            let [device, proxy, _, _, normal] = point.vectors;
            point.vectors = [device, proxy, [0.0; 3], [0.0; 3], normal];
            (point.largest_force, point.is_in_contact, point.is_slipping) = (0.0, false, false);
        }
        self
    }

    pub(crate) fn bytes(&self) -> Bytes {
        let mut out = Vec::with_capacity(64 + 72 * self.points.len());
        let flags = [
            self.is_stopped,
            self.is_held,
            self.has_acted,
            self.is_recording,
            self.is_touring,
            self.is_replaying,
            self.is_lifted,
        ];
        out.extend([1, BYTE_VERSION, self.dimension, bits(&flags)]);
        out.extend(self.revision.to_le_bytes());
        out.extend(self.ticks.to_le_bytes());
        out.extend(self.time.to_le_bytes());
        let [taken, given, kept] = self.energy;
        let numbers = [self.force, self.depth, self.cost, self.lateness, taken, given, kept];
        floats(&mut out, &numbers);
        floats(&mut out, &[f64::from(self.evaluations)]);
        out.extend(u32::try_from(self.lost).unwrap_or(u32::MAX).to_le_bytes());
        out.extend(short(self.points.len()).to_le_bytes());
        out.extend(self.beat.to_le_bytes());
        for point in &self.points {
            point.vectors.iter().for_each(|vector| floats(&mut out, vector));
            floats(&mut out, &[point.depth, point.largest_force]);
            out.extend(short(point.body as usize).to_le_bytes());
            let flags = bits(&[point.is_in_contact, point.is_slipping]);
            out.extend(u16::from(flags).to_le_bytes());
        }
        out.into()
    }
}

/// Where the values of a grid lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridPlace {
    pub(crate) dimension: u8,
    /// Values along x, y and z.
    pub(crate) counts: [usize; 3],
    pub(crate) first: [f64; 3],
    pub(crate) last: [f64; 3],
}

/// Values of a field, x fastest.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) place: GridPlace,
    pub(crate) values: Vec<f32>,
    /// Whether the values are sent as half floats, for a texture.
    pub(crate) is_half: bool,
}

impl Grid {
    pub(crate) fn bytes(&self, id: u32, revision: u32) -> Bytes {
        let width: usize = if self.is_half { 2 } else { 4 };
        let mut out = Vec::with_capacity(48 + width * self.values.len());
        out.extend([2, BYTE_VERSION, self.place.dimension, width as u8]);
        out.extend(id.to_le_bytes());
        out.extend(revision.to_le_bytes());
        for count in self.place.counts {
            out.extend(u32::try_from(count).unwrap_or(u32::MAX).to_le_bytes());
        }
        floats(&mut out, &self.place.first);
        floats(&mut out, &self.place.last);
        for value in &self.values {
            if self.is_half {
                out.extend(f16::from_f32(*value).to_le_bytes());
            } else {
                out.extend(value.to_le_bytes());
            }
        }
        out.into()
    }
}

/// A picture as a message.
pub(crate) fn picture(id: u32, revision: u32, png: &[u8]) -> Bytes {
    let mut out = Vec::with_capacity(16 + png.len());
    out.extend([3, BYTE_VERSION, 0, 0]);
    out.extend(id.to_le_bytes());
    out.extend(revision.to_le_bytes());
    out.extend(u32::try_from(png.len()).unwrap_or(u32::MAX).to_le_bytes());
    out.extend(png);
    out.into()
}

fn bits(flags: &[bool]) -> u8 {
    flags.iter().enumerate().map(|(bit, flag)| u8::from(*flag) << bit).sum()
}

fn floats(out: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|number| out.extend((*number as f32).to_le_bytes()));
}

fn short(number: usize) -> u16 {
    u16::try_from(number).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_laid_out_as_documented() {
        let point = FramePoint {
            vectors: [[1.0, 2.0, 3.0]; 5],
            body: 3,
            is_slipping: true,
            ..FramePoint::default()
        };
        let frame = Frame {
            dimension: 3,
            is_held: true,
            is_touring: true,
            revision: 7,
            ticks: 1000,
            time: 1.5,
            force: 2.5,
            lost: 9,
            beat: 258,
            points: vec![point; 10],
            ..Frame::default()
        };
        let bytes = frame.bytes();
        assert_eq!(bytes.len(), 784);
        assert_eq!(bytes[..8], [1, 2, 3, 0b1_0010, 7, 0, 0, 0]);
        assert_eq!(bytes[8..16], 1000_u64.to_le_bytes());
        assert_eq!(bytes[16..24], 1.5_f64.to_le_bytes());
        assert_eq!(bytes[24..28], 2.5_f32.to_le_bytes());
        assert_eq!(bytes[56..64], [9, 0, 0, 0, 10, 0, 2, 1]);
        assert_eq!(bytes[64 + 12..64 + 16], 1.0_f32.to_le_bytes());
        assert_eq!(bytes[64 + 68..64 + 72], [3, 0, 2, 0]);
    }

    #[test]
    fn a_grid_and_a_picture_have_their_headers() {
        let place =
            GridPlace { dimension: 2, counts: [2, 1, 1], first: [0.0; 3], last: [1.0; 3] };
        let grid = Grid { place, values: vec![1.0, -2.0], is_half: true };
        let bytes = grid.bytes(5, 6);
        assert_eq!(bytes.len(), 48 + 4);
        assert_eq!(bytes[..12], [2, 2, 2, 2, 5, 0, 0, 0, 6, 0, 0, 0]);
        assert_eq!(bytes[48..], [0, 0x3c, 0, 0xc0]);
        assert_eq!(picture(1, 2, b"png")[12..], [3, 0, 0, 0, b'p', b'n', b'g']);
    }
}
