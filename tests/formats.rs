//! PLY, STL, OFF and SMF in and out, materials of OBJ, and conversions between all formats; here,
//! what the tests share.
#![cfg(not(target_arch = "wasm32"))]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "helpers of tests may stop at the first surprise, too"
)]

#[path = "formats/arbitrary.rs"]
mod arbitrary;
#[path = "formats/assets.rs"]
mod assets;
#[path = "formats/conversions.rs"]
mod conversions;
#[path = "formats/materials.rs"]
mod materials;
#[path = "formats/off.rs"]
mod off;
#[path = "formats/ply.rs"]
mod ply;
#[path = "formats/smf.rs"]
mod smf;
#[path = "formats/stl.rs"]
mod stl;
mod support;

use decimesh::ErrorCode;
use decimesh::document::{Document, Format, NamedFile};
use decimesh::error::Error;
use decimesh::mesh::{Attribute, Mesh};

fn file(name: &str, bytes: impl Into<Vec<u8>>) -> NamedFile {
    NamedFile { name: name.into(), bytes: bytes.into() }
}

/// Opens bytes under a name that says nothing.
fn open_bytes(bytes: &[u8]) -> Result<Document, Error> {
    let document = Document::open(vec![file("model", bytes)])?;
    document.mesh().validate().expect("a mesh that was read is valid");
    Ok(document)
}

fn open(bytes: impl AsRef<[u8]>) -> Document {
    open_bytes(bytes.as_ref()).unwrap()
}

/// Code and place of the error that `bytes` give.
fn fault(bytes: impl AsRef<[u8]>) -> (ErrorCode, String) {
    let error = open_bytes(bytes.as_ref()).map(|_| ()).expect_err("should be refused");
    (error.code(), error.place().to_owned())
}

fn warning_codes(document: &Document) -> Vec<&'static str> {
    document.warnings().iter().map(|warning| warning.code).collect()
}

fn write(document: &Document, format: Format) -> Vec<u8> {
    document.write(document.mesh(), format).unwrap()
}

fn attribute<'a>(document: &'a Document, name: &str) -> Option<&'a Attribute> {
    document.mesh().wedge_sets[0].attributes.iter().find(|attribute| attribute.name == name)
}

/// Position and attributes (in the order of their names) of every corner of every triangle, as
/// bits: what must survive, wherever the wedges are.
fn corners(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut corners = Vec::new();
    for group in &mesh.groups {
        let set = &mesh.wedge_sets[group.wedge_set];
        let mut attributes: Vec<&Attribute> = set.attributes.iter().collect();
        attributes.sort_by(|a, b| a.name.cmp(&b.name));
        for &wedge in mesh.triangles[group.triangles.clone()].iter().flatten() {
            let wedge = wedge as usize;
            let mut bits: Vec<u32> = mesh.positions[wedge].iter().map(|c| c.to_bits()).collect();
            for attribute in &attributes {
                let start = (wedge - set.wedges.start) * attribute.components;
                bits.extend(attribute.values[start..start + attribute.components].iter().map(|c| c.to_bits()));
            }
            corners.push(bits);
        }
    }
    corners
}

/// Positions of the corners alone.
fn points(mesh: &Mesh) -> Vec<[f32; 3]> {
    mesh.triangles.iter().flatten().map(|&wedge| mesh.positions[wedge as usize]).collect()
}

/// Writes in `format`, reads again and expects the same corners.
fn assert_round_trip(document: &Document, format: Format) -> Document {
    let again = open(write(document, format));
    assert_eq!(again.format(), format);
    assert_eq!(corners(again.mesh()), corners(document.mesh()));
    assert_eq!(write(&again, format), write(&open(write(&again, format)), format), "the second time nothing changes");
    again
}
