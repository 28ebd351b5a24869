// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo behind a device: where its workspace lies, what the device can render, and the
//! safety chain of every contact point.

use palpate_field::{Rotation, Vector};

use crate::accepted_bodies::AcceptedBodies;
use crate::bodies::Bodies;
use crate::energy::Energy;
use crate::error::HapticsError;
use crate::tool::Coupling;
use palpate_safety::Impedance;
use palpate_safety::VelocityEstimator;
use palpate_safety::WorkspaceMap;
use palpate_safety::turn_between;
use palpate_safety::{
    Acceptance, Accepted, Limits, PassivityReport, PortState, SafetyChain, SafetyOptions,
    SafetyReport, WrenchChain,
};
use palpate_safety::{DeviceProfile, PointState, TurnState, TurningProfile};

/// How a servo protects a device and the hand that holds it.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, kernel::Ball};
/// use palpate_haptics::{DeviceProfile, Protection, ServoOptions, UnprotectedServo};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let device = DeviceProfile { max_force: 2.0, ..DeviceProfile::unlimited("example") };
/// let protection = Protection { has_passivity_control: false, ..Protection::new(device) };
/// let servo = UnprotectedServo::new(ball, 1, ServoOptions::default())?.protected(&protection)?;
/// assert_eq!(servo.options().max_force, 2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Protection<const D: usize> {
    /// The device.
    pub profile: DeviceProfile,
    /// Where its workspace lies.
    pub map: WorkspaceMap<D>,
    /// What is done with bodies that the device cannot render.
    pub acceptance: Acceptance,
    /// Whether the passivity controller acts; it observes anyway.
    pub has_passivity_control: bool,
    /// The time over which the force rises after the start and after placements [s].
    pub rise_time: f64,
}

impl<const D: usize> Protection<D> {
    /// For a device in the world as it is: all stages on, bodies scaled where they must be,
    /// forces that rise in 0.1 s.
    #[must_use]
    pub fn new(profile: DeviceProfile) -> Self {
        Self {
            profile,
            map: WorkspaceMap::default(),
            acceptance: Acceptance::Scaled,
            has_passivity_control: true,
            rise_time: 0.1,
        }
    }

    /// The bodies as the device renders them at `rate` [Hz]: stiffness and damping of each made
    /// smaller by what its worst layer needs.
    ///
    /// # Errors
    ///
    /// As [`Accepted::new`] or, where refused, [`Accepted::strict`].
    pub fn accept(
        &self,
        mut bodies: Bodies<D>,
        rate: f64,
    ) -> Result<(Bodies<D>, Vec<Accepted>), HapticsError> {
        let mut all = Vec::with_capacity(bodies.bodies().len());
        for body in bodies.bodies_mut() {
            let mut worst: Option<Accepted> = None;
            for impedance in body.surface().impedances() {
                let accepted = self.accepted(impedance?, rate)?;
                if worst.as_ref().is_none_or(|worst| accepted.factor < worst.factor) {
                    worst = Some(accepted);
                }
            }
            let Some(worst) = worst else { continue };
            if worst.factor < 1.0 {
                body.scale_surface(worst.factor);
            }
            all.push(worst);
        }
        Ok((bodies, all))
    }

    /// The same for all that a servo renders: its bodies alone, or with the coupling that is
    /// requested of its tool.
    pub(crate) fn accepted_bodies(
        &self,
        bodies: Bodies<D>,
        requested: Option<Coupling>,
        rate: f64,
    ) -> Result<AcceptedBodies<D>, HapticsError> {
        if let Some(coupling) = requested {
            return self.accept_tool(bodies, coupling, rate);
        }
        let (bodies, accepted) = self.accept(bodies, rate)?;
        Ok(AcceptedBodies { bodies, coupling: None, accepted })
    }

    /// The same for bodies and a tool together: what the worst layer through the coupling needs
    /// makes all of them softer. Where the device gives a torque, the second entry says what
    /// became of the coupling's angular stiffness and damping.
    fn accept_tool(
        &self,
        mut bodies: Bodies<D>,
        mut coupling: Coupling,
        rate: f64,
    ) -> Result<AcceptedBodies<D>, HapticsError> {
        let mut worst: Option<Accepted> = None;
        for layer in layers(&bodies)? {
            let accepted = self.accepted(coupling.on(layer)?, rate)?;
            if worst.as_ref().is_none_or(|worst| accepted.factor < worst.factor) {
                worst = Some(accepted);
            }
        }
        if let Some(worst) = worst.as_ref().filter(|worst| worst.factor < 1.0) {
            bodies.bodies_mut().iter_mut().for_each(|body| body.scale_surface(worst.factor));
            coupling = coupling.softened(worst.factor);
        }
        let mut accepted: Vec<_> = worst.into_iter().collect();
        if let Some(turning) = self.torques() {
            let turning =
                self.accept_turning(&layers(&bodies)?, &mut coupling, (turning, rate));
            accepted.push(turning?);
        }
        Ok(AcceptedBodies { bodies, coupling: Some(coupling), accepted })
    }

    /// What the device can do about its axes, if it gives a torque.
    fn torques(&self) -> Option<&TurningProfile> {
        // Written so that NaN gives none.
        self.profile.turning.as_ref().filter(|turning| turning.max_torque > 0.0)
    }

    /// Makes a tool's coupling turn as the device can, on the stiffest of the bodies' layers; what
    /// that leaves of the device's damping bears the bodies' dampers, on arms as long as it can.
    fn accept_turning(
        &self,
        layers: &[Impedance],
        coupling: &mut Coupling,
        (turning, rate): (&TurningProfile, f64),
    ) -> Result<Accepted, HapticsError> {
        let (mut part, mut damping) = (0.0_f64, 0.0_f64);
        for layer in layers {
            part = part.max((layer.stiffness() / coupling.stiffness).min(1.0));
            damping = damping.max(layer.damping());
        }
        let limits = Limits::about(turning);
        // Torques of the world are so many times those at the device.
        let scale = 1.0 / self.map.scale();
        let of =
            |impedance, acceptance| Accepted::of(impedance, scale, &limits, acceptance, rate);
        if self.acceptance == Acceptance::Strict {
            return Ok(of(coupling.turning_on(part, damping)?, Acceptance::Strict)?);
        }
        let accepted = of(coupling.turning_on(part, 0.0)?, self.acceptance)?;
        *coupling = coupling.softened_about_axes(accepted.factor);
        if self.acceptance == Acceptance::Scaled {
            let taken = 0.5 * accepted.device_stiffness / rate + accepted.device_damping;
            let left = (turning.least_damping - taken)
                .min(turning.max_damping - accepted.device_damping)
                .max(0.0);
            let needed = scale * coupling.damping_on_arms(damping);
            coupling.arms = if needed > left { (left / needed).sqrt() } else { 1.0 };
        }
        Ok(accepted)
    }

    fn accepted(&self, impedance: Impedance, rate: f64) -> Result<Accepted, HapticsError> {
        let scale = self.map.scale();
        let limits = Limits::along(&self.profile);
        Ok(Accepted::of(impedance, scale, &limits, self.acceptance, rate)?)
    }

    /// The port of one contact point.
    pub(crate) fn port(
        &self,
        bodies: &AcceptedBodies<D>,
        rate: f64,
    ) -> Result<Port<D>, HapticsError> {
        let along = bodies.along().map(|accepted| accepted.impedance);
        let options = self.safety_options(along.unwrap_or_default());
        Ok(Port {
            chain: SafetyChain::new(&self.profile, rate, options)?,
            estimator: VelocityEstimator::new(rate, self.profile.encoder_step)?,
            has_steps: self.profile.encoder_step > 0.0,
        })
    }

    /// What is between a tool and a device that turns; none of a device that does not.
    pub(crate) fn turning(
        &self,
        bodies: &AcceptedBodies<D>,
        rate: f64,
    ) -> Result<Option<TurningPort<D>>, HapticsError> {
        let Some(turning) = &self.profile.turning else { return Ok(None) };
        let chain = if let Some((along, about)) = bodies.wrench() {
            let limits = [&Limits::along(&self.profile), &Limits::about(turning)];
            let options = self.safety_options(along.impedance);
            let accepted = [along.clone(), about.clone()];
            Some(WrenchChain::new(limits, accepted, &options, rate)?)
        } else {
            None
        };
        Ok(Some(TurningPort {
            chain,
            estimator: VelocityEstimator::new(rate, turning.encoder_step)?,
            has_steps: turning.encoder_step > 0.0,
            last: None,
            angle: Vector::ZERO,
        }))
    }

    /// For what was accepted already.
    fn safety_options(&self, impedance: Impedance) -> SafetyOptions {
        SafetyOptions {
            scale: self.map.scale(),
            acceptance: Acceptance::AsItIs,
            has_passivity_control: self.has_passivity_control,
            rise_time: self.rise_time,
            ..SafetyOptions::new(impedance)
        }
    }
}

/// The layers of all bodies.
fn layers<const D: usize>(bodies: &Bodies<D>) -> Result<Vec<Impedance>, HapticsError> {
    bodies.bodies().iter().flat_map(|body| body.surface().impedances()).collect()
}

/// What is between one contact point and the device.
#[derive(Clone, Debug)]
pub(crate) struct Port<const D: usize> {
    chain: SafetyChain<D>,
    estimator: VelocityEstimator<D>,
    /// Whether the device sees its position in steps, so that its velocity is estimated.
    has_steps: bool,
}

impl<const D: usize> Port<D> {
    /// The state of the device with the best velocity that is known: the estimate, where the
    /// device sees steps, or its own.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn state(&mut self, state: PointState<D>) -> PointState<D> {
        if !self.has_steps {
            return state;
        }
        PointState { velocity: self.estimator.update(state.position), ..state }
    }

    /// The force to write [N], in device coordinates.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn write(
        &mut self,
        wanted: Vector<f64, D>,
        state: &PortState<D>,
    ) -> Vector<f64, D> {
        self.chain.step(wanted, state)
    }

    /// Renders what was accepted anew.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn renew(&mut self, accepted: &Accepted) {
        self.chain.renew(accepted);
    }

    /// Lowers the largest force [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit_force(&mut self, max_force: f64) {
        self.chain.limit_force(max_force);
    }

    /// Stops or releases the force.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn stop(&mut self, is_stopped: bool) {
        if is_stopped { self.chain.stop() } else { self.chain.release() }
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn energy(&self) -> Energy {
        energy(&self.chain.passivity())
    }

    pub(crate) fn report(&self) -> SafetyReport {
        self.chain.report()
    }
}

/// What is between a tool and a device that turns, beside the [`Port`] of its contact point.
#[derive(Clone, Debug)]
pub(crate) struct TurningPort<const D: usize> {
    /// The chain of force and torque, in place of the port's; none of a device that gives no
    /// torque.
    pub(crate) chain: Option<WrenchChain<D>>,
    estimator: VelocityEstimator<3>,
    /// Whether the device sees how it is turned in steps.
    has_steps: bool,
    last: Option<Rotation<D>>,
    /// The sum of all turns so far [rad].
    angle: Vector<f64, 3>,
}

impl<const D: usize> TurningPort<D> {
    /// How the device is turned, with the best angular velocity that is known, as
    /// [`Port::state`]; and the sum of all turns so far [rad].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn state(
        &mut self,
        turn: Option<TurnState<D>>,
    ) -> (Option<TurnState<D>>, Vector<f64, 3>) {
        let Some(mut turn) = turn else { return (None, self.angle) };
        let last = self.last.replace(turn.orientation).unwrap_or(turn.orientation);
        self.angle += turn_between(&last, &turn.orientation);
        if self.has_steps {
            turn.angular_velocity = self.estimator.update(self.angle);
        }
        (Some(turn), self.angle)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn energy(&self) -> Option<Energy> {
        self.chain.as_ref().map(|chain| energy(&chain.passivity()))
    }
}

fn energy(seen: &PassivityReport) -> Energy {
    Energy { taken: seen.energy_in, given: seen.energy_out, kept: seen.dissipated }
}
