//! Meshes by formula for the robustness tests: closed surfaces of any genus, cones, strips, soups, tangles.

use decimesh::mesh::Mesh;

use super::Noise;

/// A sphere of `around` slices and `down` rows, poles of valence `around`: 2 · around · (down − 1) triangles.
pub fn sphere(around: u32, down: u32) -> Mesh {
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for row in 1..down {
        let theta = row as f32 / down as f32 * std::f32::consts::PI;
        for slice in 0..around {
            let phi = slice as f32 / around as f32 * std::f32::consts::TAU;
            positions.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
        }
    }
    positions.push([0.0, 0.0, -1.0]);
    let last = positions.len() as u32 - 1;
    let at = |row: u32, slice: u32| 1 + (row - 1) * around + slice % around;
    let mut triangles = Vec::new();
    for slice in 0..around {
        triangles.push([0, at(1, slice), at(1, slice + 1)]);
        for row in 1..down - 1 {
            let [a, b, c, d] = [at(row, slice), at(row + 1, slice), at(row + 1, slice + 1), at(row, slice + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([last, at(down - 1, slice + 1), at(down - 1, slice)]);
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// The boundary of a plate of cubes, 5 × 3 × 1 blocks of `block`³ cubes, two blocks left out as holes: genus 2.
pub fn double_ring(block: i32) -> Mesh {
    let solid = |x: i32, y: i32, z: i32| {
        let inside = (0..5 * block).contains(&x) && (0..3 * block).contains(&y) && (0..block).contains(&z);
        let hole = y / block == 1 && (x / block == 1 || x / block == 3);
        inside && !hole
    };
    cubes([5 * block, 3 * block, block], solid)
}

/// The boundary of the cubes of a grid of `size` for which `solid` holds, outward; grid corners are shared.
pub fn cubes(size: [i32; 3], solid: impl Fn(i32, i32, i32) -> bool) -> Mesh {
    let mut ids = std::collections::BTreeMap::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut vertex = |p: [i32; 3]| {
        *ids.entry(p).or_insert_with(|| {
            positions.push(p.map(|c| c as f32));
            positions.len() as u32 - 1
        })
    };
    for (x, y, z) in (0..size[0]).flat_map(|x| (0..size[1]).flat_map(move |y| (0..size[2]).map(move |z| (x, y, z)))) {
        if !solid(x, y, z) {
            continue;
        }
        for axis in 0..3 {
            for side in [0, 1] {
                let mut next = [x, y, z];
                next[axis] += 2 * side - 1;
                if solid(next[0], next[1], next[2]) {
                    continue;
                }
                // The face's corners around the axis, turned outward.
                let corners: [u32; 4] = std::array::from_fn(|k| {
                    let k = if side == 1 { k } else { 3 - k };
                    let mut p = [x, y, z];
                    p[axis] += side;
                    p[(axis + 1) % 3] += i32::from(k == 1 || k == 2);
                    p[(axis + 2) % 3] += i32::from(k >= 2);
                    vertex(p)
                });
                let [a, b, c, d] = corners;
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// A cone of `sides` triangles around its tip; with a flat base of as many around its centre if `closed`.
pub fn cone(sides: u32, closed: bool) -> Mesh {
    let mut positions = vec![[0.0, 0.0, 1.0]];
    if closed {
        positions.push([0.0, 0.0, 0.0]);
    }
    let first = positions.len() as u32;
    for side in 0..sides {
        let angle = f64::from(side) / f64::from(sides) * std::f64::consts::TAU;
        positions.push([angle.cos() as f32, angle.sin() as f32, 0.0]);
    }
    let rim = |side: u32| first + side % sides;
    let mut triangles: Vec<[u32; 3]> = (0..sides).map(|side| [0, rim(side), rim(side + 1)]).collect();
    if closed {
        triangles.extend((0..sides).map(|side| [1, rim(side + 1), rim(side)]));
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// A strip of `along` × `across` quads closed with half a turn: one side, one border, Euler number 0.
pub fn moebius(along: u32, across: u32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..along {
        let turn = i as f32 / along as f32 * std::f32::consts::TAU;
        for j in 0..=across {
            let r = (j as f32 / across as f32 - 0.5) * 0.8;
            let reach = 1.0 + r * (turn / 2.0).cos();
            positions.push([reach * turn.cos(), reach * turn.sin(), r * (turn / 2.0).sin()]);
        }
    }
    let at = |i: u32, j: u32| if i < along { i * (across + 1) + j } else { across - j };
    let mut triangles = Vec::new();
    for i in 0..along {
        for j in 0..across {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// The same triangles, each with three vertices of its own.
pub fn unindexed(mesh: &Mesh) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::from_arrays(positions, triangles, vec![])
}

/// `n` small triangles in the unit cube, all apart from each other.
pub fn confetti(n: u32) -> Mesh {
    let mut noise = Noise(5);
    let mut positions = Vec::new();
    for _ in 0..n {
        let centre: [f32; 3] = std::array::from_fn(|_| noise.next());
        positions.extend((0..3).map(|_| centre.map(|c| c + 0.01 * noise.next())));
    }
    let triangles = (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::from_arrays(positions, triangles, vec![])
}

/// `n` triangles over n / 4 random points in the unit cube, each of three points close in a grid's order: edges of any
/// number of triangles, fans that are none, triangles through each other, a few twice or degenerate.
pub fn tangle(n: u32) -> Mesh {
    let side = (f64::from(n) / 4.0).cbrt().ceil() as u32;
    let mut noise = Noise(9);
    let mut positions = Vec::new();
    for i in 0..side.pow(3) {
        let cell = [i % side, i / side % side, i / side / side];
        positions.push(cell.map(|c| (c as f32 + 0.4 * noise.next()) / side as f32));
    }
    let mut pick = |low: u32, reach: u32| (low + ((noise.next() + 1.0) / 2.0 * reach as f32) as u32).min(side - 1);
    let triangles = (0..n)
        .map(|_| {
            let cell = [pick(0, side), pick(0, side), pick(0, side)];
            std::array::from_fn(|_| {
                let [x, y, z] = cell.map(|c| pick(c, 2));
                x + side * (y + side * z)
            })
        })
        .collect();
    Mesh::from_arrays(positions, triangles, vec![])
}

/// Several meshes in one, nothing shared.
pub fn together(meshes: &[Mesh]) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(&mesh.positions);
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// The mesh with every position sent through `place`.
pub fn moved(mut mesh: Mesh, place: impl Fn([f32; 3]) -> [f32; 3]) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = place(*p));
    mesh
}
