//! Lofts: surfaces through section curves.

use glam::{DVec4, Vec4Swizzles};

use super::ConstructError;
use super::compatible::{compatible, same_weights};
use super::fold::check_fold;
use super::interpolate::Interpolation;
use super::net_size::net_size;
use crate::geometry::curve::SAME_PLACE;
use crate::geometry::{MAX_DEGREE, NurbsCurve, NurbsSurface, SurfaceError};

/// A surface through sections, and where it meets them.
#[derive(Clone, Debug, PartialEq)]
pub struct Loft {
    /// The surface: `u` runs along the sections, `v` in `[0, 1]` from the first to the last.
    pub surface: NurbsSurface,
    /// The `v` of each section.
    pub parameters: Vec<f64>,
}

/// The default degree across sections: no more than cubic.
pub const LOFT_DEGREE: usize = 3;

/// The surface, of this degree across, that passes through section curves in order (skinning; Piegl
/// & Tiller 1997, 10.3).
///
/// The sections are made compatible (degree elevation, merged knots), and each is scaled to begin
/// with weight 1. Their homogeneous control points are interpolated: `S(u, v_k)` is section `k` up
/// to rounding. The `v_k` are chord lengths between corresponding control points, averaged over
/// those control points that move at all; the knots are averages of the `v_k`. Two sections and
/// degree 1 make a ruled surface.
///
/// # Errors
/// When the degree is not supported; when there are fewer than `degree + 1` sections; when two
/// neighbours coincide; when a section other than the first and the last runs back over itself
/// (these two may, as the bow of a hull does, but not both if there are no others); when the
/// surface comes back the way it went; or when sections of very different weights make interpolated
/// weights non-positive.
pub fn loft(sections: &[NurbsCurve], degree: usize) -> Result<Loft, ConstructError> {
    if !(1..=MAX_DEGREE).contains(&degree) {
        return Err(ConstructError::DegreeAcross { degree });
    }
    let needed = degree + 1;
    if sections.len() < needed {
        return Err(ConstructError::Sections { found: sections.len(), degree, needed });
    }
    let which = |index| format!("section {index}");
    let last = sections.len() - 1;
    for (index, section) in sections.iter().enumerate().take(last).skip(1) {
        check_fold(section, &which(index))?;
    }
    if last == 1 {
        check_fold(&sections[0], &which(0))
            .or_else(|error| check_fold(&sections[1], &which(1)).map_err(|_| error))?;
    }
    let polynomial = !sections.iter().any(NurbsCurve::is_rational);
    let sections = compatible(sections, &which)?;
    let mut lines: Vec<Vec<DVec4>> = sections.iter().map(scaled).collect();
    if polynomial {
        // Rounding in the steps above must not make the surface rational.
        lines.iter_mut().flatten().for_each(|point| point.w = 1.0);
    }
    let parameters = averaged_chords(&lines)?;
    check_way_back(&sections, degree)?;
    let across = |error| SurfaceError::Knots { direction: crate::geometry::Direction::V, error };
    let equations = Interpolation::new(degree, &parameters).map_err(across)?;

    let knots_u = sections[0].knots().clone();
    let mut net = Vec::with_capacity(net_size(knots_u.point_count(), sections.len())?);
    for i in 0..knots_u.point_count() {
        let through: Vec<DVec4> = lines.iter().map(|line| line[i]).collect();
        let weight = through[0].w;
        let alike = through.iter().all(|point| point.w == weight);
        // A weight common to all points is kept, without rounding error.
        let exact = |point: DVec4| if alike { point.with_w(weight) } else { point };
        net.extend(equations.control(&through).into_iter().map(exact));
    }
    let surface = NurbsSurface::from_homogeneous(knots_u, equations.knots().clone(), net);
    let surface = surface.map_err(|error| match error {
        // There are as many control points across as sections, each near its section.
        SurfaceError::Weight { i, j, weight } => {
            ConstructError::SectionWeights { section: j, point: i, weight }
        }
        error => error.into(),
    })?;
    Ok(Loft { surface, parameters })
}

/// Fails if the surface would come back the way it went: straight from section to section, or in
/// one bow from the first of three to the last.
fn check_way_back(sections: &[NurbsCurve], degree: usize) -> Result<(), ConstructError> {
    if degree > 1 && sections.len() > 3 {
        return Ok(());
    }
    for (first, three) in sections.windows(3).enumerate() {
        let (a, b) = (&three[0], &three[2]);
        let near = SAME_PLACE * a.magnitude();
        let mut points = 0..a.control().len();
        if same_weights(a, b) && points.all(|i| a.vertex(i).distance(b.vertex(i)) <= near) {
            return Err(ConstructError::ComesBack { first, turn: first + 1, last: first + 2 });
        }
    }
    Ok(())
}

/// The control points of a section, scaled to begin with weight 1; unchanged if they already do.
fn scaled(section: &NurbsCurve) -> Vec<DVec4> {
    let first = section.control()[0].w;
    section.control().iter().map(|&point| point / first).collect()
}

/// The parameters of the sections: the chord lengths of each column of control points as fractions
/// of the column's whole length, averaged over the columns that do not stay in one point (Piegl &
/// Tiller 1997, eq. 10.8).
fn averaged_chords(lines: &[Vec<DVec4>]) -> Result<Vec<f64>, ConstructError> {
    let point = |k: usize, i: usize| lines[k][i].xyz() / lines[k][i].w;
    let mut steps = vec![0.0; lines.len() - 1];
    let mut columns = 0.0;
    for i in 0..lines[0].len() {
        let chords: Vec<f64> =
            (1..lines.len()).map(|k| point(k, i).distance(point(k - 1, i))).collect();
        let whole: f64 = chords.iter().sum();
        if whole > 0.0 {
            columns += 1.0;
            for (step, chord) in steps.iter_mut().zip(chords) {
                *step += chord / whole;
            }
        }
    }
    let mut parameters = vec![0.0];
    for (index, step) in steps.into_iter().enumerate() {
        let before = parameters[index];
        let after = before + step / columns;
        let further = after > before; // false for NaN
        if !further {
            return Err(ConstructError::SameSections { first: index, second: index + 1 });
        }
        parameters.push(after);
    }
    // The last one is 1 up to rounding.
    if let Some(last) = parameters.last_mut() {
        *last = 1.0;
    }
    Ok(parameters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::KnotVector;
    use crate::geometry::shapes::circle_arc;
    use glam::{DAffine3, DVec2, DVec3};

    fn circle(radius: f64, z: f64) -> NurbsCurve {
        let lift = DAffine3::from_translation(DVec3::new(0.0, 0.0, z));
        circle_arc(radius, 0.0, 360.0).unwrap().transformed(&lift).unwrap()
    }

    #[test]
    fn lofts_of_polynomials_are_polynomial() {
        for count in 3..=8 {
            let section = |k: usize| {
                let place = |i: usize| {
                    let wobble = (1.7 * (i * count + k) as f64).sin();
                    DVec3::new(i as f64, wobble, k as f64 + 0.31 * wobble)
                };
                // Of different degrees, and some of two pieces.
                let points: Vec<DVec3> = (0..4 + k % 2).map(place).collect();
                let knots = KnotVector::clamped_uniform(2 + k % 2, points.len()).unwrap();
                NurbsCurve::new(knots, points, None).unwrap()
            };
            let sections: Vec<_> = (0..count).map(section).collect();
            let Loft { surface, parameters } = loft(&sections, 2.min(count - 1)).unwrap();
            assert!(!surface.is_rational(), "{count}");
            for (section, v) in sections.iter().zip(parameters) {
                let middle = surface.point_at(DVec2::new(0.5, v));
                let [start, end] = section.domain();
                let expected = section.derivatives(0.5 * (start + end)).point;
                assert!(middle.distance(expected) < 1e-13, "{count}");
            }
        }
    }

    #[test]
    fn circles_of_a_cone_make_the_cone() {
        for size in [1e-8, 1.0, 1e8] {
            let heights = [0.0, 0.1, 1.0, 1.5, 3.0];
            let sections = heights.map(|z| circle((2.0 - 0.5 * z) * size, z * size));
            for degree in 1..=4 {
                let Loft { surface, parameters } = loft(&sections, degree).unwrap();
                for (v, z) in parameters.iter().zip(heights) {
                    assert!((v - z / 3.0).abs() < 1e-15);
                }
                for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))) {
                    let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let p = surface.point_at(DVec2::new(u, v)) / size;
                    let off = p.truncate().length() - (2.0 - 0.5 * p.z);
                    assert!(off.abs() < 4e-15, "degree {degree}, ({u}, {v}): off by {off:e}");
                    assert!((p.z - 3.0 * v).abs() < 4e-15);
                }
            }
        }
    }

    #[test]
    fn unlike_sections_are_all_met() {
        let line = NurbsCurve::polyline(&[DVec3::X, DVec3::new(0.0, 1.5, 0.0), DVec3::NEG_X]);
        let half = |radius: f64, z: f64| {
            let lift = DAffine3::from_translation(DVec3::new(0.1 * z, 0.0, z));
            circle_arc(radius, 0.0, 180.0).unwrap().transformed(&lift).unwrap()
        };
        let knots = KnotVector::standard(3, 5).unwrap();
        let points = [[2.0, 0.0], [1.0, 1.0], [0.0, 1.5], [-2.0, 2.0], [-2.0, 0.0]];
        let cubic = points.map(|[x, y]| DVec3::new(x, y, 3.0)).to_vec();
        let cubic = NurbsCurve::new(knots, cubic, Some(vec![2.0, 1.0, 1.0, 1.0, 3.0])).unwrap();
        let sections = [line.unwrap(), half(1.5, 1.0), half(1.2, 2.0), cubic];
        let Loft { surface, parameters } = loft(&sections, 3).unwrap();
        for (section, &v) in sections.iter().zip(&parameters) {
            let [a, b] = section.domain();
            for k in 0..=40 {
                let s = f64::from(k) / 40.0;
                let off =
                    surface.point_at(DVec2::new(s, v)).distance(section.point_at(a + s * (b - a)));
                assert!(off < 1e-14, "v = {v}, u = {s}: off by {off:e}");
            }
        }
    }

    #[test]
    fn sections_may_share_a_point_but_not_all_of_them() {
        // A fan: all sections begin in one point.
        let ray = |x: f64| NurbsCurve::bezier(&[DVec3::ZERO, DVec3::new(x, 1.0, x * x)]).unwrap();
        let fan = loft(&[ray(-1.0), ray(0.0), ray(1.0)], 2).unwrap().surface;
        assert!(
            (0..=10).all(|k| fan.point_at(DVec2::new(0.0, f64::from(k) / 10.0)) == DVec3::ZERO)
        );
        assert_eq!(
            loft(&[ray(0.0), ray(1.0), ray(1.0)], 2).unwrap_err().to_string(),
            "sections 1 and 2 coincide: neighbours must differ"
        );
        let weighted = |z: f64, w: f64| {
            let points =
                vec![DVec3::new(0.0, 0.0, z), DVec3::new(1.0, 0.0, z), DVec3::new(2.0, 0.0, z)];
            NurbsCurve::new(KnotVector::bezier(2).unwrap(), points, Some(vec![1.0, w, 1.0]))
                .unwrap()
        };
        let uneven =
            [weighted(0.0, 1.0), weighted(1.0, 100.0), weighted(2.0, 1.0), weighted(3.0, 1.0)];
        let message = loft(&uneven, 3).unwrap_err().to_string();
        assert!(
            message.starts_with("section 2: its weights and its neighbours' differ too much: "),
            "{message}"
        );
        // An inner section that runs back over itself is refused; at an end it closes the body.
        let folded = |z: f64| {
            let points = [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 0.0, z]].map(DVec3::from);
            NurbsCurve::polyline(&points).unwrap()
        };
        let open = |z: f64| circle(1.0, z);
        assert_eq!(
            loft(&[open(0.0), folded(1.0), open(2.0)], 2).unwrap_err().to_string(),
            "section 1: it folds at control point 1, (1, 0, 1): there it turns round and runs back \
             over itself, for a length of 1; the surface would be covered twice"
        );
        assert!(loft(&[folded(0.0), open(1.0), folded(2.0)], 2).is_ok());
        assert!(loft(&[folded(0.0), open(1.0)], 1).is_ok());
        assert!(loft(&[folded(0.0), folded(1.0)], 1).is_err());
        assert_eq!(
            loft(&[ray(0.0), ray(1.0)], 3).unwrap_err().to_string(),
            "2 sections: degree 3 across needs at least 4"
        );
        for degree in [0, 33, usize::MAX] {
            for sections in [Vec::new(), vec![ray(0.0), ray(1.0)]] {
                assert_eq!(
                    loft(&sections, degree).unwrap_err().to_string(),
                    format!("degree {degree} across: degrees from 1 to 32 are supported")
                );
            }
        }
    }
}
