//! Bézier pieces: de Casteljau's algorithm and Bernstein polynomials.

use glam::DVec4;

use super::mix;
use crate::geometry::knots::BasisValues;
use crate::geometry::knots::MAX_DEGREE;

/// The point at `t` of the Bézier curve with these homogeneous control points, at most
/// [`MAX_DEGREE`] + 1 of them, by de Casteljau's repeated mixing of neighbours:
/// `P_i^r(t) = (1 − t) P_i^{r−1}(t) + t P_{i+1}^{r−1}(t)`, `P_i^0 = P_i`.
///
/// `None` for no points or too many.
pub fn de_casteljau(points: &[DVec4], t: f64) -> Option<DVec4> {
    let mut d = [DVec4::ZERO; MAX_DEGREE + 1];
    let count = points.len();
    d.get_mut(..count)?.copy_from_slice(points);
    for last in (1..count).rev() {
        for j in 0..last {
            d[j] = mix(d[j], d[j + 1], t);
        }
    }
    (count > 0).then_some(d[0])
}

/// The control points of the two pieces of a Bézier curve below and above `t`: the first
/// and the last points of each round of de Casteljau's algorithm. They share the point at
/// `t` bit for bit.
///
/// `None` for no points or more than [`MAX_DEGREE`] + 1.
pub fn split_bezier(points: &[DVec4], t: f64) -> Option<(Vec<DVec4>, Vec<DVec4>)> {
    if !(1..=MAX_DEGREE + 1).contains(&points.len()) {
        return None;
    }
    let mut above = points.to_vec();
    let mut below = Vec::with_capacity(points.len());
    for last in (0..points.len()).rev() {
        below.push(above[0]);
        for j in 0..last {
            above[j] = mix(above[j], above[j + 1], t);
        }
    }
    Some((below, above))
}

/// The Bernstein polynomials `B_{k,n}(t) = (n choose k) tᵏ (1 − t)ⁿ⁻ᵏ`, `k = 0 … n`.
///
/// A Bézier curve is `Σ P_i B_{i,n}(t)`.
///
/// Entries beyond the one at `degree` are 0. `None` for degrees above [`MAX_DEGREE`].
pub fn bernstein(degree: usize, t: f64) -> Option<BasisValues> {
    let mut values = [0.0; MAX_DEGREE + 1];
    if degree > MAX_DEGREE {
        return None;
    }
    values[0] = 1.0;
    for q in 1..=degree {
        let mut from_left = 0.0;
        for value in &mut values[..q] {
            let function = *value;
            *value = from_left + function * (1.0 - t);
            from_left = function * t;
        }
        values[q] = from_left;
    }
    Some(values)
}
