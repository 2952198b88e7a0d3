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
