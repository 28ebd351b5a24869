// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Samples as a WAV file.

use std::io::{self, Seek, Write};

/// The samples that fit into a WAV file: its header counts bytes in 32 bits.
const MOST_SAMPLES: usize = (1 << 31) - 1024;

/// Writes `samples` as a WAV file of 16 bits with some `channels`: a sample of each channel in
/// turn. Samples are clamped to [−1, 1]; NaN becomes silence.
///
/// Not for the servo's thread, because the function writes to the file while it runs: record
/// first, and write when the servo has stopped.
///
/// # Errors
///
/// The errors of `file`, and an error if there is no channel, if a channel lacks its last sample,
/// or if there are more than 2³¹ − 1024 samples, the most that fit into a WAV file.
///
/// ```
/// use palpate_vibration::write_wav;
///
/// # fn main() -> std::io::Result<()> {
/// let mut file = std::io::Cursor::new(Vec::new());
/// // Two fingers, three samples each.
/// write_wav(&mut file, 8000, 2, [0.0, 0.1, 0.5, 0.2, -1.0, 0.3])?;
/// // A header of 44 bytes for up to two channels, then two for each sample.
/// assert_eq!(file.get_ref().len(), 44 + 12);
/// # Ok(())
/// # }
/// ```
pub fn write_wav(
    file: impl Write + Seek,
    sample_rate: u32,
    channels: u16,
    samples: impl IntoIterator<Item = f32>,
) -> io::Result<()> {
    if channels == 0 {
        return Err(io::Error::other("a WAV file needs a channel"));
    }
    let format = hound::WavSpec {
        channels,
        sample_rate,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::new(file, format).map_err(io_error)?;
    let mut written = 0;
    for (count, sample) in samples.into_iter().enumerate() {
        // The writer's count of bytes would begin again at zero.
        if count >= MOST_SAMPLES {
            return Err(io::Error::other("a WAV file holds at most 2³¹ − 1024 samples"));
        }
        // `as` cuts off, and makes NaN zero.
        let rounded = (f64::from(sample) * f64::from(i16::MAX)).round() as i16;
        writer.write_sample(rounded).map_err(io_error)?;
        written = count + 1;
    }
    if written % usize::from(channels) != 0 {
        let problem = format!("{written} samples do not fill {channels} channels");
        return Err(io::Error::other(problem));
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
        write_wav(&mut file, 8000, 1, [0.0, 1.0, -0.25, 7.0, f32::NAN]).unwrap();
        file.set_position(0);
        let mut reader = hound::WavReader::new(file).unwrap();
        assert_eq!((reader.spec().channels, reader.spec().sample_rate), (1, 8000));
        let samples: Vec<i16> = reader.samples().map(Result::unwrap).collect();
        assert_eq!(samples, [0, 32767, -8192, 32767, 0]);
    }

    #[test]
    fn channels_take_turns() {
        for channels in [2, 3, 10] {
            let mut file = io::Cursor::new(Vec::new());
            let samples = (0..2 * channels).map(|i| f32::from(i) / f32::from(i16::MAX));
            write_wav(&mut file, 8000, channels, samples).unwrap();
            file.set_position(0);
            let mut reader = hound::WavReader::new(file).unwrap();
            assert_eq!((reader.spec().channels, reader.duration()), (channels, 2));
            let samples: Vec<i16> = reader.samples().map(Result::unwrap).collect();
            assert_eq!(samples, (0..2 * channels as i16).collect::<Vec<_>>());
        }
    }

    #[test]
    fn channels_without_samples_are_refused() {
        let write = |channels: u16| {
            let mut file = io::Cursor::new(Vec::new());
            write_wav(&mut file, 8000, channels, [0.0; 5]).unwrap_err().to_string()
        };
        assert_eq!(write(0), "a WAV file needs a channel");
        assert_eq!(write(2), "5 samples do not fill 2 channels");
    }

    #[test]
    fn a_file_that_fails_says_so() {
        let mut short = [0_u8; 50];
        let samples = std::iter::repeat_n(0.5, 100_000);
        assert!(write_wav(io::Cursor::new(short.as_mut_slice()), 8000, 1, samples).is_err());
    }
}
