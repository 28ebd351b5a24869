// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Being scheduled before other threads.

use thread_priority::{ThreadPriority, thread_native_id};

/// The real-time priority asked for, in percent of the range: below what systems keep for
/// their own watchdogs, above what they run interrupts at.
#[cfg(unix)]
const PERCENT: u8 = 70;

/// Whether a thread is scheduled before others.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Priority {
    /// It was not asked for.
    Normal,
    /// It is.
    Raised,
    /// It was asked for, but the system does not allow it.
    Refused {
        /// What the system said.
        reason: String,
    },
}

/// Asks the system to schedule this thread before others: first in, first out where there are
/// POSIX policies, the highest priority of its class elsewhere.
///
/// Linux allows it to those with the capability `CAP_SYS_NICE` or a limit `rtprio` (in
/// `/etc/security/limits.conf`).
#[must_use]
pub fn raise_priority() -> Priority {
    match ask() {
        Ok(()) => Priority::Raised,
        Err(error) => Priority::Refused { reason: described(&error) },
    }
}

#[cfg(unix)]
fn ask() -> Result<(), thread_priority::Error> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy,
    };
    let percent = ThreadPriorityValue::try_from(PERCENT).unwrap_or_default();
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let thread = thread_native_id();
    set_thread_priority_and_policy(thread, ThreadPriority::Crossplatform(percent), policy)
        // Where the range is shorter.
        .or_else(|_| set_thread_priority_and_policy(thread, ThreadPriority::Max, policy))
}

#[cfg(not(unix))]
fn ask() -> Result<(), thread_priority::Error> {
    thread_priority::set_thread_priority(thread_native_id(), ThreadPriority::Max)
}

fn described(error: &thread_priority::Error) -> String {
    match error {
        thread_priority::Error::OS(code) => {
            std::io::Error::from_raw_os_error(*code).to_string()
        }
        other => format!("{other:?}"),
    }
}
