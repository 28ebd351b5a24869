// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The gear of MuJoCo's plugin `mujoco.sdf.gear`, as a polygon about half a tooth that is folded
//! into all of them.
//!
//! An involute gear of pitch diameter D with N teeth, without backlash:
//!
//! - the pressure angle is ψ = 3.096e-5·N² − 6.557e-3·N + 0.551 rad; the module is D/N, the base
//!   radius D/2·cos ψ, the tip radius one module above the pitch circle, the root radius 2.2
//!   modules below the tip;
//! - at the radius ρ a tooth reaches to the angle `w − inv(arccos(base/ρ))` to either side of its
//!   middle, with `w = π/(2·N) + inv ψ`, `inv φ = tan φ − φ`; below the base circle it reaches to w;
//! - the tips are rounded with a reach of 0.0035·D, the feet with one of base − root radius.
//!
//! The fields that are rounded are those of the plugin, metres on the flanks and radians below:
//! the shape of the rounding depends on them. The first tooth begins at the angle 0 on the base
//! circle.

use std::f64::consts::PI;

use palpate::field::kernel::{Ball, Polygon};
use palpate::field::{Rotation, Shape, ShapeError, Vector};

/// Radii at which a flank is sampled before it is simplified.
const SAMPLES: u32 = 4000;

/// Halvings that find an angle: all of a double's digits.
const HALVINGS: u32 = 54;

/// The numbers of a gear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gear {
    /// The pitch diameter [m].
    pub(super) diameter: f64,
    /// The number of teeth is 2 to this power, so that folds make them of one.
    pub(super) folds: u32,
}

impl Gear {
    pub(super) fn teeth(&self) -> f64 {
        f64::from(self.folds).exp2()
    }

    fn module(&self) -> f64 {
        self.diameter / self.teeth()
    }

    fn pressure_angle(&self) -> f64 {
        let teeth = self.teeth();
        3.096e-5 * teeth * teeth - 6.557e-3 * teeth + 0.551
    }

    fn base(&self) -> f64 {
        0.5 * self.diameter * self.pressure_angle().cos()
    }

    fn tip(&self) -> f64 {
        0.5 * self.diameter + self.module()
    }

    fn root(&self) -> f64 {
        self.tip() - 2.2 * self.module()
    }

    /// The radius of the bore that the plugin gives a gear unless told [m].
    pub(super) fn bore(&self) -> f64 {
        self.root() - 0.14 * self.diameter
    }

    /// Half the angle between two teeth [rad].
    fn half_step(&self) -> f64 {
        PI / self.teeth()
    }

    /// Half the angle that a tooth takes on the base circle [rad].
    fn half_width(&self) -> f64 {
        0.5 * self.half_step() + inv(self.pressure_angle())
    }

    /// The plugin's field at a radius [m] and an angle [rad] from the middle of a tooth, without
    /// the bore: negative inside.
    fn field(&self, radius: f64, angle: f64) -> f64 {
        let beyond = angle.abs() - self.half_width();
        let base = self.base();
        let flank = if radius > base {
            beyond.max(base * (beyond + inv((base / radius).acos())))
        } else {
            beyond
        };
        let tip = radius - self.tip();
        let rounding = smooth_minimum(tip.max(-flank), flank.max(-tip), 0.0035 * self.diameter);
        let tooth = tip.max(flank).max(-rounding);
        smooth_minimum(radius - self.root(), tooth, base - self.root())
    }

    /// The profile with its bore, the middle of a tooth at the angle −w: mirrored in x, for
    /// profiles are drawn in x and z. Its edges are within `tolerance` [m] of the gear's.
    ///
    /// Exact: the point of a gear's outline that is nearest to a point is in the same half of a
    /// tooth, or its mirror image would be nearer.
    pub(super) fn profile(&self, tolerance: f64) -> Result<Shape<2>, ShapeError> {
        let corners = self.about_half_a_tooth(tolerance).into_iter().map(|[r, a]| polar(r, a));
        let mut profile =
            Shape::from_kernel(Polygon::new(vec![corners.map(Vector).collect()])?);
        // What is right between the angles 0 and `known` becomes right up to twice as much.
        let mut known = self.half_step();
        for _ in 0..self.folds {
            let turn = PI - known;
            profile = profile.rotated(Rotation::from_angle(turn)?)?.mirrored(1)?;
            profile = profile.rotated(Rotation::from_angle(-turn)?)?;
            known *= 2.0;
        }
        let profile =
            profile.mirrored(1)?.rotated(Rotation::from_angle(-self.half_width())?)?;
        // The box of the folds is large; that of the tip circle is not, and no value changes.
        let [tip, bore] =
            [self.tip(), self.bore()].map(|r| Ball::new(r).map(Shape::from_kernel));
        Shape::difference(Shape::intersection([tip?, profile])?, [bore?])
    }

    /// A closed line of radii and angles from the middle of a tooth: that of the gear around the
    /// half between the angles 0 and `half_step`. What closes it is farther from the points of
    /// this half than what is in it, but for those within the bore.
    fn about_half_a_tooth(&self, tolerance: f64) -> Vec<[f64; 2]> {
        let flank = simplified(&self.flank(tolerance), tolerance);
        let half = self.half_step();
        let before = flank.iter().map(|[radius, angle]| [*radius, -angle]);
        let within = flank.iter().rev().skip(1).copied();
        let after = flank.iter().skip(1).map(|[radius, angle]| [*radius, 2.0 * half - angle]);
        let ends = [[self.root(), 3.0 * half], [0.0, 0.0], [self.root(), -2.0 * half]];
        before.chain(within).chain(after).chain(ends).collect()
    }

    /// Half a tooth from the middle of a gap to the middle of the tip: radii and angles.
    fn flank(&self, tolerance: f64) -> Vec<[f64; 2]> {
        let (root, tip) = (self.root(), self.tip());
        let mut flank = Vec::new();
        // Closer at both ends, where the outline is bent most.
        let part = |i: u32| 0.5 - 0.5 * (PI * f64::from(i) / f64::from(SAMPLES)).cos();
        for i in 1..SAMPLES {
            let radius = root + (tip - root) * part(i);
            flank.push([radius, self.angle_at(radius)]);
        }
        let arc = |radius: f64, from: f64, to: f64| {
            let chord = 2.0 * (1.0 - tolerance / radius).acos();
            let pieces = ((from - to).abs() / chord).ceil().max(1.0) as u32;
            let part = move |i| f64::from(i) / f64::from(pieces);
            (0..=pieces).map(move |i| [radius, from + (to - from) * part(i)])
        };
        let first = flank.first().map_or(0.0, |[_, angle]| *angle);
        let last = flank.last().map_or(0.0, |[_, angle]| *angle);
        let gap = arc(root, self.half_step(), first);
        gap.chain(flank).chain(arc(tip, last, 0.0)).collect()
    }

    /// The angle from the middle of a tooth at which the field is zero [rad].
    fn angle_at(&self, radius: f64) -> f64 {
        let (mut inside, mut outside) = (0.0, self.half_step());
        for _ in 0..HALVINGS {
            let angle = 0.5 * (inside + outside);
            if self.field(radius, angle) < 0.0 { inside = angle } else { outside = angle }
        }
        0.5 * (inside + outside)
    }
}

/// The involute function.
fn inv(angle: f64) -> f64 {
    angle.tan() - angle
}

/// The quadratic smooth minimum of this reach.
fn smooth_minimum(a: f64, b: f64, reach: f64) -> f64 {
    let share = (0.5 + 0.5 * (b - a) / reach).clamp(0.0, 1.0);
    b + (a - b) * share - reach * share * (1.0 - share)
}

fn polar(radius: f64, angle: f64) -> [f64; 2] {
    [radius * angle.cos(), radius * angle.sin()]
}

/// Of a line of radii and angles, those that keep all others within `tolerance` of the chords
/// (Douglas and Peucker 1973).
fn simplified(line: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut kept = vec![false; line.len()];
    let mut open = vec![(0, line.len() - 1)];
    while let Some((first, last)) = open.pop() {
        (kept[first], kept[last]) = (true, true);
        let ends = [first, last].map(|i| polar(line[i][0], line[i][1]));
        let distances = (first + 1..last).map(|i| (i, to_chord(ends, line[i])));
        let farthest = distances.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, distance)) = farthest
            && distance > tolerance
        {
            open.extend([(first, i), (i, last)]);
        }
    }
    line.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

/// The distance from a point, as radius and angle, to the line through both ends.
fn to_chord([a, b]: [[f64; 2]; 2], [radius, angle]: [f64; 2]) -> f64 {
    let p = polar(radius, angle);
    let ([x, y], [u, v]) = ([p[0] - a[0], p[1] - a[1]], [b[0] - a[0], b[1] - a[1]]);
    let length = u.hypot(v);
    if length > 0.0 { (x * v - y * u).abs() / length } else { x.hypot(y) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    use crate::random::Random;

    const GEAR: Gear = Gear { diameter: 0.1, folds: 4 };

    const TOLERANCE: f64 = 1e-6;

    /// The field of the formulas at a point of the plane in which profiles are drawn.
    fn by_formula([x, z]: [f64; 2]) -> f64 {
        let step = TAU / GEAR.teeth();
        let from_middle = (-z).atan2(x) - GEAR.half_width();
        let angle = from_middle - step * (from_middle / step).round();
        let radius = x.hypot(z);
        GEAR.field(radius, angle).max(GEAR.bore() - radius)
    }

    #[test]
    fn the_profile_has_the_signs_of_the_formulas() -> Result<(), ShapeError> {
        let profile = GEAR.profile(TOLERANCE)?;
        let mut random = Random::new(3);
        for _ in 0..20_000 {
            let p = random.point([0.0; 2], 0.06);
            let distance = profile.distance(Vector(p));
            let field = by_formula(p);
            let agree = (distance < 0.0) == (field < 0.0);
            assert!(agree || distance.abs() < 2.0 * TOLERANCE, "{p:?}: {distance}, {field}");
        }
        Ok(())
    }

    /// Steps of 10 µm along all of a fine outline are an oracle of the distance, to 5 µm and what
    /// that adds.
    #[test]
    fn the_profile_is_exact() -> Result<(), ShapeError> {
        let flank = GEAR.flank(1e-9);
        let mut outline = Vec::new();
        for i in 0..16 {
            let middle = -GEAR.half_width() + TAU / 16.0 * f64::from(i);
            for pair in flank.windows(2) {
                for side in [-1.0, 1.0] {
                    let [a, b] =
                        [pair[0], pair[1]].map(|[r, angle]| polar(r, middle + side * angle));
                    let pieces = ((b[0] - a[0]).hypot(b[1] - a[1]) / 1e-5).ceil().max(1.0);
                    let at = |j: u32| {
                        let part = f64::from(j) / pieces;
                        [0, 1].map(|k| a[k] + (b[k] - a[k]) * part)
                    };
                    outline.extend((0..pieces as u32).map(at));
                }
            }
        }
        let profile = GEAR.profile(TOLERANCE)?;
        let mut random = Random::new(5);
        for _ in 0..100 {
            let p = random.point([0.0; 2], 0.06);
            let to = |q: &[f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
            let nearest = outline.iter().map(to).fold(f64::INFINITY, f64::min);
            let radius = p[0].hypot(p[1]);
            let expected = match by_formula(p) < 0.0 {
                true => -nearest.min(radius - GEAR.bore()),
                false if radius < GEAR.bore() => GEAR.bore() - radius,
                false => nearest,
            };
            let distance = profile.distance(Vector(p));
            assert!((distance - expected).abs() < 7e-6, "{p:?}: {distance}, {expected}");
        }
        Ok(())
    }

    #[test]
    fn a_tooth_is_as_wide_as_a_gap_on_the_pitch_circle() {
        let angle = GEAR.angle_at(0.5 * GEAR.diameter);
        assert!((angle - 0.5 * GEAR.half_step()).abs() < 1e-15, "{angle}");
    }

    #[test]
    fn a_finer_outline_has_more_corners() {
        let counts = [1e-5, 1e-6].map(|tolerance| GEAR.about_half_a_tooth(tolerance).len());
        assert!(counts[0] < counts[1] && counts[1] < 500, "{counts:?}");
    }
}
