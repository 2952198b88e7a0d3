//! The limit surface of a cage as Bézier patches.

use glam::{DAffine3, DVec2, DVec3};

use super::{CageError, LimitError};
use crate::geometry::affine::stretch;
use crate::geometry::construct::ControlNet;
use crate::geometry::magnitude::{Extent, extent, is_usable};
use crate::geometry::surface::check_invertible;
use crate::geometry::{Direction, KnotVector, NurbsSurface, SurfaceError};

/// The limit surface of a cage as polynomial Bézier patches, bicubic for Catmull–Clark, biquadratic
/// for Doo–Sabin. Most patches are exact; those near extraordinary points, and where creases meet,
/// turn or end, are within a bound that is proved for each (see [`LimitPatch::deviation`]).
///
/// There are no gaps: patches of one size share the control points of their common border bit for
/// bit; where sizes differ, borders agree up to rounding. (To achieve this, borders of patches that
/// are not exact are moved, within the tolerance.)
///
/// As a whole it is a surface over `(u, v)`: unit square k of the cage's faces, counted as
/// [`FaceRect`] says, is `k ≤ u < k + 1`, `0 ≤ v ≤ 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitSurface {
    pub(super) degree: usize,
    tolerance: f64,
    pub(super) unit_count: usize,
    /// Sorted by place: see [`FaceRect::order`].
    pub(super) patches: Vec<LimitPatch>,
    pub(super) control: Vec<DVec3>,
    /// The cage.
    net: ControlNet,
}

/// The part of the surface that a patch covers, and its accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPatch {
    /// The part of the cage.
    pub rect: FaceRect,
    /// Which sides are borders of the surface, in the order of
    /// [`RectSide::ALL`](crate::geometry::RectSide::ALL).
    pub border: [bool; 4],
    /// Upper bound on the distance between the patch and the limit surface at the same (u, v), in
    /// scene units (except for rounding by some ulps of the coordinates); 0 if the patch is exact.
    pub deviation: f64,
    /// Whether the patch is the limit surface, up to rounding.
    pub exact: bool,
}

/// The patches of some faces with their control points, sorted by place.
#[derive(Clone, Debug, Default)]
pub(super) struct Patches {
    pub(super) patches: Vec<LimitPatch>,
    pub(super) control: Vec<DVec3>,
}

/// A part of a face of a cage: a rectangle in its unit square. Most are squares; beside straight
/// semi-sharp creases there are strips, squares that were halved only across the crease.
///
/// A quad has one unit square, with corner 0 at (0, 0), corner 1 at (1, 0), corner 2 at (1, 1). A
/// face of n ≠ 4 corners has n unit squares, one for each corner: the corner at (0, 0), the face's
/// middle at (1, 1), the edge that leaves the corner along u. They are counted face after face, as
/// in Ptex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceRect {
    /// The face of the cage.
    pub face: usize,
    /// The unit square, counted through all faces.
    pub unit: usize,
    /// The smallest u and v.
    pub low: [f64; 2],
    /// The lengths of the sides: powers of ½, so that low and low + size are exact.
    pub size: [f64; 2],
}

impl FaceRect {
    /// The whole unit square with index `unit`.
    pub(super) fn whole(face: usize, unit: usize) -> Self {
        Self { face, unit, low: [0.0; 2], size: [1.0; 2] }
    }

    /// The quarter at corner k.
    pub(super) fn quarter(&self, k: usize) -> Self {
        self.half(Direction::U, k == 1 || k == 2).half(Direction::V, k >= 2)
    }

    /// The lower or the upper half along a direction.
    pub(super) fn half(mut self, direction: Direction, upper: bool) -> Self {
        self.size[direction] *= 0.5;
        self.low[direction] += if upper { self.size[direction] } else { 0.0 };
        self
    }

    /// The square that the rectangle was halved from: itself, or that of a strip.
    pub(super) fn square(mut self) -> Self {
        let side = self.size[0].max(self.size[1]);
        self.low = self.low.map(|low| (low / side).floor() * side);
        self.size = [side; 2];
        self
    }

    /// Sort key for rectangles that do not overlap. Sorts by unit square, then by the interleaved
    /// bits of v and u (Morton order) where the rectangle's [`square`](Self::square) begins, then
    /// by place within that.
    pub(super) fn order(&self) -> (usize, u128, [u64; 2]) {
        let (unit, place) = self.square_order();
        (unit, place, self.low.map(f64::to_bits))
    }

    /// The part of [`order`](Self::order) that strips of one square have in common. Of squares, the
    /// one that contains a place is the last one not after that place.
    pub(super) fn square_order(&self) -> (usize, u128) {
        (self.unit, place_order(self.square().low))
    }

    /// Whether the rectangle ends where its unit square does, in u and in v.
    pub(super) fn ends_unit(&self) -> [bool; 2] {
        self.ranges().map(|[_, high]| high == 1.0)
    }

    /// From and to in u, then in v.
    pub fn ranges(&self) -> [[f64; 2]; 2] {
        Direction::BOTH.map(|k| [self.low[k], self.low[k] + self.size[k]])
    }

    /// The place in the unit square that corresponds to a patch's (u, v) in [0, 1]².
    pub fn unit_uv(&self, uv: DVec2) -> DVec2 {
        DVec2::from(self.low) + DVec2::from(self.size) * uv
    }
}

/// The interleaved bits of two numbers from 0 to 1, the second one's first.
pub(super) fn place_order(at: [f64; 2]) -> u128 {
    // As many bits as the corners of squares have.
    let most = f64::powi(2.0, 52);
    let [u, v] = at.map(|x| spread((x * most).clamp(0.0, most - 1.0) as u64));
    u | v << 1
}

/// A number with a zero before each of its bits.
fn spread(x: u64) -> u128 {
    const STEPS: [(u32, u128); 6] = [
        (32, 0x0000_0000_ffff_ffff_0000_0000_ffff_ffff),
        (16, 0x0000_ffff_0000_ffff_0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff_00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f_0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333_3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555_5555_5555_5555_5555),
    ];
    STEPS.iter().fold(u128::from(x), |x, (shift, mask)| (x | x << shift) & mask)
}

impl LimitSurface {
    pub(super) fn empty(degree: usize, tolerance: f64, unit_count: usize, net: ControlNet) -> Self {
        let (patches, control) = (Vec::new(), Vec::new());
        Self { degree, tolerance, unit_count, patches, control, net }
    }

    /// The surface of all these patches, no two of which have parts of one unit square.
    pub(super) fn gathered(
        (degree, tolerance): (usize, f64),
        unit_count: usize,
        net: ControlNet,
        parts: &[Patches],
    ) -> Self {
        let count = (degree + 1) * (degree + 1);
        let mut surface = Self::empty(degree, tolerance, unit_count, net);
        let total = parts.iter().map(|part| part.patches.len()).sum();
        surface.patches.reserve_exact(total);
        surface.control.reserve_exact(total * count);
        // The patches of each unit square lie together in one part.
        let units = |(part, patches): (usize, &Patches)| {
            let mut starts = vec![0];
            let unit = |k: usize| patches.patches[k].rect.unit;
            starts.extend((1..patches.patches.len()).filter(|&k| unit(k - 1) != unit(k)));
            let ends = starts[1..].iter().copied().chain([patches.patches.len()]);
            let ranges = starts.iter().zip(ends).filter(|(start, end)| *start < end);
            ranges.map(|(&start, end)| (unit(start), part, start..end)).collect::<Vec<_>>()
        };
        let mut units: Vec<_> = parts.iter().enumerate().flat_map(units).collect();
        units.sort_unstable_by_key(|(unit, ..)| *unit);
        for (_, part, range) in units {
            let Patches { patches, control } = &parts[part];
            surface.patches.extend_from_slice(&patches[range.clone()]);
            surface.control.extend_from_slice(&control[range.start * count..range.end * count]);
        }
        surface
    }

    fn push(&mut self, patch: LimitPatch, net: &[DVec3]) {
        self.patches.push(patch);
        self.control.extend_from_slice(net);
    }

    /// The extent of the control points.
    pub(super) fn extent(&self) -> Extent {
        extent(|| self.control.iter().copied(), [self.degree; 2])
    }

    /// The degree in u and in v: 3 or 2.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The patches, grouped by face, with the faces in the order of the cage.
    pub fn patches(&self) -> &[LimitPatch] {
        &self.patches
    }

    /// The `(degree + 1)²` control points of a patch, v fastest; `None` beyond the last.
    pub fn control(&self, patch: usize) -> Option<&[DVec3]> {
        let count = (self.degree + 1) * (self.degree + 1);
        self.control.get(patch.checked_mul(count)?..)?.get(..count)
    }

    /// A patch as a surface with the domain [0, 1]²; `None` beyond the last.
    ///
    /// # Errors
    /// When its control points all coincide.
    pub fn surface(&self, patch: usize) -> Option<Result<NurbsSurface, SurfaceError>> {
        let points = self.control(patch)?.to_vec();
        let knots = KnotVector::bezier(self.degree);
        let knots = knots.map_err(|error| SurfaceError::Knots { direction: Direction::U, error });
        Some(knots.and_then(|knots| NurbsSurface::new(knots.clone(), knots, points, None)))
    }

    /// The requested tolerance, in scene units: no gap between patches is wider.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The largest deviation of a patch; at most half the tolerance.
    pub fn deviation(&self) -> f64 {
        self.patches.iter().map(|patch| patch.deviation).fold(0.0, f64::max)
    }

    /// The number of unit squares. The domain is from 0 to this number in u, from 0 to 1 in v.
    pub fn unit_count(&self) -> usize {
        self.unit_count
    }

    /// The vertices and edges of the cage.
    pub fn cage_net(&self) -> &ControlNet {
        &self.net
    }

    /// The surface with its normals turned: u and v are exchanged within each unit square,
    /// as if the faces of the cage ran the other way round from the same first vertices.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let count = (self.degree + 1) * (self.degree + 1);
        let mut turned: Vec<(LimitPatch, &[DVec3])> = self
            .patches
            .iter()
            .map(|patch| {
                let ([u, v], [u0, u1, v0, v1]) = (patch.rect.low, patch.border);
                let [size_u, size_v] = patch.rect.size;
                let rect = FaceRect { low: [v, u], size: [size_v, size_u], ..patch.rect };
                LimitPatch { rect, border: [v0, v1, u0, u1], ..*patch }
            })
            .zip(self.control.chunks(count))
            .collect();
        turned.sort_by_key(|(patch, _)| patch.rect.order());
        let mut surface =
            Self::empty(self.degree, self.tolerance, self.unit_count, self.net.clone());
        let n = self.degree + 1;
        for (patch, net) in turned {
            let transposed: Vec<DVec3> =
                (0..count).map(|place| net[place % n * n + place / n]).collect();
            surface.push(patch, &transposed);
        }
        surface
    }

    /// The surface moved by an affine map; parameters stay the same. Deviations and the tolerance
    /// are scaled by the largest factor by which the map stretches lengths.
    ///
    /// # Errors
    /// When the map is not finite or flattens space, or moves a vertex of the cage or a patch too
    /// far out, or all of them to one point.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, LimitError> {
        let of_surface = |error| LimitError::Surface(Box::new(error));
        check_invertible(map).map_err(of_surface)?;
        let moved = |points: &[DVec3]| -> Vec<DVec3> {
            points.iter().map(|&point| map.transform_point3(point)).collect()
        };
        let net = ControlNet { points: moved(&self.net.points), lines: self.net.lines.clone() };
        let control = moved(&self.control);
        let usable = |p: &DVec3| is_usable(*p);
        if let Some(vertex) = net.points.iter().position(|point| !usable(point)) {
            let position = net.points[vertex];
            return Err(LimitError::Cage(CageError::Position { vertex, position }));
        }
        if let Some(k) = control.iter().position(|point| !usable(point)) {
            let (place, n) = (k % ((self.degree + 1) * (self.degree + 1)), self.degree + 1);
            let (i, j) = (place / n, place % n);
            return Err(of_surface(SurfaceError::Point { i, j, point: control[k] }));
        }
        let stretch = stretch(map);
        let mut patches = self.patches.clone();
        patches.iter_mut().for_each(|patch| patch.deviation *= stretch);
        let tolerance = self.tolerance * stretch;
        let moved = Self { tolerance, patches, control, net, ..*self };
        moved.extent().checked().map_err(of_surface)?;
        Ok(moved)
    }

    /// The number of patches that are the limit surface up to rounding.
    pub fn exact_count(&self) -> usize {
        self.patches.iter().filter(|patch| patch.exact).count()
    }
}
