//! Every shared asset in these formats: the counts of its manifest, a round trip, no surprise.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use decimesh::document::{Document, Format};

use super::{corners, file, open_bytes, points};

fn files_under(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_under(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// Files that the manifest counts faces for and that have none: a header that ends before its time,
/// and one whose vertices are declared as faces.
const WITHOUT_FACES: [&str; 2] = ["ply/magnum/integer-literal-at-file-end.ply", "ply/assimp/issue623.ply"];

/// Triangles by the manifest: what its maker counted, polygons as one face.
fn manifest(root: &Path) -> BTreeMap<String, usize> {
    let text = String::from_utf8_lossy(&fs::read(root.join("MANIFEST.tsv")).unwrap()).into_owned();
    let rows = text.lines().skip(1).map(|line| line.split('\t').collect::<Vec<_>>());
    rows.filter_map(|row| Some((row.first()?.to_string(), row.get(4)?.parse().ok()?))).collect()
}

#[test]
fn every_shared_asset() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    if !root.is_dir() {
        println!("SKIPPED every_shared_asset: ../shared/assets is absent");
        return;
    }
    let counts = manifest(&root);
    let mut paths = Vec::new();
    files_under(&root, &mut paths);
    let mut opened = 0;
    for path in paths {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if !["ply", "stl", "off", "smf"].iter().any(|known| extension == *known) {
            continue;
        }
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
        let start = Instant::now();
        let result = Document::open(vec![file(&name, fs::read(&path).unwrap())]);
        assert!(start.elapsed() < Duration::from_secs(20), "{name}");
        let document = match result {
            Ok(document) => document,
            Err(error) => {
                println!("{name}: {error}");
                let is_expected = name.starts_with("invalid/")
                    || WITHOUT_FACES.contains(&name.as_str())
                    || matches!(counts.get(&name), None | Some(0));
                assert!(is_expected, "{name}: {error}");
                continue;
            }
        };
        opened += 1;
        let mesh = document.mesh();
        mesh.validate().unwrap();
        println!(
            "{name}: {} vertices, {} triangles ({:?} in the manifest), {:?}",
            mesh.positions.len(),
            mesh.triangles.len(),
            counts.get(&name),
            document.warnings().iter().map(|w| w.code).collect::<Vec<_>>()
        );
        // Strips and polygons make more triangles, and degenerate faces none.
        let left_out = document.warnings().iter().any(|w| w.code.starts_with("degenerate"));
        let wanted = counts.get(&name).copied().unwrap_or(0);
        assert!(mesh.triangles.len() >= wanted || left_out, "{name}: {wanted} in the manifest");
        for format in Format::OUTPUT {
            let again = open_bytes(&document.write(mesh, format).unwrap()).unwrap();
            assert_eq!(points(again.mesh()).len(), points(mesh).len(), "{name} as {format:?}");
            if format == document.format() && format != Format::Stl {
                assert_eq!(corners(again.mesh()), corners(mesh), "{name}");
            }
        }
    }
    assert!(opened > 40, "{opened}");
}
