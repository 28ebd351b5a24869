// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Primitives by their names in the catalogue.

use palpate::field::catalogue::{ALIASES, Entry};
use palpate::field::kernel::{Argument, Parameter, ParameterKind};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::{misshapen, numbers};
use crate::error::OrRaise;
use crate::shape::PyShape;
use crate::text;

/// A primitive of a dimension, from a value for each of its parameters.
#[pyfunction]
pub(crate) fn primitive(
    py: Python<'_>,
    name: &str,
    dimension: usize,
    values: Vec<Bound<'_, PyAny>>,
) -> PyResult<PyShape> {
    match dimension {
        2 => of_dimension::<2>(name, &values)?.build(py),
        3 => of_dimension::<3>(name, &values)?.build(py),
        _ => Err(PyValueError::new_err(format!("dimension must be 2 or 3, got {dimension}"))),
    }
}

/// A primitive and its arguments.
struct Made<const D: usize>(&'static Entry<D>, Vec<Argument>);

impl<const D: usize> Made<D>
where
    PyShape: From<palpate::field::Shape<D>>,
{
    fn build(self, py: Python<'_>) -> PyResult<PyShape> {
        self.0.build(&self.1).or_raise(py).map(PyShape::from)
    }
}

fn of_dimension<const D: usize>(name: &str, values: &[Bound<'_, PyAny>]) -> PyResult<Made<D>> {
    let unknown = || PyValueError::new_err(format!("no primitive in {D}D is called {name:?}"));
    let entry = Entry::<D>::find(name).ok_or_else(unknown)?;
    let alias = ALIASES.iter().find(|alias| alias.name == name && alias.dimension == D);
    let parameters = alias.and_then(|alias| alias.parameters).unwrap_or(entry.parameters);
    if values.len() != parameters.len() {
        let problem =
            format!("{name} takes {} arguments, got {}", parameters.len(), values.len());
        return Err(PyTypeError::new_err(problem));
    }
    let arguments =
        parameters.iter().zip(values).map(|(parameter, value)| argument(parameter, value));
    let arguments: Vec<Argument> = arguments.collect::<PyResult<_>>()?;
    Ok(Made(entry, alias.map_or(arguments.clone(), |alias| alias.arguments(arguments))))
}

/// A value for a parameter.
fn argument(parameter: &Parameter, value: &Bound<'_, PyAny>) -> PyResult<Argument> {
    let name = parameter.name;
    match parameter.kind {
        ParameterKind::Count => value.extract().map(Argument::Count).map_err(|_| {
            PyTypeError::new_err(format!("{name} must be a whole number, got {}", said(value)))
        }),
        ParameterKind::Vector | ParameterKind::Direction => {
            let array = numbers(value, name)?;
            match array.shape() {
                [_] => Ok(Argument::Vector(array.as_doubles()?.into_owned())),
                shape => Err(misshapen(name, "(D,)", shape)),
            }
        }
        ParameterKind::Points => points(value, name).map(Argument::Points),
        ParameterKind::Rings => {
            let rings = value.try_iter()?.map(|ring| points(&ring?, name));
            rings.collect::<PyResult<_>>().map(Argument::Rings)
        }
        _ => value.extract().map(Argument::Number).map_err(|_| {
            PyTypeError::new_err(format!("{name} must be a number, got {}", said(value)))
        }),
    }
}

/// Points of a list or an array, one in each row.
fn points(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Vec<f64>>> {
    let array = numbers(value, name)?;
    match array.shape() {
        [_, 0] => Ok(Vec::new()),
        [_, columns] => {
            Ok(array.as_doubles()?.chunks_exact(*columns).map(<[f64]>::to_vec).collect())
        }
        shape => Err(misshapen(name, "(n, D)", shape)),
    }
}

/// A value in few characters.
fn said(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string());
    match text.char_indices().nth(80) {
        None => text,
        Some((end, _)) => format!("{}…", &text[..end]),
    }
}

/// The primitives of both dimensions: name, dimension, sentences on it and its origin, and its parameters, each with
/// name, kind, unit and meaning. The constructors of the package are made from them.
#[pyfunction]
pub(crate) fn catalogue(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let all = PyList::empty(py);
    listed::<2>(&all)?;
    listed::<3>(&all)?;
    Ok(all)
}

fn listed<const D: usize>(all: &Bound<'_, PyList>) -> PyResult<()> {
    let py = all.py();
    let named = Entry::<D>::all().iter().map(|entry| (entry.name, entry, None));
    let aliases = ALIASES.iter().filter(|alias| alias.dimension == D);
    let aliases = aliases
        .filter_map(|alias| Some((alias.name, Entry::<D>::find(alias.name)?, Some(alias))));
    for (name, entry, alias) in named.chain(aliases) {
        let own = alias.and_then(|alias| alias.parameters);
        let given = match own {
            // One number that holds along all axes.
            Some(_) => vec![Argument::Number(1.0)],
            None => entry.example_arguments().or_raise(py)?,
        };
        let arguments = alias.map_or(given.clone(), |alias| alias.arguments(given.clone()));
        let made = entry.build(&arguments).or_raise(py)?;
        let parameters = own.unwrap_or(entry.parameters).iter().map(|parameter| {
            let Parameter { name, kind, about } = parameter;
            (*name, format!("{kind:?}"), kind.unit().symbol(), *about)
        });
        let told = PyDict::new(py);
        told.set_item("name", name)?;
        told.set_item("dimension", D)?;
        told.set_item("about", entry.about)?;
        told.set_item("origin", entry.origin)?;
        told.set_item("parameters", parameters.collect::<Vec<_>>())?;
        told.set_item("example", given.iter().map(Argument::to_string).collect::<Vec<_>>())?;
        told.set_item("made", text::of(&made))?;
        all.append(told)?;
    }
    Ok(())
}
