// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Random scenes, and arguments that fit each primitive.

use arbitrary::{Result, Unstructured};
use palpate_field::catalogue::Entry;
use palpate_field::kernel::{Argument, Parameter, ParameterKind};
use palpate_field::operator::Operator;
use palpate_haptics::{Impact, Layer, Magnet, Material, PopThrough, Texture, TextureKind};
use palpate_scene::{
    AxisAngle, Dimension, FreePlane, GuideCurve, GuideLine, GuidePlane, GuideSegment,
    GuideWell, Repeat, Scene, ViewPlane, WrittenBody, WrittenCoupling, WrittenGuide,
    WrittenMaterial, WrittenMotion, WrittenPose, WrittenRotation, WrittenShape, WrittenTool,
    WrittenView, WrittenWorkspace,
};
use serde_json::{Map, Value, json};

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
    /// The primitive as files have it: angles in degrees, under keys that say so.
    pub(crate) fn object(&self) -> Map<String, Value> {
        let mut arguments = Map::new();
        for (parameter, argument) in self.parameters.iter().zip(&self.arguments) {
            let name = parameter.name;
            match (parameter.kind, argument) {
                (ParameterKind::Angle, Argument::Number(angle)) => {
                    arguments.insert(format!("{name}_degrees"), json!(angle.to_degrees()))
                }
                (_, Argument::Number(number)) => arguments.insert(name.into(), json!(number)),
                (_, Argument::Count(count)) => arguments.insert(name.into(), json!(count)),
                (_, Argument::Vector(vector)) => arguments.insert(name.into(), json!(vector)),
                (_, Argument::Points(points)) => arguments.insert(name.into(), json!(points)),
                (_, Argument::Rings(rings)) => arguments.insert(name.into(), json!(rings)),
            };
        }
        Map::from_iter([(self.name.to_owned(), Value::Object(arguments))])
    }
}

const PROFILES: [&str; 7] = [
    "quadratic",
    "cubic",
    "quartic",
    "circular",
    "root",
    "exponential",
    "circular_geometrical",
];

/// A shape of a scene.
pub(crate) fn written(json: &Value) -> WrittenShape {
    WrittenShape::from_json(&json.to_string()).unwrap()
}

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
            let shape = written(&self.shape(u, d, 3, i)?);
            scene.shapes.insert(shape_name(i), shape);
        }
        let shapes = scene.shapes.len();
        for i in 0..u.int_in_range(1..=3)? {
            let shape = written(&self.shape(u, d, 4, shapes)?);
            let mut body = WrittenBody::new(format!("body {i}"), shape);
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
    fn shape(&self, u: Random, d: usize, depth: usize, shapes: usize) -> Result<Value> {
        if depth == 0 || u.ratio(1, 4)? {
            if shapes > 0 && u.ratio(1, 3)? {
                let name = shape_name(u.choose_index(shapes)?);
                return Ok(if u.arbitrary()? { json!(name) } else { json!({ "shape": name }) });
            }
            let list = if d == 2 { &self.planar } else { &self.spatial };
            let object = u.choose(list)?.object();
            return described(u, object);
        }
        let mut object = Map::new();
        let mut put = |key: &str, value: Value| drop(object.insert(key.to_owned(), value));
        let operator = u.int_in_range(0..=if d == 3 { 17 } else { 14 })?;
        match operator {
            0..=3 => {
                let lists = ["union", "intersection", "difference", "symmetric_difference"];
                put(lists[operator], self.shapes(u, d, depth, shapes)?);
            }
            4 => {
                let lists = ["smooth_union", "smooth_intersection", "smooth_difference"];
                put("width", json!(length(u)?));
                if let Some(profile) = maybe(u, |u| Ok(*u.choose(&PROFILES)?))? {
                    put("profile", json!(profile));
                }
                put(u.choose(&lists)?, self.shapes(u, d, depth, shapes)?);
            }
            5 | 6 => {
                let mut shape = || self.shape(u, d, depth - 1, shapes);
                let two = json!([shape()?, shape()?]);
                if operator == 5 {
                    put("height", json!(length(u)?));
                    put("displace", two);
                } else {
                    put("progress", json!(u.int_in_range(0..=8)? as f64 / 8.0));
                    put("morph", two);
                }
            }
            7 => {
                put("translate", json!(numbers(u, d)?));
                let rotation = maybe(u, |u| rotation(u, d))?;
                let mut pose = WrittenPose::default();
                pose.rotation = rotation;
                let pose = serde_json::to_value(pose).unwrap();
                pose.as_object().unwrap().iter().for_each(|(key, turn)| put(key, turn.clone()));
            }
            8 if u.arbitrary()? => put("scale", json!(length(u)?)),
            8 => put("scale", json!(lengths(u, d)?)),
            9 => put("offset", json!(0.1 * number(u)?)),
            10 | 11 => {
                let operator = u.choose(Operator::ALL)?;
                let argument = if operator.is_per_axis {
                    json!(lengths(u, d)?)
                } else {
                    json!(length(u)?)
                };
                put(operator.name, argument);
            }
            12 => put("mirror", json!(u.choose(&["x", "y"])?)),
            13 => put(u.choose(&["bend", "bend_degrees"])?, json!(number(u)?)),
            14 => put("repeat", rows(u, d)?),
            15 => put(u.choose(&["twist", "twist_degrees"])?, json!(number(u)?)),
            16 => put("extrude", json!(length(u)?)),
            _ => put("revolve", json!("y")),
        }
        match operator {
            0..=6 => {}
            16.. => put("of", self.shape(u, 2, depth - 1, 0)?),
            _ => put("of", self.shape(u, d, depth - 1, shapes)?),
        }
        described(u, object)
    }

    /// One to three shapes.
    fn shapes(&self, u: Random, d: usize, depth: usize, shapes: usize) -> Result<Value> {
        let count = u.int_in_range(1..=3)?;
        (0..count).map(|_| self.shape(u, d, depth - 1, shapes)).collect()
    }

    fn tool(&self, u: Random, d: usize, shapes: usize) -> Result<WrittenTool> {
        let shape = maybe(u, |u| Ok(written(&self.shape(u, d, 2, shapes)?)))?;
        let points = if shape.is_some() { 0 } else { u.int_in_range(0..=3)? };
        let mut tool = WrittenTool::default();
        tool.description = text(u)?;
        tool.radius = Some(length(u)?);
        tool.points = (0..points).map(|_| numbers(u, d)).collect::<Result<_>>()?;
        tool.shape = shape;
        tool.coupling = maybe(u, coupling)?;
        tool.workspace = maybe(u, |u| workspace(u, d))?;
        tool.max_force = maybe(u, length)?;
        tool.drive_power = maybe(u, length)?;
        tool.actuator = maybe(u, |u| Ok(u.choose(&["erm", "lra"])?.to_string()))?;
        Ok(tool)
    }
}

fn coupling(u: Random) -> Result<WrittenCoupling> {
    let mut coupling = WrittenCoupling::default();
    coupling.description = text(u)?;
    coupling.stiffness = maybe(u, length)?;
    coupling.damping = maybe(u, length)?;
    coupling.angular_stiffness = maybe(u, length)?;
    coupling.angular_damping = maybe(u, length)?;
    Ok(coupling)
}

fn workspace(u: Random, d: usize) -> Result<WrittenWorkspace> {
    let mut workspace = WrittenWorkspace::default();
    workspace.pose = maybe(u, |u| pose(u, d))?;
    workspace.description = text(u)?;
    workspace.scale = length(u)?;
    Ok(workspace)
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

/// The object, a quarter of the time with a description, first or last.
fn described(u: Random, mut object: Map<String, Value>) -> Result<Value> {
    if let Some(text) = text(u)? {
        let place = if u.arbitrary()? { 0 } else { object.len() };
        object.shift_insert(place, "description".to_owned(), json!(text));
    }
    Ok(Value::Object(object))
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

fn lengths(u: Random, count: usize) -> Result<Vec<f64>> {
    (0..count).map(|_| length(u)).collect()
}

fn direction<const N: usize>(u: Random) -> Result<[f64; N]> {
    let mut direction = [0.0; N];
    for x in &mut direction {
        *x = number(u)?;
    }
    direction[0] = length(u)?;
    Ok(direction)
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
    let mut pose = WrittenPose::default();
    pose.description = text(u)?;
    pose.translation = maybe(u, |u| numbers(u, d))?;
    pose.rotation = maybe(u, |u| rotation(u, d))?;
    Ok(pose)
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
        relative_stiffness: maybe(u, |u| Ok(f64::from(u.int_in_range(1..=64_u8)?) / 64.0))?,
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
        seam: maybe(u, length)?,
    })
}

fn guide(u: Random, d: usize) -> Result<WrittenGuide> {
    let direction = |u: Random| Ok(direction::<3>(u)?[..d].to_vec());
    let (stiffness, max_force) = (length(u)?, length(u)?);
    let snap_distance = maybe(u, length)?;
    let mut guide = WrittenGuide::default();
    guide.description = text(u)?;
    (guide.stiffness, guide.max_force) = (stiffness, max_force);
    guide.damping = length(u)?;
    guide.snap_distance = snap_distance;
    guide.release_distance = snap_distance.map(|snap| 2.0 * snap);
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

fn motion(u: Random, d: usize) -> Result<WrittenMotion> {
    let mut motion = WrittenMotion::new("body 0", pose(u, d)?);
    motion.description = text(u)?;
    motion.from = maybe(u, |u| pose(u, d))?;
    motion.start = if u.arbitrary()? { 0.0 } else { length(u)? };
    motion.duration = length(u)?;
    motion.turns = u.int_in_range(-3..=3)?;
    motion.repeat = *u.choose(&[Repeat::Once, Repeat::Loop, Repeat::BackAndForth])?;
    Ok(motion)
}

fn view(u: Random, d: usize, i: usize) -> Result<WrittenView> {
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
    let mut view = WrittenView::new(format!("view {i}"));
    view.description = text(u)?;
    view.at = if d == 2 || is_free { None } else { maybe(u, number)? };
    view.plane = plane;
    view.center = maybe(u, direction)?;
    view.width = maybe(u, length)?;
    view.height = maybe(u, length)?;
    view.spacing = maybe(u, length)?;
    Ok(view)
}

/// Rows of copies along at least one axis.
fn rows(u: Random, d: usize) -> Result<Value> {
    let mut rows = Map::new();
    for axis in ["x", "y", "z"].into_iter().take(d) {
        if axis != "x" && u.arbitrary()? {
            continue;
        }
        let mut row = json!({ "spacing": length(u)? });
        if u.arbitrary()? {
            let first = u.int_in_range(-3..=1_i32)?;
            row["first"] = json!(first);
            row["last"] = json!(first + u.int_in_range(0..=3_i32)?);
        }
        rows.insert(axis.to_owned(), row);
    }
    Ok(Value::Object(rows))
}
