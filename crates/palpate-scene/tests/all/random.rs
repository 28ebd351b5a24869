// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Random scenes, and arguments that fit each primitive.

use arbitrary::{Result, Unstructured};
use palpate_field::kernel::{Argument, Entry, Parameter, ParameterKind};
use palpate_field::operator::{Boolean, Profile};
use palpate_haptics::{Impact, Layer, Magnet, Material, PopThrough, Texture, TextureKind};
use palpate_scene::{
    Angle, Axis, AxisAngle, Dimension, Factor, Form, FreePlane, GuideCurve, GuideLine,
    GuidePlane, GuideSegment, GuideWell, Motion, Node, Repeat, Row, Rows, Scene, View,
    ViewPlane, WrittenBody, WrittenCoupling, WrittenGuide, WrittenMaterial, WrittenPose,
    WrittenRotation, WrittenTool, WrittenWorkspace,
};

/// A primitive of the catalogue with the keys of its parameters in files.
pub(crate) struct Known {
    pub name: &'static str,
    pub parameters: &'static [Parameter],
    pub arguments: Vec<Argument>,
}

/// All primitives of `D` dimensions with arguments that build, lengths between
/// 0.1 m and 0.9 m.
pub(crate) fn known<const D: usize>(catalogue: &'static [Entry<D>]) -> Vec<Known> {
    let fit = |entry: &'static Entry<D>| {
        (0..10_000_usize).find_map(|attempt| {
            let arguments = arguments::<D>(entry.parameters, attempt);
            entry.build(&arguments).ok().map(|_| arguments)
        })
    };
    catalogue
        .iter()
        .map(|entry| Known {
            name: entry.name,
            parameters: entry.parameters,
            arguments: fit(entry).unwrap_or_else(|| panic!("no arguments fit {}", entry.name)),
        })
        .collect()
}

/// The `attempt`th choice: lengths in another order each time.
fn arguments<const D: usize>(parameters: &[Parameter], attempt: usize) -> Vec<Argument> {
    const LENGTHS: [f64; 5] = [0.9, 0.45, 0.2, 0.1, 0.3];
    let point = |i: usize| -> Vec<f64> {
        let corners =
            [[-0.6, -0.4, -0.3], [0.7, -0.3, -0.2], [0.1, 0.6, -0.1], [0.0, 0.1, 0.7]];
        corners[i % 4][..D].to_vec()
    };
    // The corners of a convex quadrilateral, in space in a plane.
    let flat = |i: usize| -> Vec<f64> {
        let corners =
            [[-0.6, -0.4, -0.2], [0.7, -0.3, -0.15], [0.5, 0.6, 0.3], [-0.4, 0.4, 0.2]];
        corners[i][..D].to_vec()
    };
    let mut digits = attempt;
    let mut next = || {
        let digit = digits % LENGTHS.len();
        digits /= LENGTHS.len();
        digit
    };
    parameters
        .iter()
        .map(|parameter| match parameter.kind {
            ParameterKind::Angle => Argument::Number(100.0_f64.to_radians()),
            ParameterKind::Count => Argument::Count(5 + next() as u32),
            ParameterKind::Vector | ParameterKind::Direction => {
                let shift = next();
                Argument::Vector((0..D).map(|i| LENGTHS[(i + shift) % 5]).collect())
            }
            ParameterKind::Points => Argument::Points(match next() {
                4 => (0..4).map(flat).collect(),
                more => (0..D + more).map(point).collect(),
            }),
            ParameterKind::Rings => Argument::Rings(vec![(0..3).map(point).collect()]),
            _ => Argument::Number(LENGTHS[next()]),
        })
        .collect()
}

impl Known {
    /// The node as files have it: angles in degrees, under keys that say so.
    pub(crate) fn node(&self) -> Node {
        let pairs = self.parameters.iter().zip(&self.arguments);
        Node::primitive(
            self.name,
            pairs.map(|(parameter, argument)| match (parameter.kind, argument) {
                (ParameterKind::Angle, Argument::Number(angle)) => (
                    format!("{}_degrees", parameter.name),
                    Argument::Number(angle.to_degrees()),
                ),
                _ => (parameter.name.to_owned(), argument.clone()),
            }),
        )
    }
}

const PROFILES: [Profile; 7] = [
    Profile::Quadratic,
    Profile::Cubic,
    Profile::Quartic,
    Profile::Circular,
    Profile::Root,
    Profile::Exponential,
    Profile::CircularGeometrical,
];

/// What random scenes are made from.
pub(crate) struct Generator {
    planar: Vec<Known>,
    spatial: Vec<Known>,
}

type Random<'a, 'b> = &'a mut Unstructured<'b>;

impl Generator {
    pub(crate) fn new() -> Self {
        Self { planar: known(Entry::<2>::ALL), spatial: known(Entry::<3>::ALL) }
    }

    /// A scene: most build, some do not.
    pub(crate) fn scene(&self, u: Random) -> Result<Scene> {
        let dimension = if u.arbitrary()? { Dimension::Two } else { Dimension::Three };
        let d = dimension.count();
        let mut scene = Scene::new(dimension);
        scene.description = text(u)?;
        for i in 0..u.int_in_range(0..=3)? {
            let node = self.node(u, d, 3, i)?;
            scene.shapes.insert(shape_name(i), node);
        }
        let shapes = scene.shapes.len();
        for i in 0..u.int_in_range(1..=3)? {
            let mut body = WrittenBody::new(format!("body {i}"), self.node(u, d, 4, shapes)?);
            body.description = text(u)?;
            body.pose = maybe(u, |u| pose(u, d))?;
            body.material = maybe(u, |u| {
                if u.ratio(1, 3)? {
                    let names: Vec<_> = Material::preset_names().collect();
                    return Ok(WrittenMaterial::Preset(u.choose(&names)?.to_string()));
                }
                material(u, d).map(WrittenMaterial::from)
            })?;
            scene.bodies.push(body);
        }
        scene.tool = maybe(u, |u| self.tool(u, d, shapes))?;
        for _ in 0..u.int_in_range(0..=2)? {
            scene.guides.push(guide(u, d)?);
        }
        for _ in 0..u.int_in_range(0..=2)? {
            scene.motions.push(motion(u, d)?);
        }
        for i in 0..u.int_in_range(0..=2)? {
            scene.views.push(view(u, d, i)?);
        }
        Ok(scene)
    }

    /// A shape of dimension `d` at most `depth` deep, that may refer to the first
    /// `shapes` named ones.
    fn node(&self, u: Random, d: usize, depth: usize, shapes: usize) -> Result<Node> {
        let mut node = Node::new(self.form(u, d, depth, shapes)?);
        node.description = text(u)?;
        Ok(node)
    }

    fn form(&self, u: Random, d: usize, depth: usize, shapes: usize) -> Result<Form> {
        if depth == 0 || u.ratio(1, 4)? {
            if shapes > 0 && u.ratio(1, 3)? {
                return Ok(Form::Reference(shape_name(u.choose_index(shapes)?)));
            }
            let list = if d == 2 { &self.planar } else { &self.spatial };
            return Ok(u.choose(list)?.node().form);
        }
        let many = |u: Random| -> Result<Vec<Node>> {
            let count = u.int_in_range(1..=3)?;
            (0..count).map(|_| self.node(u, d, depth - 1, shapes)).collect()
        };
        let of = |u: Random| self.node(u, d, depth - 1, shapes).map(Box::new);
        let two = |u: Random| -> Result<Vec<Node>> {
            (0..2).map(|_| self.node(u, d, depth - 1, shapes)).collect()
        };
        Ok(match u.int_in_range(0..=if d == 3 { 17 } else { 14 })? {
            0 => Form::Union(many(u)?),
            1 => Form::Intersection(many(u)?),
            2 => Form::Difference(many(u)?),
            3 => Form::SymmetricDifference(many(u)?),
            4 => Form::Smooth {
                boolean: *u.choose(&[
                    Boolean::Union,
                    Boolean::Intersection,
                    Boolean::Difference,
                ])?,
                of: many(u)?,
                width: length(u)?,
                profile: maybe(u, |u| Ok(*u.choose(&PROFILES)?))?,
            },
            11 => Form::Displaced { of: two(u)?, height: length(u)? },
            12 => Form::Morphed { of: two(u)?, progress: u.int_in_range(0..=8)? as f64 / 8.0 },
            13 => Form::Bent { rate: rate(u)?, of: of(u)? },
            14 => Form::Repeated { rows: rows(u, d)?, of: of(u)? },
            15 => Form::Twisted { rate: rate(u)?, of: of(u)? },
            5 => Form::Placed {
                translate: Some(numbers(u, d)?),
                rotation: maybe(u, |u| rotation(u, d))?,
                of: of(u)?,
            },
            6 => Form::Scaled {
                factor: if u.arbitrary()? {
                    Factor::Uniform(length(u)?)
                } else {
                    Factor::Axes((0..d).map(|_| length(u)).collect::<Result<_>>()?)
                },
                of: of(u)?,
            },
            7 => Form::Offset { distance: 0.1 * number(u)?, of: of(u)? },
            8 => Form::Shell { thickness: length(u)?, of: of(u)? },
            9 => Form::Elongated {
                lengths: (0..d).map(|_| length(u)).collect::<Result<_>>()?,
                of: of(u)?,
            },
            10 => Form::Mirrored { axis: *u.choose(&[Axis::X, Axis::Y])?, of: of(u)? },
            16 => Form::Extruded {
                height: length(u)?,
                of: Box::new(self.node(u, 2, depth - 1, 0)?),
            },
            _ => Form::Revolved { of: Box::new(self.node(u, 2, depth - 1, 0)?) },
        })
    }

    fn tool(&self, u: Random, d: usize, shapes: usize) -> Result<WrittenTool> {
        let shape = maybe(u, |u| self.node(u, d, 2, shapes))?;
        let points = if shape.is_some() { 0 } else { u.int_in_range(0..=3)? };
        Ok(WrittenTool {
            description: text(u)?,
            radius: length(u)?,
            points: (0..points).map(|_| numbers(u, d)).collect::<Result<_>>()?,
            shape,
            coupling: maybe(u, |u| {
                Ok(WrittenCoupling {
                    description: text(u)?,
                    stiffness: maybe(u, length)?,
                    damping: maybe(u, length)?,
                    angular_stiffness: maybe(u, length)?,
                    angular_damping: maybe(u, length)?,
                })
            })?,
            workspace: maybe(u, |u| {
                let pose = maybe(u, |u| pose(u, d))?;
                Ok(WrittenWorkspace { description: text(u)?, scale: length(u)?, pose })
            })?,
            max_force: maybe(u, length)?,
        })
    }
}

fn shape_name(i: usize) -> String {
    ["plain", "with space", "quo\"ted.[0]", "ünï→"][i % 4].to_owned()
}

/// Something half of the time.
fn maybe<T>(u: Random, make: impl FnOnce(Random) -> Result<T>) -> Result<Option<T>> {
    if u.arbitrary()? { make(u).map(Some) } else { Ok(None) }
}

fn text(u: Random) -> Result<Option<String>> {
    if u.ratio(3, 4)? {
        return Ok(None);
    }
    Ok(Some(u.choose(&["", "plain", "tab\tnewline\n\"quoted\" \\ \u{1} 😀"])?.to_string()))
}

/// A positive number, of any scale.
fn length(u: Random) -> Result<f64> {
    let mantissa = 1.0 + u.int_in_range(0..=u32::MAX)? as f64 / 4_294_967_296.0;
    Ok(mantissa * 10.0_f64.powi(u.int_in_range(-8..=4)?))
}

fn number(u: Random) -> Result<f64> {
    Ok(match u.int_in_range(0..=7)? {
        0 => 0.0,
        1 => -0.0,
        2 => f64::from(u.int_in_range(-3..=3)?),
        3 | 4 => -length(u)?,
        _ => length(u)?,
    })
}

fn numbers(u: Random, count: usize) -> Result<Vec<f64>> {
    (0..count).map(|_| number(u)).collect()
}

fn direction<const N: usize>(u: Random) -> Result<[f64; N]> {
    let mut direction = [0.0; N];
    for x in &mut direction {
        *x = number(u)?;
    }
    direction[0] = length(u)?;
    Ok(direction)
}

/// An angle for each metre.
fn rate(u: Random) -> Result<Angle> {
    let rate = number(u)?;
    Ok(if u.arbitrary()? { Angle::Degrees(rate) } else { Angle::Radians(rate) })
}

/// A matrix that turns by an angle in the plane of the first two axes.
fn matrix(u: Random, d: usize) -> Result<WrittenRotation> {
    let (sin, cos) = number(u)?.sin_cos();
    let rows = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
    Ok(WrittenRotation::Rows(rows[..d].iter().map(|row| row[..d].to_vec()).collect()))
}

fn rotation(u: Random, d: usize) -> Result<WrittenRotation> {
    if u.ratio(1, 4)? {
        return matrix(u, d);
    }
    if d == 2 {
        return number(u).map(WrittenRotation::Degrees);
    }
    Ok(if u.arbitrary()? {
        WrittenRotation::Quaternion(direction(u)?)
    } else {
        let mut turn = AxisAngle::new(direction(u)?, number(u)?);
        turn.description = text(u)?;
        WrittenRotation::AxisAngle(turn)
    })
}

fn pose(u: Random, d: usize) -> Result<WrittenPose> {
    Ok(WrittenPose {
        description: text(u)?,
        translation: maybe(u, |u| numbers(u, d))?,
        rotation: maybe(u, |u| rotation(u, d))?,
    })
}

fn material(u: Random, d: usize) -> Result<Material> {
    let pop = |u: Random| -> Result<PopThrough> {
        Ok(PopThrough { description: text(u)?, force: length(u)?, distance: length(u)? })
    };
    let mut depth = 0.0;
    let layers = (0..u.int_in_range(0..=2)?).map(|_| {
        depth += length(u)?;
        Ok(Layer {
            description: text(u)?,
            depth,
            stiffness: maybe(u, length)?,
            damping: maybe(u, length)?,
            static_friction: None,
            dynamic_friction: None,
            viscosity: maybe(u, length)?,
            pop_through: maybe(u, pop)?,
        })
    });
    let layers = layers.collect::<Result<_>>()?;
    let dynamic_friction = length(u)?;
    Ok(Material {
        description: text(u)?,
        stiffness: length(u)?,
        damping: length(u)?,
        static_friction: dynamic_friction + length(u)?,
        dynamic_friction,
        viscosity: if u.arbitrary()? { 0.0 } else { length(u)? },
        magnet: maybe(u, |u| {
            Ok(Magnet { description: text(u)?, force: length(u)?, distance: length(u)? })
        })?,
        pop_through: maybe(u, pop)?,
        layers,
        texture: maybe(u, |u| {
            Ok(Texture {
                description: text(u)?,
                kind: *u.choose(&[TextureKind::Displacement, TextureKind::Height])?,
                amplitude: length(u)?,
                wavelength: length(u)?,
                direction: maybe(u, |u| Ok(direction::<3>(u)?[..d].to_vec()))?,
            })
        })?,
        impact: maybe(u, |u| {
            Ok(Impact {
                description: text(u)?,
                amplitude: length(u)?,
                frequency: length(u)?,
                decay: length(u)?,
            })
        })?,
    })
}

fn guide(u: Random, d: usize) -> Result<WrittenGuide> {
    let direction = |u: Random| Ok(direction::<3>(u)?[..d].to_vec());
    let (stiffness, max_force) = (length(u)?, length(u)?);
    let snap_distance = maybe(u, length)?;
    let mut guide = WrittenGuide {
        description: text(u)?,
        stiffness,
        damping: length(u)?,
        snap_distance,
        release_distance: snap_distance.map(|snap| 2.0 * snap),
        max_force,
        ..WrittenGuide::default()
    };
    let description = text(u)?;
    match u.int_in_range(0..=5)? {
        0 => guide.point = Some(numbers(u, d)?),
        1 => {
            let (through, direction) = (numbers(u, d)?, direction(u)?);
            guide.line = Some(GuideLine { description, through, direction });
        }
        2 => {
            let (from, to) = (numbers(u, d)?, numbers(u, d)?);
            guide.segment = Some(GuideSegment { description, from, to });
        }
        3 => {
            let (through, normal) = (numbers(u, d)?, direction(u)?);
            guide.plane = Some(GuidePlane { description, through, normal });
        }
        4 => {
            let count = u.int_in_range(2..=5)?;
            let points = (0..count).map(|_| numbers(u, d)).collect::<Result<_>>()?;
            let smooth = u.arbitrary()?;
            guide.curve = Some(GuideCurve { description, points, smooth });
        }
        _ => {
            let reach = 1.5 * max_force / stiffness;
            guide.well = Some(GuideWell { description, center: numbers(u, d)?, reach });
        }
    }
    Ok(guide)
}

fn motion(u: Random, d: usize) -> Result<Motion> {
    Ok(Motion {
        description: text(u)?,
        body: "body 0".to_owned(),
        from: maybe(u, |u| pose(u, d))?,
        to: pose(u, d)?,
        start: if u.arbitrary()? { 0.0 } else { length(u)? },
        duration: length(u)?,
        turns: u.int_in_range(-3..=3)?,
        repeat: *u.choose(&[Repeat::Once, Repeat::Loop, Repeat::BackAndForth])?,
    })
}

fn view(u: Random, d: usize, i: usize) -> Result<View> {
    let plane = if d == 2 {
        None
    } else {
        let free = FreePlane {
            description: text(u)?,
            origin: [0.1, -0.0, 2.0],
            right: [1.0, 0.0, 0.5],
            up: [0.0, length(u)?, 0.0],
        };
        let planes = [ViewPlane::Xy, ViewPlane::Xz, ViewPlane::Yz, ViewPlane::Free(free)];
        maybe(u, |u| Ok(u.choose(&planes)?.clone()))?
    };
    let is_free = matches!(plane, Some(ViewPlane::Free(_)));
    Ok(View {
        name: format!("view {i}"),
        description: text(u)?,
        at: if d == 2 || is_free { None } else { maybe(u, number)? },
        plane,
        center: maybe(u, direction)?,
        width: maybe(u, length)?,
        height: maybe(u, length)?,
        spacing: maybe(u, length)?,
    })
}

/// Rows of copies along at least one axis.
fn rows(u: Random, d: usize) -> Result<Rows> {
    let row = |u: Random| -> Result<Row> {
        let ends = maybe(u, |u| {
            let first = u.int_in_range(-3..=1_i32)?;
            Ok((first, first + u.int_in_range(0..=3_i32)?))
        })?;
        Ok(Row {
            spacing: Some(length(u)?),
            first: ends.map(|(first, _)| first),
            last: ends.map(|(_, last)| last),
        })
    };
    Ok(Rows {
        x: Some(row(u)?),
        y: maybe(u, row)?,
        z: if d == 3 { maybe(u, row)? } else { None },
    })
}
