//! Points of a piece on a grid of parameters.

use glam::{DVec3, DVec4};

use crate::math::bernstein;

/// The points of a net's surface at each pair of these places.
pub(in crate::patch) fn points_at<const M: usize>(
    places: [f64; M],
    degree: [usize; 2],
    net: &[DVec4],
) -> [[DVec3; M]; M] {
    // The same sums with as much room for basis functions as the degrees need.
    match degree[0].max(degree[1]) {
        0..=3 => sums_at::<M, 4>(places, degree, net),
        4..=7 => sums_at::<M, 8>(places, degree, net),
        _ => sums_at::<M, { bernstein::MAX_DEGREE + 1 }>(places, degree, net),
    }
}

fn sums_at<const M: usize, const N: usize>(
    places: [f64; M],
    [p, q]: [usize; 2],
    net: &[DVec4],
) -> [[DVec3; M]; M] {
    let bases = |degree: usize| places.map(|place| bernstein::basis(degree, place));
    let in_s: [[f64; N]; M] = bases(p);
    let in_t = if p == q { in_s } else { bases(q) };
    let mut values = [[DVec3::ZERO; M]; M];
    for (values, in_s) in values.iter_mut().zip(&in_s) {
        let mut sums = [DVec4::ZERO; M];
        for j in 0..=q {
            let mut row = DVec4::ZERO;
            for i in 0..=p {
                row += in_s[i] * net[i * (q + 1) + j];
            }
            for (sum, in_t) in sums.iter_mut().zip(&in_t) {
                *sum += in_t[j] * row;
            }
        }
        *values = sums.map(|sum| sum.truncate() / sum.w);
    }
    values
}
