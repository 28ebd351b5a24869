// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Documents of glTF, put together from accessors and the rest of the JSON.

/// The corners of a box of 1 × 2 × 3 with one corner at the origin.
pub(crate) const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 2.0, 0.0],
    [0.0, 2.0, 0.0],
    [0.0, 0.0, 3.0],
    [1.0, 0.0, 3.0],
    [1.0, 2.0, 3.0],
    [0.0, 2.0, 3.0],
];

/// Its twelve triangles, counter-clockwise seen from outside.
pub(crate) const TRIANGLES: [u16; 36] = [
    0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5,
    0, 4, 7, 0, 7, 3,
];

/// A mesh of this box, with accessor 0 as its corners and accessor 1 as its triangles.
pub(crate) const BOX: &str = r#"{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}"#;

/// A document that grows.
#[derive(Clone, Default)]
pub(crate) struct Document {
    pub(crate) data: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Document {
    /// One with the box: accessors 0 and 1.
    pub(crate) fn of_box() -> Self {
        let mut document = Self::default();
        document.floats("VEC3", &CORNERS);
        document.add("SCALAR", 5123, 36, &TRIANGLES.map(u16::to_le_bytes).concat());
        document
    }

    /// Adds an accessor of floats and says its number.
    pub(crate) fn floats<const N: usize>(&mut self, kind: &str, items: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> =
            items.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(kind, 5126, items.len(), &bytes)
    }

    /// Adds an accessor of numbers of a type.
    pub(crate) fn add(&mut self, kind: &str, code: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes, "");
        let text = format!(
            r#"{{"bufferView":{view},"componentType":{code},"count":{count},"type":"{kind}"}}"#
        );
        self.accessor(text)
    }

    /// Adds a view of new bytes; `more` follows in its JSON.
    pub(crate) fn view(&mut self, bytes: &[u8], more: &str) -> usize {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let (start, length) = (self.data.len(), bytes.len());
        self.data.extend(bytes);
        self.views.push(format!(
            r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}{more}}}"#
        ));
        self.views.len() - 1
    }

    /// Adds an accessor as it is written.
    pub(crate) fn accessor(&mut self, text: String) -> usize {
        self.accessors.push(text);
        self.accessors.len() - 1
    }

    /// The JSON, of which `rest` holds nodes, meshes and what else.
    pub(crate) fn json(&self, rest: &str, buffer: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}{buffer}}}],{rest}}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.data.len()
        )
    }

    /// The binary file.
    pub(crate) fn glb(&self, rest: &str) -> Vec<u8> {
        glb_of(&[(b"JSON", self.json(rest, "").as_bytes()), (b"BIN\0", &self.data)])
    }
}

/// A binary file of chunks.
pub(crate) fn glb_of(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in chunks {
        let length = chunk.len().next_multiple_of(4);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(*kind);
        bytes.extend(*chunk);
        let filling = if *kind == b"JSON" { b' ' } else { 0 };
        bytes.resize(bytes.len() + length - chunk.len(), filling);
    }
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

/// Bytes in base 64.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] =
        b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |group: &[u8]| {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or_default());
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        (0..4)
            .map(|i| match i <= group.len() {
                true => char::from(LETTERS[(bits >> (18 - 6 * i) & 63) as usize]),
                false => '=',
            })
            .collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}
