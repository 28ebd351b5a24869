// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of grid files, and shapes baked into grids.

use std::path::Path;

use palpate_field::{Shape, Vector};
use palpate_grid::{Grid, GridError, GridKernel, GridOptions, Lattice, Resolution, Store};
use serde::{Deserialize, Serialize};

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

/// A grid as a scene gives it: a file, or samples.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenGrid {
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    counts: Option<Vec<usize>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cell: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kernel: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<Vec<f64>>,
}

impl WrittenGrid {
    /// What a scene says of a grid of samples; `None` of one that samples alone do not make again.
    pub(crate) fn of<const D: usize>(grid: &Grid<D>) -> Option<Self> {
        let lattice = grid.lattice();
        let has_own_name = grid.kernel() != GridKernel::Quadratic;
        Some(Self {
            file: None,
            counts: Some(lattice.counts.to_vec()),
            cell: Some(lattice.cell),
            origin: Some(lattice.origin.0.to_vec()),
            kernel: has_own_name.then(|| grid.kernel().name().to_owned()),
            samples: Some(grid.samples()?),
        })
    }

    /// The grid; a file is looked for in `folder`.
    pub(crate) fn built<const D: usize>(
        &self,
        folder: Option<&Path>,
        kept: &KeptGrids<D>,
    ) -> Result<Shape<D>, Problem> {
        match self {
            Self {
                file: Some(file),
                counts: None,
                cell: None,
                origin: None,
                kernel: None,
                samples: None,
            } => of_file(file, folder, kept),
            Self {
                file: None,
                counts: Some(counts),
                cell: Some(cell),
                origin: Some(origin),
                kernel,
                samples: Some(samples),
            } => {
                let lattice = Lattice {
                    origin: Vector(along_axes(origin, "origin")?),
                    cell: *cell,
                    counts: along_axes(counts, "counts")?,
                };
                let kernel = match kernel {
                    None => GridKernel::Quadratic,
                    Some(name) => named(
                        name,
                        "kernel",
                        GridKernel::ALL.map(|kernel| (kernel.name(), kernel)),
                    )?,
                };
                let grid = Grid::from_samples(lattice, samples, kernel, Store::F32);
                grid.map(Shape::from).map_err(|error| Problem::new(error.to_string()))
            }
            _ => Err(Problem::new(
                "must have `file`, or `samples` with `counts`, `cell` and `origin`",
            )),
        }
    }
}

/// A number for each axis.
fn along_axes<T: Copy, const D: usize>(given: &[T], key: &str) -> Result<[T; D], Problem> {
    given.try_into().map_err(|_| {
        Problem::new(format!("must have {D} numbers, got {}", given.len())).under(key)
    })
}

/// The grid of a file.
fn of_file<const D: usize>(
    file: &str,
    folder: Option<&Path>,
    kept: &KeptGrids<D>,
) -> Result<Shape<D>, Problem> {
    let in_file = |problem: Problem| problem.under("file");
    let Beside { path, stamp } = Beside::of("a grid", file, folder).map_err(in_file)?;
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

/// How a shape is baked, as a file gives it.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenBake {
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cell: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kernel: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    store: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    band: Option<f64>,
}

impl WrittenBake {
    /// What a file says of these options.
    pub(crate) fn of(options: &GridOptions) -> Result<Self, Problem> {
        let own = GridOptions::with_resolution(options.resolution);
        if options.certified != own.certified {
            let message = format!(
                "files have no word for values certified to {} cells",
                options.certified
            );
            return Err(Problem::new(message));
        }
        let (tolerance, cell) = match options.resolution {
            Resolution::Tolerance(tolerance) => (Some(tolerance), None),
            Resolution::Cell(cell) => (None, Some(cell)),
        };
        let kernel = (options.kernel != own.kernel).then(|| options.kernel.name().to_owned());
        let store = (options.store != own.store).then(|| options.store.name().to_owned());
        Ok(Self { tolerance, cell, kernel, store, band: options.band })
    }

    fn options(&self) -> Result<GridOptions, Problem> {
        let resolution = match (self.tolerance, self.cell) {
            (Some(tolerance), None) => Resolution::Tolerance(tolerance),
            (None, Some(cell)) => Resolution::Cell(cell),
            _ => {
                let message = "bake takes either a tolerance [m] or the size of a cell [m]";
                return Err(Problem::new(message));
            }
        };
        let mut options =
            GridOptions { most_nodes: MOST_NODES, ..GridOptions::with_resolution(resolution) };
        if let Some(name) = &self.kernel {
            options.kernel =
                named(name, "kernel", GridKernel::ALL.map(|kernel| (kernel.name(), kernel)))?;
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
