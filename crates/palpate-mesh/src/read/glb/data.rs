// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The numbers behind a document: buffers, views of them, and accessors.

use std::borrow::Cow;

use super::document::{Accessor, Document, Sparse, View, Whole};
use super::{base64, extensions, malformed};
use crate::read::ReadProblem;
use crate::read::text::quoted;

/// A document with its buffers.
pub(super) struct Data<'a> {
    pub(super) document: &'a Document,
    buffers: Vec<Source<'a>>,
}

/// Where the bytes of a buffer are.
enum Source<'a> {
    Here(Cow<'a, [u8]>),
    /// In another file, or in a text that is no base 64.
    Uri(&'a str),
    Nowhere,
}

/// Where items lie one after the other.
#[derive(Clone, Copy)]
struct Place {
    view: Whole,
    /// From the start of the view [bytes].
    offset: Whole,
    component: Component,
    /// Of each item.
    components: usize,
    count: usize,
}

impl<'a> Data<'a> {
    /// `chunk` holds the first buffer of a binary file.
    pub(super) fn new(document: &'a Document, chunk: Option<&'a [u8]>) -> Self {
        let source = |(index, uri): (usize, Option<&'a str>)| match (uri, chunk) {
            (Some(uri), _) => match base64::of_uri(uri) {
                Some(bytes) => Source::Here(bytes.into()),
                None => Source::Uri(uri),
            },
            (None, Some(chunk)) if index == 0 => Source::Here(chunk.into()),
            (None, _) => Source::Nowhere,
        };
        let uris = document.buffers.iter().map(|buffer| buffer.uri.as_deref());
        Self { document, buffers: uris.enumerate().map(source).collect() }
    }

    pub(super) fn accessor(&self, index: Whole) -> Result<&'a Accessor, ReadProblem> {
        found(&self.document.accessors, index, "accessor")
    }

    /// Whether an accessor has numbers of its own. Others are all zero.
    pub(super) fn is_filled(&self, index: Whole) -> Result<bool, ReadProblem> {
        let accessor = self.accessor(index)?;
        Ok(accessor.buffer_view.is_some() || accessor.sparse.is_some())
    }

    /// The items of an accessor, of `N` numbers each, which are used as `what`. The memory that
    /// they take follows from their count, which the caller has limited.
    pub(super) fn items<const N: usize>(
        &self,
        index: Whole,
        what: &str,
    ) -> Result<Vec<[f64; N]>, ReadProblem> {
        let accessor = self.accessor(index)?;
        let kind = if N == 1 { "SCALAR".to_owned() } else { format!("VEC{N}") };
        if accessor.kind != kind {
            let found = quoted(&accessor.kind);
            return Err(malformed(format_args!(
                "accessor {index} is used as {what}, of type {kind}, and has type {found}"
            )));
        }
        let component = Component::of(accessor.component_type, index)?;
        let count = accessor.count.get();
        let read = |item: &[u8]| {
            std::array::from_fn(|i| component.number(item, i, accessor.normalized))
        };
        let mut items = match accessor.buffer_view {
            None => vec![[0.0; N]; count],
            Some(view) => {
                let offset = accessor.byte_offset;
                let place = Place { view, offset, component, components: N, count };
                self.bytes(place, index)?.map(read).collect()
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let places = self.sparse_places(sparse, index)?;
            let place = Place {
                view: sparse.values.buffer_view,
                offset: sparse.values.byte_offset,
                component,
                components: N,
                count: sparse.count.get(),
            };
            for (at, item) in places.into_iter().zip(self.bytes(place, index)?) {
                let Some(target) = items.get_mut(at) else {
                    return Err(malformed(format_args!(
                        "accessor {index}: its sparse part names item {at}, and there are {count}"
                    )));
                };
                *target = read(item);
            }
        }
        Ok(items)
    }

    /// Which items a sparse part replaces.
    fn sparse_places(&self, sparse: &Sparse, index: Whole) -> Result<Vec<usize>, ReadProblem> {
        let component = Component::of(sparse.indices.component_type, index)?;
        if !component.is_unsigned() {
            return Err(malformed(format_args!(
                "accessor {index}: the indices of its sparse part are no unsigned integers"
            )));
        }
        let place = Place {
            view: sparse.indices.buffer_view,
            offset: sparse.indices.byte_offset,
            component,
            components: 1,
            count: sparse.count.get(),
        };
        Ok(self
            .bytes(place, index)?
            .map(|item| component.number(item, 0, false) as usize)
            .collect())
    }

    /// The numbers of vertices that an accessor lists.
    pub(super) fn indices(&self, index: Whole) -> Result<Vec<u32>, ReadProblem> {
        let accessor = self.accessor(index)?;
        if !Component::of(accessor.component_type, index)?.is_unsigned() || accessor.normalized
        {
            return Err(malformed(format_args!(
                "accessor {index} is used as indices, and holds no unsigned integers"
            )));
        }
        let items = self.items::<1>(index, "indices")?;
        // Integers of 32 bits are exact in double precision.
        Ok(items.into_iter().map(|[item]| item as u32).collect())
    }

    /// The bytes of each item, all within the file.
    fn bytes(
        &self,
        place: Place,
        accessor: Whole,
    ) -> Result<impl Iterator<Item = &[u8]> + use<'_>, ReadProblem> {
        let view = found(&self.document.buffer_views, place.view, "buffer view")?;
        let source = found(&self.buffers, view.buffer, "buffer")?;
        let Source::Here(bytes) = source else { return Err(elsewhere(source, view)) };
        let size = place.component.size() * place.components;
        // Some programs write 0 where items lie without gaps.
        let stride = view.byte_stride.map_or(0, Whole::get);
        let stride = if stride == 0 { size } else { stride };
        if stride < size {
            return Err(malformed(format_args!(
                "buffer view {}: items of {size} bytes are {stride} bytes apart",
                place.view
            )));
        }
        let start = view.byte_offset.get();
        let data = bytes.get(start..).and_then(|rest| rest.get(..view.byte_length.get()));
        let within = data.and_then(|data| {
            let last = place.count.saturating_sub(1).checked_mul(stride)?;
            let length = if place.count == 0 { 0 } else { last.checked_add(size)? };
            data.get(place.offset.get()..)?.get(..length)
        });
        let data = within.ok_or_else(|| {
            let (view, found) = (place.view, bytes.len());
            malformed(format_args!(
                "accessor {accessor} goes past the bytes of buffer view {view}, or that past the \
                 {found} bytes of buffer {}",
                self.buffer_of(place.view)
            ))
        })?;
        Ok((0..place.count).map(move |i| &data[i * stride..i * stride + size]))
    }

    fn buffer_of(&self, view: Whole) -> Whole {
        self.document
            .buffer_views
            .get(view.get())
            .map_or_else(Whole::default, |view| view.buffer)
    }
}

/// The item of a list of the document.
pub(super) fn found<'l, T>(
    list: &'l [T],
    index: Whole,
    what: &str,
) -> Result<&'l T, ReadProblem> {
    list.get(index.get()).ok_or_else(|| {
        malformed(format_args!("it names {what} {index}, and there are {}", list.len()))
    })
}

/// The complaint that data are not in the file.
fn elsewhere(source: &Source<'_>, view: &View) -> ReadProblem {
    match (source, view.compression()) {
        (Source::Nowhere, Some(compression)) => extensions::refused(compression),
        (Source::Uri(uri), _) if uri.starts_with("data:") => {
            malformed(format_args!("buffer {} is no base 64 text", view.buffer))
        }
        (Source::Uri(_), _) => ReadProblem::Unsupported {
            what: "buffers outside the file",
            advice: "put everything into one file, for example with `gltf-transform copy in.gltf out.glb`",
        },
        _ => malformed(format_args!("buffer {} has no data in the file", view.buffer)),
    }
}

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: Whole, accessor: Whole) -> Result<Self, ReadProblem> {
        Ok(match code.get() {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => {
                return Err(malformed(format_args!(
                    "accessor {accessor} has numbers of type {code}, which is none of 5120 to \
                     5123, 5125 and 5126"
                )));
            }
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// The `i`-th number of an item. One that is normalized is a part of the largest of its
    /// type, and the least signed one counts as −1 too (glTF 2.0, section 3.6.2.2).
    fn number(self, item: &[u8], i: usize, is_normalized: bool) -> f64 {
        let (number, largest) = match self {
            Self::I8 => (f64::from(i8::from_le_bytes(chunk(item, i))), f64::from(i8::MAX)),
            Self::U8 => (f64::from(u8::from_le_bytes(chunk(item, i))), f64::from(u8::MAX)),
            Self::I16 => (f64::from(i16::from_le_bytes(chunk(item, i))), f64::from(i16::MAX)),
            Self::U16 => (f64::from(u16::from_le_bytes(chunk(item, i))), f64::from(u16::MAX)),
            Self::U32 => (f64::from(u32::from_le_bytes(chunk(item, i))), f64::from(u32::MAX)),
            Self::F32 => return f64::from(f32::from_le_bytes(chunk(item, i))),
        };
        if is_normalized { (number / largest).max(-1.0) } else { number }
    }
}

/// The `N` bytes of the `i`-th number of an item.
fn chunk<const N: usize>(item: &[u8], i: usize) -> [u8; N] {
    std::array::from_fn(|k| item[N * i + k])
}
