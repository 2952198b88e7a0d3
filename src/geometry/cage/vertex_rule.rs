//! Where a step of Catmull–Clark refinement puts a vertex, sharp or not.

use glam::DVec3;

/// The rule by which a vertex moves. A dart, the end of a single crease, moves as if smooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// By all its neighbours.
    Smooth,
    /// Along the crease through these two spokes.
    Crease([usize; 2]),
    /// Not at all.
    Corner,
}

/// The sharpness left after a step: one less, but at least 0.
pub(super) fn decayed(sharpness: f64) -> f64 {
    (sharpness - 1.0).max(0.0)
}

impl Rule {
    /// The rule of a vertex by its own sharpness and that of its spokes.
    pub(super) fn of(corner: f64, spokes: impl Iterator<Item = f64>) -> Self {
        let mut sharp = [0; 2];
        let mut count = 0;
        for (index, _) in spokes.enumerate().filter(|(_, sharpness)| *sharpness > 0.0) {
            sharp[count.min(1)] = index;
            count += 1;
        }
        match count {
            _ if corner > 0.0 => Self::Corner,
            0 | 1 => Self::Smooth,
            2 => Self::Crease(sharp),
            _ => Self::Corner,
        }
    }
}

/// A vertex and everything its new position depends on.
pub(super) struct Surroundings<'a> {
    /// The vertex.
    pub(super) center: DVec3,
    /// Its own sharpness.
    pub(super) corner: f64,
    /// The ends of its edges.
    pub(super) spokes: &'a [DVec3],
    /// The sharpness of its edges.
    pub(super) creases: &'a [f64],
    /// The centroids of its faces.
    pub(super) centroids: &'a [DVec3],
}

impl Surroundings<'_> {
    /// The position of the vertex after a step.
    ///
    /// With n edges it is `(n − 2)/n v + (Σ spokes + Σ centroids)/n²` if smooth (Catmull & Clark
    /// 1978), `3/4 v + 1/8 (a + b)` on a crease from a to b, `v` at a corner (DeRose, Kass & Truong
    /// 1998). Where the rule changes after the step, because sharpness below 1 has run out, the two
    /// rules are blended by the mean of the sharpness that runs out.
    pub(super) fn moved(&self) -> DVec3 {
        let before = Rule::of(self.corner, self.creases.iter().copied());
        let after = Rule::of(decayed(self.corner), self.creases.iter().map(|&s| decayed(s)));
        if before == after {
            return self.by(before);
        }
        let all = self.creases.iter().copied().chain([self.corner]);
        let ending = all.filter(|&s| s > 0.0 && decayed(s) == 0.0);
        let (sum, count) = ending.fold((0.0, 0.0), |(sum, count), s| (sum + s, count + 1.0));
        let weight: f64 = sum / count;
        self.by(after).lerp(self.by(before), weight)
    }

    fn by(&self, rule: Rule) -> DVec3 {
        let n = self.spokes.len() as f64;
        match rule {
            Rule::Corner => self.center,
            Rule::Crease([a, b]) => 0.75 * self.center + 0.125 * (self.spokes[a] + self.spokes[b]),
            // This is the border of a part of a mesh, never of a cage: nothing depends on it.
            Rule::Smooth if self.spokes.len() != self.centroids.len() => self.center,
            Rule::Smooth => {
                let spokes: DVec3 = self.spokes.iter().sum();
                let centroids: DVec3 = self.centroids.iter().sum();
                (n - 2.0) / n * self.center + (spokes + centroids) / (n * n)
            }
        }
    }
}

/// The position of the new vertex of an edge after a step: `(ends + centroids)/4` if smooth, the
/// mean of the ends if sharp, blended for sharpness below 1. Boundaries have no `centroids`.
pub(super) fn edge_point(ends: [DVec3; 2], centroids: Option<[DVec3; 2]>, sharpness: f64) -> DVec3 {
    let middle = 0.5 * (ends[0] + ends[1]);
    match centroids {
        Some([a, b]) if sharpness < 1.0 => {
            let smooth = 0.25 * ((ends[0] + ends[1]) + (a + b));
            smooth.lerp(middle, sharpness)
        }
        _ => middle,
    }
}
