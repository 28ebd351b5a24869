// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The live page: a local server of one world that can be seen, touched and edited in a browser.
//!
//! [`Live`] serves the page. Its servo runs in a thread of its own and shares lock-free buffers
//! with the server alone, whatever clients do. `docs/live-protocol.md` describes what both say to
//! each other; [`shader`] writes the formulas that the page draws.
//!
//! # Examples
//!
//! ```
//! use palpate_live::{Live, LiveOptions};
//!
//! # fn main() -> Result<(), palpate_live::LiveError> {
//! let coin = r#"{ "palpate": 1, "dimension": 2,
//!     "bodies": [ { "name": "coin", "shape": { "circle": { "radius": 0.05 } } } ] }"#;
//! let live = Live::start("coin", None, coin, LiveOptions::default())?;
//! assert!(live.url().starts_with("http://127.0.0.1:"));
//! assert_eq!(live.pages(), 0);
//! # Ok(())
//! # }
//! ```

#[cfg(any(test, feature = "fuzzing"))]
#[doc(hidden)]
pub mod fuzzing;
mod live;
mod server;
pub mod shader;
mod stage;
mod wire;

pub use live::{Live, LiveError, LiveOptions};
pub use stage::{GivenClock, Unsaved, UnsavedError, Watch, Work};
pub use wire::VERSION;
