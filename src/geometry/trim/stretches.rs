//! The kept parts of lines of constant parameter, and the parts of trim loops inside the domain.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::curve::euclidean;
use super::seam_sides::{Alike, SeamSides};
use super::segment::Segment;
use super::trims::border_slack;
use super::{Side, Trims, UvBox};
use crate::geometry::Direction;
use crate::math::bernstein::restrict;

/// A piece of a trim edge, cut at given lines so that it crosses none of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EdgePiece {
    /// Its homogeneous control points `(w u, w v, w)`, in the direction of the loop.
    pub control: Vec<DVec3>,
}

impl Trims {
    /// The stretches of the line on which one parameter is `at` that are kept, as ranges of the
    /// other parameter, in order. The kept part is closed: a line along a trim edge
    /// is kept where it touches the kept part. So is the domain's border beside loops along it,
    /// which may be off by rounding. Outside the domain there are no stretches.
    ///
    /// Their ends are where the line crosses the trim curves, to a few rounding errors where the
    /// crossing is steep.
    pub fn kept_along(&self, fixed: Direction, at: f64) -> Vec<[f64; 2]> {
        let free = fixed.other();
        let range = self.domain().range();
        let on_domain = range[fixed][0] <= at && at <= range[fixed][1]; // false for NaN
        if !on_domain {
            return Vec::new();
        }
        let [start, end] = range[free];
        // Curves that reach so little into the domain lie on its border.
        let is_border = range[fixed].contains(&at);
        let mut slack = DVec2::ZERO;
        slack[fixed] = if is_border { border_slack(&self.domain())[fixed] } else { 0.0 };
        let mut cuts = vec![start, end];
        for segment in self.loop_segments().flatten() {
            let [from, to] = segment.ends();
            let [low, high] = [from[fixed].min(to[fixed]), from[fixed].max(to[fixed])];
            let off = if is_border { slack[fixed] + segment.reach()[fixed] } else { 0.0 };
            if low + off < at && at < high - off {
                cuts.push(segment.at(segment.reaching(fixed, at))[free]);
            } else {
                let met = [from, to].into_iter().filter(|end| (end[fixed] - at).abs() <= off);
                cuts.extend(met.map(|end| end[free]));
            }
        }
        cuts.retain(|cut| start <= *cut && *cut <= end);
        cuts.sort_by(f64::total_cmp);
        // A curve that only touches the line, or two loops that touch there, make two cuts that
        // differ by rounding.
        let finest = 8.0 * f64::EPSILON * start.abs().max(end.abs());
        cuts.dedup_by(|next, before| *next - *before <= finest && *next != end);

        let mut kept: Vec<[f64; 2]> = Vec::new();
        for pair in cuts.windows(2) {
            let mut middle = DVec2::splat(at);
            middle[free] = 0.5 * (pair[0] + pair[1]);
            if pair[0] == pair[1] || self.side_within(middle, slack) == Side::Outside {
                continue;
            }
            match kept.last_mut() {
                Some(last) if last[1] == pair[0] => last[1] = pair[1],
                _ => kept.push([pair[0], pair[1]]),
            }
        }
        kept
    }

    /// Each loop's chains of pieces inside the domain, in the direction of the loop, without those
    /// on the domain's border, which cut nothing, and those whose two sides are alike. No piece
    /// crosses a line of constant parameter among `cuts` (in u, in v) by more than the rounding
    /// error of the curve, and nothing is cut off that is no longer than this error; all pieces of
    /// a loop have the same degree. A loop that never meets the domain's border is one chain, whose
    /// last piece ends where the first begins.
    pub(crate) fn edge_chains(&self, cuts: [&[f64]; 2]) -> Vec<Vec<EdgePiece>> {
        let domain = self.domain();
        let UvBox { min, max } = domain.bounds();
        let lines = Direction::BOTH.map(|axis| [cuts[axis], &[min[axis], max[axis]]].concat());
        let sides = SeamSides::new(domain, &self.segments);

        let mut chains = Vec::new();
        for segments in self.loop_segments() {
            let controls: Vec<Vec<DVec3>> = segments.iter().map(directed).collect();
            let degree = controls.iter().map(|control| control.len() - 1).max().unwrap_or(1);
            let size = segments.iter().map(Segment::bounds).fold(UvBox::EMPTY, UvBox::union).size();

            // The pieces in order; `None` where the loop is outside the domain or not an edge.
            let mut pieces: Vec<Option<EdgePiece>> = Vec::new();
            for (segment, mut control) in segments.iter().zip(controls) {
                while control.len() <= degree {
                    control = elevated(&control);
                }
                let alike = sides.alike(segment, size);
                for pair in stops(segment, &lines, &alike).windows(2) {
                    let middle = segment.directed_at(0.5 * (pair[0] + pair[1]));
                    let is_cut = !segment.is_on_border() && domain.bounds().holds(middle);
                    let is_edge = is_cut && !alike.hold(middle);
                    pieces.push(is_edge.then(|| {
                        let mut part = control.clone();
                        restrict(&mut part, pair[0], pair[1]);
                        EdgePiece { control: part }
                    }));
                }
            }
            // A loop that leaves the domain starts where it comes back.
            if let Some(outside) = pieces.iter().position(Option::is_none) {
                pieces.rotate_left(outside);
            }
            let parts = pieces.split(Option::is_none).filter(|part| !part.is_empty());
            chains.extend(parts.map(|part| part.iter().flatten().cloned().collect::<Vec<_>>()));
        }
        chains
    }
}

/// From 0 to 1, the fractions of a segment, in the direction of its loop, at which it is cut: where
/// it crosses one of the lines of constant parameter (in u, in v), and where its parts with both
/// sides alike begin and end.
///
/// Curves of CAD files end a rounding error beside the surface's knots. Beyond a line by no more
/// than the error of the curve, it counts as ending there: what is cut off would have no direction.
fn stops(segment: &Segment, lines: &[Vec<f64>; 2], alike: &Alike) -> Vec<f64> {
    let (reach, UvBox { min, max }) = (segment.reach(), segment.bounds());
    let mut crossings = Vec::new();
    for axis in Direction::BOTH {
        let [low, high] = [min[axis] + reach[axis], max[axis] - reach[axis]];
        let crossed = lines[axis].iter().chain(alike.ends(axis));
        let crossed = crossed.filter(|line| low < **line && **line < high);
        crossings.extend(crossed.map(|&line| {
            let t = segment.reaching(axis, line);
            if segment.is_forward() { t } else { 1.0 - t }
        }));
    }
    crossings.sort_by(f64::total_cmp);

    let at = |along: f64| segment.directed_at(along);
    let are_apart = |a: f64, b: f64| (at(a) - at(b)).abs().cmpgt(reach).any();
    let mut stops = vec![0.0];
    for along in crossings {
        if are_apart(stops[stops.len() - 1], along) && are_apart(along, 1.0) {
            stops.push(along);
        }
    }
    stops.push(1.0);
    stops
}

/// The control points of a segment in the direction in which the loop runs.
fn directed(segment: &Segment) -> Vec<DVec3> {
    let mut control = segment.homogeneous();
    if !segment.is_forward() {
        control.reverse();
    }
    control
}

/// The same Bézier curve with one control point more.
fn elevated(control: &[DVec3]) -> Vec<DVec3> {
    let degree = control.len();
    let mixed = |k: usize| {
        let share = k as f64 / degree as f64;
        let before = k.checked_sub(1).map_or(DVec3::ZERO, |before| share * control[before]);
        before + control.get(k).map_or(DVec3::ZERO, |&here| (1.0 - share) * here)
    };
    (0..=degree).map(mixed).collect()
}

impl EdgePiece {
    /// The point in the middle of its parameter, which lies between all lines it was cut at.
    pub(crate) fn middle(&self) -> DVec2 {
        let mut half = self.control.clone();
        restrict(&mut half, 0.5, 1.0);
        euclidean(half[0])
    }

    /// The control points in the unit coordinates `[0, 1]²` of the cell of the domain from `low` to
    /// `high` that contains the piece.
    pub(crate) fn within(&self, low: DVec2, high: DVec2) -> Vec<DVec3> {
        let local = |c: &DVec3| ((c.xy() - c.z * low) / (high - low)).extend(c.z);
        self.control.iter().map(local).collect()
    }
}
