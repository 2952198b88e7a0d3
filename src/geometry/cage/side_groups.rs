//! Sides of patches that lie on each other, in groups.

use std::cmp::Ordering;
use std::ops::Range;

use rayon::prelude::*;

use super::side::{Line, Side, SideNumber};

/// The sides of patches in groups: a leading one, and those that follow it. They are the longest
/// sides on each line, and among equally long ones exact ones, with the sides that lie within them.
/// Groups are in the order in which they are to be settled.
pub(super) struct Groups {
    /// The sides of all groups, one group after the other, the leader first.
    sides: Vec<SideNumber>,
    /// Where each group begins, and the last one ends.
    starts: Vec<u32>,
}

impl Groups {
    /// Forms groups of these sides.
    pub(super) fn of(numbers: Range<SideNumber>, side: impl Fn(SideNumber) -> Side + Sync) -> Self {
        let sorted = |number: SideNumber| {
            let Side { line, from, to, length, exact, .. } = side(number);
            Sorted { line, from, to, length, exact, number }
        };
        let mut sorted: Vec<Sorted> = numbers.into_par_iter().map(sorted).collect();
        sorted.par_sort_unstable_by(Sorted::order);

        // The group of each side, and for each group its rank and the number of its sides.
        let mut group_of: Vec<u32> = Vec::with_capacity(sorted.len());
        let mut groups: Vec<(f64, u32)> = Vec::new();
        // Leaders on a line with the bits of where they begin; for numbers from 0 on these are in
        // order.
        let mut leaders: Vec<(u64, usize, f64)> = Vec::new();
        for on_line in sorted.chunk_by(|a, b| a.line == b.line) {
            leaders.clear();
            for one in on_line {
                let from = one.from.to_bits();
                let after = leaders.partition_point(|leader| leader.0 <= from);
                let group = match after.checked_sub(1).map(|before| leaders[before]) {
                    Some((_, group, to)) if one.to <= to => group,
                    before => {
                        let group = groups.len();
                        match before {
                            Some((at, ..)) if at == from => {
                                leaders[after - 1] = (from, group, one.to)
                            }
                            _ => leaders.insert(after, (from, group, one.to)),
                        }
                        groups.push((side(one.number).rank, 0));
                        group
                    }
                };
                groups[group].1 += 1;
                group_of.push(group as u32);
            }
        }

        // High ranks first, equal ones as they came.
        let mut order: Vec<u32> = (0..groups.len() as u32).collect();
        order.par_sort_by(|&a, &b| groups[b as usize].0.total_cmp(&groups[a as usize].0));
        let mut starts = vec![0];
        let mut next = vec![0; groups.len()];
        let mut end = 0;
        for group in order {
            next[group as usize] = end;
            end += groups[group as usize].1;
            starts.push(end);
        }
        let mut sides = vec![0; sorted.len()];
        for (one, group) in sorted.iter().zip(group_of) {
            let place = &mut next[group as usize];
            sides[*place as usize] = one.number;
            *place += 1;
        }
        Self { sides, starts }
    }

    /// The groups, the leader of each first.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[SideNumber]> {
        self.starts.windows(2).map(|ends| &self.sides[ends[0] as usize..ends[1] as usize])
    }
}

/// What sides are sorted by.
#[derive(Clone, Copy, Debug)]
struct Sorted {
    line: Line,
    from: f64,
    to: f64,
    length: f64,
    number: SideNumber,
    exact: bool,
}

impl Sorted {
    /// By line, the longest first, and exact ones before others.
    fn order(&self, other: &Self) -> Ordering {
        let length = other.length.total_cmp(&self.length);
        let exact = other.exact.cmp(&self.exact);
        self.line.cmp(&other.line).then(length).then(exact).then(self.number.cmp(&other.number))
    }
}
