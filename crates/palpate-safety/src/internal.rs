// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What other crates of palpate use. It is no part of the interface and may change at any time.

pub use crate::approach::Approach;
pub use crate::limit::{limited, shortening};
