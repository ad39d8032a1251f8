//! Triangles of a polygon: the better diagonal of a quad, ear clipping for what has more corners.
//!
//! Ears are cut in the coordinate plane that shows the most of the polygon (the largest component
//! of its vector area, by Newell's method), after Meisters, *Polygons have ears* (1975). A corner
//! is an ear if it is convex and no other corner lies in or on its triangle; "on" keeps collinear
//! corners, which exporters leave at T-junctions, from ending up in triangles without area.

mod grid;

use grid::Grid;

/// What a triangulation costs and yields; buffers are reused from polygon to polygon.
#[derive(Debug)]
pub(super) struct Triangulator {
    /// Corner numbers of the triangles of the last polygon.
    triangles: Vec<[usize; 3]>,
    /// Corners in the plane.
    plane: Vec<[f64; 2]>,
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Whether a corner is not strictly convex: only such can lie in an ear.
    is_reflex: Vec<bool>,
    /// Where the corners are that were reflex at the start; no others become so.
    grid: Grid,
    /// Steps of containment tests left for the whole file; then corners are cut as they come.
    budget: usize,
}

/// Bounds the time one file can take in concave polygons to about a second.
const CONTAINMENT_STEPS: usize = 200_000_000;

/// How far to look for a convex corner when there is no ear.
const MAXIMUM_SEARCH: usize = 64;

impl Triangulator {
    /// For the polygons of one file.
    pub(super) fn new() -> Self {
        Self {
            triangles: Vec::new(),
            plane: Vec::new(),
            next: Vec::new(),
            previous: Vec::new(),
            is_reflex: Vec::new(),
            grid: Grid::default(),
            budget: CONTAINMENT_STEPS,
        }
    }

    /// `corners.len() - 2` triangles of corner numbers, wound as the polygon is, and whether all of
    /// them were found by the rules, which holds for polygons that do not cross themselves. At
    /// least three corners.
    #[inline(never)]
    pub(super) fn triangulate(&mut self, corners: &[[f32; 3]]) -> (&[[usize; 3]], bool) {
        self.triangles.clear();
        let regular = match corners.len() {
            0..3 => true,
            3 => {
                self.triangles.push([0, 1, 2]);
                true
            }
            4 => {
                let halves = split_quad(corners);
                self.triangles.extend(halves);
                true
            }
            _ => self.clip_ears(corners),
        };
        (&self.triangles, regular)
    }

    fn clip_ears(&mut self, corners: &[[f32; 3]]) -> bool {
        let count = corners.len();
        if !self.project(corners) {
            self.triangles.extend((1..count - 1).map(|i| [0, i, i + 1]));
            return false;
        }
        self.next.clear();
        self.next.extend((1..count).chain([0]));
        self.previous.clear();
        self.previous.extend([count - 1].into_iter().chain(0..count - 1));
        self.is_reflex.clear();
        self.is_reflex.resize(count, false);
        for i in 0..count {
            self.is_reflex[i] = self.turn(i) <= 0.0;
        }
        self.grid.fill(&self.plane, &self.is_reflex);

        let mut regular = true;
        let (mut left, mut corner, mut misses) = (count, 0, 0);
        while left > 3 {
            if self.is_ear(corner) {
                misses = 0;
            } else if misses < left && self.budget > 0 {
                misses += 1;
                corner = self.next[corner];
                continue;
            } else {
                // No ear all round: the polygon crosses itself, or the budget is spent. Cut the
                // first convex corner, or any, so that the rest still gets its triangles.
                regular = false;
                let mut steps = 0;
                while self.is_reflex[corner] && steps < MAXIMUM_SEARCH {
                    corner = self.next[corner];
                    steps += 1;
                }
                misses = 0;
            }
            let (before, after) = (self.previous[corner], self.next[corner]);
            self.triangles.push([before, corner, after]);
            self.next[before] = after;
            self.previous[after] = before;
            self.is_reflex[corner] = false;
            left -= 1;
            for neighbour in [before, after] {
                self.is_reflex[neighbour] = self.turn(neighbour) <= 0.0;
            }
            // Going on behind the next corner, not at it, makes a zigzag instead of a fan.
            corner = self.next[after];
        }
        self.triangles.push([self.previous[corner], corner, self.next[corner]]);
        regular
    }

    /// Projects the corners so that the polygon runs counter-clockwise; false if it has no area.
    fn project(&mut self, corners: &[[f32; 3]]) -> bool {
        let normal = vector_area(corners);
        let Some(axis) = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())) else { return false };
        if normal[axis] == 0.0 || !normal[axis].is_finite() {
            return false;
        }
        let (mut x, mut y) = ((axis + 1) % 3, (axis + 2) % 3);
        if normal[axis] < 0.0 {
            (x, y) = (y, x);
        }
        self.plane.clear();
        self.plane.extend(corners.iter().map(|c| [f64::from(c[x]), f64::from(c[y])]));
        true
    }

    /// Twice the signed area of a corner with its neighbours: positive where it is convex.
    fn turn(&self, corner: usize) -> f64 {
        cross(self.plane[self.previous[corner]], self.plane[corner], self.plane[self.next[corner]])
    }

    /// A convex corner whose triangle holds no other corner. Corners at the very place of one of
    /// the three do not count: they are where the bridge to a hole comes back.
    fn is_ear(&mut self, corner: usize) -> bool {
        if self.is_reflex[corner] || self.budget == 0 {
            return false;
        }
        let [a, b, c] = [self.previous[corner], corner, self.next[corner]].map(|i| self.plane[i]);
        let mut steps = 0;
        let is_free = self.grid.all_near([a, b, c], &mut steps, |i| {
            let p = self.plane[i];
            let is_inside = self.is_reflex[i]
                && cross(a, b, p) >= 0.0
                && cross(b, c, p) >= 0.0
                && cross(c, a, p) >= 0.0
                && p != a
                && p != b
                && p != c;
            !is_inside
        });
        self.budget = self.budget.saturating_sub(steps);
        is_free
    }
}

/// Both triangles of a quad: along the shorter diagonal if both diagonals lie inside, along the
/// inner one if the quad is concave.
fn split_quad(corners: &[[f32; 3]]) -> [[usize; 3]; 2] {
    const FIRST: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
    const SECOND: [[usize; 3]; 2] = [[0, 1, 3], [1, 2, 3]];
    let whole = vector_area(corners);
    let is_inside =
        |halves: [[usize; 3]; 2]| halves.iter().all(|half| dot(vector_area(&half.map(|i| corners[i])), whole) > 0.0);
    match (is_inside(FIRST), is_inside(SECOND)) {
        (true, false) => FIRST,
        (false, true) => SECOND,
        _ if squared_distance(corners[1], corners[3]) < squared_distance(corners[0], corners[2]) => SECOND,
        _ => FIRST,
    }
}

/// Twice the vector area of a closed polygon (Newell), about its first corner.
fn vector_area(corners: &[[f32; 3]]) -> [f64; 3] {
    let origin = corners[0];
    let mut sum = [0.0; 3];
    for pair in corners.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|p| difference(p, origin));
        for (axis, sum) in sum.iter_mut().enumerate() {
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            *sum += a[j] * b[k] - a[k] * b[j];
        }
    }
    sum
}

fn difference(a: [f32; 3], b: [f32; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| f64::from(a[k]) - f64::from(b[k]))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    let d = difference(a, b);
    dot(d, d)
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangulates a polygon given in the plane, tilted into space; checks that every triangle
    /// has the polygon's orientation and that areas add up, and returns the triangles.
    fn check(points: &[[f32; 2]]) -> Vec<[usize; 3]> {
        let corners: Vec<[f32; 3]> = points.iter().map(|&[x, y]| [x, y, x * 0.5 - y * 0.25 + 3.0]).collect();
        let whole = vector_area(&corners);
        let mut triangulator = Triangulator::new();
        let (triangles, regular) = triangulator.triangulate(&corners);
        assert!(regular, "{points:?}");
        assert_eq!(triangles.len(), points.len() - 2);
        let mut sum = 0.0;
        for triangle in triangles {
            let area = dot(vector_area(&triangle.map(|i| corners[i])), whole) / dot(whole, whole).sqrt();
            assert!(area > 0.0, "{triangle:?} of {points:?}");
            sum += area;
        }
        let whole = dot(whole, whole).sqrt();
        assert!((sum - whole).abs() <= 1e-6 * whole, "{sum} {whole}");
        triangles.to_vec()
    }

    #[test]
    fn a_quad_takes_the_shorter_diagonal() {
        assert_eq!(check(&[[0.0, 0.0], [4.0, -1.0], [8.0, 0.0], [4.0, 1.0]]), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(check(&[[4.0, -1.0], [8.0, 0.0], [4.0, 1.0], [0.0, 0.0]]), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_concave_quad_takes_the_inner_diagonal() {
        // An arrow head: the outer diagonal 0-2 is shorter than the inner one.
        let arrow = [[0.0, 0.0], [10.0, 1.0], [0.0, 2.0], [8.0, 1.0]];
        for turn in 0..4 {
            let mut points = arrow;
            points.rotate_left(turn);
            check(&points);
            points.reverse();
            check(&points);
        }
    }

    #[test]
    fn collinear_corners_leave_no_empty_triangle() {
        check(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        check(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [3.0, 2.0], [0.0, 2.0], [0.0, 1.0]]);
    }

    #[test]
    fn concave_polygons() {
        // A comb, its mirror image, and a star.
        let mut comb = vec![[0.0, 0.0], [16.0, 0.0]];
        for tooth in (0..8_u8).rev() {
            let x = f32::from(tooth) * 2.0;
            comb.extend([[x + 1.5, 9.0], [x + 0.5, 1.0]]);
        }
        check(&comb);
        comb.reverse();
        check(&comb);
        let star: Vec<[f32; 2]> = (0..40_u8)
            .map(|i| {
                let (radius, angle) = (if i % 2 == 0 { 1.0 } else { 5.0 }, f32::from(i) * std::f32::consts::TAU / 40.0);
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        check(&star);
    }

    #[test]
    fn a_hole_with_a_bridge() {
        // The outer square, then over the bridge 4 = 9 around the hole and back.
        check(&[
            [0.0, 0.0],
            [8.0, 0.0],
            [8.0, 8.0],
            [0.0, 8.0],
            [0.0, 0.0],
            [2.0, 2.0],
            [2.0, 6.0],
            [6.0, 6.0],
            [6.0, 2.0],
            [2.0, 2.0],
        ]);
    }

    #[test]
    fn what_crosses_itself_still_gets_its_triangles() {
        let mut triangulator = Triangulator::new();
        let pentagram: Vec<[f32; 3]> = (0..5_u8)
            .map(|i| {
                let angle = f32::from(i) * 2.0 * std::f32::consts::TAU / 5.0;
                [angle.cos(), angle.sin(), 0.0]
            })
            .collect();
        assert_eq!(triangulator.triangulate(&pentagram).0.len(), 3);
        let line: Vec<[f32; 3]> = (0..6_u8).map(|i| [f32::from(i), 0.0, 0.0]).collect();
        let (triangles, regular) = triangulator.triangulate(&line);
        assert!((triangles.len(), regular) == (4, false));
    }
}
