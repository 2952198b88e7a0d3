//! Boxes in which the ray touches the surface to within rounding.

use glam::DVec2;

use crate::patch::StRect;

/// A connected group of boxes that the ray passes within rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// The smallest rectangle around the group.
    pub(super) rect: StRect,
    /// The range along the ray.
    pub(super) z: [f64; 2],
    /// The boxes that hold its first and its last place along the ray.
    pub(super) ends: [StRect; 2],
    /// Whether every box lies at a side that is collapsed to a point.
    pub(super) collapsed: bool,
}

impl Contact {
    /// The contact of one box.
    pub(super) fn new(rect: StRect, z: [f64; 2], collapsed: bool) -> Self {
        Self { rect, z, ends: [rect; 2], collapsed }
    }

    /// The contact between two places on the ray.
    pub(super) fn between(from: (DVec2, f64), to: (DVec2, f64)) -> Self {
        let (low, high) = (from.0.min(to.0), from.0.max(to.0));
        let at = |st: DVec2| st.to_array().map(|x| [x; 2]);
        Self {
            rect: [[low.x, high.x], [low.y, high.y]],
            z: [from.1, to.1],
            ends: [at(from.0), at(to.0)],
            collapsed: false,
        }
    }

    /// The middles of the boxes at its ends.
    pub(super) fn places(&self) -> [DVec2; 2] {
        self.ends.map(|rect| DVec2::from_array(rect.map(|[from, to]| 0.5 * (from + to))))
    }

    /// Whether the rectangles touch, each widened by its own size and some roundings of parameters
    /// up to one.
    fn touches(&self, other: &Self) -> bool {
        (0..2).all(|k| {
            let ([a, b], [c, d]) = (self.rect[k], other.rect[k]);
            let reach = (b - a).max(d - c) + 16.0 * f64::EPSILON;
            a - reach <= d && c - reach <= b
        })
    }

    fn absorb(&mut self, other: &Self) {
        for k in 0..2 {
            self.rect[k] =
                [self.rect[k][0].min(other.rect[k][0]), self.rect[k][1].max(other.rect[k][1])];
        }
        if other.z[0] < self.z[0] {
            (self.z[0], self.ends[0]) = (other.z[0], other.ends[0]);
        }
        if other.z[1] > self.z[1] {
            (self.z[1], self.ends[1]) = (other.z[1], other.ends[1]);
        }
        self.collapsed &= other.collapsed;
    }
}

/// Adds a contact to a list in which no two touch.
pub(super) fn merge_into(contacts: &mut Vec<Contact>, mut new: Contact) {
    while let Some(k) = contacts.iter().position(|contact| contact.touches(&new)) {
        new.absorb(&contacts.swap_remove(k));
    }
    contacts.push(new);
}
