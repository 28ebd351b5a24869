// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tools with a shape: felt as a whole, with force and torque.
//!
//! The hand holds the device; a spring and a damper in all degrees of freedom, the *virtual
//! coupling* of Colgate, Stanley and Brown, "Issues in the haptic display of tool use" (1995),
//! hang a rigid tool on it. The tool has no mass: in each tick it is where spring and contacts
//! are in balance (Wan and McNeely, "Quasi-static approximation for 6-DoF haptic rendering",
//! 2003), which is the pose of least spring energy that the bodies allow.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod batch;
mod carry;
mod closest;
mod coupled;
mod coupling;
mod felt;
mod friction;
mod obstacle;
mod of_shape;
mod room;
mod scan;
mod settle;
#[expect(clippy::indexing_slicing, reason = "made at set-up, never in a tick")]
mod shell;
mod spread;
mod state;
mod sweep;
mod twist;

use palpate_field::{Pose, Vector};

use crate::bodies::Bodies;
use crate::error::HapticsError;
use crate::event::{Event, Reaction};
use crate::nearby::{Nearby, Punctured};
use crate::sampler::Sampler;
pub(crate) use coupled::CoupledTool;
pub use coupled::HeldTool;
pub use coupling::Coupling;
use felt::Before;
use room::Room;
use scan::Scan;
use settle::{Lengths, Settler};
pub use shell::{MOST_POINTS, Shell, ShellPoint};
pub use state::{ToolOptions, ToolState, ToolTouch};
use twist::Twist;

/// Bodies fewer than this are all near.
const FEW: usize = 5;

/// How far the tool may go in a tick, in motions: far enough that it sees no horizon.
const WAYS: f64 = 4.0;

/// How far points of the tool are likely to go in a tick, in motions of the device: as far. A
/// tool that goes farther is cut short there, and looks farther in its next turn.
const LIKELY: f64 = 1.0;

/// And in skins, where the device rests and the tool does not yet.
const LIKELY_SKINS: f64 = 0.25;

/// The tool rests where the next motion is below this part of the device's in this tick: what is
/// left of it is made up for in the next, and none where the hand rests.
const AT_REST: f64 = 1e-3;

/// The skin of points without a radius, as a part of the tool's reach. Larger slides faster;
/// walls thinner than two skins would not hold the tool.
const SKIN: f64 = 1e-3;

/// Events of a tool in a tick at most: a leave and a touch, or a change of its hold.
const MOST_EVENTS: usize = 2;

/// A rigid tool that the hand moves, and that bodies stop.
///
/// The tool's pose `X` is the one closest to the device's pose `Y` that keeps every point of its
/// [`Shell`] outside the bodies: the least of the coupling's energy
///
/// ```text
/// E = K/2 ‖v‖² + κ/2 ‖ω‖²
/// ```
///
/// with the way `v` between the origins [m], the rotation `ω` between the axes [rad], and the
/// stiffness `K` [N/m] and `κ` [N·m/rad] of the coupling. The force on the hand and the torque
/// about the tool's origin are those of spring and damper,
///
/// ```text
/// F = −K v − B (u_device − u_tool)        τ = −κ ω − β (Ω_device − Ω_tool)
/// ```
///
/// with the velocities `u` [m/s] and `Ω` [rad/s] that the device says, and those of the tool from
/// its last two poses; this damper acts in contact alone and never makes the hand be pulled in.
///
/// # What is felt of a material
///
/// Where the tool rests does not depend on how soft the bodies are: rigid bodies meet, and the
/// coupling yields. How much it gives does. With the depth `d = √(‖v‖² + (κ/K) ‖ω‖²)`, which is
/// the distance from the device's pose to the nearest free one, a body bears of the coupling's
/// force and torque, damper and all, the part
///
/// ```text
/// s(d) = ∫₀ᵈ min(K, K_body) / (K d)
/// ```
///
/// with the stiffness `K_body` of its layer at each depth: a body that is softer than the coupling
/// is felt as a contact point feels it, a harder one as the coupling. So a tool that touches one
/// body without friction feels the force of a potential; of several, each counts as much as it
/// pushes. The damping and the viscosity of the layer act at the place of each contact, as much
/// as it pushes, on the device's velocity relative to the body; its friction holds the tool back.
///
/// Not felt are: layers that give way, which would have to give way under a part of the tool
/// alone; magnets, whose pull is that of a place and not of a surface; textures of kind *height*
/// and rings of impacts, which are those of one contact, and contacts of a tool come and go from
/// point to point. Textures of kind *displacement* are part of a body's shape.
///
/// # What is promised
///
/// - *Nothing is crossed.* However fast the tool comes, on its way no point of the shell that is
///   looked at dips deeper than its radius, or, without one, than 1e-3 of the tool's reach; at
///   rest its ball is outside up to 1e-9 of the size of the scene.
/// - *It lags, if it must.* A tick takes six turns at most, and stops where the next motion is
///   below a thousandth of the device's; the next tick goes on from there.
/// - *Out of budget it gets coarser.* A tick looks at fewer levels of the shell, and says so:
///   [`ToolTouch::points_known`], [`ToolTouch::resolution`], [`ToolTouch::is_degraded`].
///
/// A body that moves carries the tool that rests on it, as far as no other one is in the way. One
/// that meets the tool is not followed on its way: it pushes the tool out from where it is after
/// the tick. So it should move less in a tick than half of what it is thick.
///
/// # Examples
///
/// A ball pressed 2 mm into the ground:
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::HalfSpace};
/// use palpate_haptics::{Bodies, Shell, Tool, ToolOptions, ToolState};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ground = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
/// let mut bodies = Bodies::from(ground);
/// let options = ToolOptions { stiffness: 500.0, damping: 0.0, ..ToolOptions::default() };
/// let mut tool = Tool::new(Shell::ball(0.0625)?, options)?;
/// let at = |y| ToolState::at_rest(Pose::translation(Vector([0.0, y, 0.0])));
/// tool.step(&mut bodies, &at(0.1));
/// let touch = tool.step(&mut bodies, &at(0.0625 - 0.002));
///
/// assert!((touch.force - Vector([0.0, 1.0, 0.0])).norm() < 1e-9);
/// assert!((touch.pose.translation - Vector([0.0, 0.0625, 0.0])).norm() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Tool<const D: usize> {
    shell: Shell<D>,
    options: ToolOptions,
    coupling: Coupling,
    scan: Scan<D>,
    settler: Settler<D>,
    /// Where the tool is; none before the first tick.
    pose: Option<Pose<D>>,
    /// The part of the force that is given, in [0, 1].
    rise: f64,
    /// The part of the coupling's force that the bodies bear, in [0, 1].
    part: f64,
    /// The bodies are others than in the tick before.
    has_new_bodies: bool,
    touch: ToolTouch<D>,
    /// How fast the device moves relative to the body that pushes hardest [m/s].
    hand_velocity: Vector<f64, D>,
    /// The body that the tool rests on.
    carrier: Option<u32>,
    events: Room<Event>,
    tick: u64,
    /// The least radius of the shell's points [m].
    radius: f64,
}

impl<const D: usize> Tool<D> {
    /// A tool that starts where the device first is.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if a number of the options breaks its rule.
    pub fn new(shell: Shell<D>, options: ToolOptions) -> Result<Self, HapticsError> {
        let coupling = Coupling::new(&options, shell.reach())?;
        options.check()?;
        let radii = shell.points().iter().map(|point| point.radius);
        Ok(Self {
            coupling,
            scan: Scan::new(&shell),
            settler: Settler::new(shell.points().len()),
            pose: None,
            rise: 1.0,
            part: 1.0,
            has_new_bodies: false,
            touch: ToolTouch::new(shell.points().len()),
            hand_velocity: Vector::ZERO,
            carrier: None,
            events: Room::with_capacity(MOST_EVENTS),
            tick: 0,
            radius: radii.fold(f64::INFINITY, f64::min),
            shell,
            options,
        })
    }

    /// The same with another largest torque on the hand [N·m]; infinite for none.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if it is not positive.
    pub fn with_max_torque(mut self, max_torque: f64) -> Result<Self, HapticsError> {
        self.options.max_torque = max_torque;
        self.options.check()?;
        Ok(self)
    }

    /// What it touches with.
    #[must_use]
    pub fn shell(&self) -> &Shell<D> {
        &self.shell
    }

    /// How it was to hang on the hand.
    #[must_use]
    pub fn options(&self) -> &ToolOptions {
        &self.options
    }

    /// How it hangs on the hand.
    #[must_use]
    pub fn coupling(&self) -> &Coupling {
        &self.coupling
    }

    /// The tool after the last tick.
    #[must_use]
    pub fn touch(&self) -> &ToolTouch<D> {
        &self.touch
    }

    /// What happened in the last tick; the tool counts as contact point 0.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Forgets what is known of the bodies: the next tick touches other ones. A larger force of
    /// theirs rises from the one before over [`ToolOptions::rise_time`].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn forget_bodies(&mut self) {
        self.lose_bodies();
        self.has_new_bodies = true;
    }

    /// What was known of the bodies does not hold any more.
    fn lose_bodies(&mut self) {
        self.scan.forget();
        self.carrier = None;
    }

    /// One tick: moves the tool as far towards `device` as `bodies` let it, and gives the force
    /// and torque on the hand. [`Bodies::reactions`] then says what was done to each body.
    ///
    /// A body that moved pushes the tool out of its way. A tool that does not get out of the
    /// bodies, since it starts within them or one moved far over it, touches nothing until it
    /// is out; then its force rises over [`ToolOptions::rise_time`]. A device pose that is not
    /// finite moves nothing and touches nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does; at
    /// most [`ToolOptions::budget`] evaluations.
    pub fn step(&mut self, bodies: &mut Bodies<D>, device: &ToolState<D>) -> &ToolTouch<D> {
        self.events.clear();
        let (mut list, mut reactions) = bodies.take_scratch();
        reactions.fill(Reaction::NONE);
        if device.is_usable() {
            self.follow(bodies, (&mut list, &mut reactions), device);
        } else {
            if bodies.has_moved {
                // What moves meanwhile is not where it was when the hand comes back.
                self.lose_bodies();
            }
            let was = Before::of(&self.touch);
            self.touch.lose();
            self.hand_velocity = Vector::ZERO;
            self.tell_changes(was, 0.0);
        }
        bodies.put_back((list, reactions));
        bodies.settle();
        self.tick += 1;
        &self.touch
    }

    fn follow(
        &mut self,
        bodies: &Bodies<D>,
        (list, reactions): (&mut [u32], &mut [Reaction<D>]),
        device: &ToolState<D>,
    ) {
        let start = self.pose.unwrap_or(device.pose);
        let motion = Twist::between(&start, &device.pose);
        let reach = self.shell.reach();
        let nearby = if bodies.bodies().len() < FEW {
            bodies.everything()
        } else {
            let way = WAYS * motion.way(reach);
            bodies.nearby((start.translation, reach + way), list)
        };
        if nearby.has_moved() {
            self.scan.forget();
        }
        let carry = self.carrier(&nearby, &start, &device.pose);
        let moved = Twist::between(&self.touch.device, &device.pose).way(reach);
        let moved = carry.map_or(moved, |carry| moved.max(carry.way(reach)));
        let lengths = self.lengths(&nearby, &start, (&motion, moved));
        self.scan.begin(&self.shell, self.options.budget);
        let start =
            carry.map_or(start, |carry| self.carried(&nearby, (start, &carry), lengths));
        let parts = (&self.shell, &mut self.scan, &nearby);
        self.settler.settle(parts, (start, device.pose), lengths);
        let rest = &self.settler.rest;
        if self.pose.is_none() && rest.pose != device.pose {
            // It was placed.
            self.rise = if rest.pushes.is_empty() { 1.0 } else { 0.0 };
        }
        if !rest.is_outside {
            self.rise = 0.0;
        }
        let before = self.pose.unwrap_or(rest.pose);
        self.pose = Some(rest.pose);
        self.write_touch(&nearby, device, &before);
        self.react(&nearby, reactions);
    }

    /// The lengths that follow from bodies, tool and motion.
    fn lengths(
        &self,
        nearby: &Nearby<'_, D>,
        start: &Pose<D>,
        (motion, moved): (&Twist<D>, f64),
    ) -> Lengths {
        let reach = self.shell.reach();
        let way = motion.way(reach);
        let extent = start.translation.norm() + reach + way;
        let place = (nearby, Punctured::default());
        let sampler = Sampler::new(place, self.radius, 0, extent);
        let unit = self.coupling.unit();
        let skin = sampler.skin().max(SKIN * reach);
        let horizon = LIKELY * moved + LIKELY_SKINS * skin;
        let tolerance = sampler.tolerance();
        let still = (AT_REST * moved).max(tolerance);
        Lengths { unit, tolerance, still, skin, horizon }
    }
}
