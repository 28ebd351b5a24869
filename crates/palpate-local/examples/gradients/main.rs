// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Five ways to the gradient of a field: prints the table of `docs/guide/gradients.md`:
//! `cargo run --release -p palpate-local --example gradients`

mod comparison;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", comparison::table()?);
    Ok(())
}
