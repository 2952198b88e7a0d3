//! Tubes, lines and balls drawn together: parts that several of them share are drawn once.
//!
//! Surfaces that coincide make speckled pictures and doubtful rays. Patches share borders and rows
//! of control points, and lines end where others do. So parts that are equal up to rounding become
//! one, whatever their direction.

use std::collections::HashMap;

use glam::DVec3;

use super::collinear::united;
use super::places::{Places, SAME};
use super::tube_parts::{Parts, ball, cap, cylinder, parts, round_part};
use super::{
    Caps, Component, ComponentKind, ConstructError, ControlNet, NetStyle, Tightest, TubeStyle,
};
use crate::geometry::NurbsCurve;
use crate::geometry::magnitude::is_usable;

/// Tubes, lines and balls that are drawn together.
///
/// Straight parts that overlap along a line become one. Curved parts are recognised as equal only
/// if they run at proportional speeds. Where two half balls would end tubes in one place, or a half
/// ball would lie at a joint, a whole ball is drawn.
#[derive(Debug)]
pub struct Drawing {
    style: TubeStyle,
    places: Places,
    /// In the order in which they came.
    items: Vec<Item>,
    /// The index of the ball or half ball of a given radius (its bits) at a place.
    round: HashMap<(usize, u64), usize>,
    /// The directions of the disks that end tubes at a place.
    flat: HashMap<usize, Vec<DVec3>>,
    /// Straight parts by the places of their ends.
    straight: HashMap<[usize; 2], usize>,
    /// Curved parts by the places of their ends and middle.
    curved: HashMap<[usize; 3], Vec<NurbsCurve>>,
    /// The number of control points of the items.
    points: usize,
}

#[derive(Debug)]
enum Item {
    /// A cylinder from point to point.
    Rod {
        kind: ComponentKind,
        ends: [DVec3; 2],
    },
    Ball {
        kind: ComponentKind,
        at: DVec3,
        radius: f64,
    },
    /// Half a ball, or a disk.
    Cap {
        at: DVec3,
        outward: DVec3,
    },
    Made(Component),
}

impl Item {
    /// Upper bound on the number of control points of the item's surface: nine around, times those
    /// of a line, of half a circle or of a quarter circle.
    fn point_count(&self) -> usize {
        match self {
            Self::Rod { .. } => 9 * 2,
            Self::Ball { .. } => 9 * 5,
            Self::Cap { .. } => 9 * 3,
            Self::Made(piece) => piece.surface.control().len(),
        }
    }
}

impl Drawing {
    /// An empty drawing whose tubes and lines have this style, for things among these points; their
    /// largest coordinate determines the rounding tolerance.
    pub fn among(points: impl IntoIterator<Item = DVec3>, style: TubeStyle) -> Self {
        let largest = |point: DVec3| point.abs().max_element();
        let magnitude = points.into_iter().map(largest).fold(f64::MIN_POSITIVE, f64::max);
        Self {
            style,
            places: Places::new(magnitude),
            items: Vec::new(),
            round: HashMap::new(),
            flat: HashMap::new(),
            straight: HashMap::new(),
            curved: HashMap::new(),
            points: 0,
        }
    }

    /// Upper bound on the number of control points of the drawing's surfaces.
    pub fn point_count(&self) -> usize {
        self.points
    }

    /// Adds a tube around a curve.
    ///
    /// # Errors
    /// As [`tube`](super::tube()).
    pub fn tube(&mut self, curve: &NurbsCurve) -> Result<(), ConstructError> {
        self.add_tube(curve).map_err(|error| error.around_a_curve("tube"))
    }

    fn add_tube(&mut self, curve: &NurbsCurve) -> Result<(), ConstructError> {
        let Parts { profile, smooth, joints, ends } = parts(curve, self.style.radius)?;
        let mut tightest = Tightest::default();
        for part in &smooth {
            if let Some([a, b]) = part.straight {
                self.rod(ComponentKind::Tube, [a, b]);
            } else if !self.knows_or_adds(&part.curve) {
                let piece = round_part(&profile, &part.curve, &self.style);
                if let Some(piece) = tightest.sift(piece)? {
                    self.push(Item::Made(piece));
                }
            }
        }
        tightest.check()?;
        for at in joints {
            self.ball(ComponentKind::Joint, at, self.style.radius);
        }
        for (at, outward) in ends {
            self.end(at, outward);
        }
        Ok(())
    }

    /// Adds a control net: a line for each of its lines, a ball of radius `joints` for each of its
    /// points.
    ///
    /// # Errors
    /// When it has too many points, one that is not finite, or a line that ends at none of them.
    pub fn net(&mut self, net: &ControlNet, joints: f64) -> Result<(), ConstructError> {
        let count = net.points.len();
        if count > NetStyle::MAX_POINTS {
            return Err(ConstructError::LargeNet { count, limit: NetStyle::MAX_POINTS });
        }
        let usable = |point: &DVec3| is_usable(*point);
        if let Some(index) = net.points.iter().position(|point| !usable(point)) {
            return Err(ConstructError::NetPoint { index, point: net.points[index] });
        }
        for (line, ends) in net.lines.iter().enumerate() {
            if let Some(&vertex) = ends.iter().find(|&&vertex| vertex >= count) {
                return Err(ConstructError::NetLine { line, vertex, count });
            }
        }
        // Draw point by point, after the lines that begin at the point.
        let mut lines = vec![Vec::new(); count];
        for &[a, b] in &net.lines {
            lines[a].push(b);
        }
        for (&point, ends) in net.points.iter().zip(lines) {
            for end in ends {
                let ends = [point, net.points[end]];
                if self.places.find_or_add(ends[0]) != self.places.find_or_add(ends[1]) {
                    self.rod(ComponentKind::Line, ends);
                }
            }
            self.ball(ComponentKind::Point, point, joints);
        }
        Ok(())
    }

    /// The surfaces, facing outward.
    ///
    /// # Errors
    /// When a radius is not a positive length.
    pub fn pieces(self) -> Result<Vec<Component>, ConstructError> {
        let rods = self.items.iter().filter_map(|item| match item {
            Item::Rod { ends, .. } => Some(*ends),
            _ => None,
        });
        let mut united = united(&rods.collect::<Vec<_>>(), self.places.tolerance()).into_iter();
        let mut pieces = Vec::with_capacity(self.items.len());
        for item in self.items {
            match item {
                Item::Rod { kind, .. } => {
                    // Rods that are part of another one are drawn with it.
                    if let Some(ends) = united.next().flatten() {
                        pieces.push(Component { kind, ..cylinder(ends, self.style.radius)? });
                    }
                }
                Item::Ball { kind, at, radius } => {
                    pieces.push(Component { kind, ..ball(at, radius)? });
                }
                Item::Cap { at, outward } => pieces.extend(cap(at, outward, &self.style)?),
                Item::Made(piece) => pieces.push(piece),
            }
        }
        Ok(pieces)
    }

    fn push(&mut self, item: Item) {
        self.points += item.point_count();
        self.items.push(item);
    }

    fn rod(&mut self, kind: ComponentKind, ends: [DVec3; 2]) {
        let mut key = ends.map(|end| self.places.find_or_add(end));
        key.sort_unstable();
        let index = self.items.len();
        if *self.straight.entry(key).or_insert(index) == index {
            self.push(Item::Rod { kind, ends });
        }
    }

    fn ball(&mut self, kind: ComponentKind, at: DVec3, radius: f64) {
        let whole = Item::Ball { kind, at, radius };
        let index = self.items.len();
        let key = (self.places.find_or_add(at), radius.to_bits());
        let known = *self.round.entry(key).or_insert(index);
        if known == index {
            self.push(whole);
        } else if matches!(self.items[known], Item::Cap { .. }) {
            self.points += whole.point_count() - self.items[known].point_count();
            self.items[known] = whole;
        }
    }

    /// Closes a tube that ends at a point in this direction.
    fn end(&mut self, at: DVec3, outward: DVec3) {
        let place = self.places.find_or_add(at);
        match self.style.caps {
            Caps::Open => {}
            Caps::Flat => {
                let there = self.flat.entry(place).or_default();
                let parallel = |other: &DVec3| outward.cross(*other).length() <= SAME_PLANE;
                if !there.iter().any(parallel) {
                    there.push(outward);
                    self.push(Item::Cap { at, outward });
                }
            }
            Caps::Round => {
                let radius = self.style.radius;
                let key = (place, radius.to_bits());
                if self.round.contains_key(&key) {
                    self.ball(ComponentKind::Joint, at, radius);
                } else {
                    self.round.insert(key, self.items.len());
                    self.push(Item::Cap { at, outward });
                }
            }
        }
    }

    /// Whether a curved part is there already; if not, it is recorded.
    fn knows_or_adds(&mut self, curve: &NurbsCurve) -> bool {
        let [start, end] = curve.domain();
        let middle = curve.point_at(0.5 * (start + end));
        let mut ends = curve.ends().map(|end| self.places.find_or_add(end));
        ends.sort_unstable();
        let tolerance = self.places.tolerance();
        let there =
            self.curved.entry([ends[0], ends[1], self.places.find_or_add(middle)]).or_default();
        let known = there.iter().any(|other| {
            coincide(curve, other, tolerance) || coincide(curve, &other.reversed(), tolerance)
        });
        if !known {
            there.push(curve.clone());
        }
        known
    }
}

/// Disks around one point are the same if their axes differ by no more than this angle, in radians:
/// the effect of an error of [`SAME`] on the direction of a curve a thousandth as long as its
/// coordinates. Other disks meet along a line.
const SAME_PLANE: f64 = 1000.0 * SAME;

/// Whether two clamped curves are the same and run at proportional speeds.
///
/// Between two knots of either, the difference of curves of degree `p` and `q` has a numerator of
/// degree `p + q`: it vanishes if it does so at `p + q + 1` places.
fn coincide(a: &NurbsCurve, b: &NurbsCurve, tolerance: f64) -> bool {
    let share_to_t = |curve: &NurbsCurve, share: f64| {
        let [start, end] = curve.domain();
        if share == 1.0 { end } else { start + share * (end - start) }
    };
    let mut breaks = vec![0.0, 1.0];
    for curve in [a, b] {
        let [start, end] = curve.domain();
        breaks.extend(curve.knots().spans().map(|span| (span.start - start) / (end - start)));
    }
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let places = a.knots().degree() + b.knots().degree();
    breaks.windows(2).all(|pair| {
        (0..=places).all(|k| {
            let share = pair[0] + (pair[1] - pair[0]) * k as f64 / places as f64;
            let [p, q] = [a, b].map(|curve| curve.point_at(share_to_t(curve, share)));
            p.distance(q) <= tolerance // false for NaN
        })
    })
}

/// A control net as surfaces: a cylinder for each line, a ball for each point. Points that
/// coincide, as at poles and seams, are drawn once, and so are lines, also where they overlap.
///
/// # Errors
/// When a radius is not a positive length, there are too many points, one is not finite, or a line
/// ends at none of them.
pub fn control_net(net: &ControlNet, style: &NetStyle) -> Result<Vec<Component>, ConstructError> {
    let mut drawing = Drawing::among(net.points.iter().copied(), style.lines());
    drawing.net(net, style.joints)?;
    drawing.pieces()
}
