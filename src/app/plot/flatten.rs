//! Curves as polylines that look like them.

use glam::DVec2;

/// The parts that each piece of a curve is cut into before any is tested for flatness. A piece's
/// wiggles are no shorter, for a polynomial of degree p has at most p − 1 turns.
const FIRST_PARTS: u32 = 8;

/// The most halvings of a part. A curve of 8192 pixels has parts of 10⁻³ pixels by then.
const DEEPEST: u32 = 20;

/// A curve `at` as polylines, one for each of its unbroken parts: it breaks where it jumps and
/// where it is not finite.
///
/// A part becomes a chord once the points at a quarter, a half and three quarters of its
/// parameters are within `tolerance` of it; it is left out if neither they nor its ends are finite.
pub(super) fn flatten(
    at: impl Fn(f64) -> DVec2,
    pieces: &[[f64; 2]],
    tolerance: f64,
) -> Vec<Vec<DVec2>> {
    let mut lines: Vec<Vec<DVec2>> = Vec::new();
    let mut line: Vec<DVec2> = Vec::new();
    for (index, &[start, end]) in pieces.iter().enumerate() {
        // An inner piece ends just before its last parameter, where the next piece begins.
        let last = if index + 1 == pieces.len() { end } else { end.next_down() };
        let parameter = |k: u32| {
            let share = f64::from(k) / f64::from(FIRST_PARTS);
            (start + share * (end - start)).min(last)
        };
        for k in 0..FIRST_PARTS {
            let (a, b) = (parameter(k), parameter(k + 1));
            let (p, q) = (at(a), at(b));
            let joined = line.last().is_some_and(|before| before.distance(p) <= tolerance);
            if !joined {
                lines.push(std::mem::take(&mut line));
                line.push(p);
            }
            halve(&at, [(a, p), (b, q)], (tolerance, DEEPEST), &mut line);
        }
    }
    lines.push(line);
    lines.into_iter().flat_map(finite).collect()
}

/// Adds the points after the first of a part.
fn halve(
    at: &impl Fn(f64) -> DVec2,
    [(a, p), (b, q)]: [(f64, DVec2); 2],
    (tolerance, depth): (f64, u32),
    line: &mut Vec<DVec2>,
) {
    let t = 0.5 * (a + b);
    let middle = at(t);
    let between = [at(0.5 * (a + t)), middle, at(0.5 * (t + b))];
    let flat = between.iter().all(|&point| distance(point, p, q) <= tolerance); // false for NaN
    let blank = between.iter().chain([&p, &q]).all(|point| !point.is_finite());
    if flat || blank || depth == 0 || t <= a || t >= b {
        line.push(q);
        return;
    }
    halve(at, [(a, p), (t, middle)], (tolerance, depth - 1), line);
    halve(at, [(t, middle), (b, q)], (tolerance, depth - 1), line);
}

/// The distance of a point from a chord.
fn distance(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let chord = to - from;
    let along = (point - from).dot(chord) / chord.length_squared();
    let along = if along.is_nan() { 0.0 } else { along.clamp(0.0, 1.0) };
    point.distance(from + along * chord)
}

/// The finite parts of a line that have two points or more.
fn finite(line: Vec<DVec2>) -> Vec<Vec<DVec2>> {
    let parts = line.split(|point| !point.is_finite());
    parts.filter(|part| part.len() > 1).map(<[DVec2]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest distance of a dense sample from a polyline.
    fn worst(at: impl Fn(f64) -> DVec2, [a, b]: [f64; 2], line: &[DVec2]) -> f64 {
        let samples = (0..=5000).map(|k| at(a + f64::from(k) / 5000.0 * (b - a)));
        let from_line = |point: DVec2| {
            line.windows(2).map(|w| distance(point, w[0], w[1])).fold(f64::INFINITY, f64::min)
        };
        samples.map(from_line).fold(0.0, f64::max)
    }

    #[test]
    fn chords_stay_within_the_tolerance_and_are_not_many() {
        let circle = |t: f64| 100.0 * DVec2::from_angle(t);
        let wave = |t: f64| DVec2::new(40.0 * t, 100.0 * (3.0 * t).sin());
        for tolerance in [1.0, 0.1, 0.01] {
            let whole = [0.0, std::f64::consts::TAU];
            let lines = flatten(circle, &[whole], tolerance);
            assert_eq!(lines.len(), 1);
            assert!(worst(circle, whole, &lines[0]) <= tolerance);
            // The chord of an arc of radius r and angle 2x is r (1 - cos x) off: the fewest chords.
            let fewest = whole[1] / (2.0 * (1.0 - tolerance / 100.0_f64).acos());
            assert!((lines[0].len() as f64) < 2.5 * fewest, "{} for {fewest}", lines[0].len());

            let lines = flatten(wave, &[[0.0, 5.0]], tolerance);
            assert!(worst(wave, [0.0, 5.0], &lines[0]) <= 1.05 * tolerance);
        }
        assert_eq!(flatten(DVec2::splat, &[[0.0, 1.0]], 0.1)[0].len(), 9, "a line");
    }

    #[test]
    fn jumps_break_a_curve_and_joints_do_not() {
        let step = |t: f64| DVec2::new(t, if t < 1.0 { 0.0 } else { 5.0 });
        let lines = flatten(step, &[[0.0, 1.0], [1.0, 2.0]], 0.1);
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0].last().unwrap().y, 0.0);
        assert_eq!(lines[1].first().unwrap(), &DVec2::new(1.0, 5.0));
        let corner = |t: f64| DVec2::new(t, (t - 1.0).abs());
        assert_eq!(flatten(corner, &[[0.0, 1.0], [1.0, 2.0]], 0.1).len(), 1);
        // Where there is no point there is no line.
        let pole = |t: f64| DVec2::new(t, if t == 0.5 { f64::NAN } else { 1.0 });
        assert_eq!(flatten(pole, &[[0.0, 1.0]], 0.1).len(), 2);
    }
}
