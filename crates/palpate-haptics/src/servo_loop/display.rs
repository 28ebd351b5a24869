// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reports as a sentence each.

use std::fmt::{Display, Formatter, Result};

use super::connection::ConnectionReport;
use super::lines;
use super::pacer::Lateness;
use super::report::{
    Ending, EvaluationCounts, GuideReport, RunReport, TextureReport, ToolReport,
};
use super::statistics::{Bucket, Distribution};
use super::vibration::VibrationReport;

/// What a report says if the device refused the last forces.
pub(crate) const NOT_RELEASED: &str = "the device did not take the zero forces at the end";

/// The widest bar of a histogram, in blocks.
const WIDEST_BAR: u64 = 40;

impl Display for Ending {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Finished => f.write_str("finished"),
            Self::Interrupted => f.write_str("interrupted"),
            Self::DeviceLost { reason } => write!(f, "the device was lost: {reason}"),
            Self::Panicked { message } => write!(f, "the servo panicked: {message}"),
        }
    }
}

impl Display for RunReport {
    /// A sentence; with `{:#}` the lines that `palpate feel` prints, each of which ends.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if f.alternate() {
            return lines::write(f, self);
        }
        let Self { ending, ticks, rate, contact_time, largest_force, .. } = self;
        write!(f, "{ticks} ticks at {rate} Hz, {contact_time:.3} s in contact, ")?;
        write!(f, "at most {largest_force:.3} N; {ending}")?;
        if self.rows_dropped > 0 {
            write!(f, "; {} rows lost", self.rows_dropped)?;
        }
        if self.connection.is_troubled() {
            write!(f, "; the device {}", self.connection)?;
        }
        if self.is_released { Ok(()) } else { write!(f, "; {NOT_RELEASED}") }
    }
}

impl Display for ConnectionReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self.watchdog {
            Some(time) => {
                write!(f, "lets go by itself after {:.3} ms without a tick", 1e3 * time)?
            }
            None => f.write_str("has no watchdog of its own")?,
        }
        let Self { stale_ticks, not_ready_ticks, longest_gap, .. } = self;
        if *stale_ticks > 0 {
            let gap = 1e3 * longest_gap;
            write!(f, "; {stale_ticks} ticks without a new state, for {gap:.3} ms at most")?;
        }
        if *not_ready_ticks > 0 {
            write!(f, "; {not_ready_ticks} ticks without any state")?;
        }
        let Self { losses, reconnections, lost_time, last_loss, not_closed, .. } = self;
        if *losses > 0 {
            write!(f, "; lost {losses} times, found again {reconnections} times, ")?;
            write!(f, "{lost_time:.3} s without it")?;
        }
        if let Some(reason) = last_loss {
            write!(f, "; the last loss: {reason}")?;
        }
        not_closed.as_ref().map_or(Ok(()), |reason| write!(f, "; not closed: {reason}"))
    }
}

impl Display for VibrationReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { commands, strongest, lost } = self;
        write!(f, "{commands} commands, an amplitude of {strongest:.2} at most")?;
        lost.as_ref().map_or(Ok(()), |reason| write!(f, "; lost: {reason}"))
    }
}

impl Display for EvaluationCounts {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{:.2} a tick, {} at most", self.mean, self.max)
    }
}

impl Display for GuideReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { kind, time, largest_force, taken, given } = self;
        if *time == 0.0 {
            return write!(f, "a {kind}, did not hold the hand");
        }
        write!(
            f,
            "a {kind}, held the hand for {time:.3} s with at most {largest_force:.3} N; "
        )?;
        let [taken, given] = [taken, given].map(|energy| 1e3 * energy);
        write!(f, "{taken:.3} mJ taken from the hand, {given:.3} mJ given")
    }
}

impl Display for TextureReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { ticks, faded_ticks, highest_frequency, wanted_rate, .. } = self;
        write!(
            f,
            "faded in {faded_ticks} of {ticks} ticks: up to {highest_frequency:.0} crests a "
        )?;
        write!(f, "second want a rate of {wanted_rate:.0} Hz")
    }
}

impl Display for ToolReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { points, most_contacts, largest_torque, resolution, .. } = self;
        write!(f, "{points} points, at most {most_contacts} contacts and ")?;
        write!(f, "{largest_torque:.4} N·m, known to {:.3} mm", 1e3 * resolution)
    }
}

impl Display for Distribution {
    /// The quantiles; with `{:#}` a line with a bar for each bucket follows.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let times = [self.p50, self.p99, self.p999, self.max];
        let [p50, p99, p999, max] = times.map(|time| 1e6 * time);
        write!(f, "p50 {p50:.2} µs, p99 {p99:.2} µs, p99.9 {p999:.2} µs, max {max:.2} µs")?;
        if !f.alternate() {
            return Ok(());
        }
        let most = self.buckets.iter().map(|bucket| bucket.count).max().unwrap_or(1).max(1);
        for Bucket { up_to, count } in &self.buckets {
            // A bucket that is not empty has a bar of at least one block.
            let bar = "█".repeat((count * WIDEST_BAR).div_ceil(most) as usize);
            write!(f, "\n    up to {:>8.0} µs {count:>8} {bar}", 1e6 * up_to)?;
        }
        Ok(())
    }
}

impl Display for Lateness {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match &self.times {
            None => f.write_str("no tick"),
            Some(times) => {
                times.fmt(f)?;
                write!(f, "; {} of {} more than a period late", self.missed, times.count)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo_loop::report::{Ended, Tally};
    use crate::{Protection, Servo, ServoOptions};
    use palpate_device::DeviceProfile;

    #[test]
    fn a_report_is_a_sentence_with_its_ending() {
        let circle = palpate_field::Shape::circle(0.05).unwrap();
        let servo = Servo::new(circle, 1, ServoOptions::default()).unwrap();
        let profile = DeviceProfile::unlimited("none");
        let tally = Tally::new(&servo.protected(&Protection::new(profile)).unwrap());
        let ended = |ending, is_released| Ended {
            ending,
            is_released,
            rows_dropped: 0,
            safety: Vec::new(),
            connection: ConnectionReport::default(),
            vibration: None,
        };
        let report = tally.report(ended(Ending::Finished, true));
        let said = "0 ticks at 1000 Hz, 0.000 s in contact, at most 0.000 N; finished";
        assert_eq!(report.to_string(), said);
        let stale = ConnectionReport { stale_ticks: 3, ..ConnectionReport::default() };
        let report =
            RunReport { connection: stale, ..tally.report(ended(Ending::Finished, true)) };
        let troubled = "; the device has no watchdog of its own; 3 ticks without a new state, for \
                        0.000 ms at most";
        assert_eq!(report.to_string(), format!("{said}{troubled}"));
        let lost = Ending::DeviceLost { reason: "unplugged".to_owned() };
        let report = tally.report(ended(lost, false));
        let said = "; the device was lost: unplugged; the device did not take the zero forces \
                    at the end";
        assert!(report.to_string().ends_with(said), "{report}");
    }

    #[test]
    fn a_connection_says_what_went_wrong_and_no_more() {
        let quiet = ConnectionReport::default();
        assert_eq!(quiet.to_string(), "has no watchdog of its own");
        let connection = ConnectionReport {
            watchdog: Some(0.03),
            stale_ticks: 14,
            not_ready_ticks: 3,
            longest_gap: 0.0025,
            losses: 2,
            reconnections: 1,
            lost_time: 0.75,
            last_loss: Some("unplugged".to_owned()),
            not_closed: Some("no answer".to_owned()),
        };
        let said = "lets go by itself after 30.000 ms without a tick; 14 ticks without a new state, \
                    for 2.500 ms at most; 3 ticks without any state; lost 2 times, found again 1 \
                    times, 0.750 s without it; the last loss: unplugged; not closed: no answer";
        assert_eq!(connection.to_string(), said);
        let lost = Some("pulled out".to_owned());
        let played = VibrationReport { commands: 11, strongest: 0.625, lost };
        let said = "11 commands, an amplitude of 0.62 at most; lost: pulled out";
        assert_eq!(played.to_string(), said);
    }

    #[test]
    fn a_tool_a_guide_and_times_are_a_sentence() {
        let (points, most_contacts, largest_torque) = (41, 3, 0.0125);
        let tool = ToolReport {
            points,
            most_contacts,
            largest_torque,
            resolution: 5e-4,
            ..ToolReport::default()
        };
        let said = "41 points, at most 3 contacts and 0.0125 N·m, known to 0.500 mm";
        assert_eq!(tool.to_string(), said);
        let mut guide = GuideReport { kind: "well", ..GuideReport::default() };
        assert_eq!(guide.to_string(), "a well, did not hold the hand");
        (guide.time, guide.largest_force) = (1.5, 2.25);
        (guide.taken, guide.given) = (0.003, 0.0005);
        let said = "a well, held the hand for 1.500 s with at most 2.250 N; \
                    3.000 mJ taken from the hand, 0.500 mJ given";
        assert_eq!(guide.to_string(), said);
    }

    #[test]
    fn times_are_quantiles_and_bars() {
        let (p50, p99, p999, max) = (1e-6, 2.5e-6, 2.9e-6, 3e-6);
        let bucket = |up_to, count| Bucket { up_to, count };
        let buckets = vec![bucket(1e-6, 79), bucket(2e-6, 1), bucket(4e-6, 0)];
        let times = Distribution { count: 80, mean: 0.0, p50, p99, p999, max, buckets };
        let said = "p50 1.00 µs, p99 2.50 µs, p99.9 2.90 µs, max 3.00 µs";
        assert_eq!(times.to_string(), said);
        let bars = format!(
            "{said}\n    up to        1 µs       79 {}\n    up to        2 µs        1 █\n    \
             up to        4 µs        0 ",
            "█".repeat(40),
        );
        assert_eq!(format!("{times:#}"), bars);
        let lateness = Lateness { times: Some(times), missed: 1 };
        assert_eq!(lateness.to_string(), format!("{said}; 1 of 80 more than a period late"));
        assert_eq!(Lateness::default().to_string(), "no tick");
    }
}
