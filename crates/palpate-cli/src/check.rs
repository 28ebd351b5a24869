// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate check`: checks a scene file.

use std::fmt;
use std::path::PathBuf;

use clap::Args;
use palpate::field::Vector;
use palpate::mesh::Findings;
use palpate::scene::text::rounded;
use palpate::scene::{
    AnyScene, BuiltMesh, BuiltScene, Samples, Scene, SceneError, SceneProblem, is_empty,
};
use serde::Serialize;

use crate::answers::Bounds;
use crate::arguments::Reading;
use crate::input::{Bakes, folder, longest_edge, other_than_scene};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, counted, shown};
use crate::unfelt;
use crate::units::hint;

pub(crate) fn run(options: &CheckOptions) -> Result<Outcome, Failure> {
    let bytes = options.reading.bytes(&options.scene)?;
    let mut out = output::answer();
    let name = options.scene.display().to_string();
    let bakes = Bakes::new(Some(folder(&options.scene)));
    let built = Scene::from_bytes_in(&bytes, bakes.resources.clone());
    match built.and_then(|scene| scene.build()) {
        Err(error) => {
            let other = other_than_scene(&options.scene, &bytes);
            out.print(&Refused::of(name, other, &error), options.json)?;
            Ok(Outcome::No)
        }
        Ok(world) => {
            let answer = match &world {
                AnyScene::Planar(scene) => Answer::of(name, scene),
                AnyScene::Spatial(scene) => Answer::of(name, scene),
            };
            let outcome = if answer.ok { Outcome::Yes } else { Outcome::No };
            out.print(&answer, options.json)?;
            Ok(outcome)
        }
    }
}

/// The answer of `palpate check` about a scene that cannot be used.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Refused {
    #[serde(skip)]
    name: String,
    /// Always `false`: the scene cannot be used.
    pub(crate) ok: bool,
    /// What is wrong.
    pub(crate) problems: Vec<Problem>,
    /// `true` if there may be further problems.
    pub(crate) maybe_more: bool,
    /// All of it in words.
    #[serde(skip)]
    said: String,
}

/// One thing that is wrong with a scene.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Problem {
    /// Where in the scene: keys joined by dots, places in lists in brackets; empty for the whole.
    pub(crate) path: String,
    /// The line, from 1; 0 for the whole.
    pub(crate) line: usize,
    /// The column in characters, from 1; 0 for the whole.
    pub(crate) column: usize,
    /// What is wrong there, in words.
    pub(crate) problem: String,
}

impl Refused {
    /// `other` says what the file is instead of a scene.
    fn of(name: String, other: Option<String>, error: &SceneError) -> Self {
        let told = |SceneProblem { path, line, column, problem, .. }: &SceneProblem| Problem {
            path: path.clone(),
            line: *line,
            column: *column,
            problem: problem.clone(),
        };
        let maybe_more = other.is_none() && !error.is_all();
        let said = other.clone().unwrap_or_else(|| error.to_string());
        let problems = match other {
            Some(problem) => vec![Problem { path: String::new(), line: 0, column: 0, problem }],
            None => error.problems().map(told).collect(),
        };
        Self { name, ok: false, problems, maybe_more, said }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", shown(&self.name), self.said)
    }
}

/// The answer of `palpate check` about a scene that can be used.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    #[serde(skip)]
    name: String,
    /// `false` if the repair of a mesh is a guess: the scene can be used, and its thing may differ.
    pub(crate) ok: bool,
    /// 2 for the plane, 3 for space.
    pub(crate) dimension: usize,
    /// The bodies.
    pub(crate) bodies: Vec<Body>,
    /// The meshes and volumes.
    pub(crate) meshes: Vec<Mesh>,
    /// The moments at which motions put a body somewhere else at once.
    pub(crate) jumps: Vec<Jump>,
    /// Motions that go nowhere, and motions faster than a hand follows.
    pub(crate) odd_motions: Vec<OddMotion>,
}

/// Faster than this, a body that meets a hand gives it a blow [m/s].
const FAST: f64 = 2.0;

/// A motion that goes nowhere, or one faster than a hand follows.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct OddMotion {
    /// The name of the body.
    pub(crate) body: String,
    /// When the motion begins [s].
    pub(crate) start: f64,
    /// The fastest speed of a point of the body [m/s]; zero if the motion goes nowhere.
    pub(crate) speed: f64,
}

impl fmt::Display for OddMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { body, start, speed } = self;
        write!(f, "the motion of body \"{}\" from {start} s on ", shown(body))?;
        if *speed == 0.0 {
            return write!(
                f,
                "goes nowhere: its ends are one pose; \"turns\" gives whole turns"
            );
        }
        write!(
            f,
            "moves points of the body at up to {speed:.3} m/s: a hand that it meets faster than {FAST} m/s \
             gets a blow"
        )
    }
}

/// A moment at which a motion puts a body somewhere else at once.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Jump {
    /// The name of the body.
    pub(crate) body: String,
    /// When it jumps first [s].
    pub(crate) time: f64,
    /// How far its origin jumps [m].
    pub(crate) distance: f64,
    /// By what angle it jumps [rad].
    pub(crate) angle: f64,
    /// The time between two jumps of a loop [s]; `null` if it jumps once.
    pub(crate) period: Option<f64>,
}

impl fmt::Display for Jump {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { body, time, distance, angle, period } = self;
        write!(
            f,
            "body \"{}\" jumps at {time} s, by {distance:.6} m and {angle:.6} rad",
            shown(body)
        )?;
        match period {
            Some(period) => write!(
                f,
                ", and again each {period} s: the loop does not end where it begins; \
                 \"repeat\": \"back_and_forth\" goes back without a jump"
            ),
            None => write!(
                f,
                ": the motion begins elsewhere than where the body is then; without \"from\" it begins \
                 at the body's pose"
            ),
        }
    }
}

/// A body of a scene.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Body {
    /// Its name.
    pub(crate) name: String,
    /// What its distance promises, in words.
    pub(crate) promise: String,
    /// The steepest slope of its distance.
    pub(crate) lipschitz: f64,
    /// The box around it; `null` if it has none.
    pub(crate) bounds: Option<Bounds>,
    /// How deep its operators are nested.
    pub(crate) depth: usize,
    /// `true` if it is proven that no point is in the body, `null` if none was found.
    pub(crate) is_empty: Option<bool>,
    /// The name of a body within which it is proven to lie wholly, so that it cannot be felt; `null`
    /// if there is none, or none is proven.
    pub(crate) hidden_in: Option<String>,
}

/// A mesh or a volume of a scene.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Mesh {
    /// The file; `null` of a mesh whose vertices and faces stand in the scene.
    pub(crate) file: Option<String>,
    /// Metres for a unit of the file; of a volume, whose head tells lengths, a factor.
    pub(crate) scale: f64,
    /// The grid of the file that is the volume, where the scene names it.
    pub(crate) grid: Option<String>,
    /// The value of the surface in a volume.
    pub(crate) value: Option<f64>,
    /// The thickness of the plate that a sheet makes [m]; `null` of a solid.
    pub(crate) thickness: Option<f64>,
    /// The box around it; `null` if it has none.
    pub(crate) bounds: Option<Bounds>,
    /// The faces of the mesh.
    pub(crate) faces: usize,
    /// Vertices equal to another, merged with it.
    pub(crate) welded: usize,
    /// Vertices joined with another a rounding away, or within `weld_within`, where that closed edges.
    pub(crate) joined: usize,
    /// How far the surface was moved by that at most [m].
    pub(crate) moved: f64,
    /// The cracks that joining corners would close; `null` if there are none.
    pub(crate) cracks: Option<Cracks>,
    /// Faces with a vertex twice, dropped.
    pub(crate) degenerate: usize,
    /// Faces with the vertices of another, dropped.
    pub(crate) duplicates: usize,
    /// Faces whose inside was not that of their neighbours, turned.
    pub(crate) turned: usize,
    /// Pieces that were inside out, turned.
    pub(crate) inside_out: usize,
    /// Pieces that lie inside another piece and have the same orientation.
    pub(crate) nested: usize,
    /// Faces on an edge of which corners of others lie, parted there.
    pub(crate) parted: usize,
    /// Faces with the solid on both sides, or on neither, dropped.
    pub(crate) inner: usize,
    /// Openings, closed by flat caps.
    pub(crate) openings: Vec<Opening>,
    /// Edges of more than two faces.
    pub(crate) crowded_rims: usize,
    /// Pairs of faces that cross each other.
    pub(crate) crossings: usize,
    /// Pairs of faces that touch without a common corner, or lie on each other.
    pub(crate) touching: usize,
    /// Where the first faces that cross are [m]; if none do, the first that touch.
    pub(crate) crossing_at: Option<[f64; 3]>,
    /// What was found and mended, in words.
    pub(crate) findings: String,
    #[serde(skip)]
    is_clean: bool,
    /// The samples of a volume.
    pub(crate) samples: Option<Sampled>,
    /// What to do if the file seems to be in another unit than metres.
    pub(crate) hint: Option<String>,
}

/// Cracks between the faces of a mesh.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Cracks {
    /// How wide the widest is [m].
    pub(crate) width: f64,
    /// The `weld_within` that closes nearly all of them [m].
    pub(crate) join_within: f64,
}

/// An opening of a mesh.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Opening {
    /// The middle of its corners [m].
    pub(crate) place: [f64; 3],
    /// The longest side of the box around it [m].
    pub(crate) size: f64,
    /// How many edges it has.
    pub(crate) edges: usize,
    /// How far from its cap the sign may be a guess [m].
    pub(crate) doubtful: f64,
}

/// The samples of a volume, in metres before `scale`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Sampled {
    /// How many there are along each axis.
    pub(crate) counts: [usize; 3],
    /// The place of the first [m].
    pub(crate) origin: [f64; 3],
    /// The way from one to the next along each axis [m].
    pub(crate) steps: [[f64; 3]; 3],
    /// The least and the largest.
    pub(crate) range: [f32; 2],
    /// `true` if their border cuts off what lies within the surface, which is then closed half a step
    /// beyond it.
    pub(crate) cut_off: bool,
}

impl Answer {
    fn of<const D: usize>(name: String, scene: &BuiltScene<D>) -> Self {
        let hidden = scene.hidden();
        let bodies = scene.bodies.iter().enumerate().map(|(number, body)| {
            let promise = body.shape.promise();
            let around = hidden.iter().find(|hidden| hidden.body == number);
            Body {
                name: body.name.clone(),
                promise: promise.in_words(),
                lipschitz: promise.lipschitz,
                bounds: promise.bounds.map(|bounds| bounds.aabb.into()),
                depth: body.shape.depth(),
                is_empty: is_empty(&body.shape_in_body),
                hidden_in: around.map(|hidden| scene.bodies[hidden.within].name.clone()),
            }
        });
        let bodies = bodies.collect();
        let jumps = scene.jumps().into_iter().map(|jump| Jump {
            body: scene.bodies[jump.body].name.clone(),
            time: jump.time,
            distance: jump.distance,
            angle: jump.angle,
            period: jump.period,
        });
        let odd_motions = scene
            .motion_speeds()
            .into_iter()
            .filter(|motion| motion.speed == 0.0 || motion.speed > FAST)
            .map(|motion| OddMotion {
                body: scene.bodies[motion.body].name.clone(),
                start: motion.start,
                speed: motion.speed,
            })
            .collect();
        let meshes: Vec<Mesh> = scene.meshes.iter().map(Mesh::of).collect();
        Self {
            name,
            ok: meshes.iter().all(|mesh| mesh.openings.is_empty()),
            dimension: D,
            bodies,
            meshes,
            jumps: jumps.collect(),
            odd_motions,
        }
    }
}

impl Mesh {
    fn of(mesh: &BuiltMesh) -> Self {
        let found = &mesh.findings;
        let sampled = |samples: &Samples| Sampled {
            counts: samples.counts,
            origin: samples.origin.0,
            steps: samples.steps.map(|step| step.0),
            range: samples.range,
            cut_off: samples.cut_off,
        };
        Self {
            file: mesh.file.clone(),
            scale: mesh.scale,
            grid: mesh.grid.clone(),
            value: mesh.value,
            thickness: mesh.thickness,
            bounds: mesh.shape.promise().bounds.map(|bounds| bounds.aabb.into()),
            faces: found.faces,
            welded: found.welded,
            joined: found.joined,
            moved: found.moved,
            cracks: found
                .cracks
                .map(|cracks| Cracks { width: cracks.width, join_within: cracks.join_within }),
            degenerate: found.degenerate,
            duplicates: found.duplicates,
            turned: found.turned,
            inside_out: found.inside_out,
            nested: found.nested,
            parted: found.parted,
            inner: found.inner,
            openings: openings(found),
            crowded_rims: found.crowded_rims,
            crossings: found.crossings,
            touching: found.touching,
            crossing_at: found.crossing_at.map(|at| at.0),
            findings: found.to_string(),
            is_clean: found.is_clean(),
            samples: mesh.samples.as_ref().map(sampled),
            hint: unit_hint(mesh),
        }
    }
}

fn openings(found: &Findings<3>) -> Vec<Opening> {
    let openings = found.openings.iter().map(|opening| Opening {
        place: opening.place.0,
        size: opening.size,
        edges: opening.edges,
        doubtful: opening.doubtful,
    });
    openings.collect()
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_mended = |mesh: &&Mesh| mesh.thickness.is_none() && !mesh.is_clean;
        let mended = match self.meshes.iter().filter(is_mended).count() {
            0 => String::new(),
            count => {
                let files = counted(count, "mesh is", "meshes are");
                format!("; {files} used as mended, and not good alone")
            }
        };
        let guesses = self.meshes.iter().filter(|mesh| !mesh.openings.is_empty()).count();
        let verdict = match guesses {
            0 => "good".to_owned(),
            count => format!(
                "not sure, the repair of {} is a guess",
                counted(count, "mesh", "meshes")
            ),
        };
        writeln!(
            f,
            "{}: {verdict}, {}D, {}{mended}",
            shown(&self.name),
            self.dimension,
            counted(self.bodies.len(), "body", "bodies")
        )?;
        for Body { name, promise, is_empty, hidden_in, .. } in &self.bodies {
            let empty = match is_empty {
                Some(false) => "",
                Some(true) => "; empty: no point is in it, which is proven",
                None => "; may be empty: no point was found in it",
            };
            writeln!(f, "  {}: {promise}{empty}", shown(name))?;
            if let Some(outer) = hidden_in {
                writeln!(f, "    warning: {}", unfelt::Told { inner: name, outer })?;
            }
        }
        self.jumps.iter().try_for_each(|jump| writeln!(f, "  warning: {jump}"))?;
        self.odd_motions.iter().try_for_each(|odd| writeln!(f, "  warning: {odd}"))?;
        self.meshes.iter().try_for_each(|mesh| mesh.fmt(f))
    }
}

impl fmt::Display for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = match self.thickness {
            Some(thickness) => format!("a plate {thickness} m thick"),
            None if self.is_clean => "closed, and no faces cross".to_owned(),
            None => self.findings.clone(),
        };
        let name = self.file.as_deref().map_or("a mesh".into(), shown);
        let grid =
            self.grid.as_ref().map_or_else(String::new, |grid| format!(", {}", shown(grid)));
        let at = self.value.map_or_else(String::new, |value| format!(" at {value}"));
        let faces = counted(self.faces, "face", "faces");
        let list = |numbers: &[f64], between: &str| {
            numbers.iter().map(|x| rounded(*x)).collect::<Vec<_>>().join(between)
        };
        let size = self.bounds.as_ref().map_or(vec![0.0; 3], Bounds::size);
        writeln!(f, "  {name}{grid}{at}: {faces}, {} m: {found}", list(&size, " × "))?;
        if let Some(Sampled { counts, range: [least, largest], steps, cut_off, .. }) =
            &self.samples
        {
            let lengths = steps.map(|step| Vector(step).norm() * self.scale);
            writeln!(
                f,
                "    samples  {} from {least} to {largest}, {} m apart along {}",
                counts.map(|count| count.to_string()).join(" × "),
                list(&lengths, " × "),
                steps.map(direction).join(", "),
            )?;
            if *cut_off {
                let cut = "their border cuts the body off: it is closed half a sample beyond";
                writeln!(f, "    border   {cut}")?;
            }
            if let Some(Bounds { min, max }) = &self.bounds {
                let [min, max] = [min, max].map(|corner| list(corner, ", "));
                writeln!(f, "    surface  from ({min}) to ({max}) m")?;
            }
        }
        match &self.hint {
            Some(hint) => writeln!(f, "    hint     {hint}"),
            None => Ok(()),
        }
    }
}

/// The direction of an axis of a volume.
fn direction(step: [f64; 3]) -> String {
    let along = Vector(step) * (1.0 / Vector(step).norm());
    let axis = (0..3).find(|i| along[*i].abs() > 1.0 - 1e-6);
    match axis {
        Some(i) => format!("{}{}", if along[i] < 0.0 { "-" } else { "" }, ["x", "y", "z"][i]),
        None => format!("({})", along.0.map(rounded).join(", ")),
    }
}

/// What to do if the size of a mesh, or of a volume without a head that tells lengths, is that of another unit.
pub(crate) fn unit_hint(mesh: &BuiltMesh) -> Option<String> {
    let aabb = mesh.shape.promise().bounds?.aabb;
    // A factor of one may have been left out.
    let scale = Some(mesh.scale).filter(|scale| (scale - 1.0).abs() > 0.0);
    let file = mesh.file.as_ref()?;
    let is_without_unit = mesh.samples.is_none() || file.to_ascii_lowercase().ends_with(".npy");
    is_without_unit.then(|| hint(longest_edge(&aabb), "\"scale\":", scale)).flatten()
}

pub(crate) const EXAMPLES: &str =
    "Examples:\n  palpate check scenes/cup.json\n  palpate check scenes/cup.json --json";

/// The options of `palpate check`.
#[derive(Args, Debug)]
pub(crate) struct CheckOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}
