//! One entry for each reader: any bytes are refused with an error, or read into a sound mesh that can be written.

use decimesh::document::{Document, Format, NamedFile, external_files};

fn named(name: &str, bytes: &[u8]) -> NamedFile {
    NamedFile { name: name.into(), bytes: bytes.to_vec() }
}

/// Opens; what opens is valid, is written in every format, and as glTF can be read again.
fn open(files: Vec<NamedFile>) {
    let Ok(document) = Document::open(files) else { return };
    let mesh = document.mesh();
    mesh.validate().expect("what is read is valid");
    assert_eq!(document.layout().groups.len(), mesh.groups.len());
    let written = document.write(mesh, Format::Glb).expect("what is read can be written");
    let again = Document::open(vec![named("written.glb", &written)]).expect("what is written can be read");
    assert_eq!(again.mesh().triangles.len(), mesh.triangles.len());
    // The world may be out of the range of numbers, which is an error and no fault.
    for format in Format::OUTPUT {
        let _ = document.write(mesh, format);
    }
}

/// A GLB whose bytes are all the fuzzer's.
pub fn glb(bytes: &[u8]) {
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(bytes);
    open(vec![named("m.glb", &file)]);
    open(vec![named("m.glb", bytes)]);
}

/// A .gltf and its buffer, apart from each other by a zero byte.
pub fn gltf(bytes: &[u8]) {
    let (json, buffer) = match bytes.iter().position(|&byte| byte == 0) {
        Some(end) => (&bytes[..end], &bytes[end + 1..]),
        None => (bytes, &[][..]),
    };
    open(vec![named("m.gltf", json), named("b.bin", buffer)]);
}

/// An OBJ without its library.
pub fn obj(bytes: &[u8]) {
    open(vec![named("m.obj", bytes)]);
}

/// A material library of a small OBJ that uses all its names.
pub fn mtl(bytes: &[u8]) {
    let obj = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 3/1 2/1 1/1\n";
    let png = named("a.png", b"\x89PNG\r\n\x1a\n");
    open(vec![named("m.obj", obj), named("m.mtl", bytes), png]);
}

/// A PLY; its first line is given.
pub fn ply(bytes: &[u8]) {
    let mut file = b"ply\n".to_vec();
    file.extend(bytes.strip_prefix(b"ply\n").unwrap_or(bytes));
    open(vec![named("m.ply", &file)]);
}

/// An STL, told by its name.
pub fn stl(bytes: &[u8]) {
    open(vec![named("m.stl", bytes)]);
}

/// An OFF, with or without its first line.
pub fn off(bytes: &[u8]) {
    let mut file = b"OFF\n".to_vec();
    file.extend(bytes);
    open(vec![named("m.off", &file)]);
    open(vec![named("m.off", bytes)]);
}

/// An SMF; its first line is given.
pub fn smf(bytes: &[u8]) {
    let mut file = b"#$SMF 1.0\n".to_vec();
    file.extend(bytes);
    open(vec![named("m.smf", &file)]);
}

/// The names in any file.
pub fn external(bytes: &[u8]) {
    let _ = external_files(bytes);
}
