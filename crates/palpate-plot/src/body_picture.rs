// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies of a picture.

use crate::drawing::{Drawing, Path, Stroke, TextPaint};
use crate::geometry::{Point, Rect, is_within};
use crate::labels::{Hatching, Occupied};
use crate::legend::{Entry, Frame, Key};
use crate::names::Name;
use crate::outline::SurfaceLines;
use crate::overlay::{Dash, Nearest};
use crate::palette::{Color, Side};
use crate::picture::surface_stroke;

/// Outlines closer than this run together: they get strokes that differ in more than colour [px].
const TOGETHER: f64 = 4.0;
/// Widths of lines [px]: a narrow one over a wide one leaves both visible.
const WIDTHS: [f64; 2] = [3.2, 1.5];
/// The white rim of an outline that sets it off from dark colours [px].
const RIM: f64 = 1.4;
/// How much of a body's colour its inside takes.
const TINT: f64 = 0.3;
/// How much darker names are than outlines: letters are thinner than these.
const DARKER: f64 = 0.35;
/// Places tried for a name within a body, along each side of its box.
const PLACES: u32 = 10;
/// The names of bodies of one colour that a legend lists.
const LISTED: usize = 4;

/// The hatching of what bodies share.
pub(crate) const SHARED: Hatching = Hatching { slope: -1.0, spacing: 6.0 };

/// Its lines.
pub(crate) fn shared_stroke() -> Stroke {
    Stroke::new(Color::INK, 0.9).with_opacity(0.75)
}

/// The bodies in view.
#[derive(Debug, Default)]
pub(crate) struct Bodies<'a> {
    bodies: Vec<Seen<'a>>,
    /// Whether the scene has several bodies, of which some may be out of view.
    are_several: bool,
    /// Whether they have colours of their own.
    are_coloured: bool,
    /// The hatching of what several of them share.
    shared: Path,
}

/// A body in view.
#[derive(Debug)]
struct Seen<'a> {
    body: &'a DrawnBody,
    stroke: Stroke,
    /// The surface, the rings around the inside and around parts that are surface [px].
    lines: Vec<Vec<Point>>,
    rings: Vec<Vec<Point>>,
    solids: Vec<Vec<Point>>,
    /// The box around the surface [px].
    bounds: Rect,
}

impl<'a> Bodies<'a> {
    /// The bodies of which `frame` shows some surface, in colours of their own or in ink.
    pub(crate) fn new(frame: &Frame, bodies: &'a [DrawnBody], are_coloured: bool) -> Self {
        let seen = bodies.iter().enumerate().filter_map(|(number, body)| {
            let bounds = frame.rect(&body.outline.bounds(&frame.window())?);
            let color = if are_coloured { Color::numbered(number) } else { Color::INK };
            let pixels = |lines: &[Vec<Point>]| -> Vec<_> {
                lines.iter().map(|line| frame.pixels(line)).collect()
            };
            Some(Seen {
                body,
                stroke: Stroke { color, ..surface_stroke() },
                lines: frame.shown(&pixels(&body.outline.lines)),
                rings: pixels(&body.outline.rings),
                solids: pixels(&body.outline.solids),
                bounds,
            })
        });
        let are_several = bodies.len() > 1;
        let mut bodies: Vec<_> = seen.collect();
        if are_coloured {
            tell_apart(&mut bodies, frame.plot.width());
        }
        let regions: Vec<_> = bodies.iter().map(|seen| &seen.rings[..]).collect();
        let shared = SHARED.over(&frame.plot, &regions, |count| count > 1);
        Self { bodies, are_several, are_coloured, shared }
    }

    /// The colours of bands inside them.
    pub(crate) fn inside(&self) -> Side {
        if self.are_coloured { Side::InsideBodies } else { Side::Inside }
    }

    /// Marks the room that the surfaces cover as occupied.
    pub(crate) fn occupy(&self, occupied: &mut Occupied) {
        let lines = self.bodies.iter().flat_map(|seen| seen.lines.iter().chain(&seen.solids));
        lines.for_each(|line| occupied.add_line(line.clone()));
    }

    /// Tints the insides, and hatches what bodies share.
    pub(crate) fn draw_insides(&self, drawing: &mut Drawing, frame: &Frame) {
        for seen in self.bodies.iter().filter(|_| self.are_coloured) {
            drawing.fill_rings(frame.region(&seen.rings), seen.stroke.color, TINT);
        }
        drawing.stroke(self.shared.clone(), shared_stroke());
    }

    /// What becomes of `color` where it lies below the insides [px].
    pub(crate) fn tinted(&self, color: Color, p: Point) -> Color {
        let bodies = self.bodies.iter().filter(|seen| is_within(p, &seen.rings));
        let bodies = bodies.filter(|_| self.are_coloured);
        bodies.fold(color, |color, seen| color.below(seen.stroke.color, TINT))
    }

    /// Draws white rims below the outlines, which set them off from dark colours.
    pub(crate) fn draw_rims(&self, drawing: &mut Drawing) {
        for seen in &self.bodies {
            let rim = Stroke::new(Color::WHITE, seen.stroke.width + 2.0 * RIM);
            drawing.stroke(Path::lines(&seen.lines), rim);
        }
    }

    /// Draws the outlines, narrow ones over wide ones and broken ones over others.
    pub(crate) fn draw_outlines(&self, drawing: &mut Drawing, frame: &Frame) {
        let mut order: Vec<&Seen<'_>> = self.bodies.iter().collect();
        order.sort_by(|a, b| {
            let by_width = b.stroke.width.total_cmp(&a.stroke.width);
            by_width.then(a.stroke.dash.is_empty().cmp(&b.stroke.dash.is_empty()).reverse())
        });
        for seen in order {
            drawing.stroke(Path::lines(&seen.lines), seen.stroke.clone());
            drawing.fill_rings(frame.region(&seen.solids), seen.stroke.color, 1.0);
        }
    }

    /// Finds places for the names at the bodies, as far as there is room, and marks them as
    /// occupied.
    pub(crate) fn place_names(
        &self,
        plot: &Rect,
        occupied: &mut Occupied,
    ) -> Vec<(Name, Color)> {
        let mut names = Vec::new();
        for (number, seen) in self.bodies.iter().enumerate() {
            if let Some(name) = self.place_name(number, plot, occupied) {
                name.texts().iter().for_each(|text| occupied.add_text(text));
                names.push((name, seen.stroke.color));
            }
        }
        names
    }

    /// A place for the name of a body: inside, preferably where no other body is, else beside it.
    fn place_name(&self, number: usize, plot: &Rect, occupied: &Occupied) -> Option<Name> {
        let seen = &self.bodies[number];
        let is_others = |p: Point| {
            let mut bodies = self.bodies.iter().enumerate();
            bodies.any(|(other, seen)| other != number && is_within(p, &seen.rings))
        };
        let mut inside: Vec<Point> = places(&seen.bounds);
        inside.retain(|p| is_within(*p, &seen.rings));
        inside.sort_by_key(|p| is_others(*p));
        let DrawnBody { name, note, .. } = seen.body;
        Name::ways(name, note, seen.bounds.width()).into_iter().find_map(|name| {
            let beside = name.beside(&seen.bounds).into_iter().filter(|p| !is_others(*p));
            let mut places = inside.iter().copied().chain(beside).map(|place| name.at(place));
            places.find(|name| name.is_free(plot, occupied))
        })
    }

    /// The legend: an entry for each colour, with a tint and hatching if insides
    /// [are drawn](Self::draw_insides). Empty if no body is in view.
    pub(crate) fn entries(&self, has_insides: bool) -> Vec<Entry> {
        let mut entries = match &self.bodies[..] {
            [] => Vec::new(),
            seen if self.are_coloured => coloured_entries(seen, has_insides),
            [seen] if !self.are_several => {
                let text = format!("surface of {}", seen.body.in_words());
                vec![Entry::new(Key::Line(seen.stroke.clone()), text)]
            }
            [seen, ..] => {
                vec![Entry::new(Key::Line(seen.stroke.clone()), "surfaces of the bodies")]
            }
        };
        if has_insides && !self.shared.verbs.is_empty() {
            entries.push(Entry::new(Key::Shared, "in several bodies"));
        }
        let areas =
            self.bodies.iter().find(|seen| seen.solids.iter().any(|ring| is_wide(ring)));
        if let Some(seen) = areas {
            entries
                .push(Entry::new(Key::Swatch(seen.stroke.color), "area that is all surface"));
        }
        entries
    }
}

/// Whether a ring [px] encloses an area that is wider than lines.
fn is_wide(ring: &[Point]) -> bool {
    let boxes = ring.iter().map(|p| Rect { min: *p, max: *p });
    let bounds = boxes.reduce(|a, b| a.union(&b));
    bounds.is_some_and(|bounds| bounds.width().min(bounds.height()) > TOGETHER)
}

/// An entry for each colour.
fn coloured_entries(bodies: &[Seen<'_>], has_insides: bool) -> Vec<Entry> {
    let mut colors: Vec<Color> = Vec::new();
    let mut entries = Vec::new();
    for Seen { stroke, .. } in bodies {
        if !colors.contains(&stroke.color) {
            colors.push(stroke.color);
            let alike = bodies.iter().filter(|other| other.stroke.color == stroke.color);
            let names: Vec<_> = alike.map(|other| other.body.in_words()).collect();
            let key = if has_insides {
                Key::DrawnBody(stroke.clone(), Color::WHITE.below(stroke.color, TINT))
            } else {
                Key::Line(stroke.clone())
            };
            entries.push(Entry::new(key, listed(&names)));
        }
    }
    entries
}

/// Draws names over what is below.
pub(crate) fn draw_names(drawing: &mut Drawing, names: &[(Name, Color)]) {
    for (name, color) in names {
        for text in name.texts() {
            let halo = Some((Color::WHITE, 3.5));
            drawing.text(&text, TextPaint { color: color.mix(Color::INK, DARKER), halo });
        }
    }
}

/// Gives bodies whose outlines run together strokes of other widths and dashes. `size` is the
/// extent of the picture [px].
fn tell_apart(bodies: &mut [Seen<'_>], size: f64) {
    let mut styles: Vec<usize> = Vec::new();
    let mut outlines: Vec<(Rect, Nearest)> = Vec::new();
    for seen in bodies {
        let segments = seen.lines.iter().flat_map(|line| line.windows(2));
        let segments: Vec<_> = segments.map(|pair| [pair[0], pair[1]]).collect();
        let runs_with = |(bounds, outline): &(Rect, Nearest)| {
            let around = bounds.grown(TOGETHER);
            let mut points = segments.iter().flat_map(|pair| along(*pair));
            points.any(|p| around.contains(p) && outline.distance(p, 0.0) < TOGETHER)
        };
        let together = outlines.iter().zip(&styles).filter(|(outline, _)| runs_with(outline));
        let taken: Vec<_> = together.map(|(_, style)| *style).collect();
        let style = (0..=taken.len()).find(|style| !taken.contains(style)).unwrap_or(0);
        let width = WIDTHS[style % WIDTHS.len()];
        let dash = Dash::of_series(style / WIDTHS.len()).lengths(width);
        seen.stroke = Stroke::new(seen.stroke.color, width).with_dash(dash);
        styles.push(style);
        outlines.push((seen.bounds, Nearest::new(segments, size)));
    }
}

/// Points along a segment, at most [`TOGETHER`] apart.
fn along([a, b]: [Point; 2]) -> impl Iterator<Item = Point> {
    let steps = (crate::geometry::distance(a, b) / TOGETHER).ceil().max(1.0) as u32;
    (0..=steps).map(move |step| {
        let share = f64::from(step) / f64::from(steps);
        [0, 1].map(|k| a[k] + share * (b[k] - a[k]))
    })
}

/// Places within `bounds`, the middle ones first.
fn places(bounds: &Rect) -> Vec<Point> {
    let share = |i: u32| f64::from(i) / f64::from(PLACES);
    let mut shares: Vec<[f64; 2]> =
        (1..PLACES).flat_map(|i| (1..PLACES).map(move |j| [share(i), share(j)])).collect();
    let away = |[x, y]: [f64; 2]| (x - 0.5).hypot(y - 0.5);
    shares.sort_by(|a, b| away(*a).total_cmp(&away(*b)));
    let place = |share: [f64; 2]| {
        [0, 1].map(|k| bounds.min[k] + share[k] * (bounds.max[k] - bounds.min[k]))
    };
    shares.into_iter().map(place).collect()
}

/// The names of bodies of one colour.
fn listed(names: &[String]) -> String {
    let count = names.len();
    if count <= LISTED {
        return names.join(", ");
    }
    format!("{} and {} more", names[..LISTED].join(", "), count - LISTED)
}

/// A body with its surface, to be drawn in a colour of its own.
///
/// # Examples
///
/// ```
/// use palpate_plot::{DrawnBody, SurfaceLines};
///
/// # let outline = SurfaceLines::default();
/// let cup = DrawnBody::new("cup", outline).with_note("glass");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnBody {
    pub(crate) name: String,
    pub(crate) note: String,
    pub(crate) outline: SurfaceLines,
}

impl DrawnBody {
    /// The body `name`, with its surface in the window of the picture.
    #[must_use]
    pub fn new(name: impl Into<String>, outline: SurfaceLines) -> Self {
        Self { name: name.into(), note: String::new(), outline }
    }

    /// With a few words that stand below its name, such as its material.
    #[must_use]
    pub fn with_note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// Its name, with the note.
    pub(crate) fn in_words(&self) -> String {
        let Self { name, note, .. } = self;
        if note.is_empty() { name.clone() } else { format!("{name} ({note})") }
    }
}
