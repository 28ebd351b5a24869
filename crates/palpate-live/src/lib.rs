// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The live page: a local server of one world that can be seen, touched and edited in a browser.

pub mod shader;
