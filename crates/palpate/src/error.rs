// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One error for programs that use several crates of palpate.

use std::io;

use palpate_device::{DeviceError, DeviceLost, NumberError};
use palpate_field::{ShapeError, UnknownName};
use palpate_grid::GridError;
#[cfg(feature = "grid-files")]
use palpate_grid::{GridFileError, GridFileProblem, VolumeError, VolumeProblem};
use palpate_haptics::HapticsError;
#[cfg(feature = "mesh-files")]
use palpate_mesh::ReadProblem;
use palpate_mesh::{ContourError, MeshError, SolidError};
use palpate_query::QueryError;
use palpate_safety::SafetyError;
#[cfg(feature = "scene")]
use palpate_scene::SceneCause;
use palpate_sim::SimulationError;

/// What went wrong in any crate of palpate.
///
/// Each error of those crates becomes one by `?`, with the same text. What an error knows is there
/// as data: its [`kind`](Self::kind), the [`parameter`](Self::parameter) with the
/// [`rule`](Self::rule) it breaks and its [`value`](Self::value); in a scene file the
/// [`path`](Self::path), [`line`](Self::line) and [`column`](Self::column). Of a scene with several
/// problems these are of the first one; [`Error::Scene`] holds them all.
///
/// ```
/// use palpate::{Error, ErrorKind};
/// use palpate::field::Shape;
///
/// let error: Error = Shape::<3>::ball(-1.0).unwrap_err().into();
/// assert_eq!(error.to_string(), "radius must be positive, got -1 m");
/// assert_eq!((error.kind(), error.parameter()), (ErrorKind::Shape, Some("radius")));
/// assert_eq!((error.value(), error.unit()), (Some(-1.0), Some("m")));
/// assert_eq!((error.kind().name(), error.rule()), ("shape", Some("positive")));
/// ```
///
/// ```
/// use palpate::Error;
/// use palpate::sim::Hand;
///
/// let hand = Hand::resting([0.0, 0.1, 0.0]).and_then(|hand| hand.with_mass(-0.1));
/// let error = Error::from(hand.unwrap_err());
/// assert_eq!((error.kind().name(), error.parameter()), ("device", Some("mass")));
/// assert_eq!((error.value(), error.unit()), (Some(-0.1), Some("kg")));
/// ```
///
/// What a scene file holds is refused with the same data, and its place:
///
/// ```
/// # #[cfg(feature = "scene")] {
/// use palpate::Error;
/// use palpate::scene::Scene;
///
/// let text = r#"{ "palpate": 1, "dimension": 3,
///   "bodies": [ { "name": "ball", "shape": { "ball": { "radius": -0.02 } } } ] }"#;
/// let error = Error::from(Scene::from_json(text).unwrap_err());
/// assert_eq!((error.parameter(), error.value()), (Some("radius"), Some(-0.02)));
/// assert_eq!((error.line(), error.path()), (Some(2), Some("bodies[0].shape.ball.radius")));
/// assert_eq!(Error::from(Scene::from_file("no such file").unwrap_err()).kind().name(), "file");
/// # }
/// ```
///
/// ```
/// # #[cfg(feature = "grid-files")] {
/// use palpate::Error;
/// use palpate::grid::Volume;
///
/// let error = Error::from(Volume::open("head.nii").unwrap_err());
/// assert_eq!((error.kind().name(), error.io_kind()), ("file", Some(std::io::ErrorKind::NotFound)));
/// # }
/// ```
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
#[non_exhaustive]
pub enum Error {
    /// A shape cannot be built.
    Shape(#[from] ShapeError),
    /// A question cannot be asked.
    Query(#[from] QueryError),
    /// Something cannot be touched as asked.
    Haptics(#[from] HapticsError),
    /// A device cannot be made.
    Device(#[from] DeviceError),
    /// A hand path, a hand or a simulated device cannot be made.
    Simulation(#[from] SimulationError),
    /// Vertices and faces are no mesh.
    Mesh(#[from] MeshError),
    /// A mesh bounds no solid.
    Solid(#[from] SolidError),
    /// A shape has no mesh.
    Contour(#[from] ContourError),
    /// A grid cannot be made.
    Grid(#[from] GridError),
    /// A file cannot be read, or holds no mesh.
    #[cfg(feature = "mesh-files")]
    MeshFile(#[from] palpate_mesh::ReadError),
    /// A file cannot be read, or holds no grid.
    #[cfg(feature = "grid-files")]
    GridFile(#[from] GridFileError),
    /// A file cannot be read, or holds no volume.
    #[cfg(feature = "grid-files")]
    VolumeFile(#[from] VolumeError),
    /// Samples make no volume, or it has no surface where it was asked for.
    #[cfg(feature = "grid-files")]
    Volume(#[from] VolumeProblem),
    /// A scene cannot be read or built.
    #[cfg(feature = "scene")]
    Scene(#[from] palpate_scene::SceneError),
    /// A picture cannot be drawn.
    #[cfg(feature = "plot")]
    Plot(#[from] palpate_plot::PlotError),
    /// A picture cannot be rendered.
    #[cfg(feature = "render")]
    Render(#[from] palpate_render::RenderError),
    /// There is no device, material, actuator or local search of that name.
    UnknownName(#[from] UnknownName),
    /// A device no longer answers.
    DeviceLost(#[from] DeviceLost),
    /// A thread for a servo did not start.
    #[cfg(feature = "std-loop")]
    Start(palpate_haptics::servo_loop::StartError),
    /// A run of a servo did not end as asked.
    #[cfg(feature = "std-loop")]
    Run(#[from] palpate_haptics::servo_loop::RunError),
    /// Numbers are no barycentric weights.
    #[cfg(feature = "local")]
    Weights(#[from] palpate_local::WeightsError),
    /// A file cannot be read or written.
    File(#[from] io::Error),
}

/// What an [`Error`] is about: a name for each of its variants, without their data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A shape cannot be built.
    Shape,
    /// A question cannot be asked.
    Query,
    /// Something cannot be touched as asked.
    Haptics,
    /// A hand path, a hand or a device cannot be made.
    Device,
    /// Vertices and faces are no mesh or bound no solid, a shape has no mesh, or a file holds no mesh.
    Mesh,
    /// A grid or a volume cannot be made, or a file holds none.
    Grid,
    /// A scene cannot be read or built.
    Scene,
    /// A picture cannot be drawn.
    Plot,
    /// There is no device, material, actuator or local search of that name.
    UnknownName,
    /// A device no longer answers.
    DeviceLost,
    /// A thread for a servo did not start.
    Thread,
    /// The loop of a servo panicked, which is a defect.
    Panicked,
    /// A file cannot be read or written.
    File,
}

impl ErrorKind {
    /// A name that stays the same, for programs and other languages: "shape", "device_lost".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shape => "shape",
            Self::Query => "query",
            Self::Haptics => "haptics",
            Self::Device => "device",
            Self::Mesh => "mesh",
            Self::Grid => "grid",
            Self::Scene => "scene",
            Self::Plot => "plot",
            Self::UnknownName => "unknown_name",
            Self::DeviceLost => "device_lost",
            Self::Thread => "thread",
            Self::Panicked => "panicked",
            Self::File => "file",
        }
    }
}

impl Error {
    /// What the error is about.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Shape(_) => ErrorKind::Shape,
            Self::Query(_) => ErrorKind::Query,
            Self::Haptics(_) => ErrorKind::Haptics,
            Self::Device(_) | Self::Simulation(_) => ErrorKind::Device,
            Self::Mesh(_) | Self::Solid(_) | Self::Contour(_) => ErrorKind::Mesh,
            Self::Grid(_) => ErrorKind::Grid,
            #[cfg(feature = "mesh-files")]
            Self::MeshFile(error) => match error.problem {
                ReadProblem::Unreadable(_) => ErrorKind::File,
                _ => ErrorKind::Mesh,
            },
            #[cfg(feature = "grid-files")]
            Self::GridFile(error) => match error.problem {
                GridFileProblem::System(_) => ErrorKind::File,
                _ => ErrorKind::Grid,
            },
            #[cfg(feature = "grid-files")]
            Self::VolumeFile(error) => match error.problem {
                VolumeProblem::Unreadable(_) => ErrorKind::File,
                _ => ErrorKind::Grid,
            },
            #[cfg(feature = "grid-files")]
            Self::Volume(_) => ErrorKind::Grid,
            #[cfg(feature = "scene")]
            Self::Scene(error) => match error.first().cause.as_deref() {
                Some(SceneCause::File(_)) => ErrorKind::File,
                _ => ErrorKind::Scene,
            },
            #[cfg(feature = "plot")]
            Self::Plot(_) => ErrorKind::Plot,
            #[cfg(feature = "render")]
            Self::Render(_) => ErrorKind::Plot,
            Self::UnknownName(_) => ErrorKind::UnknownName,
            Self::DeviceLost(_) => ErrorKind::DeviceLost,
            #[cfg(feature = "std-loop")]
            Self::Start(_) => ErrorKind::Thread,
            #[cfg(feature = "std-loop")]
            Self::Run(palpate_haptics::servo_loop::RunError::DeviceLost(_)) => {
                ErrorKind::DeviceLost
            }
            #[cfg(feature = "std-loop")]
            Self::Run(_) => ErrorKind::Panicked,
            #[cfg(feature = "local")]
            Self::Weights(_) => ErrorKind::Query,
            Self::File(_) => ErrorKind::File,
        }
    }

    /// Why the system could not read or write a file; `None` of other errors.
    ///
    /// ```
    /// use std::io;
    ///
    /// # #[cfg(feature = "scene")] {
    /// let error = palpate::Error::from(palpate::scene::Scene::from_file("none").unwrap_err());
    /// assert_eq!(error.io_kind(), Some(io::ErrorKind::NotFound));
    /// # }
    /// let full = io::Error::from(io::ErrorKind::StorageFull);
    /// assert_eq!(palpate::Error::from(full).io_kind(), Some(io::ErrorKind::StorageFull));
    /// ```
    #[must_use]
    pub fn io_kind(&self) -> Option<io::ErrorKind> {
        match self {
            #[cfg(feature = "mesh-files")]
            Self::MeshFile(palpate_mesh::ReadError {
                problem: ReadProblem::Unreadable(error),
                ..
            }) => Some(error.kind()),
            #[cfg(feature = "grid-files")]
            Self::GridFile(GridFileError {
                problem: GridFileProblem::System(error), ..
            })
            | Self::VolumeFile(VolumeError {
                problem: VolumeProblem::Unreadable(error), ..
            }) => Some(error.kind()),
            #[cfg(feature = "scene")]
            Self::Scene(error) => match error.first().cause.as_deref() {
                Some(SceneCause::File(kind)) => Some(*kind),
                _ => None,
            },
            Self::File(error) => Some(error.kind()),
            _ => None,
        }
    }

    /// The name of the parameter that is wrong, as in scene files.
    #[must_use]
    pub fn parameter(&self) -> Option<&str> {
        match self.shape_error() {
            Some(
                ShapeError::Number { parameter, .. } | ShapeError::Count { parameter, .. },
            ) => Some(parameter),
            _ => match self {
                _ if self.number().is_some() => self.number().map(|error| error.parameter),
                Self::Haptics(HapticsError::Safety(SafetyError::OtherDevice {
                    limit, ..
                })) => Some(limit),
                Self::Query(
                    QueryError::Coordinate { what, .. } | QueryError::Setting { what, .. },
                ) => Some(what),
                _ => None,
            },
        }
    }

    /// What the parameter must be: "positive".
    #[must_use]
    pub fn rule(&self) -> Option<&str> {
        match self.shape_error() {
            Some(ShapeError::Number { rule, .. } | ShapeError::Count { rule, .. }) => {
                Some(rule)
            }
            _ => self.number().map(|error| error.rule),
        }
    }

    /// The number that is wrong, in its [unit](Self::unit).
    #[must_use]
    pub fn value(&self) -> Option<f64> {
        match self.shape_error() {
            Some(ShapeError::Number { value, .. }) => Some(value.0),
            Some(ShapeError::Count { count, .. }) => Some(*count as f64),
            _ => match self {
                _ if self.number().is_some() => self.number().map(|error| error.value),
                Self::Haptics(HapticsError::Safety(SafetyError::OtherDevice {
                    device,
                    ..
                })) => Some(*device),
                Self::Query(
                    QueryError::Coordinate { value, .. }
                    | QueryError::Setting { value, .. }
                    | QueryError::Length { value },
                ) => Some(*value),
                _ => None,
            },
        }
    }

    /// The unit of the [value](Self::value): "m", "N/m"; empty for a plain number.
    #[must_use]
    pub fn unit(&self) -> Option<&'static str> {
        match self.shape_error() {
            Some(ShapeError::Number { value, .. }) => Some(value.1.symbol()),
            Some(ShapeError::Count { .. }) => Some(""),
            _ => match self {
                _ if self.number().is_some() => self.number().map(|error| error.unit),
                Self::Haptics(HapticsError::Safety(SafetyError::OtherDevice {
                    unit, ..
                })) => Some(unit),
                Self::Query(
                    QueryError::Coordinate { .. }
                    | QueryError::Setting { .. }
                    | QueryError::Length { .. },
                ) => Some("m"),
                _ => None,
            },
        }
    }

    /// Where in a scene: keys joined by dots, places in lists in brackets.
    #[must_use]
    pub fn path(&self) -> Option<&str> {
        match self {
            #[cfg(feature = "scene")]
            Self::Scene(error) if !error.first().path.is_empty() => Some(&error.first().path),
            _ => None,
        }
    }

    /// The line of a scene file, from 1.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        match self {
            #[cfg(feature = "scene")]
            Self::Scene(error) if error.first().line > 0 => Some(error.first().line),
            _ => None,
        }
    }

    /// The column in that line, from 1.
    #[must_use]
    pub fn column(&self) -> Option<usize> {
        match self {
            #[cfg(feature = "scene")]
            Self::Scene(error) if error.first().column > 0 => Some(error.first().column),
            _ => None,
        }
    }

    fn number(&self) -> Option<&NumberError> {
        match self {
            Self::Haptics(HapticsError::Number(error))
            | Self::Device(DeviceError::Number(error))
            | Self::Simulation(SimulationError::Number(error)) => Some(error),
            _ => None,
        }
    }

    fn shape_error(&self) -> Option<&ShapeError> {
        match self {
            Self::Shape(error) | Self::Haptics(HapticsError::Shape(error)) => Some(error),
            #[cfg(feature = "scene")]
            Self::Scene(error) => match error.first().cause.as_deref() {
                Some(SceneCause::Shape(error)) => Some(error),
                _ => None,
            },
            _ => None,
        }
    }
}

impl From<SafetyError> for Error {
    fn from(error: SafetyError) -> Self {
        Self::Haptics(error.into())
    }
}

#[cfg(feature = "std-loop")]
impl From<palpate_haptics::servo_loop::StartError> for Error {
    fn from(error: palpate_haptics::servo_loop::StartError) -> Self {
        match error {
            palpate_haptics::servo_loop::StartError::Haptics(error) => Self::Haptics(error),
            error => Self::Start(error),
        }
    }
}

impl From<NumberError> for Error {
    fn from(error: NumberError) -> Self {
        Self::Haptics(error.into())
    }
}
