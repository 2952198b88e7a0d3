//! Surfaces ready to be traced.

use std::fmt;

use glam::DVec3;
use rayon::prelude::*;

use super::tree::nodes::Tree;
use super::tree::regions::tree_over;
use super::wide::{BLUR, BOX_SPARE, BvhView, NEAR};
use crate::geometry::Charts;
use crate::math::{Aabb, rounding};
use crate::patch::{
    BuildError, Leaf, OrientedBox, PADDING, PatchSet, ScaledFrame, TrimWindows, WeightFit,
};

/// Surfaces split into Bézier pieces and leaves, bounded in a hierarchy.
#[derive(Clone)]
pub struct SurfaceBvh {
    pub(super) set: PatchSet,
    /// In the order of the tree.
    pub(super) leaves: Vec<Leaf>,
    /// In the same order, if some leaves are approximated by quotients; else empty.
    pub(super) weights: Vec<WeightFit>,
    pub(super) windows: TrimWindows,
    pub(super) tree: Tree,
    /// See [`leaf_width`].
    pub(super) leaf_width: f64,
    /// See [`ReachOfF32::of_tree`].
    pub(super) reach_of_f32: f64,
    /// Bounds of all that a ray from within that reach may be said to meet: single rays, and those
    /// of streams, that pass beside this box are misses.
    pub(super) surroundings: Aabb,
}

/// Counts only: the contents of a single sphere would be megabytes of text.
impl fmt::Debug for SurfaceBvh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SurfaceBvh")
            .field("surfaces", &self.surface_count())
            .field("pieces", &self.set.pieces().len())
            .field("leaves", &self.leaves.len())
            .field("bytes", &self.bytes())
            .finish_non_exhaustive()
    }
}

impl SurfaceBvh {
    /// Prepares surfaces for tracing; hits name them by their index in the slice.
    ///
    /// The work is done by the threads of the rayon pool in which it is called; the result does not
    /// depend on them.
    ///
    /// # Errors
    /// If there are more surfaces, pieces, Bézier points or leaves than 32-bit indices can count,
    /// or than memory is likely to hold.
    pub fn build<S: Charts + Sync>(surfaces: &[S]) -> Result<Self, BuildError> {
        let (set, grouped) = PatchSet::new(surfaces)?;
        let parts = grouped.all();
        let frame = ScaledFrame::around(&set.bounds());
        let reach = ReachOfF32::of(&set);
        let (mut tree, order) = tree_over(parts, grouped.groups(), frame, reach.most_scale());
        let made = order.par_iter().enumerate().map(|(leaf, &k)| {
            let part = &parts[k as usize];
            let frame = tree.frame_of(leaf as u32);
            Leaf::new(part, &set.pieces()[part.piece as usize], frame)
        });
        let (leaves, boxes): (Vec<Leaf>, Vec<OrientedBox>);
        let mut weights = Vec::new();
        if set.pieces().iter().any(|piece| piece.patch.has_quotient_leaves()) {
            let made = made.map(|(leaf, weight, oriented)| ((leaf, oriented), weight));
            ((leaves, boxes), weights) = made.unzip();
        } else {
            (leaves, boxes) = made.map(|(leaf, _, oriented)| (leaf, oriented)).unzip();
        }
        tree.fill(&boxes);
        let windows = TrimWindows::new(&leaves, set.pieces());
        let (leaf_width, reach_of_f32) = (leaf_width(&leaves), reach.of_tree(&tree));
        // Twice the error bound of a point: the second time for rounding of distances up to there.
        let surroundings = set.bounds().grown(2.0 * reach.factor * reach_of_f32);
        Ok(Self { set, leaves, weights, windows, tree, leaf_width, reach_of_f32, surroundings })
    }

    /// The pieces.
    pub fn patches(&self) -> &PatchSet {
        &self.set
    }

    /// The leaves; neighbours in space are mostly side by side.
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// The number of surfaces.
    pub fn surface_count(&self) -> usize {
        self.set.surface_count()
    }

    /// The number of leaves of a surface; 0 if there is no such surface.
    pub fn leaf_count(&self, surface: usize) -> usize {
        let pieces = self.set.pieces_of(surface);
        let leaves = self.leaves.iter();
        leaves.filter(|leaf| pieces.contains(&(leaf.piece as usize))).count()
    }

    /// The memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let leaves = size_of_val(&self.leaves[..]) + size_of_val(&self.weights[..]);
        self.set.bytes() + leaves + self.windows.bytes() + self.tree.bytes()
    }

    /// The smallest and largest coordinates of a box that holds all surfaces, except for rounding;
    /// `None` without surfaces.
    ///
    /// The box is not the smallest: it holds the control points of all parts into which the
    /// surfaces are cut.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let bounds = self.set.bounds();
        (!bounds.is_empty()).then_some((bounds.min, bounds.max))
    }

    /// What the fast kernels search.
    pub(super) fn view(&self) -> BvhView<'_> {
        let Self { tree, leaves, weights, windows, set, reach_of_f32, surroundings, .. } = self;
        BvhView { tree, leaves, weights, windows, set, reach_of_f32: *reach_of_f32, surroundings }
    }
}

/// How far a point may be from a ray, in scaled coordinates, while boxes in f32 still meet the ray:
/// a quarter of the blur of rays at the boxes of nodes, and a part of the growth of oriented boxes.
const BLUR_OF_F32: f64 = 0.25 * BLUR as f64;

/// With that, and with four roundings of coordinates and distances (see [`BLUR`]), a ray is off by
/// no more than its blur and the growth of boxes cover.
const _: () = {
    let rounded = 4.0 * (5.0 + 8.0) * 0.5 * f32::EPSILON as f64;
    assert!(rounded + BLUR_OF_F32 <= BLUR as f64 + PADDING);
};

/// Nor is it farther off than oriented boxes were grown by.
///
/// A point of a leaf is inside the pair of planes of each row `r` of its box: `|r · p − d| ≤ 1` less
/// `|r|` times the growth. So the test in f32 finds the point of the ray that is nearest to it
/// inside, if it is wrong about `r · o − d` plus `z` times `r · a` by no more than `|r|` times what
/// is left of the growth. The scene lies within √3 of the middle, and so does the plane halfway
/// between the two, as some of the leaf's control points lie on either side of it: `|d| ≤ √3 |r|`,
/// and half of their distance is no more than √3. The origin `o` lies within [`NEAR`]: if it is
/// moved, to within √7, as the ray passes within √3 of the middle. The roundings, as multiples of
/// `|r| u`, all of one sign and without fused operations:
const _: () = {
    let (origin, scene) = (NEAR, 1.75);
    let (distance, z) = (origin + scene, origin + scene);
    // Of r, of o, of d, of the three products, and of their sums.
    let at = origin + origin + scene + origin + 3.0 * distance;
    // Of r, of a, of the products, and of their two sums.
    let along = z * (1.0 + 1.0 + 1.0 + 2.0);
    // Of 1 / (r · a), for (r · o − d) / (r · a) and for the half width, and of the former product.
    let quotient = distance + scene + distance;
    let rounded = (at + along + quotient) * 0.5 * f32::EPSILON as f64;
    assert!(rounded + BLUR_OF_F32 <= OrientedBox::GROWTH);
    // Places where rays enter and leave are compared with some slack of their own.
    assert!(2.0 * z * 0.5 * f32::EPSILON as f64 <= BOX_SPARE as f64);
};

/// How far away ray origins may be for the work in f32.
///
/// A point may be as far from a ray as the promised bound of its residual. That bound grows with
/// the origin's coordinates, but the growth of boxes in f32 does not. The rounding error of the
/// surfaces themselves is part of their boxes.
struct ReachOfF32 {
    /// How far a point may be from a ray, per unit of the largest coordinate.
    factor: f64,
    /// The largest coordinate of the surfaces.
    magnitude: f64,
}

impl ReachOfF32 {
    fn of(set: &PatchSet) -> Self {
        let patches = set.pieces().iter().map(|piece| &piece.patch);
        let (factor, magnitude) = patches.fold((0f64, 0f64), |(factor, magnitude), patch| {
            (factor.max(patch.residual_factor()), magnitude.max(patch.magnitude()))
        });
        Self { factor, magnitude }
    }

    /// The largest factor by which coordinates may be scaled up. A larger one resolves smaller
    /// things, but rays must begin nearer: with this one they may begin up to `TIMES` times as far
    /// away as anything in the scene. On bicubic surfaces, things of about 5e-6 of the scene's
    /// largest coordinate still fill the coordinates.
    fn most_scale(&self) -> f64 {
        const TIMES: f64 = 1024.0;
        rounding::power_of_two_below(BLUR_OF_F32 / (self.factor * TIMES * self.magnitude))
    }

    /// The largest coordinate an origin may have: at least that of the surfaces, whose boxes cover
    /// the error of points for a ray that starts among them.
    fn of_tree(&self, tree: &Tree) -> f64 {
        let scale = tree.regions.iter().map(|region| region.frame.scale).fold(0.0, f64::max);
        (BLUR_OF_F32 / (self.factor * scale)).max(self.magnitude)
    }
}

/// The width of the leaves that rays meet, in scene units: a harmonic mean, weighted by area.
fn leaf_width(leaves: &[Leaf]) -> f64 {
    let (mut areas, mut widths) = (0.0, 0.0);
    for leaf in leaves {
        let [x, y] = leaf.half_side_lengths().map(f64::from);
        let area = 4.0 * x * y;
        areas += area;
        widths += area.sqrt();
    }
    if areas > 0.0 { areas / widths } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface, shapes};

    /// A bicubic sheet of hills, `spans` × `spans` pieces.
    fn hills(spans: usize) -> NurbsSurface {
        let points = spans + 3;
        let knots = KnotVector::clamped_uniform(3, points).unwrap();
        let point = |k: usize| {
            let [x, y] = [k / points, k % points].map(|i| 10.0 * i as f64 / points as f64);
            DVec4::new(x, y, 0.5 * (1.3 * x).sin() * (1.1 * y).cos(), 1.0)
        };
        let net: Vec<DVec4> = (0..points * points).map(point).collect();
        NurbsSurface::from_homogeneous(knots.clone(), knots, net).unwrap()
    }

    fn built(surface: NurbsSurface) -> SurfaceBvh {
        SurfaceBvh::build(&[surface]).unwrap()
    }

    #[test]
    fn debug_shows_counts() {
        let bvh = built(shapes::plane(1.0, 1.0).unwrap());
        let (leaves, bytes) = (bvh.leaves().len(), bvh.bytes());
        let counts = format!("surfaces: 1, pieces: 1, leaves: {leaves}, bytes: {bytes}");
        assert_eq!(format!("{bvh:?}"), format!("SurfaceBvh {{ {counts}, .. }}"));
        assert!(format!("{:?}", bvh.tracer()).starts_with("Tracer { kernel: "));
        assert!(format!("{:?}", bvh.tracer()).len() < 500);
        assert!(format!("{:?}", bvh.patches()).len() < 100);
    }

    #[test]
    fn bounds_hold_the_surface_closely() {
        let bvh = built(shapes::sphere(1.0).unwrap());
        let (low, high) = bvh.bounds().unwrap();
        for end in [-low, high] {
            assert!(end.min_element() > 1.0 - 1e-14 && end.max_element() < 1.01, "{end}");
        }
    }

    #[test]
    fn memory_stays_small() {
        // Dense splines: one leaf and one control point per span are all there is.
        for (spans, most) in [(64, 410.0), (200, 380.0)] {
            let bvh = built(hills(spans));
            let bytes = bvh.bytes() as f64 / (spans * spans) as f64;
            assert!(bytes < most, "{bytes} bytes a span of {spans}²");
        }
        // Curved surfaces: a leaf with its weight and its share of the tree, and no more leaves
        // than pay off.
        for surface in [shapes::sphere(1.0).unwrap(), shapes::torus(1.0, 0.4).unwrap()] {
            let bvh = built(surface);
            let (bytes, leaves) = (bvh.bytes(), bvh.leaves().len());
            let each = bytes as f64 / leaves as f64;
            assert!(bytes < 1_000_000 && each < 414.0, "{bytes} bytes, {each} a leaf");
        }
    }
}
