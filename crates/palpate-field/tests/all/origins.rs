// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the catalogue says that the origin of a primitive is, and which way it points: each
//! phrase is held against the example.

use palpate_field::catalogue::Entry;
use palpate_field::kernel::{Argument, MarkKind};
use palpate_field::{Shape, ShapeError, Vector};

/// The rounding of the fields [m].
const TOLERANCE: f64 = 1e-12;
/// A step beside a tip, and from a side [m].
const BESIDE: f64 = 0.05;
/// How much larger than the shape a box may be [m]: that of a prism holds the circle around it.
const LOOSE: f64 = 0.1;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A primitive's example; one of the plane is one of space that is the same at every z.
struct Example {
    name: &'static str,
    distance: Box<dyn Fn([f64; 3]) -> f64>,
    /// The corners of the box around it.
    bounds: Option<[[f64; 3]; 2]>,
    /// The lengths with their ends.
    lengths: Vec<(String, [[f64; 3]; 2])>,
    positions: Vec<(String, [f64; 3])>,
    vectors: Vec<(&'static str, [f64; 3])>,
    numbers: Vec<(&'static str, f64)>,
    counts: Vec<(&'static str, u32)>,
    is_spatial: bool,
}

impl Example {
    fn of<const D: usize>(entry: &Entry<D>) -> Result<Self, ShapeError> {
        let (shape, arguments): (Shape<D>, _) = (entry.example()?, entry.example_arguments()?);
        let bounds = shape.promise().bounds.map(|bounds| bounds.aabb);
        let of_kind = |kind| {
            let marks = entry.marks(&arguments);
            marks.map(|marks| marks.into_iter().filter(move |mark| mark.kind == kind))
        };
        let named = || entry.parameters.iter().map(|p| p.name).zip(&arguments);
        Ok(Self {
            name: entry.name,
            bounds: bounds.map(|aabb| [aabb.min, aabb.max].map(|p| p.in_space().0)),
            lengths: of_kind(MarkKind::Length)?
                .map(|m| (m.name(), [m.points[0], m.points[1]].map(|p| p.in_space().0)))
                .collect(),
            positions: of_kind(MarkKind::Position)?
                .map(|m| (m.name(), m.points[0].in_space().0))
                .collect(),
            vectors: named()
                .filter_map(|(name, argument)| match argument {
                    Argument::Vector(v) => {
                        let v = Vector::<f64, D>(v[..].try_into().ok()?);
                        Some((name, v.in_space().0))
                    }
                    _ => None,
                })
                .collect(),
            numbers: named()
                .filter_map(|(name, argument)| match argument {
                    Argument::Number(number) => Some((name, *number)),
                    _ => None,
                })
                .collect(),
            counts: named()
                .filter_map(|(name, argument)| match argument {
                    Argument::Count(count) => Some((name, *count)),
                    _ => None,
                })
                .collect(),
            distance: Box::new(move |p| shape.distance(Vector(p).truncated())),
            is_spatial: D == 3,
        })
    }

    fn at(&self, p: [f64; 3]) -> f64 {
        (self.distance)(p)
    }

    fn passes(&self, p: [f64; 3]) -> bool {
        self.at(p).abs() < TOLERANCE
    }

    fn min(&self) -> [f64; 3] {
        self.bounds.expect("a bounded example")[0]
    }

    fn max(&self) -> [f64; 3] {
        self.bounds.expect("a bounded example")[1]
    }

    /// The axes that the example has.
    fn axes(&self) -> &'static [usize] {
        if self.is_spatial { &[0, 1, 2] } else { &[0, 1] }
    }

    /// `true` if the box is as large on both sides of the origin along an axis.
    fn is_centred_along(&self, axis: usize) -> bool {
        let [min, max] = [self.min()[axis], self.max()[axis]];
        (min + max).abs() < TOLERANCE && self.is_tight(axis)
    }

    /// `true` if the surface is next to both ends of the box, so that it says where the shape is.
    fn is_tight(&self, axis: usize) -> bool {
        let sides = [self.min()[axis], self.max()[axis]];
        sides.into_iter().all(|side| self.nearest_on(axis, side) < LOOSE)
    }

    /// The least distance on the plane where a coordinate is `at`, by samples.
    fn nearest_on(&self, axis: usize, at: f64) -> f64 {
        let steps = 60;
        let place = |i: usize, axis: usize| {
            let [min, max] = [self.min()[axis], self.max()[axis]];
            min + (max - min) * i as f64 / f64::from(steps)
        };
        let mut nearest = f64::INFINITY;
        for i in 0..=steps as usize {
            for j in 0..=steps as usize {
                let mut p = [0.0; 3];
                p[axis] = at;
                p[(axis + 1) % 3] = place(i, (axis + 1) % 3);
                p[(axis + 2) % 3] = place(j, (axis + 2) % 3);
                nearest = nearest.min(self.at(p));
            }
        }
        nearest
    }

    /// `true` if the field is the same at points and at those that `map` gives.
    fn is_same(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> bool {
        (0..200).all(|i| {
            // Multiples of irrational numbers: nowhere near each other, on no plane of symmetry.
            let share = |k: f64| (f64::from(i) * k).fract() * 2.4 - 1.2;
            let p = [share(0.618_034), share(0.414_214), share(0.732_051)];
            (self.at(p) - self.at(map(p))).abs() < TOLERANCE
        })
    }

    fn is_mirrored(&self, axis: usize) -> bool {
        self.is_same(|mut p| {
            p[axis] = -p[axis];
            p
        })
    }

    /// `true` if a turn about y keeps the field.
    fn is_turned(&self, angle: f64) -> bool {
        let (sin, cos) = angle.sin_cos();
        self.is_same(|[x, y, z]| [cos * x + sin * z, y, cos * z - sin * x])
    }

    /// `true` if the box touches the surface at the middle of a side, at `end` of `direction`.
    fn touches_on(&self, direction: [f64; 3], sign: f64) -> bool {
        let axis = direction.iter().position(|x| *x != 0.0).expect("an axis");
        let end = if sign > 0.0 { self.max()[axis] } else { self.min()[axis] };
        self.passes(direction.map(|x| x * end))
    }

    /// `true` if there is a single point of the surface at that end of the axis.
    fn has_tip(&self, direction: [f64; 3], sign: f64) -> bool {
        let axis = direction.iter().position(|x| *x != 0.0).expect("an axis");
        let end = if sign > 0.0 { self.max()[axis] } else { self.min()[axis] };
        let beside = |step: f64| {
            let mut p = direction.map(|x| x * end);
            p[(axis + 1) % 3 % self.axes().len()] += step;
            self.at(p)
        };
        self.touches_on(direction, sign)
            && beside(BESIDE) > TOLERANCE
            && beside(-BESIDE) > TOLERANCE
    }

    fn has_flat_bottom(&self) -> bool {
        let y = self.min()[1];
        [-BESIDE, 0.0, BESIDE].into_iter().all(|x| self.passes([x, y, 0.0]))
    }

    /// The ends of the length called `name`.
    fn ends(&self, name: &str) -> [[f64; 3]; 2] {
        let found = self.lengths.iter().find(|(known, _)| known == name);
        found.unwrap_or_else(|| panic!("{} has no {name}", self.name)).1
    }

    /// `true` if a radius starts at the origin.
    fn has_radius_from_origin(&self) -> bool {
        let is_one =
            |name: &str, ends: &[[f64; 3]; 2]| name.contains("radius") && ends[0] == [0.0; 3];
        self.lengths.iter().any(|(name, ends)| is_one(name, ends))
    }

    fn number(&self, name: &str) -> f64 {
        let found = self.numbers.iter().find(|(known, _)| *known == name);
        found.unwrap_or_else(|| panic!("{} has no {name}", self.name)).1
    }

    fn count(&self, name: &str) -> f64 {
        let found = self.counts.iter().find(|(known, _)| *known == name);
        f64::from(found.unwrap_or_else(|| panic!("{} has no {name}", self.name)).1)
    }

    fn vector(&self, name: &str) -> [f64; 3] {
        let found = self.vectors.iter().find(|(known, _)| *known == name);
        found.unwrap_or_else(|| panic!("{} has no {name}", self.name)).1
    }

    /// The largest radius of a ring about the origin.
    fn ring(&self) -> f64 {
        let rings = ["ring_radius", "outer_radius"];
        let known = self.numbers.iter().filter(|(name, _)| rings.contains(name));
        known.map(|(_, radius)| *radius).fold(0.0, f64::max)
    }

    /// `true` if there is more inside on one side of the origin, along an axis, than on the other.
    fn is_open(&self, axis: usize) -> bool {
        let [mut there, mut here] = [[0.0; 3]; 2];
        (here[axis], there[axis]) = (self.ring(), -self.ring());
        self.at(here) <= TOLERANCE && self.at(there) > TOLERANCE
    }

    fn reaches_box_on(&self, axes: [[f64; 3]; 2]) -> bool {
        axes.into_iter().all(|axis| self.touches_on(axis, 1.0) && self.touches_on(axis, -1.0))
    }

    fn bounded(&self) -> bool {
        self.bounds.is_some()
    }
}

/// What `phrase` says of `example`; `None` if there is no rule for it.
fn holds(example: &Example, phrase: &str) -> Option<bool> {
    let e = example;
    let third = std::f64::consts::TAU / 3.0;
    Some(match phrase {
        "centred" => e.axes().iter().all(|axis| e.is_centred_along(*axis)),
        "at half its height" => e.is_centred_along(1),
        "axis along y" => {
            let turns = e.is_turned(third) || e.is_turned(std::f64::consts::PI);
            // An arc of a ring has an axis, too.
            e.is_mirrored(0) && (turns || e.is_mirrored(1))
        }
        "a helix about the y axis" => {
            // Away from its ends.
            let rise = 0.2 / std::f64::consts::TAU * e.number("pitch") * e.count("starts");
            let (sin, cos) = 0.2_f64.sin_cos();
            e.is_same(|[x, y, z]| {
                let far = y.abs() > 0.3;
                let on = [cos * x + sin * z, y + rise, cos * z - sin * x];
                if far { [x, y, z] } else { on }
            })
        }
        "a crest at +x" => {
            let radius = e.number("radius");
            e.passes([radius, 0.0, 0.0]) && e.at([radius - BESIDE, BESIDE, 0.0]) < 0.0
        }
        "about the y axis" => e.is_turned(0.7),
        "its length along y" => e.axes().iter().all(|i| *i == 1 || e.max()[*i] < e.max()[1]),
        "straight sides along z" => e.max()[2] > e.max()[0] && e.ends("length")[0][2] < 0.0,
        "edges along the axes" => {
            let half = e.max();
            // A frame has its surface at the edges alone.
            let faces = e.axes().iter().all(|i| {
                let beside = (i + 1) % e.axes().len();
                let mut face = [0.0; 3];
                face[*i] = half[*i];
                let mut edge = face;
                edge[beside] = half[beside];
                e.passes(face) || e.passes(edge)
            });
            faces && e.axes().iter().all(|i| e.is_mirrored(*i) || e.name == "rounded_rectangle")
        }
        "two edges along x" => {
            let [[_, bottom, _], _] = [e.min(), e.max()];
            let on_edge = |x: f64| e.passes([x, bottom, 0.0]) && e.passes([-x, -bottom, 0.0]);
            on_edge(e.min()[0] + BESIDE) && on_edge(0.0)
        }
        "bars along the axes" | "diagonals along the axes" | "radii along the axes" => {
            e.reaches_box_on([X, Y]) && (!e.is_spatial || e.reaches_box_on([Y, Z]))
        }
        "corners on the axes" => [X, Y, Z].iter().all(|axis| e.has_tip(*axis, 1.0)),
        "diagonals along x and z" => e.has_tip(Z, 1.0) && e.reaches_box_on([X, Z]),
        "two corners on z" => e.has_tip(Z, 1.0) && e.has_tip(Z, -1.0),
        "a corner towards +z" => e.has_tip(Z, 1.0) && !e.has_tip(Z, -1.0),
        "a base with edges along x and z" => {
            let ([_, bottom, _], half) = (e.min(), 0.5 * e.number("side"));
            let is_corner = |x: f64, z: f64| e.passes([x, bottom, z]);
            is_corner(half, half) && is_corner(-half, half) && e.has_flat_bottom()
        }
        "strokes along the diagonals" => {
            let corner = e.max()[0];
            e.at([0.5 * corner, 0.5 * corner, 0.0]) < 0.0 && e.at([corner, 0.0, 0.0]) > 0.0
        }
        "given by its points" => {
            let points = e.positions.iter().filter(|(name, _)| name != "control");
            e.positions.len() > 1 && points.into_iter().all(|(_, p)| e.at(*p) <= TOLERANCE)
        }
        "a tip up" => e.has_tip(Y, 1.0),
        "a tip down" => e.has_tip(Y, -1.0),
        "a flat side down" => e.has_flat_bottom(),
        "hollow upwards" => e.at([0.0, e.max()[1], 0.0]) > BESIDE && e.is_mirrored(0),
        "the thin end up" => {
            let [low, high] = [e.min()[1], e.max()[1]];
            let x = 0.5 * e.max()[0];
            e.at([x, high - 2.0 * BESIDE, 0.0]) > e.at([x, low + 2.0 * BESIDE, 0.0])
        }
        "spread about +y" => e.is_mirrored(0) && e.max()[1] > -e.min()[1],
        "rising to the right" => {
            let [[left, bottom, _], [right, top, _]] = [e.min(), e.max()];
            e.at([left, top, 0.0]) > BESIDE
                && [[right, top], [left, bottom]]
                    .iter()
                    .all(|[x, y]| e.at([*x, *y, 0.0]) < BESIDE)
        }
        "open downwards" => e.is_open(1) && e.is_mirrored(0),
        "open towards -z" => e.is_open(2) && e.is_mirrored(0),
        "at the centre of its circle"
        | "at the centre of its disc"
        | "at the centre of its ring"
        | "at the centre of its arc"
        | "at the centre of its ball"
        | "at the centre of its sphere" => e.has_radius_from_origin(),
        "at the centre of its bottom circle" => e.ends("bottom_radius")[0] == [0.0; 3],
        "at the centre of its triangle" => e.is_turned(third),
        "midway between its centres" => {
            let [from, to] = e.ends("height");
            (0..3).all(|i| from[i] == -to[i]) && from[1] < 0.0
        }
        "the bottom disc down" | "the bottom ball down" => {
            let y = -0.5 * e.number("height") - e.number("bottom_radius");
            e.passes([0.0, y, 0.0])
        }
        "`bottom_radius` below" => {
            e.passes([e.number("bottom_radius"), -0.5 * e.number("height"), 0.0])
        }
        "at its vertex" | "at its tip" => e.passes([0.0; 3]),
        "opening upwards" => e.at(Y) < 0.0 && e.at([0.0, -1.0, 0.0]) > 0.0,
        "opening downwards" => e.at([0.0, -1.0, 0.0]) < 0.0 && e.at(Y) > 0.0,
        "endless" => !e.bounded(),
        "endless along y" => !e.bounded() && e.is_same(|[x, y, z]| [x, y + 7.0, z]),
        "endless along x" => {
            let wave = 4.0 * e.number("ring_radius") * (0.5 * e.number("angle")).sin();
            !e.bounded() && e.is_same(|[x, y, z]| [x + wave, y, z])
        }
        "a crest at x = 0" => {
            let top =
                e.ends("ring_radius")[0][1] + e.number("ring_radius") + e.number("radius");
            e.passes([0.0, top, 0.0]) && e.at([BESIDE, top, 0.0]) > 0.0
        }
        "arcs that meet at y = 0" => {
            let end = e.number("ring_radius") * (0.5 * e.number("angle")).sin();
            e.is_same(|[x, y, z]| [2.0 * end - x, -y, z])
        }
        "at the middle of both vertices" => e.passes([0.0, e.vector("radii")[1], 0.0]),
        "the branch above" => e.at([0.0, 3.0, 0.0]) < 0.0 && e.at([0.0, -3.0, 0.0]) > 0.0,
        "`offset` from the origin along `normal`" => {
            let normal = Vector(e.vector("normal")).normalized()?;
            e.passes((normal * e.number("offset")).0)
        }
        "which points out" => e.at(e.vector("normal").map(|x| 10.0 * x)) > 0.0,
        _ => return None,
    })
}

fn check<const D: usize>() -> Result<Vec<String>, ShapeError> {
    let mut wrong = Vec::new();
    for entry in Entry::<D>::all() {
        let example = Example::of(entry)?;
        for phrase in entry.origin.split("; ").flat_map(|part| part.split(", ")) {
            match holds(&example, phrase) {
                Some(true) => {}
                Some(false) => wrong.push(format!("{} ({D}D) is not: {phrase}", entry.name)),
                None => wrong.push(format!("{} ({D}D): no rule for: {phrase}", entry.name)),
            }
        }
    }
    Ok(wrong)
}

#[test]
fn what_is_said_of_origins_holds() -> Result<(), ShapeError> {
    assert_eq!([check::<2>()?, check::<3>()?].concat(), Vec::<String>::new());
    Ok(())
}
