// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The scheduling priority of a thread.

use thread_priority::{ThreadPriority, thread_native_id};

/// The requested real-time priority, in percent of the range: below the system's own watchdogs,
/// above its interrupt threads.
#[cfg(unix)]
const PERCENT: u8 = 70;

/// Whether a thread is scheduled before others.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Priority {
    /// The normal priority; no other was requested.
    Normal,
    /// A raised priority.
    Raised,
    /// The system refused a raised priority.
    Refused {
        /// The error of the operating system.
        reason: String,
    },
}

/// Requests that the system schedules this thread before others: with the POSIX policy first
/// in, first out where it exists, with the highest priority of the thread's class elsewhere.
///
/// Linux grants the request to processes with the capability `CAP_SYS_NICE` or a limit `rtprio`
/// (in `/etc/security/limits.conf`).
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
        // Some systems have a shorter range.
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
