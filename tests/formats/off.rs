//! OFF: every prefix, colours of vertices and faces, comments, and every fault.

use decimesh::ErrorCode;
use decimesh::document::Format;

use super::{assert_round_trip, attribute, fault, open, warning_codes, write};

const SQUARE: &str = "OFF\n# a square\n4 1 0\n\n0 0 0 # corner\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

#[test]
fn polygons_comments_and_counts_beside_the_keyword() {
    for text in [
        SQUARE.to_owned(),
        SQUARE.replace("OFF\n# a square\n", "OFF "),
        SQUARE.replace('\n', "\r\n"),
        format!("# first\n{SQUARE}"),
        SQUARE.replace("4 0 1 2 3", "4\n0 1\n2 3"),
        SQUARE.replace("4 1 0", "4 1"),
    ] {
        let document = open(&text);
        assert_eq!((document.format(), document.mesh().triangles.len()), (Format::Off, 2), "{text}");
        assert!(document.warnings().is_empty());
        assert_round_trip(&document, Format::Off);
    }
}

#[test]
fn every_prefix() {
    let text = "STCNOFF\n3 1 0\n0 0 0  0 0 1  255 0 51 255  0.5 1\n1 0 0  0 0 1  0 255 0 102  0 0\n0 1 0  0 0 1  0 0 255 255  1 1\n3 0 1 2\n";
    let document = open(text);
    assert_eq!(attribute(&document, "NORMAL").unwrap().values[..3], [0.0, 0.0, 1.0]);
    assert_eq!(attribute(&document, "TEXCOORD_0").unwrap().values[..2], [0.5, 1.0]);
    let color = attribute(&document, "COLOR_0").unwrap();
    assert_eq!((color.components, &color.values[..8]), (4, &[1.0, 0.0, 0.2, 1.0, 0.0, 1.0, 0.0, 0.4][..]));
    assert!(write(&document, Format::Off).starts_with(b"STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 51 255 0.5 1\n"));
    assert_round_trip(&document, Format::Off);
    for (prefix, row) in [("N", "0 0 1"), ("ST", "0 1"), ("C", "0 255 0"), ("NC", "")] {
        let rows = [0, 1, 2].map(|i| format!("{} {} 0 {row}", i % 2, i / 2)).join("\n");
        let text = format!("{prefix}OFF\n3 1 0\n{rows}\n3 0 1 2\n");
        if row.is_empty() {
            assert_eq!(fault(text).0, ErrorCode::UnknownFormat, "the prefixes have an order");
        } else {
            assert_round_trip(&open(text), Format::Off);
        }
    }
}

#[test]
fn colours_in_floats_stay_floats() {
    let document = open("COFF\n3 1 0\n0 0 0 0.1 0.2 0.3 1\n1 0 0 1.0 1.0 1.0 1.0\n0 1 0 0 0 0 0.5\n3 0 1 2\n");
    assert_eq!(attribute(&document, "COLOR_0").unwrap().values[..4], [0.1, 0.2, 0.3, 1.0]);
    assert_round_trip(&document, Format::Off);
}

#[test]
fn colours_of_faces() {
    let faces = "3 0 1 2 255 0 0\n3 0 2 3 0.0 0.0 1.0 1.0\n";
    let text = SQUARE.replace("4 1 0", "4 2 0").replace("4 0 1 2 3\n", faces);
    let document = open(text.replace("4 0 1 2 3", faces));
    assert_eq!(document.mesh().positions.len(), 6);
    assert_eq!(attribute(&document, "COLOR_0").unwrap().values[..3], [1.0, 0.0, 0.0]);
    assert_eq!(attribute(&document, "COLOR_0").unwrap().values[15..], [0.0, 0.0, 1.0]);
    let indexed = open(SQUARE.replace("4 0 1 2 3", "4 0 1 2 3 7"));
    assert_eq!(warning_codes(&indexed), ["face-colors-ignored"]);
}

#[test]
fn every_fault_has_its_code_and_place() {
    for (from, to, code, place) in [
        ("OFF\n", "4OFF\n", ErrorCode::Unsupported, "model:1"),
        ("OFF\n", "nOFF\n", ErrorCode::Unsupported, "model:1"),
        ("OFF\n", "OFF BINARY\n", ErrorCode::Unsupported, "model:1"),
        ("4 1 0", "4 -1 0", ErrorCode::OutOfRange, "model:3"),
        ("4 1 0", "4.5 1 0", ErrorCode::OutOfRange, "model:3"),
        ("4 1 0", "4000000000 1 0", ErrorCode::Truncated, "model:4"),
        ("4 1 0", "1e30 1 0", ErrorCode::Truncated, "model:4"),
        ("4 1 0", "4 x 0", ErrorCode::Syntax, "model:3"),
        ("4 1 0", "4 2 0", ErrorCode::Truncated, "model:10"),
        ("1 1 0", "1 nan 0", ErrorCode::NotFinite, "model:7"),
        ("1 1 0", "1 y 0", ErrorCode::Syntax, "model:7"),
        ("4 0 1 2 3", "4 0 1 2 4", ErrorCode::OutOfRange, "model:9"),
        ("4 0 1 2 3", "4 0 1 2 -1", ErrorCode::OutOfRange, "model:9"),
        ("4 0 1 2 3", "4000000000 0 1 2 3", ErrorCode::OutOfRange, "model:9"),
        ("4 0 1 2 3", "4 0 1 2", ErrorCode::Truncated, "model:10"),
        ("4 0 1 2 3", "2 0 1", ErrorCode::NoTriangles, "model"),
    ] {
        let text = SQUARE.replacen(from, to, 1);
        assert_ne!(text, SQUARE);
        assert_eq!(fault(text), (code, place.to_owned()), "{to}");
    }
}
