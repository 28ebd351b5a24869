// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The gear of MuJoCo's plugin `mujoco.sdf.gear`, as a polygon.
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

/// Radii at which a flank is sampled before it is simplified.
const SAMPLES: u32 = 4000;

/// Halvings that find an angle: all of a double's digits.
const HALVINGS: u32 = 54;

/// The numbers of a gear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gear {
    /// The pitch diameter [m].
    pub(super) diameter: f64,
    pub(super) teeth: u32,
}

impl Gear {
    fn module(&self) -> f64 {
        self.diameter / f64::from(self.teeth)
    }

    fn pressure_angle(&self) -> f64 {
        let teeth = f64::from(self.teeth);
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
        PI / f64::from(self.teeth)
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

    /// The outline, counter-clockwise, whose edges are within `tolerance` [m] of the gear's.
    pub(super) fn outline(&self, tolerance: f64) -> Vec<[f64; 2]> {
        let flank = simplified(&self.flank(tolerance), tolerance);
        let middle = self.half_width();
        let one = flank.iter().map(|[radius, angle]| [*radius, -angle]);
        // The middle of the tip and the middle of the gap are in one flank alone.
        let other = flank.iter().rev().filter(|[_, angle]| *angle > 0.0);
        let other = other.filter(|[_, angle]| *angle < self.half_step());
        let tooth: Vec<_> = one.chain(other.copied()).collect();
        let step = 2.0 * self.half_step();
        let teeth = (0..self.teeth).map(|i| middle + step * f64::from(i));
        teeth.flat_map(|at| tooth.iter().map(move |[r, angle]| polar(*r, at + angle))).collect()
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

    const GEAR: Gear = Gear { diameter: 0.1, teeth: 25 };

    /// The angle of a point from the middle of the nearest tooth.
    fn from_tooth([x, y]: [f64; 2]) -> f64 {
        let step = TAU / f64::from(GEAR.teeth);
        let angle = (y.atan2(x) - GEAR.half_width()).rem_euclid(step);
        angle.min(step - angle)
    }

    #[test]
    fn corners_of_the_outline_are_on_the_gear() {
        let outline = GEAR.outline(1e-6);
        for p in &outline {
            let field = GEAR.field(p[0].hypot(p[1]), from_tooth(*p));
            // Radians on the walls below the base circle count a twentieth of a metre here.
            assert!(field.abs() < 1e-9, "{p:?}: {field}");
        }
    }

    #[test]
    fn edges_are_within_the_tolerance() {
        let outline = GEAR.outline(1e-6);
        for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
            let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            let (radius, angle) = (middle[0].hypot(middle[1]), from_tooth(middle));
            // Twice the tolerance to either side the sign is that of the field.
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            let out = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
            for side in [-2e-6, 2e-6] {
                let p = [middle[0] + side * out[0], middle[1] + side * out[1]];
                let field = GEAR.field(p[0].hypot(p[1]), from_tooth(p));
                assert!(field * side > 0.0, "at {radius}, {angle}: {field} {side} off");
            }
        }
    }

    #[test]
    fn a_tooth_is_as_wide_as_a_gap_on_the_pitch_circle() {
        let angle = GEAR.angle_at(0.5 * GEAR.diameter);
        assert!((angle - 0.5 * GEAR.half_step()).abs() < 1e-15, "{angle}");
    }

    #[test]
    fn a_finer_outline_has_more_corners() {
        let counts = [1e-5, 1e-6].map(|tolerance| GEAR.outline(tolerance).len());
        assert!(counts[0] < counts[1] && counts[1] < 5000, "{counts:?}");
    }
}
