// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a scene uses beside its text.

use std::fmt;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use palpate_field::Shape;
use palpate_grid::{Grid, GridCache, GridError, GridOptions, GridProgress};

/// Who is told how a grid is made, and can stop it.
pub type BakeProgress = Arc<dyn Fn(GridProgress) -> ControlFlow<()> + Send + Sync>;

/// What a scene uses beside its text: the folder of its files, a folder of grids that were baked before, and who is
/// told how a grid is made. A folder alone [becomes](From) resources.
///
/// ```
/// use palpate_scene::{Resources, Scene};
///
/// # fn main() -> Result<(), palpate_scene::SceneError> {
/// let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "disc",
///     "shape": { "bake": { "cell": 0.002 }, "of": { "ball": { "radius": 0.02 } } } } ] }"#;
/// # let folder = tempfile::tempdir().expect("a folder");
/// let resources = Resources::default().with_cache(folder.path().join("grids"));
/// Scene::from_json_in(text, resources)?.build()?;
/// // The next run reads the grid from the folder.
/// # assert_eq!(std::fs::read_dir(folder.path().join("grids")).expect("is made").count(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Default)]
#[non_exhaustive]
pub struct Resources {
    /// The folder in which files of meshes, volumes and grids are looked for; a scene without one has none.
    pub folder: Option<PathBuf>,
    /// Where grids that are baked are kept from run to run; `None` keeps them in memory alone.
    pub cache: Option<GridCache>,
    /// Who is told how a grid is made.
    pub progress: Option<BakeProgress>,
}

impl Resources {
    /// The same with files in a folder.
    #[must_use]
    pub fn in_folder(self, folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()), ..self }
    }

    /// The same with grids kept in a folder, of up to 2 GiB.
    #[must_use]
    pub fn with_cache(self, folder: impl Into<PathBuf>) -> Self {
        Self { cache: Some(GridCache::in_folder(folder)), ..self }
    }

    /// The same, telling how a grid is made.
    #[must_use]
    pub fn with_progress(self, progress: BakeProgress) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// The grid of a shape, kept or made.
    pub(crate) fn bake<const D: usize>(
        &self,
        shape: &Shape<D>,
        options: &GridOptions,
    ) -> Result<Grid<D>, GridError> {
        let silent = |_| ControlFlow::Continue(());
        let progress: &(dyn Fn(GridProgress) -> ControlFlow<()> + Sync) = match &self.progress {
            Some(progress) => &**progress,
            None => &silent,
        };
        match &self.cache {
            Some(cache) => cache.bake(shape, options, progress).map(|(grid, _)| grid),
            None => Grid::bake_with(shape, options, progress),
        }
    }
}

impl From<PathBuf> for Resources {
    fn from(folder: PathBuf) -> Self {
        Self::default().in_folder(folder)
    }
}

impl From<&Path> for Resources {
    fn from(folder: &Path) -> Self {
        Self::default().in_folder(folder)
    }
}

impl PartialEq for Resources {
    /// Who is told does not count.
    fn eq(&self, other: &Self) -> bool {
        (&self.folder, &self.cache) == (&other.folder, &other.cache)
    }
}

impl fmt::Debug for Resources {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { folder, cache, progress: _ } = self;
        f.debug_struct("Resources")
            .field("folder", folder)
            .field("cache", cache)
            .finish_non_exhaustive()
    }
}
