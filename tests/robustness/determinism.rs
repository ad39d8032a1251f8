//! The same input gives the same bytes, however often and in whatever company.

use decimesh::mesh::Mesh;
use decimesh::simplify::{PlacementRule, SimplifyOptions, simplify};

use super::{at_end, to};
use crate::support::surfaces::{sphere, tangle, together};
use crate::support::{self, fingerprint};

fn inputs() -> Vec<(&'static str, Mesh)> {
    let mut inputs: Vec<(&'static str, Mesh)> =
        support::all().into_iter().map(|(name, mesh, _)| (name, mesh)).collect();
    inputs.push(("sphere", sphere(60, 30)));
    inputs.push(("tangle", tangle(2000)));
    inputs
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    for (name, mesh) in inputs() {
        let tenth = to(mesh.triangles.len() / 10);
        let subset = SimplifyOptions { placement: PlacementRule::Subset, ..tenth.clone() };
        for options in [tenth, subset, SimplifyOptions::default()] {
            let first = simplify(&mesh, &options).unwrap();
            // Another run in between, so that nothing may be left over from the one before.
            simplify(&together(&[mesh.clone(), sphere(12, 6)]), &options).unwrap();
            let second = simplify(&mesh, &options).unwrap();
            assert_eq!(first, second, "{name}");
            assert_eq!(fingerprint(&at_end(&mesh, &first)), fingerprint(&at_end(&mesh, &second)), "{name}");
        }
    }
}

#[test]
fn other_threads_give_the_same_bytes() {
    let mesh = sphere(60, 30);
    let here = fingerprint(&at_end(&mesh, &simplify(&mesh, &to(200)).unwrap()));
    let elsewhere: Vec<u64> = std::thread::scope(|scope| {
        let runs: Vec<_> =
            (0..3).map(|_| scope.spawn(|| fingerprint(&at_end(&mesh, &simplify(&mesh, &to(200)).unwrap())))).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    assert!(elsewhere.iter().all(|&other| other == here));
}
