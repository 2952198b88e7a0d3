//! The trims as seen through a small window: what a point there is compared with.
//!
//! Most places that a tracer asks about lie in leaves that one or two curves pass through. For such
//! a rectangle, the *window*, a few numbers a curve tell which side of it a point is on, many
//! points at a time. Where they do not tell, [`Trims::side_within`] does.
//!
//! # Why it is certain
//! Whether a point is kept is the parity of the number of times a ray from it towards larger u
//! crosses the loops; with [`Kept::Even`](super::Kept) the opposite. Each monotone segment of a
//! loop has at most one stretch in the window; all other parts of the loops stay outside.
//! (Stretches end a little farther out than the window reaches, so that rounding of points on them
//! does not count.)
//!
//! - A stretch rises in v from one end to the other, so the ray crosses it if its level is between
//!   the ends and the point is on the left. The stretch lies in the rectangle of its ends, and in
//!   a [band](super::window_curve) along its chord. A point that lies outside of either by more than
//!   it may be off is on the same side as it seems to be; else nothing is decided. Stretches that
//!   join inside the window, and go on in the same direction, count as one: a *chain*.
//! - The ray crosses the parts outside as often, up to an even number, as that from any other point
//!   of the same level in the window, because moving the point does not cross them. With the level,
//!   that number changes only where such a part ends, right of the window: at the end of a stretch.
//!   Such an [*exit*](WindowCurve::exit) is another thing that is crossed by rays below it. Where
//!   two stretches join there, no such part ends, and their two exits cancel each other.
//! - What is left does not depend on the point. One point that the loops themselves have decided
//!   gives it; it is kept as something that every ray crosses.
//!
//! The level of an end is the same number in all that begins or ends there. Rounding it changes no
//! parity: a point that is decided, and about at that level, is left of everything that begins or
//! ends there, or right of it all, because the end itself is not within reach of the point.

use glam::DVec2;

use super::window_curve::{Stretch, WindowCurve};
use super::{Side, Trims, UvBox};

/// The window reaches a little beyond the square from −1 to 1.
pub(crate) const WINDOW_REACH: f64 = 1.0625;

/// Curves are followed a little farther, so that they end outside the window.
const CUT_OFF_AT: f64 = 1.125;

/// How far points and curves may be off in the coordinates of the window, in each of them: half of
/// it because of rounding in f64, the rest because ends of curves are rounded to f32.
pub(crate) const WINDOW_SPARE: f64 = 1e-6;
const SPARE_OF_F64: f64 = 0.5 * WINDOW_SPARE;
const _: () = assert!(SPARE_OF_F64 + CUT_OFF_AT * (0.5 * f32::EPSILON as f64) < WINDOW_SPARE);

/// With more curves than this, descending the hierarchy of all curves takes less time.
const MOST_CURVES: usize = 24;

/// The most stretches that are looked at to make so many curves of them.
const MOST_STRETCHES: usize = 16 * MOST_CURVES;

/// Stretches become a chain if its band is no wider than this, in the window's coordinates: few
/// places fall into it.
const THIN: f32 = 1.0 / 32.0;

/// Whether trims keep a point seen through a window, in coordinates from −1 to 1, if it may be off
/// by `reach`; `None` where the loops themselves must decide.
pub(crate) fn is_kept(window: &[WindowCurve], point: DVec2, reach: DVec2) -> Option<bool> {
    let reach = reach + WINDOW_SPARE;
    let is_seen = (point.abs() + reach).cmple(DVec2::splat(WINDOW_REACH)).all(); // false for NaN
    if is_seen && !window.is_empty() { parity(window, point, reach) } else { None }
}

/// Whether a ray from a point towards larger u crosses an odd number of curves.
fn parity(window: &[WindowCurve], point: DVec2, reach: DVec2) -> Option<bool> {
    let mut crossed = window.iter().map(|curve| curve.is_crossed(point, reach));
    crossed.try_fold(false, |is_odd, is_crossed| Some(is_odd ^ is_crossed?))
}

/// Where a segment runs through a window: its index, and a range of its parameter.
type Within = (usize, [f64; 2]);

impl Trims {
    /// What there is to cross within a rectangle, whose coordinates are taken to run from −1 to 1,
    /// and slightly beyond it.
    ///
    /// Nothing if there is too much, or if `rounding`, by which parameters may be off, or the error
    /// of the curves is too large for it.
    pub(crate) fn window(&self, square: &UvBox, rounding: DVec2) -> Vec<WindowCurve> {
        let (center, half) = (square.center(), 0.5 * square.size());
        let most_off = SPARE_OF_F64 * half - rounding;
        if !most_off.cmpge(DVec2::ZERO).all() {
            return Vec::new(); // also for NaN
        }
        let Some(within) = self.segments_within(&UvBox::about(center, CUT_OFF_AT * half), most_off)
        else {
            return Vec::new();
        };
        let stretch =
            |&(index, range): &Within| self.segments[index].stretch_in(range, center, half);
        let stretches: Vec<Stretch> = within.iter().map(stretch).collect();

        let (mut window, mut first) = (Vec::new(), 0);
        for next in 1..=within.len() {
            if next < within.len() && self.goes_on(within[next - 1], within[next]) {
                continue;
            }
            let mut chain = stretches[first..next].to_vec();
            if !self.segments[within[first].0].is_forward() {
                chain.reverse();
            }
            add_chains(&chain, &mut window);
            first = next;
        }
        if window.len() > MOST_CURVES {
            return Vec::new();
        }
        let is_exit = |end: &DVec2| end.x > WINDOW_REACH && end.y.abs() <= WINDOW_REACH;
        let ends = stretches.iter().flat_map(|stretch| stretch.ends).filter(is_exit);
        let mut exits: Vec<f64> = ends.map(|end| end.y).collect();
        exits.sort_by(f64::total_cmp);
        // Where two curves join beyond the window, nothing ends.
        let unpaired = exits.chunk_by(f64::eq).filter(|alike| alike.len() % 2 == 1);
        window.extend(unpaired.map(|alike| WindowCurve::exit(alike[0])));
        self.adjusted(window, |point| center + half * point)
    }

    /// The segments that run through a rectangle, in their own order; `None` if they are too many,
    /// or if twice the error bound of one of them is more than `most_off`.
    fn segments_within(&self, seen: &UvBox, most_off: DVec2) -> Option<Vec<Within>> {
        let mut within = Vec::new();
        let is_unusable = self.tree.any(seen, |index| {
            let segment = &self.segments[index];
            within.extend(segment.stretch_within(seen).map(|range| (index, range)));
            let is_exact = (2.0 * segment.reach()).cmple(most_off).all(); // false for NaN
            within.len() > MOST_STRETCHES || !is_exact
        });
        within.sort_unstable_by_key(|(index, _)| *index);
        (!is_unusable).then_some(within)
    }

    /// Whether a stretch is the continuation of the one before, along the loop, and runs in the same
    /// direction in u and in v.
    fn goes_on(&self, before: Within, after: Within) -> bool {
        let ((first, [from, to]), (second, [next_from, next_to])) = (before, after);
        let [one, other] = [first, second].map(|index| &self.segments[index]);
        let meet_at_joint = if one.is_forward() {
            to == 1.0 && next_from == 0.0
        } else {
            from == 0.0 && next_to == 1.0
        };
        let ([start, joint], [same, end]) = (one.directed_ends(), other.directed_ends());
        let (step, next) = (joint - start, end - same);
        second == first + 1
            && meet_at_joint
            && joint == same
            && step.y * next.y > 0.0
            && [0.0 < step.x, step.x < 0.0] == [0.0 < next.x, next.x < 0.0]
    }

    /// The window with what every ray crosses, if that is needed; `uv` gives the parameters of a
    /// point.
    fn adjusted(
        &self,
        mut window: Vec<WindowCurve>,
        uv: impl Fn(DVec2) -> DVec2,
    ) -> Vec<WindowCurve> {
        const PLACES: [f64; 5] = [0.0, -0.5, 0.5, -0.9, 0.9];
        let grid = PLACES.iter().flat_map(|&y| PLACES.iter().map(move |&x| DVec2::new(x, y)));
        let decided = grid.into_iter().find_map(|point| {
            let is_inside = match self.side_of(uv(point)) {
                Side::Inside => true,
                Side::Outside => false,
                Side::Edge { .. } => return None,
            };
            Some(is_inside != parity(&window, point, DVec2::splat(WINDOW_SPARE))?)
        });
        match decided {
            Some(differs) => window.extend(differs.then(|| WindowCurve::exit(f64::INFINITY))),
            None => window.clear(),
        }
        window
    }
}

/// Adds stretches that go on in one direction, in order of v: as one chain if it is thin, else in
/// halves.
fn add_chains(stretches: &[Stretch], window: &mut Vec<WindowCurve>) {
    let chain = WindowCurve::chain(stretches);
    if chain.width() <= THIN || stretches.len() == 1 {
        window.push(chain);
        return;
    }
    let (first, second) = stretches.split_at(stretches.len() / 2);
    add_chains(first, window);
    add_chains(second, window);
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Random, letter, smooth, trims, wide};
    use super::super::{Kept, TrimCurve, TrimLoop};
    use super::*;

    /// Compares what is seen through random windows, and the exact answers; returns how many of the
    /// points the windows told about, and how many there were in windows that could be used.
    fn compared(trims: &Trims, random: &mut Random, around: f64) -> [u32; 2] {
        let mut counts = [0; 2];
        let joints: Vec<DVec2> = trims.joints().collect();
        for k in 0..400 {
            let mut signed = || 2.0 * random.next() - 1.0;
            let mut center = around * DVec2::new(signed(), signed());
            let half = 0.5 * around * DVec2::new(signed(), signed()).abs().powf(3.0);
            if k % 2 == 0 {
                // A joint near or beyond a side of the window.
                let place = DVec2::new(signed(), signed()) * 1.2;
                center = joints[k % joints.len()] + place * half;
            }
            let window = trims.window(&UvBox::about(center, half), DVec2::splat(1e-16));
            for _ in 0..100 {
                let mut point = 1.05 * DVec2::new(signed(), signed());
                if let [curve, ..] = window[..] {
                    // At the level of an end, or beside it.
                    point.y = if signed() < -0.8 { f64::from(curve.y[1]) } else { point.y };
                    point.x = if signed() < -0.8 { f64::from(curve.x[0]) } else { point.x };
                }
                let reach = DVec2::splat(if signed() < 0.0 { 0.0 } else { 1e-3 });
                let seen = is_kept(&window, point, reach);
                let exact = trims.side_within(center + half * point, reach * half);
                match (seen, exact) {
                    (Some(true), Side::Inside) | (Some(false), Side::Outside) | (None, _) => {}
                    wrong => panic!("{wrong:?} at {point} of {half} about {center}: {window:?}"),
                }
                counts[0] += u32::from(seen.is_some());
                counts[1] += u32::from(!window.is_empty() && point.abs().max_element() < 1.05);
            }
        }
        counts
    }

    #[test]
    fn windows_show_what_the_loops_say() {
        let mut random = Random::new(14);
        let mut all = vec![trims(&letter())];
        for kept in [Kept::Odd, Kept::Even] {
            let circles = [(0.0, 1.0), (0.1, 0.5), (0.3, 0.2)];
            let circles = circles.map(|(u, r)| TrimLoop::circle(DVec2::new(u, 0.0), r).unwrap());
            all.push(Trims::new(wide(), kept, &circles).unwrap());
        }
        for degree in [1, 2, 3, 5, 7, 12] {
            let curve = smooth(&mut random, degree, 9 + degree);
            all.push(trims(&[TrimLoop::new(&[TrimCurve::nurbs(&curve).unwrap()]).unwrap()]));
        }
        for (k, trims) in all.iter().enumerate() {
            let around = if k == 0 { 9.0 } else { 1.5 };
            let [told, points] = compared(trims, &mut random, around);
            assert!(points > 20_000 && f64::from(told) > 0.9 * f64::from(points), "{k}: {told}");
        }
    }

    #[test]
    fn points_near_an_edge_are_left_to_the_loops() {
        let circle = trims(&[TrimLoop::circle(DVec2::ZERO, 1.0).unwrap()]);
        let window = circle.window(&UvBox::new([0.9, 1.1], [-0.1, 0.1]), DVec2::ZERO);
        let told = |off: f64, reach: f64| {
            let point = DVec2::new((1.0 + off - 1.0) * 10.0, 0.0);
            is_kept(&window, point, DVec2::splat(10.0 * reach))
        };
        assert_eq!([told(-1e-3, 0.0), told(1e-3, 0.0)], [Some(true), Some(false)]);
        assert_eq!([told(-1e-3, 2e-3), told(1e-3, 2e-3)], [None, None]);
        assert_eq!([told(0.0, 0.0), told(1e-9, 0.0)], [None, None]);
        assert_eq!([told(f64::NAN, 0.0), told(1e-3, f64::NAN)], [None, None]);
        assert_eq!([told(1e-3, f64::INFINITY), told(0.11, 0.0)], [None, None]);
    }

    #[test]
    fn windows_in_which_f64_is_too_coarse_are_not_used() {
        let circle = trims(&[TrimLoop::circle(DVec2::ZERO, 1.0).unwrap()]);
        let about = |half: f64| UvBox::about(DVec2::X, DVec2::splat(half));
        assert!(!circle.window(&about(1e-6), DVec2::ZERO).is_empty());
        assert!(circle.window(&about(1e-9), DVec2::ZERO).is_empty());
        assert!(circle.window(&about(1e-6), DVec2::splat(1e-12)).is_empty());
        assert!(circle.window(&about(0.0), DVec2::ZERO).is_empty());
        // Nor if no curve is near.
        let inside = UvBox::about(DVec2::ZERO, DVec2::splat(1e-6));
        assert!(!circle.window(&inside, DVec2::ZERO).is_empty());
        assert!(circle.window(&inside, DVec2::splat(1e-6)).is_empty());
    }
}
