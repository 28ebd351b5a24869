// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate schema`.

use clap::{Args, ValueEnum};

/// The options of `palpate schema`.
#[derive(Args, Debug)]
pub(crate) struct SchemaOptions {
    /// What the schema is of.
    #[arg(value_enum, default_value = "scenes")]
    pub(crate) of: SchemaOf,
}

/// What a schema is of.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum SchemaOf {
    /// Scene files.
    Scenes,
    /// What `--json` prints, and the questions of other programs.
    Answers,
}
