// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of grid files, and shapes baked into grids.

use std::path::Path;

use palpate_field::Shape;
use palpate_grid::{Grid, GridError, GridOptions, Kernel, Resolution, Store};
use serde::Deserialize;

use crate::beside::{Beside, Kept, Stamp};
use crate::problem::Problem;
use crate::resources::Resources;

/// The samples of all grids that are kept.
const MOST_SAMPLES: usize = 1 << 27;

/// The nodes of a grid that a scene bakes: more are made once, by a command, and read from a file.
const MOST_NODES: usize = 1 << 25;

pub(crate) static PLANAR: KeptGrids<2> = Kept::new(MOST_SAMPLES);
pub(crate) static SPATIAL: KeptGrids<3> = Kept::new(MOST_SAMPLES);

/// What a grid is made of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source<const D: usize> {
    File(Stamp),
    Shape(Shape<D>, GridOptions),
}

/// The grids that are kept.
pub(crate) type KeptGrids<const D: usize> = Kept<Source<D>, Shape<D>>;

/// A grid as a file gives it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenGrid {
    file: String,
}

impl WrittenGrid {
    /// The grid of the file, which is looked for in `folder`.
    pub(crate) fn built<const D: usize>(
        &self,
        folder: Option<&Path>,
        kept: &KeptGrids<D>,
    ) -> Result<Shape<D>, Problem> {
        let in_file = |problem: Problem| problem.under("file");
        let Beside { path, stamp } =
            Beside::of("a grid", &self.file, folder).map_err(in_file)?;
        let source = Source::File(stamp.clone());
        if let Some(known) = kept.of(&source) {
            return Ok(known);
        }
        let grid =
            Grid::<D>::open(&path).map_err(|error| in_file(Problem::new(error.to_string())))?;
        let samples = grid.stored_samples();
        let shape = grid.into();
        kept.keep(
            source,
            &shape,
            samples,
            |known| matches!(known, Source::File(known) if known.is_of_same_file(&stamp)),
        );
        Ok(shape)
    }
}

/// How a shape is baked, as a file gives it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenBake {
    tolerance: Option<f64>,
    cell: Option<f64>,
    kernel: Option<String>,
    store: Option<String>,
    band: Option<f64>,
}

impl WrittenBake {
    fn options(&self) -> Result<GridOptions, Problem> {
        let resolution = match (self.tolerance, self.cell) {
            (Some(tolerance), None) => Resolution::Tolerance(tolerance),
            (None, Some(cell)) => Resolution::Cell(cell),
            _ => {
                let message = "bake takes either a tolerance [m] or the size of a cell [m]";
                return Err(Problem::new(message));
            }
        };
        let mut options = GridOptions::with_resolution(resolution).with_most_nodes(MOST_NODES);
        if let Some(name) = &self.kernel {
            options.kernel =
                named(name, "kernel", Kernel::ALL.map(|kernel| (kernel.name(), kernel)))?;
        }
        if let Some(name) = &self.store {
            options.store =
                named(name, "store", Store::ALL.map(|store| (store.name(), store)))?;
        }
        options.band = self.band;
        Ok(options)
    }

    /// Whether its numbers and names are good.
    pub(crate) fn check(&self) -> Result<(), Problem> {
        self.options().map(|_| ())
    }

    /// The grid of a shape.
    pub(crate) fn baked<const D: usize>(
        &self,
        shape: Shape<D>,
        kept: &KeptGrids<D>,
        resources: &Resources,
    ) -> Result<Shape<D>, Problem> {
        let source = Source::Shape(shape, self.options()?);
        if let Some(known) = kept.of(&source) {
            return Ok(known);
        }
        let Source::Shape(shape, options) = &source else { unreachable!("it was made above") };
        let grid = resources.bake(shape, options).map_err(|error| match error {
            GridError::Number(error) => Problem::of_shape(error),
            error => Problem::new(error.to_string()),
        })?;
        let samples = grid.stored_samples();
        let made = grid.into();
        kept.keep(source, &made, samples, |_| false);
        Ok(made)
    }
}

/// What a name stands for.
pub(crate) fn named<T: Copy, const N: usize>(
    name: &str,
    key: &str,
    known: [(&str, T); N],
) -> Result<T, Problem> {
    let found = known.iter().find(|(known, _)| *known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names = known.map(|(known, _)| format!("{known:?}")).join(", ");
        Problem::new(format!("{key} must be one of {names}, got {name:?}")).under(key)
    })
}
