//! One ray of a stream, on its way through the boxes.

use crate::intersect::tree::nodes::ChildCode;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::box_ray::{BoxRay, Stack};
use crate::intersect::wide::hit_place::HitPlace;
use crate::intersect::wide::nearest::{Fate, keep};
use crate::intersect::wide::single::ray::{SingleHit, boxes_in};
use crate::intersect::wide::view::BvhView;
use crate::math::{Ray, RayFrame};
use crate::patch::ScaledFrame;

/// A ray on its way.
#[derive(Clone, Debug, Default)]
pub(super) struct Flight {
    pub boxes: BoxRay,
    /// The boxes still to be entered.
    pub stack: Stack,
    /// As in [`SingleRay`](crate::intersect::wide::single::ray::SingleRay).
    pub shift: f64,
    pub scale: f64,
    pub magnitude: f64,
    pub t_from_z: f64,
    /// The nearest hit so far, if there is one.
    pub met: bool,
    pub hit: SingleHit,
    /// Whether the ray is to be traced by itself from the beginning.
    pub alone: bool,
}

impl Flight {
    /// Puts the ray among those on their way, if there is anything more for it to enter.
    #[inline(always)]
    pub(super) fn go_on(&mut self, k: u32, walking: &mut Vec<(u32, ChildCode)>) {
        while let Some((entry, code)) = self.stack.pop() {
            if entry <= self.boxes.far {
                walking.push((k, code));
                return;
            }
        }
    }

    /// Goes on in other scaled coordinates. (Back in the first ones, they may be rounded
    /// differently from the first time, but in the same way for every such ray.)
    #[cold]
    pub(super) fn change_to(&mut self, scaled: &ScaledFrame, ray: &Ray) {
        let frame = RayFrame::new(ray);
        let end = if self.met { self.hit.place.z } else { frame.z_range[1] };
        (self.boxes, self.shift) = boxes_in(scaled, &frame, end);
        self.scale = scaled.scale;
    }

    /// Whether nothing more is asked for.
    #[inline(always)]
    pub(super) fn is_done(&self) -> bool {
        self.boxes.far == f32::NEG_INFINITY
    }

    /// Whether a hit is the nearest so far; if so, ends the ray there or, if any will do, at once.
    #[inline(always)]
    pub(super) fn takes(&mut self, view: &BvhView<'_>, hit: &HitPlace, wanted: Wanted) -> bool {
        match keep(hit, view, self.met.then_some(&self.hit.place)) {
            Fate::Nearer => {
                self.boxes.far = wanted.far(hit.z, self.shift, self.scale);
                self.met = true;
                if self.is_done() {
                    self.stack.clear();
                }
                return true;
            }
            Fate::Dropped => {}
            Fate::Undecided => self.alone = true,
        }
        false
    }
}
