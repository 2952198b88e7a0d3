//! The rectangle of parameters that trim loops cut from, and whether it closes on itself.

use super::{JOINT_TOLERANCE, MAX_PARAMETER, TrimError, TrimLoopError, UvBox};
use glam::DVec2;

use crate::geometry::{Direction, NurbsSurface, RectSide};

/// The domain of the surface that is trimmed.
///
/// In a *periodic* direction the surface closes on itself with the length of the domain as its
/// period. Loops may then run past the domain's ends and lie anywhere along that direction: a loop
/// stands for itself and all its copies shifted by whole periods, and the copies that reach into
/// the domain are used. So a hole across the seam of a cylinder `0 ≤ u ≤ 1` is one loop around
/// `u = 0`, or the same loop around `u = 1`.
///
/// A loop must close in the plane. A cut that runs once around a cylinder does not: it ends one
/// period from where it began, and which side of it is meant is unknown. Complete such a cut to a
/// loop along the seam and a border, as on an unrolled sheet, or join two such cuts along the seam
/// to bound a band.
///
/// A side may be a *pole*, which the surface collapses to a point. The curves of a loop
/// [on the domain](super::TrimLoop::on) need not say how they go from one place of it to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimDomain {
    range: [[f64; 2]; 2],
    periodic: [bool; 2],
    /// Which sides are poles.
    poles: [bool; 4],
}

impl TrimDomain {
    /// The domain `[u[0], u[1]] × [v[0], v[1]]`, periodic in neither direction.
    ///
    /// # Errors
    /// When a range is empty, not finite, or goes beyond 10¹⁰⁰.
    pub fn new(u: [f64; 2], v: [f64; 2]) -> Result<Self, TrimError> {
        for (direction, [start, end]) in [(Direction::U, u), (Direction::V, v)] {
            let usable = start < end && start.abs() <= MAX_PARAMETER && end.abs() <= MAX_PARAMETER;
            if !usable {
                return Err(TrimError::Domain { direction, start, end });
            }
        }
        Ok(Self { range: [u, v], periodic: [false; 2], poles: [false; 4] })
    }

    /// The domain of a surface, periodic in neither direction and without poles.
    ///
    /// # Errors
    /// When the surface's parameters go beyond 10¹⁰⁰.
    pub fn of(surface: &NurbsSurface) -> Result<Self, TrimError> {
        let [u, v] = surface.domain();
        Self::new(u, v)
    }

    /// The domain of a surface, periodic where the surface
    /// [closes on itself](NurbsSurface::closes), with its poles.
    ///
    /// # Errors
    /// When the surface's parameters go beyond 10¹⁰⁰.
    pub fn with_seams_of(surface: &NurbsSurface) -> Result<Self, TrimError> {
        let mut domain = Self::of(surface)?;
        for direction in Direction::BOTH {
            if surface.closes(direction) {
                domain = domain.periodic_in(direction);
            }
        }
        domain.poles = RectSide::ALL.map(|side| {
            let border = surface.curve_at(side.fixed(), side.value_in(&domain.range));
            border.is_ok_and(|border| border.is_point())
        });
        Ok(domain)
    }

    /// The same domain, closing on itself in a direction.
    #[must_use]
    pub fn periodic_in(mut self, direction: Direction) -> Self {
        self.periodic[direction] = true;
        self
    }

    /// The domain run backwards in u, with another range, which must be as valid as its present
    /// one.
    pub(super) fn reversed_u(mut self, range: [f64; 2]) -> Self {
        self.range[0] = range;
        self.poles[..2].reverse();
        self
    }

    /// The domain with u and v exchanged.
    pub(super) fn swapped(mut self) -> Self {
        self.range.reverse();
        self.periodic.reverse();
        self.poles.rotate_left(2);
        self
    }

    /// The ranges `[start, end]` in u and in v.
    pub fn range(&self) -> [[f64; 2]; 2] {
        self.range
    }

    /// Whether the domain closes on itself in a direction.
    pub fn is_periodic(&self, direction: Direction) -> bool {
        self.periodic[direction]
    }

    /// The way along a pole between two points no farther than `slack` from it, or along two poles
    /// that share a corner; `None` if there are no such poles.
    pub(super) fn along_poles(&self, ends: [DVec2; 2], slack: DVec2) -> Option<Vec<DVec2>> {
        let on_poles = ends.map(|end| {
            RectSide::ALL.map(|side| {
                let (fixed, at) = (side.fixed(), side.value_in(&self.range));
                let is_near = self.poles[side] && (end[fixed] - at).abs() <= slack[fixed];
                let mut on_pole = end;
                on_pole[fixed] = at;
                is_near.then_some(on_pole)
            })
        });
        let pair = |a: RectSide, b: RectSide| Some((on_poles[0][a]?, on_poles[1][b]?));
        let mut sides = RectSide::ALL.into_iter();
        let along_one = sides.find_map(|side| pair(side, side)).map(|(from, to)| vec![from, to]);
        along_one.or_else(|| {
            let [us, vs] = Direction::BOTH.map(RectSide::ends_of);
            let mut corners = us.into_iter().flat_map(|u| vs.map(|v| (u, v)));
            corners.find_map(|(u, v)| {
                let (from, to) = pair(u, v).or_else(|| pair(v, u))?;
                let corner = DVec2::new(u.value_in(&self.range), v.value_in(&self.range));
                Some(vec![from, corner, to])
            })
        })
    }

    /// Restates an error about a loop for loops on this domain: a loop that is open by just the
    /// length of the domain, as a line around a cylinder is, becomes [`TrimLoopError::Across`].
    #[must_use]
    pub fn explained(&self, error: TrimLoopError) -> TrimLoopError {
        let TrimLoopError::Open { next: 0, end, gap, .. } = error else { return error };
        let UvBox { min, max } = self.bounds();
        let slack = JOINT_TOLERANCE * (max - min);
        let across = Direction::BOTH.into_iter().find(|&along| {
            let beside = along.other();
            let off = gap[along].abs() - (max - min)[along];
            off.abs() <= slack[along] && gap[beside].abs() <= slack[beside]
        });
        let Some(direction) = across else { return error };
        let ends = [end + gap, end];
        let at = |point: DVec2, mut border: DVec2| {
            border[direction] = point[direction];
            border
        };
        let back = [min, max].map(|border| [at(ends[1], border), at(ends[0], border)]);
        TrimLoopError::Across { direction, ends, back }
    }

    /// The domain as a rectangle.
    pub fn bounds(&self) -> UvBox {
        UvBox::new(self.range[0], self.range[1])
    }
}
