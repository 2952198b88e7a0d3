//! Rectangles of faces, cut repeatedly until a Bézier patch is the surface or near it.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::creased::CreasedQuad;
use super::error::LimitError;
use super::limit_surface::{FaceRect, LimitPatch, Patches};
use super::net::{Net, corner_turn, part};
use crate::geometry::{Direction, RectSide};
use crate::math::Aabb;

/// How well a rectangle is known.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// The patch is the surface.
    Exact,
    /// The parts, from this node on, are more accurate; the patch, if any, may be near enough.
    Open { first_part: u32, cut: Cut, has_patch: bool },
    /// The surface lies in this box, and the patch lies near it.
    End { hull: Aabb },
}

/// How a rectangle is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// Into four; quarter k is the one at corner k: (0, 0), (1, 0), (1, 1), (0, 1).
    Quarters,
    /// Into two halves along a direction, the lower half first.
    Halves(Direction),
}

impl Cut {
    /// The parts, in the order of places.
    fn parts(self) -> &'static [usize] {
        match self {
            Self::Quarters => &[0, 1, 3, 2],
            Self::Halves(_) => &[0, 1],
        }
    }

    /// Along each direction, whether a part is the upper half; `None` where it is the whole.
    fn halves(self, part: usize) -> [Option<bool>; 2] {
        match self {
            Self::Quarters => [Some(part == 1 || part == 2), Some(part >= 2)],
            Self::Halves(direction) => direction.pair(Some(part == 1), None),
        }
    }
}

/// The angle, in radians, that is always allowed between the normals of a patch and of the surface.
/// The distance alone says little of normals: a patch may be a few times as large as it may be off.
const MOST_TURN: f64 = 5e-3;

/// The default tolerance, as a share of the cage's size. It and all finer ones allow that angle.
/// Coarser ones are there to save memory: from six times the default on, they allow any.
pub(super) const DEFAULT_TOLERANCE: f64 = 1e-4;

/// Parts with a side that is no longer than this many tolerances are not seen: at the default
/// tolerance, a fortieth of a pixel where the cage spans a thousand. (Below, there are always
/// differences where a surface has no tangent plane.)
const SEEN: f64 = 0.25;

/// The rectangles of some faces: each root covers a face, each other is a part of its parent.
#[derive(Clone, Debug)]
pub(super) struct Tree<'a> {
    degree: usize,
    nodes: Vec<(Kind, Net)>,
    /// What is not a part of another.
    roots: Vec<Place>,
    /// The largest allowed distance of a patch from the surface.
    limit: f64,
    /// The largest allowed angle between their normals.
    most_turn: f64,
    tolerance: f64,
    /// The rectangles of all trees of a surface.
    count: &'a AtomicUsize,
}

/// A rectangle with its sides.
#[derive(Clone, Copy, Debug)]
struct Place {
    rect: FaceRect,
    /// Which sides are borders of the surface.
    border: [bool; 4],
    node: u32,
}

/// The most rectangles, 2²², of all trees of a surface: at fine tolerances a third of them or more
/// become patches, which take 2 kB each once they are ready to trace.
const MAX_RECTS: usize = 1 << 22;

/// The halving steps after which corners are no longer exact in f64.
pub(super) const MAX_LEVELS: u32 = 52;

impl<'a> Tree<'a> {
    /// A tree of nothing for a cage of this size, its largest side. Patches may be at most a share
    /// of the tolerance from the surface. Its rectangles are added to `count`, which they share
    /// with other trees of the surface.
    pub(super) fn new(
        degree: usize,
        (tolerance, share): (f64, f64),
        size: f64,
        count: &'a AtomicUsize,
    ) -> Self {
        let limit = share * tolerance;
        let coarseness = (tolerance / (DEFAULT_TOLERANCE * size)).max(1.0);
        // Not a power, whose last bits would be up to the processor's library.
        let most_turn = MOST_TURN * (coarseness * coarseness * coarseness);
        Self { degree, nodes: Vec::new(), roots: Vec::new(), limit, most_turn, tolerance, count }
    }

    /// Adds a square that is not part of another.
    pub(super) fn add_root(
        &mut self,
        rect: FaceRect,
        border: [bool; 4],
    ) -> Result<u32, LimitError> {
        let node = self.add(1)?;
        self.roots.push(Place { rect, border, node });
        Ok(node)
    }

    /// Adds rectangles that have no patch yet.
    fn add(&mut self, count: usize) -> Result<u32, LimitError> {
        let first = self.nodes.len();
        if self.count.fetch_add(count, Ordering::Relaxed) + count > MAX_RECTS {
            let (limit, tolerance) = (MAX_RECTS, self.tolerance);
            return Err(LimitError::TooManyPatches { limit, tolerance });
        }
        let unknown = (Kind::End { hull: Aabb::EMPTY }, [DVec3::ZERO; 16]);
        self.nodes.resize(first + count, unknown);
        Ok(first as u32)
    }

    /// Sets the patch of a rectangle that is the surface.
    pub(super) fn set_exact(&mut self, node: u32, net: Net) {
        self.nodes[node as usize] = (Kind::Exact, net);
    }

    /// Ends at a square if it is small enough, and returns whether it does. The surface over it
    /// lies in `hull`, by the convex hull property of the scheme.
    pub(super) fn end(&mut self, node: u32, net: Net, hull: Aabb) -> bool {
        let ends = self.farthest_from(&net, &hull) <= self.limit;
        if ends {
            self.nodes[node as usize] = (Kind::End { hull }, net);
        }
        ends
    }

    /// Cuts a rectangle and, optionally, gives it a patch that may stand for all parts; returns the
    /// first part.
    pub(super) fn open(
        &mut self,
        node: u32,
        net: Option<Net>,
        cut: Cut,
    ) -> Result<u32, LimitError> {
        let first_part = self.add(cut.parts().len())?;
        let has_patch = net.is_some();
        let kind = Kind::Open { first_part, cut, has_patch };
        self.nodes[node as usize] = (kind, net.unwrap_or([DVec3::ZERO; 16]));
        Ok(first_part)
    }

    /// Gives a square beside a semi-sharp crease its strips.
    pub(super) fn set_strips(&mut self, node: u32, quad: &CreasedQuad) -> Result<(), LimitError> {
        let Some(halves) = quad.halves() else {
            self.set_exact(node, quad.patch());
            return Ok(());
        };
        let first = self.open(node, Some(quad.patch()), Cut::Halves(quad.across()))?;
        for (half, node) in halves.iter().zip(first..) {
            self.set_strips(node, half)?;
        }
        Ok(())
    }

    /// Upper bound on the distance between a point of the patch and one in the box.
    fn farthest_from(&self, net: &Net, hull: &Aabb) -> f64 {
        let used = (self.degree + 1) * (self.degree + 1);
        let far = |p: &DVec3| (*p - hull.min).abs().max((*p - hull.max).abs()).length();
        net[..used].iter().map(far).fold(0.0, f64::max)
    }

    /// Upper bound on the distance of a patch over a rectangle from the surface at the same
    /// parameters; `None` if it exceeds the limit, or if normals differ too much.
    ///
    /// A difference of Bézier patches is no larger than the largest difference of their control
    /// points, so the bound is proved except for rounding by some ulps. Normals are only compared,
    /// at the corners of all parts that are known exactly and large enough to be seen.
    fn deviation(&self, net: &Net, node: u32) -> Option<f64> {
        let (kind, own) = &self.nodes[node as usize];
        let found = match *kind {
            Kind::Exact => {
                let used = (self.degree + 1) * (self.degree + 1);
                let sides = [self.degree, used - 1 - self.degree].map(|k| own[0].distance(own[k]));
                let seen = sides.iter().all(|&side| side > SEEN * self.tolerance);
                if seen && corner_turn(net, own, self.degree + 1) > self.most_turn {
                    return None;
                }
                let pairs = net[..used].iter().zip(own);
                pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
            }
            Kind::End { hull } => self.farthest_from(net, &hull),
            Kind::Open { first_part, cut, .. } => {
                let mut worst = 0.0_f64;
                for &k in cut.parts() {
                    let part = part(net, self.degree + 1, cut.halves(k));
                    worst = worst.max(self.deviation(&part, first_part + k as u32)?);
                }
                worst
            }
        };
        (found <= self.limit).then_some(found)
    }

    /// The patches: the fewest rectangles that are within the limits. They are sorted by place.
    pub(super) fn patches(&self) -> Patches {
        let mut roots = self.roots.clone();
        roots.sort_by_key(|root| root.rect.order()); // faces of n ≠ 4 corners came later
        let mut patches = Patches::default();
        for root in &roots {
            self.collect(root, &mut patches);
        }
        patches
    }

    fn collect(&self, place: &Place, patches: &mut Patches) {
        let Place { rect, border, node } = *place;
        let (kind, net) = &self.nodes[node as usize];
        let deviation = match *kind {
            Kind::Exact => Some(0.0),
            Kind::End { hull } => Some(self.farthest_from(net, &hull)),
            Kind::Open { has_patch, .. } => has_patch.then(|| self.deviation(net, node)).flatten(),
        };
        let used = (self.degree + 1) * (self.degree + 1);
        if let Some(deviation) = deviation {
            let exact = matches!(kind, Kind::Exact);
            patches.patches.push(LimitPatch { rect, border, deviation, exact });
            patches.control.extend_from_slice(&net[..used]);
        } else if let Kind::Open { first_part, cut, .. } = *kind {
            for &part in cut.parts() {
                let (mut rect, mut border) = (rect, border);
                for direction in Direction::BOTH {
                    let Some(upper) = cut.halves(part)[direction] else { continue };
                    rect = rect.half(direction, upper);
                    let [first, last] = RectSide::ends_of(direction);
                    border[if upper { first } else { last }] = false; // a cut
                }
                self.collect(&Place { rect, border, node: first_part + part as u32 }, patches);
            }
        }
    }
}
