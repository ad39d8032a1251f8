//! How fast files are read, against what the machine can do at best: `cargo bench --bench reading`.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark prints, and may stop at the first surprise")]

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use decimesh::document::{Document, Format, NamedFile};

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

fn open(name: &str, bytes: &[u8]) -> Document {
    Document::open(vec![NamedFile { name: name.into(), bytes: bytes.to_vec() }]).unwrap()
}

fn main() {
    let text = obj(500).into_bytes();
    let copy = |bytes: &[u8]| best(|| bytes.to_vec());
    let say = |what: &str, bytes: &[u8], seconds: f64, best: f64| {
        let size = bytes.len() as f64 / 1e6;
        println!(
            "{what}: {size:.1} MB in {:.1} ms, {:.0} MB/s, {:.2} times the least",
            seconds * 1e3,
            size / seconds,
            seconds / best
        );
    };
    let mut least = copy(&text);
    say("obj", &text, best(|| open("m.obj", &text)), least);
    let document = open("m.obj", &text);
    for format in Format::OUTPUT.into_iter().filter(|&format| format != Format::Obj) {
        let bytes = document.write(document.mesh(), format).unwrap();
        least = copy(&bytes);
        if format == Format::Glb {
            let json = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
            least += best(|| serde_json::from_slice::<serde_json::Value>(&bytes[20..json]).unwrap());
        }
        say(format.as_str(), &bytes, best(|| open("m", &bytes)), least);
    }
}
