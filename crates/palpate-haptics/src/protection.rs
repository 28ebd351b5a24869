// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Protection of a servo: the workspace map, what the device can render, and the safety chain
//! of every contact point.

use std::sync::Arc;

use palpate_field::{Rotation, Vector};

use crate::accepted_bodies::AcceptedBodies;
use crate::bodies::Bodies;
use crate::energy::Energy;
use crate::error::HapticsError;
use crate::tool::Coupling;
use palpate_safety::{
    Acceptance, Accepted, DeviceLimits, DeviceProfile, Impedance, PassivityReport, PerMotion,
    PointState, PortState, SafetyChain, SafetyOptions, SafetyReport, TurnState, TurningProfile,
    VelocityEstimator, WorkspaceMap, WrenchChain,
};

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
/// let device = DeviceProfile::unlimited("example").with_max_force(2.0);
/// let protection = Protection::new(device).with_passivity_control(false);
/// let servo = UnprotectedServo::new(ball, 1, ServoOptions::default())?.protected(&protection)?;
/// assert_eq!(servo.options().max_force, 2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Protection<const D: usize> {
    /// The limits and properties of the device.
    pub profile: DeviceProfile,
    /// The map between device and world coordinates.
    pub map: WorkspaceMap<D>,
    /// How bodies that the device cannot render are treated.
    pub acceptance: Acceptance,
    /// Whether the passivity controller acts; the passivity observer always runs.
    pub has_passivity_control: bool,
    /// The time over which the force rises after the start and after a proxy is placed anew
    /// [s].
    pub rise_time: f64,
}

impl<const D: usize> Protection<D> {
    /// Protection with every stage on and the identity map. Bodies that the device cannot
    /// render are made softer; forces rise within 0.1 s.
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

    /// The same protection with another map between device and world coordinates.
    #[must_use]
    pub fn with_map(self, map: WorkspaceMap<D>) -> Self {
        Self { map, ..self }
    }

    /// The same protection with another way to treat bodies that the device cannot render.
    #[must_use]
    pub fn with_acceptance(self, acceptance: Acceptance) -> Self {
        Self { acceptance, ..self }
    }

    /// The same protection with the passivity controller on or off.
    #[must_use]
    pub fn with_passivity_control(self, is_on: bool) -> Self {
        Self { has_passivity_control: is_on, ..self }
    }

    /// The same protection with another time over which the force rises [s].
    #[must_use]
    pub fn with_rise_time(self, rise_time: f64) -> Self {
        Self { rise_time, ..self }
    }

    /// The bodies as the device renders them at `rate` [Hz]: the stiffness and damping of each
    /// body are scaled by the factor that its worst layer needs.
    ///
    /// # Errors
    ///
    /// As [`Accepted::new`], or [`Accepted::strict`] with [`Acceptance::Strict`].
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

    /// Accepts everything that a servo renders: its bodies, and with a tool the requested
    /// virtual coupling. A device that gives no force takes bodies as they are.
    pub(crate) fn accepted_bodies(
        self: &Arc<Self>,
        bodies: Bodies<D>,
        requested: Option<Coupling>,
        rate: f64,
    ) -> Result<AcceptedBodies<D>, HapticsError> {
        let protection = Some(self.clone());
        if self.profile.max_force == 0.0 {
            return Ok(AcceptedBodies { protection, ..AcceptedBodies::unchanged(bodies) });
        }
        if let Some(coupling) = requested {
            let (bodies, coupling, accepted) = self.accept_tool(bodies, coupling, rate)?;
            return Ok(AcceptedBodies {
                bodies,
                coupling: Some(coupling),
                accepted,
                protection,
            });
        }
        let (bodies, accepted) = self.accept(bodies, rate)?;
        Ok(AcceptedBodies { bodies, coupling: None, accepted, protection })
    }

    /// Accepts bodies and the coupling of a tool together: the factor that the worst layer in
    /// series with the coupling needs scales all of them. If the device gives a torque, a
    /// second entry holds the accepted angular stiffness and damping.
    fn accept_tool(
        &self,
        mut bodies: Bodies<D>,
        mut coupling: Coupling,
        rate: f64,
    ) -> Result<(Bodies<D>, Coupling, Vec<Accepted>), HapticsError> {
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
            let turning = self.accept_turning(&layers(&bodies)?, &mut coupling, turning, rate);
            accepted.push(turning?);
        }
        Ok((bodies, coupling, accepted))
    }

    /// The rotational properties of a device that gives a torque.
    fn torques(&self) -> Option<&TurningProfile> {
        // Written so that NaN gives `None`.
        self.profile.turning.as_ref().filter(|turning| turning.max_torque > 0.0)
    }

    /// Scales the angular coupling to what the device can render on the stiffest layer. The
    /// device damping that remains limits the lever arms on which the bodies' dampers act.
    fn accept_turning(
        &self,
        layers: &[Impedance],
        coupling: &mut Coupling,
        turning: &TurningProfile,
        rate: f64,
    ) -> Result<Accepted, HapticsError> {
        let (mut part, mut damping) = (0.0_f64, 0.0_f64);
        for layer in layers {
            part = part.max((layer.stiffness() / coupling.stiffness).min(1.0));
            damping = damping.max(layer.damping());
        }
        let limits = DeviceLimits::about(turning);
        // A torque at the device is this multiple of the torque in the world.
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
        let limits = DeviceLimits::along(&self.profile);
        Ok(Accepted::of(impedance, scale, &limits, self.acceptance, rate)?)
    }

    /// Makes the port of one contact point.
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

    /// Makes the port between a tool and a device with rotation; `None` for other devices.
    pub(crate) fn turning(
        &self,
        bodies: &AcceptedBodies<D>,
        rate: f64,
    ) -> Result<Option<TurningPort<D>>, HapticsError> {
        let Some(turning) = &self.profile.turning else { return Ok(None) };
        let chain = if let Some((along, about)) = bodies.wrench() {
            let (along_limits, about_limits) =
                (DeviceLimits::along(&self.profile), DeviceLimits::about(turning));
            let limits = PerMotion { along: &along_limits, about: &about_limits };
            let options = self.safety_options(along.impedance);
            let accepted = PerMotion { along: along.clone(), about: about.clone() };
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

    /// The options of a safety chain for an impedance that was already accepted.
    fn safety_options(&self, impedance: Impedance) -> SafetyOptions {
        SafetyOptions::new(impedance)
            .with_scale(self.map.scale())
            .with_acceptance(Acceptance::AsItIs)
            .with_passivity_control(self.has_passivity_control)
            .with_rise_time(self.rise_time)
    }
}

/// Stiffness and damping of every layer of every body.
fn layers<const D: usize>(bodies: &Bodies<D>) -> Result<Vec<Impedance>, HapticsError> {
    bodies.bodies().iter().flat_map(|body| body.surface().impedances()).collect()
}

/// The port between one contact point and the device.
#[derive(Clone, Debug)]
pub(crate) struct Port<const D: usize> {
    chain: SafetyChain<D>,
    estimator: VelocityEstimator<D>,
    /// Whether encoder steps make it necessary to estimate the velocity.
    has_steps: bool,
}

impl<const D: usize> Port<D> {
    /// The state of the device. Its velocity is estimated from positions if the device has
    /// encoder steps, and is the device's own otherwise.
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

    /// Replaces the accepted impedance.
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

/// The rotational port between a tool and a device, beside the [`Port`] of its contact point.
#[derive(Clone, Debug)]
pub(crate) struct TurningPort<const D: usize> {
    /// The safety chain of force and torque, which replaces the chain of the [`Port`]; `None`
    /// for a device that gives no torque.
    pub(crate) chain: Option<WrenchChain<D>>,
    estimator: VelocityEstimator<3>,
    /// Whether the orientation has encoder steps.
    has_steps: bool,
    last: Option<Rotation<D>>,
    /// The sum of all rotation vectors so far [rad].
    angle: Vector<f64, 3>,
}

impl<const D: usize> TurningPort<D> {
    /// Orientation and angular velocity of the device, the latter estimated as in
    /// [`Port::state`], and the sum of all rotation vectors so far [rad].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn state(
        &mut self,
        turn: Option<TurnState<D>>,
    ) -> (Option<TurnState<D>>, Vector<f64, 3>) {
        let Some(mut turn) = turn else { return (None, self.angle) };
        let last = self.last.replace(turn.orientation).unwrap_or(turn.orientation);
        self.angle += last.turn_to(&turn.orientation);
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
