//! The root that a ray starts on, if any, and the leaves that need not be searched because of it.

use fearless_simd::{Simd, SimdBase, f32x16};
use fearless_simd_macros::simd;
use glam::DVec3;

use super::proof::departure::{Departure, Final, MAY_START};
use super::reach::WIDENED_F32;
use super::view::Fitted;
use crate::intersect::Root;
use crate::math::rounding;
use crate::patch::{Leaf, TensorPatch};

/// The line that a ray lies on: a point, and a unit vector in f32. Most rays do not start on the
/// leaf, and need no copies of them.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) origin: &'a DVec3,
    pub(super) axis: &'a [f32; 3],
}

/// A ray's start.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Start<'a> {
    /// The root that the ray starts on, if any.
    pub(super) from: Option<&'a Root>,
    /// Whether hits count only ahead of the origin.
    pub(super) ahead: bool,
}

impl Start<'_> {
    /// The ray's start in a leaf's box coordinates, if it lies on the leaf's piece.
    #[inline(always)]
    pub(crate) fn place_in(&self, leaf: &Leaf) -> Option<[f32; 2]> {
        let root = self.from.filter(|root| root.piece == leaf.piece)?;
        Some(leaf.box_coordinates(root.st).as_vec2().to_array())
    }

    /// Whether the ray starts on a leaf and is known not to meet it again. `certified` says whether
    /// the leaf's certificate holds for the ray, `error` is the error bound of a point's distance
    /// from it.
    #[inline(always)]
    pub(super) fn is_done_with<S: Simd>(
        &self,
        simd: S,
        fitted: Fitted<'_>,
        patch: &TensorPatch,
        line: Line<'_>,
        certified: bool,
        error: f64,
    ) -> bool {
        if certified {
            self.is_root_of(fitted.leaf)
        } else {
            self.departs_from(simd, fitted, patch, line, error)
        }
    }

    /// Whether the ray starts on the one root it has with a leaf that is certified for it.
    #[inline(always)]
    fn is_root_of(&self, leaf: &Leaf) -> bool {
        self.place_in(leaf).is_some_and(|[x, y]| x.abs().max(y.abs()) <= WIDENED_F32)
    }

    /// Whether the ray starts on a leaf, or near it on its piece, and is proved not to have that
    /// leaf ahead of it again; `error` is the error bound of a point's distance from the ray.
    #[simd]
    fn departs_from<S: Simd>(
        &self,
        simd: S,
        fitted: Fitted<'_>,
        patch: &TensorPatch,
        line: Line<'_>,
        error: f64,
    ) -> bool {
        let leaf = fitted.leaf;
        let (Some(root), Some(place)) = (self.from, self.place_in(leaf)) else { return false };
        let nearby = place[0].abs().max(place[1].abs()) <= MAY_START;
        if !(nearby && self.ahead) {
            return false;
        }
        let [x, y, z] = (*line.origin - leaf.middle).as_vec3().to_array();
        let [dx, dy, dz] = *line.axis;
        let reach = root.error + error;
        let departure = Departure {
            place: [f32x16::splat(simd, place[0]), f32x16::splat(simd, place[1])],
            origin: [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)],
            axis: [f32x16::splat(simd, dx), f32x16::splat(simd, dy), f32x16::splat(simd, dz)],
            reach: f32x16::splat(simd, rounding::f32_above(reach)),
        };
        let Final { surely, if_near } = departure.is_final(simd, fitted);
        let near = || patch.point(root.st).distance(*line.origin) <= reach;
        surely & 1 != 0 || (if_near & 1 != 0 && near())
    }
}
