// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate grid`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use palpate::grid::{GridKernel, GridOptions as Options, Resolution, Store};

use super::numbers::{count, length};

pub(super) const EXAMPLES: &str = "\
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
