// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes as bytes of files.

use std::borrow::Cow;
use std::io::{self, Write};

use gltf::binary::{Glb, Header};
use palpate_field::{Point, Vector};

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
        let triangles: Vec<_> = (0..self.elements().len())
            .map(|face| {
                let corners = self.corners(face);
                let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let normal = across.normalized().unwrap_or(Vector::ZERO);
                let single = |p: Point<3>| stl_io::Vector::new(p.0.map(|x| x as f32));
                stl_io::Triangle { normal: single(normal), vertices: corners.map(single) }
            })
            .collect();
        stl_io::write_stl(&mut out, triangles.iter())
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

    fn write_glb(&self, out: impl Write) -> io::Result<()> {
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
        let glb = Glb {
            // The writer counts the length.
            header: Header { magic: *b"glTF", version: 2, length: 0 },
            json: Cow::Owned(json.into_bytes()),
            bin: Some(Cow::Owned(bytes)),
        };
        glb.to_writer(out).map_err(io::Error::other)
    }
}
