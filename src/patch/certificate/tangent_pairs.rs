//! How both tangents of a leaf turn together. That says more than how far each turns: their values
//! at one place belong together, and so do their means over one set.

use glam::{DVec3, DVec4};

use crate::math::Interval;

/// Nets of more points use only the bounds of each tangent: a bicubic net has 136 pairs, one of
/// degree 5 × 5 has 666.
const MOST_POINTS: usize = 36;

/// More than the relative rounding error of a sum of four products, with room to spare.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// The proved bounds of the pairs of a polynomial net's tangents.
///
/// Let `a_i` and `b_i` be the coefficients of `S_s` and of `S_t`, both written with the Bernstein
/// functions of the net's own degrees. At each place, and in the mean over any set, the pair of
/// tangents is a mean of the pairs `(a_i, b_i)`, both with the *same* weights `λ_i`. So
///
/// `ā × b̄ = ½ Σ_ij λ_i λ_j N_ij`, `N_ij = a_i × b_j + a_j × b_i`.
///
/// In the frame of [`Certificate`](crate::patch::Certificate), with `a_i = α₁ a₀ + α₂ b₀ + α₃ n`
/// and `b_j` likewise,
///
/// `N_ij = m (a₀ × b₀) + g (a₀ × n) + h (b₀ × n)`,
///
/// where `m` is the sum of `α₁β₂ − α₂β₁` for `(i, j)` and for `(j, i)`, and `g` and `h` are the
/// same sums of `α₁β₃ − α₃β₁` and of `α₂β₃ − α₃β₂`. Where all `m` are positive, the quotients `g/m`
/// and `h/m` of a sum are means of those of its terms: they lie between the least and the largest.
/// And the multiple of `a₀ × b₀` in `ā × b̄` is at least half the least `m`.
///
/// Measured on a rough height field, on the leaves that a camera sees: 69 % are certified by the
/// turns of each tangent from the chords' frame, 76 % by the turns of the pairs, 80 % by the turns
/// of the pairs from their middle; 88 % have at most one root.
pub(super) struct PairTurns {
    /// The ranges of `g/m` and `h/m`.
    pub(super) across: [Interval; 2],
    /// Half the least `m`, or less.
    pub(super) least: f64,
}

/// The tangents' coefficients by component, in the frame.
struct Coefficients {
    count: usize,
    a: [[f64; MOST_POINTS]; 3],
    b: [[f64; MOST_POINTS]; 3],
}

impl PairTurns {
    /// The bounds for a polynomial net, each of whose coordinates has the error bound `noise`. The
    /// products of the `dual` directions with a vector are its components in the frame
    /// `(a₀, b₀, n)`. `None` where a normal may turn away from `n`, or the net is large.
    pub(super) fn new(
        ([p, q], points): ([usize; 2], &[DVec4]),
        noise: f64,
        dual: &[DVec3; 3],
    ) -> Option<Self> {
        if points.len() > MOST_POINTS {
            return None;
        }
        let Coefficients { count, a, b } = Coefficients::new(([p, q], points), dual);
        // The error bound of a product in a minor: the errors of its factors, and rounding.
        let largest = |of: &[f64; MOST_POINTS]| of[..count].iter().fold(0.0, |m, x| x.abs().max(m));
        let (most_a, most_b) = (a.each_ref().map(largest), b.each_ref().map(largest));
        let off = |degree: usize, k: usize| 4.0 * (degree as f64 + 1.0) * noise * dual[k].length();
        let product = |i: usize, j: usize| {
            let (off_a, off_b) = (off(p, i), off(q, j));
            most_a[i] * off_b
                + most_b[j] * off_a
                + off_a * off_b
                + ROUNDINGS * (most_a[i] * most_b[j])
        };
        let minor = |i: usize, j: usize| 2.0 * (product(i, j) + product(j, i));
        let (off_m, off_g, off_h) = (minor(0, 1), minor(0, 2), minor(1, 2));

        let mut across = [Interval::EMPTY; 2];
        let (mut least, mut forward) = (f64::INFINITY, true);
        for i in 0..count {
            let [a1, a2, a3] = [a[0][i], a[1][i], a[2][i]];
            let [b1, b2, b3] = [b[0][i], b[1][i], b[2][i]];
            for j in i..count {
                let [x1, x2, x3] = [a[0][j], a[1][j], a[2][j]];
                let [y1, y2, y3] = [b[0][j], b[1][j], b[2][j]];
                let m = (a1 * y2 - a2 * y1) + (x1 * b2 - x2 * b1) - off_m;
                let g = (a1 * y3 - a3 * y1) + (x1 * b3 - x3 * b1);
                let h = (a2 * y3 - a3 * y2) + (x2 * b3 - x3 * b2);
                let per_m = 1.0 / m;
                // `m` is the least possible; with the largest, quotients are smaller by this
                // fraction.
                let part = 2.0 * off_m * per_m;
                for (across, (x, off)) in across.iter_mut().zip([(g, off_g), (h, off_h)]) {
                    let more = off + (x.abs() + off) * part;
                    across.lo = across.lo.min((x - more) * per_m);
                    across.hi = across.hi.max((x + more) * per_m);
                }
                least = least.min(m);
                forward &= (m > 0.0) & (g + h).is_finite(); // false for NaN
            }
        }
        let across = across.map(|range| range.grown(ROUNDINGS * range.magnitude()));
        let known = across.iter().all(|range| range.magnitude().is_finite());
        let known = known && forward && least.is_finite();
        known.then_some(Self { across, least: 0.5 * least })
    }
}

impl Coefficients {
    fn new(([p, q], points): ([usize; 2], &[DVec4]), dual: &[DVec3; 3]) -> Self {
        let mut to =
            Self { count: points.len(), a: [[0.0; MOST_POINTS]; 3], b: [[0.0; MOST_POINTS]; 3] };
        let at = |i: usize, j: usize| points[i * (q + 1) + j].truncate();
        for i in 0..=p {
            for j in 0..=q {
                // A derivative, its degree raised again.
                let (mut along_s, mut along_t) = (DVec3::ZERO, DVec3::ZERO);
                let here = at(i, j);
                if i > 0 {
                    along_s += i as f64 * (here - at(i - 1, j));
                }
                if i < p {
                    along_s += (p - i) as f64 * (at(i + 1, j) - here);
                }
                if j > 0 {
                    along_t += j as f64 * (here - at(i, j - 1));
                }
                if j < q {
                    along_t += (q - j) as f64 * (at(i, j + 1) - here);
                }
                let m = i * (q + 1) + j;
                for k in 0..3 {
                    to.a[k][m] = dual[k].dot(along_s);
                    to.b[k][m] = dual[k].dot(along_t);
                }
            }
        }
        to
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::Arc;

    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;
    use crate::math::testing::same_cases;
    use crate::patch::TensorPatch;
    use crate::patch::pieces::chart_net::ChartNet;

    /// Nodes and weights of Gauss's rule of four points on [0, 1].
    const GAUSS: [[f64; 2]; 4] = [
        [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
        [0.330_009_478_207_571_87, 0.326_072_577_431_273_07],
        [0.669_990_521_792_428_1, 0.326_072_577_431_273_07],
        [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
    ];

    /// The bounds hold for means along segments between any two places, which a quadrature rule
    /// that is exact for them finds; and the nearest mean comes close to its bound.
    #[test]
    fn means_turn_no_farther() {
        let net = (1usize..=3, 1usize..=3).prop_flat_map(|(p, q)| {
            let point = (-0.15..0.15f64, -0.15..0.15f64, -0.3..0.3f64);
            let points = prop::collection::vec(point, (p + 1) * (q + 1));
            points.prop_map(move |points| {
                let control = points.into_iter().enumerate().map(|(k, (x, y, z))| {
                    let (i, j) = (k / (q + 1), k % (q + 1));
                    DVec4::new(i as f64 / p as f64 + x, j as f64 / q as f64 + y, z, 1.0)
                });
                ([p, q], control.collect::<Vec<_>>())
            })
        });
        let place = || (0.0..=1.0f64, 0.0..=1.0f64).prop_map(|(s, t)| DVec2::new(s, t));
        let segments = prop::collection::vec((place(), place()), 40);
        let (said, closest) = (Cell::new(0), Cell::new(f64::INFINITY));
        proptest!(same_cases(256), |((degree, control) in net, segments in segments)| {
            let (patch, _) = TensorPatch::new(&Arc::new(ChartNet::single(degree, &control)), [0, 0]);
            let dual = [DVec3::X, DVec3::Y, DVec3::Z];
            let turns = PairTurns::new((degree, &control), patch.noise(), &dual);
            let Some(PairTurns { across, least }) = turns else { return Ok(()) };
            said.set(said.get() + 1);
            for (from, to) in segments {
                let (mut a, mut b) = (DVec3::ZERO, DVec3::ZERO);
                for [node, weight] in GAUSS {
                    let jet = patch.jet(from.lerp(to, node));
                    (a, b) = (a + weight * jet.ds, b + weight * jet.dt);
                }
                // In this frame `a₀ × n` is −Y and `b₀ × n` is X.
                let normal = a.cross(b);
                prop_assert!(normal.z >= least, "{normal} from {from} to {to}");
                for (told, part) in across.into_iter().zip([-normal.y, normal.x]) {
                    let part = part / normal.z;
                    let left = (part - told.lo).min(told.hi - part);
                    prop_assert!(left >= 0.0, "{normal} from {from} to {to}: {told:?}");
                    closest.set(closest.get().min(left));
                }
            }
        });
        let (said, closest) = (said.get(), closest.get());
        assert!(said > 50 && closest < 0.02, "{said} nets, one to {closest}");
    }

    /// Nor of NaN.
    #[test]
    fn nothing_is_said_of_folds_and_large_nets() {
        let dual = [DVec3::X, DVec3::Y, DVec3::Z];
        let net = |degree: usize, x: fn(f64) -> f64| -> Vec<DVec4> {
            let at = |k: usize| k as f64 / degree as f64;
            let pairs = (0..=degree).flat_map(|i| (0..=degree).map(move |j| (i, j)));
            pairs.map(|(i, j)| DVec4::new(x(at(i)), at(j), 0.0, 1.0)).collect()
        };
        let said = |degree: usize, x| {
            PairTurns::new(([degree; 2], &net(degree, x)), 1e-15, &dual).is_some()
        };
        assert!(said(5, |x| x));
        assert!(!said(5, |x| x * (1.0 - x)));
        assert!(!said(6, |x| x));
        assert!(!said(3, |x| if x == 0.0 { f64::NAN } else { x }));
        for noise in [f64::NAN, f64::INFINITY] {
            assert!(PairTurns::new(([3; 2], &net(3, |x| x)), noise, &dual).is_none());
        }
    }
}
