//! Trim curves of a surface, as geomdl's `export_json` writes them.
//!
//! `trims` is a list of closed loops, alone or as `{"count": …, "data": […]}`: splines, free-form
//! points, or containers of such curves in turn.

use std::collections::BTreeSet;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::claims::{miscounts, mistypes};
use super::points::Points;
use super::{Entry, Keyed, LoadError, Raw, Reader, is_set};
use crate::geometry::trim::Kept;
use crate::math::Counted;
use crate::scene::{
    CurveKind, CurveSpec, Knots, LoopKind, LoopSense, LoopSpec, Place, TrimSpec, Written,
};

/// A list in an object, or alone.
#[derive(Deserialize)]
struct ListKeys<'a> {
    #[serde(borrow)]
    count: Raw<'a>,
    #[serde(borrow)]
    data: Raw<'a>,
}

/// A loop, or a curve of one: all keys optional, so that its kinds can be told apart.
#[derive(Deserialize)]
struct CurveKeys<'a> {
    #[serde(borrow, rename = "type")]
    kind: Raw<'a>,
    #[serde(borrow)]
    count: Raw<'a>,
    #[serde(borrow)]
    degree: Raw<'a>,
    #[serde(borrow)]
    knotvector: Raw<'a>,
    #[serde(borrow)]
    control_points: Raw<'a>,
    #[serde(borrow)]
    weights: Raw<'a>,
    #[serde(borrow)]
    points: Raw<'a>,
    #[serde(borrow)]
    data: Raw<'a>,
    #[serde(borrow)]
    reversed: Raw<'a>,
}

/// Notes on what is not used in the trims of a surface, once each.
type Unused = BTreeSet<&'static str>;

const MISTYPED: &str = "\"type\" of a curve is not what its other keys make of it";

impl<'a> Reader<'a> {
    /// The trims of an entry, if it has any.
    pub(super) fn trims(&mut self, entry: &Entry<'a>) -> Result<Option<TrimSpec>, LoadError> {
        let Some(raw) = entry.item.trims else { return Ok(None) };
        let mut unused = BTreeSet::new();
        let mut loops = Vec::new();
        for (index, raw) in self.list(entry, raw, &mut unused)?.into_iter().enumerate() {
            loops.push(self.trim_loop(entry, (index, raw), &mut unused)?);
        }
        for why in unused {
            self.note(entry, "trims of surface", why.to_owned());
        }
        if loops.is_empty() {
            return Ok(None);
        }
        // Without outlines, the border of the domain is the outline.
        let outlined = loops.iter().any(|one| one.sense == Some(LoopSense::Outline));
        let kept = if outlined { Kept::Odd } else { Kept::Even };
        Ok(Some(TrimSpec { place: self.place(raw), kept, loops }))
    }

    fn list(
        &self,
        entry: &Entry<'a>,
        raw: &'a RawValue,
        unused: &mut Unused,
    ) -> Result<Vec<&'a RawValue>, LoadError> {
        if raw.get().starts_with('[') {
            return self.parse(raw.get());
        }
        let Keyed(keys): Keyed<ListKeys<'a>> = self.parse(raw.get())?;
        let data = keys
            .data
            .ok_or_else(|| entry.malformed(self.place(raw), "trims: missing key \"data\""))?;
        let loops: Vec<&'a RawValue> = self.parse(data.get())?;
        if miscounts(keys.count, loops.len()) {
            unused.insert("\"count\" is not the number of loops in \"data\"");
        }
        Ok(loops)
    }

    fn trim_loop(
        &self,
        entry: &Entry<'a>,
        (index, raw): (usize, &'a RawValue),
        unused: &mut Unused,
    ) -> Result<LoopSpec, LoadError> {
        let place = self.place(raw);
        let Keyed(keys): Keyed<CurveKeys<'a>> = self.parse(raw.get())?;
        // The region inside a loop is cut off, or kept if the loop is reversed.
        let cuts = !is_set(keys.reversed);
        let sense = Some(if cuts { LoopSense::Hole } else { LoopSense::Outline });
        let curves = match keys.data {
            Some(data) => {
                let beside =
                    [keys.degree, keys.knotvector, keys.control_points, keys.weights, keys.points];
                if beside.iter().any(Option::is_some) {
                    unused.insert("what stands beside the curves of \"data\" is left out");
                }
                let items: Vec<&'a RawValue> = self.parse(data.get())?;
                if miscounts(keys.count, items.len()) {
                    unused
                        .insert("\"count\" of a loop is not the number of curves in its \"data\"");
                }
                if mistypes(keys.kind, "container") {
                    unused.insert(MISTYPED);
                }
                let each = items.into_iter().enumerate().map(|(curve, raw)| {
                    let Keyed(keys): Keyed<CurveKeys<'a>> = self.parse(raw.get())?;
                    if is_set(keys.reversed) {
                        unused.insert("\"reversed\" of a curve within \"data\" is left out");
                    }
                    self.trim_curve(entry, (index, Some(curve), self.place(raw)), &keys, unused)
                });
                each.collect::<Result<_, _>>()?
            }
            None => {
                let mut curve =
                    self.trim_curve(entry, (index, None, place.clone()), &keys, unused)?;
                // Free-form points alone are a closed polygon, whether the last repeats the first
                // or not.
                if let CurveKind::Polyline(points) = &mut curve.kind {
                    let first = points.first().copied();
                    points.extend(first.filter(|first| points.last() != Some(first)));
                }
                vec![curve]
            }
        };
        Ok(LoopSpec { place, kind: LoopKind::Curves(curves), sense })
    }

    /// The curve of a loop: the only one, or one of a container's.
    fn trim_curve(
        &self,
        entry: &Entry<'a>,
        (index, curve, place): (usize, Option<usize>, Place),
        keys: &CurveKeys<'a>,
        unused: &mut Unused,
    ) -> Result<CurveSpec, LoadError> {
        let kind = match (keys.degree, keys.control_points, keys.points) {
            (Some(degree), Some(control), free) => {
                if free.is_some() {
                    unused.insert("\"points\" beside the control points of a spline are left out");
                }
                let knots = self.needed::<Vec<f64>>(entry, "knotvector", keys.knotvector)?;
                let knots = Written::new(Knots::Values(knots.value), knots.place);
                let (points, weights, twice) = self.control(control, keys.weights)?;
                unused.extend(twice);
                let points = self.in_plane(entry, self.needed(entry, "points", points)?)?;
                let weights = weights.map(|raw| self.weights(raw)).transpose()?;
                let degree = Written::new(self.parse(degree.get())?, self.place(degree));
                CurveKind::Nurbs { degree, knots, points, weights }
            }
            (degree, None, Some(points)) => {
                if degree.or(keys.knotvector).or(keys.weights).is_some() {
                    unused.insert("degree, knots and weights beside free-form points are left out");
                }
                let points = Written::new(self.parse(points.get())?, self.place(points));
                CurveKind::Polyline(self.in_plane(entry, points)?)
            }
            _ => {
                let which = curve.map_or_else(String::new, |curve| format!(", curve {curve},"));
                let what = match (keys.data, curve) {
                    (Some(_), _) => {
                        "is a container within a container, of which only splines and points are \
                         read"
                    }
                    (None, Some(_)) => {
                        "is neither a spline (degree, knotvector, control_points) nor points"
                    }
                    (None, None) => {
                        "is neither a spline (degree, knotvector, control_points), nor points, \
                         nor a container (data)"
                    }
                };
                let message = format!("trims: loop {index}{which} {what}");
                return Err(entry.malformed(place, &message));
            }
        };
        let is_spline = matches!(kind, CurveKind::Nurbs { .. });
        if mistypes(keys.kind, if is_spline { "spline" } else { "freeform" }) {
            unused.insert(MISTYPED);
        }
        Ok(CurveSpec { place, kind, transform: Vec::new(), reverse: false })
    }

    /// Returns points as points of (u, v), which have 2 coordinates.
    fn in_plane(
        &self,
        entry: &Entry<'a>,
        Written { value, place }: Written<Points>,
    ) -> Result<Vec<glam::DVec3>, LoadError> {
        match value.unlike(2) {
            None => Ok(value.points),
            Some(other) => {
                let coordinates = Counted(other, "coordinate");
                let message = format!(
                    "trims: a point has {coordinates}, but trim curves lie in (u, v) and need 2"
                );
                Err(entry.malformed(place, &message))
            }
        }
    }
}
