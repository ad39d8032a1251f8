//! PLY: every encoding, type and element, and every fault, on files of a few rows.

use decimesh::ErrorCode;
use decimesh::document::Format;

use super::{assert_round_trip, attribute, corners, fault, open, open_bytes, points, warning_codes, write};

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const FACES: &str = "property list uchar int vertex_indices\n";
const TRIANGLE: &str = "0 0 0\n1 0 0\n0 1 0\n";

fn text(vertex_properties: &str, vertices: &str, face_properties: &str, faces: &str) -> String {
    let rows = |text: &str| text.lines().filter(|line| !line.is_empty()).count();
    format!(
        "ply\nformat ascii 1.0\ncomment made by formula\nelement vertex {}\n{vertex_properties}element face {}\n{face_properties}end_header\n{vertices}{faces}",
        rows(vertices),
        rows(faces)
    )
}

/// A pyramid of every kind of value, in binary.
fn binary(is_big: bool) -> Vec<u8> {
    let kind = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = format!(
        "ply\nformat {kind} 1.0\nelement extra 2\nproperty list ushort double knots\nproperty short id\n\
         element vertex 4\nproperty double x\nproperty float y\nproperty int z\nproperty list uchar uchar tags\n\
         property ushort red\nproperty ushort green\nproperty ushort blue\nproperty uint64 stamp\n\
         element face 4\nproperty char flag\nproperty list int uint vertex_index\nproperty float32 quality\n\
         element edge 1\nproperty int a\nproperty int b\nend_header\n"
    )
    .into_bytes();
    macro_rules! put {
        ($($value:expr),*) => {$( if is_big { bytes.extend($value.to_be_bytes()) } else { bytes.extend($value.to_le_bytes()) } )*};
    }
    put!(2_u16, 0.5_f64, 0.25_f64, 7_i16, 0_u16, 8_i16);
    for (i, [x, y, z]) in [[0_i32, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].into_iter().enumerate() {
        put!(f64::from(x), y as f32, z);
        bytes.push(i as u8);
        bytes.extend(vec![9; i]);
        put!(0xFFFF_u16, 0x8000_u16, 0_u16, 1_u64);
    }
    for triangle in [[0_u32, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        put!(-1_i8, 3_i32, triangle[0], triangle[1], triangle[2], 1.5_f32);
    }
    put!(0_i32, 1_i32);
    bytes
}

#[test]
fn both_byte_orders_and_all_kinds_of_rows() {
    let (little, big) = (open(binary(false)), open(binary(true)));
    assert_eq!(little.format(), Format::Ply);
    assert_eq!(corners(little.mesh()), corners(big.mesh()));
    assert_eq!(little.mesh().triangles, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    assert_eq!(little.mesh().positions[3], [0.0, 0.0, 1.0]);
    assert_eq!(&attribute(&little, "COLOR_0").unwrap().values[..3], [1.0, 32768.0 / 65535.0, 0.0]);
    let messages: Vec<&str> = little.warnings().iter().map(|warning| warning.message.as_str()).collect();
    assert_eq!(
        messages,
        ["elements left out: extra, edge", "properties left out: vertex.tags, vertex.stamp, face.flag, face.quality"]
    );
}

#[test]
fn text_equals_binary() {
    let pyramid = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    let faces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    let text = open(text(XYZ, pyramid, FACES, faces));
    assert_eq!(points(text.mesh()), points(open(binary(true)).mesh()));
    assert!(text.warnings().is_empty());
}

#[test]
fn line_ends_and_blanks_of_every_kind() {
    let plain = text(XYZ, TRIANGLE, FACES, "3 0 1 2\n");
    for text in [
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        plain.replace('\n', " \t\n").replace("property ", "  property \t"),
        plain.trim_end().to_owned(),
        plain.replace("3 0 1 2", "\n\n  3 0 1 2"),
    ] {
        assert_eq!(open(&text).mesh().triangles, [[0, 1, 2]], "{text:?}");
    }
    // In binary, a first coordinate whose first byte is a line feed must not be taken for one.
    for end in ["\n", "\r", "\r\n"] {
        let header = text(XYZ, TRIANGLE, FACES, "3 0 1 2\n").replace("ascii", "binary_little_endian");
        let header = &header[..header.find("end_header").unwrap()];
        let mut bytes = format!("{header}end_header\n").replace('\n', end).into_bytes();
        let x = f32::from_le_bytes([b'\n', 0, 0, 0x40]);
        for c in [x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            bytes.extend(c.to_le_bytes());
        }
        bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
        assert_eq!(open(&bytes).mesh().positions[0][0], x, "{end:?}");
    }
}

#[test]
fn polygons_are_triangulated_and_what_is_none_is_left_out() {
    let square = "0 0 0\n2 0 0\n2 2 0\n0 2 0\n1 1 0\n";
    // A concave arrow, a line, a point, a triangle with a corner twice.
    let document = open(text(XYZ, square, FACES, "5 0 1 4 2 3\n2 0 1\n1 0\n3 0 1 1\n0\n4 0 1 2 3\n"));
    assert_eq!(document.mesh().triangles.len(), 3 + 2);
    assert_eq!(warning_codes(&document), ["face-too-small", "degenerate-face"]);
    assert!(document.warnings()[0].message.starts_with("3 faces"), "{:?}", document.warnings());
    assert_eq!(document.warnings()[0].place, "model:17");
}

#[test]
fn faces_may_come_before_their_vertices() {
    let text =
        format!("ply\nformat ascii 1.0\nelement face 1\n{FACES}element vertex 3\n{XYZ}end_header\n3 0 1 2\n{TRIANGLE}");
    assert_eq!(open(text).mesh().triangles, [[0, 1, 2]]);
}

#[test]
fn strips_turn_at_every_triangle_and_restart() {
    let vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
    let text = text(XYZ, vertices, "property list int int vertex_indices\n", "10 0 1 2 3 -1 2 3 3 4 4\n");
    let document = open(text.replace("element face", "element tristrips"));
    // The second strip's 2 3 3 and 3 3 4 are no triangles, and neither is 3 4 4.
    assert_eq!(document.mesh().triangles, [[0, 1, 2], [2, 1, 3]]);
    assert!(document.warnings().is_empty());
}

#[test]
fn attributes_of_vertices_by_their_usual_names() {
    for (names, kind) in [(["s", "t"], "float"), (["u", "v"], "double"), (["texture_u", "texture_v"], "float32")] {
        let properties = format!(
            "{XYZ}property float nx\nproperty float ny\nproperty float nz\nproperty {kind} {}\nproperty {kind} {}\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n",
            names[0], names[1]
        );
        let rows = "0 0 0 0 0 1 0.25 0.5 255 0 51 255\n1 0 0 0 0 1 1 0 0 255 0 102\n0 1 0 0 0 1 0 1 0 0 255 255\n";
        let document = open(text(&properties, rows, FACES, "3 0 1 2\n"));
        assert_eq!(attribute(&document, "NORMAL").unwrap().values[..3], [0.0, 0.0, 1.0]);
        assert_eq!(attribute(&document, "TEXCOORD_0").unwrap().values[..4], [0.25, 0.5, 1.0, 0.0]);
        let color = attribute(&document, "COLOR_0").unwrap();
        assert_eq!((color.components, &color.values[..8]), (4, &[1.0, 0.0, 0.2, 1.0, 0.0, 1.0, 0.0, 0.4][..]));
        let written = write(&document, Format::Ply);
        let header = String::from_utf8_lossy(&written).into_owned();
        assert!(header.contains("comment made by formula\n"), "remarks are kept");
        assert!(header.contains(&format!("property float {}\n", names[0])), "so are the names");
        assert_round_trip(&document, Format::Ply);
    }
}

#[test]
fn float_colours_stay_floats() {
    let properties = format!("{XYZ}property float red\nproperty float green\nproperty float blue\n");
    let document = open(text(&properties, "0 0 0 0.1 0.2 0.3\n1 0 0 0 0 0\n0 1 0 1 1 1\n", FACES, "3 0 1 2\n"));
    assert_eq!(attribute(&document, "COLOR_0").unwrap().values[..3], [0.1, 0.2, 0.3]);
    assert_round_trip(&document, Format::Ply);
}

#[test]
fn texture_coordinates_and_colours_of_faces() {
    let properties = format!(
        "{FACES}property list uchar float texcoord\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    );
    let square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let faces = "3 0 1 2 6 0 0 1 0 1 1 255 0 0\n3 0 2 3 6 0 0 1 1 0 0.5 255 0 0\n";
    let document = open(text(XYZ, square, &properties, faces));
    assert_eq!(document.mesh().positions.len(), 4, "corners that agree share a wedge");
    assert_eq!(attribute(&document, "COLOR_0").unwrap().values[..3], [1.0, 0.0, 0.0]);
    assert_round_trip(&document, Format::Ply);
    let torn = open(text(XYZ, square, &properties, &faces.replace("1 1 0 0.5", "0.75 1 0 0.5")));
    assert_eq!(torn.mesh().positions.len(), 5);
    let wrong = open(text(XYZ, square, &properties, &faces.replace("6 0 0 1 1 0 0.5", "3 0 0 1")));
    assert_eq!(warning_codes(&wrong), ["mixed-corners"]);
}

#[test]
fn many_colours_of_faces_are_blended_and_few_are_not() {
    let n = 40_usize;
    let mut vertices = String::new();
    let mut faces = String::new();
    for y in 0..=n {
        for x in 0..=n {
            vertices += &format!("{x} {y} 0\n");
        }
    }
    for y in 0..n {
        for x in 0..n {
            let a = y * (n + 1) + x;
            faces += &format!("4 {a} {} {} {} {} {} 9\n", a + 1, a + n + 2, a + n + 1, x * 6, y * 6);
        }
    }
    let properties = format!("{FACES}property uchar red\nproperty uchar green\nproperty uchar blue\n");
    let scattered = open(text(XYZ, &vertices, &properties, &faces));
    assert_eq!(warning_codes(&scattered), ["face-colors-blended"]);
    assert_eq!(scattered.mesh().positions.len(), (n + 1) * (n + 1));
    let color = attribute(&scattered, "COLOR_0").unwrap();
    // The vertex (1, 1) is at quads of red 0, 6, 0, 6.
    let wedge = scattered.mesh().positions.iter().position(|p| *p == [1.0, 1.0, 0.0]).unwrap();
    assert!((color.values[3 * wedge] - 3.0 / 255.0).abs() < 1e-6, "{}", color.values[3 * wedge]);
    let painted: String = faces.lines().map(|line| format!("{}\n", line.replace(" 9", " 0"))).collect();
    let painted: String = painted
        .lines()
        .map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            format!(
                "{} {} 0 0\n",
                words[..5].join(" "),
                if words[1].parse::<usize>().unwrap() % 2 == 0 { 0 } else { 255 }
            )
        })
        .collect();
    let painted = open(text(XYZ, &vertices, &properties, &painted));
    assert!(painted.warnings().is_empty());
    assert!(painted.mesh().positions.len() > (n + 1) * (n + 1));
}

#[test]
fn what_is_not_finite() {
    let properties = format!("{XYZ}property float nx\nproperty float ny\nproperty float nz\nproperty float quality\n");
    let rows = "0 0 0 nan 0 1 nan\n1 0 0 0 0 1 inf\n0 1 0 0 0 1 1\n";
    let document = open(text(&properties, rows, FACES, "3 0 1 2\n"));
    assert_eq!(warning_codes(&document), ["not-finite-attribute", "properties-ignored"]);
    for bad in ["nan", "inf", "1e39", "-1e400"] {
        let text = text(XYZ, &TRIANGLE.replace("1 0 0", &format!("1 {bad} 0")), FACES, "3 0 1 2\n");
        assert_eq!(fault(text), (ErrorCode::NotFinite, "model:12".into()), "{bad}");
    }
    let mut bytes = binary(false);
    let end = bytes.windows(10).position(|w| w == b"end_header").unwrap() + 11;
    bytes[end + 24..end + 32].copy_from_slice(&1e300_f64.to_le_bytes());
    assert_eq!(fault(&bytes).0, ErrorCode::NotFinite);
}

#[test]
fn every_fault_has_its_code_and_place() {
    let plain = text(XYZ, TRIANGLE, FACES, "3 0 1 2\n");
    for (from, to, code, place) in [
        ("format ascii 1.0\n", "", ErrorCode::Syntax, "model:9"),
        ("format ascii 1.0", "format ascii 2.0", ErrorCode::Unsupported, "model:2"),
        ("format ascii", "format binary_pdp", ErrorCode::Unsupported, "model:2"),
        ("element vertex 3", "element vertex -3", ErrorCode::OutOfRange, "model:4"),
        ("element vertex 3", "element vertex 99999999999999999999", ErrorCode::OutOfRange, "model:4"),
        ("element vertex 3", "element vertex 4000000000", ErrorCode::Truncated, "model:11"),
        ("element face 1", "element face 1000000", ErrorCode::Truncated, "model:14"),
        ("element vertex 3", "elephant vertex 3", ErrorCode::Syntax, "model:4"),
        ("element vertex 3\n", "", ErrorCode::Syntax, "model:4"),
        ("property float x", "property half x", ErrorCode::Syntax, "model:5"),
        ("property float y", "property float x", ErrorCode::Syntax, "model"),
        ("property float y", "property float y z", ErrorCode::Syntax, "model:6"),
        ("property float z\n", "", ErrorCode::Syntax, "model"),
        ("list uchar", "list float", ErrorCode::Syntax, "model:9"),
        ("end_header\n", "", ErrorCode::Syntax, "model:10"),
        ("1 0 0", "1 0", ErrorCode::Syntax, "model:12"),
        ("1 0 0", "1 x 0", ErrorCode::Syntax, "model:12"),
        ("3 0 1 2", "3 0 1", ErrorCode::Syntax, "model:14"),
        ("3 0 1 2", "3 0 1 3", ErrorCode::OutOfRange, "model:14"),
        ("3 0 1 2", "3 0 1 -1", ErrorCode::OutOfRange, "model:14"),
        ("3 0 1 2", "200 0 1 2", ErrorCode::Truncated, "model:14"),
        ("3 0 1 2", "-3 0 1 2", ErrorCode::Truncated, "model:14"),
        ("3 0 1 2", "2 0 1", ErrorCode::NoTriangles, "model"),
        ("element face", "element fence", ErrorCode::NoTriangles, "model"),
    ] {
        assert!(plain.contains(from));
        let text = plain.replacen(from, to, 1);
        assert_eq!(fault(&text), (code, place.to_owned()), "{from} -> {to}");
    }
    let twice = plain.replace("z\n", "z\nproperty float z\n").replace(" 0\n", " 0 9\n");
    assert_eq!(
        (open(&twice).mesh().positions[1], warning_codes(&open(&twice))),
        ([1.0, 0.0, 0.0], vec!["properties-ignored"])
    );
    let extra = plain.replace("1 0 0\n", "1 0 0 5\n");
    assert_eq!(warning_codes(&open(extra)), ["extra-numbers-ignored"]);
}

#[test]
fn a_cut_file_is_truncated_wherever_it_is_cut() {
    for bytes in [binary(false), text(XYZ, TRIANGLE, FACES, "3 0 1 2\n").into_bytes()] {
        for length in 4..bytes.len() - 2 {
            let result = open_bytes(&bytes[..length]).map(|_| ());
            let code = result.map_err(|error| error.code());
            let is_fair = matches!(code, Err(ErrorCode::Truncated | ErrorCode::Syntax));
            assert!(is_fair, "{length}: {code:?}");
        }
    }
}

#[test]
fn counts_are_believed_only_if_the_bytes_are_there() {
    // Lists whose lengths claim more than there is, in every integer type.
    for (kind, bytes) in
        [("uint", &[0xFF; 4][..]), ("ushort", &[0xFF; 2]), ("int64", &[0x7F; 8]), ("uint64", &[0xFF; 8])]
    {
        let mut file = format!(
            "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list {kind} int vertex_indices\nelement vertex 0\n{XYZ}end_header\n"
        )
        .into_bytes();
        file.extend(bytes);
        file.extend([0; 40]);
        assert_eq!(fault(&file).0, ErrorCode::Truncated, "{kind}");
    }
    // An element without properties takes no bytes, however many there are.
    let text = text(XYZ, TRIANGLE, FACES, "3 0 1 2\n")
        .replace("element vertex", "element nothing 18446744073709551615\nelement vertex");
    assert_eq!(open(text).mesh().triangles.len(), 1);
    let many = "element e 0\n".repeat(5000);
    assert_eq!(fault(format!("ply\nformat ascii 1.0\n{many}end_header\n")).0, ErrorCode::TooLarge);
}
