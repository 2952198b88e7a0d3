//! The order in which boxes are looked at in the search for the end of a stretch.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::patch::StRect;

/// A box that may hold the end of a stretch.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndBox {
    pub rect: StRect,
    /// Where the box begins along the ray; if the last place is searched for, minus where it ends.
    pub z: f64,
    /// Whether the box is too short for a division to tell more.
    pub short: bool,
    /// Across which direction to halve it.
    pub axis: usize,
}

/// Boxes, of which the nearest is taken first.
///
/// Of boxes that begin at one `z`, as the halves of a box cut along the ray do, the one in the
/// first slot is taken; its slot goes to the box in the last one, which came late. So such boxes
/// are not all divided in turn before the first of them is short.
#[derive(Debug, Default)]
pub(super) struct EndQueue {
    slots: Vec<EndBox>,
    /// One for each box, and some of boxes that have left their slots since.
    order: BinaryHeap<Nearest>,
}

impl EndQueue {
    pub(super) fn clear(&mut self) {
        self.slots.clear();
        self.order.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    pub(super) fn push(&mut self, end_box: EndBox) {
        self.order.push(Nearest { z: end_box.z, slot: self.slots.len() });
        self.slots.push(end_box);
    }

    /// Takes out the nearest box.
    pub(super) fn pop(&mut self) -> Option<EndBox> {
        while let Some(Nearest { z, slot }) = self.order.pop() {
            let is_there = self.slots.get(slot).is_some_and(|at| at.z.total_cmp(&z).is_eq());
            if !is_there {
                continue;
            }
            let nearest = self.slots.swap_remove(slot);
            if let Some(moved) = self.slots.get(slot) {
                self.order.push(Nearest { z: moved.z, slot });
            }
            return Some(nearest);
        }
        None
    }
}

/// That a box which begins at `z` is in this slot; greater where the box is to be taken earlier.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    z: f64,
    slot: usize,
}

impl Ord for Nearest {
    fn cmp(&self, other: &Self) -> Ordering {
        other.z.total_cmp(&self.z).then(other.slot.cmp(&self.slot))
    }
}

impl PartialOrd for Nearest {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Nearest {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Nearest {}

#[cfg(test)]
mod tests {
    use super::*;

    /// With many boxes at one `z`, and numbers that are none.
    #[test]
    fn the_order_is_that_of_the_first_least_slot() {
        let mut state = 1_u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) % below
        };
        let (mut queue, mut slots) = (EndQueue::default(), Vec::new());
        for k in 0..2000 {
            for part in 0..random(4) {
                let z = [-1.0, -0.0, 0.0, 0.5, f64::NAN][random(5) as usize];
                let rect = [[f64::from(k), part as f64]; 2];
                let end_box = EndBox { rect, z, short: false, axis: 0 };
                queue.push(end_box);
                slots.push(end_box);
            }
            let least = (0..slots.len()).min_by(|&a, &b| slots[a].z.total_cmp(&slots[b].z));
            let expected = least.map(|slot| slots.swap_remove(slot).rect);
            assert_eq!(queue.pop().map(|found| found.rect), expected, "step {k}");
            assert_eq!(queue.is_empty(), slots.is_empty(), "step {k}");
        }
        queue.clear();
        assert!(queue.is_empty() && queue.pop().is_none());
    }
}
