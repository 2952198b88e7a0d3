//! Trim curves of a surface, as geomdl's `export_json` writes them.
//!
//! `trims` is `{"count": …, "data": […]}`, or the list alone, of closed loops: splines, free-form
//! points, or containers of such curves in turn.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::points::Points;
use super::{ControlPoints, Entry, Keyed, LoadError, Raw, Reader};
use crate::geometry::trim::Kept;
use crate::scene::{
    CurveKind, CurveSpec, Knots, LoopKind, LoopSense, LoopSpec, Place, TrimSpec, Written,
};

/// A list in an object, or alone.
#[derive(Deserialize)]
struct ListKeys<'a> {
    #[serde(borrow)]
    data: Raw<'a>,
}

/// A loop, or a curve of one: all keys optional, so that its kinds can be told apart.
#[derive(Deserialize)]
struct CurveKeys<'a> {
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

impl<'a> Reader<'a> {
    /// The trims of an entry, if it has any.
    pub(super) fn trims(&self, entry: &Entry<'a>) -> Result<Option<TrimSpec>, LoadError> {
        let Some(raw) = entry.item.trims.filter(|raw| raw.get() != "null") else {
            return Ok(None);
        };
        let items = self.list(entry, raw)?;
        let loops = items.iter().enumerate();
        let loops = loops.map(|(index, raw)| self.trim_loop(entry, index, raw));
        let loops = loops.collect::<Result<Vec<_>, _>>()?;
        if loops.is_empty() {
            return Ok(None);
        }
        // Without outlines the whole domain is one.
        let outlined = loops.iter().any(|one| one.sense == Some(LoopSense::Outline));
        let kept = if outlined { Kept::Odd } else { Kept::Even };
        Ok(Some(TrimSpec { place: self.place(raw), kept, loops }))
    }

    fn list(&self, entry: &Entry<'a>, raw: &'a RawValue) -> Result<Vec<&'a RawValue>, LoadError> {
        if raw.get().starts_with('[') {
            return self.parse(raw.get());
        }
        let Keyed(keys): Keyed<ListKeys<'a>> = self.parse(raw.get())?;
        let data = keys
            .data
            .ok_or_else(|| entry.malformed(self.place(raw), "trims: missing key \"data\""))?;
        self.parse(data.get())
    }

    fn trim_loop(
        &self,
        entry: &Entry<'a>,
        index: usize,
        raw: &'a RawValue,
    ) -> Result<LoopSpec, LoadError> {
        let place = self.place(raw);
        let Keyed(keys): Keyed<CurveKeys<'a>> = self.parse(raw.get())?;
        // What a curve goes around is cut off, or what it goes around is kept.
        let cuts = keys.reversed.map_or("false", RawValue::get);
        let cuts = ["false", "0", "0.0", "null"].contains(&cuts);
        let sense = Some(if cuts { LoopSense::Hole } else { LoopSense::Outline });
        let curves = match keys.data {
            Some(data) => {
                let items: Vec<&'a RawValue> = self.parse(data.get())?;
                let each = items.into_iter().map(|raw| {
                    let Keyed(keys): Keyed<CurveKeys<'a>> = self.parse(raw.get())?;
                    self.trim_curve(entry, index, (self.place(raw), keys))
                });
                each.collect::<Result<_, _>>()?
            }
            None => {
                let mut curve = self.trim_curve(entry, index, (place.clone(), keys))?;
                // Free-form points alone are a polygon, whether it is said to close or not.
                if let CurveKind::Polyline(points) = &mut curve.kind {
                    let first = points.first().copied();
                    points.extend(first.filter(|first| points.last() != Some(first)));
                }
                vec![curve]
            }
        };
        Ok(LoopSpec { place, kind: LoopKind::Curves(curves), sense })
    }

    fn trim_curve(
        &self,
        entry: &Entry<'a>,
        index: usize,
        (place, keys): (Place, CurveKeys<'a>),
    ) -> Result<CurveSpec, LoadError> {
        let kind = match (keys.degree, keys.control_points, keys.points) {
            (Some(degree), Some(control), _) => {
                let knots = self.needed::<Vec<f64>>(entry, "knotvector", keys.knotvector)?;
                let knots = Written::new(Knots::Values(knots.value), knots.place);
                let (points, weights) = if control.get().starts_with('{') {
                    let Keyed(inner): Keyed<ControlPoints<'a>> = self.parse(control.get())?;
                    (inner.points, inner.weights.or(keys.weights))
                } else {
                    (Some(control), keys.weights)
                };
                let points = self.in_plane(entry, self.needed(entry, "points", points)?)?;
                let weights = weights.map(|raw| self.parse(raw.get())).transpose()?;
                CurveKind::Nurbs { degree: self.parse(degree.get())?, knots, points, weights }
            }
            (_, None, Some(points)) => {
                let points = Written::new(self.parse(points.get())?, self.place(points));
                CurveKind::Polyline(self.in_plane(entry, points)?)
            }
            _ => {
                let message = format!(
                    "trims: curve {index} is neither a spline (degree, knotvector, \
                     control_points), nor points, nor a container (data)"
                );
                return Err(entry.malformed(place, &message));
            }
        };
        Ok(CurveSpec { place, kind, transform: Vec::new(), reverse: false })
    }

    /// Points of (u, v).
    fn in_plane(
        &self,
        entry: &Entry<'a>,
        Written { value, place }: Written<Points>,
    ) -> Result<Vec<glam::DVec3>, LoadError> {
        let odd = value.odd.map(|(_, dimension)| dimension);
        match odd.unwrap_or(value.dimension) {
            0 | 2 => Ok(value.points),
            other => {
                let message = format!(
                    "trims: a point has {other} coordinates, but trim curves lie in (u, v) and \
                     need 2"
                );
                Err(entry.malformed(place, &message))
            }
        }
    }
}
