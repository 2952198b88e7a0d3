//! The Bézier pieces of a loop.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::curve::euclidean;
use crate::math::bernstein::restrict;

/// A Bézier piece of a loop.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LoopPiece {
    /// Where the piece begins and ends, equal bit for bit to the adjoining ends of its neighbours.
    pub(super) ends: [DVec2; 2],
    /// Its homogeneous control points; the outer ones equal the ends up to a rounding error.
    pub(super) control: Vec<DVec3>,
}

impl LoopPiece {
    /// The straight line between two points.
    pub(super) fn line(ends: [DVec2; 2]) -> Self {
        Self { ends, control: ends.map(|end| end.extend(1.0)).into() }
    }

    /// The piece run backwards.
    pub(super) fn reversed(&self) -> Self {
        let [from, to] = self.ends;
        Self { ends: [to, from], control: self.control.iter().rev().copied().collect() }
    }

    pub(super) fn hull(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.control.iter().map(|&c| euclidean(c)).chain(self.ends)
    }

    /// Moves the beginning (0) or the end (1) of the piece, together with the control point there.
    pub(super) fn move_end(&mut self, which: usize, to: DVec2) {
        if self.ends[which] == to {
            return;
        }
        self.ends[which] = to;
        let index = which * (self.control.len() - 1);
        let weight = self.control[index].z;
        self.control[index] = (weight * to).extend(weight);
    }

    /// Whether the piece is a straight line by its degree, which is 1.
    pub(super) fn is_line(&self) -> bool {
        self.control.len() == 2
    }

    /// The point at a parameter, and the derivative there.
    pub(super) fn at(&self, t: f64) -> [DVec2; 2] {
        let mut control = self.control.clone();
        let degree = control.len() - 1;
        for last in (1..degree).rev() {
            for k in 0..=last {
                control[k] = (1.0 - t) * control[k] + t * control[k + 1];
            }
        }
        let (from, to) = (control[0], control[1]);
        let place = (1.0 - t) * from + t * to;
        let (along, point) = (degree as f64 * (to - from), euclidean(place));
        [point, (along.xy() - along.z * point) / place.z]
    }

    /// The piece between two parameters, which may lie outside `[0, 1]`.
    pub(super) fn restricted(&self, from: f64, to: f64) -> Self {
        if [from, to] == [0.0, 1.0] {
            return self.clone();
        }
        let mut control = self.control.clone();
        restrict(&mut control, from, to);
        for k in 0..2 {
            if let Some(value) = self.constant(k) {
                control.iter_mut().for_each(|c| c[k] = c.z * value);
            }
        }
        let mut ends = [control[0], control[control.len() - 1]].map(euclidean);
        if from == 0.0 {
            ends[0] = self.ends[0];
        }
        if to == 1.0 {
            ends[1] = self.ends[1];
        }
        Self { ends, control }
    }

    /// The value of a coordinate that is the same all along the piece.
    pub(super) fn constant(&self, k: usize) -> Option<f64> {
        let value = self.ends[0][k];
        self.hull().all(|point| point[k] == value).then_some(value)
    }
}
