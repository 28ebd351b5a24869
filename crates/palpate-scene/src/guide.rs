// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Guides of the hand in free space, as files give them.

use palpate_device::NumberError;
use palpate_field::{LARGEST_LENGTH, Point, Vector};
use palpate_haptics::{Curve, Guide, GuideOptions, HapticsError};
#[cfg(test)]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::pose::{direction, position};
use crate::problem::{Problem, Problems, SceneError, at_least, positive, positive_if};
use crate::scene::Dimension;
#[cfg(test)]
use crate::schema::VectorSchema;

/// A force that guides the hand: towards a point, a line, a plane or a curve, or into a well.
///
/// It has one of `point`, `line`, `segment`, `plane`, `curve` and `well`, in world coordinates.
///
/// ```
/// use palpate_scene::WrittenGuide;
///
/// # fn main() -> Result<(), serde_json::Error> {
/// let ruler: WrittenGuide = serde_json::from_str(
///     r#"{ "line": { "through": [0, 0.1, 0], "direction": [1, 0, 0] }, "snap_distance": 0.01 }"#,
/// )?;
/// assert_eq!((ruler.stiffness, ruler.max_force), (300.0, 2.0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, default, expecting = "an object")]
#[cfg_attr(test, schemars(rename = "Guide"))]
#[cfg_attr(test, schemars(extend("oneOf" = [
    { "required": ["point"] }, { "required": ["line"] }, { "required": ["segment"] },
    { "required": ["plane"] }, { "required": ["curve"] }, { "required": ["well"] },
])))]
#[non_exhaustive]
pub struct WrittenGuide {
    /// A note for readers of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The point that attracts the hand [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(with = "Option<VectorSchema>"))]
    pub point: Option<Vec<f64>>,
    /// The endless line that attracts the hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<GuideLine>,
    /// The segment that attracts the hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segment: Option<GuideSegment>,
    /// The plane that attracts the hand; in 2D a line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<GuidePlane>,
    /// The curve that attracts the hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curve: Option<GuideCurve>,
    /// The well that attracts a hand near its centre.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub well: Option<GuideWell>,
    /// Force for each metre off the guide [N/m]; 300 if left out.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub stiffness: f64,
    /// Force for each metre per second off the guide [N·s/m]; 1 if left out.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub damping: f64,
    /// How near the hand must come before the guide takes hold [m]; any distance if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub snap_distance: Option<f64>,
    /// How far the hand must be pulled before the guide lets go [m], at least the snap
    /// distance; that if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub release_distance: Option<f64>,
    /// The greatest force [N]; 2 if left out.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub max_force: f64,
}

impl Default for WrittenGuide {
    fn default() -> Self {
        Self {
            description: None,
            point: None,
            line: None,
            segment: None,
            plane: None,
            curve: None,
            well: None,
            stiffness: 300.0,
            damping: 1.0,
            snap_distance: None,
            release_distance: None,
            max_force: 2.0,
        }
    }
}

/// An endless line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct GuideLine {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// A point on it [m].
    #[cfg_attr(test, schemars(with = "VectorSchema"))]
    pub through: Vec<f64>,
    /// Its direction, of any length but zero.
    #[cfg_attr(test, schemars(with = "VectorSchema"))]
    pub direction: Vec<f64>,
}

/// A segment between two points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct GuideSegment {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Where it begins [m].
    #[cfg_attr(test, schemars(with = "VectorSchema"))]
    pub from: Vec<f64>,
    /// Where it ends [m].
    #[cfg_attr(test, schemars(with = "VectorSchema"))]
    pub to: Vec<f64>,
}

/// A plane; in 2D a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct GuidePlane {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// A point on it [m].
    #[cfg_attr(test, schemars(with = "VectorSchema"))]
    pub through: Vec<f64>,
    /// Its normal, of any length but zero.
    #[cfg_attr(test, schemars(with = "VectorSchema"))]
    pub normal: Vec<f64>,
}

/// A curve through points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct GuideCurve {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The points, in order [m]; each unlike the one before, at most 1025, or 65 if smooth.
    #[cfg_attr(test, schemars(with = "Vec<VectorSchema>", length(min = 2, max = 1025)))]
    pub points: Vec<Vec<f64>>,
    /// Smooth through the points (Catmull and Rom 1974) instead of straight between them.
    #[serde(default, skip_serializing_if = "crate::problem::is_default")]
    pub smooth: bool,
}

/// A pull towards a centre that rises to the greatest force and falls to nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct GuideWell {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Its centre [m].
    #[cfg_attr(test, schemars(with = "VectorSchema"))]
    pub center: Vec<f64>,
    /// How far it reaches [m]: farther than `max_force / stiffness`.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub reach: f64,
}

impl WrittenGuide {
    /// Checks the numbers, in a scene of `dimension`.
    pub(crate) fn check(&self, dimension: usize) -> Result<(), Problems> {
        let numbers = [
            positive("stiffness", self.stiffness, "N/m"),
            at_least("damping", self.damping, 0.0, "N·s/m"),
            positive_if("snap_distance", self.snap_distance, "m"),
            positive_if("release_distance", self.release_distance, "m"),
            positive("max_force", self.max_force, "N"),
        ];
        // Only numbers that are good are compared with one another.
        let numbers = Problems::all(numbers).and_then(|()| Ok(self.check_release()?));
        Problems::all([
            numbers,
            self.check_one_target().map_err(Problems::from),
            self.check_target(dimension),
        ])
    }

    /// Checks each target that is there.
    fn check_target(&self, dimension: usize) -> Result<(), Problems> {
        let point = self.point.as_ref().map_or(Ok(()), |point| position(point, dimension));
        let line = self.line.as_ref().map_or(Ok(()), |line| {
            check_straight(&line.through, "direction", &line.direction, dimension)
        });
        let plane = self.plane.as_ref().map_or(Ok(()), |plane| {
            check_straight(&plane.through, "normal", &plane.normal, dimension)
        });
        let segment = self.segment.as_ref().map_or(Ok(()), |segment| segment.check(dimension));
        let curve = self.curve.as_ref().map_or(Ok(()), |curve| curve.check(dimension));
        let well = self.well.as_ref().map_or(Ok(()), |well| self.check_well(well, dimension));
        let targets = [
            ("point", point.map_err(Problems::from)),
            ("line", line),
            ("segment", segment),
            ("plane", plane),
            ("curve", curve),
            ("well", well.map_err(Problems::from)),
        ];
        Problems::all(targets.map(|(key, target)| target.map_err(|p| p.under(key))))
    }

    fn check_release(&self) -> Result<(), Problem> {
        let Some(release) = self.release_distance else { return Ok(()) };
        let message = match self.snap_distance {
            Some(snap) if release >= snap => return Ok(()),
            Some(snap) => {
                format!("must be at least the snap distance {snap} m, got {release} m")
            }
            None => "has a meaning only beside `snap_distance`".to_owned(),
        };
        Err(Problem::about(message).under("release_distance"))
    }

    fn check_one_target(&self) -> Result<(), Problem> {
        let targets = [
            ("point", self.point.is_some()),
            ("line", self.line.is_some()),
            ("segment", self.segment.is_some()),
            ("plane", self.plane.is_some()),
            ("curve", self.curve.is_some()),
            ("well", self.well.is_some()),
        ];
        let mut given = targets.iter().filter(|(_, is_given)| *is_given);
        let message = match (given.next(), given.next()) {
            (Some(_), None) => return Ok(()),
            (Some((first, _)), Some((second, _))) => {
                format!("a guide has one target, got `{first}` and `{second}`")
            }
            (None, _) => {
                let names = targets.map(|(name, _)| format!("`{name}`")).join(", ");
                format!("a guide needs one of {names}")
            }
        };
        Err(Problem::new(message))
    }

    fn check_well(&self, well: &GuideWell, dimension: usize) -> Result<(), Problem> {
        position(&well.center, dimension).map_err(|problem| problem.under("center"))?;
        let inner = self.max_force / self.stiffness;
        // Written so that NaN is refused.
        if well.reach > inner && well.reach <= LARGEST_LENGTH {
            return Ok(());
        }
        let reach = well.reach;
        let message =
            format!("must be more than max_force / stiffness, {inner} m, got {reach} m");
        Err(Problem::about(message).under("reach"))
    }
}

/// Checks a point and a direction, which has a name of its own.
fn check_straight(
    through: &[f64],
    key: &str,
    along: &[f64],
    dimension: usize,
) -> Result<(), Problems> {
    Problems::all([
        position(through, dimension).map_err(|problem| problem.under("through")),
        direction(along, dimension).map_err(|problem| problem.under(key)),
    ])
}

impl GuideSegment {
    fn check(&self, dimension: usize) -> Result<(), Problems> {
        Problems::all([
            position(&self.from, dimension).map_err(|problem| problem.under("from")),
            position(&self.to, dimension).map_err(|problem| problem.under("to")),
        ])?;
        if differ(&self.from, &self.to) {
            return Ok(());
        }
        Err(Problem::about("must not be where the segment begins").under("to").into())
    }
}

impl GuideCurve {
    fn check(&self, dimension: usize) -> Result<(), Problems> {
        let most = if self.smooth { 65 } else { 1025 };
        let count = self.points.len();
        if !(2..=most).contains(&count) {
            let message = format!("must have 2 to {most} points, got {count}");
            return Err(Problem::about(message).under("points").into());
        }
        let points = self.points.iter().enumerate();
        let good = points.map(|(i, point)| position(point, dimension).map_err(|p| p.at(i)));
        let apart = self.points.windows(2).enumerate().map(|(i, pair)| match pair {
            [before, point] if !differ(before, point) => {
                Err(Problem::about("must not be where the point before it is").at(i + 1))
            }
            _ => Ok(()),
        });
        let checked = Problems::all(good).and_then(|()| Problems::all(apart));
        checked.map_err(|problems| problems.under("points"))
    }
}

/// `true` if `a` and `b` are different points.
fn differ(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).any(|(a, b)| (b - a).abs() >= f64::MIN_POSITIVE)
}

impl WrittenGuide {
    /// The guide with these numbers.
    ///
    /// # Errors
    ///
    /// If there is not exactly one target, a vector has not one number for each dimension, or the constructor of its
    /// kind refuses a number. A scene that was built has none of these.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_scene::{Dimension, Scene};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "table", "shape": { "ball": { "radius": 0.5 } } } ],
    ///          "guides": [ { "plane": { "through": [0, 0.75], "normal": [0, 2] },
    ///                        "stiffness": 256 } ] }"#,
    /// )?;
    /// let mut guide = scene.guides[0].guide(Dimension::Two)?;
    /// let force = guide.force(Vector([0.3, 0.75390625, 0.0]), Vector::ZERO); // 1/256 m above
    /// assert_eq!(force, Vector([0.0, -1.0, 0.0]));
    /// # Ok(())
    /// # }
    /// ```
    pub fn guide(&self, dimension: Dimension) -> Result<Guide, SceneError> {
        self.built(dimension).map_err(|problem| problem.located(None).into())
    }

    /// The guide with these numbers.
    pub(crate) fn built(&self, dimension: Dimension) -> Result<Guide, Problem> {
        let vector = |parameter, numbers: &[f64]| vector(parameter, numbers, dimension);
        let options = GuideOptions {
            stiffness: self.stiffness,
            damping: self.damping,
            snap_distance: self.snap_distance.unwrap_or(f64::INFINITY),
            max_force: self.max_force,
            ..GuideOptions::default()
        };
        let options = match self.release_distance {
            Some(distance) => GuideOptions { release_distance: Some(distance), ..options },
            None => options,
        };
        let point =
            self.point.iter().map(|point| Guide::to_point(vector("point", point)?, options));
        let line = self.line.iter().map(|line| {
            let through = vector("through", &line.through)?;
            Guide::along_line(through, vector("direction", &line.direction)?, options)
        });
        let segment = self.segment.iter().map(|segment| {
            let from = vector("from", &segment.from)?;
            Guide::along_segment(from, vector("to", &segment.to)?, options)
        });
        let plane = self.plane.iter().map(|plane| {
            let through = vector("through", &plane.through)?;
            Guide::on_plane(through, vector("normal", &plane.normal)?, options)
        });
        let curve = self.curve.iter().map(|curve| {
            let points: Result<Vec<Point<3>>, _> =
                curve.points.iter().map(|point| vector("points", point)).collect();
            let points = points?;
            let curve =
                if curve.smooth { Curve::smooth(&points) } else { Curve::polyline(&points) };
            Guide::along_curve(curve?, options)
        });
        let well = self
            .well
            .iter()
            .map(|well| Guide::well(vector("center", &well.center)?, well.reach, options));
        let mut guides = point.chain(line).chain(segment).chain(plane).chain(curve).chain(well);
        match (guides.next(), guides.count()) {
            (Some(guide), 0) => guide.map_err(|error| Problem::new(error.to_string())),
            (guide, more) => {
                let count = usize::from(guide.is_some()) + more;
                Err(Problem::new(format!("a guide needs one target, got {count}")))
            }
        }
    }
}

/// A vector of so many numbers; one of the plane has no z.
fn vector(
    parameter: &'static str,
    numbers: &[f64],
    dimension: Dimension,
) -> Result<Vector<f64, 3>, HapticsError> {
    if numbers.len() != dimension.count() {
        return Err(HapticsError::Number(NumberError::new(
            parameter,
            "one number for each dimension",
            numbers.len() as f64,
            "numbers",
        )));
    }
    Ok(Vector(std::array::from_fn(|axis| numbers.get(axis).copied().unwrap_or(0.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_guide_can_mean_is_refused() {
        let none = WrittenGuide::default();
        let error = none.guide(Dimension::Two).unwrap_err();
        assert_eq!(error.to_string(), "a guide needs one target, got 0");
        let flat = WrittenGuide { point: Some(vec![0.0; 3]), ..none };
        let error = flat.guide(Dimension::Two).unwrap_err();
        let expected = "point must be one number for each dimension, got 3 numbers";
        assert_eq!(error.to_string(), expected);
        assert!(flat.guide(Dimension::Three).is_ok());
    }
}
