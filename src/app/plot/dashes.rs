//! Lines cut into dashes.

use glam::DVec2;

/// The longest line that is worth dashes: longer ones leave every picture.
const LONGEST: f64 = 1e5;

/// Cuts a line into dashes, the first at its beginning. `lengths` are those of dashes and gaps in
/// turn; if there are none, the line stays whole.
pub(super) fn dashed(line: &[DVec2], lengths: &[f64]) -> Vec<Vec<DVec2>> {
    let whole: f64 = line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    let Some(&first) = line.first().filter(|_| lengths.len() > 1 && whole < LONGEST) else {
        return vec![line.to_vec()];
    };
    let mut dashes = vec![vec![first]];
    let (mut turn, mut left) = (0, lengths[0]);
    for ends in line.windows(2) {
        let length = ends[0].distance(ends[1]);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let here = ends[0].lerp(ends[1], done / length);
            if turn % 2 == 0 {
                if let Some(dash) = dashes.last_mut() {
                    dash.push(here);
                }
            } else {
                dashes.push(vec![here]);
            }
            turn = (turn + 1) % lengths.len();
            left = lengths[turn];
        }
        left -= length - done;
        if let Some(dash) = dashes.last_mut().filter(|_| turn % 2 == 0) {
            dash.push(ends[1]);
        }
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_are_as_long_as_they_should_be_around_corners_too() {
        let lengths = [3.0, 1.0, 0.5, 1.5];
        let line = [[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [10.5, 8.0]].map(DVec2::from);
        let dashes = dashed(&line, &lengths);
        let along = |p: DVec2| p.x + p.y;
        let ends: Vec<[f64; 2]> =
            dashes.iter().map(|dash| [along(dash[0]), along(dash[dash.len() - 1])]).collect();
        // From 0 to 18.5 in turns of 6.
        let expected =
            [[0.0, 3.0], [4.0, 4.5], [6.0, 9.0], [10.0, 10.5], [12.0, 15.0], [16.0, 16.5]];
        assert_eq!(ends, [&expected[..], &[[18.0, 18.5]]].concat());
        // One goes around the corner at 18.
        assert_eq!(dashes[6], [[10.0, 8.0], [10.5, 8.0]].map(DVec2::from));
        let around = dashed(&line, &[10.5, 1.0]);
        assert_eq!(around[0], [[0.0, 0.0], [10.0, 0.0], [10.0, 0.5]].map(DVec2::from));
        assert_eq!(dashed(&line, &[]), [line.to_vec()]);
        assert_eq!(dashed(&[], &lengths), [Vec::new()]);
    }
}
