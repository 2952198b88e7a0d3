//! Polynomial surfaces as POV-Ray's `bicubic_patch`es.

use glam::{DVec3, Vec4Swizzles};

use super::{PovrayGap, vector};
use crate::geometry::{Charts, NurbsSurface};
use crate::patch::ScaledFrame;

/// The most halvings of a patch each way: a million parts.
const MAX_HALVINGS: u32 = 10;

/// All Bézier pieces of a surface, elevated to degree 3, in the coordinates of a frame; the
/// flatness is in scene units.
///
/// # Errors
/// When the surface is rational, of a degree above 3, or the flatness too small.
pub(super) fn patches(
    surface: &impl Charts,
    flatness: f64,
    frame: &ScaledFrame,
) -> Result<String, PovrayGap> {
    surface.charts().iter().map(|chart| of_chart(&chart.surface, flatness, frame)).collect()
}

fn of_chart(
    surface: &NurbsSurface,
    flatness: f64,
    frame: &ScaledFrame,
) -> Result<String, PovrayGap> {
    if surface.is_rational() {
        return Err(PovrayGap::Rational);
    }
    let (u, v) = (surface.knots_u().degree(), surface.knots_v().degree());
    let wrong = PovrayGap::Degree { u, v };
    let (Some(more_u), Some(more_v)) = (3_usize.checked_sub(u), 3_usize.checked_sub(v)) else {
        return Err(wrong);
    };
    let bicubic = surface.elevated_u(more_u).and_then(|surface| surface.elevated_v(more_v));
    let bezier = bicubic.map_err(|_| wrong)?.bezier_form();

    let [_, columns] = bezier.size();
    let mut text = String::new();
    for u in bezier.knots_u().spans() {
        for v in bezier.knots_v().spans() {
            let point = |i: usize, j: usize| {
                let control = bezier.control()[(u.index - 3 + i) * columns + v.index - 3 + j];
                frame.scaled(control.xyz() / control.w)
            };
            let net = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| point(i, j)));
            text.push_str(&patch(&net, frame.scale * flatness)?);
        }
    }
    Ok(text)
}

fn patch(net: &[[DVec3; 4]; 4], flatness: f64) -> Result<String, PovrayGap> {
    let halvings = halvings(net, flatness);
    if halvings > MAX_HALVINGS {
        return Err(PovrayGap::TooFine { halvings, limit: MAX_HALVINGS });
    }
    let rows = net.map(|row| format!("  {}", row.map(vector).join(", "))).join(",\n");
    Ok(format!(
        "bicubic_patch {{ type 1 flatness {flatness:?} u_steps {halvings} v_steps {halvings}\n{rows}\n}}\n"
    ))
}

/// The number of halvings of a patch each way until every part's control points are within
/// `flatness` of the plane through three of its corners: then POV-Ray stops.
///
/// Let δ be the length of the longest second difference of the net, mixed ones included. Then
/// `P_ij = P_00 + i (P_30 − P_00) / 3 + j (P_03 − P_00) / 3 + e` with `|e| ≤ (1 + 1 + 9) δ`:
/// a control point on a border is within δ of its place on the chord, and i j ≤ 9 mixed
/// differences lead inwards. Halving divides δ by at least four.
fn halvings(net: &[[DVec3; 4]; 4], flatness: f64) -> u32 {
    let mut longest: f64 = 0.0;
    for i in 0..4 {
        for j in 0..2 {
            let along_v = net[i][j] - 2.0 * net[i][j + 1] + net[i][j + 2];
            let along_u = net[j][i] - 2.0 * net[j + 1][i] + net[j + 2][i];
            longest = longest.max(along_u.length()).max(along_v.length());
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            let mixed = net[i + 1][j + 1] - net[i + 1][j] - net[i][j + 1] + net[i][j];
            longest = longest.max(mixed.length());
        }
    }
    let times = (11.0 * longest / flatness).log2() / 2.0;
    times.ceil().max(0.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::split_bezier;

    /// Half the net, below the middle in both directions.
    fn quarter(net: &[[DVec3; 4]; 4]) -> [[DVec3; 4]; 4] {
        let half = |line: [DVec3; 4]| {
            let (below, _) = split_bezier(&line.map(|p| p.extend(1.0)), 0.5).unwrap();
            [0, 1, 2, 3].map(|k| below[k].xyz())
        };
        let rows = net.map(half);
        let columns = [0, 1, 2, 3].map(|j| half([0, 1, 2, 3].map(|i| rows[i][j])));
        [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| columns[j][i]))
    }

    fn off_plane(net: &[[DVec3; 4]; 4]) -> f64 {
        let normal = (net[3][0] - net[0][0]).cross(net[0][3] - net[0][0]).normalize();
        let away = |p: &DVec3| (*p - net[0][0]).dot(normal).abs();
        net.iter().flatten().map(away).fold(0.0, f64::max)
    }

    #[test]
    fn so_many_halvings_are_enough_and_not_many_too_many() {
        let wavy = |i: usize, j: usize| {
            let (x, y) = (i as f64, j as f64);
            DVec3::new(x, y + 0.2 * x * x, (2.3 * x + y).sin())
        };
        let mut net = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| wavy(i, j)));
        for flatness in [1.0, 1e-2, 1e-4] {
            let mut part = net;
            let count = halvings(&net, flatness);
            for _ in 0..count {
                part = quarter(&part);
            }
            let off = off_plane(&part);
            assert!(off <= flatness && off > 1e-3 * flatness, "{flatness:e}: {off:e}");
        }
        net = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| DVec3::new(i as f64, j as f64, 7.0)));
        assert_eq!(halvings(&net, 1e-9), 0);
    }
}
