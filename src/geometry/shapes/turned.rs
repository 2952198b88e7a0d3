//! Control nets of surfaces of revolution.

use glam::{DVec3, DVec4};

/// A point that is turned: `center + x across + y ahead` for `(x, y)` on the unit circle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turned {
    pub(crate) center: DVec3,
    pub(crate) across: DVec3,
    pub(crate) ahead: DVec3,
    pub(crate) weight: f64,
}

/// The homogeneous net of points turned along an arc; the index of the point runs fastest.
pub(crate) fn turned_net(arc: &[(f64, f64, f64)], points: &[Turned]) -> Vec<DVec4> {
    let around = |&(x, y, w): &(f64, f64, f64)| {
        points.iter().map(move |point| {
            let w = w * point.weight;
            (w * (point.center + x * point.across + y * point.ahead)).extend(w)
        })
    };
    arc.iter().flat_map(around).collect()
}
