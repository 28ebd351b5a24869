// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Screw threads about the y axis.

use std::f64::consts::TAU;

use super::cylinder::{from_axis, turned_bounds};
use crate::error::{ShapeError, Unit, finite, not_negative, positive};
use crate::kernel::mark::Mark;
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Dual, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 32.0;

/// The most threads beside each other.
const MOST_STARTS: u32 = 1000;

/// Room for the roundings of the factor that makes the flanks no steeper than one.
const SCALE_ROOM: f64 = 1.0 - 16.0 * f64::EPSILON;

/// A ridge that winds around a cylinder about the y axis: flat crests and roots, straight
/// flanks between. A bound; exact off the crests and roots, and off the ends.
///
/// A bolt's thread as drawn in ISO 68-1 has crests of P/8, roots of P/4, and is 5/8·H deep,
/// where P is the pitch and `H = √3/2·P`: its flanks are at 60° to each other.
///
/// # Derivation
///
/// In the half plane through the axis at the angle φ [rad] the thread's section is a profile
/// repeated each pitch P, shifted along the axis by φ/2π of the lead, which is P times the
/// starts. So at the distance r from the axis `h = y − lead·φ/2π` says where along the
/// profile a point is, and folded about the middles of crests and roots it is in `[0, P/2]`.
///
/// In that plane, the section above the roots' line is a convex wedge, between the line of
/// the crest and that of the flank, and `w(r, h)` is the exact signed distance to it. At the
/// radius r a step around the axis changes h by `lead/2πr`, and the slope of w along h is at
/// most n, the part of the flank's unit normal along the axis: next to the corner of the
/// wedge, normals are between those of its sides. So with s for `lead/2πq`, where q is the
/// roots' radius, w is no steeper than `√(1 + n²s²)` for `r ≥ q`.
///
/// Nearer to the axis h changes faster and faster. There `w(q, h)·r/q − c·(q − r)` takes the
/// place of w. Its slope around the axis is that at q, its slope along the axis no larger, and
/// along r it is `c − |w|/q` under a ridge, where w is negative and no larger than the depth.
/// With `c ≥ depth/2q` this is at most c. So it is no steeper than `√(c² + n²(1 + s²))`: as steep
/// as w outside if c² is `1 − n²`. Divided by the larger of both steepnesses it has a Lipschitz
/// constant of one.
///
/// The thread is the union of what has been described and the cylinder of the roots, within
/// the cylinder of the crests: minima and maxima of distances that are no steeper than one.
/// Where it is between two roots, w is positive, so that near the axis the cylinder of the
/// roots counts. Past an end, h is that of the end, so that the value is the same along y, and
/// the distance to the end is at right angles to it: an orthant, as for an extrusion.
///
/// Roundings move h by a few units of the height and of the lead, which is part of the size that
/// the promise counts with; folding it another way at the middle of a root moves it no
/// farther.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::ScrewThread};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // Two starts, each climbing by 0.8 m in a turn.
/// let screw = ScrewThread::new(1.0, 4.0, 0.4, 2, Vector([0.1, 0.2, 0.2]))?;
/// let screw = Shape::from_kernel(screw);
/// assert_eq!(screw.distance(Vector([1.5, 0.0, 0.0])), 0.5); // over a crest
/// assert_eq!(screw.distance(Vector([-1.25, 0.0, 0.0])), 0.25); // half a turn on: the other's crest
/// assert!((screw.distance(Vector([0.85, 0.2, 0.0])) - 0.05).abs() < 1e-15); // over a root
/// assert_eq!(screw.distance(Vector([0.0, 7.0, 0.0])), 5.0); // over an end
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ScrewThread {
    radius: f64,
    half_height: f64,
    pitch: f64,
    starts: u32,
    profile: Vector<f64, 3>,
    /// Up in a right-handed turn [m].
    lead: f64,
    /// The distance of the roots from the axis [m].
    root_radius: f64,
    /// The unit normal of a flank, along the axis and away from it.
    normal: [f64; 2],
    /// What the distance to crest and flank is multiplied by.
    scale: f64,
    /// How fast it falls towards the axis below the roots.
    core_slope: f64,
}

impl ScrewThread {
    /// A thread with crests at `radius`, of full `height`, `pitch` from crest to crest [m],
    /// left-handed if it is negative, and so many `starts`. `profile` has the widths of a crest and of
    /// a root along the axis, and the depth of the roots below the crests [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or a width negative; if the starts are not from 1 to 1000;
    /// if crest and root together are wider than the pitch; or if the roots are as deep as the
    /// axis.
    pub fn new(
        radius: f64,
        height: f64,
        pitch: f64,
        starts: u32,
        profile: Vector<f64, 3>,
    ) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        let half_height = 0.5 * positive("height", height, Unit::Metre)?;
        let spacing = finite("pitch", pitch, Unit::Metre)?.abs();
        if positive("pitch", spacing, Unit::Metre).is_err() {
            let rule = "positive, or negative for a left-handed thread";
            return Err(ShapeError::number("pitch", rule, pitch, Unit::Metre));
        }
        if !(1..=MOST_STARTS).contains(&starts) {
            let rule = format!("from 1 to {MOST_STARTS}");
            return Err(ShapeError::number("starts", rule, f64::from(starts), Unit::One));
        }
        let [crest, root, depth] = profile.0;
        not_negative("profile[0]", crest, Unit::Metre)?;
        not_negative("profile[1]", root, Unit::Metre)?;
        positive("profile[2]", depth, Unit::Metre)?;
        if crest + root > spacing {
            let rule = format!("at most the pitch {spacing} m less the root's {root} m");
            return Err(ShapeError::number("profile[0]", rule, crest, Unit::Metre));
        }
        if depth >= radius {
            let rule = format!("less than the radius, {radius} m");
            return Err(ShapeError::number("profile[2]", rule, depth, Unit::Metre));
        }
        let root_radius = radius - depth;
        let lead = pitch * f64::from(starts);
        let width = 0.5 * (spacing - crest - root);
        let length = Vector([depth, width]).norm();
        let normal = [depth / length, width / length];
        let core_slope = normal[1].max(0.5 * depth / root_radius);
        let along = normal[0] * normal[0];
        let around = along * (lead / (TAU * root_radius)).powi(2);
        let steepest = (1.0 + around).max(core_slope * core_slope + along + around);
        Ok(Self {
            radius,
            half_height,
            pitch,
            starts,
            profile,
            lead,
            root_radius,
            normal,
            scale: SCALE_ROOM / steepest.sqrt(),
            core_slope,
        })
    }

    /// Numbers in the formula are no larger than this and the coordinates together [m].
    fn size(&self) -> f64 {
        self.radius + self.half_height + self.lead.abs()
    }

    /// Where along its turn of the profile `p` is, from the middle of the nearest crest.
    #[inline(always)]
    fn along<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.0;
        let pitch = self.pitch.abs();
        let turns = (self.half_height + self.lead.abs()) / pitch + 1.0;
        let y = y.clamp(-self.half_height, self.half_height);
        let along = y - S::turn(x, -z).scale(self.lead);
        along - along.nearest_multiple(pitch, -turns, turns)
    }

    /// The signed distance to the wedge between the lines of crest and flank, at a distance
    /// from the axis and `from_crest`, the distance from the middle of a crest along the axis.
    #[inline(always)]
    fn wedge<S: Scalar>(&self, from_axis: S, from_crest: S) -> S {
        let [along, out] = self.normal;
        let zero = S::constant(0.0);
        let above = from_axis - S::constant(self.radius);
        let past = from_crest - S::constant(0.5 * self.profile.0[0]);
        let face = above.max(past.scale(along) + above.scale(out));
        let down_the_flank = past.scale(out) - above.scale(along);
        let corner = S::norm([above, past]);
        let above_flank = S::select_less(down_the_flank, zero, corner, face);
        S::select_less(zero, past, above_flank, face)
    }

    /// The distance from the `wedge`, of a point within the cylinder of the roots that at the
    /// roots' radius.
    #[inline(always)]
    fn beside_wedge<S: Scalar>(&self, from_axis: S, y: S, wedge: S) -> S {
        let share = from_axis.scale(1.0 / self.root_radius).min(S::constant(1.0));
        let below = (S::constant(self.root_radius) - from_axis).max(S::constant(0.0));
        let ridge = (wedge * share - below.scale(self.core_slope)).scale(self.scale);
        self.beside_ridge(from_axis, y, ridge)
    }

    /// The distance, from that to a ridge without ends.
    #[inline(always)]
    fn beside_ridge<S: Scalar>(&self, from_axis: S, y: S, ridge: S) -> S {
        let over_root = from_axis - S::constant(self.root_radius);
        let over_crest = from_axis - S::constant(self.radius);
        let around = ridge.min(over_root).max(over_crest);
        S::orthant([around, y.abs() - S::constant(self.half_height)])
    }

    /// The model of [`wedge`](Self::wedge), which is convex and falls with neither argument:
    /// below, a tangent plane is a bound, and above, it is farthest off at a corner.
    #[inline(never)]
    fn wedge_model<const N: usize>(
        &self,
        from_axis: AffineModel<N>,
        from_crest: AffineModel<N>,
    ) -> AffineModel<N> {
        let [r, h] = [from_axis.value, from_crest.value];
        let [by_r, by_h] = Dual::variables([r, h]);
        let Dual { value, gradient } = self.wedge(by_r, by_h);
        let [dr, dh] = [from_axis.deviation(), from_crest.deviation()];
        let mut above = 0.0_f64;
        for [u, v] in [[dr, dh], [dr, -dh], [-dr, dh], [-dr, -dh]] {
            let plane = value + gradient[0] * u + gradient[1] * v;
            above = Scalar::max(above, self.wedge(r + u, h + v) - plane);
        }
        let [radial, axial] = [from_axis.scale(gradient[0]), from_crest.scale(gradient[1])];
        let plane = radial + axial;
        AffineModel { value, upper: plane.upper + above, ..plane }
    }
}

impl Kernel<3> for ScrewThread {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let from_axis = from_axis(p);
        let at = from_axis.max(S::constant(self.root_radius));
        let wedge = self.wedge(at, self.along(p).abs());
        self.beside_wedge(from_axis, p.0[1], wedge)
    }

    const HAS_OWN_MODEL: bool = true;

    /// By the formula or, over cells of half a pitch or where that is wider, by the Lipschitz
    /// constant. A cell that crosses the middle of a root is folded there too.
    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        let y = cell.0[1];
        let value = self.distance(Vector(cell.0.map(|x| x.value)));
        let evaluations = Evaluations { operations: OPERATIONS, size: self.size() };
        let rough = evaluations.by_steepness(value, &cell);
        let half_pitch = 0.5 * self.pitch.abs();
        let along = self.along(cell);
        if along.deviation() >= half_pitch {
            return rough;
        }
        let wall = AffineModel::constant(half_pitch);
        let from_crest = wall - (wall - along.abs()).abs();
        let from_axis = from_axis(cell);
        let fine = if from_axis.minimum() >= self.root_radius {
            let ridge = self.wedge_model(from_axis, from_crest).scale(self.scale);
            self.beside_ridge(from_axis, y, ridge)
        } else {
            let at = from_axis.max(AffineModel::constant(self.root_radius));
            self.beside_wedge(from_axis, y, self.wedge_model(at, from_crest))
        };
        let reach = self.size() + AffineModel::radius(&cell.0);
        let centre = Vector(cell.0.map(|x| x.value)).norm();
        let rounding = OPERATIONS * f64::EPSILON * (reach + centre);
        let width = |model: &AffineModel<N>| model.maximum() - model.minimum();
        if width(&fine) <= width(&rough) {
            AffineModel { lower: fine.lower + rounding, upper: fine.upper + rounding, ..fine }
        } else {
            rough
        }
    }

    fn promise(&self) -> Promise<3> {
        let bounds = turned_bounds(self.radius, self.half_height);
        Promise::exact(Some(bounds), OPERATIONS, self.size()).bound()
    }
}

primitive! {
    ScrewThread, screw_thread, 3,
    about: "A ridge that winds around a cylinder about the y axis; left-handed if its pitch is negative.",
    origin: "centred; a helix about the y axis, a crest at +x",
    parameters: {
        radius: Length = "from the axis to the crests",
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_height,
        pitch: Coordinate = "from crest to crest, negative for a left-handed thread",
        starts: Count = "the number of ridges beside each other, at most 1000",
        profile: Vector = "the width of a crest, the width of a root, and the depth",
    },
    marks: |kernel| {
        let (radius, pitch, root_radius) = (kernel.radius(), kernel.pitch(), kernel.root_radius);
        let [crest, root, depth] = kernel.profile().0;
        let at = |r: f64, y: f64| Vector([r, y, 0.0]);
        let middle = 0.5 * pitch.abs();
        vec![
            Mark::from_origin("radius", at(-radius, 0.0)),
            Mark::height(kernel.height(), root_radius, root_radius),
            Mark::length_between("pitch", at(radius, 0.0), at(radius, -pitch.abs())).right(),
            Mark::length_between("profile", at(radius, -0.5 * crest), at(radius, 0.5 * crest)).of(0),
            Mark::length_between(
                "profile", at(root_radius, middle - 0.5 * root), at(root_radius, middle + 0.5 * root),
            ).of(1),
            Mark::length_between("profile", at(root_radius, middle), at(root_radius + depth, middle)).of(2),
        ]
    },
    example: (0.7, 1.7, 0.5, 2, Vector([0.1, 0.17, 0.15])),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, bound};
    use crate::vector::Point;

    impl Evidence<3> for ScrewThread {
        const SAMPLE: &'static str = r#"{ "radius": 0.035, "height": 0.09, "pitch": -0.02, "starts": 2,
             "profile": [0.004, 0.006, 0.007] }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "–",
            "`radius` of the crests, `height`, `pitch`, `starts`, `profile`: the widths of a crest and of a root along the axis, and the depth",
            "bound",
        )];

        fn definition(&self) -> Definition<3> {
            bound(thread(self))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            let profile = Vector([0.1, 0.2, 0.3]);
            let thread = |pitch, starts, profile| Self::new(1.0, 2.0, pitch, starts, profile);
            vec![
                Self::new(f64::NAN, 2.0, 0.5, 1, profile),
                Self::new(1.0, -2.0, 0.5, 1, profile),
                thread(0.0, 1, profile),
                thread(-1e-20, 1, profile),
                thread(f64::NAN, 1, profile),
                thread(0.5, 0, profile),
                thread(0.5, 1001, profile),
                thread(0.25, 1, profile),
                thread(-0.25, 1, profile),
                thread(0.5, 1, Vector([-0.1, 0.2, 0.3])),
                thread(0.5, 1, Vector([0.1, f64::NAN, 0.3])),
                thread(0.5, 1, Vector([0.1, 0.2, 0.0])),
                thread(0.5, 1, Vector([0.1, 0.2, 1.0])),
            ]
        }
    }

    /// The profile of a thread along its axis.
    #[derive(Clone, Copy)]
    struct Thread {
        radius: f64,
        half: f64,
        pitch: f64,
        lead: f64,
        crest: f64,
        root: f64,
        depth: f64,
    }

    impl Thread {
        /// The radius at `h` along the profile. The middle of a crest is at `h = 0`.
        fn radius(&self, h: f64) -> f64 {
            let from_crest = (h - self.pitch * (h / self.pitch).round()).abs();
            let past = from_crest - 0.5 * self.crest;
            let width = 0.5 * (self.pitch - self.crest - self.root);
            if past <= 0.0 {
                self.radius
            } else if past >= width {
                self.radius - self.depth
            } else {
                self.radius - self.depth * past / width
            }
        }

        fn contains(&self, p: Point<3>) -> bool {
            // Right-handed: from +x towards −z while it climbs.
            let turn = (-p[2]).atan2(p[0]) / TAU;
            p[1].abs() < self.half && p[0].hypot(p[2]) < self.radius(p[1] - self.lead * turn)
        }

        /// Where the helix of the place `h` along the profile is at the height `y`, at `radius`.
        fn at(&self, h: f64, radius: f64, y: f64) -> Point<3> {
            let angle = TAU * (y - h) / self.lead;
            Vector([radius * angle.cos(), y, -radius * angle.sin()])
        }

        /// What the segment of the profile from one place and radius to another sweeps along the
        /// thread, and on both ends.
        fn swept(self, [from, to]: [[f64; 2]; 2]) -> [Patch<3>; 3] {
            let on = move |share: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * share);
            let around = TAU * self.radius / self.lead.abs();
            let across = (to[1] - from[1]).hypot((to[0] - from[0]) * around);
            let along = 2.0 * self.half * 1.0_f64.hypot(around);
            let side = Patch::surface([across, along], move |u, v| {
                let [h, radius] = on(u);
                self.at(h, radius, self.half * (2.0 * v - 1.0))
            });
            let end = |y: f64| {
                Patch::surface([across, self.radius], move |u, v| {
                    let [h, radius] = on(u);
                    self.at(h, radius * v, y)
                })
            };
            [side, end(self.half), end(-self.half)]
        }
    }

    fn thread(kernel: &ScrewThread) -> Definition<3> {
        let [crest, root, depth] = kernel.profile().0;
        let (pitch, starts) = (kernel.pitch(), kernel.starts());
        let thread = Thread {
            radius: kernel.radius(),
            half: 0.5 * kernel.height(),
            pitch: pitch.abs(),
            lead: pitch * f64::from(starts),
            crest,
            root,
            depth,
        };
        let (high, low) = (thread.radius, thread.radius - depth);
        let mut boundary = Vec::new();
        for start in 0..starts {
            let middle = f64::from(start) * thread.pitch;
            let corners = [
                [middle - 0.5 * crest, high],
                [middle + 0.5 * crest, high],
                [middle + 0.5 * (thread.pitch - root), low],
                [middle + 0.5 * (thread.pitch + root), low],
                [middle + thread.pitch - 0.5 * crest, high],
            ];
            for ends in corners.windows(2) {
                boundary.extend(thread.swept([ends[0], ends[1]]));
            }
        }
        Definition::new(boundary, move |p| thread.contains(p))
    }
}
