//! How fast files are read, against what the machine can do at best: `cargo bench --bench reading`, or of some only:
//! `cargo bench --bench reading -- glb`.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark prints, and may stop at the first surprise")]

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use decimesh::document::{Document, Format, NamedFile, Outline};

const RUNS: usize = 5;

/// A hilly square of `size` × `size` cells with normals and texture coordinates, six decimals as most exporters write.
fn obj(size: usize) -> String {
    let mut out = String::from("# generated\no hills\n");
    let side = size + 1;
    let at = |i: usize| i as f32 / size as f32;
    let height = |x: f32, y: f32| (x * 17.0).sin() * (y * 13.0).cos() * 0.1;
    for (x, y) in (0..side * side).map(|i| (at(i % side), at(i / side))) {
        writeln!(out, "v {x:.6} {:.6} {y:.6}", height(x, y)).unwrap();
    }
    for (x, y) in (0..side * side).map(|i| (at(i % side), at(i / side))) {
        writeln!(out, "vt {x:.6} {y:.6}").unwrap();
    }
    for (x, y) in (0..side * side).map(|i| (at(i % side), at(i / side))) {
        writeln!(out, "vn {:.4} {:.4} {:.4}", height(y, x), 1.0, height(x, y)).unwrap();
    }
    for cell in 0..size * size {
        let a = cell / size * side + cell % size + 1;
        let [b, c, d] = [a + 1, a + side + 1, a + side];
        writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}\nf {a}/{a}/{a} {c}/{c}/{c} {d}/{d}/{d}").unwrap();
    }
    out
}

/// Seconds that this thread has run, where Linux tells, so that others on the machine do not count.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}

/// The shortest of some runs, in seconds; each is repeated until the clock, which ticks in milliseconds, can tell.
fn best<T>(mut run: impl FnMut() -> T) -> f64 {
    let mut time = |_| {
        let (start, ran) = (Instant::now(), processor_seconds());
        let mut count = 0.0;
        while start.elapsed().as_secs_f64() < 0.2 {
            black_box(run());
            count += 1.0;
        }
        let elapsed = start.elapsed().as_secs_f64();
        ran.and_then(|ran| Some(processor_seconds()? - ran)).unwrap_or(elapsed) / count
    };
    (0..RUNS).map(&mut time).fold(f64::INFINITY, f64::min)
}

fn parse(name: &str, bytes: &[u8]) -> Outline {
    Outline::parse(vec![NamedFile { name: name.into(), bytes: bytes.to_vec() }]).unwrap()
}

fn open(name: &str, bytes: &[u8]) -> Document {
    parse(name, bytes).decode().unwrap()
}

/// A machine of `count` boxes, each a mesh with accessors of its own: a GLB that is mostly JSON, as CAD gives.
fn boxes(count: usize) -> Vec<u8> {
    const CORNERS: [[u8; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    const SIDES: [[u16; 4]; 6] = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let mut binary = Vec::new();
    let (mut views, mut accessors, mut meshes, mut nodes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut add = |binary: &[u8], start: usize, accessor: String| {
        views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{}}}"#, binary.len() - start));
        accessors.push(format!(r#"{{"bufferView":{},{accessor}}}"#, views.len() - 1));
    };
    for n in 0..count {
        let start = binary.len();
        CORNERS.iter().flatten().for_each(|&c| binary.extend((f32::from(c) * (1.0 + n as f32)).to_le_bytes()));
        let size = n + 1;
        let bounds = format!(r#""min":[0,0,0],"max":[{size},{size},{size}]"#);
        add(&binary, start, format!(r#""componentType":5126,"count":8,"type":"VEC3",{bounds}"#));
        let start = binary.len();
        let corners = SIDES.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]);
        corners.for_each(|corner| binary.extend(corner.to_le_bytes()));
        add(&binary, start, r#""componentType":5123,"count":36,"type":"SCALAR""#.into());
        let (positions, indices) = (2 * n, 2 * n + 1);
        let primitive = format!(r#"{{"attributes":{{"POSITION":{positions}}},"indices":{indices},"material":0}}"#);
        meshes.push(format!(r#"{{"name":"Part {n}","primitives":[{primitive}]}}"#));
        nodes.push(format!(r#"{{"name":"Part {n}","mesh":{n},"translation":[{n}.5,0.25,-{n}.125]}}"#));
    }
    let roots: Vec<String> = (0..count).map(|n| n.to_string()).collect();
    let [views, accessors, meshes, nodes, roots] = [views, accessors, meshes, nodes, roots].map(|list| list.join(","));
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{roots}]}}],"nodes":[{nodes}],"meshes":[{meshes}],
        "materials":[{{"name":"Steel","pbrMetallicRoughness":{{"metallicFactor":1,"roughnessFactor":0.4}}}}],
        "buffers":[{{"byteLength":{}}}],"bufferViews":[{views}],"accessors":[{accessors}]}}"#,
        binary.len()
    );
    json.extend(std::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (content, kind) in [(json.as_bytes(), b"JSON"), (&binary, b"BIN\0")] {
        out.extend((content.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(content);
    }
    out
}

fn copy(bytes: &[u8]) -> f64 {
    best(|| bytes.to_vec())
}

fn say(what: &str, bytes: &[u8], seconds: f64, least: f64) {
    let size = bytes.len() as f64 / 1e6;
    println!(
        "{what}: {size:.1} MB in {:.2} ms, {:.0} MB/s, {:.2} times the least",
        seconds * 1e3,
        size / seconds,
        seconds / least
    );
}

/// The least for a GLB is a copy and a parse of its JSON.
fn say_glb(what: &str, bytes: &[u8]) {
    let json = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let least = copy(bytes) + best(|| serde_json::from_slice::<serde_json::Value>(&bytes[20..json]).unwrap());
    say(what, bytes, best(|| parse("m", bytes)), least);
    say(&format!("{what}, with geometry"), bytes, best(|| open("m", bytes)), least);
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let wanted = |what: &str| words.is_empty() || words.iter().any(|word| what.contains(word.as_str()));
    let text = obj(500).into_bytes();
    let document = open("m.obj", &text);
    if wanted("glb of one mesh") {
        say_glb("glb of one mesh", &document.write(document.mesh(), Format::Glb).unwrap());
    }
    if wanted("glb of 5000 meshes") {
        say_glb("glb of 5000 meshes", &boxes(5000));
    }
    if wanted("obj") {
        say("obj", &text, best(|| open("m.obj", &text)), copy(&text));
    }
    let others = Format::OUTPUT.into_iter().filter(|format| !matches!(format, Format::Obj | Format::Glb));
    for format in others.filter(|format| wanted(format.as_str())) {
        let bytes = document.write(document.mesh(), format).unwrap();
        say(format.as_str(), &bytes, best(|| open("m", &bytes)), copy(&bytes));
    }
}
