//! The limit surface of a cage as Bézier patches.

use glam::{DAffine3, DVec3};

use super::CageError;
use crate::geometry::arrange::{check_invertible, stretch};
use crate::geometry::construct::ControlNet;
use crate::geometry::surface::{Extent, extent};
use crate::geometry::{KnotVector, MAX_MAGNITUDE, NurbsSurface, SurfaceError};

/// The limit surface of a cage as polynomial Bézier patches, bicubic for Catmull–Clark, biquadratic
/// for Doo–Sabin. Most patches are exact; those near extraordinary points are within a bound that
/// is proved for each (see [`LimitPatch::deviation`]).
///
/// There are no gaps: patches of one size share the control points of their common border bit for
/// bit; where sizes differ, borders agree up to rounding. (To achieve this, borders of patches that
/// are not exact are moved, within the tolerance.)
///
/// As a whole it is a surface over `(u, v)`: unit square k of the cage's faces, counted as
/// [`FaceSquare`] says, is `k ≤ u < k + 1`, `0 ≤ v ≤ 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitSurface {
    pub(super) degree: usize,
    tolerance: f64,
    pub(super) unit_count: usize,
    /// Sorted by place: see [`FaceSquare::order`].
    pub(super) patches: Vec<LimitPatch>,
    pub(super) control: Vec<DVec3>,
    /// The cage.
    net: ControlNet,
}

/// The part of the surface that a patch covers, and its accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPatch {
    /// The part of the cage.
    pub square: FaceSquare,
    /// Which sides are borders of the surface: first u, last u, first v, last v.
    pub border: [bool; 4],
    /// Upper bound on the distance between the patch and the limit surface at the same (u, v), in
    /// scene units (except for rounding by some ulps of the coordinates); 0 if the patch is exact.
    pub deviation: f64,
    /// Whether the patch is the limit surface, up to rounding.
    pub exact: bool,
}

/// A part of a face of a cage: a square of its unit square.
///
/// A quad has one unit square, with corner 0 at (0, 0), corner 1 at (1, 0), corner 2 at (1, 1). A
/// face of n ≠ 4 corners has n unit squares, one for each corner: the corner at (0, 0), the face's
/// middle at (1, 1), the edge that leaves the corner along u. They are counted face after face, as
/// in Ptex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceSquare {
    /// The face of the cage.
    pub face: usize,
    /// The unit square, counted through all faces.
    pub unit: usize,
    /// The smallest u and v.
    pub low: [f64; 2],
    /// The side length: a power of ½, so that low and low + side are exact.
    pub side: f64,
}

impl FaceSquare {
    /// The whole unit square with index `unit`.
    pub(super) fn whole(face: usize, unit: usize) -> Self {
        Self { face, unit, low: [0.0; 2], side: 1.0 }
    }

    /// The quarter at corner k.
    pub(super) fn quarter(&self, k: usize) -> Self {
        let side = 0.5 * self.side;
        let (u, v) = (f64::from(u8::from(k == 1 || k == 2)), f64::from(u8::from(k >= 2)));
        Self { low: [self.low[0] + u * side, self.low[1] + v * side], side, ..*self }
    }

    /// Sort key for squares that do not overlap: the square that contains a place is the last one
    /// not after that place. Sorts by unit square, then by the interleaved bits of v and u (Morton
    /// order).
    pub(super) fn order(&self) -> (usize, u128) {
        (self.unit, place_order(self.low))
    }

    /// Whether the square ends where its unit square does, in u and in v.
    pub(super) fn ends_unit(&self) -> [bool; 2] {
        self.low.map(|low| low + self.side == 1.0)
    }

    /// The place in the unit square that corresponds to a patch's (u, v) in [0, 1]².
    pub fn unit_uv(&self, u: f64, v: f64) -> [f64; 2] {
        [self.low[0] + self.side * u, self.low[1] + self.side * v]
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

    pub(super) fn push(&mut self, patch: LimitPatch, net: &[DVec3]) {
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
        let knots = knots.map_err(|error| SurfaceError::Knots {
            direction: crate::geometry::Direction::U,
            error,
        });
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
                let ([u, v], [u0, u1, v0, v1]) = (patch.square.low, patch.border);
                let square = FaceSquare { low: [v, u], ..patch.square };
                LimitPatch { square, border: [v0, v1, u0, u1], ..*patch }
            })
            .zip(self.control.chunks(count))
            .collect();
        turned.sort_by_key(|(patch, _)| patch.square.order());
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
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, SurfaceError> {
        check_invertible(map)?;
        let moved = |points: &[DVec3]| -> Vec<DVec3> {
            points.iter().map(|&point| map.transform_point3(point)).collect()
        };
        let net = ControlNet { points: moved(&self.net.points), lines: self.net.lines.clone() };
        let control = moved(&self.control);
        let usable = |p: &DVec3| p.abs().cmple(DVec3::splat(MAX_MAGNITUDE)).all(); // NaN is not
        if let Some(vertex) = net.points.iter().position(|point| !usable(point)) {
            let position = net.points[vertex];
            return Err(SurfaceError::Cage(CageError::Position { vertex, position }));
        }
        if let Some(k) = control.iter().position(|point| !usable(point)) {
            let (place, n) = (k % ((self.degree + 1) * (self.degree + 1)), self.degree + 1);
            return Err(SurfaceError::Point { i: place / n, j: place % n, point: control[k] });
        }
        let stretch = stretch(map);
        let mut patches = self.patches.clone();
        patches.iter_mut().for_each(|patch| patch.deviation *= stretch);
        let tolerance = self.tolerance * stretch;
        let moved = Self { tolerance, patches, control, net, ..*self };
        moved.extent().checked()?;
        Ok(moved)
    }

    /// The number of patches that are the limit surface up to rounding.
    pub fn exact_count(&self) -> usize {
        self.patches.iter().filter(|patch| patch.exact).count()
    }
}
