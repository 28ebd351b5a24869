// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One primitive by its name.

use std::io::Write;

use palpate::field::catalogue::{ALIASES, Alias, Entry};
use palpate::plot::Figure;
use palpate::scene::{WrittenShape, unknown_name};

use super::{Answer, Primitive, drawing};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::picture::{self, Picture};
use crate::shapes::{Dimension, ShapesOptions};

/// A primitive in the dimensions in which it has this name.
struct Named {
    alias: Option<&'static Alias>,
    planar: Option<&'static Entry<2>>,
    spatial: Option<&'static Entry<3>>,
}

pub(super) fn run(options: &ShapesOptions, name: &str) -> Result<Outcome, Failure> {
    let named = Named::find(name, options.dimension)?;
    let picture = options
        .output
        .as_deref()
        .map(|path| Picture::new(&mut Files::default(), path))
        .transpose()?;
    match (&picture, options.width) {
        (Some(picture), width) => picture.check_width(width)?,
        (None, Some(_)) => {
            let example = format!("palpate shapes {name} --output {name}.png");
            let problem = format!("--width is for a picture, and needs --output: {example}");
            return Err(Failure::input(problem));
        }
        (None, None) => {}
    }
    let mut primitives = named.described()?;
    if let Some(picture) = &picture {
        let width = options.width.unwrap_or(picture::WIDTH);
        picture.save(&named.figure()?, width)?;
        let output = picture.path().display().to_string();
        primitives.iter_mut().for_each(|row| row.output = Some(output.clone()));
    }
    let mut out = output::answer();
    if options.json {
        out.json(&Answer { primitives })?;
        return Ok(Outcome::Yes);
    }
    named.say(&mut out, &primitives)?;
    if let Some(picture) = picture {
        let path = picture.path().display().to_string();
        writeln!(out, "{}: {name} with its parameters", shown(&path))?;
    }
    Ok(Outcome::Yes)
}

impl Named {
    /// The primitive called `name`, in one dimension if it is given.
    fn find(name: &str, dimension: Option<Dimension>) -> Result<Self, Failure> {
        let wanted = |other: Dimension| dimension.is_none_or(|dimension| dimension == other);
        let planar = Entry::<2>::find(name);
        let spatial = Entry::<3>::find(name);
        let found = Self {
            alias: ALIASES.iter().find(|alias| alias.name == name),
            planar: planar.filter(|_| wanted(Dimension::Two)),
            spatial: spatial.filter(|_| wanted(Dimension::Three)),
        };
        let elsewhere = match (found.planar, found.spatial, planar, spatial) {
            (Some(_), ..) | (_, Some(_), ..) => return Ok(found),
            (_, _, Some(_), _) => Some("of the plane: leave out `--dimension 3`"),
            (_, _, _, Some(_)) => Some("of space: leave out `--dimension 2`"),
            _ => None,
        };
        Err(Failure::input(match elsewhere {
            Some(place) => format!("`{name}` is a primitive {place}"),
            None => {
                let unknown = unknown_name("primitive", name, &names(dimension));
                format!("{unknown} (`palpate shapes` lists all)")
            }
        }))
    }

    fn described(&self) -> Result<Vec<Primitive>, Failure> {
        let (planar, spatial) =
            (self.planar.map(Primitive::of), self.spatial.map(Primitive::of));
        planar.into_iter().chain(spatial).collect()
    }

    fn figure(&self) -> Result<Figure, Failure> {
        let words = self.planar.map(|entry| (entry.name, entry.about, entry.origin));
        let words = words.or(self.spatial.map(|entry| (entry.name, entry.about, entry.origin)));
        let (name, about, origin) = words.unwrap_or_default();
        let mut figure = Figure::new(name.replace('_', " "))
            .with_caption(format!("{about} Origin: {}.", origin.replace('`', "")));
        if let Some(entry) = self.planar {
            figure = drawing::add(figure, entry)?;
        }
        match self.spatial {
            Some(entry) => drawing::add(figure, entry),
            None => Ok(figure),
        }
    }

    fn say(&self, out: &mut impl Write, rows: &[Primitive]) -> Result<(), Failure> {
        if let Some(Alias { name, of, dimension, parameters, .. }) = self.alias {
            write!(out, "`{name}` is another name of `{of}` in {dimension}D")?;
            for parameter in parameters.unwrap_or_default() {
                write!(out, ", with one number as `{}`: {}", parameter.name, parameter.about)?;
            }
            writeln!(out)?;
        }
        for row in rows {
            write!(out, "{row}")?;
            let example = WrittenShape::from_json(&row.example.to_string());
            let example = example.map_err(Failure::input)?.to_json();
            writeln!(out, "    example: {}", example.trim_end().replace('\n', "\n    "))?;
        }
        Ok(())
    }
}

/// The names of all primitives, other names included.
fn names(dimension: Option<Dimension>) -> Vec<&'static str> {
    let wanted = |other: usize| match dimension {
        None => true,
        Some(Dimension::Two) => other == 2,
        Some(Dimension::Three) => other == 3,
    };
    let planar = Entry::<2>::ALL.iter().map(|entry| (entry.name, 2));
    let spatial = Entry::<3>::ALL.iter().map(|entry| (entry.name, 3));
    let others = ALIASES.iter().map(|alias| (alias.name, alias.dimension));
    let mut names: Vec<_> = planar
        .chain(spatial)
        .chain(others)
        .filter(|(_, dimension)| wanted(*dimension))
        .map(|(name, _)| name)
        .collect();
    names.sort_unstable();
    names.dedup();
    names
}
