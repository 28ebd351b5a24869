// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rigid tools: rendered as a whole, with force and torque.
//!
//! The hand holds the device. The *virtual coupling* of Colgate, Stanley and Brown, "Issues in
//! the haptic display of tool use" (1995), a spring and a damper in all degrees of freedom,
//! connects a rigid tool to the device. The tool has no mass: in each tick it is where spring
//! and contacts balance (Wan and McNeely, "Quasi-static approximation for 6-DoF haptic
//! rendering", 2003), the pose of least spring energy that the bodies allow.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod carry;
mod carry_out;
mod closest;
mod coupling;
mod felt;
mod friction;
mod of_shape;
mod scan;
mod settle;
mod shares;
#[expect(clippy::indexing_slicing, reason = "made at set-up, never in a tick")]
mod shell;
mod spread;
mod squeezed;
mod state;
mod sweep;

use palpate_field::{Pose, Vector};

use crate::bodies::Bodies;
use crate::contact_point::LET_GO;
use crate::error::HapticsError;
use crate::event::{Event, Reaction};
use crate::nearby::{Nearby, Punctured, Yielding};
use crate::proxy::{Edited, MOST_OF_POINT};
use crate::sampler::Sampler;
use carry_out::Covering;
pub(crate) use coupling::Borne;
use coupling::Twist;
pub use coupling::{Coupling, HeldTool};
use felt::{Before, Felt};
use scan::{FixedList, Scan, Surroundings};
use settle::{Ends, Lengths, RestSearch};
pub use shell::{MOST_POINTS, Shell, ShellPoint};
pub use state::{Handle, ToolOptions, ToolState, ToolTouch};

/// Fewer bodies than this all count as near: selecting would cost more than it saves.
const FEW: usize = 5;

/// The largest motion of the tool in a tick, in device motions: so large that the horizon never
/// constrains it.
const WAYS: f64 = 4.0;

/// The expected motion of the tool's points in a tick, in device motions. A tool that would
/// move farther is stopped there, and evaluates a larger neighbourhood in its next iteration.
const LIKELY: f64 = 1.0;

/// The least expected motion, in skins, for a tool that still moves while the device rests.
const LIKELY_SKINS: f64 = 0.25;

/// A tool outside the bodies rests when its next motion is below this part of the device's motion
/// in this tick. The next tick corrects the remainder, which is zero when the hand rests.
const AT_REST: f64 = 1e-3;

/// The skin of points without a radius, as a part of the tool's reach. A larger skin speeds up
/// slides, but the tool crosses walls thinner than two skins.
const SKIN: f64 = 1e-3;

/// The most events of a tool in a tick: a leave and a touch, or a slip or stick; what an edit did; and
/// a squeeze.
const MOST_EVENTS: usize = 4;

/// A rigid tool that is coupled to the hand and stopped by bodies: a god-object with six
/// degrees of freedom.
///
/// The tool's pose `X` is the one closest to the device's pose `Y` that keeps every point of its
/// [`Shell`] outside the bodies: the least of the coupling's energy
///
/// ```text
/// E = K/2 ‖v‖² + κ/2 ‖ω‖²
/// ```
///
/// with the displacement `v` between the origins [m], the rotation vector `ω` between the axes
/// [rad], and the stiffness `K` [N/m] and `κ` [N·m/rad] of the coupling. Spring and damper give
/// the force on the hand and the torque about the tool's origin,
///
/// ```text
/// F = −K v − B (u_device − u_tool)        τ = −κ ω − β (Ω_device − Ω_tool)
/// ```
///
/// with the velocities `u` [m/s] and `Ω` [rad/s] of the device as read, and those of the tool
/// from its last two poses. The damper acts only in contact and never pulls the hand in.
///
/// # How materials are rendered
///
/// The rest pose does not depend on the stiffness of the bodies: tool and bodies meet as rigid
/// bodies, and the coupling is stretched. The force does depend on it. With the depth `d =
/// √(‖v‖² + (κ/K) ‖ω‖²)`, the distance from the device's pose to the nearest free pose, a body
/// scales the coupling's force and torque, damper included, by
///
/// ```text
/// s(d) = ∫₀ᵈ min(K, K_body) / (K d)
/// ```
///
/// with the stiffness `K_body` of its layer at each depth: a body softer than the coupling
/// feels as it does to a contact point, a harder one as stiff as the coupling. The force of one
/// body without friction therefore has a potential; several bodies are weighted by how much
/// each pushes, and where level ones meet, their stiffness blends. The damping and the viscosity of a layer act at each contact, with the same
/// weight, on the device's velocity relative to the body; friction holds the tool back.
///
/// A tool does not render: pop-through, because a layer would have to give way under a part of
/// the tool only; magnets, because their pull acts at a point; textures of kind *height* and
/// ringing, because they belong to a single contact, and a tool's contacts change from point to
/// point. Textures of kind *displacement* are part of a body's shape and are rendered.
///
/// # What is promised
///
/// - *No surface is crossed.* At any speed, no point of the evaluated shell dips deeper than
///   its radius, or, without a radius, than 1e-3 of the tool's reach. At rest every evaluated
///   ball is outside up to 1e-9 of the size of the scene.
/// - *The tool may lag.* A tick takes at most six iterations, and stops when the tool is outside
///   and its next motion is below a thousandth of the device's; the next tick continues from there.
/// - *With too small a budget the tool gets coarser.* The tick evaluates fewer levels of the
///   shell, and reports this: [`ToolTouch::points_known`], [`ToolTouch::resolution`],
///   [`ToolTouch::is_degraded`].
///
/// A moving body carries a tool that rests on it until another body is in the way. The motion
/// of a body that hits the tool is not swept: the body pushes the tool out from its pose after
/// the tick. So a body should move less in a tick than half its thickness.
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
pub struct Tool {
    shell: Shell,
    options: ToolOptions,
    pub(crate) coupling: Coupling,
    scan: Scan,
    rest_search: RestSearch,
    /// The pose of the tool; `None` before the first tick.
    pose: Option<Pose<3>>,
    /// The rendered part of the force, in [0, 1].
    rise: f64,
    /// The part of the coupling's force that the bodies bear, in [0, 1].
    part: f64,
    /// Whether the bodies were replaced since the last tick.
    has_new_bodies: bool,
    /// Whether one of them jumped.
    has_jumped: bool,
    /// The part of the force from which it rises in this tick; `None` if no body jumped.
    pub(crate) start: Option<f64>,
    /// What new bodies did to the tool in this tick; `None` if they did not cover it.
    pub(crate) edited: Option<Edited>,
    /// Whether the tool began inside bodies, in the first tick or when it was set down, so that its
    /// force rises from zero.
    pub(crate) begins: bool,
    /// Whether it has not been outside since it began.
    is_beginning: bool,
    /// Whether a safety chain lets the force rise after a beginning or a placement, in place of
    /// [`ToolOptions::rise_time`].
    pub(crate) is_protected: bool,
    /// How far new bodies carry points without a radius [m].
    pub(crate) most_of_point: f64,
    touch: ToolTouch,
    /// The velocity of the device relative to the body that pushes hardest [m/s].
    pub(crate) hand_velocity: Vector<f64, 3>,
    /// How far the bodies that push the tool carry the hand in this tick.
    pub(crate) bodies_moved: Twist,
    /// The body that the tool rests on.
    carrier: Option<u32>,
    /// The bodies that the tool lies in, because they moved and left it no room.
    yielding: Yielding,
    /// Whether the force changes in this tick by more than 0.3 N beyond what motion explains, or
    /// bodies begin or cease to yield.
    pub(crate) hands_over: bool,
    /// By how much motion changes the force in this tick, at most [N].
    pub(crate) explained: f64,
    /// Whether bodies moved since the tool was last at the device.
    is_moved: bool,
    /// In how many ticks the tool rode on a body.
    ridden: u32,
    events: FixedList<Event>,
    tick: u64,
    /// The least radius of the shell's points [m].
    radius: f64,
}

impl Tool {
    /// A tool that starts at the device's first pose.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if a number of the options breaks its rule.
    #[inline(never)]
    pub fn new(shell: Shell, options: ToolOptions) -> Result<Self, HapticsError> {
        let coupling = Coupling::new(&options, shell.reach())?;
        options.check()?;
        let radii = shell.points().iter().map(|point| point.radius);
        Ok(Self {
            coupling,
            scan: Scan::new(&shell),
            rest_search: RestSearch::new(&shell),
            pose: None,
            rise: 1.0,
            part: 1.0,
            has_new_bodies: false,
            has_jumped: false,
            start: None,
            edited: None,
            begins: false,
            is_beginning: false,
            is_protected: false,
            most_of_point: MOST_OF_POINT,
            touch: ToolTouch::new(shell.points().len()),
            hand_velocity: Vector::ZERO,
            bodies_moved: Twist::NONE,
            carrier: None,
            yielding: Yielding::default(),
            hands_over: false,
            explained: 0.0,
            is_moved: false,
            ridden: 0,
            events: FixedList::with_capacity(MOST_EVENTS),
            tick: 0,
            radius: radii.fold(f64::INFINITY, f64::min),
            shell,
            options,
        })
    }

    /// This tool with another torque limit [N·m]; infinite for no limit.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the limit is not positive.
    pub fn with_max_torque(mut self, max_torque: f64) -> Result<Self, HapticsError> {
        self.options.max_torque = max_torque;
        self.options.check()?;
        Ok(self)
    }

    /// The shell.
    #[must_use]
    pub fn shell(&self) -> &Shell {
        &self.shell
    }

    /// The options, with the requested coupling before device limits.
    #[must_use]
    pub fn options(&self) -> &ToolOptions {
        &self.options
    }

    /// The rendered coupling, after device limits.
    #[must_use]
    pub fn coupling(&self) -> &Coupling {
        &self.coupling
    }

    /// The tool after the last tick.
    #[must_use]
    pub fn touch(&self) -> &ToolTouch {
        &self.touch
    }

    /// The events of the last tick; the tool counts as contact point 0.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Forgets the bodies, which are replaced before the next tick.
    ///
    /// If the new bodies cover the tool by at most the least radius of its points, or by 5 mm where
    /// that is less than a skin, they carry it out the shortest way in the metric of the coupling, and the touch
    /// goes on. If they cover it by more, its force rises from zero over
    /// [`ToolOptions::rise_time`]; if they push harder without covering it, from the old force.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn forget_bodies(&mut self) {
        self.lose_bodies();
        self.has_new_bodies = true;
    }

    /// Takes note that a body jumped; `is_near`: near the tool, before, on its way or after. Where
    /// it covers the tool now, the tool is placed outside. A larger force rises from the last one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn see_jump(&mut self, is_near: bool) {
        self.lose_bodies();
        self.has_new_bodies |= is_near;
        self.has_jumped |= is_near;
    }

    /// A tick of a tool that is lifted off the bodies: it is at the device, and touches nothing. The
    /// next [`step`](Self::step) places it anew, as the first one did.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub fn hover(&mut self, device: &ToolState) {
        self.events.clear();
        (self.edited, self.begins, self.is_beginning) = (None, false, false);
        (self.hands_over, self.explained) = (false, 0.0);
        self.bodies_moved = Twist::NONE;
        self.lose_bodies();
        let was = Before::of(&self.touch);
        self.touch.lose();
        self.pose = None;
        self.hand_velocity = Vector::ZERO;
        if device.is_usable() {
            (self.touch.device, self.touch.pose) = (device.pose, device.pose);
            self.hand_velocity = device.velocity;
        }
        self.tell_changes(was, 0.0);
        self.tick += 1;
    }

    /// Discards all evaluations of the bodies.
    fn lose_bodies(&mut self) {
        self.scan.forget();
        self.rest_search.forget();
        (self.carrier, self.yielding) = (None, Yielding::default());
    }

    /// One tick: moves the tool towards `device` as far as `bodies` let it, and computes force
    /// and torque on the hand. Afterwards [`Bodies::reactions`] holds force and torque on each
    /// body.
    ///
    /// A moving body pushes the tool out of its way. A tool that cannot get out of the bodies,
    /// because it starts inside or a body moved far over it, touches nothing until it is out;
    /// then its force rises over [`ToolOptions::rise_time`]. If the device's pose is not
    /// finite, the tool stays in place and touches nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does; at
    /// most [`ToolOptions::budget`] evaluations.
    #[inline(never)]
    pub fn step(&mut self, bodies: &mut Bodies, device: &ToolState) -> &ToolTouch {
        self.events.clear();
        (self.edited, self.begins, self.hands_over) = (None, false, false);
        (self.explained, self.start) = (0.0, None);
        self.bodies_moved = Twist::NONE;
        let (mut list, mut reactions) = bodies.take_scratch();
        reactions.fill(Reaction::NONE);
        if device.is_usable() {
            self.follow(bodies, &mut list, &mut reactions, device);
        } else {
            if bodies.has_moved {
                // Bodies that move in this tick make earlier evaluations invalid.
                self.lose_bodies();
            }
            let was = Before::of(&self.touch);
            self.touch.lose();
            self.hand_velocity = Vector::ZERO;
            self.tell_changes(was, 0.0);
        }
        bodies.put_back(list, reactions);
        bodies.settle();
        self.tick += 1;
        &self.touch
    }

    fn follow(
        &mut self,
        bodies: &Bodies,
        list: &mut [u32],
        reactions: &mut [Reaction],
        device: &ToolState,
    ) {
        let start = self.pose.unwrap_or(device.pose);
        let motion = Twist::between(&start, &device.pose);
        let reach = self.shell.reach();
        let nearby = if bodies.bodies().len() < FEW {
            bodies.everything()
        } else {
            let way = WAYS * motion.way(reach);
            bodies.nearby(start.translation, reach + way, list)
        };
        let is_held = self.touch.pose != self.touch.device;
        self.is_moved = nearby.has_moved() || self.is_moved && is_held;
        let held = self.bodies_moved(&nearby);
        let slid = self.slides(&nearby, &self.touch.device, &device.pose);
        let carry = self.carrier(&nearby, &start, &device.pose);
        let rides = carry.is_some() && self.rides(&nearby, &start, &motion);
        if nearby.has_moved() && !rides {
            self.scan.forget();
        }
        let moved = Twist::between(&self.touch.device, &device.pose).way(reach);
        let moved = carry.map_or(moved, |carry| moved.max(carry.way(reach)));
        let lengths = self.lengths(&nearby, &start, &motion, moved);
        self.scan.begin(&self.shell, self.options.budget);
        self.rest_search.begin(&nearby);
        let (everything, was, was_yielding) = (nearby, start, self.yielding);
        self.look_for_room(&everything, &start, lengths);
        let nearby = everything.without(self.yielding);
        let start = match carry {
            Some(carry) if rides => carry.moved(&start),
            Some(carry) => self.carried(&nearby, start, &carry, lengths),
            None => start,
        };
        let start = self.edited_start(&nearby, start, lengths);
        let surroundings = Surroundings { shell: &self.shell, nearby: &nearby };
        let is_out = self.edited == Some(Edited::Placed);
        let ends = Ends { start, goal: device.pose, is_out };
        self.rest_search.settle(&mut self.scan, surroundings, ends, lengths);
        let is_stuck = !self.rest_search.rest.is_outside && nearby.has_moved();
        let was_held = self.touch.contact;
        if is_stuck && was_held {
            self.make_room(&nearby, Ends { start: was, ..ends }, lengths);
        }
        let rest = &self.rest_search.rest;
        self.is_beginning |= self.pose.is_none();
        let is_placed = self.pose.is_none() && rest.pose != device.pose;
        if is_placed {
            // The tool was placed anew.
            self.rise = if rest.pushes.is_empty() { 1.0 } else { 0.0 };
        }
        if !rest.is_outside || self.edited == Some(Edited::Placed) {
            self.rise = 0.0;
        }
        let is_in = is_placed || !rest.is_outside || self.rise == 0.0;
        self.begins = self.is_beginning && is_in;
        self.is_beginning &= !rest.is_outside;
        let is_zero = self.begins || self.edited == Some(Edited::Placed);
        if is_zero && rest.is_outside && self.is_protected {
            self.rise = 1.0;
        }
        let before = self.pose.unwrap_or(rest.pose);
        self.pose = Some(rest.pose);
        let (felt, has_jumped) = (Felt::of(&self.touch), self.has_jumped);
        self.write_touch(&nearby, device, &before, moved);
        // Bodies that move onto the tool carry the hand from this tick on.
        let moved = held.or_else(|| self.bodies_moved(&nearby));
        self.bodies_moved = moved.filter(|_| !is_placed).unwrap_or(Twist::NONE);
        let slides = self.slides(&nearby, &felt.device, &device.pose).max(slid);
        self.explained = self.coupling.stiffness * slides;
        if !(self.touch.contact || self.touch.is_covered) {
            self.explained += if has_jumped { f64::INFINITY } else { LET_GO };
        }
        self.hands_over |= self.is_moved && !has_jumped && self.has_stepped(&felt);
        self.tell_edited(has_jumped, &felt);
        self.tell_squeezed(was_yielding);
        self.react(&nearby, reactions);
    }

    /// The pose from which a tool at `start` goes on: new bodies may carry it.
    fn edited_start(
        &mut self,
        nearby: &Nearby<'_>,
        start: Pose<3>,
        lengths: Lengths,
    ) -> Pose<3> {
        // A body that moves while others are edited pushes the tool. One that moves while another jumps
        // does so too, after the jump.
        let is_pushed = nearby.has_moved() && !self.has_jumped;
        if !self.has_new_bodies || self.pose.is_none() || is_pushed {
            return start;
        }
        match self.carry_out(nearby, &start, lengths) {
            Covering::None => start,
            Covering::Deep => {
                self.edited = Some(Edited::Placed);
                start
            }
            Covering::Carried(pose, distance) => {
                self.edited = Some(Edited::Carried { distance });
                pose
            }
        }
    }

    /// The lengths that follow from bodies, tool and motion.
    fn lengths(
        &self,
        nearby: &Nearby<'_>,
        start: &Pose<3>,
        motion: &Twist,
        moved: f64,
    ) -> Lengths {
        let reach = self.shell.reach();
        let way = motion.way(reach);
        let extent = start.translation.norm() + reach + way;
        let sampler = Sampler::new(nearby, Punctured::default(), self.radius, 0, extent);
        let unit = self.coupling.unit();
        let skin = sampler.skin().max(SKIN * reach);
        let horizon = LIKELY * moved + LIKELY_SKINS * skin;
        let tolerance = sampler.tolerance();
        let still = (AT_REST * moved).max(tolerance);
        Lengths { unit, tolerance, still, skin, horizon }
    }
}
