// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Guides as scene files have them.

use palpate_field::{Point, Vector};

use super::{Curve, Guide, GuideOptions};
use crate::error::HapticsError;

impl<const D: usize> Guide<D> {
    /// The guide that a scene describes.
    ///
    /// Not for the servo: a curve allocates.
    ///
    /// # Errors
    ///
    /// As the constructor of its kind; [`HapticsError::GuideTargets`] without exactly one target,
    /// [`HapticsError::Number`] if a vector has not `D` numbers. A scene that was built has
    /// neither.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_haptics::Guide;
    /// use palpate_scene::Scene;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "table", "shape": { "ball": { "radius": 0.5 } } } ],
    ///          "guides": [ { "plane": { "through": [0, 0.75], "normal": [0, 2] },
    ///                        "stiffness": 256 } ] }"#,
    /// )?;
    /// let mut guide = Guide::<2>::from_data(&scene.guides[0])?;
    /// let force = guide.force(Vector([0.3, 0.75390625]), Vector::ZERO); // 1/256 m above
    /// assert_eq!(force, Vector([0.0, -1.0]));
    /// # Ok(())
    /// # }
    /// ```
    pub fn from_data(data: &palpate_scene::Guide) -> Result<Self, HapticsError> {
        let options = GuideOptions {
            stiffness: data.stiffness,
            damping: data.damping,
            snap_distance: data.snap_distance.unwrap_or(f64::INFINITY),
            release_distance: data.release_distance,
            max_force: data.max_force,
        };
        let point =
            data.point.iter().map(|point| Self::to_point(vector("point", point)?, options));
        let line = data.line.iter().map(|line| {
            let through = vector("through", &line.through)?;
            Self::along_line(through, vector("direction", &line.direction)?, options)
        });
        let segment = data.segment.iter().map(|segment| {
            let from = vector("from", &segment.from)?;
            Self::along_segment(from, vector("to", &segment.to)?, options)
        });
        let plane = data.plane.iter().map(|plane| {
            let through = vector("through", &plane.through)?;
            Self::on_plane(through, vector("normal", &plane.normal)?, options)
        });
        let curve = data.curve.iter().map(|curve| {
            let points: Result<Vec<Point<D>>, _> =
                curve.points.iter().map(|point| vector("points", point)).collect();
            let points = points?;
            let curve =
                if curve.smooth { Curve::smooth(&points) } else { Curve::polyline(&points) };
            Self::along_curve(curve?, options)
        });
        let well = data
            .well
            .iter()
            .map(|well| Self::well(vector("center", &well.center)?, well.reach, options));
        let mut guides = point.chain(line).chain(segment).chain(plane).chain(curve).chain(well);
        match (guides.next(), guides.count()) {
            (Some(guide), 0) => guide,
            (guide, more) => {
                let count = usize::from(guide.is_some()) + more;
                Err(HapticsError::GuideTargets { count })
            }
        }
    }
}

fn vector<const D: usize>(
    parameter: &'static str,
    numbers: &[f64],
) -> Result<Vector<f64, D>, HapticsError> {
    let components = numbers.try_into().map_err(|_| HapticsError::Number {
        parameter,
        rule: "one number for each dimension",
        value: numbers.len() as f64,
        unit: "numbers",
    })?;
    Ok(Vector(components))
}
