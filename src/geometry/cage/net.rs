//! Nets of patches, and of halves and quarters of them.

use glam::DVec3;

/// The control points of a patch, v fastest; `(degree + 1)²` of them are in use.
pub(super) type Net = [DVec3; 16];

/// The control points of a part of a patch with n × n points, the upper, the lower half or the
/// whole in u and in v: de Casteljau at the middle.
pub(super) fn part(net: &Net, n: usize, halves: [Option<bool>; 2]) -> Net {
    let mut result = *net;
    for (half, [next, stride]) in halves.into_iter().zip([[1, n], [n, 1]]) {
        let Some(upper) = half else { continue };
        for line in 0..n {
            halve(&mut result, n, (line * next, stride), upper);
        }
    }
    result
}

/// Keeps one half of a curve of n points at the indices `start`, `start + stride` and so on.
pub(super) fn halve(net: &mut [DVec3], n: usize, (start, stride): (usize, usize), upper: bool) {
    let at = |index: usize| start + index * stride;
    for round in 1..n {
        if upper {
            for j in 0..n - round {
                net[at(j)] = 0.5 * (net[at(j)] + net[at(j + 1)]);
            }
        } else {
            for j in (round..n).rev() {
                net[at(j)] = 0.5 * (net[at(j - 1)] + net[at(j)]);
            }
        }
    }
}

/// The largest angle, or for large ones its sine, between the normals of two patches with n × n
/// points at a corner that has normals.
pub(super) fn corner_turn(a: &Net, b: &Net, n: usize) -> f64 {
    let last = n * n - 1;
    // A corner, and its neighbours along v and u.
    let corners = [
        [0, 1, n],
        [n - 1, n - 2, 2 * n - 1],
        [last + 1 - n, last + 2 - n, last + 1 - 2 * n],
        [last, last - 1, last - n],
    ];
    let normal = |net: &Net, [at, beside, next]: [usize; 3]| {
        (net[next] - net[at]).cross(net[beside] - net[at]).try_normalize()
    };
    let turn = |corner| match (normal(a, corner), normal(b, corner)) {
        (Some(a), Some(b)) => {
            let sine = a.cross(b).length();
            if a.dot(b) > 0.0 { sine } else { 1.0 }
        }
        _ => 0.0,
    };
    corners.into_iter().map(turn).fold(0.0, f64::max)
}
