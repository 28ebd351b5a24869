// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a device accepts of bodies.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use palpate_device::{DeviceProfile, TurningProfile};
use palpate_safety::{
    Acceptance, Accepted, DeviceLimits, Impedance, Refused, Requester, SafetyError,
    SafetySettings, WorkspaceMap,
};

use crate::bodies::{Bodies, Body};
use crate::error::HapticsError;
use crate::guide::Guide;
use crate::tool::{Borne, Coupling};

/// Bodies, and the virtual coupling of a tool, with stiffness and damping that a device can
/// render.
///
/// [`Servo::accept`](crate::Servo::accept) makes them for
/// [`replace_bodies`](crate::Servo::replace_bodies) of the same servo.
#[derive(Clone, Debug)]
pub struct AcceptedBodies {
    pub(crate) bodies: Bodies,
    /// The accepted coupling of the tool; `None` if the servo renders contact points.
    pub(crate) coupling: Option<Coupling>,
    /// Contact points: one entry per body. Tool: the translational entry, then the rotational
    /// one if the device gives a torque. Empty without protection.
    pub(crate) accepted: Vec<Accepted>,
    /// The lateral stiffness of each height texture.
    pub(crate) textures: Vec<AcceptedTexture>,
    /// The protection of the servo, and of its clones, that they were accepted for; `None`
    /// without protection.
    pub(crate) protection: Option<Arc<Protection>>,
}

impl AcceptedBodies {
    /// Unchanged bodies, for a servo without protection.
    pub(crate) fn unchanged(bodies: Bodies) -> Self {
        Self {
            bodies,
            coupling: None,
            accepted: Vec::new(),
            textures: Vec::new(),
            protection: None,
        }
    }

    /// `true` if both were accepted for the same servo.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn is_for_servo_of(&self, other: &Self) -> bool {
        match (&self.protection, &other.protection) {
            (None, None) => true,
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &Bodies {
        &self.bodies
    }

    /// The stiffness and damping that the device renders, as in
    /// [`Servo::accepted`](crate::Servo::accepted).
    #[must_use]
    pub fn accepted(&self) -> &[Accepted] {
        &self.accepted
    }

    /// The height textures as the device renders them; a tool with a shape feels none.
    #[must_use]
    pub fn textures(&self) -> &[AcceptedTexture] {
        &self.textures
    }

    /// The stiffest translational entry, of bodies and of textures; `None` without protection.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn along(&self) -> Option<&Accepted> {
        if self.coupling.is_some() {
            return self.accepted.first();
        }
        let stiffness = |accepted: &Accepted| accepted.impedance.stiffness();
        let of_textures = self.textures.iter().map(|texture| &texture.lateral);
        let all = self.accepted.iter().chain(of_textures);
        all.max_by(|a, b| stiffness(a).total_cmp(&stiffness(b)))
    }

    /// The translational and the rotational entry of a tool on a device that gives a torque.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn wrench(&self) -> Option<(&Accepted, &Accepted)> {
        match (self.coupling, self.accepted.as_slice()) {
            (Some(_), [along, about]) => Some((along, about)),
            _ => None,
        }
    }
}

/// The height texture of a body as a device renders it.
///
/// Down the slopes of the waves a hand feels a lateral stiffness, of at most `F a (2π / λ)²` under
/// the device's largest force `F`, with the amplitude `a` and the wavelength `λ` of the texture. By
/// the rules of a material, a device that renders less renders lower waves.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AcceptedTexture {
    /// The place of its body among the bodies.
    pub body: usize,
    /// The lateral stiffness; its share is that of the amplitude.
    pub lateral: Accepted,
}

impl Protection {
    /// Accepts everything that a servo renders: its bodies, and with a tool the requested
    /// virtual coupling. A device that gives no force takes bodies as they are.
    #[inline(never)]
    pub(crate) fn accepted_bodies(
        self: &Arc<Self>,
        bodies: Bodies,
        requested: Option<Coupling>,
        rate: f64,
    ) -> Result<AcceptedBodies, HapticsError> {
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
                textures: Vec::new(),
                protection,
            });
        }
        let accepted = self.accept_points(bodies, rate)?;
        Ok(AcceptedBodies { protection, ..accepted })
    }

    /// Accepts bodies and the coupling of a tool together: as layers in series with the coupling.
    /// If the device gives a torque, a second entry holds the accepted angular stiffness and
    /// damping.
    fn accept_tool(
        &self,
        mut bodies: Bodies,
        mut coupling: Coupling,
        rate: f64,
    ) -> Result<(Bodies, Coupling, Vec<Accepted>), HapticsError> {
        let mut refusals = self.refusals();
        self.accept_magnets(&mut bodies, rate, &mut refusals)?;
        self.stiffen(&mut bodies, rate)?;
        if self.settings.is_strict {
            self.refuse_tool(&bodies, &coupling, rate, &mut refusals)?;
            refusals.end()?;
        }
        let all = in_series(&coupling, &layers(&bodies)?)?;
        let along = self.accepted(&all, rate, Requester::Material)?;
        let (stiffness, damping) = (along.stiffness_factor, along.damping_factor);
        bodies.bodies_mut().iter_mut().for_each(|body| body.scale_surface(stiffness, damping));
        coupling = coupling.softened(stiffness, damping);
        let mut accepted = vec![along];
        if let Some(turning) = self.torques() {
            let turning = self.accept_turning(&layers(&bodies)?, &mut coupling, turning, rate);
            accepted.push(turning?);
        }
        Ok((bodies, coupling, accepted))
    }

    /// Refuses the coupling on each body, and about axes, of which the device renders less than all.
    fn refuse_tool(
        &self,
        bodies: &Bodies,
        coupling: &Coupling,
        rate: f64,
        refusals: &mut Refusals,
    ) -> Result<(), HapticsError> {
        for (number, body) in bodies.bodies().iter().enumerate() {
            let own: Vec<_> = body.surface().impedances().collect::<Result<_, _>>()?;
            let stiffest = own.iter().map(Impedance::stiffness).fold(0.0, f64::max);
            let is_softer = coupling.stiffness < stiffest;
            let requester =
                if is_softer { Requester::Coupling(number) } else { Requester::Body(number) };
            let accepted = self.accepted(&in_series(coupling, &own)?, rate, requester)?;
            refusals.look(&accepted, requester);
        }
        if let Some(turning) = self.torques() {
            let asked = coupling.turning_on(coupling.borne(&layers(bodies)?))?;
            refusals.look(&self.turned(asked, turning, rate)?, Requester::AngularCoupling);
        }
        Ok(())
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
        let borne = coupling.borne(layers);
        if self.settings.is_strict {
            // Strict protection has refused a coupling of which less than all is rendered.
            return self.turned(coupling.turning_on(borne)?, turning, rate);
        }
        let undamped = Borne { damping: 0.0, ..borne };
        let accepted = self.turned(coupling.turning_on(undamped)?, turning, rate)?;
        let (stiffness, own_damping) = (accepted.stiffness_factor, accepted.damping_factor);
        *coupling = coupling.softened_about_axes(stiffness, own_damping);
        if self.settings.acceptance != Acceptance::AsIs {
            let taken = 0.5 * accepted.device_stiffness / rate + accepted.device_damping;
            let left = (turning.least_damping - taken)
                .min(turning.max_damping - accepted.device_damping)
                .max(0.0);
            let needed = accepted.scale * coupling.damping_on_arms(borne.damping);
            coupling.arms = if needed > left { (left / needed).sqrt() } else { 1.0 };
        }
        Ok(accepted)
    }

    /// What the device renders of a stiffness and a damping about axes.
    fn turned(
        &self,
        asked: Impedance,
        turning: &TurningProfile,
        rate: f64,
    ) -> Result<Accepted, HapticsError> {
        let limits = DeviceLimits::about(turning);
        // A torque at the device is this multiple of the torque in the world.
        let scale = 1.0 / self.map.scale();
        Ok(Accepted::of(asked, scale, &limits, self.settings.acceptance, rate)?)
    }
}

/// Stiffness and damping of every layer of every body.
fn layers(bodies: &Bodies) -> Result<Vec<Impedance>, HapticsError> {
    bodies.bodies().iter().flat_map(|body| body.surface().impedances()).collect()
}

/// The layers as the hand feels them through the coupling.
fn in_series(
    coupling: &Coupling,
    layers: &[Impedance],
) -> Result<Vec<Impedance>, HapticsError> {
    layers.iter().map(|layer| coupling.on(*layer)).collect()
}

/// How a servo protects a device and the hand that holds it.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, kernel::Ball};
/// use palpate_device::DeviceProfile;
/// use palpate_haptics::{Protection, ServoOptions, Servo};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let device = DeviceProfile { max_force: 2.0, ..DeviceProfile::unlimited("example") };
/// let protection = Protection::new(device).with(|s| s.has_passivity_control = false);
/// let servo = Servo::new(ball, 1, ServoOptions::default())?.protected(&protection)?;
/// assert_eq!(servo.options().max_force, 2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Protection {
    /// The limits and properties of the device.
    pub profile: DeviceProfile,
    /// The map between device and world coordinates.
    pub map: WorkspaceMap,
    /// How the safety chains protect.
    pub settings: SafetySettings,
}

impl Protection {
    /// Protection with the identity map and the [default settings](SafetySettings::default): every
    /// stage acts.
    #[must_use]
    pub fn new(profile: DeviceProfile) -> Self {
        Self { profile, map: WorkspaceMap::default(), settings: SafetySettings::default() }
    }

    /// This protection with changed settings.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut SafetySettings)) -> Self {
        change(&mut self.settings);
        self
    }

    /// This protection with another map between device and world coordinates.
    #[must_use]
    pub fn with_map(self, map: WorkspaceMap) -> Self {
        Self { map, ..self }
    }

    /// The bodies as the device renders them at `rate` [Hz]: all layers of a body have the share of
    /// stiffness and the share of damping that [`Accepted::of_layers`] gives, and its height texture
    /// the share of the amplitude that [`AcceptedTexture`] has.
    ///
    /// # Errors
    ///
    /// As [`Accepted::new`]; [`SafetyError::MaterialRefused`](palpate_safety::SafetyError) of strict
    /// protection, with everything that is refused.
    #[inline(never)]
    pub fn accept(
        &self,
        bodies: Bodies,
        rate: f64,
    ) -> Result<(Bodies, Vec<Accepted>), HapticsError> {
        let AcceptedBodies { bodies, accepted, .. } = self.accept_points(bodies, rate)?;
        Ok((bodies, accepted))
    }

    /// Accepts the bodies that contact points touch.
    fn accept_points(
        &self,
        mut bodies: Bodies,
        rate: f64,
    ) -> Result<AcceptedBodies, HapticsError> {
        let mut all = Vec::with_capacity(bodies.bodies().len());
        let mut refusals = self.refusals();
        self.accept_magnets(&mut bodies, rate, &mut refusals)?;
        self.stiffen(&mut bodies, rate)?;
        for (number, body) in bodies.bodies_mut().iter_mut().enumerate() {
            let layers: Vec<_> = body.surface().impedances().collect::<Result<_, _>>()?;
            let requester = Requester::Body(number);
            let accepted = self.accepted(&layers, rate, requester)?;
            refusals.look(&accepted, requester);
            body.scale_surface(accepted.stiffness_factor, accepted.damping_factor);
            all.push(accepted);
        }
        let textures = self.accept_textures(&mut bodies, rate, &mut refusals)?;
        refusals.end()?;
        Ok(AcceptedBodies { accepted: all, textures, ..AcceptedBodies::unchanged(bodies) })
    }

    /// Lowers the waves of height textures to what the device renders of their lateral stiffness.
    fn accept_textures(
        &self,
        bodies: &mut Bodies,
        rate: f64,
        refusals: &mut Refusals,
    ) -> Result<Vec<AcceptedTexture>, HapticsError> {
        let mut textures = Vec::new();
        // Without a largest force nothing limits how deep a hand presses, nor what it feels.
        if self.profile.max_force == f64::INFINITY {
            return Ok(textures);
        }
        for (number, body) in bodies.bodies_mut().iter_mut().enumerate() {
            let stiffness = body.surface().lateral_stiffness(self.profile.max_force);
            let Some(stiffness) = stiffness else { continue };
            let requester = Requester::Texture(number);
            let layer = Impedance::new(stiffness, 0.0)?;
            let lateral = self.accepted(&[layer], rate, requester)?;
            refusals.look(&lateral, requester);
            body.lower_waves(lateral.stiffness_factor);
            textures.push(AcceptedTexture { body: number, lateral });
        }
        Ok(textures)
    }

    /// The guides as the device renders them at `rate` [Hz], each by the rules of a material. A
    /// device that gives no force takes them as they are.
    ///
    /// # Errors
    ///
    /// As [`accept`](Self::accept).
    #[inline(never)]
    pub fn accept_guides(
        &self,
        guides: &[Guide],
        rate: f64,
    ) -> Result<(Vec<Guide>, Vec<Accepted>), HapticsError> {
        if self.profile.max_force == 0.0 {
            return Ok((guides.to_vec(), Vec::new()));
        }
        let mut all = (Vec::with_capacity(guides.len()), Vec::with_capacity(guides.len()));
        let mut refusals = self.refusals();
        for (number, guide) in guides.iter().enumerate() {
            let requester = Requester::Guide(number);
            let accepted = self.accepted(&[guide.impedance()?], rate, requester)?;
            refusals.look(&accepted, requester);
            let (stiffness, damping) = (accepted.stiffness_factor, accepted.damping_factor);
            all.0.push(guide.clone().softened(stiffness, damping));
            all.1.push(accepted);
        }
        refusals.end()?;
        Ok(all)
    }

    /// Softens the magnets of bodies to what the device renders, as if they were materials.
    pub(crate) fn accept_magnets(
        &self,
        bodies: &mut Bodies,
        rate: f64,
        refusals: &mut Refusals,
    ) -> Result<(), HapticsError> {
        for (number, body) in bodies.bodies_mut().iter_mut().enumerate() {
            let Some(magnet) = &body.surface().magnet else { continue };
            let impedance = Impedance::new(magnet.stiffness(), 0.0)?;
            let requester = Requester::Magnet(number);
            let accepted = self.accepted(&[impedance], rate, requester)?;
            refusals.look(&accepted, requester);
            body.scale_magnet(accepted.stiffness_factor);
        }
        Ok(())
    }

    /// Gives surfaces of a relative stiffness that which they have on the device.
    pub(crate) fn stiffen(&self, bodies: &mut Bodies, rate: f64) -> Result<(), HapticsError> {
        // Where nothing is relative, the device need not have a largest stiffness.
        let is_relative = |body: &Body| body.surface().is_relative();
        if bodies.bodies().iter().any(is_relative) {
            let most = Accepted::most_stiffness(
                &DeviceLimits::along(&self.profile),
                self.settings.acceptance,
                rate,
            )? / self.map.scale();
            bodies.bodies_mut().iter_mut().for_each(|body| body.stiffen(most));
        }
        Ok(())
    }

    /// What the device renders of layers that `requester` asks for.
    fn accepted(
        &self,
        layers: &[Impedance],
        rate: f64,
        requester: Requester,
    ) -> Result<Accepted, HapticsError> {
        let scale = self.map.scale();
        let limits = DeviceLimits::along(&self.profile);
        let accepted =
            Accepted::of_layers(layers, scale, &limits, self.settings.acceptance, rate);
        Ok(accepted.map_err(|error| match error {
            SafetyError::MaterialRefused(all) => SafetyError::MaterialRefused(
                all.into_iter().map(|refused| refused.by(requester)).collect(),
            ),
            error => error,
        })?)
    }

    /// Where strict protection collects what it refuses.
    pub(crate) fn refusals(&self) -> Refusals {
        Refusals { is_strict: self.settings.is_strict, all: Vec::new() }
    }
}

/// What strict protection refuses; nothing if it is not strict.
#[derive(Debug)]
pub(crate) struct Refusals {
    is_strict: bool,
    all: Vec<Refused>,
}

impl Refusals {
    /// Refuses what the device renders less of than `requester` asks for.
    pub(crate) fn look(&mut self, accepted: &Accepted, requester: Requester) {
        if self.is_strict {
            self.all.extend(accepted.refusal(requester));
        }
    }

    /// An error with all refusals, if there are any.
    pub(crate) fn end(self) -> Result<(), SafetyError> {
        if self.all.is_empty() { Ok(()) } else { Err(SafetyError::MaterialRefused(self.all)) }
    }
}
