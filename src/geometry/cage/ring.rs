//! The quads around a vertex: the limit point of the vertex under refinement, and the normal of the
//! limit surface there.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::mesh::Mesh;
use super::vertex_rule::{Rule, Surroundings, decayed, edge_point};

/// A vertex with the quads around it, counterclockwise. Refinement keeps their number.
#[derive(Clone, Debug)]
pub(super) struct Ring {
    center: DVec3,
    /// The sharpness of the vertex.
    corner: f64,
    /// The ends of its edges: one for each quad and, if the ring is open, one more.
    spokes: Vec<DVec3>,
    /// The sharpness of its edges.
    creases: Vec<f64>,
    /// The far corner of each quad; quad i lies between spokes i and i + 1.
    diagonals: Vec<DVec3>,
}

/// The steps after which a dart's ring has shrunk to nothing: a step leaves at most 0.66 of it (the
/// largest subdominant eigenvalue for any number of edges), and 0.66¹⁰⁰ < 1e-18.
const DART_STEPS: usize = 100;

/// The steps after which all finite sharpness, at most 10, is used up.
const SHARP_STEPS: usize = 10;

impl Ring {
    /// The ring of a vertex; `None` if not all its faces are quads.
    pub(super) fn of(mesh: &Mesh, vertex: u32) -> Option<Self> {
        let topology = &mesh.topology;
        let star = topology.star(vertex);
        if star.corners.iter().any(|&corner| topology.sides(corner) != 4) {
            return None;
        }
        let at = |&vertex: &u32| mesh.positions[vertex as usize];
        let diagonal = |&corner: &u32| mesh.at(topology.next(topology.next(corner)));
        Some(Self {
            center: mesh.positions[vertex as usize],
            corner: mesh.corners[vertex as usize],
            spokes: topology.spoke_ends(&star).iter().map(at).collect(),
            creases: topology.spokes(&star).iter().map(|&c| mesh.crease(c)).collect(),
            diagonals: star.corners.iter().map(diagonal).collect(),
        })
    }

    fn is_closed(&self) -> bool {
        self.spokes.len() == self.diagonals.len()
    }

    fn rule(&self) -> Rule {
        Rule::of(self.corner, self.creases.iter().copied())
    }

    /// Whether exactly one edge is sharp, and not the vertex.
    fn is_dart(&self) -> bool {
        self.corner == 0.0 && self.creases.iter().filter(|&&s| s > 0.0).count() == 1
    }

    /// The ring after one step of refinement.
    pub(super) fn refined(&self) -> Self {
        let n = self.spokes.len();
        let quads = self.diagonals.iter().enumerate();
        let centroids: Vec<DVec3> = quads
            .map(|(i, &far)| {
                0.25 * ((self.center + far) + (self.spokes[i] + self.spokes[(i + 1) % n]))
            })
            .collect();
        let spoke = |i: usize| {
            let before = if i == 0 && self.is_closed() { n - 1 } else { i.wrapping_sub(1) };
            let sides = centroids.get(before).zip(centroids.get(i)).map(|(&a, &b)| [a, b]);
            edge_point([self.center, self.spokes[i]], sides, self.creases[i])
        };
        let surroundings = Surroundings {
            center: self.center,
            corner: self.corner,
            spokes: &self.spokes,
            creases: &self.creases,
            centroids: &centroids,
        };
        Self {
            center: surroundings.moved(),
            corner: decayed(self.corner),
            spokes: (0..n).map(spoke).collect(),
            creases: self.creases.iter().map(|&sharpness| decayed(sharpness)).collect(),
            diagonals: centroids,
        }
    }

    /// Whether anything is sharp that refinement makes smooth.
    pub(super) fn is_semi_sharp(&self) -> bool {
        let finite = |s: f64| s > 0.0 && s.is_finite();
        finite(self.corner) || self.creases.iter().any(|&s| finite(s))
    }

    /// The ring after refinement has used up all finite sharpness.
    fn settled(&self) -> Self {
        let mut ring = self.clone();
        for _ in 0..SHARP_STEPS {
            if !ring.is_semi_sharp() {
                break;
            }
            ring = ring.refined();
        }
        ring
    }

    /// The limit point of the vertex.
    ///
    /// With n edges it is `(n² v + 4 Σ spokes + Σ diagonals) / (n (n + 5))` (Halstead, Kass &
    /// DeRose 1993); on a crease from a to b the cubic B-spline's `(a + 4 v + b)/6`; at a corner v
    /// itself. For a dart no such mask is known, so its ring is refined until it has shrunk below
    /// rounding.
    pub(super) fn limit(&self) -> DVec3 {
        let mut ring = self.settled();
        if ring.is_dart() {
            for _ in 0..DART_STEPS {
                ring = ring.refined();
            }
            return ring.center;
        }
        match ring.rule() {
            Rule::Corner => ring.center,
            Rule::Crease([a, b]) => (4.0 * ring.center + (ring.spokes[a] + ring.spokes[b])) / 6.0,
            Rule::Smooth => {
                let n = ring.spokes.len() as f64;
                let spokes: DVec3 = ring.spokes.iter().sum();
                let diagonals: DVec3 = ring.diagonals.iter().sum();
                (n * n * ring.center + 4.0 * spokes + diagonals) / (n * (n + 5.0))
            }
        }
    }

    /// The unit normal of the limit surface at the limit point, as seen from one of the quads.
    ///
    /// Smooth vertices use the tangent masks of Halstead, Kass & DeRose (1993), vertices on creases
    /// the same eigenvectors fitted to the crease, corners of a single quad its two edges. For
    /// darts the ring is refined.
    ///
    /// `None` where there is no tangent plane: where the tangents are parallel or vanish, at sharp
    /// corners of two or more quads without a crease between them, and at creases with four or more
    /// quads on this side. (From four on, an eigenvalue across the crease is as large as the 1/2
    /// along it: Biermann, Levin & Zorin 2000 change the rules for that reason.)
    pub(super) fn normal(&self, quad: usize) -> Option<DVec3> {
        let ring = self.settled();
        let [first, second] = match ring.rule() {
            _ if ring.is_dart() => return ring.dart_normal(),
            Rule::Smooth => ring.smooth_tangents(),
            Rule::Crease(_) => {
                let sector = ring.sector(quad).filter(|sector| sector.len() <= 4)?;
                ring.crease_tangents(&sector)
            }
            Rule::Corner => {
                let sector = ring.sector(quad)?;
                let [first, last] = sector[..] else { return None };
                [first, last].map(|spoke| ring.spokes[spoke] - ring.center)
            }
        };
        unit_normal(first, second, ring.extent())
    }

    /// The vector from the limit point of a smooth vertex to the next control point on the patch
    /// border along a spoke, a third of the tangent there; for four spokes it is the B-spline's
    /// (Loop, Schaefer, Ni & Castaño 2009). `None` if anything is sharp, the ring is open, or there
    /// are only two spokes.
    pub(super) fn handle(&self, along: usize) -> Option<DVec3> {
        let smooth = self.corner == 0.0 && self.creases.iter().all(|&s| s == 0.0);
        if !(smooth && self.is_closed() && self.spokes.len() > 2) {
            return None;
        }
        let n = self.spokes.len() as f64;
        let angle = TAU / n;
        let a = spoke_weight(angle);
        let around = self.spokes.iter().zip(&self.diagonals).enumerate();
        let sum = around.fold(DVec3::ZERO, |sum, (i, (spoke, diagonal))| {
            let turn = angle * (i as f64 - along as f64);
            let (here, next) = (turn.cos(), (turn + angle).cos());
            sum + a * here * (*spoke - self.center) + (here + next) * (*diagonal - self.center)
        });
        // The length is that of the cited paper, written for this scaling of the eigenvector.
        let eigenvalue = (a + 4.0) / 16.0;
        let half = (0.5 * angle).cos();
        Some(sum * (eigenvalue / (3.0 * n * half * (4.0 + half * half).sqrt())))
    }

    fn smooth_tangents(&self) -> [DVec3; 2] {
        let n = self.spokes.len() as f64;
        let angle = TAU / n;
        let a = spoke_weight(angle);
        let tangent = |wave: fn(f64) -> f64| {
            let around = self.spokes.iter().zip(&self.diagonals).enumerate();
            around.fold(DVec3::ZERO, |sum, (i, (spoke, diagonal))| {
                let [here, next] = [i, i + 1].map(|i| wave(angle * i as f64));
                sum + a * here * (*spoke - self.center) + (here + next) * (*diagonal - self.center)
            })
        };
        [tangent(f64::cos), tangent(f64::sin)]
    }

    /// The spokes of the quads that are connected to a quad without crossing a sharp edge.
    fn sector(&self, quad: usize) -> Option<Vec<usize>> {
        let n = self.spokes.len();
        let mut first = quad;
        while !self.creases.get(first).is_some_and(|&s| s > 0.0) {
            first = (first + n - 1) % n;
            if first == quad {
                return None;
            }
        }
        let mut sector = vec![first];
        for step in 1..=n {
            let spoke = (first + step) % n;
            sector.push(spoke);
            if self.creases[spoke] > 0.0 {
                break;
            }
        }
        Some(sector)
    }

    /// The tangents along the crease and across it, for k quads between its two edges.
    fn crease_tangents(&self, sector: &[usize]) -> [DVec3; 2] {
        let k = sector.len() - 1;
        let offset = |spoke: usize| self.spokes[spoke] - self.center;
        let (first, last) = (offset(sector[0]), offset(sector[k]));
        if k == 1 {
            return [first - last, first + last];
        }
        // Inside, the eigenvector is that of a smooth vertex with the angle π/k. Its values at the
        // two ends follow from their column of the refinement matrix, and from the weights' sum,
        // which is 0.
        let angle = PI / k as f64;
        let a = spoke_weight(angle);
        let eigenvalue = (a + 4.0) / 16.0;
        let (mut across, mut sum) = (DVec3::ZERO, 0.0);
        for (i, &spoke) in sector.iter().enumerate().take(k) {
            let [here, next] = [i, i + 1].map(|i| (angle * i as f64).sin());
            across +=
                a * here * offset(spoke) + (here + next) * (self.diagonals[spoke] - self.center);
            sum += (a + 1.0) * here + next;
        }
        let outermost = angle.sin();
        let end = (0.25 * outermost + 0.0625 * a * outermost - 0.125 * sum) / (eigenvalue - 0.25);
        across += end * (first + last);
        [first - last, across]
    }

    /// The normal of a dart's ring, refined until it is flat. The ring is kept about the origin, so
    /// that its size does not vanish relative to its position.
    fn dart_normal(&self) -> Option<DVec3> {
        let mut ring = self.clone();
        for _ in 0..DART_STEPS {
            let (center, scale) = (ring.center, 1.0 / ring.extent());
            let moved = |point: &mut DVec3| *point = (*point - center) * scale;
            moved(&mut ring.center);
            ring.spokes.iter_mut().chain(&mut ring.diagonals).for_each(moved);
            ring = ring.refined();
        }
        let n = ring.spokes.len();
        let offset = |i: usize| ring.spokes[i % n] - ring.center;
        let sum: DVec3 = (0..n).map(|i| offset(i).cross(offset(i + 1))).sum();
        sum.try_normalize()
    }

    /// The length of the longest spoke or diagonal.
    fn extent(&self) -> f64 {
        let far = self.spokes.iter().chain(&self.diagonals);
        far.map(|point| (*point - self.center).length()).fold(0.0, f64::max)
    }
}

/// The weight of spokes relative to that of diagonals in the subdominant eigenvectors, for quads
/// `angle` apart; the eigenvalue is (weight + 4)/16.
fn spoke_weight(angle: f64) -> f64 {
    1.0 + angle.cos() + (0.5 * angle).cos() * (2.0 * (9.0 + angle.cos())).sqrt()
}

/// The direction of a cross product; `None` if the product is rounding error.
pub(super) fn unit_normal(first: DVec3, second: DVec3, extent: f64) -> Option<DVec3> {
    // Rounding leaves some ulps of the ring's extent in each tangent.
    let noise = 64.0 * f64::EPSILON * extent;
    if !(first.length() > noise && second.length() > noise) {
        return None;
    }
    let (a, b) = (first.normalize(), second.normalize());
    let cross = a.cross(b);
    (cross.length() > 64.0 * f64::EPSILON).then(|| cross.normalize())
}
