//! Puts a mesh into the tree it came from: the same file with other triangles.
//!
//! A primitive without triangles is left out. If its glTF mesh has nothing else, nodes, skins and
//! animations would refer to a mesh that may not be empty; so one vertex of the original is kept
//! as a point: the count of triangles stays honest, and what is left looks like a speck.

use crate::document::json_tree::Value;

use super::column::{Column, Content};
use super::json::{items, items_mut, object, remove, remove_extension, text, uint};
use super::layout::Layout;
use super::schema::{DRACO_EXTENSION, MESHOPT_EXTENSIONS};
use super::{GltfSource, SetSource, container, json as tree_json, pack, usage};
use crate::document::lookup::image_type;
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;

/// Extensions whose data number vertices or triangles: wrong after any change of either.
pub(super) const VERTEX_EXTENSIONS: [&str; 3] = ["CESIUM_primitive_outline", "EXT_mesh_manifold", "FB_ngon_encoding"];

/// The file as GLB, with `mesh` (of the same groups, wedge sets and attributes) for what was read.
///
/// # Errors
/// `invalid-argument` (or what [`Mesh::validate`] finds) for a mesh that does not fit the file;
/// `too-large` beyond 4 GiB.
pub(in crate::document) fn write(source: &GltfSource, mesh: &Mesh) -> Result<Vec<u8>, Error> {
    check_shape(source, mesh)?;
    let mut tree = source.tree.clone();
    let replaceable = usage::replaceable(&tree, &source.primitives);
    let contents = choose_contents(source, mesh, &tree);
    let mut columns = Columns { tree: &mut tree, free: replaceable.accessors, list: Vec::new() };
    let sets: Vec<Vec<usize>> =
        source.sets.iter().zip(&contents.sets).enumerate().map(|(s, (set, &c))| columns.add_set(s, set, c)).collect();
    let mut indices = Vec::with_capacity(mesh.groups.len());
    for (g, group) in mesh.groups.iter().enumerate() {
        let triangles = &mesh.triangles[group.triangles.clone()];
        let set = &mesh.wedge_sets[group.wedge_set].wedges;
        let address = source.primitives[g];
        let old = uint(&columns.tree["meshes"][address.mesh]["primitives"][address.primitive], "indices");
        let content = Content::Triangles(triangles, set.start as u32);
        indices.push((!triangles.is_empty()).then(|| columns.add_indices(old, content, set.len())));
    }
    let Columns { free, list, .. } = columns;

    for (g, address) in source.primitives.iter().enumerate() {
        let primitive = &mut tree["meshes"][address.mesh]["primitives"][address.primitive];
        let set = mesh.groups[g].wedge_set;
        match contents.groups[g] {
            Fate::Dropped => *primitive = Value::Null,
            Fate::Point => point_to(primitive, &source.sets[set], &sets[set], None),
            Fate::Triangles => point_to(primitive, &source.sets[set], &sets[set], indices[g]),
        }
    }
    for mesh in items_mut(&mut tree, "meshes") {
        if let Some(primitives) = mesh.get_mut("primitives").and_then(Value::as_array_mut) {
            primitives.retain(|primitive| !primitive.is_null());
        }
        VERTEX_EXTENSIONS.iter().for_each(|name| remove_extension(mesh, name));
    }
    bury(&mut tree, &free);

    let buffers: Vec<&[u8]> =
        source.buffers.iter().map(|buffer| buffer.bytes(&source.files).unwrap_or_default()).collect();
    let images = embeddable_images(source);
    let binary = pack::pack(&mut tree, &list, &replaceable.views, &buffers, &images);
    pack::set_buffer(&mut tree, binary.len());
    forget_extensions(&mut tree);
    let mut json = Vec::new();
    tree.write(&mut json);
    container::build(&json, &binary)
}

fn check_shape(source: &GltfSource, mesh: &Mesh) -> Result<(), Error> {
    mesh.validate()?;
    let fail = |place: String, what| Err(Error::new(ErrorCode::InvalidArgument, place, format!("{what} of the file")));
    if mesh.groups.len() != source.primitives.len() {
        return fail("mesh.groups".into(), "not one group for each primitive");
    }
    if mesh.wedge_sets.len() != source.sets.len() {
        return fail("mesh.wedge_sets".into(), "not the wedge sets");
    }
    for (s, (wedges, set)) in mesh.wedge_sets.iter().zip(&source.sets).enumerate() {
        if wedges.attributes.len() + 1 != set.attributes.len() {
            return fail(format!("mesh.wedge_sets[{s}].attributes"), "not the attributes");
        }
        for (attribute, origin) in wedges.attributes.iter().zip(&set.attributes[1..]) {
            if Layout::of(&source.tree["accessors"][origin.accessor]).components() != attribute.components {
                return fail(format!("mesh.wedge_sets[{s}].{}", attribute.name), "not the components");
            }
        }
    }
    Ok(())
}

/// What becomes of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    Triangles,
    Point,
    Dropped,
}

/// The mesh whose wedges of a set are written, and which of them.
type SetContent<'m> = Option<(&'m Mesh, usize, usize)>;

struct Contents<'m> {
    groups: Vec<Fate>,
    sets: Vec<SetContent<'m>>,
}

fn choose_contents<'m>(source: &'m GltfSource, mesh: &'m Mesh, tree: &Value) -> Contents<'m> {
    let mut left: Vec<usize> = items(tree, "meshes").iter().map(|mesh| items(mesh, "primitives").len()).collect();
    let mut out =
        Contents { groups: vec![Fate::Triangles; mesh.groups.len()], sets: vec![None; mesh.wedge_sets.len()] };
    for (g, group) in mesh.groups.iter().enumerate() {
        if group.triangles.is_empty() {
            left[source.primitives[g].mesh] -= 1;
            out.groups[g] = Fate::Dropped;
        } else {
            let wedges = &mesh.wedge_sets[group.wedge_set].wedges;
            out.sets[group.wedge_set] = Some((mesh, wedges.start, wedges.len()));
        }
    }
    for (g, group) in mesh.groups.iter().enumerate() {
        let left = &mut left[source.primitives[g].mesh];
        let original = source.mesh.wedge_sets.get(group.wedge_set);
        let first = original.and_then(|_| {
            let triangles = source.mesh.groups.get(g)?.triangles.clone();
            source.mesh.triangles.get(triangles)?.first().map(|triangle| triangle[0] as usize)
        });
        if let (0, Some(wedge)) = (*left, first) {
            *left = 1;
            out.groups[g] = Fate::Point;
            out.sets[group.wedge_set] = Some((&source.mesh, wedge, 1));
        }
    }
    out
}

/// Gives every column of the output its accessor.
struct Columns<'t, 'm> {
    tree: &'t mut Value,
    /// Accessors of the file that may be overwritten, and have not been yet.
    free: Vec<bool>,
    list: Vec<Column<'m>>,
}

impl<'m> Columns<'_, 'm> {
    /// The accessors of each attribute of the set.
    fn add_set(&mut self, s: usize, set: &SetSource, content: SetContent<'m>) -> Vec<usize> {
        let Some((mesh, start, count)) = content else {
            return Vec::new();
        };
        let wedges = &mesh.wedge_sets[s];
        let in_set = start - wedges.wedges.start;
        let first = self.list.len();
        let mut origins: Vec<usize> = Vec::new();
        let single_weights = set.attributes.iter().filter(|a| a.semantic.starts_with("WEIGHTS_")).count() == 1;
        let accessors = set.attributes.iter().enumerate().map(|(k, attribute)| {
            let content = match k.checked_sub(1).map(|k| &wedges.attributes[k]) {
                None => Content::Positions(&mesh.positions[start..start + count]),
                Some(a) => Content::Values(&a.values[in_set * a.components..(in_set + count) * a.components]),
            };
            // Targets often share one accessor of zeros.
            let same = self.list[first..].iter().zip(&origins);
            if let Some((known, _)) = { same }.find(|(c, o)| **o == attribute.accessor && c.content == content) {
                return known.accessor;
            }
            let accessor = self.claim(Some(attribute.accessor));
            let json = &self.tree["accessors"][attribute.accessor];
            let column = Column {
                accessor,
                layout: Layout::of(json),
                content,
                set: Some(s),
                old_place: place_of(json),
                bounds: attribute.semantic == "POSITION" || json.get("min").is_some() || json.get("max").is_some(),
                weights: single_weights && attribute.semantic.starts_with("WEIGHTS_"),
                sparse: attribute.target.is_some() && json.get("sparse").is_some(),
            };
            self.list.push(column);
            origins.push(attribute.accessor);
            accessor
        });
        accessors.collect()
    }

    fn add_indices(&mut self, old: Option<usize>, content: Content<'m>, vertex_count: usize) -> usize {
        let accessor = self.claim(old);
        let json = &mut self.tree["accessors"][accessor];
        // 65535 itself would mean primitive restart.
        json["componentType"] = if vertex_count <= usize::from(u16::MAX) { 5123.into() } else { 5125.into() };
        json["type"] = "SCALAR".into();
        remove(json, "normalized");
        let old_place = place_of(json);
        let bounds = json.get("min").is_some() || json.get("max").is_some();
        let layout = Layout::of(json);
        self.list.push(Column {
            accessor,
            layout,
            content,
            set: None,
            old_place,
            bounds,
            weights: false,
            sparse: false,
        });
        accessor
    }

    /// The old accessor if nothing else needs it, or a new one like it.
    fn claim(&mut self, old: Option<usize>) -> usize {
        if let Some(old) = old
            && self.free.get(old) == Some(&true)
        {
            self.free[old] = false;
            return old;
        }
        let mut new = object(Vec::new());
        if let Some(old) = old.and_then(|old| items(self.tree, "accessors").get(old)) {
            for key in ["name", "bufferView", "byteOffset", "componentType", "normalized", "type"] {
                if let Some(value) = old.get(key) {
                    new[key] = value.clone();
                }
            }
        }
        let accessors = array(self.tree, "accessors");
        accessors.push(new);
        accessors.len() - 1
    }
}

/// The array under `key`, made if need be.
pub(super) fn array<'t>(tree: &'t mut Value, key: &str) -> &'t mut Vec<Value> {
    if !tree[key].is_array() {
        tree[key] = Value::Array(Vec::new());
    }
    match &mut tree[key] {
        Value::Array(values) => values,
        _ => unreachable!("it was made an array"),
    }
}

fn place_of(accessor: &Value) -> Option<(usize, usize)> {
    let sparse = uint(&accessor["sparse"]["values"], "bufferView").map(|view| (view, 0));
    uint(accessor, "bufferView").map(|view| (view, uint(accessor, "byteOffset").unwrap_or(0))).or(sparse)
}

/// Lets the primitive use the new accessors; without indices it becomes points.
fn point_to(primitive: &mut Value, set: &SetSource, accessors: &[usize], indices: Option<usize>) {
    for (attribute, &accessor) in set.attributes.iter().zip(accessors) {
        let holder = match attribute.target {
            Some(target) => &mut primitive["targets"][target],
            None => &mut primitive["attributes"],
        };
        holder[&*attribute.semantic] = accessor.into();
    }
    match indices {
        Some(indices) => {
            primitive["indices"] = indices.into();
            if primitive.get("mode").is_some() {
                primitive["mode"] = 4.into();
            }
        }
        None => {
            remove(primitive, "indices");
            primitive["mode"] = 0.into();
        }
    }
    remove_extension(primitive, DRACO_EXTENSION);
    VERTEX_EXTENSIONS.iter().for_each(|name| remove_extension(primitive, name));
}

/// Accessors that lost their use keep their place in the array, for the numbers of those behind
/// them, as the smallest valid thing: one zero. The last of the array can go.
fn bury(tree: &mut Value, free: &[bool]) {
    for (accessor, _) in items_mut(tree, "accessors").iter_mut().zip(free).filter(|(_, free)| **free) {
        for key in ["bufferView", "byteOffset", "sparse", "min", "max"] {
            remove(accessor, key);
        }
        accessor["count"] = 1.into();
    }
    let accessors = array(tree, "accessors");
    while accessors.len() <= free.len() && accessors.len().checked_sub(1).is_some_and(|last| free[last]) {
        accessors.pop();
    }
    if accessors.is_empty() {
        remove(tree, "accessors");
    }
}

/// Images that are files or `data:` URIs and of a known type: they move into the binary chunk.
fn embeddable_images(source: &GltfSource) -> Vec<pack::Image<'_>> {
    let json = items(&source.tree, "images");
    let images = source.images.iter().enumerate().filter_map(|(index, image)| {
        let bytes = image.bytes(&source.files).filter(|bytes| !bytes.is_empty())?;
        let mime_type = image_type(bytes).or_else(|| text(&json[index], "mimeType"))?;
        Some(pack::Image { index, bytes, mime_type })
    });
    images.collect()
}

/// Extensions that were taken out everywhere are not in use any more.
fn forget_extensions(tree: &mut Value) {
    for name in VERTEX_EXTENSIONS.iter().chain(&MESHOPT_EXTENSIONS).chain([&DRACO_EXTENSION]) {
        let mut used = false;
        tree_json::for_each_extension(tree, &mut |found, _| used |= found == *name);
        for key in ["extensionsUsed", "extensionsRequired"] {
            let Some(names) = tree.get_mut(key).and_then(Value::as_array_mut) else {
                continue;
            };
            names.retain(|listed| used || listed.as_str() != Some(name));
            if names.is_empty() {
                remove(tree, key);
            }
        }
    }
}
