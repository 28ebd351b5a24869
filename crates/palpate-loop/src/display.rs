// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reports as a sentence each.

use std::fmt::{Display, Formatter, Result};

use crate::pacer::Lateness;
use crate::report::{Ending, RunReport};
use crate::statistics::Distribution;
use crate::tool_report::ToolReport;

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
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { ending, ticks, rate, contact_time, largest_force, .. } = self;
        write!(f, "{ticks} ticks at {rate} Hz, {contact_time:.3} s in contact, ")?;
        write!(f, "at most {largest_force:.3} N; {ending}")?;
        if self.is_released {
            Ok(())
        } else {
            f.write_str("; the device did not take the zero forces at the end")
        }
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
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { count, p50_ns, p99_ns, max_ns, .. } = self;
        write!(f, "{count} times: p50 {p50_ns} ns, p99 {p99_ns} ns, max {max_ns} ns")
    }
}

impl Display for Lateness {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match &self.times {
            None => f.write_str("no tick"),
            Some(times) => write!(f, "{times}; {} more than a period late", self.missed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Tally;
    use palpate_haptics::{DeviceProfile, Protection, ServoOptions, UnprotectedServo};

    #[test]
    fn a_report_is_a_sentence_with_its_ending() {
        let circle = palpate_field::Shape::circle(0.05).unwrap();
        let servo = UnprotectedServo::new(circle, 1, ServoOptions::default()).unwrap();
        let profile = DeviceProfile::unlimited("none");
        let tally = Tally::new(&servo.protected(&Protection::new(profile)).unwrap());
        let report = tally.report(Ending::Finished, true, 0, Vec::new());
        let said = "0 ticks at 1000 Hz, 0.000 s in contact, at most 0.000 N; finished";
        assert_eq!(report.to_string(), said);
        let lost = Ending::DeviceLost { reason: "unplugged".to_owned() };
        let report = tally.report(lost, false, 0, Vec::new());
        let said = "; the device was lost: unplugged; the device did not take the zero forces \
                    at the end";
        assert!(report.to_string().ends_with(said), "{report}");
    }

    #[test]
    fn a_tool_and_times_are_a_sentence() {
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
        let (p50_ns, p99_ns, max_ns) = (1, 2, 3);
        let times =
            Distribution { count: 4, p50_ns, p99_ns, max_ns, ..Distribution::default() };
        let lateness = Lateness { times: Some(times), missed: 1 };
        let said = "4 times: p50 1 ns, p99 2 ns, max 3 ns; 1 more than a period late";
        assert_eq!(lateness.to_string(), said);
        assert_eq!(Lateness::default().to_string(), "no tick");
    }
}
