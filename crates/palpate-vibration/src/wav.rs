// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Samples as a WAV file.

use std::io::{self, Seek, Write};

/// The samples that fit into a WAV file: its header counts bytes in 32 bits.
const MOST_SAMPLES: usize = (1 << 31) - 1024;

/// Writes samples as a WAV file of one channel and 16 bits. Samples are clamped to [−1, 1]; NaN
/// becomes silence.
///
/// Not for the servo's thread, because the function writes to the file while it runs: record
/// first, and write when the servo has stopped.
///
/// # Errors
///
/// The errors of `file`, and an error if there are more than 2³¹ − 1024 samples, the most that
/// fit into a WAV file.
///
/// ```
/// use palpate_vibration::write_wav;
///
/// # fn main() -> std::io::Result<()> {
/// let mut file = std::io::Cursor::new(Vec::new());
/// write_wav(&mut file, 8000, [0.0, 0.5, -1.0])?;
/// // A header of 44 bytes, then two for each sample.
/// assert_eq!(file.get_ref().len(), 44 + 6);
/// # Ok(())
/// # }
/// ```
pub fn write_wav(
    file: impl Write + Seek,
    sample_rate: u32,
    samples: impl IntoIterator<Item = f32>,
) -> io::Result<()> {
    let format = hound::WavSpec {
        channels: 1,
        sample_rate,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::new(file, format).map_err(io_error)?;
    for (count, sample) in samples.into_iter().enumerate() {
        // The writer's count of bytes would begin again at zero.
        if count >= MOST_SAMPLES {
            return Err(io::Error::other("a WAV file holds at most 2³¹ − 1024 samples"));
        }
        // `as` cuts off, and makes NaN zero.
        let rounded = (f64::from(sample) * f64::from(i16::MAX)).round() as i16;
        writer.write_sample(rounded).map_err(io_error)?;
    }
    writer.finalize().map_err(io_error)
}

fn io_error(error: hound::Error) -> io::Error {
    match error {
        hound::Error::IoError(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let mut file = io::Cursor::new(Vec::new());
        write_wav(&mut file, 8000, [0.0, 1.0, -0.25, 7.0, f32::NAN]).unwrap();
        file.set_position(0);
        let mut reader = hound::WavReader::new(file).unwrap();
        assert_eq!((reader.spec().channels, reader.spec().sample_rate), (1, 8000));
        let samples: Vec<i16> = reader.samples().map(Result::unwrap).collect();
        assert_eq!(samples, [0, 32767, -8192, 32767, 0]);
    }

    #[test]
    fn a_file_that_fails_says_so() {
        let mut short = [0_u8; 50];
        let samples = std::iter::repeat_n(0.5, 100_000);
        assert!(write_wav(io::Cursor::new(short.as_mut_slice()), 8000, samples).is_err());
    }
}
