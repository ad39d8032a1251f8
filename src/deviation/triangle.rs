//! One triangle in `f64`: its area, and the exact distance of a point from it.
//!
//! Corners are the file's `f32`, which `f64` holds exactly: differences are exact or nearly so, and
//! fourth powers of any `f32` length neither overflow nor vanish, so nothing has to be normalised.

/// A point or a vector in a part's local space.
pub(super) type Point = [f64; 3];

#[inline(always)]
pub(super) fn wide(p: [f32; 3]) -> Point {
    [f64::from(p[0]), f64::from(p[1]), f64::from(p[2])]
}

#[inline(always)]
fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Length of the segment from `a` to `b`.
pub(super) fn length(a: [f32; 3], b: [f32; 3]) -> f64 {
    let edge = minus(wide(b), wide(a));
    dot(edge, edge).sqrt()
}

/// Area in squared local units; 0 for a triangle without a surface.
pub(super) fn area(corners: &[[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(wide);
    let normal = cross(minus(b, a), minus(c, a));
    0.5 * dot(normal, normal).sqrt()
}

/// Barycentric coordinates of the place in the triangle that is nearest to `p` (Ericson 2005, section 5.1.5).
pub(super) fn closest_weights(p: Point, corners: &[[f32; 3]; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(wide);
    let (ab, ac) = (minus(b, a), minus(c, a));
    let (d1, d2) = (dot(ab, minus(p, a)), dot(ac, minus(p, a)));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (dot(ab, minus(p, b)), dot(ac, minus(p, b)));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = share(d1, d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let (d5, d6) = (dot(ab, minus(p, c)), dot(ac, minus(p, c)));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = share(d2, d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = share(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let (v, w) = (share(vb, va + vb + vc), share(vc, va + vb + vc));
    [1.0 - v - w, v, w]
}

/// `part / whole` from 0 to 1; 0 of nothing.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 0.0 }
}

/// The point with the given barycentric coordinates.
#[inline(always)]
pub(super) fn point_at(corners: &[[f32; 3]; 3], weights: [f64; 3]) -> Point {
    let [a, b, c] = corners.map(wide);
    let [u, v, w] = weights;
    [u * a[0] + v * b[0] + w * c[0], u * a[1] + v * b[1] + w * c[1], u * a[2] + v * b[2] + w * c[2]]
}

/// `p` moved by so many times a direction.
#[inline(always)]
pub(super) fn along(p: Point, direction: Point, times: f64) -> Point {
    [p[0] + times * direction[0], p[1] + times * direction[1], p[2] + times * direction[2]]
}

/// Two directions of length 1 at a right angle in the triangle's plane; the second is 0 if the
/// triangle is so thin that it has none.
pub(super) fn tangents(corners: &[[f32; 3]; 3]) -> [Point; 2] {
    let [a, b, c] = corners.map(wide);
    let unit = |v: Point| {
        let squared = dot(v, v);
        if squared > 0.0 { v.map(|x| x / squared.sqrt()) } else { [0.0; 3] }
    };
    let first = unit(minus(b, a));
    let ac = minus(c, a);
    [first, unit(along(ac, first, -dot(ac, first)))]
}

/// Squared distance of `p` from the nearest point of the triangle, by the region of the plane that
/// `p` projects to (Ericson 2005, section 5.1.5).
#[inline]
pub(super) fn distance_squared(p: Point, corners: &[[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(wide);
    let (ab, ac, ap) = (minus(b, a), minus(c, a), minus(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return dot(ap, ap);
    }
    let bp = minus(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return dot(bp, bp);
    }
    let cp = minus(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return dot(cp, cp);
    }
    // Twice the areas that p's projection spans with each edge, times the triangle's normal.
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return from_line(ap, ab);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return from_line(ap, ac);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return from_line(bp, minus(c, b));
    }
    let normal = cross(ab, ac);
    let (height, squared) = (dot(normal, ap), dot(normal, normal));
    if squared > 0.0 {
        return height * height / squared;
    }
    // A needle so thin that its normal vanishes is its edges.
    from_segment(ap, ab).min(from_segment(ap, ac)).min(from_segment(bp, minus(c, b)))
}

/// Squared distance of the end of `offset` from the line along `direction` through its start.
#[inline(always)]
fn from_line(offset: Point, direction: Point) -> f64 {
    let squared = dot(direction, direction);
    let t = if squared > 0.0 { dot(offset, direction) / squared } else { 0.0 };
    let rest = [offset[0] - t * direction[0], offset[1] - t * direction[1], offset[2] - t * direction[2]];
    dot(rest, rest)
}

/// As [`from_line`], from the segment that `direction` spans.
fn from_segment(offset: Point, direction: Point) -> f64 {
    let squared = dot(direction, direction);
    let along = dot(offset, direction);
    if along <= 0.0 {
        return dot(offset, offset);
    }
    if along >= squared {
        let rest = minus(offset, direction);
        return dot(rest, rest);
    }
    from_line(offset, direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn every_region_has_its_distance() {
        let cases: [(Point, f64); 9] = [
            ([1.0, 1.0, 3.0], 9.0),    // above the inside
            ([1.0, 1.0, 0.0], 0.0),    // on it
            ([-3.0, -4.0, 0.0], 25.0), // corner a
            ([6.0, -1.0, 2.0], 9.0),   // corner b
            ([0.0, 7.0, 0.0], 9.0),    // corner c
            ([2.0, -2.0, 1.0], 5.0),   // edge ab
            ([-2.0, 1.0, 1.0], 5.0),   // edge ac
            ([4.0, 4.0, 0.0], 8.0),    // edge bc
            ([3.0, 3.0, 1.0], 3.0),    // edge bc, raised
        ];
        for (p, expected) in cases {
            // Any rotation or reversal of the corners is the same triangle.
            for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0], [0, 2, 1], [1, 0, 2]] {
                let got = distance_squared(p, &order.map(|k| CORNERS[k]));
                assert!((got - expected).abs() < 1e-14, "{p:?} in order {order:?}: {got}, not {expected}");
            }
        }
    }

    #[test]
    fn area_and_points_are_those_of_the_plane() {
        assert_eq!(area(&CORNERS), 8.0);
        assert_eq!(area(&[[1.0; 3], [2.0; 3], [3.0; 3]]), 0.0);
        assert_eq!(point_at(&CORNERS, [0.25, 0.25, 0.5]), [1.0, 2.0, 0.0]);
        assert_eq!(length(CORNERS[1], CORNERS[0]), 4.0);
    }

    #[test]
    fn the_closest_weights_are_those_of_the_closest_point() {
        for x in -6..9 {
            for y in -6..9 {
                for z in [-1.0, 0.0, 2.0] {
                    let p = [f64::from(x), f64::from(y), z];
                    let weights = closest_weights(p, &CORNERS);
                    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                    assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{weights:?}");
                    let away = minus(point_at(&CORNERS, weights), p);
                    assert!((dot(away, away) - distance_squared(p, &CORNERS)).abs() < 1e-12, "{p:?}");
                }
            }
        }
    }

    #[test]
    fn tangents_are_at_right_angles_in_the_plane() {
        for corners in [CORNERS, [[1.0, 2.0, 3.0], [-1.0, 4.0, 2.0], [5.0, 5.0, 9.0]]] {
            let [u, v] = tangents(&corners);
            assert!((dot(u, u) - 1.0).abs() < 1e-15 && (dot(v, v) - 1.0).abs() < 1e-15 && dot(u, v).abs() < 1e-15);
            let normal = cross(minus(wide(corners[1]), wide(corners[0])), minus(wide(corners[2]), wide(corners[0])));
            assert!(dot(normal, u).abs() < 1e-13 && dot(normal, v).abs() < 1e-13);
        }
        assert_eq!(tangents(&[[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), [[1.0, 0.0, 0.0], [0.0; 3]]);
        assert_eq!(tangents(&[[0.0; 3]; 3]), [[0.0; 3]; 2]);
    }

    #[test]
    fn lengths_at_the_ends_of_f32_keep_their_distance() {
        for unit in [1e-44_f32, 1e-30, 1e30, 8e37] {
            let corners = CORNERS.map(|p| p.map(|c| c * unit));
            let u = f64::from(corners[1][0]) / 4.0;
            let got = distance_squared([u, u, 3.0 * u], &corners).sqrt();
            assert!((got / u - 3.0).abs() < 1e-12, "unit {unit}: {got}");
            assert!(area(&corners) > 0.0 && area(&corners).is_finite());
        }
    }
}
