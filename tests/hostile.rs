//! Files made to break readers, each in a process of its own: an error or a sound result, soon and in little memory.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test may stop at the first surprise")]

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use decimesh::document::{Document, Format, NamedFile, external_files};

/// What the issue allows for each file.
const MOST_TIME: Duration = Duration::from_secs(2);
const MOST_MEMORY: usize = 64 << 20;

/// Names the file for the child process.
const FILE: &str = "DECIMESH_HOSTILE_FILE";

fn files_under(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files_under(&path, out) } else { out.push(path) }
    }
}

/// The file and what it names beside itself, and nothing outside of its folder.
fn load(path: &Path) -> Vec<NamedFile> {
    let bytes = fs::read(path).unwrap();
    let mut files = vec![];
    for name in external_files(&bytes) {
        let is_inside = !name.contains("..") && !name.starts_with('/') && !name.contains(':');
        let bytes = is_inside.then(|| fs::read(path.with_file_name(&name)).ok()).flatten();
        files.extend(bytes.map(|bytes| NamedFile { name, bytes }));
    }
    files.insert(0, NamedFile { name: path.file_name().unwrap().to_string_lossy().into_owned(), bytes });
    files
}

/// The largest resident size so far or the present one, in bytes; 0 where the system does not tell.
fn resident(field: &str) -> usize {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(field)).unwrap_or("0");
    line.split_whitespace().find_map(|word| word.parse::<usize>().ok()).unwrap_or(0) << 10
}

/// The child: opens, and writes what could be opened in every format.
#[test]
fn child() {
    let Some(path) = std::env::var_os(FILE) else { return };
    let files = load(Path::new(&path));
    let size: usize = files.iter().map(|file| file.bytes.len()).sum();
    let before = resident("VmRSS:");
    match Document::open(files) {
        Err(error) => {
            assert!(!error.message().is_empty());
            println!("refused: {error}");
        }
        Ok(document) => {
            document.mesh().validate().unwrap();
            println!("opened: {:?}", document.warnings());
            let bytes = document.write(document.mesh(), Format::Glb).unwrap();
            Document::open(vec![NamedFile { name: "written.glb".into(), bytes }]).unwrap();
        }
    }
    let used = resident("VmHWM:").saturating_sub(before);
    assert!(used <= MOST_MEMORY + size, "{used} bytes of memory for a file of {size}");
}

/// What the child said, or why it has to be blamed.
fn run(path: &Path) -> Result<String, String> {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["child", "--exact", "--nocapture", "--test-threads=1"])
        .env(FILE, path)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Read on the side: a full pipe would stop the child.
    let mut streams = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
    let reader = std::thread::spawn(move || {
        let mut text = Vec::new();
        let _ = streams.0.read_to_end(&mut text);
        let _ = streams.1.read_to_end(&mut text);
        String::from_utf8_lossy(&text).into_owned()
    });
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break Some(status);
        }
        if start.elapsed() > MOST_TIME {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let text = reader.join().unwrap();
    match status {
        None => Err(format!("{}: not done after {MOST_TIME:?}", path.display())),
        Some(status) if !status.success() => Err(format!("{}: {status}\n{text}", path.display())),
        Some(_) => Ok(text),
    }
}

/// Runs every file of a folder.
fn check(folder: &Path, at_least: usize) {
    let mut paths = Vec::new();
    files_under(folder, &mut paths);
    paths.sort();
    let failures: Vec<String> = paths.iter().filter_map(|path| run(path).err()).collect();
    assert!(failures.is_empty(), "{} of {} failed:\n{}", failures.len(), paths.len(), failures.join("\n"));
    assert!(paths.len() >= at_least, "only {} files", paths.len());
}

#[test]
fn regressions_stay_mended() {
    check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/hostile"), 1);
}

#[test]
fn invalid_assets_do_no_harm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/invalid");
    if !folder.is_dir() {
        println!("skipped: invalid_assets_do_no_harm (../shared/assets is not there)");
        return;
    }
    check(&folder, 300);
}

#[test]
fn nasty_assets_do_no_harm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/nasty");
    if !folder.is_dir() {
        println!("skipped: nasty_assets_do_no_harm (../shared/assets is not there)");
        return;
    }
    check(&folder, 10);
}

/// A triangle as glTF, with these nodes, of which a scene has the first, and these extras.
fn gltf(nodes: &str, extras: &str) -> String {
    let accessor = r#"{"bufferView":0,"componentType":5121,"count":3,"type":"VEC3"}"#;
    let data = "data:application/octet-stream;base64,AAAAAQAAAAEA";
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":9,"uri":"{data}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":9}}],"accessors":[{accessor}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"scenes":[{{"nodes":[0]}}],
        "nodes":[{nodes}],"extras":[{extras}]}}"#
    )
}

/// One and a half megabytes of JSON whose parts have a few bytes each. What is kept for a part has to be small too.
#[test]
fn parts_of_a_few_bytes_take_little_memory() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hostile-parts");
    fs::create_dir_all(&folder).unwrap();
    let repeated = |part: &dyn Fn(usize) -> String, size: usize| -> String {
        let count = (3 << 19) / size;
        (0..count).map(|i| part(i) + ",").collect()
    };
    let mesh = r#"{"mesh":0}"#;
    let files = [
        ("empty-nodes", gltf(&(repeated(&|_| "{}".into(), 3) + mesh), "")),
        ("scaled-nodes", gltf(&(repeated(&|_| r#"{"scale":[1,1,1]}"#.into(), 18) + mesh), "")),
        ("chain-of-nodes", gltf(&(repeated(&|i| format!(r#"{{"children":[{}]}}"#, i + 1), 22) + mesh), "")),
        // Each stands twice under its parent, and is visited once all the same.
        ("doubled-nodes", gltf(&(repeated(&|i| format!(r#"{{"children":[{0},{0}]}}"#, i + 1), 28) + mesh), "")),
        // The way down comes first, so that every ancestor has another child to go to.
        (
            "comb-of-nodes",
            gltf(&(repeated(&|i| format!(r#"{{"children":[{},{}]}},{mesh}"#, 2 * i + 2, 2 * i + 1), 37) + mesh), ""),
        ),
        ("empty-lists", gltf(mesh, &(repeated(&|_| "[]".into(), 3) + "0"))),
    ];
    for (name, text) in &files {
        fs::write(folder.join(name).with_extension("gltf"), text).unwrap();
    }
    check(&folder, files.len());
}
