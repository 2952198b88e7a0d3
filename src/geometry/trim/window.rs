//! The trims as seen through a small window: what a point there is compared with.
//!
//! Most places that a tracer asks about lie in leaves that one or two curves pass through. For such
//! a rectangle, the *window*, a few numbers a curve tell which side of it a point is on, many
//! points at a time. Where they do not tell, [`Trims::contains_within`] does.
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
//!   the band of its control points along its chord. A point that lies outside of either by more
//!   than it may be off is on the same side as it seems to be; else nothing is decided.
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

/// Something that rays through a window may cross: a stretch of a trim curve, or what stands for
/// curves outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WindowCurve {
    /// A vector across the chord, towards smaller u; the sum of its absolute values is 1.
    pub(crate) across: [f32; 2],
    /// The stretch lies where the product of `across` and a point is between these.
    pub(crate) band: [f32; 2],
    /// The smallest and the largest u.
    pub(crate) x: [f32; 2],
    /// The smallest and the largest v.
    pub(crate) y: [f32; 2],
}

impl WindowCurve {
    /// What all rays from points below a level cross.
    fn exit(level: f64) -> Self {
        const FAR: f32 = 4.0;
        Self { across: [0.0; 2], band: [0.0; 2], x: [FAR; 2], y: [-FAR, level as f32] }
    }

    /// A stretch of a curve with these control points, the first and the last in order of v.
    fn stretch(points: &[DVec2]) -> Self {
        let [from, to] = [points[0], points[points.len() - 1]];
        let across = (to - from).perp();
        let across = (across / across.abs().element_sum()).as_vec2();
        let offsets = points.iter().map(|point| across.as_dvec2().dot(*point));
        let [low, high] = offsets
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        Self {
            across: across.to_array(),
            band: [(low as f32).next_down(), (high as f32).next_up()],
            x: [from.x.min(to.x) as f32, from.x.max(to.x) as f32],
            y: [from.y as f32, to.y as f32],
        }
    }

    /// Whether a ray from a point towards larger u crosses this; `None` where that is not decided,
    /// if the point may be off by `reach`.
    fn is_crossed(&self, point: DVec2, reach: DVec2) -> Option<bool> {
        let [across, band, x, y] =
            [self.across, self.band, self.x, self.y].map(|pair| pair.map(f64::from));
        let apart = point.x + reach.x < x[0]
            || point.x - reach.x > x[1]
            || point.y + reach.y < y[0]
            || point.y - reach.y > y[1]; // false for NaN
        let across = DVec2::from_array(across);
        let (offset, spread) = (across.dot(point), across.abs().dot(reach));
        let (left, right) = (offset - spread > band[1], offset + spread < band[0]);
        if !(apart || left || right) {
            return None;
        }
        let is_level = y[0] <= point.y && point.y < y[1];
        Some(is_level && if apart { point.x < x[0] } else { left })
    }
}

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

impl Trims {
    /// What there is to cross within a rectangle, whose coordinates are taken to run from −1 to 1,
    /// and slightly beyond it.
    ///
    /// Nothing if there is too much, or if `rounding`, by which parameters may be off, or the error
    /// of the curves is too large for it.
    pub(crate) fn window(&self, square: &UvBox, rounding: DVec2) -> Vec<WindowCurve> {
        let (center, half) = (square.center(), 0.5 * square.size());
        let seen = UvBox::about(center, CUT_OFF_AT * half);
        let most_off = SPARE_OF_F64 * half - rounding;
        let (mut window, mut exits) = (Vec::new(), Vec::new());
        let is_unusable = self.tree.any(&seen, |index| {
            let segment = &self.segments[index];
            let Some(range) = segment.stretch_within(&seen) else { return false };
            let points: Vec<DVec2> =
                segment.control_points(range).map(|point| (point - center) / half).collect();
            let ends = [points[0], points[points.len() - 1]];
            let is_exit = |end: &DVec2| end.x > WINDOW_REACH && end.y.abs() <= WINDOW_REACH;
            exits.extend(ends.into_iter().filter(is_exit).map(|end| end.y));
            window.push(WindowCurve::stretch(&points));
            let is_exact = (2.0 * segment.reach()).cmple(most_off).all(); // false for NaN
            window.len() > MOST_CURVES || !is_exact
        });
        if is_unusable {
            return Vec::new();
        }
        exits.sort_by(f64::total_cmp);
        // Where two curves join beyond the window, nothing ends.
        let unpaired = exits.chunk_by(f64::eq).filter(|alike| alike.len() % 2 == 1);
        window.extend(unpaired.map(|alike| WindowCurve::exit(alike[0])));
        self.adjusted(window, |point| center + half * point)
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
            let is_inside = match self.contains(uv(point)) {
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
                let exact = trims.contains_within(center + half * point, reach * half);
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
    }
}
