//! Squares of faces, halved repeatedly until a Bézier patch is the surface or near it.

use glam::DVec3;

use super::Cage;
use super::cage_error::LimitError;
use super::limit_surface::{FaceSquare, LimitPatch, LimitSurface};
use super::mesh::Mesh;
use super::seams;
use super::topology::Topology;
use crate::math::Aabb;

/// The control points of a patch, v fastest; `(degree + 1)²` of them are in use.
pub(super) type Net = [DVec3; 16];

/// How well a square is known.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// The patch is the surface.
    Exact,
    /// The four squares from this one on are more accurate; the patch may be near enough.
    Open { first_child: u32 },
    /// As `Open`, without a patch.
    Split { first_child: u32 },
    /// The surface lies in this box, and the patch lies near it.
    End { hull: Aabb },
}

/// The squares of all faces: each root covers a face, each other square a quarter of its parent.
///
/// Quarter k of a square is the one at its corner k: (0, 0), (1, 0), (1, 1), (0, 1).
#[derive(Clone, Debug)]
pub(super) struct Tree {
    degree: usize,
    nodes: Vec<(Kind, Net)>,
    roots: Vec<Root>,
    /// The largest allowed distance of a patch from the surface.
    limit: f64,
    tolerance: f64,
}

/// A square that is not a quarter of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    pub(super) square: FaceSquare,
    /// Which sides are borders of the surface.
    pub(super) border: [bool; 4],
    node: u32,
}

/// The most squares, 2²²: they take 2 GB.
const MAX_SQUARES: usize = 1 << 22;

/// The halving steps after which the corners of squares are no longer exact in f64.
pub(super) const MAX_LEVELS: u32 = 52;

impl Tree {
    /// A tree without squares. Patches may be at most a share of the tolerance from the surface.
    pub(super) fn new(
        degree: usize,
        (tolerance, share): (f64, f64),
        cage: &Cage,
    ) -> Result<Self, LimitError> {
        let (magnitude, smallest) = (cage.magnitude(), cage.smallest_tolerance());
        if !(tolerance >= smallest && tolerance > 0.0 && tolerance.is_finite()) {
            return Err(LimitError::Tolerance { tolerance, magnitude, smallest });
        }
        let limit = share * tolerance;
        Ok(Self { degree, nodes: Vec::new(), roots: Vec::new(), limit, tolerance })
    }

    /// Adds a square that is not part of another.
    pub(super) fn add_root(
        &mut self,
        square: FaceSquare,
        border: [bool; 4],
    ) -> Result<u32, LimitError> {
        let node = self.add(1)?;
        self.roots.push(Root { square, border, node });
        Ok(node)
    }

    /// Adds squares that have no patch yet.
    fn add(&mut self, count: usize) -> Result<u32, LimitError> {
        let first = self.nodes.len();
        if first + count > MAX_SQUARES {
            let (limit, tolerance) = (MAX_SQUARES, self.tolerance);
            return Err(LimitError::TooManyPatches { limit, tolerance });
        }
        let unknown = (Kind::End { hull: Aabb::EMPTY }, [DVec3::ZERO; 16]);
        self.nodes.resize(first + count, unknown);
        Ok(first as u32)
    }

    /// Sets the patch of a square that is the surface.
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

    /// Gives a square its four quarters and, optionally, a patch that may stand for all of them.
    pub(super) fn open(&mut self, node: u32, net: Option<Net>) -> Result<u32, LimitError> {
        let first_child = self.add(4)?;
        self.nodes[node as usize] = match net {
            Some(net) => (Kind::Open { first_child }, net),
            None => (Kind::Split { first_child }, [DVec3::ZERO; 16]),
        };
        Ok(first_child)
    }

    /// Upper bound on the distance between a point of the patch and one in the box.
    fn farthest_from(&self, net: &Net, hull: &Aabb) -> f64 {
        let used = (self.degree + 1) * (self.degree + 1);
        let far = |p: &DVec3| (*p - hull.min).abs().max((*p - hull.max).abs()).length();
        net[..used].iter().map(far).fold(0.0, f64::max)
    }

    /// Upper bound on the distance of a patch over a square from the surface at the same
    /// parameters; `None` if it exceeds the limit.
    ///
    /// A difference of Bézier patches is no larger than the largest difference of their control
    /// points, so the bound is proved except for rounding by some ulps.
    fn deviation(&self, net: &Net, node: u32) -> Option<f64> {
        let (kind, own) = &self.nodes[node as usize];
        let found = match *kind {
            Kind::Exact => {
                let used = (self.degree + 1) * (self.degree + 1);
                let pairs = net[..used].iter().zip(own);
                pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
            }
            Kind::End { hull } => self.farthest_from(net, &hull),
            Kind::Open { first_child } | Kind::Split { first_child } => {
                let mut worst = 0.0_f64;
                for k in 0..4 {
                    let quarter = quarter(net, self.degree + 1, k);
                    worst = worst.max(self.deviation(&quarter, first_child + k as u32)?);
                }
                worst
            }
        };
        (found <= self.limit).then_some(found)
    }

    /// The patches: the fewest squares that are within the limit.
    pub(super) fn patches(&self, cage: &Mesh) -> Result<LimitSurface, LimitError> {
        let units = unit_count(&cage.topology);
        let mut surface =
            LimitSurface::empty(self.degree, self.tolerance, units, cage.control_net());
        let mut roots = self.roots.clone();
        roots.sort_by_key(|root| root.square.order()); // faces of n ≠ 4 corners came later
        for root in &roots {
            self.collect(root, &mut surface);
        }
        // u counts unit squares and must still distinguish the places within the smallest squares.
        let smallest = surface.patches.iter().map(|patch| patch.square.side).fold(1.0, f64::min);
        if smallest < units as f64 * SMALLEST_SIDE {
            let levels = -smallest.log2() as u32;
            return Err(LimitError::TooDeep { tolerance: self.tolerance, levels });
        }
        Ok(surface)
    }

    fn collect(&self, root: &Root, surface: &mut LimitSurface) {
        let Root { square, border, node } = *root;
        let (kind, net) = &self.nodes[node as usize];
        let (deviation, children) = match *kind {
            Kind::Exact => (Some(0.0), None),
            Kind::End { hull } => (Some(self.farthest_from(net, &hull)), None),
            Kind::Open { first_child } => (self.deviation(net, node), Some(first_child)),
            Kind::Split { first_child } => (None, Some(first_child)),
        };
        let used = (self.degree + 1) * (self.degree + 1);
        match (deviation, children) {
            (Some(deviation), _) => {
                let exact = matches!(kind, Kind::Exact);
                surface.push(LimitPatch { square, border, deviation, exact }, &net[..used]);
            }
            (None, Some(first)) => {
                // In the order of places.
                for k in [0, 1, 3, 2] {
                    let node = first + k as u32;
                    let square = square.quarter(k);
                    // Quarter k keeps those sides that meet at corner k.
                    let (u, v) = (usize::from(k == 1 || k == 2), usize::from(k >= 2));
                    let mut kept = [false; 4];
                    kept[u] = border[u];
                    kept[2 + v] = border[2 + v];
                    self.collect(&Root { square, border: kept, node }, surface);
                }
            }
            (None, None) => {}
        }
    }
}

/// The smallest side of a square, per unit square: 2⁸ places within it can be told apart.
const SMALLEST_SIDE: f64 = 1.0 / (1_u64 << 44) as f64;

/// The number of unit squares of all faces.
fn unit_count(topology: &Topology) -> usize {
    let sides = (0..topology.face_count()).map(|face| topology.face_range(face).len());
    sides.map(|sides| if sides == 4 { 1 } else { sides }).sum()
}

/// The shares of the tolerance that patches may initially be from the surface. Moving patches to
/// meet their neighbours takes them farther from it, up to half of the tolerance. The first share
/// is nearly always enough; each further one starts again from the beginning.
const SHARES: [f64; 5] = [0.25, 0.1, 0.04, 0.016, 0.0064];

/// A limit surface without gaps, from patches within a share of the tolerance.
pub(super) fn within(
    tolerance: f64,
    cage: &Mesh,
    patches: impl Fn(f64) -> Result<LimitSurface, LimitError>,
) -> Result<LimitSurface, LimitError> {
    for share in SHARES {
        let mut surface = patches(share)?;
        seams::close(&mut surface, cage);
        if surface.deviation() <= 0.5 * tolerance {
            return match surface.extent().checked() {
                Ok(_) => Ok(surface),
                Err(error) => Err(LimitError::Surface(Box::new(error))),
            };
        }
    }
    Err(LimitError::TooDeep { tolerance, levels: MAX_LEVELS })
}

/// The control points of a quarter of a patch with n × n points: de Casteljau at the middle,
/// in u and in v.
fn quarter(net: &Net, n: usize, k: usize) -> Net {
    let mut result = *net;
    let upper = [k == 1 || k == 2, k >= 2];
    for line in 0..n {
        halve(&mut result, n, (line, n), upper[0]);
    }
    for line in 0..n {
        halve(&mut result, n, (line * n, 1), upper[1]);
    }
    result
}

/// Keeps one half of a curve of n points at the indices `start`, `start + stride` and so on.
pub(super) fn halve(net: &mut [DVec3], n: usize, (start, stride): (usize, usize), upper: bool) {
    let at = |index: usize| start + index * stride;
    for round in 1..n {
        if upper {
            for j in 0..n - round {
                net[at(j)] = 0.5 * (net[at(j)] + net[at(j + 1)]);
            }
        } else {
            for j in (round..n).rev() {
                net[at(j)] = 0.5 * (net[at(j - 1)] + net[at(j)]);
            }
        }
    }
}
