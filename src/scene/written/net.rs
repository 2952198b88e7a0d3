//! Control nets as written, not yet checked.

use glam::DVec3;

use super::Written;
use crate::geometry::{
    Direction, KnotError, KnotVector, LEAST_AROUND, MAX_CONTROL_POINTS, NurbsSurface, SurfaceError,
};

/// Knots as an author writes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Knots {
    /// Clamped and evenly spaced on `[0, 1]`: what is meant when none are given.
    #[default]
    ClampedUniform,
    /// Clamped, `0, 1, 2, …` inside: the textbooks' standard knots.
    Standard,
    /// Every knot, equal ones repeated.
    Values(Vec<f64>),
    /// Each knot once, with its multiplicity.
    Multiplicities(Vec<(f64, usize)>),
    /// Evenly spaced, without repeated ends: `0, 1, 2, …`.
    Uniform,
    /// The knots `0, 1, 2, …` of a closed spline: each control point is written once, and the first
    /// ones follow again after the last.
    PeriodicUniform,
    /// As [`Knots::PeriodicUniform`], with the knots of one period listed: one more than there are
    /// control points.
    Periodic(Vec<f64>),
}

/// A NURBS surface as written: numbers with their places, not yet known to be a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// The degrees in u and v.
    pub degree: [Written<usize>; 2],
    /// The knots in u and v.
    pub knots: [Written<Knots>; 2],
    /// The number of control points written along u and v.
    pub size: [usize; 2],
    /// The control points, v fastest, not multiplied by their weights.
    pub points: Written<Vec<DVec3>>,
    /// A weight for each control point; none for a polynomial surface.
    pub weights: Option<Written<Vec<f64>>>,
}

/// Why a net is not a surface, and the part to blame.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct NetFault {
    pub(in crate::scene) error: SurfaceError,
    pub(in crate::scene) blame: Blame,
}

/// The part of a net that is at fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) enum Blame {
    Degree(Direction),
    Knots(Direction),
    Points,
    Weights,
}

impl Net {
    /// The surface that these numbers describe.
    ///
    /// # Errors
    /// When they describe none: see [`NurbsSurface::new`] and [`KnotVector`]; or when points that a
    /// periodic direction repeats by itself are written again.
    pub fn surface(&self) -> Result<NurbsSurface, SurfaceError> {
        self.checked().map_err(|fault| fault.error)
    }

    /// As [`Net::surface`], but an error also tells the part to blame.
    pub(in crate::scene) fn checked(&self) -> Result<NurbsSurface, NetFault> {
        let knots_u = self.knot_vector(Direction::U)?;
        let knots_v = self.knot_vector(Direction::V)?;
        for direction in Direction::BOTH {
            let weights = self.weights.as_ref().map(|weights| &weights.value[..]);
            let grid = Grid { points: &self.points.value, weights, size: self.size };
            let degree = self.degree[direction].value;
            let checked = self.knots[direction].value.check_period(&grid, direction, degree);
            checked.map_err(|error| NetFault {
                error: SurfaceError::Knots { direction, error },
                blame: Blame::Points,
            })?;
        }
        let around = [knots_u.point_count(), knots_v.point_count()];
        let points = wrapped(&self.points.value, self.size, around);
        let weights =
            self.weights.as_ref().map(|weights| wrapped(&weights.value, self.size, around));
        NurbsSurface::new(knots_u, knots_v, points, weights).map_err(|error| {
            let blame = match error {
                SurfaceError::Weight { .. } | SurfaceError::WeightCount { .. } => Blame::Weights,
                SurfaceError::Domain { direction, .. } => Blame::Knots(direction),
                _ => Blame::Points,
            };
            NetFault { error, blame }
        })
    }

    /// The number of control points, those that closed directions repeat included.
    pub(super) fn point_count(&self) -> usize {
        let repeated =
            [0, 1].map(|k| if self.knots[k].value.are_closed() { self.degree[k].value } else { 0 });
        if repeated == [0, 0] {
            return self.points.value.len();
        }
        let [rows, columns] = [0, 1].map(|k| self.size[k].saturating_add(repeated[k]));
        rows.saturating_mul(columns)
    }

    fn knot_vector(&self, direction: Direction) -> Result<KnotVector, NetFault> {
        let knots = &self.knots[direction].value;
        let degree = self.degree[direction].value;
        knot_vector(degree, knots, self.size[direction]).map_err(|error| {
            let blame = match error {
                KnotError::Degree { .. } => Blame::Degree(direction),
                _ => Blame::Knots(direction),
            };
            NetFault { error: SurfaceError::Knots { direction, error }, blame }
        })
    }

    /// Where the part to blame was written.
    pub(in crate::scene) fn place(&self, blame: Blame) -> &super::Place {
        match (blame, &self.weights) {
            (Blame::Degree(direction), _) => &self.degree[direction].place,
            (Blame::Knots(direction), _) => &self.knots[direction].place,
            (Blame::Weights, Some(weights)) => &weights.place,
            (Blame::Points | Blame::Weights, _) => &self.points.place,
        }
    }
}

impl Knots {
    /// Whether these are the knots of a closed spline, for which the first control points are
    /// repeated.
    pub(in crate::scene) fn are_closed(&self) -> bool {
        matches!(self, Self::PeriodicUniform | Self::Periodic(_))
    }

    /// Checks that a grid of control points does not end, in the direction of these knots, with
    /// those that a closed spline of this degree repeats by itself: other programs write them. (A
    /// spline that is to run twice through the same points is refused, too.)
    pub(super) fn check_period(
        &self,
        grid: &Grid<'_>,
        direction: Direction,
        degree: usize,
    ) -> Result<(), KnotError> {
        let count = grid.size[direction];
        // At degree 1 a repeated point does no harm. The others must make a closed spline.
        let others = count.saturating_sub(degree);
        let may_repeat = degree > 1 && others >= LEAST_AROUND;
        if !(self.are_closed() && grid.is_full() && may_repeat) {
            return Ok(());
        }
        let same = |i: usize, j: usize| grid.are_same(direction, i, j);
        let is_apex = (1..count).all(|i| same(0, i));
        if !is_apex && (0..degree).all(|i| same(i, others + i)) {
            return Err(KnotError::Wrapped { repeated: degree });
        }
        Ok(())
    }
}

/// Control points as written, second direction fastest: those of a curve are a row.
pub(super) struct Grid<'a> {
    pub(super) points: &'a [DVec3],
    pub(super) weights: Option<&'a [f64]>,
    pub(super) size: [usize; 2],
}

impl Grid<'_> {
    /// Whether there are as many points, and weights if there are any, as the size says; surfaces
    /// and curves refuse others.
    fn is_full(&self) -> bool {
        let count = self.size[0].checked_mul(self.size[1]);
        count == Some(self.points.len())
            && self.weights.is_none_or(|weights| count == Some(weights.len()))
    }

    /// Whether two rows of control points across a direction are the same.
    fn are_same(&self, direction: Direction, i: usize, j: usize) -> bool {
        let [_, columns] = self.size;
        (0..self.size[direction.other()]).all(|k| {
            let [a, b] = [i, j].map(|row| {
                let [row, column] = direction.pair(row, k);
                row * columns + column
            });
            self.points[a] == self.points[b] && self.weights.is_none_or(|w| w[a] == w[b])
        })
    }
}

/// The knots `0, 1, 2, …` of a period of this many spans.
pub(in crate::scene) fn evenly_spaced(spans: usize) -> Vec<f64> {
    (0..=spans).map(|knot| knot as f64).collect()
}

/// The entries of a grid of `size` (second direction fastest), with the first rows and columns
/// repeated after the last until the grid has the size `wanted`, which the knots of closed
/// directions need.
///
/// Entries that do not fill `size` are returned as they are: the surface or curve then refuses
/// them.
pub(in crate::scene) fn wrapped<T: Copy>(
    entries: &[T],
    size: [usize; 2],
    wanted: [usize; 2],
) -> Vec<T> {
    if wanted == size || entries.len() != size[0] * size[1] {
        return entries.to_vec();
    }
    let row = |i: usize| (0..wanted[1]).map(move |j| entries[i % size[0] * size[1] + j % size[1]]);
    (0..wanted[0]).flat_map(row).collect()
}

/// The knot vector for this many control points, as written. That of a closed spline has more
/// points: the first ones again, as [`wrapped`] repeats them.
pub(in crate::scene) fn knot_vector(
    degree: usize,
    knots: &Knots,
    points: usize,
) -> Result<KnotVector, KnotError> {
    match knots {
        Knots::ClampedUniform => KnotVector::clamped_uniform(degree, points),
        Knots::Standard => KnotVector::standard(degree, points),
        Knots::Values(values) => KnotVector::for_points(degree, values.clone(), points),
        Knots::Multiplicities(pairs) => {
            let knots = KnotVector::with_multiplicities(degree, pairs)?;
            KnotVector::for_points(degree, knots.values().to_vec(), points)
        }
        Knots::Uniform => KnotVector::uniform(degree, points),
        // Before as many knots are made.
        Knots::PeriodicUniform if points > MAX_CONTROL_POINTS => {
            Err(KnotError::TooManyPoints { points })
        }
        Knots::PeriodicUniform => KnotVector::periodic(degree, &evenly_spaced(points)),
        Knots::Periodic(period) if period.len() != points.saturating_add(1) => {
            Err(KnotError::PeriodCount { knots: period.len(), points })
        }
        Knots::Periodic(period) => KnotVector::periodic(degree, period),
    }
}
