// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Grids that were baked before, in a folder.

use std::fs::{self, File};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use palpate_field::Shape;

use crate::bake::{GridOptions, GridProgress};
use crate::error::GridError;
use crate::file::{GridFileError, MAGIC};
use crate::grid::Grid;

/// A change of what is baked from the same shape and options changes this number.
const BAKED: u8 = 1;

/// The bytes of all files that are kept unless another number is asked for: 2 GiB.
const MOST_BYTES: u64 = 2 << 30;

/// The ending of the files.
const ENDING: &str = "grid";

/// A folder of grids, each under the BLAKE3 sum of what it was baked from: the [content](Shape::content) of the
/// shape, the options, and the version of the format. A file that is damaged, or of another version, is baked anew.
///
/// When the files have more bytes than the limit, those that were used longest ago are removed.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use palpate_field::Shape;
/// use palpate_grid::{Found, GridCache, GridOptions};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// let cache = GridCache::in_folder(folder.path());
/// let (ball, options) = (Shape::sphere(0.05)?, GridOptions::with_cell(0.005));
/// let go_on = |_| ControlFlow::Continue(());
/// let (made, found) = cache.bake(&ball, &options, &go_on)?;
/// assert!(matches!(found, Found::Made));
/// let (again, found) = cache.bake(&ball, &options, &go_on)?;
/// assert!(matches!(found, Found::Kept) && again.promise() == made.promise());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GridCache {
    folder: PathBuf,
    most_bytes: u64,
}

/// Where a grid comes from.
#[derive(Debug)]
#[non_exhaustive]
pub enum Found {
    /// It was kept.
    Kept,
    /// It was made, and is kept.
    Made,
    /// It was made, and is not kept: the shape has a part that is known by its Rust type alone.
    Unknown,
    /// It was made, and cannot be kept.
    NotKept(GridFileError),
}

impl GridCache {
    /// The grids in a folder, which is made when one is kept.
    #[must_use]
    pub fn in_folder(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), most_bytes: MOST_BYTES }
    }

    /// The same with another limit of the bytes of all files.
    #[must_use]
    pub fn with_most_bytes(self, most_bytes: u64) -> Self {
        Self { most_bytes, ..self }
    }

    /// The grid of a shape: kept, or else baked, as by [`Grid::bake_with`], and kept.
    ///
    /// # Errors
    ///
    /// As [`Grid::bake_with`]. That a file cannot be written is none: the [answer](Found::NotKept) says so.
    #[inline(never)]
    pub fn bake<const D: usize>(
        &self,
        shape: &Shape<D>,
        options: &GridOptions,
        progress: &(dyn Fn(GridProgress) -> ControlFlow<()> + Sync),
    ) -> Result<(Grid<D>, Found), GridError> {
        let Some(path) = self.path(shape, options) else {
            return Ok((Grid::bake_with(shape, options, progress)?, Found::Unknown));
        };
        if let Ok(kept) = Grid::open(&path) {
            // The time of a file that may not be written to stays.
            drop(
                File::options()
                    .append(true)
                    .open(&path)
                    .and_then(|file| file.set_modified(SystemTime::now())),
            );
            return Ok((kept, Found::Kept));
        }
        let grid = Grid::bake_with(shape, options, progress)?;
        let found = match self.keep(&grid, &path) {
            Ok(()) => Found::Made,
            Err(error) => Found::NotKept(error),
        };
        Ok((grid, found))
    }

    /// The file of the grid of a shape; `None` if a part of the shape is known by its Rust type alone.
    fn path<const D: usize>(&self, shape: &Shape<D>, options: &GridOptions) -> Option<PathBuf> {
        let mut sum = blake3::Hasher::new();
        sum.update(&MAGIC);
        sum.update(&[BAKED, D as u8]);
        // All options are numbers and names, which are written whole.
        let options = format!("{options:?}");
        sum.update(&(options.len() as u64).to_le_bytes());
        sum.update(options.as_bytes());
        let is_known = shape.content(&mut |part| {
            sum.update(part);
        });
        is_known.then(|| self.folder.join(format!("{}.{ENDING}", sum.finalize().to_hex())))
    }

    fn keep<const D: usize>(&self, grid: &Grid<D>, path: &Path) -> Result<(), GridFileError> {
        fs::create_dir_all(&self.folder).map_err(|error| GridFileError {
            path: self.folder.clone(),
            problem: error.into(),
        })?;
        grid.save(path)?;
        self.clear(path);
        Ok(())
    }

    /// Removes the files that were used longest ago, but the newest one, until all have no more bytes than the limit.
    fn clear(&self, newest: &Path) {
        let Ok(files) = fs::read_dir(&self.folder) else { return };
        let mut files: Vec<_> = files
            .filter_map(|file| {
                let (file, path) = (file.as_ref().ok()?, file.as_ref().ok()?.path());
                let metadata = file.metadata().ok().filter(|metadata| metadata.is_file())?;
                let is_grid = path.extension().is_some_and(|ending| ending == ENDING);
                let used = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                is_grid.then_some((used, path, metadata.len()))
            })
            .collect();
        files.sort();
        let mut bytes: u64 = files.iter().map(|(.., bytes)| bytes).sum();
        for (_, path, size) in files {
            if bytes <= self.most_bytes {
                return;
            }
            // Another program may have removed it, or may read it.
            if path != newest && fs::remove_file(&path).is_ok() {
                bytes -= size;
            }
        }
    }
}
