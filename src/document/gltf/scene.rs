//! Where the scenes show each mesh, and how large.

use crate::document::json_tree::Value;

use super::accessor::{Data, read_all};
use super::json::{extension, index as as_index, items, members, text, uint};
use super::schema;
use crate::document::{GroupLabel, Instance};
use crate::error::Error;

/// Column-major 4×4.
pub(super) type Matrix = [f64; 16];

const IDENTITY: Matrix = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// Instances beyond this are not read: each takes 128 bytes, a node of a file only a few, and a
/// format that repeats the triangles for each instance could not hold more.
const MOST_INSTANCES: usize = 100_000;

/// Every appearance of every mesh (parts and glTF meshes have the same indices).
pub(super) struct Appearances {
    /// In the default scene.
    pub(super) instances: Vec<Instance>,
    /// The largest scale of each mesh in any scene.
    pub(super) scales: Vec<f32>,
}

/// Walks the node tree of every scene.
///
/// The scale of a matrix is the longest of its three axes. The cube root of the determinant would
/// be smaller, even 0 for a flattened mesh, and would let errors along the long axis pass as small.
///
/// # Errors
/// Those of accessors, for inverse bind matrices and instance transforms.
pub(super) fn appearances(data: Data<'_>) -> Result<Appearances, Error> {
    let root = data.root;
    let world = WorldMatrices::new(data);
    let default_scene = root.scene.unwrap_or(0);
    let scene_roots = |scene: usize| root.scenes.get(scene).map_or(&[][..], Vec::as_slice);
    let shown = reachable(data, scene_roots(default_scene).iter().copied());
    let anywhere = reachable(data, (0..root.scenes.len()).flat_map(scene_roots).copied());

    let mut instances = Vec::new();
    let mut instances_left = MOST_INSTANCES;
    // Largest scale in a scene, and among nodes that no scene shows (a level of detail may hang
    // on an extension only).
    let mut largest = vec![[0.0f64; 2]; root.mesh_count];
    for node in &root.nodes {
        let (n, Some(mesh)) = (node.index, node.mesh) else {
            continue;
        };
        let base = match node.skin {
            Some(skin) => skinned_matrix(data, skin, &world)?,
            None => world.of(n),
        };
        let locals = instance_matrices(data, n, instances_left)?;
        instances_left -= locals.len().min(instances_left);
        for local in locals {
            let world_from_local = multiply(&base, &local);
            let slot = &mut largest[mesh][usize::from(!anywhere[n])];
            *slot = slot.max(longest_axis(&world_from_local));
            if shown[n] {
                instances.push(Instance { part: mesh, world_from_local });
            }
        }
    }
    let usable = |scale: f64| (scale as f32).is_normal().then_some(scale as f32);
    let scales = largest.iter().map(|&[seen, unseen]| usable(seen).or(usable(unseen)).unwrap_or(1.0)).collect();
    Ok(Appearances { instances, scales })
}

/// Names for each primitive that became a group.
pub(super) fn label(tree: &Value, mesh: usize, primitive: usize) -> GroupLabel {
    let mesh_json = items(tree, "meshes").get(mesh);
    let primitive_json = mesh_json.and_then(|json| items(json, "primitives").get(primitive));
    let material = primitive_json.and_then(|json| uint(json, "material"));
    GroupLabel {
        object: mesh_json.and_then(|json| text(json, "name")).map(str::to_owned),
        group: None,
        material: material.map(|material| {
            let name = items(tree, "materials").get(material).and_then(|json| text(json, "name"));
            name.map_or_else(|| format!("material_{material}"), str::to_owned)
        }),
        mesh,
        primitive,
    }
}

/// World from local of the nodes that place something, and of no others: a file may have millions that do not.
struct WorldMatrices {
    /// Nodes with a mesh, and those that stand for a skin's joints; ascending.
    nodes: Vec<usize>,
    /// `None` in a cycle, which has none.
    matrices: Vec<Option<Matrix>>,
}

impl WorldMatrices {
    /// Follows the ways from the roots to these nodes. Beside the result no more matrices are kept than there are
    /// ancestors with another child to go to.
    fn new(data: Data<'_>) -> Self {
        let root = data.root;
        let count = items(data.tree, "nodes").len();
        // Of several parents the first counts.
        let mut parents = vec![None; count];
        for node in &root.nodes {
            node.children.iter().for_each(|&child| _ = parents[child].get_or_insert(node.index as u32));
        }
        let mut places = vec![false; count];
        root.nodes.iter().for_each(|node| places[node.index] = node.mesh.is_some() && node.skin.is_none());
        root.skins.iter().filter_map(|skin| skin.first_joint).for_each(|joint| places[joint] = true);
        let nodes: Vec<usize> = (0..count).filter(|&node| places[node]).collect();
        // What leads to one of them and was not come by yet.
        let mut leads = vec![false; count];
        let mut next = Vec::new();
        for &node in &nodes {
            let mut node = node;
            while !std::mem::replace(&mut leads[node], true) {
                match parents[node] {
                    Some(parent) => node = parent as usize,
                    None => next.push((node, None)),
                }
            }
        }
        let mut matrices = vec![None; nodes.len()];
        let mut ancestors: Vec<(usize, &[usize], Matrix)> = Vec::new();
        while let Some((node, parent)) = next.pop() {
            let local = schema::local(data.tree, node).unwrap_or(IDENTITY);
            let matrix = parent.map_or(local, |parent| multiply(&parent, &local));
            if let Ok(at) = nodes.binary_search(&node) {
                matrices[at] = Some(matrix);
            }
            leads[node] = false;
            ancestors.push((node, root.children(node), matrix));
            while let Some((node, children, matrix)) = ancestors.pop() {
                let is_next = |&child: &usize| leads[child] && parents[child] == Some(node as u32);
                let mut left = children.iter().enumerate().filter(|(_, child)| is_next(child));
                let Some((_, &child)) = left.next() else {
                    continue;
                };
                if let Some((at, _)) = left.find(|&(_, &other)| other != child) {
                    ancestors.push((node, &children[at..], matrix));
                }
                next.push((child, Some(matrix)));
                break;
            }
        }
        Self { nodes, matrices }
    }

    fn of(&self, node: usize) -> Matrix {
        self.nodes.binary_search(&node).ok().and_then(|at| self.matrices[at]).unwrap_or(IDENTITY)
    }
}

fn reachable(data: Data<'_>, from: impl Iterator<Item = usize>) -> Vec<bool> {
    let mut seen = vec![false; items(data.tree, "nodes").len()];
    let mut stack: Vec<usize> = from.collect();
    while let Some(n) = stack.pop() {
        if let Some(first @ false) = seen.get_mut(n) {
            *first = true;
            stack.extend(data.root.children(n));
        }
    }
    seen
}

/// A skin ignores its node's place: the first joint stands for all of them, in their bind pose.
fn skinned_matrix(data: Data<'_>, skin: usize, world: &WorldMatrices) -> Result<Matrix, Error> {
    let Some(skin) = data.root.skins.get(skin) else {
        return Ok(IDENTITY);
    };
    let joint = skin.first_joint.map_or(IDENTITY, |joint| world.of(joint));
    let Some(accessor) = skin.inverse_bind_matrices else {
        return Ok(joint);
    };
    let numbers = read_all(data, accessor, 1)?;
    let mut inverse_bind = IDENTITY;
    if numbers.len() == inverse_bind.len() {
        inverse_bind = std::array::from_fn(|i| f64::from(numbers[i]));
    }
    Ok(multiply(&joint, &inverse_bind))
}

/// The transforms of `EXT_mesh_gpu_instancing`, or one identity.
fn instance_matrices(data: Data<'_>, node: usize, limit: usize) -> Result<Vec<Matrix>, Error> {
    let attributes = items(data.tree, "nodes").get(node).and_then(|node| extension(node, INSTANCING));
    let Some(attributes) = attributes else {
        return Ok(vec![IDENTITY]);
    };
    let mut columns: [Vec<f32>; 3] = Default::default();
    for (name, accessor) in members(attributes, "attributes") {
        let slot = ["TRANSLATION", "ROTATION", "SCALE"].iter().position(|known| *known == name);
        if let (Some(slot), Some(accessor)) = (slot, as_index(accessor)) {
            columns[slot] = read_all(data, accessor, limit)?;
        }
    }
    let [translation, rotation, scale] = columns;
    let count = (translation.len() / 3).max(rotation.len() / 4).max(scale.len() / 3);
    let triple = |values: &[f32], i: usize, default: f32| -> [f32; 3] {
        std::array::from_fn(|k| values.get(i * 3 + k).copied().unwrap_or(default))
    };
    Ok((0..count)
        .map(|i| {
            let turn =
                std::array::from_fn(|k| rotation.get(i * 4 + k).copied().unwrap_or(if k == 3 { 1.0 } else { 0.0 }));
            compose(triple(&translation, i, 0.0), turn, triple(&scale, i, 1.0))
        })
        .collect())
}

/// Translation · rotation (unit quaternion x, y, z, w) · scale.
pub(super) fn compose(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> Matrix {
    let [x, y, z, w] = rotation.map(f64::from);
    let axes = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
        [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
        [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let mut matrix = IDENTITY;
    for (column, axis) in axes.iter().enumerate() {
        for (row, value) in axis.iter().enumerate() {
            matrix[column * 4 + row] = value * f64::from(scale[column]);
        }
    }
    for (row, value) in translation.iter().enumerate() {
        matrix[12 + row] = f64::from(*value);
    }
    matrix
}

fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| (0..4).map(|k| a[k * 4 + i % 4] * b[i / 4 * 4 + k]).sum())
}

fn longest_axis(matrix: &Matrix) -> f64 {
    let length = |column: usize| (0..3).map(|row| matrix[column * 4 + row].powi(2)).sum::<f64>().sqrt();
    let longest = length(0).max(length(1)).max(length(2));
    if longest.is_finite() { longest } else { 0.0 }
}
