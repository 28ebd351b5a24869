// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compresses the files of the page, so that no request waits for that.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;

/// The page, beside this file.
const PAGE: &str = "web";

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed={PAGE}");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?);
    let mut paths = Vec::new();
    files(Path::new(PAGE), &mut paths)?;
    // The program searches for them.
    paths.sort();
    let mut table = String::from("&[\n");
    for (number, path) in paths.iter().enumerate() {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&fs::read(Path::new(PAGE).join(path))?)?;
        let compressed = format!("{number}.gz");
        fs::write(out.join(&compressed), encoder.finish()?)?;
        table += &format!(
            "Compressed {{ path: {path:?}, bytes: include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{compressed}\")) }},\n"
        );
    }
    fs::write(out.join("page.rs"), table + "]\n")
}

/// The paths of all files below a folder, from the page on, with slashes.
fn files(folder: &Path, found: &mut Vec<String>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files(&path, found)?;
        } else {
            let path = path.strip_prefix(PAGE).map_err(io::Error::other)?;
            let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
            found.push(parts.join("/"));
        }
    }
    Ok(())
}
