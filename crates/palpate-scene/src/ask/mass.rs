// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Volume, mass and moments of the bodies of a scene.

use std::fmt;
use std::sync::atomic::AtomicBool;

use palpate_field::{Mass, MassLimits, Point};
use serde::{Deserialize, Serialize};

use super::{AskError, is_set};
use crate::build::{BuiltBody, BuiltScene};
use crate::emptiness::is_empty;
use crate::text::{counted, measured, shown};

/// The density of water [kg/m³].
const WATER: f64 = 1000.0;

/// What are the masses of the bodies?
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MassQuestion {
    /// The bodies that are asked about; all if there are none.
    pub bodies: Vec<String>,
    /// The density of all bodies [kg/m³].
    pub density: f64,
    /// The relative error of a volume at which its search stops.
    pub tolerance: f64,
    /// The most cells that are looked at for each body.
    pub cells: usize,
}

impl Default for MassQuestion {
    /// Water; the limits of [`MassLimits::default`].
    fn default() -> Self {
        let MassLimits { tolerance, cells } = MassLimits::default();
        Self { bodies: Vec::new(), density: WATER, tolerance, cells }
    }
}

/// Volume, mass and moments of each body.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MassAnswer<const D: usize> {
    /// The density of all bodies [kg/m³].
    pub density: f64,
    /// The relative error of a volume that was asked for.
    pub tolerance: f64,
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BodyMass<D>>,
    /// Whether no body is missing; `false` if the search was stopped.
    pub is_whole: bool,
}

/// The mass of a body, or why it has none.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct BodyMass<const D: usize> {
    /// The name of the body.
    pub name: String,
    /// Why the body has no mass, such as a body without bounds. If it is set, no other key
    /// except `name` is present.
    pub problem: Option<String>,
    /// Its mass.
    #[serde(flatten)]
    pub weighed: Option<Weighed<D>>,
}

/// A mass with its errors. In the plane a body is one metre thick.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Weighed<const D: usize> {
    /// The volume [m³]; in the plane the area [m²].
    pub volume: f64,
    /// The largest error of the volume.
    pub volume_error: f64,
    /// The mass [kg]; in the plane the mass of a body 1 m thick.
    pub mass: f64,
    /// The largest error of the mass.
    pub mass_error: f64,
    /// `true`: proven to have no point. `false`: it has points, as its volume shows or one that was
    /// found. `None`: neither.
    pub empty: Option<bool>,
    /// Whether points with negative values may exist: curves and sheets have none.
    pub has_interior: bool,
    /// The centre of mass [m]; `None` of a body without volume.
    pub centroid: Option<Point<D>>,
    /// The largest error of each of its coordinates [m].
    pub centroid_error: f64,
    /// `∫ ρ (p − c)(p − c)ᵀ` about the centroid `c` [kg·m²].
    #[serde(serialize_with = "rows")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub second_moments: [[f64; D]; D],
    /// The largest error of each second moment [kg·m²].
    pub second_moments_error: f64,
    /// The cells that were looked at; none of a polyhedron, whose faces tell.
    pub cells: usize,
    /// Whether the error of the volume is above the tolerance.
    pub open: bool,
}

/// Serde has arrays of a generic length only as slices.
fn rows<S: serde::Serializer, const D: usize>(
    matrix: &[[f64; D]; D],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(matrix.iter().map(|row| row.as_slice()))
}

impl MassQuestion {
    pub(super) fn answer<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        stop: &AtomicBool,
    ) -> Result<MassAnswer<D>, AskError> {
        let mut asked = scene.numbers_of(&self.bodies)?;
        if asked.is_empty() {
            asked = (0..scene.bodies.len()).collect();
        }
        let unless_stopped = asked.iter().take_while(|_| !is_set(stop));
        let bodies: Vec<_> =
            unless_stopped.map(|body| self.weigh(&scene.bodies[*body])).collect();
        Ok(MassAnswer {
            density: self.density,
            tolerance: self.tolerance,
            is_whole: bodies.len() == asked.len(),
            bodies,
        })
    }

    fn weigh<const D: usize>(&self, body: &BuiltBody<D>) -> BodyMass<D> {
        let limits = MassLimits { tolerance: self.tolerance, cells: self.cells };
        let found = body.shape.mass(self.density, limits);
        let (problem, weighed) = match found {
            Ok(mass) => (None, Some(self.weighed(body, &mass))),
            Err(error) => (Some(error.to_string()), None),
        };
        BodyMass { name: body.name.clone(), problem, weighed }
    }

    fn weighed<const D: usize>(&self, body: &BuiltBody<D>, mass: &Mass<D>) -> Weighed<D> {
        let open = mass.volume_error > self.tolerance * mass.volume;
        let has_interior = body.shape.promise().has_interior;
        let empty = match (mass.is_zero(), open) {
            (true, _) => Some(has_interior),
            (false, true) => is_empty(&body.shape),
            (false, false) => Some(false),
        };
        Weighed {
            volume: mass.volume,
            volume_error: mass.volume_error,
            mass: mass.mass(),
            mass_error: mass.mass_error(),
            empty,
            has_interior,
            centroid: (!mass.is_zero()).then_some(mass.centroid),
            centroid_error: mass.centroid_error,
            second_moments: mass.second_moments,
            second_moments_error: mass.second_moments_error,
            cells: mass.cells,
            open,
        }
    }
}

impl<const D: usize> fmt::Display for MassAnswer<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for BodyMass { name, problem, weighed } in &self.bodies {
            let name = shown(name);
            if let Some(problem) = problem {
                writeln!(f, "{name}: {problem}")?;
            }
            if let Some(weighed) = weighed {
                let by = match weighed.cells {
                    0 if weighed.centroid.is_some() => "its faces".to_owned(),
                    cells => counted(cells, "cell", "cells"),
                };
                writeln!(f, "{name}, at {} kg/m³ ({by})", self.density)?;
                weighed.write(f, self.tolerance)?;
            }
        }
        Ok(())
    }
}

impl<const D: usize> Weighed<D> {
    fn write(&self, f: &mut fmt::Formatter<'_>, tolerance: f64) -> fmt::Result {
        let [volume, mass, moment] =
            if D == 2 { ["m²", "kg/m", "kg·m"] } else { ["m³", "kg", "kg·m²"] };
        let Some(centroid) = self.centroid else {
            let why = if self.has_interior {
                "empty: no point is in it, its volume is proven to be 0"
            } else {
                "no inside: curves and sheets have a volume of 0"
            };
            return writeln!(f, "  {why} {volume}");
        };
        if self.open {
            if self.empty.is_none() {
                writeln!(f, "  may be empty: no point was found in it")?;
            }
            let (cells, share) = (self.cells, self.volume_error / self.volume);
            writeln!(
                f,
                "  open: after {cells} cells the error is {share:.1e} of the volume, and the \
                 tolerance is {tolerance}; allow more cells"
            )?;
        }
        let error = self.volume_error;
        write_row(f, "volume", &measured(self.volume, error), error, volume)?;
        let error = self.mass_error;
        write_row(f, "mass", &measured(self.mass, error), error, mass)?;
        let error = self.centroid_error;
        write_row(f, "centroid", &list(&centroid.0, error), error, "m")?;
        for (i, moments) in self.second_moments.iter().enumerate() {
            let what = if i == 0 { "second moments" } else { "" };
            let error = self.second_moments_error;
            write_row(f, what, &list(moments, error), error, moment)?;
        }
        Ok(())
    }
}

fn write_row(
    f: &mut fmt::Formatter<'_>,
    what: &str,
    value: &str,
    error: f64,
    unit: &str,
) -> fmt::Result {
    writeln!(f, "  {what:<15}{value} ± {error:.1e} {unit}")
}

fn list(values: &[f64], error: f64) -> String {
    let values: Vec<_> = values.iter().map(|x| measured(*x, error)).collect();
    format!("[{}]", values.join(", "))
}
