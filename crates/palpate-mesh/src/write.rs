// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes as bytes of files.

use std::io::{self, Write};

use palpate_field::Vector;

use crate::mesh::{MeshError, TriangleMesh, single};
use crate::read::Format;

impl TriangleMesh {
    /// Writes the mesh in a format, its coordinates [m] as they are: in double precision to OBJ and PLY, in single
    /// precision to STL and GLB, which have no other.
    ///
    /// ```
    /// use palpate_mesh::{Format, TriangleMesh, read};
    /// # use palpate_field::Vector;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    /// # let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    /// let mesh = TriangleMesh::new(corners.map(Vector).to_vec(), faces)?;
    /// let mut bytes = Vec::new();
    /// mesh.write(Format::Ply, &mut bytes)?;
    /// assert_eq!(read(&bytes, Format::Ply)?.vertices(), mesh.vertices());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As of `out`.
    pub fn write(&self, format: Format, out: impl Write) -> io::Result<()> {
        match format {
            Format::Obj => self.write_obj(out),
            Format::Stl => self.write_stl(out),
            Format::Ply => self.write_ply(out),
            Format::Glb => self.write_glb(out),
        }
    }

    /// The mesh as a file of a format holds it: in single precision in STL and GLB, and in STL with equal vertices
    /// merged, as its readers do. So what is measured of it holds for the file.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_mesh::{Format, TriangleMesh};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let corners = [[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Vector);
    /// let mesh = TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2]])?;
    /// assert_eq!(mesh.in_format(Format::Stl)?.vertices()[0][0], f64::from(0.1_f32));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As of [`new`](Self::new).
    pub fn in_format(&self, format: Format) -> Result<Self, MeshError> {
        if !format.is_single() {
            return Ok(self.clone());
        }
        let vertices = self.vertices().iter().map(|p| single(*p)).collect();
        let mesh = Self::new(vertices, self.elements().to_vec())?;
        Ok(if format == Format::Stl { mesh.welded() } else { mesh })
    }

    fn write_obj(&self, mut out: impl Write) -> io::Result<()> {
        for p in self.vertices() {
            writeln!(out, "v {} {} {}", p[0], p[1], p[2])?;
        }
        for face in self.elements() {
            let [a, b, c] = face.map(|vertex| vertex + 1);
            writeln!(out, "f {a} {b} {c}")?;
        }
        Ok(())
    }

    fn write_stl(&self, mut out: impl Write) -> io::Result<()> {
        out.write_all(&[0; 80])?;
        out.write_all(&(self.elements().len() as u32).to_le_bytes())?;
        for face in 0..self.elements().len() {
            let corners = self.corners(face);
            let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let normal = across.normalized().unwrap_or(Vector::ZERO);
            for coordinate in [normal].iter().chain(&corners).flat_map(|p| p.0) {
                out.write_all(&(coordinate as f32).to_le_bytes())?;
            }
            // No attributes.
            out.write_all(&[0; 2])?;
        }
        Ok(())
    }

    fn write_ply(&self, mut out: impl Write) -> io::Result<()> {
        let (vertices, faces) = (self.vertices().len(), self.elements().len());
        write!(
            out,
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty double x\n\
             property double y\nproperty double z\nelement face {faces}\n\
             property list uchar uint vertex_indices\nend_header\n"
        )?;
        for coordinate in self.vertices().iter().flat_map(|p| p.0) {
            out.write_all(&coordinate.to_le_bytes())?;
        }
        for face in self.elements() {
            out.write_all(&[3])?;
            for vertex in face {
                out.write_all(&vertex.to_le_bytes())?;
            }
        }
        Ok(())
    }

    fn write_glb(&self, mut out: impl Write) -> io::Result<()> {
        let (vertices, indices) = (self.vertices().len(), 3 * self.elements().len());
        let places = || self.vertices().iter().map(|p| p.0.map(|x| x as f32));
        let each = |of: fn(f32, f32) -> f32, from: f32| {
            let [x, y, z] =
                places().fold([from; 3], |all, p| std::array::from_fn(|i| of(all[i], p[i])));
            format!("[{x},{y},{z}]")
        };
        let (min, max) = (each(f32::min, f32::INFINITY), each(f32::max, f32::NEG_INFINITY));
        let mut bytes: Vec<u8> = places().flatten().flat_map(f32::to_le_bytes).collect();
        let middle = bytes.len();
        bytes.extend(self.elements().iter().flatten().flat_map(|vertex| vertex.to_le_bytes()));
        let (length, rest) = (bytes.len(), bytes.len() - middle);
        // 5126 and 5125: single precision and unsigned integers; 34962 and 34963: vertices and indices.
        let json = format!(
            r#"{{"asset":{{"version":"2.0","generator":"palpate"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3","min":{min},"max":{max}}},{{"bufferView":1,"componentType":5125,"count":{indices},"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{middle},"target":34962}},{{"buffer":0,"byteOffset":{middle},"byteLength":{rest},"target":34963}}],"buffers":[{{"byteLength":{length}}}]}}"#
        );
        let mut json = json.into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        // Header and heads of chunks; the data are numbers of 4 bytes.
        let all = 12 + 8 + json.len() + 8 + length;
        let too_long = |_| io::Error::other("a GLB has 4294967295 bytes at most");
        let number = |n: usize| u32::try_from(n).map(u32::to_le_bytes).map_err(too_long);
        out.write_all(b"glTF\x02\0\0\0")?;
        out.write_all(&number(all)?)?;
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &bytes)] {
            out.write_all(&number(chunk.len())?)?;
            out.write_all(kind)?;
            out.write_all(chunk)?;
        }
        Ok(())
    }
}
