//! SMF: bindings, blocks and transformations, and every fault.

use decimesh::ErrorCode;
use decimesh::document::Format;

use super::{assert_round_trip, attribute, fault, open, warning_codes, write};

const TRIANGLE: &str = "#$SMF 1.0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn vertices_faces_polygons() {
    let document = open(TRIANGLE);
    assert_eq!((document.format(), &document.mesh().triangles[..]), (Format::Smf, &[[0, 1, 2]][..]));
    let square = open("#$SMF 1.0\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf -3 -2 -1\n");
    assert_eq!(square.mesh().triangles.len(), 3);
    assert_eq!(square.mesh().triangles[2], [1, 2, 3]);
    assert_eq!(
        String::from_utf8(write(&document, Format::Smf)).unwrap(),
        "#$SMF 1.0\n#$vertices 3\n#$faces 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    );
    assert_round_trip(&square, Format::Smf);
}

#[test]
fn without_its_comment_it_is_known_by_statements_of_its_own() {
    let body = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(open(body).format(), Format::Obj, "nothing tells them apart, nor need it");
    for own in ["begin\nend\n", "bind c vertex\n", "trans 1 2 3\n", "rot x 90\n"] {
        assert_eq!(open(format!("{body}{own}")).format(), Format::Smf, "{own}");
    }
}

#[test]
fn bindings() {
    let values = "bind n vertex\nn 0 0 1\nn 0 0 1\nn 0 0 1\nbind c vertex\nc 1 0 0\nc 0 1 0\nc 0 0 1\nbind r vertex\nr 0 0\nr 1 0\nr 0 1\n";
    let document = open(format!("{TRIANGLE}{values}"));
    assert_eq!(attribute(&document, "NORMAL").unwrap().values[..3], [0.0, 0.0, 1.0]);
    assert_eq!(attribute(&document, "COLOR_0").unwrap().values[..3], [1.0, 0.0, 0.0]);
    assert_eq!(attribute(&document, "TEXCOORD_0").unwrap().values[2..4], [1.0, 0.0]);
    assert!(document.warnings().is_empty());
    assert_round_trip(&document, Format::Smf);
    let faces = open(format!("{TRIANGLE}f 3 2 1\nbind c face\nc 1 0 0\nc 0 1 0\nbind n face\nn 0 0 1\nn 0 0 -1\n"));
    assert_eq!(faces.mesh().positions.len(), 6);
    assert_eq!(attribute(&faces, "NORMAL").unwrap().values[15..], [0.0, 0.0, -1.0]);
    assert_round_trip(&faces, Format::Smf);
    for values in ["c 1 0 0\n", "bind c vertex\nc 1 0 0\n", "bind n none\nn 0 0 1\n"] {
        let document = open(format!("{TRIANGLE}{values}"));
        assert_eq!(warning_codes(&document), ["values-ignored"], "{values}");
        assert!(document.mesh().wedge_sets[0].attributes.is_empty());
    }
}

#[test]
fn blocks_count_anew_and_move() {
    let block = |transform: &str| format!("begin\n{transform}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nend\n");
    let text = format!("{TRIANGLE}{}{}", block("trans 5 0 0\nscale 2 1 1"), block("rot z 90\ntrans 0 0 1"));
    let document = open(text);
    let mesh = document.mesh();
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    assert_eq!(mesh.positions[3..6], [[5.0, 0.0, 0.0], [7.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
    assert_eq!(mesh.positions[6..9], [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 0.0, 1.0]]);
    // Blocks within blocks, a matrix, and what comes after counts from the start again.
    let nested = "begin\ntrans 1 0 0\nbegin\nmmult 1 0 0 0 0 1 0 0 0 0 1 7 0 0 0 1\nv 0 0 0\nend\nend\nf 1 2 3\n";
    let document = open(format!("{TRIANGLE}{nested}"));
    assert_eq!(document.mesh().positions[3], [1.0, 0.0, 7.0]);
    assert_eq!(document.mesh().triangles[1], [0, 1, 2]);
    let corrected =
        open(format!("{TRIANGLE}v 5 5 5\nset vertex_correction 1\nf 1 2 3\ndec vertex_correction\nf 1 2 3\n"));
    assert_eq!(corrected.mesh().triangles[1..], [[1, 2, 3], [0, 1, 2]]);
}

#[test]
fn other_statements_are_told() {
    let document = open(format!("{TRIANGLE}set solidity 5\nt 0 0 0\ntex x.png\nbind r face\n"));
    assert_eq!(warning_codes(&document), ["unknown-statement", "unknown-binding"]);
    assert!(document.warnings()[0].message.starts_with('3'), "{:?}", document.warnings());
}

#[test]
fn every_fault_has_its_code_and_place() {
    for (statement, code) in [
        ("v 0 0\nv 0 0 0", ErrorCode::Syntax),
        ("v 0 a 0", ErrorCode::Syntax),
        ("v 0 inf 0", ErrorCode::NotFinite),
        ("f 1 2 4", ErrorCode::OutOfRange),
        ("f 1 2 0", ErrorCode::OutOfRange),
        ("f 1 2 -4", ErrorCode::OutOfRange),
        ("f 1 2 1.5", ErrorCode::OutOfRange),
        ("f 1 2 x", ErrorCode::Syntax),
        ("end", ErrorCode::Syntax),
        ("rot w 90", ErrorCode::Syntax),
        ("mload 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0.5 1", ErrorCode::Unsupported),
        ("trans 1e38 0 0\nscale 1e38 1 1\nv 1e38 0 0", ErrorCode::NotFinite),
    ] {
        let (found, place) = fault(format!("{TRIANGLE}{statement}\nv 1 1 1\n"));
        assert_eq!(found, code, "{statement}");
        let line = if statement.starts_with("trans") { 8 } else { 6 };
        assert_eq!(place, format!("model:{line}"), "{statement}");
    }
    assert_eq!(fault(format!("{TRIANGLE}f 1 2")).0, ErrorCode::Truncated);
    assert_eq!(fault(format!("{TRIANGLE}{}", "begin\n".repeat(100_000))).0, ErrorCode::TooLarge);
    assert_eq!(fault("#$SMF 1.0\nv 0 0 0\n").0, ErrorCode::NoTriangles);
}
