//! Trim edges near a root where the ray meets the surface at a small angle.
//!
//! Where a root may be far off along the ray, it may be on either side of any edge that the ray
//! passes over there. But only a narrow strip of the surface lies within rounding of the ray: an
//! edge beside that strip does not matter. Where the shape of the strip is not certain, all edges
//! near it matter.

use glam::{DVec2, DVec3};

use super::reach::{TRIM_REACH, parameter_reach, step_towards};
use crate::geometry::RectSide;
use crate::geometry::trim::Side;
use crate::math::RayFrame;
use crate::patch::{Jet, Piece};

/// How well a root is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownRoot<'a> {
    pub ray: &'a RayFrame,
    /// How far its point may be from the ray.
    pub error: f64,
    /// How far it may be off along the ray.
    pub along: f64,
}

/// Roots whose error bound along the ray is more than this many times the one across it are treated
/// as a stretch of the ray, not as a square.
const STRETCHED: f64 = 4.0;

/// The most squares that are looked at: a few for each halving of a long strip beside an edge.
const MOST_SQUARES: usize = 256;

/// Gauss–Newton steps to the place under a point of the ray, from a place near it.
const STEPS: usize = 3;

impl KnownRoot<'_> {
    /// Whether edges beside the strip must be told from those on it.
    pub(super) fn is_long(&self) -> bool {
        self.along > STRETCHED * self.error
    }

    /// The side of the trims that holds all the ray passes over where the root may be; `None` if it
    /// may be either. The piece has no pole nearby.
    ///
    /// The strip is covered by squares over parts of the ray; a part is halved as long as its
    /// square reaches an edge and it is longer than the strip is wide.
    pub(super) fn side(&self, piece: &Piece, st: DVec2, jet: &Jet) -> Option<Side> {
        let width = TRIM_REACH * self.error;
        let (mut waiting, mut only) = (vec![self.over_piece(piece, jet.point)], None);
        for _ in 0..MOST_SQUARES {
            let Some(part) = waiting.pop() else { return only };
            match self.side_of(piece, (st, jet), part) {
                Strip::Beyond => {}
                Strip::Of(side) if *only.get_or_insert(side) == side => {}
                Strip::Open if part[1] - part[0] > 2.0 * width => {
                    let middle = 0.5 * (part[0] + part[1]);
                    waiting.extend([[middle, part[1]], [part[0], middle]]);
                }
                Strip::Of(_) | Strip::Open | Strip::Unknown => return None,
            }
        }
        None // it may run along an edge
    }

    /// The range along the ray, measured from a root, that is near enough to the root and may be
    /// over the piece: the piece lies between its control points.
    fn over_piece(&self, piece: &Piece, root: DVec3) -> [f64; 2] {
        let reach = TRIM_REACH * self.along;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in piece.patch.control() {
            let along = self.ray.axis.dot(point.project() - root);
            (least, most) = (least.min(along), most.max(along));
        }
        let spare = TRIM_REACH * self.error;
        [(least - spare).max(-reach), (most + spare).min(reach)]
    }

    /// The side of what lies under a part of the ray, whose ends are given as lengths from a root.
    fn side_of(&self, piece: &Piece, root: (DVec2, &Jet), [from, to]: [f64; 2]) -> Strip {
        let half = 0.5 * (to - from);
        let under = |along: f64| Foot::new(piece, root, root.1.point + along * self.ray.axis);
        let feet = [from, 0.5 * (from + to), to].map(under);
        // Beyond a border there is nothing; beyond another side there are other parameters, about
        // which nothing is known here.
        let beyond = |foot: &Foot| foot.beyond.filter(|&side| !piece.is_border(side));
        if feet.iter().any(|foot| beyond(foot).is_some()) {
            return Strip::Unknown;
        }
        let [a, middle, b] = &feet;
        if a.beyond.is_some() && a.beyond == middle.beyond && a.beyond == b.beyond {
            return Strip::Beyond;
        }
        let found = |foot: &Foot| foot.beyond.is_some() || foot.off <= self.error + 0.25 * half;
        if !feet.iter().all(found) {
            return Strip::Open; // also for NaN
        }
        // Twice as far as the ends, which must surely be within reach.
        let reach = parameter_reach(&middle.jet, 2.0 * half + TRIM_REACH * self.error);
        let holds = |foot: &Foot| (foot.st - middle.st).abs().cmple(reach).all();
        match piece.side(middle.st, reach) {
            side @ (Side::Inside | Side::Outside) if holds(a) && holds(b) => Strip::Of(side),
            _ => Strip::Open,
        }
    }
}

/// What is known of a part of the strip.
enum Strip {
    /// It lies beyond the surface's border.
    Beyond,
    /// It lies on one side of all edges.
    Of(Side),
    /// Its parts may each lie on one side.
    Open,
    /// Part of it lies over another piece.
    Unknown,
}

/// The place of a piece under a point.
struct Foot {
    st: DVec2,
    jet: Jet,
    /// The side beyond which the point lies, if it does.
    beyond: Option<RectSide>,
    /// How far the place is off in the tangent plane.
    off: f64,
}

impl Foot {
    fn new(piece: &Piece, (mut st, jet): (DVec2, &Jet), point: DVec3) -> Self {
        let mut jet = *jet;
        for _ in 0..STEPS {
            st = (st + step_towards(&jet, point - jet.point)).clamp(DVec2::ZERO, DVec2::ONE);
            jet = piece.patch.jet(st);
        }
        let step = step_towards(&jet, point - jet.point);
        let next = st + step;
        let outside = [next.x < 0.0, next.x > 1.0, next.y < 0.0, next.y > 1.0];
        let beyond = RectSide::ALL.into_iter().find(|&side| outside[side]);
        Self { st, jet, beyond, off: (step.x * jet.ds + step.y * jet.dt).length() }
    }
}
