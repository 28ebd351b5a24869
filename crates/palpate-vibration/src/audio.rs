// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Audio.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::io::{self, Seek, Write};

use palpate_device::DeviceError;

use crate::actuator::{
    Actuator, CarrierDrive, Mechanism, Motor, MotorDrive, check_sample_rate,
};
use crate::cue::{Mapping, MappingOptions, Sensation, Tap, Tone};
use crate::limiter::{Limiter, Limiting, delay};
use crate::ringing::Ringing;
use crate::sensation_level::{Adaptation, Faded};
use crate::strength::{Strengths, amplitude, hold_strength, slide_strength, tap_strength};

/// The time over which an amplitude rises from zero to one [s]: a jump would click, a slower
/// rise would blur a texture.
const ATTACK: f64 = 0.002;

/// A sine whose phase never jumps, and whose amplitude changes slowly.
#[derive(Clone, Copy, Debug, Default)]
struct Oscillator {
    /// The phase in turns, in [0, 1).
    phase: f64,
    amplitude: f64,
}

/// From one sample to the next.
#[derive(Clone, Copy)]
struct Step {
    /// The time between two samples [s].
    period: f64,
    /// The largest change of an amplitude.
    slew: f64,
}

impl Oscillator {
    /// The next sample, a step after the last, while the oscillator moves towards `tone`.
    fn next(&mut self, tone: Tone, step: Step) -> f64 {
        let Step { period, slew } = step;
        let change = (tone.amplitude - self.amplitude).clamp(-slew, slew);
        self.amplitude += change;
        let sample = self.amplitude * libm::sin(TAU * self.phase);
        self.phase += tone.frequency * period;
        self.phase -= libm::floor(self.phase);
        sample
    }

    /// Starts at `amplitude` at once if the oscillator is silent: at phase zero this does not
    /// click.
    fn strike(&mut self, amplitude: f64) {
        if self.amplitude == 0.0 {
            *self = Self { phase: 0.0, amplitude };
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Player {
    hold: Oscillator,
    slide: Oscillator,
    tap: Oscillator,
    ringing: Ringing,
    adaptation: Adaptation,
    /// The tones of hold and slide; where one is silent, with its last frequency, because a sine
    /// that fades out keeps it.
    tones: [Tone; 2],
}

/// Makes the samples of one actuator from the sensations of some contact points.
///
/// For an actuator that plays every frequency, and for a voice coil, the samples are a sum of
/// sines. The phase of every sine is continuous when its frequency changes, and its amplitude
/// changes over 2 ms; a tap begins at once, at phase zero. A limiter with look-ahead keeps the sum
/// within ±1, which delays it by [`delay`](Self::delay) samples: neighbouring samples of a point
/// differ by at most [`largest_step`](Self::largest_step), and nothing is clipped.
///
/// For other actuators ([`for_actuator`](Self::for_actuator)) a touch is moved to what they play,
/// with its strength above the threshold of the skin:
///
/// - A resonant actuator plays its resonance. Hold and tap are its envelope; the crests of a slide
///   are a rhythm of it up to 50 Hz, less up to 80 Hz, and none above, where skin and actuator do
///   not follow.
/// - A rotating mass gets a level, positive to turn and negative to brake. Hold, slide and tap are
///   played by the speed at which their strength is felt, at least that of the start level, below
///   which the motor does not turn. It starts at 4 dB above the threshold, and stops at 2 dB.
/// - Both are pushed beyond their rated level until they are as strong as wanted, and pushed
///   backwards to stop; a tap begins to decay when the actuator has reached it.
///
/// On an actuator, every touch begins at least 10 dB above the threshold of the skin, every tap at
/// least 20 dB, and a slide from a tenth of its full level on is 10 dB above. A hold that does not change fades ([`Adaptation`]).
///
/// # Examples
///
/// A tap is `a exp(−d t) sin(2π f t)` from the first sample after the delay on:
///
/// ```
/// use palpate_vibration::{
///     Mapping, MappingOptions, Sensation, Synthesiser, Tap,
/// };
///
/// # fn main() -> Result<(), palpate_device::DeviceError> {
/// let mapping = Mapping::new(MappingOptions::default())?;
/// let mut synthesiser = Synthesiser::new(&mapping, 8000.0, 1)?;
/// let tap = Tap { amplitude: 0.5, frequency: 250.0, decay: 100.0 };
/// let mut samples = [0.0; 32];
/// synthesiser.render(&[Sensation { tap: Some(tap), ..Sensation::default() }], &mut samples);
///
/// assert_eq!((synthesiser.delay(), samples[16]), (16, 0.0));
/// // After 1 ms, a quarter of a turn.
/// assert!((f64::from(samples[24]) - 0.5 * (-0.1_f64).exp()).abs() < 1e-7);
/// # Ok(())
/// # }
/// ```
///
/// A motor gets levels:
///
/// ```
/// use palpate_vibration::{
///     Mapping, MappingOptions, Sensation, Synthesiser, Tone, actuator_named,
/// };
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let motor = actuator_named("erm")?;
/// let mapping = Mapping::new(motor.options(MappingOptions::default()))?;
/// let mut synthesiser = Synthesiser::for_actuator(&mapping, &motor, 1000.0, 1)?;
/// let hold = Tone { frequency: 60.0, amplitude: 0.1 };
/// let mut levels = [0.0; 100];
/// synthesiser.render(&[Sensation { hold, ..Sensation::default() }], &mut levels);
/// // 4.5 V to start it; then the 2.3 V that keep it turning.
/// assert_eq!(levels[0], 1.0);
/// assert!((levels[99] * 4.5 - 2.3).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Synthesiser {
    output: Output,
    limiting: Limiting,
    sample_rate: f64,
    highest_frequency: f64,
}

#[derive(Clone, Debug)]
enum Output {
    Waves {
        players: Vec<Player>,
        limiter: Limiter,
        /// The band of a voice coil [Hz].
        band: Option<[f64; 2]>,
    },
    Carrier {
        touches: Vec<Strengths>,
        drive: CarrierDrive,
    },
    Motor {
        touches: Vec<Strengths>,
        drive: MotorDrive,
    },
}

impl Synthesiser {
    /// A synthesiser of `sample_rate` [Hz] for `points` contact points, whose sensations come
    /// from `mapping`, and an actuator that plays every frequency of it.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] without a point; [`DeviceError::Number`] if the sample
    /// rate is less than twice the mapping's highest frequency, which would alias, or more than
    /// 1 MHz.
    pub fn new(
        mapping: &Mapping,
        sample_rate: f64,
        points: usize,
    ) -> Result<Self, DeviceError> {
        Self::of(mapping, None, sample_rate, points)
    }

    /// A synthesiser as [`new`](Self::new) makes it, for an actuator; the mapping is one of the
    /// actuator's [`options`](Actuator::options).
    ///
    /// For a rotating mass the samples are levels: `sample_rate` is the rate at which the motor
    /// takes them, which may be that of the servo.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); and [`DeviceError::Number`] if a figure of the actuator breaks its rule,
    /// or if the sample rate is less than twice the actuator's resonance.
    pub fn for_actuator(
        mapping: &Mapping,
        actuator: &Actuator,
        sample_rate: f64,
        points: usize,
    ) -> Result<Self, DeviceError> {
        Self::of(mapping, Some(&actuator.mechanism), sample_rate, points)
    }

    fn of(
        mapping: &Mapping,
        mechanism: Option<&Mechanism>,
        sample_rate: f64,
        points: usize,
    ) -> Result<Self, DeviceError> {
        if points == 0 {
            return Err(DeviceError::NoContactPoint);
        }
        mechanism.map(Mechanism::check).transpose()?;
        let options = mapping.options();
        let highest_frequency = match mechanism {
            None | Some(Mechanism::VoiceCoil { .. }) => options.highest_frequency,
            Some(Mechanism::Resonant { resonance, .. }) => *resonance,
            // A level has no frequency.
            Some(Mechanism::RotatingMass { .. }) => 0.0,
        };
        check_sample_rate(sample_rate, highest_frequency)?;
        let touches =
            |has_rhythm| vec![Strengths::new(options, sample_rate, has_rhythm); points];
        let output = match mechanism.copied() {
            None | Some(Mechanism::VoiceCoil { .. }) => {
                let band = match mechanism {
                    Some(Mechanism::VoiceCoil { lowest, highest }) => Some([*lowest, *highest]),
                    _ => None,
                };
                let players = vec![Player::new(options, sample_rate); points];
                let limiter = Limiter::new(sample_rate);
                Output::Waves { players, limiter, band }
            }
            Some(Mechanism::Resonant { resonance, bandwidth, overdrive }) => {
                let drive = CarrierDrive::new(resonance, bandwidth, overdrive, sample_rate);
                Output::Carrier { touches: touches(true), drive }
            }
            Some(Mechanism::RotatingMass { frequency, start_level, overdrive, rise, fall }) => {
                let motor = Motor { frequency, start_level, overdrive, rise, fall };
                let drive = MotorDrive::new(motor, sample_rate);
                Output::Motor { touches: touches(false), drive }
            }
        };
        Ok(Self { output, limiting: Limiting::default(), sample_rate, highest_frequency })
    }

    /// Samples a second [Hz].
    #[must_use]
    pub fn sample_rate(&self) -> f64 {
        self.sample_rate
    }

    /// The samples by which the limiter delays; none where the samples are an envelope or a level.
    #[must_use]
    pub fn delay(&self) -> usize {
        match &self.output {
            Output::Waves { .. } => delay(self.sample_rate),
            Output::Carrier { .. } | Output::Motor { .. } => 0,
        }
    }

    /// The largest difference of neighbouring samples of one contact point, where the samples are
    /// a sum of sines: for three sines of full amplitude and the highest frequency f,
    /// `3 (2π f + 1 / 2 ms) / sample_rate`, and for the gain of the limiter `2 / (delay + 1)`.
    #[must_use]
    pub fn largest_step(&self) -> f64 {
        let waves = 3.0 * (TAU * self.highest_frequency + 1.0 / ATTACK) / self.sample_rate;
        // The gain falls from 1 to 1/3 for a sum of 3, by 1 / (delay + 1) of that in a sample.
        waves + 2.0 / (self.delay() as f64 + 1.0)
    }

    /// What was made smaller so far, because together it was more than the actuator plays.
    #[must_use]
    pub fn limiting(&self) -> Limiting {
        self.limiting
    }

    /// Renders the samples of one tick, in [−1, 1], from the sensation of each contact point;
    /// silence for those missing. As many samples as `samples` has places: 8 for a tick of
    /// 1 kHz at 8 kHz.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn render(&mut self, sensations: &[Sensation], samples: &mut [f32]) {
        let silence = Sensation::default();
        let felt = sensations.iter().chain(std::iter::repeat(&silence));
        let count = samples.len();
        let mut least_gain = 1.0_f64;
        let mut put = |place: &mut f32, (sample, gain): (f64, f64)| {
            *place = sample as f32;
            least_gain = least_gain.min(gain);
        };
        match &mut self.output {
            Output::Waves { players, limiter, band } => {
                let period = 1.0 / self.sample_rate;
                let step = Step { period, slew: period / ATTACK };
                for (player, sensation) in players.iter_mut().zip(felt) {
                    player.begin(sensation, count as f64 * period, *band);
                }
                for place in samples {
                    let sum = players.iter_mut().map(|player| player.next(step)).sum();
                    put(place, limiter.step(sum));
                }
            }
            Output::Carrier { touches, drive } => {
                for (touch, sensation) in touches.iter_mut().zip(felt) {
                    touch.begin(sensation, count, |strength| drive.reach(strength));
                }
                for place in samples {
                    put(place, drive.step(together(touches)));
                }
            }
            Output::Motor { touches, drive } => {
                for (touch, sensation) in touches.iter_mut().zip(felt) {
                    touch.begin(sensation, count, |strength| drive.reach(strength));
                }
                for place in samples {
                    put(place, drive.step(together(touches)));
                }
            }
        }
        self.limiting.count(least_gain);
    }
}

/// The strength of all touches together: powers add up.
fn together(touches: &mut [Strengths]) -> f64 {
    touches.iter_mut().map(Strengths::next_squared).sum::<f64>().sqrt()
}

impl Player {
    fn new(options: &MappingOptions, sample_rate: f64) -> Self {
        Self {
            hold: Oscillator::default(),
            slide: Oscillator::default(),
            tap: Oscillator::default(),
            ringing: Ringing::new(sample_rate),
            adaptation: Adaptation::new(options),
            tones: [Tone::default(); 2],
        }
    }

    /// A tick of `duration` [s] begins, on a voice coil if there is a `band` [Hz].
    fn begin(&mut self, sensation: &Sensation, duration: f64, band: Option<[f64; 2]>) {
        let Faded { mut tone, fade } = self.adaptation.step(sensation.hold, duration);
        let mut slide = sensation.slide;
        let mut tap = sensation.tap;
        if let Some([lowest, highest]) = band {
            let played = |strength: f64, frequency: f64| {
                let frequency = frequency.max(lowest).min(highest);
                Tone { frequency, amplitude: amplitude(strength, frequency) }
            };
            tone = played(hold_strength(sensation.hold, fade), tone.frequency);
            slide = played(slide_strength(slide), slide.frequency);
            tap = tap.map(|tap| {
                let Tone { amplitude, frequency } = played(tap_strength(&tap), tap.frequency);
                Tap { amplitude, frequency, ..tap }
            });
        }
        if let Some(tap) = tap {
            self.ringing.strike(tap);
            self.tap.strike(tap.amplitude);
        }
        for (last, tone) in self.tones.iter_mut().zip([tone, slide]) {
            *last = if tone.amplitude > 0.0 { tone } else { Tone { amplitude: 0.0, ..*last } };
        }
    }

    fn next(&mut self, step: Step) -> f64 {
        let [hold, slide] = self.tones;
        let Tap { amplitude, frequency, .. } = self.ringing.next();
        self.hold.next(hold, step)
            + self.slide.next(slide, step)
            + self.tap.next(Tone { frequency, amplitude }, step)
    }
}

/// The samples that fit into a WAV file: its header counts bytes in 32 bits.
const MOST_SAMPLES: usize = (1 << 31) - 1024;

/// The bytes of a sample.
const SAMPLE_BYTES: u16 = 2;

/// Writes `samples` as a WAV file of 16 bits with some `channels`: a sample of each channel in
/// turn. Samples are clamped to [−1, 1]; NaN becomes silence.
///
/// Not for the servo's thread, because the function writes to the file while it runs: record
/// first, and write when the servo has stopped.
///
/// # Errors
///
/// The errors of `file`, and an error if there is no channel, if a channel lacks its last sample,
/// if there are more than 2³¹ − 1024 samples, the most that fit into a WAV file, or if the channels
/// or the sample rate are too many for its header.
///
/// ```
/// use palpate_vibration::write_wav;
///
/// # fn main() -> std::io::Result<()> {
/// let mut file = std::io::Cursor::new(Vec::new());
/// // Two fingers, three samples each.
/// write_wav(&mut file, 8000, 2, [0.0, 0.1, 0.5, 0.2, -1.0, 0.3])?;
/// // A header of 44 bytes, then two for each sample.
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
    let mut file = io::BufWriter::new(file);
    let start = file.stream_position()?;
    file.write_all(&header(sample_rate, channels, 0)?)?;
    let mut written = 0;
    for (count, sample) in samples.into_iter().enumerate() {
        // The header's count of bytes would begin again at zero.
        if count >= MOST_SAMPLES {
            return Err(io::Error::other("a WAV file holds at most 2³¹ − 1024 samples"));
        }
        // `as` cuts off, and makes NaN zero.
        let rounded = (f64::from(sample) * f64::from(i16::MAX)).round() as i16;
        file.write_all(&rounded.to_le_bytes())?;
        written = count + 1;
    }
    if written % usize::from(channels) != 0 {
        let problem = format!("{written} samples do not fill {channels} channels");
        return Err(io::Error::other(problem));
    }
    let end = file.stream_position()?;
    file.seek(io::SeekFrom::Start(start))?;
    file.write_all(&header(sample_rate, channels, written)?)?;
    file.seek(io::SeekFrom::Start(end))?;
    file.flush()
}

/// The header of a WAV file with so many samples: of plain PCM, format tag 1, for any number of
/// channels. The extensible format is meant for more than two, but common readers refuse that
/// format, such as Python's `wave` before 3.12.
///
/// # References
///
/// IBM and Microsoft, Multimedia Programming Interface and Data Specifications 1.0 (1991),
/// chapter 3, Waveform Audio File Format.
fn header(sample_rate: u32, channels: u16, samples: usize) -> io::Result<[u8; 44]> {
    let beyond = || {
        let rule = "beyond the header of a WAV file";
        io::Error::other(format!("{channels} channels at {sample_rate} Hz are {rule}"))
    };
    let block = channels.checked_mul(SAMPLE_BYTES).ok_or_else(beyond)?;
    let rate = sample_rate.checked_mul(u32::from(block)).ok_or_else(beyond)?;
    let bytes = u32::try_from(samples).map_err(io::Error::other)? * u32::from(SAMPLE_BYTES);
    let mut header = [0; 44];
    let mut rest = header.as_mut_slice();
    rest.write_all(b"RIFF")?;
    rest.write_all(&(bytes + 36).to_le_bytes())?;
    rest.write_all(b"WAVEfmt ")?;
    rest.write_all(&16_u32.to_le_bytes())?;
    rest.write_all(&1_u16.to_le_bytes())?;
    rest.write_all(&channels.to_le_bytes())?;
    rest.write_all(&sample_rate.to_le_bytes())?;
    rest.write_all(&rate.to_le_bytes())?;
    rest.write_all(&block.to_le_bytes())?;
    rest.write_all(&(8 * SAMPLE_BYTES).to_le_bytes())?;
    rest.write_all(b"data")?;
    rest.write_all(&bytes.to_le_bytes())?;
    Ok(header)
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use crate::{Cue, MappingOptions};
    use palpate_testkit::cases::each as cases;

    const WOOD: Tap = Tap { amplitude: 8.0, frequency: 100.0, decay: 80.0 };

    fn mapping() -> Mapping {
        Mapping::new(MappingOptions::default()).unwrap()
    }

    #[test]
    fn nothing_clicks_whatever_happens() {
        let mapping = mapping();
        cases(50, |u| {
            let mut synthesiser = Synthesiser::new(&mapping, 8000.0, 1).unwrap();
            // The sines of f32 samples round at 2^-24.
            let largest = synthesiser.largest_step() + 1e-6;
            let mut last = 0.0;
            for _ in 0..300 {
                let mut number = || u.int_in_range(0..=100).map(|i: i32| f64::from(i) * 1e-2);
                let cue = Cue {
                    depth: number()? * 0.01,
                    normal_force: number()? * 5.0,
                    normal_speed: number()?,
                    slide_speed: number()?,
                    wavelength: Some(0.002),
                    impact: Some(WOOD),
                    began: number()? < 0.2,
                };
                let mut samples = [0.0_f32; 8];
                synthesiser.render(&[mapping.feel(&cue)], &mut samples);
                for sample in samples {
                    assert!(sample.abs() <= 1.0);
                    assert!(f64::from(sample - last).abs() <= largest);
                    last = sample;
                }
            }
            Ok(())
        });
    }

    #[test]
    fn a_slide_is_a_sine_of_its_frequency() {
        let slide = Tone { frequency: 200.0, amplitude: 0.5 };
        let mut synthesiser = Synthesiser::new(&mapping(), 8000.0, 1).unwrap();
        let mut samples = vec![0.0_f32; 8000];
        for tick in samples.chunks_mut(8) {
            synthesiser.render(&[Sensation { slide, ..Sensation::default() }], tick);
        }
        let up = samples.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
        assert!((199..=200).contains(&up), "{up} turns in a second");
        let largest = samples.iter().copied().fold(0.0, f32::max);
        assert!((f64::from(largest) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn silence_becomes_and_stays_silent() {
        let mut synthesiser = Synthesiser::new(&mapping(), 8000.0, 2).unwrap();
        let cue = Cue {
            depth: 0.01,
            normal_speed: 1.0,
            impact: Some(WOOD),
            began: true,
            ..Cue::default()
        };
        let mut samples = [0.0_f32; 32];
        synthesiser.render(&[mapping().feel(&cue)], &mut samples);
        assert!(samples.iter().any(|sample| *sample != 0.0));
        for _ in 0..1100 {
            synthesiser.render(&[], &mut samples);
        }
        assert_eq!(samples, [0.0; 32]);
        // Tap and hold, each at its largest, are up to 2 together. The tap rings for 95 ms, 24
        // ticks of 32 samples.
        let Limiting { ticks, least_gain } = synthesiser.limiting();
        assert!((1..=25).contains(&ticks) && (0.5..0.9).contains(&least_gain));
    }

    #[test]
    fn too_few_samples_are_refused() {
        let error = Synthesiser::new(&mapping(), 700.0, 1).unwrap_err();
        assert_eq!(
            error.to_string(),
            "sample_rate must be at least twice the highest frequency, got 700 Hz"
        );
        assert!(Synthesiser::new(&mapping(), 8000.0, 0).is_err());
        for wrong in [f64::NAN, f64::INFINITY, 1e300, -1.0, 0.0] {
            assert!(Synthesiser::new(&mapping(), wrong, 1).is_err(), "{wrong}");
            for (name, actuator) in &crate::ACTUATORS {
                let made = Synthesiser::for_actuator(&mapping(), actuator, wrong, 1);
                assert!(made.is_err(), "{name}: {wrong}");
            }
        }
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod wav_tests {
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
    fn the_header_is_of_plain_pcm_for_any_number_of_channels() {
        for channels in [1, 2, 10_u16] {
            let mut file = io::Cursor::new(vec![7; 100]);
            // The file begins where the writer stands.
            file.set_position(6);
            let samples = std::iter::repeat_n(0.5, 3 * usize::from(channels));
            write_wav(&mut file, 8000, channels, samples).unwrap();
            let end = 6 + 44 + 6 * u64::from(channels);
            assert_eq!(file.position(), end);
            let bytes = &file.get_ref()[6..];
            let short = |at: usize| u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap());
            let long = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
            assert_eq!((&bytes[..4], &bytes[8..16]), (&b"RIFF"[..], &b"WAVEfmt "[..]));
            assert_eq!((long(16), short(20), short(22)), (16, 1, channels));
            assert_eq!((long(24), long(28)), (8000, 16000 * u32::from(channels)));
            assert_eq!((short(32), short(34)), (2 * channels, 16));
            assert_eq!((&bytes[36..40], long(40)), (&b"data"[..], 6 * u32::from(channels)));
            assert_eq!(long(4), 36 + long(40));
        }
    }

    #[test]
    fn what_the_header_cannot_say_is_refused() {
        let write = |sample_rate, channels| {
            let file = io::Cursor::new(Vec::new());
            write_wav(file, sample_rate, channels, []).unwrap_err().to_string()
        };
        let message = |channels: u16, sample_rate: u32| {
            format!(
                "{channels} channels at {sample_rate} Hz are beyond the header of a WAV file"
            )
        };
        assert_eq!(write(8000, 40_000), message(40_000, 8000));
        assert_eq!(write(u32::MAX, 1), message(1, u32::MAX));
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
