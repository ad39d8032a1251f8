//! The properties of the native tests, in the browser; and that its bytes are the native ones.
#![cfg(target_arch = "wasm32")]
#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

mod support;

use decimesh::lod::{self, Level};
use decimesh::simplify::{SimplifyOptions, simplify};
use wasm_bindgen_test::wasm_bindgen_test;

wasm_bindgen_test::wasm_bindgen_test_configure!(run_in_browser);

#[wasm_bindgen_test]
fn every_fixture_keeps_its_properties_at_every_level() {
    for (name, mesh, closed) in support::all() {
        let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
        support::check_all_levels(name, &mesh, &sequence, closed);
    }
}

#[wasm_bindgen_test]
fn the_deviation_is_the_native_one_bit_for_bit() {
    assert_eq!(support::fingerprint_of(&support::measured_plates()), support::MEASURED_PLATES);
}

#[wasm_bindgen_test]
fn the_result_is_the_native_one_bit_for_bit() {
    let mesh = support::plate(24, 0.3);
    let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
    let level = lod::extract(&mesh, &sequence, Level::Triangles(100));
    assert_eq!(support::fingerprint(&level.mesh), support::BUMPY_PLATE_AT_100);
}
