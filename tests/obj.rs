//! OBJ in and out: every feature and every fault on a file of a few lines, then real files.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "helpers of tests may stop at a surprise")]
#![allow(clippy::print_stdout, reason = "skipping is said aloud")]

use std::path::{Path, PathBuf};

use decimesh::ErrorCode;
use decimesh::document::{Document, Format, NamedFile};
use decimesh::error::Error;
use decimesh::mesh::Mesh;

fn open_bytes(bytes: &[u8]) -> Result<Document, Error> {
    let file = NamedFile { name: "model.obj".into(), bytes: bytes.to_vec() };
    let document = Document::open(vec![file])?;
    document.mesh().validate().expect("a mesh that was read is valid");
    Ok(document)
}

fn open(text: &str) -> Document {
    open_bytes(text.as_bytes()).unwrap()
}

/// Code and place of the error that `text` gives.
fn fault(text: &str) -> (ErrorCode, String) {
    let error = open_bytes(text.as_bytes()).map(|_| ()).expect_err(text);
    (error.code(), error.place().to_owned())
}

/// Without the material libraries that these tests name and do not give.
fn warnings(document: &Document) -> Vec<(&'static str, String)> {
    let warnings = document.warnings().iter().filter(|warning| warning.code != "missing-material-library");
    warnings.map(|warning| (warning.code, warning.place.clone())).collect()
}

fn write(document: &Document) -> String {
    String::from_utf8(document.write(document.mesh(), Format::Obj).unwrap()).unwrap()
}

/// Position and attributes of every corner of every triangle, as bits: what must survive.
fn corners(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut corners = Vec::new();
    for group in &mesh.groups {
        let set = &mesh.wedge_sets[group.wedge_set];
        for &wedge in mesh.triangles[group.triangles.clone()].iter().flatten() {
            let wedge = wedge as usize;
            let mut bits: Vec<u32> = mesh.positions[wedge].iter().map(|c| c.to_bits()).collect();
            for attribute in &set.attributes {
                let start = (wedge - set.wedges.start) * attribute.components;
                bits.extend(attribute.values[start..start + attribute.components].iter().map(|c| c.to_bits()));
            }
            corners.push(bits);
        }
    }
    corners
}

fn attribute_names(document: &Document, group: usize) -> Vec<&str> {
    let mesh = document.mesh();
    mesh.wedge_sets[mesh.groups[group].wedge_set].attributes.iter().map(|a| a.name.as_str()).collect()
}

/// Object, `g`, material of each group.
fn labels(document: &Document) -> Vec<[Option<&str>; 3]> {
    let labels = &document.layout().groups;
    labels.iter().map(|l| [l.object.as_deref(), l.group.as_deref(), l.material.as_deref()]).collect()
}

/// Writes, reads again, and expects the same. Wedges of interleaved groups come in another order
/// the second time; after that the text itself must not change any more.
fn assert_round_trip(document: &Document) {
    let text = write(document);
    let again = open(&text);
    assert_eq!(corners(again.mesh()), corners(document.mesh()));
    assert_eq!(labels(&again), labels(document));
    assert_eq!(again.layout().material_libraries, document.layout().material_libraries);
    let text = write(&again);
    assert_eq!(write(&open(&text)), text);
    assert_eq!(warnings(&again), []);
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

// --- Reading: features ------------------------------------------------------------------------

#[test]
fn positions_only_wedges_are_the_vertices() {
    let document = open("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 4 2 3\n");
    assert_eq!(document.format(), Format::Obj);
    assert_eq!(document.mesh().positions, [[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(document.mesh().triangles, [[3, 1, 2]]);
    assert_eq!((document.mesh().groups.len(), document.mesh().parts[0].scale), (1, 1.0));
    assert!(document.warnings().is_empty());
}

#[test]
fn blanks_line_ends_comments_and_continued_lines() {
    let plain = open("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for text in [
        "\u{FEFF}# c\r\n\r\n  v\t0  0 0 \r\n\tv 1 0 0 # c\r\nv 0 1 0 # 7\r\nf 1 2 3 \t\r\n",
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
        "v 0 0 \\\n0\nv \\\r\n1 0 0\nv 0 1 0\nf 1\\\n \\\n2 3 # \\\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",
        "# not a continuation \\\nv 0 0 0\nv 1.0e0 -0e5 +.0\nv 0. 100e-2 0\nf 1 2 3\n",
        "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1// 2/ 3//\n",
    ] {
        assert_eq!(open(text).mesh(), plain.mesh(), "{text:?}");
    }
}

#[test]
fn a_place_is_right_after_continued_lines_and_carriage_returns() {
    let text = "v 0 0 \\\n0\r\nv 1 0 0\rv 0 1 0\n# c \\\nusemtl a \\\n b\nf 1 2 9\n";
    assert_eq!(fault(text), (ErrorCode::OutOfRange, "model.obj:8".into()));
}

#[test]
fn attributes_and_shared_wedges() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nvt 1\nvt 0.5 1 0\nvn 0 0 1\nvn 0 1 0\n\
                f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/2 4/1/1\n";
    let mesh = open(text).mesh().clone();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 4]]);
    let [normal, texcoord] = mesh.wedge_sets[0].attributes.as_slice() else { panic!("two attributes") };
    assert_eq!((normal.name.as_str(), texcoord.name.as_str()), ("NORMAL", "TEXCOORD_0"));
    assert_eq!(texcoord.values, [0.0, 0.25, 1.0, 0.0, 0.5, 1.0, 0.5, 1.0, 0.0, 0.25]);
    assert_eq!(normal.values[6..12], [0.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    assert_round_trip(&open(text));
}

#[test]
fn faces_with_different_attributes_go_to_different_wedge_sets() {
    let text =
        format!("{TRIANGLE}vt 0 1\nvn 0 0 1\nf 1/1 2/1 3/1\nf 1 2 3\nf 1//1 2//1 3//1\nf 3/1 2/1 1/1\nf 1/1 2 3/1\n");
    let document = open(&text);
    assert_eq!(document.mesh().groups.len(), 3);
    assert_eq!(document.mesh().triangles.len(), 5);
    assert_eq!(document.mesh().wedge_sets.len(), 3);
    assert_eq!(document.mesh().parts.len(), 1, "one part, so that the sets weld");
    let names: Vec<_> = (0..3).map(|group| attribute_names(&document, group)).collect();
    assert_eq!(names, [vec!["TEXCOORD_0"], vec![], vec!["NORMAL"]]);
    assert_eq!(warnings(&document), [("mixed-corners", "model.obj:10".into())]);
    assert_round_trip(&document);
}

#[test]
fn negative_indices_count_back_from_the_face() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf -3/-1/-1 -2/1/1 -1/-1/1\nv 5 5 5\nf -1//1 -2//1 -3//1\n";
    let mesh = open(text).mesh().clone();
    let x: Vec<f32> = mesh.triangles.iter().flatten().map(|&wedge| mesh.positions[wedge as usize][0]).collect();
    assert_eq!(x, [0.0, 1.0, 0.0, 5.0, 0.0, 1.0]);
}

#[test]
fn colours_on_vertices() {
    let document = open("v 0 0 0\nv 1 0 0 0.5 0.25 0\nv 0 1 0\nf 1 2 3\n");
    let color = &document.mesh().wedge_sets[0].attributes[0];
    assert_eq!((color.name.as_str(), color.components), ("COLOR_0", 3));
    assert_eq!(color.values, [1.0, 1.0, 1.0, 0.5, 0.25, 0.0, 1.0, 1.0, 1.0]);
    assert_round_trip(&document);
    let document = open("v 0 0 0 1 0 0 0.5\nv 1 0 0 0.5 0.25 0 1\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    let color = &document.mesh().wedge_sets[0].attributes[1];
    assert_eq!((color.components, color.values[..4].to_vec()), (4, vec![1.0, 0.0, 0.0, 0.5]));
    assert_round_trip(&document);
    let document = open("v 0 0 0 2\nv 1 0 0 1 \nv 0 1 0 1 2\nf 1 2 3\n");
    assert!(attribute_names(&document, 0).is_empty());
    assert_eq!(
        warnings(&document),
        [("vertex-weight-ignored", "model.obj:1".into()), ("extra-numbers-ignored", "model.obj:3".into())]
    );
}

#[test]
fn names_make_groups_in_order_of_first_appearance() {
    let text = format!(
        "mtllib a b.mtl c.MTL  d.mtl\nmtllib c.MTL\n{TRIANGLE}f 1 2 3\no Part one\nusemtl red \nf 1 2 3\ng x y\nf 1 2 3\n\
         usemtl blue#2\nf 1 2 3\no Part one\ng\nusemtl red\nf 3 2 1\no two\nusemtl\nf 1 2 3\n"
    );
    let document = open(&text);
    assert_eq!(
        labels(&document),
        [
            [None, None, None],
            [Some("Part one"), None, Some("red")],
            [Some("Part one"), Some("x y"), Some("red")],
            [Some("Part one"), Some("x y"), Some("blue#2")],
            [Some("two"), None, None],
        ]
    );
    assert_eq!(document.layout().material_libraries, ["a b.mtl", "c.MTL", "d.mtl"]);
    let counts: Vec<usize> = document.mesh().groups.iter().map(|group| group.triangles.len()).collect();
    assert_eq!(counts, [1, 2, 1, 1, 1]);
    let primitives: Vec<_> = document.layout().groups.iter().map(|label| (label.mesh, label.primitive)).collect();
    assert_eq!(primitives, [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4)]);
    assert_round_trip(&document);
}

#[test]
fn smoothing_groups_are_kept_where_a_group_has_one() {
    let text = format!("{TRIANGLE}s 2\ng a\nf 1 2 3\ng b\ns off\nf 1 2 3\ng c\nf 1 2 3\ns 1\nf 1 2 3\n");
    let document = open(&text);
    assert_eq!(warnings(&document), [("smoothing-groups-merged", "model.obj:13".into())]);
    let lines = write(&document);
    let lines: Vec<&str> = lines.lines().filter(|line| "gsf".contains(&line[..1])).collect();
    assert_eq!(lines, ["g a", "s 2", "f 1 2 3", "g b", "s off", "f 1 2 3", "g c", "f 1 2 3", "f 1 2 3"]);
}

#[test]
fn names_need_not_be_utf8() {
    let document = open_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl caf\xE9\nf 1 2 3\n").unwrap();
    assert_eq!(document.layout().groups[0].material.as_deref(), Some("caf\u{FFFD}"));
    assert_eq!(warnings(&document), [("name-not-utf8", "model.obj:4".into())]);
}

#[test]
fn what_is_no_triangle_is_left_out_with_one_warning_each() {
    let text = format!(
        "{TRIANGLE}p 1 2\nl 1 2\nl 2 3\ncstype bezier\ncurv 0 1 1 2 \\\n 3\nend\nlod 3\nwobble\n 17\nf 1 2\nf 1 2 3\nf 1 2 2\nf 1 1 1 2\n"
    );
    let document = open(&text);
    assert_eq!(document.mesh().triangles, [[0, 1, 2]]);
    let expected = [
        ("points-ignored", 4),
        ("lines-ignored", 5),
        ("free-form-ignored", 7),
        ("display-ignored", 11),
        ("unknown-statement", 12),
        ("face-too-small", 14),
        ("degenerate-face", 16),
    ];
    assert_eq!(warnings(&document), expected.map(|(code, line)| (code, format!("model.obj:{line}"))));
    assert_eq!(document.warnings()[1].message, "2 line elements (l) left out");
}

// --- Reading: polygons ------------------------------------------------------------------------

/// Area of all triangles of a mesh in the plane z = 0, and the least of them, with sign.
fn areas(mesh: &Mesh) -> (f32, f32) {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|wedge| mesh.positions[wedge as usize]);
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
    };
    mesh.triangles.iter().map(area).fold((0.0, f32::INFINITY), |(sum, least), a| (sum + a, least.min(a)))
}

#[test]
fn polygons_are_triangulated_inside() {
    // An L, a quad with a reflex corner, and a square with a point on an edge.
    let shapes: [(&str, usize, f32); 3] = [
        ("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 4 5 6 1 2 3\n", 4, 3.0),
        ("v 0 0 0\nv 10 1 0\nv 0 2 0\nv 8 1 0\nf 1 2 3 4\n", 2, 2.0),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n", 3, 4.0),
    ];
    for (text, count, expected) in shapes {
        let document = open(text);
        assert_eq!(document.mesh().triangles.len(), count, "{text}");
        let (sum, least) = areas(document.mesh());
        assert!((sum - expected).abs() < 1e-5 && least > 0.0, "{text}: {sum} {least}");
        assert!(document.warnings().is_empty());
    }
}

#[test]
fn a_polygon_with_a_repeated_corner_loses_a_triangle() {
    let document = open("v 0 0 0\nv 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4 5 1\n");
    assert_eq!(document.mesh().triangles.len(), 2);
    assert_eq!(areas(document.mesh()).0, 1.0);
    assert_eq!(warnings(&document), [("degenerate-triangle", "model.obj:6".into())]);
}

#[test]
fn huge_concave_polygons_end_in_time() {
    // A ring of 50,000 ragged spikes; quadratic work would take minutes.
    let radius = |i: u32| 1.0 + f64::from(i % 2) * 0.5 + f64::from(i % 7) * 0.01;
    let ring = polygon(100_000, |i| {
        let angle = f64::from(i) / 100_000.0 * std::f64::consts::TAU;
        [radius(i) * angle.cos(), radius(i) * angle.sin()]
    });
    let document = open(&ring);
    assert_eq!((document.mesh().triangles.len(), document.warnings().len()), (99_998, 0));
    assert!(areas(document.mesh()).1 >= 0.0);
    // A comb across the axes, so that the box of every tooth is all of it: done roughly, and said.
    let comb = polygon(100_001, |i| match i {
        100_000 => [200_000.0, 0.0],
        _ => [f64::from(i) + f64::from(i % 2) * 90_000.0, f64::from(i % 2) * 90_000.0 + 1.0],
    });
    let document = open(&comb);
    assert_eq!(document.mesh().triangles.len(), 99_999);
    assert_eq!(warnings(&document), [("polygon-not-simple", "model.obj:100002".into())]);
}

/// A file of one polygon in the plane.
fn polygon(count: u32, corner: impl Fn(u32) -> [f64; 2]) -> String {
    let mut text = String::new();
    for i in 0..count {
        let [x, y] = corner(i);
        text += &format!("v {x} {y} 0\n");
    }
    text += "f";
    (1..=count).for_each(|i| text += &format!(" {i}"));
    text + "\n"
}

// --- Reading: faults --------------------------------------------------------------------------

#[test]
fn faults_have_code_and_place() {
    use ErrorCode::{NotFinite, OutOfRange, Syntax, Truncated};
    let cases: [(&str, ErrorCode, usize); 26] = [
        ("f 0 1 2\n", OutOfRange, 4),
        ("f 1 2 4\n", OutOfRange, 4),
        ("f 1 2 -4\n", OutOfRange, 4),
        ("f 1 2 -0\n", OutOfRange, 4),
        ("f 1 2 4000000000\n", OutOfRange, 4),
        ("f 1 2 4294967296\n", OutOfRange, 4),
        ("f 1 2 99999999999999999999999999\n", OutOfRange, 4),
        ("f 1 2 3 4 3 2 1\n# c\n", OutOfRange, 4),
        ("f 1 2 3\n\nf 1 2 x\n", Syntax, 6),
        ("f 1 2 3.5\n", Syntax, 4),
        ("f 1 2 3/1/1/1\n", Syntax, 4),
        ("f 1 2 /1\n", Syntax, 4),
        ("f 1 2 -\n", Syntax, 4),
        ("v 1 2\nf 1 2 3\n", Syntax, 4),
        ("v\nf 1 2 3\n", Syntax, 4),
        ("v 1 2 three\nf 1 2 3\n", Syntax, 4),
        ("v 1,0 2,0 3,0\nf 1 2 3\n", Syntax, 4),
        ("v 1 2 3 red\nf 1 2 3\n", Syntax, 4),
        ("vn 0 1\nf 1 2 3\n", Syntax, 4),
        ("vt\nf 1 2 3\n", Syntax, 4),
        ("v nan 0 0\nf 1 2 3\n", NotFinite, 4),
        ("v 0 -1.#IND 0\nf 1 2 3\n", NotFinite, 4),
        ("vt 0 1e39\nf 1 2 3\n", NotFinite, 4),
        ("vn 0 0 -Infinity\nf 1 2 3\n", NotFinite, 4),
        ("f 1 2 3\nv 1 2", Truncated, 5),
        ("f 1 2 3\nf 1 2", Truncated, 5),
    ];
    for (text, code, line) in cases {
        assert_eq!(fault(&format!("{TRIANGLE}{text}")), (code, format!("model.obj:{line}")), "{text}");
    }
    assert_eq!(fault(&format!("{TRIANGLE}f 1 2 3\nv 1 2 3e-")), (Truncated, "model.obj:5".into()));
}

#[test]
fn attribute_indices_to_nothing_are_left_out() {
    let document = open(&format!("{TRIANGLE}vt 0 0\nf 1/1/1 2/1/2 3/1/1\nf 1/1 2/0 3/2\nf 1/-9 2/1 3/1\n"));
    assert_eq!(document.mesh().triangles.len(), 3);
    assert_eq!(attribute_names(&document, 0), ["TEXCOORD_0"]);
    assert!(attribute_names(&document, 1).is_empty());
    let found = warnings(&document);
    assert_eq!(found, [("dangling-index", "model.obj:5".into()), ("mixed-corners", "model.obj:6".into())]);
    // An element that comes later is not missing.
    let document = open(&format!("{TRIANGLE}f 1/1 2/1 3/1\nvt 0 0\n"));
    assert_eq!(attribute_names(&document, 0), ["TEXCOORD_0"]);
    assert!(document.warnings().is_empty());
}

#[test]
fn other_content_is_not_obj() {
    let prose = "Once upon a time\nv for victory, and 3 more\no brother\nf is the sixth letter\n".repeat(20);
    let contents: [&[u8]; 6] = [
        b"",
        b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\nv 0 0 0\n",
        b"<!DOCTYPE html>\n<html>\nv 0 0 0\n</html>",
        prose.as_bytes(),
        b"\xFE\xFF\x00O\x00n\x00c\x00e\x00 \x00u\x00p",
        &[0x7F; 1000],
    ];
    for content in contents {
        let code = open_bytes(content).map(|_| ()).expect_err("not OBJ").code();
        assert_eq!(code, ErrorCode::UnknownFormat, "{:?}", String::from_utf8_lossy(content));
    }
    for text in ["o empty\n", "# c\n\nmtllib a.mtl\n", "v 1 2 3\n", "  vt 0.5 0.5\nvt 1 1\n"] {
        assert_eq!(fault(text).0, ErrorCode::NoTriangles, "{text}");
    }
}

// --- Writing ----------------------------------------------------------------------------------

#[test]
fn the_text_is_exact() {
    let text = "mtllib a.mtl\no thing\ng left\nusemtl red\nv 0.1 -0 1e-20 1 0.5 0\nv 16777216 0 0\nv 0 1 0\nv 0 1 0\nv 7 7 7\n\
                vt 0 0.5\nvt 0 0.5\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\nf 2/1/1 1/1/1 4/1/1\n";
    let expected = "# Decimesh\nmtllib a.mtl\nv 0.1 -0 1e-20 1 0.5 0\nv 16777216 0 0 1 1 1\nv 0 1 0 1 1 1\nvt 0 0.5\nvn 0 0 1\n\
                    o thing\ng left\nusemtl red\nf 1/1/1 2/1/1 3/1/1\nf 2/1/1 1/1/1 3/1/1\n";
    assert_eq!(write(&open(text)), expected);
}

#[test]
fn a_mesh_in_the_place_of_the_original() {
    let document = open(&format!("{TRIANGLE}v 1 1 0\ng a\nf 1 2 3\ng b\nf 2 4 3\n"));
    let mut mesh = document.mesh().clone();
    mesh.triangles.remove(0);
    mesh.groups[0].triangles = 0..0;
    mesh.groups[1].triangles = 0..1;
    let bytes = document.write(&mesh, Format::Obj).unwrap();
    assert_eq!(String::from_utf8(bytes).unwrap(), "# Decimesh\nv 1 0 0\nv 0 1 0\nv 1 1 0\ng b\nf 1 3 2\n");
}

// --- Real files -------------------------------------------------------------------------------

fn fixture(name: &str) -> Result<Document, Error> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/obj").join(name);
    open_bytes(&std::fs::read(path).unwrap())
}

#[test]
fn fixtures_read_as_expected_and_round_trip() {
    let expected: [(&str, usize, usize, &[&str]); 9] = [
        ("box-incomplete-normals.obj", 12, 2, &["dangling-index"]),
        ("box-mixed-attributes.obj", 12, 4, &[]),
        ("box-negative-indices.obj", 12, 1, &[]),
        ("concave.obj", 16, 1, &[]),
        ("cube-vertexcol.obj", 12, 6, &[]),
        ("cube_mtllib_after_g.obj", 12, 1, &[]),
        ("eof_test.obj", 1, 1, &[]),
        ("issue-161-inconsistent-f.obj", 12, 2, &["smoothing-groups-merged"]),
        ("issue-319-003.obj", 8, 1, &[]),
    ];
    for (name, triangles, groups, codes) in expected {
        let document = fixture(name).unwrap();
        let found: Vec<&str> = warnings(&document).into_iter().map(|(code, _)| code).collect();
        let counts = (document.mesh().triangles.len(), document.mesh().groups.len());
        assert_eq!((counts, found.as_slice()), ((triangles, groups), codes), "{name}");
        assert_round_trip(&document);
    }
    let error = fixture("inf_nan.obj").map(|_| ()).unwrap_err();
    assert_eq!((error.code(), error.place()), (ErrorCode::NotFinite, "model.obj:1"));
}

/// Every `.obj` below `folder`, sorted.
fn obj_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            obj_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "obj") {
            found.push(path);
        }
    }
}

/// Files whose triangle count is not the manifest's, which counts corners - 2 of every face.
const OTHER_COUNTS: [(&str, Result<usize, ErrorCode>, &str); 8] = [
    ("invalid/draco/inf_nan.obj", Err(ErrorCode::NotFinite), "NaN and infinity"),
    ("invalid/magnum-obj/invalid-mixed-primitives.obj", Err(ErrorCode::NoTriangles), "both faces repeat a vertex"),
    ("invalid/obj/invalid-relative-texture-index.obj", Err(ErrorCode::OutOfRange), "no vertices"),
    ("misc/trimesh/capsule/capsule.obj", Ok(10_000), "200 faces have two corners at one point"),
    ("nasty/deg_faces.obj", Ok(3), "one face repeats a vertex"),
    ("obj/assimp/box_UTF16BE.obj", Ok(12), "the manifest's maker did not read UTF-16"),
    ("obj/assimp/number_formats.obj", Err(ErrorCode::Syntax), "3.1+e2 is no number"),
    ("obj/assimp/spider/spider.obj", Ok(1312), "56 faces have two corners at one point"),
];

#[test]
fn every_shared_asset() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    let Ok(manifest) = std::fs::read(root.join("MANIFEST.tsv")) else {
        println!("SKIPPED every_shared_asset: ../shared/assets is absent");
        return;
    };
    let manifest = String::from_utf8_lossy(&manifest);
    let count_of = |path: &str| -> Option<usize> {
        let row = manifest.lines().find(|line| line.split('\t').next() == Some(path))?;
        row.split('\t').nth(4)?.parse().ok()
    };
    let mut files = Vec::new();
    for folder in ["obj", "misc", "nasty", "invalid"] {
        obj_files(&root.join(folder), &mut files);
    }
    assert!(files.len() > 100);
    for path in files {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
        let result = open_bytes(&std::fs::read(&path).unwrap());
        let found = result.as_ref().map(|document| document.mesh().triangles.len()).map_err(Error::code);
        let listed = OTHER_COUNTS.iter().find(|(path, ..)| *path == name).map(|(_, expected, _)| *expected);
        match (listed, count_of(&name)) {
            (Some(expected), _) => assert_eq!(found, expected, "{name}"),
            (None, Some(0)) => {
                assert!(matches!(found, Err(ErrorCode::NoTriangles | ErrorCode::UnknownFormat)), "{name}");
            }
            (None, Some(count)) if name == "obj/tinyobjloader/issue-319-002.obj" => {
                assert_eq!(found, Ok(count - 1), "{name}: one polygon has two corners at one point");
            }
            (None, Some(count)) => assert_eq!(found, Ok(count), "{name}"),
            (None, None) => {}
        }
        if let Ok(document) = &result {
            assert_round_trip(document);
        }
    }
}

// --- Properties -------------------------------------------------------------------------------

#[cfg(not(target_arch = "wasm32"))]
mod properties {
    use proptest::prelude::*;

    use super::{assert_round_trip, open_bytes};

    /// A number as files have them, mostly valid.
    fn number() -> impl Strategy<Value = String> {
        prop_oneof![
            10 => (-20_i8..20).prop_map(|i| format!("{}", f32::from(i) / 4.0)),
            4 => any::<f32>().prop_filter("finite", |value| value.is_finite()).prop_map(|value| value.to_string()),
            1 => "[-+.0-9eEnai]{0,6}",
        ]
    }

    fn corner() -> impl Strategy<Value = String> {
        let index =
            || prop_oneof![12 => (1..9_i8).prop_map(|i| i.to_string()), 2 => (-4..1_i8).prop_map(|i| i.to_string())];
        prop_oneof![
            4 => index(),
            2 => (index(), index()).prop_map(|(v, vt)| format!("{v}/{vt}")),
            2 => (index(), index()).prop_map(|(v, vn)| format!("{v}//{vn}")),
            2 => (index(), index(), index()).prop_map(|(v, vt, vn)| format!("{v}/{vt}/{vn}")),
        ]
    }

    fn line() -> impl Strategy<Value = String> {
        let numbers = |count| prop::collection::vec(number(), count).prop_map(|n| n.join(" "));
        prop_oneof![
            4 => numbers(3..4).prop_map(|n| format!("v {n}")),
            1 => numbers(0..9).prop_map(|n| format!("v {n}")),
            2 => numbers(2..3).prop_map(|n| format!("vt {n}")),
            2 => numbers(3..4).prop_map(|n| format!("vn {n}")),
            6 => prop::collection::vec(corner(), 3..7).prop_map(|c| format!("f {}", c.join(" "))),
            2 => ("o|g|usemtl|mtllib|s|l|p|#|curv|x", "[ -~\\\\]{0,6}").prop_map(|(k, rest)| format!("{k} {rest}")),
        ]
    }

    fn soup() -> impl Strategy<Value = String> {
        let start = (0..8).map(|i| format!("v {} {} {}\nvt {i} 0\nvn 0 {i} 1\n", i % 2, i / 2 % 2, i / 4));
        let start: String = start.collect();
        prop::collection::vec(line(), 0..12).prop_map(move |lines| start.clone() + &lines.join("\n") + "\nf 1 2 3\n")
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut text = b"v 0 0 0\n".to_vec();
            text.extend(bytes);
            let _ = open_bytes(&text);
        }

        #[test]
        fn any_text_of_the_alphabet_is_read_or_refused(text in "v 0 0 0\n[vfntosg#/ \\-+.0-9e\\\\\r\n\t]{0,200}") {
            if let Ok(document) = open_bytes(text.as_bytes()) {
                assert_round_trip(&document);
            }
        }

        #[test]
        fn what_was_read_survives_writing(text in soup()) {
            if let Ok(document) = open_bytes(text.as_bytes()) {
                assert_round_trip(&document);
            }
        }

        #[test]
        fn a_cut_file_is_read_or_refused(text in soup(), cut in 0_usize..600) {
            let _ = open_bytes(&text.as_bytes()[..cut.min(text.len())]);
        }
    }
}
