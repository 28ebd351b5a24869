// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate grid`: samples a scene on a grid.

use std::fmt;
use std::ops::ControlFlow;
use std::path::Path;

use palpate::field::Shape;
use palpate::grid::{Grid, GridError, GridFileProblem, GridProgress};
use palpate::scene::{AnyScene, BuiltScene};
use serde::Serialize;

use crate::arguments::GridOptions;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::{progress, threads};
use palpate::scene::text::rounded;

/// Bakes the scene, or one of its bodies; the answer is no if the deviation is not known.
pub(crate) fn run(options: &GridOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene))?;
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
    let mut files = Files::reading([options.scene.as_path()]);
    let destination = files.output_as(&options.output, "a grid", "grid")?;
    let pool = threads::pool(options.threads)?;
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
    let shown = progress::Progress::of("sampling");
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
    /// How far values are from the scene's at most, proven [m]; `null` if nothing is known.
    pub(crate) deviation: Option<f64>,
    /// The size of the values that the deviation holds for [m]; others are bounds alone.
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
