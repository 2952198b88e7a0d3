//! Surfaces ready to be traced.

use std::fmt;

use glam::DVec3;
use rayon::prelude::*;

use super::f32_reach::ReachOfF32;
use super::tree::nodes::Tree;
use super::tree::regions::tree_over;
use super::wide::BvhView;
use crate::geometry::Charts;
use crate::math::Aabb;
use crate::patch::{BuildError, Leaf, OrientedBox, PatchSet, ScaledFrame, TrimWindows, WeightFit};

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
