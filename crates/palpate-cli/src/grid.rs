// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate grid`: samples a scene on a grid.

use std::fmt;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use palpate::field::Shape;
use palpate::grid::{
    Grid, GridError, GridFileProblem, GridKernel, GridOptions as Options, GridProgress,
    Resolution, Store,
};
use palpate::scene::text::rounded;
use palpate::scene::{AnyScene, BuiltScene};
use serde::Serialize;

use crate::arguments::Reading;
use crate::arguments::numbers::{count, length};
use crate::input;
use crate::interrupt::{self, Interrupt, Progress};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};

/// Bakes the scene, or one of its bodies; the answer is no if the deviation is not known.
pub(crate) fn run(options: &GridOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene), options.reading)?;
    match &named.scene {
        AnyScene::Planar(scene) => bake(options, scene, interrupt),
        AnyScene::Spatial(scene) => bake(options, scene, interrupt),
    }
}

fn bake<const D: usize>(
    options: &GridOptions,
    scene: &BuiltScene<D>,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let shape = input::body_or_whole(scene, options.body.as_deref())?;
    let mut files = Files::reading([options.scene.as_path()], options.reading);
    let destination = files.output_as(&options.output, "a grid", "grid")?;
    let pool = interrupt::pool(options.threads)?;
    interrupt.heed();
    let made = pool.install(|| grid(options, shape, interrupt));
    let Some(grid) = made? else {
        output::remark("interrupted: nothing was written");
        return Ok(Outcome::Interrupted);
    };
    destination.write(|out| {
        grid.write(out).map_err(|problem| match problem {
            GridFileProblem::System(error) => error.into(),
            problem => Failure::file(&options.output, problem),
        })
    })?;
    let answer = Answer::of(&options.output, shape, &grid);
    output::answer().print(&answer, options.json)?;
    Ok(if answer.deviation.is_some() { Outcome::Yes } else { Outcome::No })
}

/// The grid of a shape; `None` if the program is asked to end.
fn grid<const D: usize>(
    options: &GridOptions,
    shape: &Shape<D>,
    interrupt: &Interrupt,
) -> Result<Option<Grid<D>>, Failure> {
    let shown = Progress::of("sampling");
    let progress = |GridProgress { done, of, cell }: GridProgress| {
        shown.show(done, of, format_args!("cells of {} m", rounded(cell)));
        if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let made = Grid::bake_with(shape, &options.options(), &progress);
    drop(shown);
    match made {
        Ok(grid) => Ok(Some(grid)),
        Err(GridError::Stopped) => Ok(None),
        Err(error) => Err(Failure::file(&options.scene, error)),
    }
}

/// The answer of `palpate grid`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The file.
    pub(crate) output: String,
    /// The distance of neighbouring nodes [m].
    pub(crate) cell: f64,
    /// The nodes along each axis.
    pub(crate) counts: Vec<usize>,
    /// The place of the first node [m].
    pub(crate) origin: Vec<f64>,
    /// How many samples are stored.
    pub(crate) stored_samples: usize,
    /// How samples become values: `quadratic` or `trilinear`.
    pub(crate) kernel: &'static str,
    /// How samples are stored.
    pub(crate) store: &'static str,
    /// The proven largest difference between a value of the grid and that of the scene [m].
    pub(crate) deviation: Option<f64>,
    /// `deviation` holds for values whose size is at most this [m]. Larger values are bounds
    /// alone.
    pub(crate) within: Option<f64>,
    /// `true` if the scene's values are distances.
    pub(crate) source_is_exact: bool,
    /// The steepest slope of the values.
    pub(crate) lipschitz: f64,
    /// What the values promise, in words.
    pub(crate) promise: String,
}

impl Answer {
    fn of<const D: usize>(output: &Path, shape: &Shape<D>, grid: &Grid<D>) -> Self {
        let (lattice, promise) = (grid.lattice(), grid.promise());
        Self {
            output: output.display().to_string(),
            cell: lattice.cell,
            counts: lattice.counts.to_vec(),
            origin: lattice.origin.0.to_vec(),
            stored_samples: grid.stored_samples(),
            kernel: grid.kernel().name(),
            store: grid.store().name(),
            deviation: Some(grid.deviation()).filter(|deviation| deviation.is_finite()),
            within: promise.deviation.map(|deviation| deviation.within),
            source_is_exact: shape.promise().is_exact(),
            lipschitz: promise.lipschitz,
            promise: promise.in_words(),
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cell, kernel, store, stored_samples, .. } = self;
        let counts: Vec<_> = self.counts.iter().map(usize::to_string).collect();
        let counts = counts.join(" × ");
        writeln!(
            f,
            "{}: {counts} nodes, {cell} m apart; {kernel}, {store}, {stored_samples} samples",
            shown(&self.output)
        )?;
        match self.deviation {
            Some(deviation) => {
                let within = self.within.unwrap_or_default();
                writeln!(
                    f,
                    "  values   up to {within:.3e} m in size: off the scene's by at most {deviation:.3e} m, proven"
                )?;
                if self.source_is_exact {
                    writeln!(f, "  surface  at most {deviation:.3e} m from the scene's")?;
                } else {
                    writeln!(
                        f,
                        "  surface  may be farther off: the scene's values are bounds of the distance"
                    )?;
                }
            }
            None => writeln!(
                f,
                "  values   off the scene's by an unknown amount: take smaller cells, or a wider --band"
            )?,
        }
        writeln!(f, "  slope    at most {:.4}", self.lipschitz)
    }
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate grid scenes/cup.json --tolerance 5e-4 --output cup.grid
  palpate grid scenes/cup.json --cell 0.001 --band 5 --store i16 --output cup.grid --json

A scene uses the file as { \"grid\": { \"file\": \"cup.grid\" } }. The deviation is certified:
near the surface, as far as is printed, the values of the grid differ from the scene's by no more. Status 1 if it is not known.";

/// The options of `palpate grid`.
#[derive(Args, Debug)]
pub(crate) struct GridOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The largest deviation from the values of the scene [m]: cells are as small as it takes.
    #[arg(long, allow_negative_numbers = true, value_parser = length, required_unless_present = "cell", conflicts_with = "cell")]
    pub(crate) tolerance: Option<f64>,
    /// The size of a cell [m].
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) cell: Option<f64>,
    /// One body instead of all.
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Option<String>,
    /// How samples are interpolated: quadratic to be touched, trilinear to be quick.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) kernel: KernelChoice,
    /// How samples are stored.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) store: StoreChoice,
    /// Keep only samples within so many cells of the surface; all if left out.
    #[arg(long, value_name = "CELLS", allow_negative_numbers = true)]
    pub(crate) band: Option<f64>,
    /// The most nodes; a million take about 20 MB while they are made.
    #[arg(long, allow_negative_numbers = true, default_value_t = 1 << 26, value_parser = count(1, 1_usize << 32))]
    pub(crate) nodes: usize,
    /// The file to write; its name ends in .grid.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Threads; as many as the machine runs at once if left out.
    #[arg(long, value_parser = count(1, 1024_usize))]
    pub(crate) threads: Option<usize>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// A kernel by its name.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum KernelChoice {
    /// Smooth: 27 samples in space.
    #[default]
    Quadratic,
    /// Eight samples in space.
    Trilinear,
}

/// A store by its name.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum StoreChoice {
    /// Single precision.
    #[default]
    F32,
    /// Whole numbers of 16 bits.
    I16,
    /// Whole numbers of 8 bits.
    I8,
}

impl GridOptions {
    /// What is asked of the library.
    pub(crate) fn options(&self) -> Options {
        let resolution = match (self.tolerance, self.cell) {
            (Some(tolerance), _) => Resolution::Tolerance(tolerance),
            (None, cell) => Resolution::Cell(cell.unwrap_or_default()),
        };
        Options {
            kernel: match self.kernel {
                KernelChoice::Quadratic => GridKernel::Quadratic,
                KernelChoice::Trilinear => GridKernel::Trilinear,
            },
            store: match self.store {
                StoreChoice::F32 => Store::F32,
                StoreChoice::I16 => Store::I16,
                StoreChoice::I8 => Store::I8,
            },
            most_nodes: self.nodes,
            band: self.band,
            ..Options::with_resolution(resolution)
        }
    }
}
