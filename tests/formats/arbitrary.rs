//! Properties: any bytes are read or refused, and what was read survives writing.

use decimesh::document::Format;
use proptest::prelude::*;

use super::{corners, open, open_bytes, write};

/// What is read must be valid, and be the same again after being written in its own format.
fn check(bytes: &[u8]) {
    let Ok(document) = open_bytes(bytes) else { return };
    for format in Format::OUTPUT {
        let written = document.write(document.mesh(), format).unwrap();
        let again = open_bytes(&written);
        if format == document.format() {
            // Colours are exact only where they were bytes; geometry always is.
            let again = again.unwrap();
            let points = |c: Vec<Vec<u32>>| -> Vec<Vec<u32>> { c.into_iter().map(|c| c[..3].to_vec()).collect() };
            // STL takes -0 for 0.
            if format != Format::Stl {
                assert_eq!(points(corners(again.mesh())), points(corners(document.mesh())));
            }
            let second = write(&again, format);
            assert_eq!(corners(open(&second).mesh()), corners(again.mesh()));
        }
    }
}

fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        12 => (-20_i8..20).prop_map(|i| format!("{}", f32::from(i) / 4.0)),
        3 => any::<f32>().prop_filter("finite", |value| value.is_finite()).prop_map(|value| value.to_string()),
        1 => "[-+.0-9eEnai]{0,6}",
    ]
}

fn numbers(count: impl Into<prop::collection::SizeRange>) -> impl Strategy<Value = String> {
    prop::collection::vec(number(), count).prop_map(|n| n.join(" "))
}

fn indices(low: i8) -> impl Strategy<Value = Vec<i8>> {
    prop::collection::vec(low..low + 9, 3..6)
}

fn joined(indices: &[i8]) -> String {
    indices.iter().map(i8::to_string).collect::<Vec<_>>().join(" ")
}

fn smf_line() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => numbers(3).prop_map(|n| format!("v {n}")),
        4 => indices(0).prop_map(|i| format!("f {}", joined(&i))),
        2 => ("begin|end|#|set|inc|x", "[ -~]{0,6}").prop_map(|(k, rest)| format!("{k} {rest}")),
        2 => ("n|c|trans|scale", numbers(3)).prop_map(|(k, n)| format!("{k} {n}")),
        1 => numbers(2).prop_map(|n| format!("r {n}")),
        1 => "rot [xyz] [0-9]{1,3}",
        2 => "bind [ncr] (vertex|face|none)",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn any_bytes_after_a_header(bytes in prop::collection::vec(any::<u8>(), 0..300), which in 0..7_usize) {
        let starts: [&[u8]; 7] = [
            b"",
            b"ply\n",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 9\nproperty list uchar uchar vertex_indices\nend_header\n",
            b"solid x\nfacet ",
            b"COFF 4 2 0\n",
            b"#$SMF 1.0\n",
            &[0; 80],
        ];
        let mut file = starts[which].to_vec();
        file.extend(bytes);
        check(&file);
    }

    #[test]
    fn any_binary_ply(
        rows in prop::collection::vec(prop::array::uniform3(-8.0_f32..8.0), 3..9),
        faces in prop::collection::vec(prop::collection::vec(0_u8..9, 0..7), 1..9),
        colors in any::<u8>(),
        cut in 0..400_usize,
        is_cut in any::<bool>(),
    ) {
        let mut file = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\nproperty list uchar uchar vertex_indices\nend_header\n",
            rows.len(), faces.len()
        ).into_bytes();
        for row in &rows {
            row.iter().for_each(|c| file.extend(c.to_le_bytes()));
            file.extend([colors, 7, 255 - colors]);
        }
        for face in &faces {
            file.push(face.len() as u8);
            file.extend(face);
        }
        if is_cut {
            file.truncate(cut);
        }
        check(&file);
    }

    #[test]
    fn any_header(lines in prop::collection::vec("(element|property|format|comment|list|end_header) [a-z]{1,5} ?[a-z0-9]{0,4}", 0..6)) {
        check(format!("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", lines.join("\n")).as_bytes());
    }

    #[test]
    fn any_text_of_off(prefix in "(ST)?C?N?", rows in prop::collection::vec(numbers(3..10), 3..9), faces in prop::collection::vec((indices(0), "( [0-9.]{1,4}){0,4}"), 1..6)) {
        let mut text = format!("{prefix}OFF\n{} {} 0\n{}\n", rows.len(), faces.len(), rows.join("\n"));
        for (face, color) in &faces {
            text += &format!("{} {}{color}\n", face.len(), joined(face));
        }
        check(text.as_bytes());
    }

    #[test]
    fn any_text_of_smf(lines in prop::collection::vec(smf_line(), 0..20)) {
        check(format!("#$SMF 1.0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n{}\n", lines.join("\n")).as_bytes());
    }

    #[test]
    fn any_text_of_stl(words in prop::collection::vec("(solid|facet|outer loop|vertex|endloop|endfacet|endsolid|[0-9.]{1,3} [0-9]{1,2} [0-9]{1,2})", 0..60)) {
        check(format!("solid x\nfacet\n{}", words.join("\n")).as_bytes());
    }

    #[test]
    fn any_binary_stl(facets in prop::collection::vec((prop::array::uniform9(-4_i8..4), any::<u16>()), 1..9)) {
        let mut file = vec![0; 80];
        file.extend((facets.len() as u32).to_le_bytes());
        for (corners, word) in &facets {
            file.extend([0; 12]);
            corners.iter().for_each(|c| file.extend(f32::from(*c).to_le_bytes()));
            file.extend(word.to_le_bytes());
        }
        check(&file);
    }
}
