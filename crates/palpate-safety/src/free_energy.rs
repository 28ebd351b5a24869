// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The passivity of forces that have a potential: guides, wells and magnets.
//!
//! They may pull a hand in, which gives out energy that the hand did not put in. So this stage does
//! not balance their energy, as that of walls is balanced, but the energy that sampling adds to it.

use crate::approach::Lift;
use crate::effect::Effect;
use crate::passivity::{InnerProduct, MEMORY, PassivityOptions, SLACK, SPARE, STEP};

/// The part of what damping covers that passes.
const COVERED: f64 = 0.8;

/// The part of what damping dissipates that counts while less than the whole force passes. It is
/// more than [`COVERED`], so that the balance is paid, and less than 1, so that swings decay.
const CREDITED: f64 = 0.9;

/// The shortest time in which the force of a moving hand comes back [s].
const RECOVERY: f64 = 1.0;

/// The time in which the height over the lowest place is forgotten while the whole force passes:
/// guides with damping take energy that is no height [s]. Where less passes, a slow swing may last
/// longer than that.
const FORGOTTEN: f64 = 10.0;

/// The most that the balance owes [J]. What a stall gave out at once beyond it is credited, so that walls
/// need not pay for it.
const MOST_OWED: f64 = 1e-3;

/// No hand climbs higher in a potential [J].
const HIGHEST: f64 = 1e3;

/// Energy that sampling generates in forces that have a potential (guides, magnets), and how it
/// was limited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct FreeForceReport {
    /// Ticks in which the force was made less, and the largest change.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// The least energy balance [J]. It begins at zero. It adds the energy that the device's
    /// damping dissipates, and subtracts the energy that sampling, the slew limit and the
    /// returning force generate, except `credited`.
    pub least_balance: f64,
    /// Energy that the forces may add [J]: when the force returns to a hand at rest, when it
    /// rises after it was zeroed or made softer, and what the balance would owe beyond 1 mJ.
    pub credited: f64,
}

/// The passivity observer and controller of the forces of guides and magnets.
///
/// **Observer.** A force that is held over a tick gives out `F_k · Δx`, as it was written. Meanwhile
/// the potential `U` of the wanted force rises by `−½ (F_k + F_{k+1}) · Δx`, exactly for springs
/// (trapezoidal rule), and that of a part `p` of it by `p` times as much; what the limits of the size
/// of the force leave of it is such a part, too. The sum of both is what sampling, and a slew limit,
/// generate: `−½ p ΔF · Δx` where the force was written as wanted. The device's damping `b`
/// dissipates at least `b |Δx|² / T`. The balance is what damping dissipates minus what sampling
/// generates; it starts at the reserve and never exceeds it.
///
/// **Controller.** While the balance is used up, the part that passes is at most [`COVERED`] times the
/// losses over the leaks, both summed since the balance ran out. The part falls by [`STEP`] a tick, and
/// at once when [`SPARE`] more was given out.
///
/// **Recovery.** A part that rises by `Δp` adds `Δp U` to the energy of the hand, and a swing that is
/// lifted again and again grows, also one that leaves the reach of the force each time. So the part
/// rises only where the force acts, while the balance pays for `Δp U`, with `U` above its lowest value
/// of late, and in no less than a [second](RECOVERY). A hand at rest pays nothing: the force rises as that of
/// a wall does ([`Lift`]), and so it does after it was zeroed; both are counted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeEnergy<V> {
    /// The last tick; `None` after one that was not finite.
    last: Option<Last<V>>,
    /// The largest force that the device gives [N].
    max_force: f64,
    /// The part of the force that passes.
    part: f64,
    /// What damping dissipates minus what sampling generates, at most the reserve [J].
    balance: f64,
    /// What sampling would generate with the whole force, and what damping dissipates, while the
    /// balance is used up; both decay by [`MEMORY`] [J].
    leaks: f64,
    losses: f64,
    /// The potential above its least value of late [J].
    height: f64,
    lift: Lift<V>,
    report: FreeForceReport,
}

#[derive(Clone, Copy, Debug)]
struct Last<V> {
    position: V,
    /// The whole force, as large as the device gives it [N].
    felt: V,
    /// The scale of the wanted force.
    scale: f64,
    /// The force that was written [N].
    written: V,
    /// The part of the force that the limits of its size left.
    share: f64,
}

/// What a [`FreeEnergy`] is given in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeInput<V> {
    /// The whole force of guides and magnets [N].
    pub(crate) force: V,
    /// The position of the device [m].
    pub(crate) position: V,
    /// The part of the force that is wanted: less than the whole while it rises after it was zeroed,
    /// or is made softer.
    pub(crate) scale: f64,
    /// The time since the tick before [s].
    pub(crate) elapsed: f64,
    /// Whether all inputs are finite.
    pub(crate) is_sound: bool,
}

/// What a [`FreeEnergy`] gives in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passed<V> {
    /// The force that passes.
    pub(crate) force: V,
    /// The part of what damping dissipates that it needs: walls have what is left [J].
    pub(crate) spent: f64,
}

/// What a [`FreeEnergy`] is made for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeEnergyOptions {
    /// The energy that it may give out [J].
    pub(crate) reserve: f64,
    /// The largest force of the device [N].
    pub(crate) max_force: f64,
}

impl<V: InnerProduct> FreeEnergy<V> {
    pub(crate) fn new(FreeEnergyOptions { reserve, max_force }: FreeEnergyOptions) -> Self {
        Self {
            last: None,
            max_force,
            part: 1.0,
            balance: reserve,
            leaks: 0.0,
            losses: 0.0,
            height: 0.0,
            lift: Lift::new(),
            report: FreeForceReport::default(),
        }
    }

    /// One tick, with the options of the stage for walls. If an input is not finite, the wanted force
    /// is returned and the motion so far is forgotten.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(
        &mut self,
        input: FreeInput<V>,
        options: &PassivityOptions,
    ) -> Passed<V> {
        let FreeInput { force, position, scale, elapsed, is_sound } = input;
        let wanted = if scale < 1.0 { force * scale } else { force };
        // A device of infinite damping is passive whatever it renders.
        if !is_sound || options.damping == f64::INFINITY {
            self.last = None;
            return Passed { force: wanted, spent: 0.0 };
        }
        let size = force.norm();
        let felt = if size > self.max_force { force * (self.max_force / size) } else { force };
        let written = if scale < 1.0 { felt * scale } else { felt };
        let before = self.last.replace(Last { position, felt, scale, written, share: 1.0 });
        let is_idle = |last: Last<V>| last.felt == V::ZERO && last.written == V::ZERO;
        if force == V::ZERO && before.is_none_or(is_idle) {
            self.lift.step(position, elapsed, None);
            return Passed { force, spent: 0.0 };
        }
        let spent = before.map_or(0.0, |last| {
            let way = position - last.position;
            let loss = SLACK * options.damping * way.dot(way) / elapsed;
            // Of a motion whose square overflows nothing is known.
            let loss = if loss.is_finite() { loss } else { 0.0 };
            let climbed = -0.5 * (felt + last.felt).dot(way);
            let forgotten = if self.part < 1.0 { 0.0 } else { (elapsed / FORGOTTEN).min(1.0) };
            // Written so that NaN is no height.
            let height = (self.height * (1.0 - forgotten) + climbed).max(0.0);
            self.height = if height < HIGHEST { height } else { HIGHEST };
            self.report.credited += self.part * (scale - last.scale).max(0.0) * self.height;
            let is_taken = (self.part < 1.0).then_some(true);
            let is_lifted = self.lift.step(position, elapsed, is_taken) && options.is_on;
            let leak = last.written.dot(way) + self.part * last.scale * last.share * climbed;
            let mut full = self.observe(leak, loss);
            if options.is_on {
                if is_lifted && leak <= 0.0 {
                    full = self.lifted(full, options.rise_rate * elapsed / felt.norm());
                } else if full < 0.0 {
                    self.cut(full, felt.norm());
                } else {
                    full -= self.risen(elapsed / RECOVERY, 0.5 * full);
                }
            }
            self.balance = full.min(options.reserve);
            let beyond = self.balance - options.reserve;
            self.report.least_balance = self.report.least_balance.min(beyond);
            let owed = (-MOST_OWED - self.balance).max(0.0);
            self.report.credited += owed;
            self.balance += owed;
            loss - (full - options.reserve).clamp(0.0, loss)
        });
        if self.part < 1.0 {
            let passed = self.report.effect.count(written, Some(written * self.part));
            self.written(passed, 1.0);
            return Passed { force: passed, spent };
        }
        // What the device cannot give is left to the limit of the force.
        Passed { force: wanted, spent }
    }

    /// Records the force that was written, and the share that the limits of its size left.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn written(&mut self, force: V, share: f64) {
        if let Some(last) = &mut self.last {
            (last.written, last.share) = (force, share);
        }
    }

    /// Lowers the largest force [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn lower_limit(&mut self, max_force: f64) {
        // `min` ignores NaN.
        self.max_force = self.max_force.min(max_force).max(0.0);
    }

    /// The balance after a tick that leaked, and in which damping dissipated `loss` [J]; above the
    /// reserve, too.
    fn observe(&mut self, leak: f64, loss: f64) -> f64 {
        let credit = if self.part < 1.0 { CREDITED * loss } else { loss };
        let full = self.balance + credit - leak;
        if !full.is_finite() {
            // Numbers overflowed: assume that damping covers nothing.
            (self.leaks, self.losses) = (f64::INFINITY, 0.0);
            return -SPARE;
        }
        if full >= 0.0 {
            (self.leaks, self.losses) = (0.0, 0.0);
        } else {
            // A tick without a leak tells nothing about the leak of the whole force.
            let whole = if leak > 0.0 { leak / self.part } else { 0.0 };
            self.leaks = MEMORY * self.leaks + whole;
            self.losses = MEMORY * self.losses + loss;
        }
        full
    }

    /// Lets less of a force of size `force` [N] pass, as the balance, `full` [J], is used up.
    fn cut(&mut self, full: f64, force: f64) {
        if self.leaks > 0.0 && force > 0.0 {
            let covered = (COVERED * self.losses / self.leaks).min(self.part);
            let smooth = self.part - STEP / force;
            let part = if full > -SPARE { smooth.max(covered) } else { covered };
            if part < self.part {
                self.lift.end();
            }
            self.part = part;
        }
    }

    /// Lets more of the force of a hand at rest pass, by `rise` at most, and forgives what the balance
    /// owes; returns the balance.
    fn lifted(&mut self, full: f64, rise: f64) -> f64 {
        let owed = (-full).max(0.0);
        self.report.credited += owed + self.risen(rise, f64::INFINITY);
        full + owed
    }

    /// Lets more of the force pass, by `rise` at most and for `most` [J] at most; returns what it
    /// costs [J].
    fn risen(&mut self, rise: f64, most: f64) -> f64 {
        let paid = if self.height > 0.0 { most / self.height } else { f64::INFINITY };
        let rise = rise.min(paid).min(1.0 - self.part);
        // Written so that NaN rises nothing.
        if rise > 0.0 {
            self.part += rise;
            rise * self.height
        } else {
            0.0
        }
    }

    pub(crate) fn report(&self) -> FreeForceReport {
        self.report
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use palpate_field::Vector;

    /// A whole force at a position, a tick of 1 ms after the one before.
    fn input(force: Vector<f64, 3>, position: Vector<f64, 3>) -> FreeInput<Vector<f64, 3>> {
        FreeInput { force, position, scale: 1.0, elapsed: 1e-3, is_sound: true }
    }

    fn options(damping: f64) -> PassivityOptions {
        PassivityOptions {
            is_on: true,
            stiffness: 0.0,
            max_force: f64::INFINITY,
            damping,
            mass: 0.1,
            max_rate: f64::INFINITY,
            reserve: 1e-4,
            rise_rate: 20.0,
            period: 1e-3,
        }
    }

    /// A spring that is held over ticks of 1 ms, with a damped mass.
    #[derive(Clone, Copy, Debug)]
    struct Swing {
        /// [N/m].
        stiffness: f64,
        /// [N·s/m].
        damping: f64,
        /// The largest force of the spring [N].
        max_force: f64,
        /// Where the mass is let go [m].
        start: f64,
    }

    /// How a mass swung.
    struct Swung {
        /// The largest sum of kinetic and potential energy at any time [J].
        most: f64,
        /// That sum in the end [J].
        last: f64,
        report: FreeForceReport,
    }

    /// Lets the mass swing for 60 s.
    fn swings(swing: Swing) -> Swung {
        let Swing { stiffness, damping, max_force, start } = swing;
        let (mass, period) = (0.1, 1e-3);
        let options = options(damping);
        let mut free =
            FreeEnergy::new(FreeEnergyOptions { reserve: options.reserve, max_force });
        let (mut x, mut v, mut most, mut energy) = (start, 0.0, 0.0_f64, 0.0);
        for _ in 0..60_000 {
            let at = Vector([x, 0.0, 0.0]);
            let Passed { force, .. } = free.step(input(at * -stiffness, at), &options);
            let force = force[0].clamp(-max_force, max_force);
            // m v' = F − b v, exactly.
            let (rate, steady) = (damping / mass, force / damping);
            let decay = (-rate * period).exp();
            x += steady * period + (v - steady) * (1.0 - decay) / rate;
            v = steady + (v - steady) * decay;
            energy = 0.5 * mass * v * v + free.part * stored(stiffness, max_force, x);
            most = most.max(energy);
        }
        Swung { most, last: energy, report: free.report() }
    }

    /// The potential of a spring of a largest force [J].
    fn stored(stiffness: f64, max_force: f64, x: f64) -> f64 {
        let elastic = x.abs().min(max_force / stiffness);
        0.5 * stiffness * elastic * elastic
            + if elastic < x.abs() { max_force * (x.abs() - elastic) } else { 0.0 }
    }

    /// `K = 2 b / T`, Colgate and Schenkel (1997).
    #[test]
    fn springs_up_to_twice_the_damping_over_the_period_pass() {
        for damping in [0.2, 1.0, 3.0] {
            let stiffness = 2.0 * damping / 1e-3;
            let swing = Swing { stiffness, damping, max_force: f64::INFINITY, start: 1e-3 };
            let Swung { most, report, .. } = swings(swing);
            assert_eq!((report.effect.ticks, report.least_balance), (0, 0.0), "{damping}");
            assert!(most <= 0.5 * stiffness * 1e-6, "{damping}: {most} J");
        }
    }

    /// Without the stage such a spring grows without bound. Once a part that came back by the clock
    /// alone lifted the spring of 1000 N/m to a joule in a minute, and the losses of a long pull paid
    /// for the leaks of the swing after it.
    #[test]
    fn a_stiffer_spring_gives_out_its_reserve_beyond_its_potential() {
        let usual =
            Swing { stiffness: 1000.0, damping: 0.2, max_force: f64::INFINITY, start: 1e-3 };
        for case in [
            Swing { stiffness: 2000.0, ..usual },
            Swing { stiffness: 4000.0, damping: 0.5, ..usual },
            Swing { damping: 0.02, ..usual },
            Swing { start: 4e-3, ..usual },
            Swing { stiffness: 3000.0, max_force: 1.0, start: 5e-2, ..usual },
            Swing { stiffness: 1e6, damping: 0.5, max_force: 3.0, start: 1e-2 },
        ] {
            let Swung { most, last, report } = swings(case);
            let Swing { stiffness, max_force, start, .. } = case;
            let first = stored(stiffness, max_force, start);
            assert!(report.effect.ticks > 0, "{case:?}: {report:?}");
            // The reserve, what is given out while the part falls smoothly, and one tick's leak, `½
            // |ΔF| |Δx|`, at the speed of the first energy.
            let way = (2.0 * first / 0.1).sqrt() * 1e-3;
            let beyond = 1e-4 + SPARE + 0.5 * (stiffness * way).min(2.0 * max_force) * way;
            assert!(report.least_balance >= -beyond, "{case:?}: {report:?}");
            assert!(most <= first + beyond, "{case:?}: {most} J of {first} J");
            assert!(last < 0.5 * first, "{case:?}: {last} J of {first} J");
        }
    }

    /// A part that the controller took stays taken while nothing moves, as nothing is paid.
    #[test]
    fn a_hand_at_rest_feels_the_whole_force_again() {
        let options = options(0.0);
        let mut free = FreeEnergy::new(FreeEnergyOptions {
            reserve: options.reserve,
            max_force: f64::INFINITY,
        });
        let mut at = |x: f64| {
            let force = Vector([-1000.0 * x, 0.0, 0.0]);
            free.step(input(force, Vector([x, 0.0, 0.0])), &options).force[0]
        };
        let shaken: Vec<_> =
            (0..200).map(|tick| at(if tick % 2 == 0 { 2e-3 } else { 1e-3 })).collect();
        assert_eq!(shaken.last(), Some(&0.0));
        let rested: Vec<_> = (0..10_000).map(|_| at(2e-3)).collect();
        assert!(rested.windows(2).all(|pair| pair[0] - pair[1] <= 0.02 + 1e-12), "{rested:?}");
        assert_eq!(rested.last(), Some(&-2.0));
        // `½ K (4 − 1) mm²`, and what one tick leaked before all was taken, `½ 1 N 1 mm`, less the
        // reserve.
        assert!((free.report().credited - 1.9e-3).abs() < 1e-9, "{:?}", free.report());
    }

    /// Once the losses were no number, and guides faded away.
    #[test]
    fn a_device_of_infinite_damping_is_passive() {
        let options = options(f64::INFINITY);
        let mut free = FreeEnergy::new(FreeEnergyOptions {
            reserve: options.reserve,
            max_force: f64::INFINITY,
        });
        for x in [0.0, 0.0, 0.01, -0.02] {
            let force = Vector([-1e4 * x - 1.0, 0.0, 0.0]);
            let passed = free.step(input(force, Vector([x, 0.0, 0.0])), &options);
            assert_eq!((passed.force, passed.spent), (force, 0.0));
        }
        assert_eq!(free.report(), FreeForceReport::default());
    }

    #[test]
    fn a_pull_that_begins_is_no_leak_and_jolts_fade() {
        let options = options(0.0);
        let mut free = FreeEnergy::new(FreeEnergyOptions {
            reserve: options.reserve,
            max_force: f64::INFINITY,
        });
        let mut at = |x: f64, force: f64| {
            free.step(input(Vector([force, 0.0, 0.0]), Vector([x, 0.0, 0.0])), &options).force
                [0]
        };
        // Pulled in by a steady 2 N: the potential falls by what is given out.
        assert!((0..100).all(|k| at(1e-4 * f64::from(k), 2.0) == 2.0));
        // A force that turns against every motion of a device without damping.
        let jolts: Vec<_> =
            (0..200).map(|k| at(2e-5 * f64::from(k % 2), f64::from(k % 2) * -2.0)).collect();
        let pushes: Vec<_> = jolts.iter().skip(1).step_by(2).collect();
        assert_eq!((pushes[0], pushes.last()), (&-2.0, Some(&&-0.0)), "{jolts:?}");
        // By the controller's steps, until more than the spare is given out.
        assert!(pushes.windows(2).all(|pair| pair[0] <= pair[1]), "{jolts:?}");
    }

    /// A mass in a well of a constant pull, without friction, beside a soft spring that brings it
    /// back: once the force was whole again outside of its reach, and each pass gave out all of the
    /// well's potential.
    #[test]
    fn a_well_that_is_passed_again_and_again_pumps_nothing() {
        for (damping, reach) in [(0.0, 0.01), (0.02, 0.01), (0.02, 0.003), (0.2, 0.003)] {
            let (mass, period, pull, spring) = (0.1, 1e-3, 3.0, 20.0);
            let options = options(damping);
            let mut free = FreeEnergy::new(FreeEnergyOptions {
                reserve: options.reserve,
                max_force: 10.0,
            });
            let (mut x, mut v, mut most) = (0.03_f64, 0.0_f64, 0.0_f64);
            let first = 0.5 * spring * x * x;
            for _ in 0..60_000 {
                let at = Vector([x, 0.0, 0.0]);
                // 20 kN/m in the middle, and nothing beyond the reach.
                let full = if x.abs() < reach { (-2e4 * x).clamp(-pull, pull) } else { 0.0 };
                let force = free.step(input(Vector([full, 0.0, 0.0]), at), &options).force[0];
                for _ in 0..10 {
                    let pushed = force - spring * x - damping * v;
                    v += pushed / mass * 0.1 * period;
                    x += v * 0.1 * period;
                }
                most = most.max(0.5 * (mass * v * v + spring * x * x));
            }
            // The well's potential once, the reserve and the spare, what is credited, and what one
            // tick adds at an edge of 3 N at 1 m/s.
            let credited = free.report().credited;
            assert!(credited < 2e-3, "{damping}, {reach}: {credited} J");
            let bound = first + pull * reach + 1e-4 + SPARE + credited + 3e-3;
            assert!(most <= bound, "{damping}, {reach}: {most} J of {bound} J");
        }
    }

    /// The force of a spring behind a slew limit lags behind its place, and once nobody counted that.
    #[test]
    fn a_spring_behind_a_slew_limit_does_not_grow() {
        let (mass, period, stiffness, damping) = (0.1, 1e-3, 400.0, 0.5);
        let options = options(damping);
        let mut free =
            FreeEnergy::new(FreeEnergyOptions { reserve: options.reserve, max_force: 10.0 });
        let (mut x, mut v, mut written) = (0.01, 0.0, 0.0_f64);
        for _ in 0..60_000 {
            let at = Vector([x, 0.0, 0.0]);
            let wanted = free.step(input(at * -stiffness, at), &options).force[0];
            written += (wanted - written).clamp(-0.2, 0.2);
            free.written(Vector([written, 0.0, 0.0]), 1.0);
            let (rate, steady) = (damping / mass, written / damping);
            let decay = (-rate * period).exp();
            x += steady * period + (v - steady) * (1.0 - decay) / rate;
            v = steady + (v - steady) * decay;
        }
        assert!(x.abs() < 0.01 && 0.5 * mass * v * v < 1e-3, "{x} m, {v} m/s");
        assert!(free.report().effect.ticks > 0);
    }

    /// Once nothing came back, and a passive spring was cut.
    #[test]
    fn a_stage_without_a_reserve_lets_passive_springs_pass() {
        let options = PassivityOptions { reserve: 0.0, ..options(1.0) };
        let mut free =
            FreeEnergy::new(FreeEnergyOptions { reserve: 0.0, max_force: f64::INFINITY });
        for tick in 0..5000 {
            let x = 1e-3 * (0.05 * f64::from(tick)).sin();
            let force = Vector([-2000.0 * x, 0.0, 0.0]);
            let passed = free.step(input(force, Vector([x, 0.0, 0.0])), &options);
            assert_eq!(passed.force, force, "{tick}");
        }
    }
}
