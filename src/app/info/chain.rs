//! The intervals of a polyline in a hierarchy of boxes: consecutive ones are near each other.

use glam::DVec3;
use nurbray::math::Aabb;

/// The number of intervals in a box of the lowest level, and of boxes in one of the level above.
const TOGETHER: usize = 4;

/// Boxes around the intervals of a polyline.
#[derive(Debug)]
pub(super) struct Chain {
    /// The number of intervals.
    count: usize,
    /// Box k of the lowest level, the first, is around intervals `4 k … 4 k + 3`; box k of another
    /// level is around boxes `4 k … 4 k + 3` of the one below. The last level has one box.
    levels: Vec<Vec<Aabb>>,
}

impl Chain {
    /// The hierarchy of a polyline of two points at least, with boxes that are `margin` larger than
    /// its own on every side, along each axis.
    pub(super) fn new(points: &[DVec3], margin: DVec3) -> Self {
        let count = points.len() - 1;
        let around = |k: usize| {
            let end = ((k + 1) * TOGETHER).min(count);
            let Aabb { min, max } = Aabb::around(points[k * TOGETHER..=end].iter().copied());
            Aabb { min: min - margin, max: max + margin }
        };
        let mut levels = vec![(0..count.div_ceil(TOGETHER)).map(around).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            let united = |boxes: &[Aabb]| boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
            levels.push(below.chunks(TOGETHER).map(united).collect());
        }
        Self { count, levels }
    }

    /// The boxes of the lowest level, each around a few intervals.
    pub(super) fn boxes(&self) -> &[Aabb] {
        &self.levels[0]
    }

    /// The interval nearest to a point, the first of equally near ones, if one is within `reach` of
    /// it; `distance` is that from an interval.
    pub(super) fn nearest(
        &self,
        point: DVec3,
        reach: f64,
        distance: impl Fn(usize) -> f64,
    ) -> Option<usize> {
        let mut best: (f64, Option<usize>) = (reach, None);
        let mut waiting = vec![(self.levels.len() - 1, 0)];
        while let Some((level, k)) = waiting.pop() {
            let off = point - point.clamp(self.levels[level][k].min, self.levels[level][k].max);
            if off.length() > best.0 {
                continue;
            }
            let Some(below) = level.checked_sub(1) else {
                for interval in self.below(level, k) {
                    let here = distance(interval);
                    if here < best.0 || (here == best.0 && best.1.is_none_or(|it| interval < it)) {
                        best = (here, Some(interval));
                    }
                }
                continue;
            };
            waiting.extend(self.below(level, k).map(|k| (below, k)));
        }
        best.1
    }

    /// The intervals in boxes of the lowest level that meet one of another chain, grown by `reach`:
    /// all that may be within `reach` of it.
    pub(super) fn beside(&self, other: &Self, reach: f64) -> Vec<usize> {
        let mut found = Vec::new();
        let mut waiting = vec![(self.levels.len() - 1, 0)];
        while let Some((level, k)) = waiting.pop() {
            if !other.meets(&self.levels[level][k].grown(reach)) {
                continue;
            }
            match level.checked_sub(1) {
                None => found.extend(self.below(level, k)),
                Some(below) => waiting.extend(self.below(level, k).rev().map(|k| (below, k))),
            }
        }
        found
    }

    /// Whether a box meets one of the lowest level.
    fn meets(&self, target: &Aabb) -> bool {
        let mut waiting = vec![(self.levels.len() - 1, 0)];
        while let Some((level, k)) = waiting.pop() {
            let Aabb { min, max } = self.levels[level][k];
            if !(min.cmple(target.max).all() && target.min.cmple(max).all()) {
                continue;
            }
            let Some(below) = level.checked_sub(1) else { return true };
            waiting.extend(self.below(level, k).map(|k| (below, k)));
        }
        false
    }

    /// What box k of a level is around: intervals, or boxes of the level below.
    fn below(&self, level: usize, k: usize) -> std::ops::Range<usize> {
        let all = if level == 0 { self.count } else { self.levels[level - 1].len() };
        k * TOGETHER..((k + 1) * TOGETHER).min(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn helix(turns: f64, radius: f64) -> Vec<DVec3> {
        let at = |k: u32| {
            let angle = std::f64::consts::TAU * turns * f64::from(k) / 500.0;
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.01 * angle)
        };
        (0..=500).map(at).collect()
    }

    #[test]
    fn the_nearest_interval_and_all_that_are_near_another_chain() {
        let (points, others) = (helix(7.0, 1.0), helix(7.0, 1.05));
        let [chain, other] = [&points, &others].map(|points| Chain::new(points, DVec3::ZERO));
        let middle = |points: &[DVec3], k: usize| 0.5 * (points[k] + points[k + 1]);
        for (n, reach) in [(3usize, 0.1), (77, 0.4), (200, 1.0), (499, 9.0)] {
            let point = 1.1 * middle(&others, n) + DVec3::new(0.01, 0.02, 0.03);
            let distance = |k: usize| middle(&points, k).distance(point);
            let by_looking = (0..500).filter(|&k| distance(k) <= reach);
            let by_looking = by_looking.min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
            // Boxes hold the intervals, and so their middles.
            assert_eq!(chain.nearest(point, reach, distance), by_looking, "{n}");
        }
        assert_eq!(chain.beside(&other, 0.06).len(), 500);
        let far: Vec<DVec3> = points.iter().map(|p| *p + 9.0 * DVec3::X).collect();
        assert!(chain.beside(&Chain::new(&far, DVec3::ZERO), 0.06).is_empty());
        // Six of seven turns farther along the axis, the last turn is beside the first.
        let turns = 0.06 * std::f64::consts::TAU * DVec3::Z;
        let shifted: Vec<DVec3> = points.iter().map(|p| *p + turns).collect();
        let near = chain.beside(&Chain::new(&shifted, DVec3::ZERO), 0.01);
        assert!((71..100).contains(&near.len()) && near[near.len() - 1] == 499, "{near:?}");
        assert!(near.is_sorted());
    }
}
