//! Makes the nets for the sums of pieces from a B-spline's control points, in lanes.

use fearless_simd::{Simd, SimdBase, SimdCombine, SimdSplit, f64x4, f64x8};
use fearless_simd_macros::simd;

use super::power_lines::{Lines, MOST_IN_LINE, Shares, coefficients, make_lines};
use crate::patch::{
    LONGEST, LONGEST_OF_CUBIC, NetRoom, NetSource, PieceNet, SplineNet, TensorPatch, ToPowers,
};

/// How many nets are kept. As a rule, more than the pieces that one packet meets: the packets
/// beside it meet some of them, too.
const KEPT: usize = 16;

/// Nets made for the last searches, of a scene's pieces: neighbouring rays often meet the same
/// pieces. Room for the nets is allocated once one is made.
#[derive(Debug, Default)]
pub(crate) struct RecentNets(Option<Box<[RecentNet; KEPT]>>);

#[derive(Debug)]
struct RecentNet {
    piece: u32,
    room: NetRoom,
}

impl RecentNets {
    /// [`TensorPatch::sums_source`] of a piece; if the net is not kept here, it is made in lanes.
    #[inline(always)]
    pub(crate) fn net_of<'n, S: Simd>(
        &'n mut self,
        simd: S,
        piece: u32,
        patch: &'n TensorPatch,
    ) -> PieceNet<'n> {
        match patch.sums_source() {
            NetSource::Kept(net) => net,
            NetSource::Spline(spline) => {
                // Each piece has its place (multiplicative hashing, Knuth 1973), since the length
                // of rows of pieces is often a power of two.
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
        // Unrolled for the most common degrees.
        (Some(along), [3, 3], 3) => make_of(simd, (spline, along), ([3, 3], 3), room),
        (Some(along), [3, 3], 4) => make_of(simd, (spline, along), ([3, 3], 4), room),
        (Some(along), [2, 2], 3) => make_of(simd, (spline, along), ([2, 2], 3), room),
        (Some(along), degree @ [p, q], size) if p.max(q) <= 3 => {
            make_of(simd, (spline, along), (degree, size), room);
        }
        (Some(along), ..) => make_long(simd, (spline, along), room),
    }
    spline.made(room)
}

/// [`make`] by powers, for degrees above three: eight numbers of all rows at a time, then two rows.
#[simd]
fn make_long<S: Simd>(
    simd: S,
    (spline, [along_s, along_t]): (&SplineNet<'_>, [ToPowers<'_>; 2]),
    room: &mut NetRoom,
) {
    const EIGHTS: usize = LONGEST / 8;
    let ([p, q], size) = (spline.degree(), spline.size());
    for i in 0..=p {
        *room.row::<LONGEST>(i) = *spline.row(i);
    }
    let shares = in_all_lanes::<S, MOST_IN_LINE>(simd, along_s, p);
    let columns = Lines { blocks: 1, apart: 0, count: (size * (q + 1)).div_ceil(8), step: EIGHTS };
    make_lines(simd, &shares, p, columns, room.eights());
    let shares = in_all_lanes::<S, MOST_IN_LINE>(simd, along_t, q);
    for first in (0..=p).step_by(2) {
        let second = (first + 1).min(p);
        let mut points = [[0.0; 8]; MOST_IN_LINE];
        for j in 0..=q {
            for (row, half) in [(first, 0), (second, 4)] {
                let numbers = &room.row::<LONGEST>(row)[size * j..size * j + 4];
                points[j][half..half + 4].copy_from_slice(numbers);
            }
        }
        let line = Lines { blocks: 1, apart: 0, count: 1, step: 1 };
        make_lines(simd, &shares, q, line, &mut points);
        // Where points have three numbers, the fourth one belongs to the next point.
        for j in 0..=q {
            for (row, half) in [(first, 0), (second, 4)] {
                let numbers = &mut room.row::<LONGEST>(row)[size * j..size * j + 4];
                numbers.copy_from_slice(&points[j][half..half + 4]);
            }
        }
    }
}

/// [`make`] by powers, for these degrees and numbers a point: two columns, then two rows, at a
/// time.
#[inline(always)]
fn make_of<S: Simd>(
    simd: S,
    (spline, [along_s, along_t]): (&SplineNet<'_>, [ToPowers<'_>; 2]),
    ([p, q], size): ([usize; 2], usize),
    room: &mut NetRoom,
) {
    let along_s = in_all_lanes::<S, 4>(simd, along_s, p);
    let along_t = in_all_lanes::<S, 4>(simd, along_t, q);
    let zero = f64x4::splat(simd, 0.0);
    let mut halves = [[[zero; 2]; 4]; 2];
    for k in 0..=q / 2 {
        let (first, second) = (2 * k * size, (2 * k + 1).min(q) * size);
        let mut points = [f64x8::splat(simd, 0.0); 4];
        for i in 0..=p {
            let row = spline.row::<LONGEST_OF_CUBIC>(i);
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
        // Where points have three numbers, the fourth one belongs to the next point.
        for j in 0..=q {
            let (one, other) = coefficients[j].split();
            one.store_slice(&mut room.row::<LONGEST_OF_CUBIC>(first)[size * j..size * j + 4]);
            other.store_slice(&mut room.row::<LONGEST_OF_CUBIC>(second)[size * j..size * j + 4]);
        }
    }
}

#[inline(always)]
fn in_all_lanes<S: Simd, const N: usize>(
    simd: S,
    to_powers: ToPowers<'_>,
    degree: usize,
) -> Shares<S, N> {
    let mut shares = [[f64x8::splat(simd, 0.0); N]; N];
    // A length known in advance needs no checks.
    let numbers = &to_powers.shares()[..degree * (degree + 1)];
    for i in 0..=degree {
        for k in 0..degree {
            shares[i][k] = f64x8::splat(simd, numbers[degree * i + k]);
        }
    }
    shares
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, DVec4};

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::math::bernstein::{self, Basis};
    use crate::patch::PatchSet;

    /// A surface with more Bézier points than are kept.
    fn dense([p, q]: [usize; 2], rational: bool) -> NurbsSurface {
        let weight = |x: f64, y: f64| if rational { 1.0 + 0.3 * (x + 2.0 * y).sin() } else { 1.0 };
        dense_with([p, q], weight)
    }

    /// The same with the weights of a function.
    fn dense_with([p, q]: [usize; 2], weight: impl Fn(f64, f64) -> f64) -> NurbsSurface {
        let count = if p.max(q) > 3 { 60 } else { 80 };
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
        for degree in [[3, 3], [3, 2], [2, 3], [2, 2], [3, 1], [1, 3], [5, 5], [4, 2], [3, 7]] {
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
                    if p.max(q) <= 3 {
                        assert!(truth.eq(&scalar), "{degree:?}, piece {k}");
                    } else {
                        for (&truth, made) in truth.zip(&scalar) {
                            assert!((truth - *made).abs().max_element() < 1e-12, "{degree:?}, {k}");
                        }
                    }
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

    /// A net's sum by powers; with three numbers a point, without the weight.
    fn sum_by_powers(
        net: &PieceNet<'_>,
        [p, q]: [usize; 2],
        size: usize,
        (s, t): (f64, f64),
    ) -> DVec4 {
        let (x, y) = (2.0 * s - 1.0, 2.0 * t - 1.0);
        let mut sum = [0.0; 4];
        for (i, j) in (0..=p).flat_map(|i| (0..=q).map(move |j| (i, j))) {
            let power = f64::powi(x, i as i32) * f64::powi(y, j as i32);
            for (sum, number) in sum.iter_mut().zip(&net.row(i)[size * j..size * (j + 1)]) {
                *sum += number * power;
            }
        }
        DVec4::from_array(sum)
    }

    /// The sum of a net's Bézier points by Bernstein functions.
    fn sum_by_bernstein(control: &[DVec4], [p, q]: [usize; 2], (s, t): (f64, f64)) -> DVec4 {
        let in_s: Basis = bernstein::basis(p, s);
        let in_t: Basis = bernstein::basis(q, t);
        let terms = control.iter().enumerate();
        terms.map(|(k, &point)| in_s[k / (q + 1)] * in_t[k % (q + 1)] * point).sum()
    }

    /// For the numbers of a net, row by row, the sums by powers equal those by Bernstein functions.
    #[test]
    fn lanes_make_the_same_surface_by_powers() {
        for degree in [[3, 3], [3, 2], [2, 3], [2, 2], [3, 1], [1, 3], [5, 5], [4, 2], [3, 7]] {
            for rational in [false, true] {
                let surface = dense(degree, rational);
                let (set, _) = PatchSet::new(std::slice::from_ref(&surface)).unwrap();
                let size = if rational { 4 } else { 3 };
                let [p, q] = degree;
                let mut others = 0;
                for piece in set.pieces() {
                    let patch = &piece.patch;
                    if p.max(q) > 3 && !patch.sums_by_powers() {
                        others += 1;
                        continue;
                    }
                    assert!(patch.sums_by_powers());
                    let NetSource::Spline(spline) = patch.sums_source() else {
                        panic!("its points are kept");
                    };
                    let control: Vec<_> = patch.control().collect();
                    let most = 1.3 * f64::max(8.0, 0.8 * (p + q + 4) as f64);
                    let most = most * f64::EPSILON * patch.magnitude().max(1.0);
                    for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                        let mut room = NetRoom::new();
                        let net = dispatch!(level, simd => make(simd, &spline, &mut room));
                        for st in [(0.0, 1.0), (0.3, 0.9), (0.5, 0.5), (1.0, 0.2)] {
                            let by_powers = sum_by_powers(&net, degree, size, st);
                            let truth = sum_by_bernstein(&control, degree, st);
                            let off = (by_powers - truth).abs().to_array();
                            let off = off[..size].iter().copied().fold(0.0, f64::max);
                            assert!(off <= most, "{degree:?} at {st:?}: {off:e}, {most:e}");
                        }
                    }
                }
                assert!(4 * others < set.pieces().len(), "{degree:?}: {others}");
            }
        }
    }

    /// A control point at either end of those that govern a piece has so small a share in the piece
    /// that it may be hundreds of times as heavy as all points on the piece, which is well
    /// conditioned all the same: what is made of such points is as exact as what is made of others.
    #[test]
    fn heavy_points_at_the_ends_take_no_digits() {
        for (degree, times) in
            [([3, 3], 100.0), ([5, 5], 300.0), ([7, 7], 1000.0), ([6, 6], 1000.0)]
        {
            let [p, q] = degree;
            for along_u in [true, false] {
                let heavy = |x: f64, y: f64| (if along_u { x } else { y }) == 30.0;
                let surface = dense_with(degree, |x, y| if heavy(x, y) { times } else { 1.0 });
                let (set, _) = PatchSet::new(std::slice::from_ref(&surface)).unwrap();
                let mut checked = 0;
                for piece in set.pieces().iter().filter(|piece| piece.patch.sums_by_powers()) {
                    let patch = &piece.patch;
                    let NetSource::Spline(spline) = patch.sums_source() else {
                        panic!("its points are kept");
                    };
                    let weight = |i: usize, j: usize| spline.points().row(i)[4 * j + 3];
                    if !(0..=p).any(|i| (0..=q).any(|j| weight(i, j) > 1.0)) {
                        continue;
                    }
                    checked += 1;
                    let control: Vec<_> = patch.control().collect();
                    let most = 0.5 * patch.residual_factor() * patch.magnitude();
                    for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                        let mut room = NetRoom::new();
                        let net = dispatch!(level, simd => make(simd, &spline, &mut room));
                        for st in [(0.0, 0.0), (0.3, 0.9), (0.5, 0.5), (1.0, 0.2), (1.0, 1.0)] {
                            let by_powers = sum_by_powers(&net, degree, 4, st);
                            let truth = sum_by_bernstein(&control, degree, st);
                            let [a, b] = [by_powers, truth].map(|at| at.truncate() / at.w);
                            let off = a.distance(b);
                            assert!(off <= most, "{degree:?} at {st:?}: {off:e}, {most:e}");
                        }
                    }
                }
                assert!(checked > 50, "{degree:?}: {checked} pieces");
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
