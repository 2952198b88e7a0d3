//! How much farther apart two places of a leaf may be than their points.

use glam::{DVec2, DVec3};

use super::bicubic::{Fit, NO_WEIGHT, WeightFit, in_both_directions, is_biquadratic};
use super::fit_error::{BLOSSOM, REACHES};
use super::term;
use crate::patch::FitError;

/// How much less than in the middle all matrices are taken to stretch, whatever the terms: for
/// rounding, in f64 and of the weight to f32.
const ROUNDING: f64 = 1e-4;

/// See [`Leaf::stretch`](super::Leaf::stretch). Infinite, too, where tangents in the middle are
/// parallel or zero.
///
/// The points of two places differ by the means of both tangents on the way from one place to the
/// other, times the differences of the places. Only the parts of these in the plane of the tangents
/// in the middle are looked at: where a leaf bends out of that plane, its points are no closer. (So
/// a finite stretch says nothing of how far it bends.)
///
/// With the half sides made unit vectors, let the columns of `M` be the components of both tangents
/// along two axes in that plane, at 45° to the bisector of those in the middle, which are at an
/// angle `φ`. In the middle `M` is symmetric, and its least eigenvalue is `√(1 − |cos φ|)`. For a
/// unit vector `v`, `|M v|` is at least `v · M v`. That is less than in the middle by no more than
/// the largest eigenvalue of the symmetric part of the difference, whose entries are bounded by
/// what the terms of polynomials add up to, and by the error of the approximation. The same holds
/// for means of `M`. (So tangents that turn together, as around a pole, lose little.)
pub(super) fn stretch(fit: &Fit, weight: &WeightFit, error: &FitError) -> f64 {
    let (a, b) = (term(fit, 4), term(fit, 1));
    let lengths = [a.length(), b.length()];
    let (unit_a, unit_b) = (a / lengths[0], b / lengths[1]);
    let [ahead, aside] = [unit_a + unit_b, unit_a - unit_b].map(DVec3::normalize);
    let axes = [ahead + aside, ahead - aside].map(|axis| axis * std::f64::consts::FRAC_1_SQRT_2);
    let terms = std::array::from_fn(|m| {
        let term = term(fit, m);
        DVec2::new(term.dot(axes[0]), term.dot(axes[1]))
    });
    let turning = if *weight != NO_WEIGHT {
        // Without terms of third degree, there are a third as many products.
        let powers = if is_biquadratic(fit, weight) { 3 } else { 4 };
        of_quotient((&terms, weight, powers), lengths, error)
    } else if tangents_are_short(fit, lengths) {
        Some(of_polynomial(&terms, lengths, error.slope))
    } else {
        None
    };
    let Some(Turning { diagonal: [x, y], others }) = turning else { return f64::INFINITY };
    let turned = 0.5 * (x + y + (x - y).hypot(others));
    let left = (1.0 - unit_a.dot(unit_b).abs()).sqrt() - turned - ROUNDING;
    let stretches = left > 1e-3; // false for NaN
    if stretches { 1.0 / left } else { f64::INFINITY }
}

/// Whether the terms of either tangent of a polynomial, wherever it bends, add up to no more than
/// twice its length in the middle. Their rounding errors are told by that.
fn tangents_are_short(fit: &Fit, lengths: [f64; 2]) -> bool {
    let mut others = [0.0; 2];
    for m in 0..16 {
        let (i, j) = (m / 4, m % 4);
        if i + j > 1 {
            let size = term(fit, m).length() * REACHES[i + j - 1];
            others[0] += i as f64 * size;
            others[1] += j as f64 * size;
        }
    }
    others[0] <= lengths[0] && others[1] <= lengths[1]
}

/// Bounds of how far the matrix of both tangents is from that in the middle.
struct Turning {
    /// Of the entries on the diagonal.
    diagonal: [f64; 2],
    /// Of the sum of the other two.
    others: f64,
}

impl Turning {
    /// From how both tangents differ from those in the middle: the coefficients of `xⁱ yʲ`, for `i`
    /// and `j` below `powers`, which are multiplied by `scale`; and an error bound of either.
    #[inline(always)]
    fn new(
        differences: impl Fn(usize, usize) -> [DVec2; 2],
        (powers, scale): (usize, f64),
        lengths: [f64; 2],
        error: f64,
    ) -> Self {
        let per_length = lengths.map(|length| 1.0 / length);
        let (mut diagonal, mut others) = ([0.0; 2], 0.0);
        for i in 0..powers {
            for j in 0..powers {
                let [by_x, by_y] = differences(i, j);
                let (by_x, by_y) = (by_x * per_length[0], by_y * per_length[1]);
                let reach = REACHES[i] * REACHES[j];
                diagonal[0] += by_x.x.abs() * reach;
                diagonal[1] += by_y.y.abs() * reach;
                others += (by_x.y + by_y.x).abs() * reach;
            }
        }
        let off = per_length.map(|per_length| error * per_length);
        Self {
            diagonal: [scale * diagonal[0] + off[0], scale * diagonal[1] + off[1]],
            others: scale * others + off[0] + off[1],
        }
    }
}

/// For a polynomial with these terms.
fn of_polynomial(terms: &[DVec2; 16], lengths: [f64; 2], error: f64) -> Turning {
    let differences = |i: usize, j: usize| {
        let by_x = if i < 3 { (i + 1) as f64 * terms[4 * i + 4 + j] } else { DVec2::ZERO };
        let by_y = if j < 3 { (j + 1) as f64 * terms[4 * i + j + 1] } else { DVec2::ZERO };
        if i + j == 0 { [DVec2::ZERO; 2] } else { [by_x, by_y] }
    };
    Turning::new(differences, (4, 1.0), lengths, error)
}

/// For a surface `S = X / W`: with the tangents `a` and `b` in the middle,
///
/// `S_x − a = (X_x W − X W_x − W² a) / W²`, and the same for `y` and `b`.
///
/// The approximation's error adds the slopes' error of `X` and `W` for the surface's own point, and
/// the points' error times the slope of `W`, over `W`. (That of `W` itself is left to `ROUNDING`.)
/// All terms have fewer than `powers` powers of `x`, and of `y`. `None` where weights may be zero.
fn of_quotient(
    (terms, weight, powers): (&[DVec2; 16], &WeightFit, usize),
    lengths: [f64; 2],
    error: &FitError,
) -> Option<Turning> {
    let weight = weight.map(f64::from);
    let mut in_powers = [[0.0; 4]; 4];
    in_powers.as_flattened_mut().copy_from_slice(&weight);
    let weights = in_both_directions(&BLOSSOM, &in_powers);
    let least = weights.as_flattened().iter().copied().fold(f64::INFINITY, f64::min);
    let positive = least > 0.0; // false for NaN
    if !positive {
        return None;
    }

    // Coefficients of `xⁱ yʲ` of `W²`, of `X_x W − X W_x`, and of `X_y W − X W_y`.
    let mut squared = [[0.0; 7]; 7];
    let (mut by_x, mut by_y) = ([[DVec2::ZERO; 7]; 7], [[DVec2::ZERO; 7]; 7]);
    let mut weight_slope = 0.0;
    for m in (0..4 * powers).filter(|m| m % 4 < powers) {
        let (k, l) = (m / 4, m % 4);
        if m > 0 {
            weight_slope += (k + l) as f64 * weight[m].abs() * REACHES[k + l - 1];
        }
        for i in 0..powers {
            for j in 0..powers {
                let term = weight[m] * terms[4 * i + j];
                squared[i + k][j + l] += weight[m] * weight[4 * i + j];
                if i != k {
                    by_x[i + k - 1][j + l] += (i as f64 - k as f64) * term;
                }
                if j != l {
                    by_y[i + k][j + l - 1] += (j as f64 - l as f64) * term;
                }
            }
        }
    }
    let [a, b] = [terms[4], terms[1]];
    let differences =
        |i: usize, j: usize| [by_x[i][j] - squared[i][j] * a, by_y[i][j] - squared[i][j] * b];
    let scale = 1.0 / (least * least);
    let off = (error.slope + error.value / least * weight_slope) / least;
    Some(Turning::new(differences, (2 * powers - 1, scale), lengths, off))
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec4};

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface, shapes};
    use crate::patch::{FIT_DOMAIN, Leaf, PatchSet, ScaledFrame};

    /// Of the leaves of the first surface, but for those with poles: all stretches, and the largest
    /// that two places show.
    fn check(surfaces: &[NurbsSurface]) -> (Vec<f64>, f64) {
        let (set, parts) = PatchSet::new(surfaces).unwrap();
        let frame = ScaledFrame::around(&set.bounds());
        let mut seen = 0u32;
        let mut place = || {
            seen += 1;
            // Evenly distributed (Roberts 2018).
            let of = |step: f64| FIT_DOMAIN * (2.0 * (f64::from(seen) * step).fract() - 1.0);
            DVec2::new(of(0.754_877_666_246_692_7), of(0.569_840_290_998_053_2))
        };
        let (mut stretches, mut shown) = (Vec::new(), 0f64);
        for part in parts.all() {
            let piece = &set.pieces()[part.piece as usize];
            let (leaf, _, _) = Leaf::new(part, piece, &frame);
            // At a pole, places differ whose points do not.
            if piece.surface != 0 || leaf.has_pole() {
                continue;
            }
            let sides = DVec2::from(leaf.half_side_lengths().map(f64::from));
            let stretch = f64::from(leaf.stretch());
            let [s, t] = leaf.rect();
            let point = |place: DVec2| {
                let at = |[from, to]: [f64; 2], x: f64| 0.5 * (from + to + x * (to - from));
                piece.patch.point(DVec2::new(at(s, place.x), at(t, place.y)))
            };
            for _ in 0..200 {
                let (from, to) = (place(), place());
                for to in [to, from.lerp(to, 1e-3)] {
                    let ratio = ((to - from) * sides).length() / point(to).distance(point(from));
                    assert!(ratio <= stretch * (1.0 + 1e-6), "{ratio} of {stretch}: {leaf:?}");
                    shown = shown.max(ratio);
                }
            }
            stretches.push(stretch);
        }
        (stretches, shown)
    }

    fn sheet(point: impl Fn(f64, f64) -> DVec4) -> NurbsSurface {
        let knots = KnotVector::clamped_uniform(3, 7).unwrap();
        let net = (0..49).map(|k| point(f64::from(k / 7), f64::from(k % 7))).collect();
        NurbsSurface::from_homogeneous(knots.clone(), knots, net).unwrap()
    }

    #[test]
    fn places_are_no_farther_apart_than_stretched_points() {
        // Among many others, its leaves are few and large.
        let sphere = |k: i32| {
            let aside = DAffine3::from_translation(DVec3::new(3.0 * f64::from(k), 0.0, 0.0));
            shapes::sphere(1.0).unwrap().transformed(&aside).unwrap()
        };
        let spheres: Vec<NurbsSurface> = (0..400).map(sphere).collect();
        let weight = |x: f64, y: f64| 1.0 + 0.3 * (2.0 * x + y).sin();
        let weighted =
            sheet(|x, y| weight(x, y) * DVec4::new(x, y, 0.3 * (1.3 * x).sin() * y.cos(), 1.0));
        let leaning = sheet(|x, y| DVec4::new(x + 0.6 * y, y, 0.2 * (x - y).cos(), 1.0));
        let (stretches, shown) = check(&spheres);
        let small = stretches.iter().filter(|&&stretch| stretch < 1.5 * shown).count();
        assert!(2 * small >= stretches.len(), "{stretches:?}, {shown}");
        let thin = sheet(|x, y| DVec4::new(x, 1e-3 * y + 0.01 * x * x, 0.2 * x.sin(), 1.0));
        let twisted = sheet(|x, y| {
            let w = 0.02 + 0.1 * x;
            DVec4::new(x, 1e-3 * y + w * y * x, 0.01 * y * x, 1.0 + 0.05 * x)
        });
        let acute = sheet(|x, y| DVec4::new(x + 9.0 * y, y + 0.1 * x, 0.3 * (x - y).sin(), 1.0));
        for surface in [thin, twisted, acute] {
            let _ = check(&[surface]);
        }
        for surface in [shapes::torus(1.0, 0.03).unwrap(), weighted, leaning] {
            let (stretches, shown) = check(&[surface]);
            assert!(
                stretches.iter().all(|&stretch| stretch < 1.5 * shown),
                "{stretches:?}, {shown}"
            );
        }
    }
}
