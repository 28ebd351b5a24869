// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The local searches of the literature beside the proven ones: prints the tables of
//! `docs/guide/local-methods.md`: `cargo run --release -p palpate-local --example methods`

mod comparison;
mod inputs;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    for table in comparison::all()? {
        println!("{}\n", table.with_times());
    }
    Ok(())
}
