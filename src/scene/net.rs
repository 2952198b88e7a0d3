//! Control nets as written, not yet checked.

use glam::DVec3;

use super::Written;
use crate::geometry::{Direction, KnotError, KnotVector, NurbsSurface, SurfaceError};

/// Knots as an author lists them.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Knots {
    /// Clamped and evenly spaced on `[0, 1]`: what is meant when none are given.
    #[default]
    ClampedUniform,
    /// Every knot, equal ones repeated.
    Values(Vec<f64>),
    /// Each knot once, with its multiplicity.
    Multiplicities(Vec<(f64, usize)>),
}

/// A NURBS surface as written: numbers with their places, not yet known to be a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// The degrees in u and v.
    pub degree: [usize; 2],
    /// The knots in u and v.
    pub knots: [Written<Knots>; 2],
    /// The number of control points along u and v.
    pub size: [usize; 2],
    /// The control points, v fastest, not multiplied by their weights.
    pub points: Written<Vec<DVec3>>,
    /// A weight for each control point; none for a polynomial surface.
    pub weights: Option<Written<Vec<f64>>>,
}

/// Why a net is no surface, and the number to blame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NetFault {
    pub(super) error: SurfaceError,
    pub(super) blame: Blame,
}

/// The part of a net that is at fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Blame {
    Knots(Direction),
    Points,
    Weights,
}

impl Net {
    /// The surface these numbers are, if they are one.
    pub(super) fn surface(&self) -> Result<NurbsSurface, NetFault> {
        let knots_u = self.knot_vector(Direction::U)?;
        let knots_v = self.knot_vector(Direction::V)?;
        let weights = self.weights.as_ref().map(|weights| weights.value.clone());
        NurbsSurface::new(knots_u, knots_v, self.points.value.clone(), weights).map_err(|error| {
            let blame = match error {
                SurfaceError::Weight { .. } | SurfaceError::WeightCount { .. } => Blame::Weights,
                SurfaceError::Domain { direction, .. } => Blame::Knots(direction),
                _ => Blame::Points,
            };
            NetFault { error, blame }
        })
    }

    fn knot_vector(&self, direction: Direction) -> Result<KnotVector, NetFault> {
        let k = match direction {
            Direction::U => 0,
            Direction::V => 1,
        };
        knot_vector(self.degree[k], &self.knots[k].value, self.size[k]).map_err(|error| NetFault {
            error: SurfaceError::Knots { direction, error },
            blame: Blame::Knots(direction),
        })
    }

    /// Where the part to blame was written.
    pub(super) fn place(&self, blame: Blame) -> &super::Place {
        match (blame, &self.weights) {
            (Blame::Knots(Direction::U), _) => &self.knots[0].place,
            (Blame::Knots(Direction::V), _) => &self.knots[1].place,
            (Blame::Weights, Some(weights)) => &weights.place,
            (Blame::Points | Blame::Weights, _) => &self.points.place,
        }
    }
}

pub(super) fn knot_vector(
    degree: usize,
    knots: &Knots,
    points: usize,
) -> Result<KnotVector, KnotError> {
    match knots {
        Knots::ClampedUniform => KnotVector::clamped_uniform(degree, points),
        Knots::Values(values) => KnotVector::for_points(degree, values.clone(), points),
        Knots::Multiplicities(pairs) => {
            let knots = KnotVector::with_multiplicities(degree, pairs)?;
            KnotVector::for_points(degree, knots.values().to_vec(), points)
        }
    }
}
