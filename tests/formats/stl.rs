//! STL: text and binary, which is which, colours of facets, and every fault.

use decimesh::ErrorCode;
use decimesh::document::{Document, Format};

use super::{assert_round_trip, attribute, fault, file, open, points, warning_codes, write};

type Facet = ([[f32; 3]; 3], u16);

fn binary(header: &[u8], facets: &[Facet]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend((facets.len() as u32).to_le_bytes());
    for (corners, word) in facets {
        for c in [[0.0; 3]].iter().chain(corners).flatten() {
            bytes.extend(c.to_le_bytes());
        }
        bytes.extend(word.to_le_bytes());
    }
    bytes
}

const A: [f32; 3] = [0.0, 0.0, 0.0];
const B: [f32; 3] = [1.0, 0.0, 0.0];
const C: [f32; 3] = [0.0, 1.0, 0.0];
const D: [f32; 3] = [0.0, 0.0, 1.0];

fn pyramid(words: [u16; 4]) -> [Facet; 4] {
    [([A, C, B], words[0]), ([A, B, D], words[1]), ([B, C, D], words[2]), ([C, A, D], words[3])]
}

const TEXT: &str = "solid a pyramid\nfacet normal 0 0 -1\n outer loop\n  vertex 0 0 0\n  vertex 0 1 0\n  vertex 1 0 0\n endloop\nendfacet\n\
    facet normal nan nan nan\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 0 1\n endloop\nendfacet\nendsolid a pyramid\n";

#[test]
fn binary_facets_that_meet_share_their_vertices() {
    let document = open(binary(b"made by formula", &pyramid([0; 4])));
    assert_eq!(document.format(), Format::Stl);
    assert_eq!(document.mesh().positions, [A, C, B, D]);
    assert_eq!(document.mesh().triangles, [[0, 1, 2], [0, 2, 3], [2, 1, 3], [1, 0, 3]]);
    assert!(document.warnings().is_empty());
    let again = assert_round_trip(&document, Format::Stl);
    let written = write(&again, Format::Stl);
    assert_eq!(written.len(), 84 + 4 * 50);
    assert!(written.starts_with(b"made by formula"));
    // The normal of the first facet points down.
    assert_eq!(written[84..96], [0_f32, 0.0, -1.0].map(f32::to_le_bytes).concat());
}

#[test]
fn minus_zero_is_zero() {
    let facets = [([A, C, B], 0), ([[-0.0, 0.0, -0.0], B, D], 0)];
    assert_eq!(open(binary(b"", &facets)).mesh().positions.len(), 4);
}

#[test]
fn a_binary_file_may_begin_with_solid() {
    let document = open(binary(b"solid facet made by a CAD program", &pyramid([0; 4])));
    assert_eq!(document.mesh().triangles.len(), 4);
    assert!(!write(&document, Format::Stl).starts_with(b"solid"));
}

#[test]
fn text_with_one_solid_and_several() {
    let document = open(TEXT);
    assert_eq!((document.format(), document.mesh().triangles.len()), (Format::Stl, 2));
    assert_eq!(document.layout().groups[0].object.as_deref(), Some("a pyramid"));
    assert!(document.warnings().is_empty(), "normals do not matter");
    assert_round_trip(&document, Format::Stl);
    let two = open(format!("{TEXT}{}", TEXT.replace("a pyramid", "another")));
    assert_eq!(two.layout().groups.len(), 2);
    assert_eq!(two.layout().groups[1].object.as_deref(), Some("another"));
    assert_eq!(two.mesh().positions.len(), 4);
}

#[test]
fn text_as_programs_write_it() {
    for text in [
        TEXT.to_uppercase(),
        TEXT.replace('\n', "\r\n"),
        TEXT.replace("\n  ", " "),
        TEXT.replace("solid a pyramid", "solid"),
        format!("\u{FEFF} {TEXT}"),
        TEXT.replace("0 1 0", "0.0e+000 1.0E0 0."),
        TEXT.replace("endsolid a pyramid\n", ""),
    ] {
        let document = open(&text);
        assert_eq!(points(document.mesh()), points(open(TEXT).mesh()), "{text}");
    }
    let utf16: Vec<u8> = [0xFF, 0xFE].into_iter().chain(TEXT.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    // Its first bytes are no text of one byte each.
    assert_eq!(fault(utf16).0, ErrorCode::UnknownFormat);
}

#[test]
fn colours_of_viscam_are_kept() {
    let words = [0x8000 | 31 << 10, 0x8000 | 31 << 10, 0x8000 | 31, 0];
    let document = open(binary(b"", &pyramid(words)));
    let color = attribute(&document, "COLOR_0").unwrap();
    assert_eq!((color.components, &color.values[..3]), (3, &[1.0, 0.0, 0.0][..]));
    assert_eq!(words_of(&write(&document, Format::Stl)), words);
    assert_eq!(document.losses(Format::Stl), None);
    // Where facets of different colours meet there are as many wedges.
    assert_eq!(document.mesh().positions.len(), 4 + 3 + 3);
    assert_round_trip(&document, Format::Stl);
}

#[test]
fn colours_of_materialise_are_kept() {
    let words = [31, 31 << 10, 0x8000, 0x8000];
    let document = open(binary(b"COLOR=\x20\x40\x80\xFF,MATERIAL=", &pyramid(words)));
    let color = attribute(&document, "COLOR_0").unwrap();
    assert_eq!(color.values[..3], [1.0, 0.0, 0.0]);
    assert_eq!(color.values[color.values.len() - 3..], [32.0 / 255.0, 64.0 / 255.0, 128.0 / 255.0]);
    let written = write(&document, Format::Stl);
    assert_eq!(words_of(&written), words);
    assert!(written.starts_with(b"COLOR=\x20\x40\x80\xFF,MATERIAL="));
}

fn words_of(bytes: &[u8]) -> Vec<u16> {
    bytes[84..].chunks_exact(50).map(|facet| u16::from_le_bytes([facet[48], facet[49]])).collect()
}

#[test]
fn other_attribute_words_are_told() {
    assert_eq!(warning_codes(&open(binary(b"", &pyramid([1, 0, 0, 0])))), ["attribute-words-ignored"]);
}

#[test]
fn degenerate_facets_are_left_out() {
    let document = open(binary(b"", &[([A, B, B], 0), ([A, B, C], 0)]));
    assert_eq!(document.mesh().triangles.len(), 1);
    assert_eq!(document.warnings()[0].place, "model: facet 0");
}

#[test]
fn every_fault_has_its_code_and_place() {
    for (from, to, code, place) in [
        ("vertex 0 1 0", "vertex 0 1", ErrorCode::Syntax, "model:5"),
        ("vertex 0 1 0", "vertex 0 x 0", ErrorCode::Syntax, "model:5"),
        ("vertex 0 1 0", "vertex 0 inf 0", ErrorCode::NotFinite, "model:5"),
        (" endloop\nendfacet\nfacet", "facet", ErrorCode::Syntax, "model:7"),
    ] {
        let text = TEXT.replacen(from, to, 1);
        assert_ne!(text, TEXT);
        assert_eq!(fault(text), (code, place.to_owned()), "{to}");
    }
    let end = TEXT.find("  vertex 0 0 1").unwrap();
    assert_eq!(fault(&TEXT[..end]), (ErrorCode::Truncated, "model:13".into()));
    assert_eq!(fault(&TEXT[..end + 11]).0, ErrorCode::Truncated);
    let mut bad = binary(b"", &pyramid([0; 4]));
    bad[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(fault(bad), (ErrorCode::NotFinite, "model: facet 1".into()));
    assert_eq!(fault("solid empty\nendsolid empty\n").0, ErrorCode::NoTriangles);
}

#[test]
fn a_binary_file_that_was_cut_is_known_by_its_name() {
    let bytes = binary(b"", &pyramid([0; 4]));
    let open_named = |bytes: &[u8]| Document::open(vec![file("part.STL", bytes)]).map_err(|error| error.code());
    for length in [4, 83, 84, 85, 150, bytes.len() - 1] {
        assert_eq!(
            open_named(&bytes[..length]).err(),
            Some(if length < 84 { ErrorCode::UnknownFormat } else { ErrorCode::Truncated }),
            "{length}"
        );
    }
    let mut lying = bytes.clone();
    lying[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(open_named(&lying).err(), Some(ErrorCode::Truncated));
    let mut long = bytes;
    long.extend([1; 7]);
    assert_eq!(warning_codes(&open_named(&long).unwrap()), ["extra-bytes-ignored"]);
}
