//! What the exact solver is asked, and what it answers.

use glam::DVec2;

use crate::geometry::RectSide;
use crate::math::RayFrame;
use crate::patch::{StRect, TensorPatch};

/// One leaf and one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Problem<'a> {
    /// The piece the leaf belongs to.
    pub patch: &'a TensorPatch,
    /// The rectangle to search, in the piece's parameters: the leaf and at least its slack.
    pub rect: StRect,
    /// A root is wanted only if it lies in this rectangle, to within its slack.
    pub wanted: StRect,
    /// The side at which the rectangle ends in a point.
    pub collapsed: Option<RectSide>,
    /// The ray.
    pub ray: &'a RayFrame,
    /// How far computed points may be from the true ones.
    pub error: f64,
    /// The range of `z` of interest.
    pub z_range: [f64; 2],
}

/// How a solution is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Evidence {
    /// The only root in this rectangle of parameters.
    Isolated(StRect),
    /// The ray passes through the point a side is collapsed to.
    Collapsed,
    /// The ray passes the surface within rounding: a tangency, or a near miss; somewhere from `z`
    /// to `z`.
    Contact([f64; 2]),
    /// An end of a stretch along which the ray runs inside the surface, from `z` to `z`.
    Stretch { z: [f64; 2], end: End },
}

/// An end of a stretch, as the ray runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    First,
    Last,
}

impl End {
    pub(crate) const BOTH: [Self; 2] = [Self::First, Self::Last];
}

impl Evidence {
    /// Whether it is proved that the ray meets the surface there.
    pub(crate) fn is_proof(self) -> bool {
        self.open_range().is_none()
    }

    /// The range along the ray in which the solution lies, if rounding allows no more precise
    /// answer.
    pub(crate) fn open_range(self) -> Option<[f64; 2]> {
        match self {
            Self::Isolated(_) | Self::Collapsed => None,
            Self::Contact(z) | Self::Stretch { z, .. } => Some(z),
        }
    }
}

/// A place where the ray meets the leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solution {
    pub st: DVec2,
    pub evidence: Evidence,
}

/// What a search finds on a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Found {
    Place(Solution),
    /// Both ends of a stretch.
    Stretch([Solution; 2]),
}

impl Found {
    /// The place, or the two ends.
    pub(crate) fn solutions(&self) -> &[Solution] {
        match self {
            Self::Place(solution) => std::slice::from_ref(solution),
            Self::Stretch(ends) => ends,
        }
    }

    /// How it is known; of both ends of a stretch, this is alike but for which of them it is.
    pub(crate) fn evidence(&self) -> Evidence {
        self.solutions()[0].evidence
    }
}
