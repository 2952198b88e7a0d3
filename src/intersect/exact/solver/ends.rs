//! From boxes to what is reported: the ends of stretches, contacts and roots.

use glam::{DMat2, DVec2};

use super::{AT_POLE, END, END_BUDGET, EndBox, ExactSolver, FINEST_SIDE, STRETCH};
use super::{halves, inner, linearised};
use crate::intersect::exact::contact::{self, Contact};
use crate::intersect::exact::problem::{End, Evidence, Found, Problem, Solution};
use crate::patch::{StRect, holds};

impl ExactSolver {
    /// Adds one contact that stands for all the spare boxes: from the first to the last place in
    /// them where the ray may meet the leaf.
    pub(super) fn search_ends(&mut self, problem: &Problem<'_>) {
        let (first, last) = (self.search_end(problem, 1.0), self.search_end(problem, -1.0));
        if let (Some(first), Some(last)) = (first, last) {
            contact::merge_into(&mut self.contacts, Contact::between(first, last));
        }
    }

    /// The two ends of a stretch, within the boxes known to hold them.
    fn ends_of(&mut self, problem: &Problem<'_>, contact: &Contact) -> [DVec2; 2] {
        let mut places = contact.places();
        for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
            self.spare.clear();
            self.spare.push(contact.ends[k]);
            if let Some((place, _)) = self.search_end(problem, sign) {
                places[k] = place;
            }
        }
        places.map(|x| settled(problem, inner(problem.rect, x)))
    }

    /// The first place (for `sign` 1, the last for −1) where the ray may meet the spare
    /// boxes: the nearest box, in which it may lie, is always divided next.
    fn search_end(&mut self, problem: &Problem<'_>, sign: f64) -> Option<(DVec2, f64)> {
        let mut queue = std::mem::take(&mut self.queue);
        queue.clear();
        for k in 0..self.spare.len() {
            self.consider(problem, self.spare[k], sign, &mut queue);
        }
        let mut end = None;
        for _ in 0..END_BUDGET {
            let nearest = (0..queue.len()).min_by(|&a, &b| queue[a].z.total_cmp(&queue[b].z));
            let Some(nearest) = nearest else { break };
            let EndBox { rect, z, short, axis } = queue.swap_remove(nearest);
            end = Some((DVec2::from_array(rect.map(|[from, to]| 0.5 * (from + to))), sign * z));
            if short {
                break;
            }
            for part in halves(rect, axis, 0.0) {
                self.boxes += 1;
                self.consider(problem, part, sign, &mut queue);
            }
            if queue.is_empty() {
                end = None; // nothing was there after all
            }
        }
        self.queue = queue;
        end
    }

    /// The direction across which to halve the box just looked at in the search for an end. At a
    /// collapsed side it is the one that leads away from the side: halves across the other
    /// direction would both contain the pole.
    fn end_axis(&self, problem: &Problem<'_>, rect: StRect, exhausted: [bool; 2]) -> usize {
        let spread = self.net.spread();
        let wanted = match problem.collapsed.filter(|_| self.at_collapsed_side(problem, rect)) {
            Some(side) => side.fixed() as usize,
            None => usize::from(spread.y > spread.x),
        };
        if exhausted[wanted] { 1 - wanted } else { wanted }
    }

    fn consider(
        &mut self,
        problem: &Problem<'_>,
        rect: StRect,
        sign: f64,
        queue: &mut Vec<EndBox>,
    ) {
        self.net.restrict_from(&self.whole, rect);
        let bounds = self.net.bounds();
        if self.is_empty(problem, rect, &bounds) {
            return;
        }
        let exhausted = rect.map(|[from, to]| to - from <= FINEST_SIDE);
        let finest = (2.0 * problem.error).max(END * self.size);
        queue.push(EndBox {
            rect,
            z: if sign > 0.0 { bounds.z.lo } else { -bounds.z.hi },
            short: bounds.z.hi - bounds.z.lo <= finest || exhausted == [true; 2],
            axis: self.end_axis(problem, rect, exhausted),
        });
    }

    /// Turns isolated roots and contacts into what is found; a root found in two overlapping
    /// boxes is reported once, and a contact that holds a proved root is that root.
    pub(super) fn report(&mut self, problem: &Problem<'_>, found: &mut Vec<Found>) {
        let first = found.len();
        for &solution in &self.isolated {
            let Evidence::Isolated(rect) = solution.evidence else { continue };
            // One root found twice lies in both boxes. Of two roots near each other, rounding may
            // put one into the other's box.
            let mut others = found[first..].iter().flat_map(Found::solutions);
            let known = others.any(|other| match other.evidence {
                Evidence::Isolated(its) => holds(rect, other.st) && holds(its, solution.st),
                _ => false,
            });
            if !known {
                found.push(Found::Place(solution));
            }
        }
        let contacts = std::mem::take(&mut self.contacts);
        for contact in &contacts {
            let [[s0, s1], [t0, t1]] = contact.rect;
            let corners = [[s0, t0], [s1, t1]].map(|x| inner(problem.rect, x.into()));
            let proved = self.isolated.iter().any(|root| match root.evidence {
                Evidence::Isolated(rect) => corners.iter().all(|&st| holds(rect, st)),
                _ => false,
            });
            if proved {
                continue; // the box's only root, seen again from its edge: all of it lies in the box
            }
            if contact.z[1] - contact.z[0] > STRETCH * self.size {
                let (places, z) = (self.ends_of(problem, contact), contact.z);
                found.push(Found::Stretch(End::BOTH.map(|end| Solution {
                    st: places[end as usize],
                    evidence: Evidence::Stretch { z, end },
                })));
                continue;
            }
            let ends = contact.places().map(|x| inner(problem.rect, x));
            let middle = 0.5 * (ends[0] + ends[1]);
            // Boxes at a pole may hold, to within rounding, only a line through it: the ray may
            // pass that line away from the pole.
            let side = problem.collapsed.filter(|_| contact.collapsed);
            let pole = side.map(|side| side.beside(middle));
            let pole =
                pole.filter(|&st| linearised(problem, st).1.length() <= AT_POLE * problem.error);
            found.push(Found::Place(match pole {
                Some(st) => Solution { st, evidence: Evidence::Collapsed },
                None => Solution {
                    st: settled(problem, middle),
                    evidence: Evidence::Contact(contact.z),
                },
            }));
        }
        self.contacts = contacts;
    }
}

/// This part of their trace is added to the diagonal of the normal equations: a direction counts
/// where it moves the point by more than the root of this, 1e-5, of what the other direction does.
const DAMPING: f64 = 1e-10;

/// A place near `st`, within the problem's rectangle, where the surface is closest to the ray
/// across the direction in which it does not touch: at a tangency the Jacobian has rank
/// one, and only that part of the distance can be removed. Least squares, damped by what
/// rounding leaves of the other direction (Levenberg 1944).
fn settled(problem: &Problem<'_>, st: DVec2) -> DVec2 {
    let (low, high) = (
        DVec2::new(problem.rect[0][0], problem.rect[1][0]),
        DVec2::new(problem.rect[0][1], problem.rect[1][1]),
    );
    let mut best = (f64::INFINITY, st);
    let mut st = st;
    for _ in 0..4 {
        let (jacobian, at) = linearised(problem, st);
        let better = at.length() < best.0; // false for NaN
        if !better {
            break;
        }
        best = (at.length(), st);
        let normal = jacobian.transpose() * jacobian;
        let damping = DAMPING * (normal.x_axis.x + normal.y_axis.y);
        let damped = normal + DMat2::from_diagonal(DVec2::splat(damping));
        let step = damped.inverse() * (jacobian.transpose() * at);
        if !step.is_finite() {
            break;
        }
        st = (st - step).clamp(low, high);
    }
    best.1
}
