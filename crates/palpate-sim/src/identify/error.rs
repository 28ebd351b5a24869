// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Why a device cannot be identified.

use palpate_device::{DeviceLost, NumberError};

use super::DeviceAxis;

/// How far a motion is from the model's.
fn missed(misfit: f64, limit: f64) -> String {
    if misfit.is_finite() {
        format!(
            "the residual is {misfit:.3} times what encoder steps explain, {limit} at most are allowed"
        )
    } else {
        "no numbers fit it".to_owned()
    }
}

/// Why an identification ended without a result. The last force and torque written, if any, are zero.
///
/// ```
/// use palpate_sim::{DeviceAxis, IdentifyError};
///
/// let stuck = IdentifyError::Stuck { axis: DeviceAxis::Along(0), force: 0.9 };
/// assert!(stuck.to_string().starts_with("along x: the handle did not move at 0.9000 N"));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// An option or a number of the profile breaks its rule.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// The device gives no forces.
    #[error("the device {name:?} gives no forces, so nothing moves it but a hand")]
    NoForce {
        /// The device's name.
        name: String,
    },
    /// The device does not open.
    #[error("{lost}; nothing was written to the device")]
    NotOpened {
        /// The message of the transport.
        lost: DeviceLost,
    },
    /// The device no longer answers.
    #[error("{axis}: {lost}; the motors were set to zero as far as the device still takes it")]
    Lost {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The message of the transport.
        lost: DeviceLost,
    },
    /// The handle would leave the workspace.
    #[error(
        "travel must be at most the radius of the device's workspace, {radius} m, got {travel} m"
    )]
    TravelBeyondWorkspace {
        /// The travel that was asked for [m].
        travel: f64,
        /// The radius of the workspace [m].
        radius: f64,
    },
    /// A reading is NaN or infinite.
    #[error("{axis}: the reading at {time:.3} s is not a finite number; check the encoders")]
    NotFinite {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The time of the reading [s].
        time: f64,
    },
    /// A device that gives torques did not say where it points.
    #[error(
        "{axis}: the reading at {time:.3} s has no orientation, and the device gives torques"
    )]
    NoOrientation {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The time of the reading [s].
        time: f64,
    },
    /// The time of a tick is not later than that of the one before.
    #[error("{axis}: the tick after {before} s is at {time} s; times must increase")]
    TimeNotIncreasing {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The time of the tick before [s].
        before: f64,
        /// The time of the tick [s].
        time: f64,
    },
    /// A tick came so late that a force was held too long.
    #[error(
        "{axis}: a tick was {late:.3} s after the one before, 0.02 s at most are allowed while a force \
         is held; see palpate jitter"
    )]
    Late {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The time since the tick before [s].
        late: f64,
    },
    /// The device tells nothing new.
    #[error(
        "{axis}: the device was not measured for {since:.3} s: its readings are stale or not ready"
    )]
    NotMeasured {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The time since the last reading [s].
        since: f64,
    },
    /// The handle left the range of the motions.
    #[error(
        "{axis}: the handle is {moved:.3e} {unit} from its start, {limit:.3e} {unit} at most are \
         allowed: a hand moves it, it falls, or the travel is too small for its encoder steps; let go \
         of it, balance its weight, or allow more travel",
        unit = axis.length_unit()
    )]
    LeftRange {
        /// The axis along or about which the handle moved.
        axis: DeviceAxis,
        /// The distance from the start [m], or the angle [rad].
        moved: f64,
        /// The most that is allowed.
        limit: f64,
    },
    /// The handle moved faster than the motions may.
    #[error(
        "{axis}: the handle moves by {speed:.3} {unit}/s, {limit:.3} {unit}/s at most are allowed: \
         a hand moves it, its mass is far below that of other devices, or the travel is too small \
         for its encoder steps: allow more travel, with which the limit grows",
        unit = axis.length_unit()
    )]
    TooFast {
        /// The axis along or about which the handle moved.
        axis: DeviceAxis,
        /// Its speed [m/s], or angular speed [rad/s].
        speed: f64,
        /// The most that is allowed.
        limit: f64,
    },
    /// No force that is allowed moves the handle.
    #[error(
        "{axis}: the handle did not move at {force:.4} {unit}: a hand or a lock holds it, the motors \
         are off, the encoders do not count, or its friction or mass needs a larger part of the \
         force",
        unit = axis.force_unit()
    )]
    Stuck {
        /// The axis that was pushed.
        axis: DeviceAxis,
        /// The largest force [N], or torque [N·m].
        force: f64,
    },
    /// The handle does not come to rest.
    #[error(
        "{axis}: without a force the handle still moved after {time:.3} s: a hand moves it, it falls, \
         or it has no friction that could stop it"
    )]
    NeverRests {
        /// The axis that was watched.
        axis: DeviceAxis,
        /// How long it was watched [s].
        time: f64,
    },
    /// A spring pulls at the handle.
    #[error(
        "{axis}: a spring of {stiffness:.3} {unit} holds the handle: a hand, whose mass and damping \
         would be measured with the device's; let go of it",
        unit = axis.stiffness_unit()
    )]
    Held {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The stiffness of the spring [N/m], or [N·m/rad].
        stiffness: f64,
    },
    /// The handle moves otherwise than a mass with damping and friction.
    #[error(
        "{axis}: the motion is not that of a mass with damping and friction: {}: a hand moves the \
         handle, forces come late, or the handle is much lighter or heavier than its travel and \
         force suit",
        missed(*misfit, *limit)
    )]
    Misfit {
        /// The axis that was moved.
        axis: DeviceAxis,
        /// The root mean square of the misses over their standard deviations.
        misfit: f64,
        /// The most that is allowed.
        limit: f64,
    },
    /// The caller gave no further tick.
    #[error("{axis}: stopped before the end")]
    Interrupted {
        /// The axis that was moved.
        axis: DeviceAxis,
    },
}
