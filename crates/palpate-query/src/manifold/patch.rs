// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Patches of contact and the points that span them; contacts of deep and of moved bodies.
//!
//! Contacts of bodies that overlap by more than one of them is thick.
//!
//! Deep in a wall, its gradient leads out of its next side, through its thickness, and says nothing of
//! where it came from. The gradient of the thicker body does, which is the *host* here: a normal out of
//! the host, and the point of the other body, the *guest*, that lies deepest in it.

use palpate_field::{Point, Pose, Vector};

use super::region::{Grid, Towards, distance, towards};
use super::{
    COPIES, LIKE, ManifoldSettings, Member, SAME_DEPTH, SeparatedPair, Spanned, Touch,
    drop_copies, is_copy,
};
use crate::certified::Goal;
use crate::contact::NormalSource;
use crate::pair::body_pair::{BodyPair, Slopes};
use crate::pair::distance_bound::descend;
use crate::pair::search::BoxCell;

/// Candidates nearer than this many spacings are neighbours.
const NEIGHBOURS: f64 = 2.0;

/// The cosine of how far normals of a patch may be from that of its first, 25°.
const ALIKE: f64 = 0.906;

/// Candidates next to a patch that are less deep by more than this share of
/// [`ManifoldSettings::precision_length`] are its slope, and no patch of their own.
const SLOPE: f64 = 0.1;

/// The precision of the deepest point of a patch, as a share of the same length.
const PRECISE: f64 = 1e-3;

/// Patches smaller than this many spacings are one contact, as are corners.
const SMALL: f64 = 1.5;

/// A patch reaches no farther than so many spacings beyond the sides between its corners.
const BEYOND: f64 = 2.0;

/// A corner is moved by at most so many spacings.
const FAR: f64 = 4.0;

/// A corner gives up as many spacings at most to be at the bottom of a valley.
const VALLEY: f64 = 1.0;

/// The first steps to the bottom of a valley, in spacings: long ones may lead far along it, short ones find
/// no way in a flat one.
const VALLEY_STEPS: [f64; 2] = [1.0, 0.1];

/// The last step of a corner, as a share of the spacing.
const SHARP: f64 = 0.06;

/// Candidates and what they are candidates of.
pub(super) struct Patches<'a, 'b, const D: usize> {
    pub(super) pair: BodyPair<'a, D>,
    pub(super) settings: &'b ManifoldSettings,
    /// The certified best point is among them.
    pub(super) candidates: &'b [Touch<D>],
}

impl<const D: usize> Patches<'_, '_, D> {
    /// The contacts of all patches.
    pub(super) fn contacts(&mut self) -> Vec<Member<D>> {
        let candidates = self.candidates;
        let near = NEIGHBOURS * self.settings.spacing;
        let mut grid = Grid::new(candidates.iter().map(|touch| touch.point), near);
        let mut order: Vec<usize> = (0..candidates.len()).collect();
        order.sort_by(|&i, &k| candidates[i].gap.total_cmp(&candidates[k].gap));
        let mut is_owned = vec![false; candidates.len()];
        let (mut members, mut contacts) = (Vec::new(), Vec::new());
        let mut group = 0;
        for seed in order {
            if is_owned[seed] {
                continue;
            }
            let first = &candidates[seed];
            grid.begin(first.point, seed);
            is_owned[seed] = true;
            let mut is_slope = false;
            grid.taken(first.point, |i| {
                is_slope |=
                    candidates[i].gap < first.gap - SLOPE * self.settings.precision_length();
            });
            if is_slope {
                continue;
            }
            members.clear();
            members.push(seed);
            let mut next = 0;
            while next < members.len() {
                let here = candidates[members[next]].point;
                next += 1;
                let known = members.len();
                grid.take(
                    here,
                    |i| candidates[i].normal.dot(first.normal) > ALIKE,
                    &mut members,
                );
                for &member in &members[known..] {
                    is_owned[member] = true;
                }
            }
            self.span(seed, &members, group, &mut contacts);
            group += 1;
        }
        contacts
    }

    /// Appends the contacts of one patch: its deepest, and its corners.
    fn span(
        &mut self,
        seed: usize,
        members: &[usize],
        group: usize,
        contacts: &mut Vec<Member<D>>,
    ) {
        let spacing = self.settings.spacing;
        let seed = self.by_values(self.candidates[seed]);
        // Bodies that touch in a valley meet all along it nearly as deep: short steps find
        // no way down.
        let deepest = self.deepest(seed, spacing);
        let points = || members.iter().map(|&i| self.candidates[i].point);
        let mut centre = Vector::ZERO;
        for p in points() {
            centre += p * (1.0 / members.len() as f64);
        }
        let farthest = |measure: &dyn Fn(Point<D>) -> f64| {
            let candidates = members.iter().map(|&i| &self.candidates[i]);
            candidates.fold((f64::NEG_INFINITY, deepest), |best, touch| {
                let far = measure(touch.point);
                if far > best.0 { (far, *touch) } else { best }
            })
        };
        contacts.push(Member { touch: deepest, group });
        let (size, one) = farthest(&|p| distance(p, centre));
        if size < SMALL * spacing {
            return;
        }
        let (_, other) = farthest(&|p| distance(p, one.point));
        // Round the patch, as seen against the normal.
        let mut corners = vec![one, other];
        let mut i = 0;
        while D == 3 && i < corners.len() {
            let (from, to) = (corners[i].point, corners[(i + 1) % corners.len()].point);
            let outwards = square_to(to - from, deepest.normal).and_then(Vector::normalized);
            let beyond = outwards.map(|outwards| farthest(&|p| (p - from).dot(outwards)));
            match beyond {
                // A candidate that is no corner of the flat polygon could come again and again.
                Some((far, corner))
                    if far > BEYOND * spacing
                        && corners.iter().all(|known| known.point != corner.point) =>
                {
                    corners.insert(i + 1, corner);
                }
                _ => i += 1,
            }
        }
        for i in 0..corners.len() {
            let is_apart =
                |other: &Touch<D>| distance(other.point, corners[i].point) > SMALL * spacing;
            if corners[..i].iter().all(is_apart) {
                let corner = self.by_values(corners[i]);
                let touch = self.corner(corner, &deepest, centre);
                contacts.push(Member { touch, group });
            }
        }
    }

    /// A candidate with the gap of the fields' values: that of a flat model is too small where bodies are
    /// round.
    pub(super) fn by_values(&mut self, candidate: Touch<D>) -> Touch<D> {
        if candidate.source == NormalSource::ThickerBody {
            return candidate;
        }
        Touch { gap: self.pair.gap_at(candidate.point), ..candidate }
    }

    /// The deepest point near a candidate, with a first step of `first` [m].
    fn deepest(&mut self, start: Touch<D>, first: f64) -> Touch<D> {
        let goal = Goal::least(PRECISE * self.settings.precision_length());
        let (_, p) = descend(&mut self.pair, start.point, Some(first), goal, 0.0);
        let is_near = distance(p, start.point) < NEIGHBOURS * self.settings.spacing;
        let found = is_near.then(|| self.settle(p, self.settings.spacing)).flatten();
        found.filter(|found| found.gap < start.gap).unwrap_or(start)
    }

    /// A corner as far out as the patch reaches from its centre.
    pub(super) fn corner(
        &mut self,
        corner: Touch<D>,
        deepest: &Touch<D>,
        centre: Point<D>,
    ) -> Touch<D> {
        let corner = self.sharpen(corner, centre);
        self.in_valley(corner, deepest.gap, centre)
    }

    /// A corner at the bottom of the valley beside it, as of a rod that lies on a face: the corner is no
    /// less far out there.
    fn in_valley(&mut self, corner: Touch<D>, deepest: f64, centre: Point<D>) -> Touch<D> {
        if corner.gap <= deepest + SLOPE * self.settings.precision_length() {
            return corner;
        }
        let outwards = (corner.point - centre).normalized().unwrap_or(Vector::ZERO);
        for share in VALLEY_STEPS {
            let bottom = self.deepest(corner, share * self.settings.spacing);
            let inwards = (corner.point - bottom.point).dot(outwards);
            if bottom.gap < corner.gap && inwards <= VALLEY * self.settings.spacing {
                return bottom;
            }
        }
        corner
    }

    /// Moves a corner outwards along the patch until the gap is the margin or the
    /// bodies no longer face each other: never far, unless the budget left out the rim.
    fn sharpen(&mut self, corner: Touch<D>, centre: Point<D>) -> Touch<D> {
        let away = corner.point - centre;
        let away = away - corner.normal * away.dot(corner.normal);
        let outwards = away * (1.0 / away.norm().max(f64::MIN_POSITIVE));
        let sideways = square_to(corner.normal, outwards).unwrap_or(Vector::ZERO);
        let ways = [outwards, (outwards + sideways) * 0.7, (outwards - sideways) * 0.7];
        let start = corner.point;
        let mut corner = corner;
        let mut step = 0.5 * self.settings.spacing;
        while step > SHARP * self.settings.spacing {
            let moved = ways.iter().find_map(|way| {
                let touch = self.beside(&corner, corner.point + *way * step, step)?;
                let is_on = touch.normal.dot(corner.normal) > super::LIKE;
                let is_out = (touch.point - corner.point).dot(outwards) > 0.3 * step;
                let is_far = distance(touch.point, start) > FAR * self.settings.spacing;
                (is_on && is_out && !is_far).then_some(touch)
            });
            match moved {
                Some(touch) => corner = touch,
                None => step *= 0.5,
            }
        }
        corner
    }

    /// The touch next to `p`, of the kind of `corner`.
    fn beside(&mut self, corner: &Touch<D>, p: Point<D>, far: f64) -> Option<Touch<D>> {
        if corner.source != NormalSource::ThickerBody {
            return self.settle(p, far);
        }
        let goal = Goal::least(PRECISE * self.settings.precision_length());
        let (_, inside) = descend(&mut self.pair, p, Some(far), goal, 0.0);
        let found = swallowed(&mut self.pair, inside, self.settings);
        found.filter(|touch| distance(touch.point, p) <= 2.0 * far)
    }

    /// The point of the surface between next to `p`, if it is within `far` and the
    /// bodies touch there.
    pub(super) fn settle(&mut self, p: Point<D>, far: f64) -> Option<Touch<D>> {
        let found = settled(&mut self.pair, p, far, self.settings);
        found.filter(|touch| touch.gap <= self.settings.margin)
    }
}

/// The point of the surface between two bodies next to `p`, if it is within `far` and the bodies face
/// each other there.
pub(super) fn settled<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    far: f64,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    settled_slopes(pair, p, far, settings).map(|(touch, _)| touch)
}

/// The same, and both values and gradients there.
pub(super) fn settled_slopes<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    far: f64,
    settings: &ManifoldSettings,
) -> Option<(Touch<D>, Slopes<D>)> {
    let mut here = p;
    for _ in 0..4 {
        let slopes = pair.slopes(here);
        match towards(here, slopes, settings) {
            Towards::There(touch) => return Some((touch, slopes)),
            Towards::Next(next) if distance(next, p) <= far => here = next,
            _ => return None,
        }
    }
    None
}

/// A touch in or next to a box that the surface between the bodies may cross, where its centre does not
/// lead to one: from the nearest points of the bodies' surfaces, from the deepest point near, or where
/// one body is thin and wholly in the other, along the gradient of that other.
pub(super) fn seeded<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    cell: &BoxCell<D>,
    settings: &ManifoldSettings,
) -> Seeded<D> {
    let far = 2.0 * cell.radius();
    let is_in = |p: Point<D>| distance(p, cell.centre) <= far;
    let is_touch = |touch: &Touch<D>| touch.gap <= settings.margin && is_in(touch.point);
    for body in 0..2 {
        let start = pair.surface_point(body, cell.centre).filter(|p| is_in(*p));
        let found = start.and_then(|start| settled(pair, start, far, settings));
        if let Some(found) = found.filter(is_touch) {
            return Seeded::Touch(found);
        }
    }
    let precise = PRECISE * settings.precision_length();
    let (value, deepest) =
        descend(pair, cell.centre, Some(cell.radius()), Goal::least(precise), 0.0);
    if !is_in(deepest) {
        return Seeded::Nothing;
    }
    let found = settled(pair, deepest, far, settings).filter(is_touch);
    match found.or_else(|| swallowed(pair, deepest, settings).filter(is_touch)) {
        Some(found) => Seeded::Touch(found),
        None if value < -precise => Seeded::Overlap(deepest),
        None => Seeded::Nothing,
    }
}

/// What is found in or next to a box.
pub(super) enum Seeded<const D: usize> {
    Touch(Touch<D>),
    /// A point in both bodies, where neither's gradient tells the normal: no touch, and yet a part of the region.
    Overlap(Point<D>),
    Nothing,
}

/// The touch of a thin body that lies wholly in a thick one, at a point in both: along the gradient of the
/// thick one, at the side of the thin one that is deeper in it.
fn swallowed<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let gap = pair.gap_at(p);
    let inside = Touch { gap, ..Touch::at(pair, p) };
    let host = (gap < 0.0).then(|| host(pair, &inside)).flatten()?;
    let outwards = pair.slopes(p)[host].1.normalized()?;
    // To both sides of the thin body, along the gradient of the thick one and against it.
    let [mut deeper, mut higher] = [p; 2];
    for _ in 0..2 {
        deeper += outwards * pair.slopes(deeper)[1 - host].0.min(0.0);
        higher -= outwards * pair.slopes(higher)[1 - host].0.min(0.0);
    }
    let thickness = distance(deeper, higher);
    let is_out = |pair: &mut BodyPair<'_, D>, side: Point<D>| {
        pair.slopes(side)[1 - host].0 >= -SIDE * thickness
    };
    if thickness > settings.spacing || !is_out(pair, deeper) || !is_out(pair, higher) {
        return None;
    }
    let depth = pair.slopes(deeper)[host].0;
    let normal = if host == 0 { outwards } else { -outwards };
    let (point, source) = (deeper - outwards * (0.5 * depth), NormalSource::ThickerBody);
    let touch = Touch { point, normal, gap: depth, source };
    (depth < gap).then_some(touch)
}

/// A vector square to both, in space; in the plane there is none.
pub(super) fn square_to<const D: usize>(
    a: Vector<f64, D>,
    b: Vector<f64, D>,
) -> Option<Vector<f64, D>> {
    (D == 3).then(|| a.in_space().cross(b.in_space()).truncated())
}

/// A body is thick if, over a way against its gradient, its value falls by more than this share of it.
const THICK: f64 = 0.5;

/// Steps to the deepest point at most.
const STEPS: usize = 32;

/// A point is at the side of a thin body if it is in the body by less than this share of its thickness.
const SIDE: f64 = 0.01;

/// A step leads down if it does by this share of the last step's length.
const DOWN: f64 = 0.5;

/// What a step is multiplied by after one that leads down and stays in the guest, and after another.
const GROW: f64 = 1.5;
const SHRINK: f64 = 0.5;

/// The last step, as a share of [`ManifoldSettings::precision_length`].
pub(super) const DEEP_PRECISE: f64 = 0.05;

/// The host of a touch: the body that is thick where the other is thin; `None` if both are the one or
/// the other.
pub(super) fn host<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
) -> Option<usize> {
    let slopes = pair.slopes(touch.point);
    let way = touch.gap.abs();
    let mut is_thick = |body: usize| {
        let (value, slope) = slopes[body];
        let inwards = slope.normalized()? * -way;
        let deeper = pair.slopes(touch.point + inwards)[body].0;
        Some(value - deeper > THICK * way)
    };
    match [is_thick(0)?, is_thick(1)?] {
        [true, false] => Some(0),
        [false, true] => Some(1),
        _ => None,
    }
}

/// The touch along the gradient of the host, at the point of the guest that lies deepest in it, from a
/// point of the guest on down, with a step of `first` [m] or of its depth. `None` where the host has no
/// gradient, or the point is not in it.
pub(super) fn in_host<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    host: usize,
    (from, first): (Point<D>, f64),
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let precise = DEEP_PRECISE * settings.precision_length();
    let (here, (gap, slope)) = lowest(pair, host, (from, first), precise);
    let outwards = slope.normalized().filter(|_| gap < 0.0)?;
    let normal = if host == 0 { outwards } else { -outwards };
    let point = here - outwards * (0.5 * gap);
    Some(Touch { point, normal, gap, source: NormalSource::ThickerBody })
}

/// The point of the guest where the host's value is least, from a point of the guest on down, to `precise`
/// [m]; and the host's value and gradient there.
pub(super) fn lowest<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    host: usize,
    (from, first): (Point<D>, f64),
    precise: f64,
) -> (Point<D>, (f64, Vector<f64, D>)) {
    let guest = 1 - host;
    let mut here = from;
    let mut slopes = pair.slopes(here);
    let mut step = slopes[host].0.abs().max(first);
    for _ in 0..STEPS {
        if step < precise {
            break;
        }
        let Some(outwards) = slopes[host].1.normalized() else { break };
        let mut next = here - outwards * step;
        let mut there = pair.slopes(next);
        // Back into the guest, where the step has left it.
        for _ in 0..2 {
            let (value, slope) = there[guest];
            let squared = slope.dot(slope);
            if value > 0.0 && squared > 0.0 {
                next -= slope * (value / squared);
                there = pair.slopes(next);
            }
        }
        let is_deeper = there[host].0 < slopes[host].0 - DOWN * precise;
        if is_deeper && there[guest].0 <= precise {
            (here, slopes) = (next, there);
            step *= GROW;
        } else {
            step *= SHRINK;
        }
    }
    (here, slopes[host])
}

/// The touch along the host's gradient, where a touch is deeper than the margin and one of the bodies is
/// too thin to say where it came from.
pub(super) fn pushed<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    if touch.gap >= -settings.margin {
        return None;
    }
    let host = host(pair, touch)?;
    in_host(pair, host, (touch.point, settings.spacing), settings)
        .filter(|found| found.gap <= touch.gap)
}

/// The touch of bodies that were followed to where they overlap: along `normals`, those of the first
/// touch carried with the first body and with the second, from the `points` of that touch, carried
/// likewise. All are in the pair's frame.
///
/// A body whose gradient still leads along its own normal is the host. Where neither's does, both are
/// thin: the gap is what the points have moved past each other.
pub(crate) fn followed<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    points: [Point<D>; 2],
    normals: [Vector<f64, D>; 2],
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    for host in 0..2 {
        let guest = points[1 - host];
        let side = if host == 0 { 1.0 } else { -1.0 };
        let Some(outwards) = pair.slopes(guest)[host].1.normalized() else { continue };
        if (outwards * side).dot(normals[host]) > super::LIKE
            && let Some(found) = in_host(pair, host, (guest, settings.spacing), settings)
            && found.normal.dot(normals[host]) > super::LIKE
        {
            return Some(Touch { source: NormalSource::History, ..found });
        }
    }
    let normal = (normals[0] + normals[1]).normalized()?;
    let gap = (points[1] - points[0]).dot(normal);
    let point = points[1] - normal * (0.5 * gap);
    (gap < 0.0).then_some(Touch { point, normal, gap, source: NormalSource::History })
}

/// A point is drawn to where the gap is this share of the margin, in so many steps at most.
const WITHIN: f64 = 0.9;
const DRAWN: usize = 4;

/// Where the bodies face each other no longer at a point of a rim, they may so many spacings farther
/// inwards.
const INWARDS: [f64; 3] = [1.0 / 16.0, 1.0 / 4.0, 1.0];

impl<const D: usize> Spanned<D> {
    /// These points, found when the second body was at `found_at` in the pair's frame, on the surface
    /// between the bodies as they are now, with the best point of the search. `None` where the bodies do
    /// not face each other any more at a point as they did: what spans the region now must be found anew.
    pub(crate) fn moved(
        &self,
        separated: &mut SeparatedPair<'_, D>,
        found_at: &Pose<D>,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        let SeparatedPair { pair, best, .. } = separated;
        let second_to_frame = pair.second_from_frame.inverse();
        let with_second =
            |p: Point<D>| second_to_frame.transform_point(found_at.transform_point(p));
        let mut carry = |member: &Member<D>| {
            let Touch { point, normal, .. } = member.touch;
            let touch = carried(pair, [point, with_second(point)], normal, settings)?;
            Some(Member { touch, ..*member })
        };
        let mut members: Vec<_> = self.members.iter().map(&mut carry).collect::<Option<_>>()?;
        let beyond: Vec<_> = self.beyond.iter().filter_map(&mut carry).collect();
        for member in &mut members {
            if member.touch.gap > settings.margin
                && let Some(touch) = drawn_within(pair, &member.touch, settings)
            {
                member.touch = touch;
            }
        }
        members.extend(beyond);
        members.retain(|member| member.touch.gap <= settings.margin);
        let deepest = Touch::at(pair, *best);
        add_deepest(&mut members, deepest, settings);
        // Those that have come nearer to each other than the spacing.
        drop_copies(&mut members, settings.spacing / COPIES);
        Some(Self { members, beyond: Vec::new(), stop: self.stop })
    }
}

/// The deepest touch with a normal like `normal` next to the places to which the bodies carried a point;
/// or farther inwards, where the bodies face each other likewise at none of them.
pub(crate) fn carried<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    places: [Point<D>; 2],
    normal: Vector<f64, D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let found = places.map(|place| like(pair, place, normal, settings));
    let deeper = found.into_iter().flatten().min_by(|one, other| one.gap.total_cmp(&other.gap));
    deeper.or_else(|| {
        places.into_iter().find_map(|place| {
            let inwards = inwards(pair, place, normal)?;
            let mut ways =
                INWARDS.into_iter().map(|share| inwards * (share * settings.spacing));
            ways.find_map(|way| like(pair, place + way, normal, settings))
        })
    })
}

/// The way inwards from a point at the rim of a region where the gradient of a body leads out of a side of
/// it: along the region, against that gradient.
fn inwards<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    normal: Vector<f64, D>,
) -> Option<Vector<f64, D>> {
    let [(_, slope_a), (_, slope_b)] = pair.slopes(p);
    let sum = slope_a + slope_b;
    (normal * sum.dot(normal) - sum).normalized()
}

/// The touch next to a point, if it has a normal like `normal`.
fn like<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    normal: Vector<f64, D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    settled(pair, p, settings.spacing, settings).filter(|touch| touch.normal.dot(normal) > LIKE)
}

/// A touch whose gap is within the margin, by steps of Newton's method along the surface between the
/// bodies from a touch whose gap is larger.
fn drawn_within<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    from: &Touch<D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let mut here = from.point;
    for _ in 0..DRAWN {
        let [(a, slope_a), (b, slope_b)] = pair.slopes(here);
        // On the surface between, the gap is the sum of both values.
        let (across, sum) = (slope_a - slope_b, slope_a + slope_b);
        let along = sum - across * (sum.dot(across) / across.dot(across));
        let next = here - along * ((a + b - WITHIN * settings.margin) / along.dot(along));
        let touch = like(pair, next, from.normal, settings)?;
        if touch.gap <= settings.margin {
            return Some(touch);
        }
        here = touch.point;
    }
    None
}

/// Adds the certified deepest touch, unless one of the members is as deep.
fn add_deepest<const D: usize>(
    members: &mut Vec<Member<D>>,
    deepest: Touch<D>,
    settings: &ManifoldSettings,
) {
    let is_as_deep =
        |touch: &Touch<D>| touch.gap - deepest.gap <= SAME_DEPTH * settings.precision_length();
    if let Some(member) = members.iter_mut().find(|member| is_as_deep(&member.touch)) {
        // No less deep than what is certified.
        member.touch.gap = member.touch.gap.min(deepest.gap);
        return;
    }
    let is_like = |member: &&mut Member<D>| member.touch.normal.dot(deepest.normal) > LIKE;
    let apart = |member: &Member<D>| distance(member.touch.point, deepest.point);
    let nearest = members
        .iter_mut()
        .filter(is_like)
        .min_by(|one, other| apart(one).total_cmp(&apart(other)));
    match nearest {
        Some(member) if is_copy(&member.touch, &deepest, settings.spacing) => {
            member.touch = deepest;
        }
        nearest => {
            let group = nearest.map(|member| member.group);
            let new = || members.iter().map(|member| member.group + 1).max().unwrap_or(0);
            let group = group.unwrap_or_else(new);
            members.push(Member { touch: deepest, group });
        }
    }
}
