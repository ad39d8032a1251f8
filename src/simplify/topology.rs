//! Connectivity of the mesh while it shrinks: triangles, and the fan of triangles at each vertex.
//!
//! Flat arrays only. A fan is a slice of triangle ids in one pool; when two vertices merge, the
//! new fan is written over the longer old slice if it fits and else to the end of the pool, which
//! is compacted in vertex order when full. Dead triangles stay in the fans of their third
//! vertices until the fan is next walked, which saves touching those vertices at every collapse.

use super::quadric::{Quadric, Vec3};

/// All that a walk needs of a vertex, in one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Vertex {
    pub(super) position: Vec3,
    pub(super) quadric: Quadric,
    fan_start: u32,
    fan_length: u32,
    /// Scratch of the link test: the last walk that met this vertex.
    pub(super) mark: u32,
    pub(super) kind: super::vertex_kind::VertexKind,
}

const _: () = assert!(size_of::<Vertex>() == 64);

/// Vertex ids of a triangle.
pub(super) type Triangle = [u32; 3];

/// The first id of a triangle that is gone.
const DEAD: u32 = u32::MAX;

/// One triangle of a fan, seen from the fan's vertex: (vertex, next, previous) keep its winding.
#[derive(Debug, Clone, Copy)]
pub(super) struct FanTriangle {
    pub(super) triangle: u32,
    pub(super) next: u32,
    pub(super) previous: u32,
}

/// All ones if true.
#[inline(always)]
fn mask(condition: bool) -> u32 {
    u32::from(condition).wrapping_neg()
}

/// Vertices, triangles and the fan pool.
#[derive(Debug)]
pub(super) struct Topology {
    pub(super) vertices: Vec<Vertex>,
    pub(super) triangles: Vec<Triangle>,
    pool: Vec<u32>,
    pub(super) live_triangle_count: usize,
}

impl Topology {
    /// Builds the fans: counted, summed, filled.
    pub(super) fn new(positions: impl ExactSizeIterator<Item = Vec3>, triangles: Vec<Triangle>) -> Self {
        let mut vertices: Vec<Vertex> = positions
            .map(|position| Vertex {
                position,
                quadric: Quadric::default(),
                fan_start: 0,
                fan_length: 0,
                mark: 0,
                kind: super::vertex_kind::VertexKind::Manifold,
            })
            .collect();
        for &v in triangles.iter().flatten() {
            vertices[v as usize].fan_length += 1;
        }
        let mut sum = 0;
        for vertex in &mut vertices {
            vertex.fan_start = sum;
            sum += vertex.fan_length;
            vertex.fan_length = 0;
        }
        let mut pool = vec![0; sum as usize];
        // Room for appended fans, so that compaction is rare.
        pool.reserve_exact(sum as usize + 1024);
        for (t, triangle) in triangles.iter().enumerate() {
            for &v in triangle {
                let vertex = &mut vertices[v as usize];
                pool[(vertex.fan_start + vertex.fan_length) as usize] = t as u32;
                vertex.fan_length += 1;
            }
        }
        let live_triangle_count = triangles.len();
        Self { vertices, triangles, pool, live_triangle_count }
    }

    pub(super) fn kill(&mut self, triangle: u32) {
        self.triangles[triangle as usize][0] = DEAD;
        self.live_triangle_count -= 1;
    }

    /// Fills `fan` with the live triangles at `v` and forgets the dead ones.
    #[inline(always)]
    pub(super) fn walk_fan(&mut self, v: u32, fan: &mut Vec<FanTriangle>) {
        fan.clear();
        let vertex = &mut self.vertices[v as usize];
        let start = vertex.fan_start as usize;
        let slice = &mut self.pool[start..start + vertex.fan_length as usize];
        fan.reserve(slice.len());
        for i in 0..slice.len() {
            let triangle = slice[i];
            let [a, b, c] = self.triangles[triangle as usize];
            if a == DEAD {
                continue;
            }
            // Which corner it is cannot be predicted: masks, not branches.
            let (at_a, at_b) = (mask(a == v), mask(b == v));
            let at_c = !(at_a | at_b);
            let next = (b & at_a) | (c & at_b) | (a & at_c);
            let previous = (c & at_a) | (a & at_b) | (b & at_c);
            if fan.len() < i {
                slice[fan.len()] = triangle;
            }
            fan.push(FanTriangle { triangle, next, previous });
        }
        vertex.fan_length = fan.len() as u32;
    }

    /// Gives `v` the fan made of `a` and `b`; both are live triangles already renamed to `v`.
    /// `gone` is the vertex whose slice is free now.
    pub(super) fn set_fan(&mut self, v: u32, gone: u32, triangles: impl Iterator<Item = u32> + Clone) {
        let length = triangles.clone().count();
        let (own, other) = (self.vertices[v as usize], self.vertices[gone as usize]);
        let fits = |vertex: Vertex| vertex.fan_length as usize >= length;
        let start = if fits(own) {
            own.fan_start as usize
        } else if fits(other) {
            other.fan_start as usize
        } else {
            if self.pool.len() + length > self.pool.capacity() {
                self.vertices[v as usize].fan_length = 0;
                self.vertices[gone as usize].fan_length = 0;
                self.compact(length);
            }
            let start = self.pool.len();
            self.pool.resize(start + length, 0);
            start
        };
        for (slot, triangle) in self.pool[start..start + length].iter_mut().zip(triangles) {
            *slot = triangle;
        }
        let vertex = &mut self.vertices[v as usize];
        vertex.fan_start = start as u32;
        vertex.fan_length = length as u32;
        self.vertices[gone as usize].fan_length = 0;
    }

    /// Rewrites the pool in vertex order without the dead triangles and the abandoned slices.
    fn compact(&mut self, extra: usize) {
        let needed = 3 * self.live_triangle_count + extra;
        let mut pool = Vec::with_capacity(needed + needed / 2 + 1024);
        for vertex in &mut self.vertices {
            let start = pool.len();
            let old = vertex.fan_start as usize;
            let slice = &self.pool[old..old + vertex.fan_length as usize];
            pool.extend(slice.iter().copied().filter(|&t| self.triangles[t as usize][0] != DEAD));
            vertex.fan_start = start as u32;
            vertex.fan_length = (pool.len() - start) as u32;
        }
        self.pool = pool;
    }

    /// Area vector (twice the area long) of a triangle of `v`'s fan with `v` at `position`.
    #[inline(always)]
    pub(super) fn area_vector(&self, position: Vec3, next: u32, previous: u32) -> Vec3 {
        let a = self.vertices[next as usize].position - position;
        let b = self.vertices[previous as usize].position - position;
        a.cross(b)
    }
}
