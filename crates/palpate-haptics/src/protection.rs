// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo behind a device: where its workspace lies, what the device can render, and the
//! safety chain of every contact point.

use palpate_field::Vector;

use crate::bodies::Bodies;
use crate::device::{DeviceProfile, PointState};
use crate::error::HapticsError;
use crate::impedance::Impedance;
use crate::recorder::Energy;
use crate::safety::{
    Acceptance, Accepted, PortState, SafetyChain, SafetyOptions, SafetyReport,
};
use crate::tool::Tool;
use crate::velocity::VelocityEstimator;
use crate::workspace::WorkspaceMap;

/// How a servo protects a device and the hand that holds it.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{
///     Bodies, Body, DeviceProfile, Protection, Servo, ServoOptions, Surface,
/// };
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let bodies = Bodies::new(vec![Body::new(ball, Surface::smooth(2000.0, 0.0)?)?])?;
/// let mut servo = Servo::new(bodies, 1, ServoOptions::default())?;
/// // 0.5 N·s/m bear 1000 N/m at 1 kHz.
/// let device = DeviceProfile { least_damping: 0.5, ..DeviceProfile::unlimited("example") };
/// let accepted = servo.protect(&Protection::new(device))?;
/// assert_eq!(accepted[0].factor, 0.5);
/// assert_eq!(servo.bodies().bodies()[0].surface().stiffness(), 1000.0);
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

    /// Likewise the bodies and a tool, together: what the worst layer through the coupling needs
    /// makes all of them softer.
    pub(crate) fn accept_tool(
        &self,
        mut bodies: Bodies<D>,
        tool: &mut Tool<D>,
        rate: f64,
    ) -> Result<(Bodies<D>, Vec<Accepted>), HapticsError> {
        let mut worst: Option<Accepted> = None;
        for impedance in bodies.bodies().iter().flat_map(|body| body.surface().impedances()) {
            let accepted = self.accepted(tool.impedance_on(impedance?)?, rate)?;
            if worst.as_ref().is_none_or(|worst| accepted.factor < worst.factor) {
                worst = Some(accepted);
            }
        }
        if let Some(worst) = worst.as_ref().filter(|worst| worst.factor < 1.0) {
            bodies.bodies_mut().iter_mut().for_each(|body| body.scale_surface(worst.factor));
            tool.soften(worst.factor);
        }
        Ok((bodies, worst.into_iter().collect()))
    }

    fn accepted(&self, impedance: Impedance, rate: f64) -> Result<Accepted, HapticsError> {
        let (profile, scale) = (&self.profile, self.map.scale());
        match self.acceptance {
            Acceptance::Scaled => Accepted::new(impedance, scale, profile, rate),
            Acceptance::Strict => Accepted::strict(impedance, scale, profile, rate),
            Acceptance::AsItIs => Accepted::as_it_is(impedance, scale, profile),
        }
    }

    /// The port of one contact point, to bodies at most as stiff as those accepted.
    pub(crate) fn port(
        &self,
        accepted: &[Accepted],
        rate: f64,
    ) -> Result<Port<D>, HapticsError> {
        let stiffest = accepted
            .iter()
            .map(|accepted| accepted.impedance)
            .max_by(|a, b| a.stiffness().total_cmp(&b.stiffness()));
        let options = SafetyOptions {
            scale: self.map.scale(),
            acceptance: Acceptance::AsItIs,
            has_passivity_control: self.has_passivity_control,
            rise_time: self.rise_time,
            ..SafetyOptions::new(stiffest.unwrap_or_default())
        };
        Ok(Port {
            chain: SafetyChain::new(&self.profile, rate, options)?,
            estimator: VelocityEstimator::new(rate, self.profile.encoder_step)?,
            has_steps: self.profile.encoder_step > 0.0,
        })
    }
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
        let seen = self.chain.passivity();
        Energy { taken: seen.energy_in, given: seen.energy_out, kept: seen.dissipated }
    }

    pub(crate) fn report(&self) -> SafetyReport {
        self.chain.report()
    }
}
