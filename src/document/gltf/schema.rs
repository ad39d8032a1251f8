//! Is this JSON a glTF 2.0 whose geometry can be relied on?
//!
//! What the triangles depend on is read here, checked, into small typed records: a fault is an
//! error at its JSON path. The rest of the tree is only carried through, so a fault there is none
//! of ours; [`super::carried`] warns of the worst.

use crate::document::json_parse::{self, Fault};
use crate::document::json_tree::Value;

use super::json::{items, path_at, text};
use super::layout::{Component, Layout, Shape};
use super::scene::{Matrix, compose};
use super::spot::Spot;
use crate::error::{Error, ErrorCode};

pub(super) const DRACO_EXTENSION: &str = "KHR_draco_mesh_compression";
pub(super) const MESHOPT_EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// What the reader takes from the tree. Every index is that of something which is there.
#[derive(Debug)]
pub(super) struct Root {
    pub(super) accessors: Vec<Accessor>,
    pub(super) views: Vec<View>,
    /// Those with a mesh or children, ascending: a file may have millions of nodes with neither.
    pub(super) nodes: Vec<Node>,
    /// The nodes of each scene.
    pub(super) scenes: Vec<Vec<usize>>,
    /// The default scene.
    pub(super) scene: Option<usize>,
    pub(super) skins: Vec<Skin>,
    pub(super) mesh_count: usize,
}

/// Byte offsets and counts are as the file states them, not yet compared with what is there.
#[derive(Debug)]
pub(super) struct Accessor {
    pub(super) view: Option<usize>,
    pub(super) offset: u64,
    pub(super) layout: Layout,
    pub(super) count: u64,
    pub(super) sparse: Option<Sparse>,
}

/// Elements that differ from the base.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) index_component: Component,
    /// Buffer view and byte offset there.
    pub(super) indices: (usize, u64),
    /// As `indices`.
    pub(super) values: (usize, u64),
}

/// A range of a buffer.
#[derive(Debug)]
pub(super) struct View {
    pub(super) buffer: usize,
    pub(super) offset: u64,
    pub(super) length: u64,
    pub(super) stride: Option<usize>,
}

/// A node of the scene.
#[derive(Debug)]
pub(super) struct Node {
    /// Its place among all nodes.
    pub(super) index: usize,
    pub(super) children: Box<[usize]>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
}

impl Root {
    /// The children of any node.
    pub(super) fn children(&self, node: usize) -> &[usize] {
        let found = self.nodes.binary_search_by_key(&node, |node| node.index);
        found.map_or(&[], |at| &self.nodes[at].children)
    }
}

/// A skin, as far as it places a mesh.
#[derive(Debug)]
pub(super) struct Skin {
    pub(super) first_joint: Option<usize>,
    pub(super) inverse_bind_matrices: Option<usize>,
}

/// Parses and checks; the tree is what will be edited, the root what is read.
///
/// # Errors
/// `syntax`, `out-of-range`, `too-large` or `unsupported`, at a JSON path.
pub(super) fn parse(json: &[u8]) -> Result<(Value, Root), Error> {
    // Neither is allowed, and both occur: a byte-order mark, and zeros that pad a GLB chunk.
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let json = &json[..json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1)];
    let tree: Value = json_parse::parse(json).map_err(|fault| syntax_error(json, fault))?;
    check_version(&tree)?;
    let root = read_root(&Spot::root(&tree))?;
    Ok((tree, root))
}

fn check_version(tree: &Value) -> Result<(), Error> {
    if !tree.is_object() {
        return Err(Error::new(ErrorCode::Syntax, "", "a glTF file is a JSON object"));
    }
    let asset = &tree["asset"];
    let version = text(asset, "version");
    // glTF 1.0 did not demand a version, but kept its meshes in an object.
    if version.is_some_and(|v| v.starts_with("1.")) || (version.is_none() && tree["meshes"].is_object()) {
        return Err(Error::new(ErrorCode::Unsupported, "asset.version", "glTF 1.0 is not supported; only 2.0 is"));
    }
    let Some(version) = version else {
        return Err(Error::new(ErrorCode::Syntax, "asset.version", "missing: a glTF file states its version"));
    };
    let (key, needed) = text(asset, "minVersion").map_or(("version", version), |v| ("minVersion", v));
    if needed.starts_with("2.") && (key == "version" || needed == "2.0") {
        return Ok(());
    }
    let message = format!("glTF {needed} is not supported; only 2.0 is");
    Err(Error::new(ErrorCode::Unsupported, format!("asset.{key}"), message))
}

/// How many elements each array of the tree has.
struct Counts<'v, 'p> {
    root: &'p Spot<'v, 'p>,
}

impl Counts<'_, '_> {
    fn of(&self, list: &str) -> usize {
        items(self.root.value, list).len()
    }

    /// The element of `list` that a member of `spot` refers to, if it does.
    fn reference(&self, spot: &Spot<'_, '_>, key: &str, list: &str) -> Result<Option<usize>, Error> {
        spot.field(key).map(|field| field.index_of(list, self.of(list))).transpose()
    }

    /// The elements of `list` that an array refers to.
    fn references(&self, spot: &Spot<'_, '_>, key: &str, list: &str) -> Result<Vec<usize>, Error> {
        let count = self.of(list);
        spot.field(key).map_or(Ok(Vec::new()), |field| field.elements(|element| element.index_of(list, count)))
    }
}

fn read_root(root: &Spot<'_, '_>) -> Result<Root, Error> {
    let counts = Counts { root };
    list(root, "buffers", |buffer| {
        buffer.field("byteLength").map_or(Ok(0), |length| length.size())?;
        match buffer.field("uri") {
            Some(uri) if uri.value.as_str().is_none() => uri.fail(ErrorCode::Syntax, "must be a string"),
            _ => Ok(()),
        }
    })?;
    let views = list(root, "bufferViews", |view| read_view(view, &counts))?;
    let accessors = list(root, "accessors", |accessor| read_accessor(accessor, &counts))?;
    list(root, "meshes", |mesh| {
        mesh.required("primitives")?.elements(|primitive| check_primitive(primitive, &counts)).map(|_| ())
    })?;
    let skins = list(root, "skins", |skin| {
        let joints = counts.references(skin, "joints", "nodes")?;
        let inverse_bind_matrices = counts.reference(skin, "inverseBindMatrices", "accessors")?;
        Ok(Skin { first_joint: joints.first().copied(), inverse_bind_matrices })
    })?;
    let mut nodes = Vec::new();
    let mut index = 0;
    list(root, "nodes", |node| {
        let children = counts.references(node, "children", "nodes")?.into_boxed_slice();
        let mesh = counts.reference(node, "mesh", "meshes")?;
        let skin = counts.reference(node, "skin", "skins")?;
        read_local(node)?;
        if mesh.is_some() || !children.is_empty() {
            nodes.push(Node { index, children, mesh, skin });
        }
        index += 1;
        Ok(())
    })?;
    let scenes = list(root, "scenes", |scene| counts.references(scene, "nodes", "nodes"))?;
    let scene = counts.reference(root, "scene", "scenes")?;
    Ok(Root { accessors, views, nodes, scenes, scene, skins, mesh_count: counts.of("meshes") })
}

/// What `read` makes of each object of an array that may be absent.
fn list<'v, T>(
    root: &Spot<'v, '_>,
    key: &str,
    mut read: impl FnMut(&Spot<'v, '_>) -> Result<T, Error>,
) -> Result<Vec<T>, Error> {
    let Some(field) = root.field(key) else {
        return Ok(Vec::new());
    };
    field.elements(|element| {
        element.check_object()?;
        read(element)
    })
}

fn read_view(view: &Spot<'_, '_>, counts: &Counts<'_, '_>) -> Result<View, Error> {
    let stride = view.field("byteStride");
    Ok(View {
        buffer: view.required("buffer")?.index_of("buffers", counts.of("buffers"))?,
        offset: view.field("byteOffset").map_or(Ok(0), |offset| offset.whole())?,
        length: view.required("byteLength")?.whole()?,
        stride: match stride.map(|stride| stride.size()).transpose()? {
            Some(bytes) if !(4..=252).contains(&bytes) => {
                return view.required("byteStride")?.fail(ErrorCode::Syntax, "must be 4 to 252 bytes");
            }
            stride => stride,
        },
    })
}

fn read_accessor(accessor: &Spot<'_, '_>, counts: &Counts<'_, '_>) -> Result<Accessor, Error> {
    let shape = accessor.required("type")?;
    let Some(known_shape) = shape.value.as_str().and_then(Shape::of) else {
        return shape.fail(ErrorCode::Syntax, "has a value that glTF 2.0 does not allow");
    };
    let normalized = accessor.field("normalized");
    let layout = Layout {
        component: read_component(accessor)?,
        shape: known_shape,
        normalized: match normalized.map_or(Some(false), |normalized| normalized.value.as_bool()) {
            Some(normalized) => normalized,
            None => return accessor.required("normalized")?.fail(ErrorCode::Syntax, "must be true or false"),
        },
    };
    let sparse = accessor.field("sparse");
    Ok(Accessor {
        view: counts.reference(accessor, "bufferView", "bufferViews")?,
        offset: accessor.field("byteOffset").map_or(Ok(0), |offset| offset.whole())?,
        layout,
        count: accessor.required("count")?.whole()?,
        sparse: sparse.map(|sparse| read_sparse(&sparse, counts)).transpose()?,
    })
}

fn read_sparse(sparse: &Spot<'_, '_>, counts: &Counts<'_, '_>) -> Result<Sparse, Error> {
    let place = |key: &str| {
        let part = sparse.required(key)?;
        let view = part.required("bufferView")?.index_of("bufferViews", counts.of("bufferViews"))?;
        let offset = part.field("byteOffset").map_or(Ok(0), |offset| offset.whole())?;
        Ok::<_, Error>((view, offset))
    };
    let indices = sparse.required("indices")?;
    let index_component = read_component(&indices)?;
    if !matches!(index_component, Component::U8 | Component::U16 | Component::U32) {
        return indices.required("componentType")?.fail(ErrorCode::Syntax, "must be an unsigned integer type");
    }
    let count = sparse.required("count")?.whole()?;
    Ok(Sparse { count, index_component, indices: place("indices")?, values: place("values")? })
}

fn read_component(holder: &Spot<'_, '_>) -> Result<Component, Error> {
    let field = holder.required("componentType")?;
    match Component::of(field.whole()?) {
        Some(component) => Ok(component),
        None => field.fail(ErrorCode::Syntax, "has a value that glTF 2.0 does not allow"),
    }
}

fn check_primitive(primitive: &Spot<'_, '_>, counts: &Counts<'_, '_>) -> Result<(), Error> {
    let count = counts.of("accessors");
    let check_semantics =
        |semantics: &Spot<'_, '_>| semantics.members(|accessor| accessor.index_of("accessors", count).map(|_| ()));
    primitive.check_object()?;
    check_semantics(&primitive.required("attributes")?)?;
    counts.reference(primitive, "indices", "accessors")?;
    counts.reference(primitive, "material", "materials")?;
    if let Some(mode) = primitive.field("mode")
        && mode.whole()? > 6
    {
        return mode.fail(ErrorCode::Syntax, "has a value that glTF 2.0 does not allow");
    }
    if let Some(targets) = primitive.field("targets") {
        targets.elements(|target| check_semantics(target))?;
    }
    Ok(())
}

/// Parent from local of a node that was checked; none is the identity.
pub(super) fn local(tree: &Value, node: usize) -> Option<Matrix> {
    read_local(&Spot::root(items(tree, "nodes").get(node)?)).ok().flatten()
}

/// Single precision, as every renderer has it.
fn read_local(node: &Spot<'_, '_>) -> Result<Option<Matrix>, Error> {
    let single = |value: f64| value as f32;
    if let Some(matrix) = node.field("matrix") {
        return Ok(Some(matrix.numbers::<16>()?.map(|value| f64::from(single(value)))));
    }
    let [translation, rotation, scale] = ["translation", "rotation", "scale"].map(|key| node.field(key));
    if translation.is_none() && rotation.is_none() && scale.is_none() {
        return Ok(None);
    }
    Ok(Some(compose(
        translation.map_or(Ok([0.0; 3]), |field| field.numbers())?.map(single),
        rotation.map_or(Ok([0.0, 0.0, 0.0, 1.0]), |field| field.numbers())?.map(single),
        scale.map_or(Ok([1.0; 3]), |field| field.numbers())?.map(single),
    )))
}

/// A parser's error at the JSON path where it struck, with line and column for an editor.
fn syntax_error(json: &[u8], fault: Fault) -> Error {
    let before = &json[..fault.at];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let column = fault.at - before.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1) + 1;
    let position = format!("line {line} column {column}");
    let path = path_at(json, fault.at + 1);
    // A nesting bomb has a path as long as itself.
    const LONGEST: usize = 120;
    let place = if path.is_empty() || path.len() > LONGEST { position } else { format!("{path} ({position})") };
    let code = if fault.is_end { ErrorCode::Truncated } else { ErrorCode::Syntax };
    Error::new(code, place, format!("JSON: {}", fault.message))
}
