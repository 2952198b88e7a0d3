//! Control nets of pieces that are made of a B-spline's control points: in lanes, the numbers that the
//! scalar code makes, to the last bit.

use fearless_simd::{Select, Simd, SimdBase, SimdCombine, SimdSplit, f64x4, f64x8};
use fearless_simd_macros::simd;

use crate::geometry::Mix;
use crate::patch::{NetRoom, NetSource, PieceNet, SplineNet, TensorPatch};

/// Two control points side by side.
#[derive(Clone, Copy)]
struct Two<S: Simd>(f64x8<S>);

impl<S: Simd> Mix for Two<S> {
    /// Not fused: the scalar code has no such operation.
    #[inline(always)]
    fn mixed(self, other: Self, [beta, alpha]: [f64; 2]) -> Self {
        let (a, b, simd) = (self.0, other.0, self.0.simd);
        let sum = a * f64x8::splat(simd, beta) + b * f64x8::splat(simd, alpha);
        Self(a.simd_eq(b).select(a, sum))
    }
}

impl<S: Simd> Two<S> {
    #[inline(always)]
    fn of(a: f64x4<S>, b: f64x4<S>) -> Self {
        Self(a.combine(b))
    }
}

/// [`TensorPatch::net`], made in lanes.
#[inline(always)]
pub(super) fn net_of<'n, S: Simd>(
    simd: S,
    patch: &'n TensorPatch,
    room: &'n mut Option<NetRoom>,
) -> PieceNet<'n> {
    match patch.net_source() {
        NetSource::Kept(net) => net,
        NetSource::Spline(spline) => {
            let is_made = room.is_some();
            let room = room.get_or_insert_with(NetRoom::new);
            if is_made { spline.made(room) } else { make(simd, &spline, room) }
        }
    }
}

/// Makes a net: of the degrees met most in lanes.
#[simd]
pub(super) fn make<'r, S: Simd>(
    simd: S,
    spline: &SplineNet<'_>,
    room: &'r mut NetRoom,
) -> PieceNet<'r> {
    match (spline.degree(), spline.size()) {
        ([3, 3], 3) => make_of::<S, 3, 3>(simd, spline, room),
        ([3, 3], 4) => make_of::<S, 3, 4>(simd, spline, room),
        ([2, 2], 3) => make_of::<S, 2, 3>(simd, spline, room),
        _ => {
            spline.make(room);
        }
    }
    spline.made(room)
}

/// [`make`] for the same degree `P` in both directions, and `C` numbers a point.
#[inline(always)]
fn make_of<S: Simd, const P: usize, const C: usize>(
    simd: S,
    spline: &SplineNet<'_>,
    room: &mut NetRoom,
) {
    let zero = f64x4::splat(simd, 0.0);
    // Along s: columns 0 and 1, then 2 and 3.
    let mut halves = [[[zero; 2]; 4]; 2];
    for k in 0..2 {
        let (first, second) = (2 * k * C, (2 * k + 1).min(P) * C);
        let mut points = [Two::of(zero, zero); 4];
        for i in 0..=P {
            let row = spline.row(i);
            points[i] = Two::of(
                f64x4::from_slice(simd, &row[first..first + 4]),
                f64x4::from_slice(simd, &row[second..second + 4]),
            );
        }
        points = spline.along(0).apply(P, points);
        for i in 0..=P {
            let (first, second) = points[i].0.split();
            halves[k][i] = [first, second];
        }
    }
    // Along t: rows 0 and 1, then 2 and 3.
    for k in 0..2 {
        let (first, second) = (2 * k, (2 * k + 1).min(P));
        let mut points = [Two::of(zero, zero); 4];
        for j in 0..=P {
            points[j] = Two::of(halves[j / 2][first][j % 2], halves[j / 2][second][j % 2]);
        }
        points = spline.along(1).apply(P, points);
        // The last numbers of points of three are those of the next ones.
        for j in 0..=P {
            let (one, other) = points[j].0.split();
            one.store_slice(&mut room.row(first)[C * j..C * j + 4]);
            other.store_slice(&mut room.row(second)[C * j..C * j + 4]);
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use glam::DVec3;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::intersect::Kernel;
    use crate::patch::PatchSet;

    /// A surface with more Bézier points than are kept.
    fn dense([p, q]: [usize; 2], rational: bool) -> NurbsSurface {
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
            let w = if rational { 1.0 + 0.3 * (x + 2.0 * y).sin() } else { 1.0 };
            (w * DVec3::new(x, y, (x * y).cos())).extend(w)
        });
        NurbsSurface::from_homogeneous(knots(p), knots(q), points.collect()).unwrap()
    }

    #[test]
    fn lanes_make_the_nets_of_knot_insertion() {
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
                    let bits = |numbers: &[f64]| -> Vec<u64> {
                        numbers.iter().map(|number| number.to_bits()).collect()
                    };
                    let check = |net: PieceNet<'_>| {
                        for (i, row) in scalar.chunks_exact(q + 1).enumerate() {
                            for (j, point) in row.iter().enumerate() {
                                let numbers = &net.row(i)[size * j..size * (j + 1)];
                                let truth = &point.to_array()[..size];
                                assert_eq!(bits(numbers), bits(truth), "{degree:?}, piece {k}");
                            }
                        }
                    };
                    check(spline.make(&mut NetRoom::new()));
                    for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                        let mut room = NetRoom::new();
                        dispatch!(level, simd => check(make(simd, &spline, &mut room)));
                    }
                }
            }
        }
    }
}
