// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Searches that prove where things touch.

mod triangles;

use std::error::Error;

use crate::fields::Rows;
use crate::scenes;

/// All rows of the suite.
pub(crate) fn measure() -> Result<Rows, Box<dyn Error>> {
    let mut rows = Rows::new();
    for work in scenes::spatial()? {
        eprintln!("measuring triangles on {} …", work.name);
        triangles::measure(&work, &mut rows)?;
    }
    Ok(rows)
}
