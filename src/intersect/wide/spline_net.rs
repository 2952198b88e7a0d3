//! The nets for sums of pieces that are made of a B-spline's control points, in lanes.

use fearless_simd::{Simd, SimdBase, SimdCombine, SimdFloat, SimdSplit, f64x4, f64x8};
use fearless_simd_macros::simd;

use crate::patch::{NetRoom, NetSource, PieceNet, SplineNet, TensorPatch, ToPowers};

/// How many nets are kept. More than the pieces that one packet meets, as a rule: the packets beside it meet some
/// of them, too.
const KEPT: usize = 16;

/// Nets that were made for the last searches, of a scene's pieces: neighbouring rays often meet the same ones.
/// There is room for them once one is made.
#[derive(Debug, Default)]
pub(super) struct RecentNets(Option<Box<[RecentNet; KEPT]>>);

#[derive(Debug)]
struct RecentNet {
    piece: u32,
    room: NetRoom,
}

impl RecentNets {
    /// [`TensorPatch::sums_source`] of a piece, made in lanes where it is not here.
    #[inline(always)]
    pub(super) fn net_of<'n, S: Simd>(
        &'n mut self,
        simd: S,
        (piece, patch): (u32, &'n TensorPatch),
    ) -> PieceNet<'n> {
        match patch.sums_source() {
            NetSource::Kept(net) => net,
            NetSource::Spline(spline) => {
                // Each piece has its place (multiplicative hashing, Knuth 1973): rows of pieces are often as long
                // as a power of two.
                let place = piece.wrapping_mul(0x9e37_79b9) >> (u32::BITS - KEPT.ilog2());
                let nets = self.0.get_or_insert_with(Self::none);
                let RecentNet { piece: made, room } = &mut nets[place as usize];
                if *made == piece {
                    return spline.made(room);
                }
                *made = piece;
                make(simd, &spline, room)
            }
        }
    }

    #[cold]
    fn none() -> Box<[RecentNet; KEPT]> {
        let none = || RecentNet { piece: u32::MAX, room: NetRoom::new() };
        Box::new(std::array::from_fn(|_| none()))
    }
}

/// Makes a net for sums.
#[simd]
pub(super) fn make<'r, S: Simd>(
    simd: S,
    spline: &SplineNet<'_>,
    room: &'r mut NetRoom,
) -> PieceNet<'r> {
    match (spline.by_powers(), spline.degree(), spline.size()) {
        (None, ..) => {
            spline.make(room);
        }
        // Unrolled for the degrees met most.
        (Some(along), [3, 3], 3) => make_of(simd, (spline, along), ([3, 3], 3), room),
        (Some(along), [3, 3], 4) => make_of(simd, (spline, along), ([3, 3], 4), room),
        (Some(along), [2, 2], 3) => make_of(simd, (spline, along), ([2, 2], 3), room),
        (Some(along), degree, size) => make_of(simd, (spline, along), (degree, size), room),
    }
    spline.made(room)
}

/// [`make`] by powers, for these degrees and numbers a point: two columns, then two rows, at a time.
#[inline(always)]
fn make_of<S: Simd>(
    simd: S,
    (spline, [along_s, along_t]): (&SplineNet<'_>, [&ToPowers; 2]),
    ([p, q], size): ([usize; 2], usize),
    room: &mut NetRoom,
) {
    let [along_s, along_t] = [in_all_lanes(simd, along_s), in_all_lanes(simd, along_t)];
    let zero = f64x4::splat(simd, 0.0);
    let mut halves = [[[zero; 2]; 4]; 2];
    for k in 0..=q / 2 {
        let (first, second) = (2 * k * size, (2 * k + 1).min(q) * size);
        let mut points = [f64x8::splat(simd, 0.0); 4];
        for i in 0..=p {
            let row = spline.row(i);
            let one = f64x4::from_slice(simd, &row[first..first + 4]);
            points[i] = one.combine(f64x4::from_slice(simd, &row[second..second + 4]));
        }
        let coefficients = coefficients(simd, &along_s, p, points);
        for i in 0..=p {
            let (first, second) = coefficients[i].split();
            halves[k][i] = [first, second];
        }
    }
    for k in 0..=p / 2 {
        let (first, second) = (2 * k, (2 * k + 1).min(p));
        let mut points = [f64x8::splat(simd, 0.0); 4];
        for j in 0..=q {
            points[j] = halves[j / 2][first][j % 2].combine(halves[j / 2][second][j % 2]);
        }
        let coefficients = coefficients(simd, &along_t, q, points);
        // The last numbers of points of three are those of the next ones.
        for j in 0..=q {
            let (one, other) = coefficients[j].split();
            one.store_slice(&mut room.row(first)[size * j..size * j + 4]);
            other.store_slice(&mut room.row(second)[size * j..size * j + 4]);
        }
    }
}

/// The shares of the second to the fourth control point in each coefficient.
pub(super) type Shares<S> = [[f64x8<S>; 3]; 4];

#[inline(always)]
fn in_all_lanes<S: Simd>(simd: S, to_powers: &ToPowers) -> Shares<S> {
    let mut shares = [[f64x8::splat(simd, 0.0); 3]; 4];
    for i in 0..4 {
        for k in 0..3 {
            shares[i][k] = f64x8::splat(simd, to_powers.shares()[i][k]);
        }
    }
    shares
}

/// The coefficients of powers, from control points.
#[inline(always)]
pub(super) fn coefficients<S: Simd>(
    simd: S,
    shares: &Shares<S>,
    degree: usize,
    points: [f64x8<S>; 4],
) -> [f64x8<S>; 4] {
    let mut coefficients = [f64x8::splat(simd, 0.0); 4];
    coefficients[0] = points[0];
    for k in 1..=degree {
        let other = points[k] - points[0];
        for i in 0..=degree {
            coefficients[i] = other.mul_add(shares[i][k - 1], coefficients[i]);
        }
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use glam::DVec3;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::intersect::Kernel;
    use crate::math::bernstein::{self, Basis};
    use crate::patch::PatchSet;

    /// A surface with more Bézier points than are kept.
    fn dense([p, q]: [usize; 2], rational: bool) -> NurbsSurface {
        let weight = |x: f64, y: f64| if rational { 1.0 + 0.3 * (x + 2.0 * y).sin() } else { 1.0 };
        dense_with([p, q], weight)
    }

    /// The same with the weights of a function.
    fn dense_with([p, q]: [usize; 2], weight: impl Fn(f64, f64) -> f64) -> NurbsSurface {
        let count = 80;
        let knots = |p: usize| {
            // Every seventh knot is repeated until the surface has a crease there.
            let inner = (1..).flat_map(|k| std::iter::repeat_n(k, if k % 7 == 0 { p } else { 1 }));
            let mut values = vec![0.0; p + 1];
            values.extend(inner.take(count - p - 1).map(|k| f64::from(k) + 0.1 * f64::from(k % 3)));
            let end = values[count - 1] + 1.0;
            values.extend(std::iter::repeat_n(end, p + 1));
            KnotVector::new(p, values).unwrap()
        };
        let points = (0..count * count).map(|k| {
            let (x, y) = ((k / count) as f64, (k % count) as f64);
            let w = weight(x, y);
            (w * DVec3::new(x, y, (x * y).cos())).extend(w)
        });
        NurbsSurface::from_homogeneous(knots(p), knots(q), points.collect()).unwrap()
    }

    #[test]
    fn scalar_nets_are_those_of_knot_insertion() {
        for degree in [[3, 3], [3, 2], [2, 3], [2, 2], [3, 1], [1, 3]] {
            for rational in [false, true] {
                let surface = dense(degree, rational);
                let form = surface.bezier_form();
                let stride = form.knots_v().point_count();
                let (set, _) = PatchSet::new(std::slice::from_ref(&surface)).unwrap();
                let (p, q) = (degree[0], degree[1]);
                let columns = form.knots_v().spans().count();
                assert_eq!(set.pieces().len(), form.knots_u().spans().count() * columns);
                for (k, piece) in set.pieces().iter().enumerate() {
                    let NetSource::Spline(spline) = piece.patch.net_source() else {
                        panic!("its points are kept");
                    };
                    let first = k / columns * p * stride + k % columns * q;
                    let truth = (0..=p).flat_map(|i| &form.control()[first + i * stride..][..=q]);
                    let scalar: Vec<_> = piece.patch.control().collect();
                    assert!(truth.eq(&scalar), "{degree:?}, piece {k}");
                    let size = if rational { 4 } else { 3 };
                    let mut room = NetRoom::new();
                    let net = spline.make(&mut room);
                    for (i, row) in scalar.chunks_exact(q + 1).enumerate() {
                        for (j, point) in row.iter().enumerate() {
                            let numbers = &net.row(i)[size * j..size * (j + 1)];
                            assert_eq!(numbers, &point.to_array()[..size], "{degree:?}, {k}");
                        }
                    }
                }
            }
        }
    }

    /// The sums by powers are those of Bernstein functions: of the numbers of a net, row by row.
    #[test]
    fn lanes_make_the_same_surface_by_powers() {
        for degree in [[3, 3], [3, 2], [2, 3], [2, 2], [3, 1], [1, 3]] {
            for rational in [false, true] {
                let surface = dense(degree, rational);
                let (set, _) = PatchSet::new(std::slice::from_ref(&surface)).unwrap();
                let size = if rational { 4 } else { 3 };
                let [p, q] = degree;
                for piece in set.pieces() {
                    let patch = &piece.patch;
                    assert!(patch.sums_by_powers());
                    let NetSource::Spline(spline) = patch.sums_source() else {
                        panic!("its points are kept");
                    };
                    let control: Vec<_> = patch.control().collect();
                    let most = 8.0 * f64::EPSILON * patch.magnitude().max(1.0) * 1.3;
                    for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                        let mut room = NetRoom::new();
                        let net = dispatch!(level, simd => make(simd, &spline, &mut room));
                        for (s, t) in [(0.0, 1.0), (0.3, 0.9), (0.5, 0.5), (1.0, 0.2)] {
                            let in_s: Basis = bernstein::basis(p, s);
                            let in_t: Basis = bernstein::basis(q, t);
                            let (x, y) = (2.0 * s - 1.0, 2.0 * t - 1.0);
                            for c in 0..size {
                                let (mut by_powers, mut truth) = (0.0, 0.0);
                                for i in 0..=p {
                                    for j in 0..=q {
                                        let power = f64::powi(x, i as i32) * f64::powi(y, j as i32);
                                        by_powers += net.row(i)[size * j + c] * power;
                                        truth += control[i * (q + 1) + j][c] * (in_s[i] * in_t[j]);
                                    }
                                }
                                let off = f64::abs(by_powers - truth);
                                assert!(off <= most, "{degree:?} at {s}, {t}: {off:e}, {most:e}");
                            }
                        }
                    }
                }
            }
        }
    }

    /// One heavy point among many: only the pieces it governs are badly conditioned by powers.
    #[test]
    fn pieces_are_told_apart_by_their_condition() {
        let surface = dense_with([3, 3], |x, y| if (x, y) == (37.0, 52.0) { 1e3 } else { 1.0 });
        let (set, _) = PatchSet::new(std::slice::from_ref(&surface)).unwrap();
        let mut others = 0;
        for piece in set.pieces().iter().filter(|piece| !piece.patch.sums_by_powers()) {
            others += 1;
            let patch = &piece.patch;
            let NetSource::Spline(spline) = patch.sums_source() else {
                panic!("its points are kept");
            };
            assert!(spline.by_powers().is_none());
            assert!(patch.control().any(|point| point.w > 1.0), "it has none of that point");
            // Its sums are made of the Bézier points.
            for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                let mut room = NetRoom::new();
                let net = dispatch!(level, simd => make(simd, &spline, &mut room));
                for (k, point) in patch.control().enumerate() {
                    assert_eq!(net.row(k / 4)[4 * (k % 4)..][..4], point.to_array());
                }
            }
        }
        assert!((4..=16).contains(&others), "{others} pieces");
    }
}
