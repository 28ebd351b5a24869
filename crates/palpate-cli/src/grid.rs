// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate grid`: samples a scene on a grid.

use std::io::Write;
use std::ops::ControlFlow;

use palpate::field::Shape;
use palpate::grid::{Grid, GridError, GridFileProblem, GridProgress};
use palpate::scene::{AnyScene, BuiltScene};
use serde_json::json;

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
    report(options, shape, &grid)?;
    Ok(if grid.deviation().is_finite() { Outcome::Yes } else { Outcome::No })
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

fn report<const D: usize>(
    options: &GridOptions,
    shape: &Shape<D>,
    grid: &Grid<D>,
) -> Result<(), Failure> {
    let mut out = output::answer();
    let (lattice, promise) = (grid.lattice(), grid.promise());
    let name = options.output.display().to_string();
    let is_exact = shape.promise().is_exact();
    let deviation = Some(grid.deviation()).filter(|deviation| deviation.is_finite());
    if options.json {
        out.json(&json!({
            "output": name,
            "cell_m": lattice.cell,
            "nodes": lattice.counts.to_vec(),
            "origin_m": lattice.origin.0.to_vec(),
            "stored_samples": grid.stored_samples(),
            "kernel": grid.kernel().name(),
            "store": grid.store().name(),
            "deviation_m": deviation,
            "deviation_of_values_up_to_m": promise.deviation.map(|deviation| deviation.within),
            "source_is_exact": is_exact,
            "lipschitz": promise.lipschitz,
            "promise": promise.in_words(),
        }))?;
        return Ok(());
    }
    let counts = lattice.counts.map(|count| count.to_string()).join(" × ");
    writeln!(
        out,
        "{}: {counts} nodes, {} m apart; {}, {}, {} samples",
        shown(&name),
        lattice.cell,
        grid.kernel().name(),
        grid.store().name(),
        grid.stored_samples(),
    )?;
    match deviation {
        Some(deviation) => {
            let within = promise.deviation.map_or(0.0, |deviation| deviation.within);
            writeln!(
                out,
                "  values   up to {within:.3e} m in size: off the scene's by at most {deviation:.3e} m, proven"
            )?;
            if is_exact {
                writeln!(out, "  surface  at most {deviation:.3e} m from the scene's")?;
            } else {
                writeln!(
                    out,
                    "  surface  may be farther off: the scene's values are bounds of the distance"
                )?;
            }
        }
        None => writeln!(
            out,
            "  values   off the scene's by an unknown amount: take smaller cells, or a wider --band"
        )?,
    }
    writeln!(out, "  slope    at most {:.4}", promise.lipschitz)?;
    Ok(())
}
