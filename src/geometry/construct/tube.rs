//! Curves as visible surfaces: round tubes and flat ribbons.

use glam::DVec3;

use super::fold::check_fold;
use super::path::smooth_parts;
use super::stops::without_stops;
use super::{
    Component, ComponentKind, ConstructError, Drawing, RibbonStyle, Sweep, SweepOptions, TubeStyle,
    sweep,
};
use crate::geometry::NurbsCurve;

/// The surfaces of a tube around a curve, facing outward.
///
/// Straight parts are exact cylinders, arcs of circles exact tori; the rest is
/// [swept](super::sweep()). Where the curve has a kink, a sphere joins the parts, whose ends stay
/// open inside of it: together they look like one body, but they are not one closed surface, and a
/// ray that goes on through the ball may meet the inside of an end. Where the curve pauses, as at a
/// control point that is repeated more often than its degree, the tube goes on. A curve that ends
/// where it begins has no caps. Parts that would be there twice, as where the curve passes a corner
/// again, are made once; [`Drawing`] does the same for several curves.
///
/// # Errors
/// When the radius is not a positive length, or the curve has a gap, is only a point, runs back
/// over itself, or bends with a radius smaller than the tube's, as it does on both sides of a cusp.
pub fn tube(curve: &NurbsCurve, style: &TubeStyle) -> Result<Vec<Component>, ConstructError> {
    let points = curve.points();
    let mut drawing = Drawing::among(points, *style);
    drawing.tube(curve)?;
    drawing.pieces()
}

/// The flat band along a curve, one surface for each of the curve's smooth parts: straight lines
/// across the curve, [swept](super::sweep()) along it. At a corner of the curve each part ends
/// square: the parts overlap on the inside of the corner and leave a notch on its outside. Around a
/// corner in the ribbon's own plane, the overlapping parts coincide: rounding decides which of them
/// is seen and whether one shades the other. Pictures are speckled there, and the rays doubtful.
///
/// # Errors
/// When the width is not a positive length, and as [`sweep`](super::sweep()).
pub fn ribbon(curve: &NurbsCurve, style: &RibbonStyle) -> Result<Vec<Component>, ConstructError> {
    let usable = style.width > 0.0 && style.width.is_finite(); // false for NaN
    if !usable {
        return Err(ConstructError::Width { width: style.width });
    }
    check_fold(curve, "curve")?;
    let called = |error: ConstructError| error.around_a_curve("ribbon");
    let curve = without_stops(curve).map_err(called)?;
    let half = DVec3::X * (style.width / 2.0);
    let profile = NurbsCurve::polyline(&[half, -half]).map_err(ConstructError::of("ribbon"))?;
    let options = SweepOptions {
        up: style.up,
        twist: style.twist,
        tolerance: style.tolerance,
        ..SweepOptions::default()
    };
    let made = |part: NurbsCurve| {
        let Sweep { surface, deviation } = sweep(&profile, &part, &options)?;
        Ok(Component { kind: ComponentKind::Ribbon, surface, deviation })
    };
    let parts = smooth_parts(&curve).map_err(called)?.into_iter();
    parts.map(|part| made(part).map_err(called)).collect()
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec2};

    use super::*;
    use crate::geometry::KnotVector;
    use crate::geometry::construct::Caps;
    use crate::geometry::shapes::circle_arc;

    fn counts(pieces: &[Component]) -> [usize; 3] {
        let kinds = [ComponentKind::Tube, ComponentKind::Joint, ComponentKind::Cap];
        kinds.map(|kind| pieces.iter().filter(|p| p.kind == kind).count())
    }

    /// The distances from a point to the lines on which the sides of a polygon lie, and to
    /// the nearest of its corners.
    fn distances(point: DVec3, corners: &[DVec3]) -> (Vec<f64>, f64) {
        let to_line = |pair: &[DVec3]| {
            let along = (pair[1] - pair[0]).normalize();
            (point - pair[0]).reject_from_normalized(along).length()
        };
        let to_corners = corners.iter().map(|corner| point.distance(*corner));
        (corners.windows(2).map(to_line).collect(), to_corners.fold(f64::INFINITY, f64::min))
    }

    /// The radius is accurate however long the curve is: to a thousandth of the reach of the
    /// circle's control points.
    #[test]
    fn thin_tubes_have_their_radius() {
        let points = [[0.0, 0.0, 0.0], [500.0, 1000.0, 0.0], [1000.0, -800.0, 300.0]];
        let curve = NurbsCurve::bezier(&points.map(DVec3::from)).unwrap();
        // As far as rounding allows.
        for (radius, offset) in [(1e-8, 0.0), (1e-4, 1e6), (1e-4, 1e9)] {
            let far = DAffine3::from_translation(DVec3::splat(offset));
            let style = TubeStyle { radius, caps: Caps::Open, tolerance: None };
            assert!(tube(&curve.transformed(&far).unwrap(), &style).is_ok(), "{radius}, {offset}");
        }
        for radius in [1.0, 1e-2, 1e-4] {
            let style = TubeStyle { radius, caps: Caps::Open, tolerance: None };
            let [Component { surface, deviation, .. }] = &tube(&curve, &style).unwrap()[..] else {
                panic!("one tube")
            };
            assert!(*deviation <= 1.5e-3 * radius, "{radius}: {deviation}");
            let [[a, b], [c, d]] = surface.domain();
            for (i, j) in (0..=40).flat_map(|i| (0..=12).map(move |j| (i, j))) {
                let v = c + (d - c) * f64::from(i) / 40.0;
                let point = surface.point_at(DVec2::new(a + (b - a) * f64::from(j) / 12.0, v));
                let off = point.distance(curve.point_at(v)) / radius - 1.0;
                assert!(off.abs() <= 1.5e-3, "{radius}: {off}");
            }
        }
    }

    #[test]
    fn a_polygon_is_cylinders_joints_and_caps_at_one_distance() {
        for size in [1e-8, 1.0, 1e8] {
            let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 1.0], [0.0, 2.0, 5.0]];
            let corners = corners.map(|corner| size * DVec3::from(corner));
            let polygon = NurbsCurve::polyline(&corners).unwrap();
            let style = TubeStyle { radius: 0.1 * size, ..TubeStyle::default() };
            let pieces = tube(&polygon, &style).unwrap();
            assert_eq!(counts(&pieces), [3, 2, 2]);
            for piece in &pieces {
                assert_eq!(piece.deviation, 0.0);
                let [[a, b], [c, d]] = piece.surface.domain();
                for (i, j) in (0..=12).flat_map(|i| (0..=12).map(move |j| (i, j))) {
                    let share = [f64::from(i) / 12.0, f64::from(j) / 12.0];
                    let (u, v) = (a + share[0] * (b - a), c + share[1] * (d - c));
                    let (lines, corner) =
                        distances(piece.surface.point_at(DVec2::new(u, v)), &corners);
                    let right = |distance: &f64| (distance / size - 0.1).abs() < 1e-14;
                    let fits = match piece.kind {
                        ComponentKind::Tube => lines.iter().any(right),
                        _ => right(&corner),
                    };
                    assert!(fits, "{}: ({u}, {v})", piece.kind);
                }
            }
            let style = TubeStyle { caps: Caps::Flat, ..style };
            assert_eq!(counts(&tube(&polygon, &style).unwrap()), [3, 2, 2]);
            let style = TubeStyle { caps: Caps::Open, ..style };
            assert_eq!(counts(&tube(&polygon, &style).unwrap()), [3, 2, 0]);
        }
    }

    #[test]
    fn caps_face_outward_and_close_the_tube() {
        let line = NurbsCurve::polyline(&[DVec3::ZERO, DVec3::new(1.0, 2.0, 2.0)]).unwrap();
        for caps in [Caps::Flat, Caps::Round] {
            let style = TubeStyle { radius: 0.5, caps, tolerance: None };
            let pieces = tube(&line, &style).unwrap();
            let center = DVec3::new(0.5, 1.0, 1.0);
            for piece in &pieces {
                let [[a, b], [c, d]] = piece.surface.domain();
                let (u, v) = (a + 0.3 * (b - a), c + 0.4 * (d - c));
                let outward = piece.surface.point_at(DVec2::new(u, v)) - center;
                assert!(
                    piece.surface.normal(DVec2::new(u, v)).unwrap().dot(outward) > 0.0,
                    "{}",
                    piece.kind
                );
            }
        }
    }

    #[test]
    fn closed_curves_have_no_caps() {
        let circle = circle_arc(2.0, 0.0, 360.0).unwrap();
        let style = TubeStyle { radius: 0.1, ..TubeStyle::default() };
        let pieces = tube(&circle, &style).unwrap();
        assert_eq!((counts(&pieces), pieces[0].deviation), ([1, 0, 0], 0.0));
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]];
        let square = square.map(|[x, y]| DVec3::new(x, y, 0.0));
        let triangle = NurbsCurve::polyline(&square).unwrap();
        assert_eq!(counts(&tube(&triangle, &style).unwrap()), [3, 3, 0]);
    }

    #[test]
    fn ribbons_face_up_and_are_as_wide_as_they_should_be() {
        let wave = [[0.0, 0.0], [1.0, 2.0], [2.0, -2.0], [3.0, 0.0]];
        let wave = wave.map(|[x, y]| DVec3::new(x, y, 0.0));
        let curve = NurbsCurve::bezier(&wave).unwrap();
        let style = RibbonStyle { width: 0.2, ..RibbonStyle::default() };
        let pieces = ribbon(&curve, &style).unwrap();
        assert_eq!(pieces.len(), 1);
        let band = &pieces[0].surface;
        let [[a, b], _] = band.domain();
        for k in 0..=20 {
            let v = f64::from(k) / 20.0;
            assert!(band.normal(DVec2::new(0.5 * (a + b), v)).unwrap().distance(DVec3::Z) < 1e-12);
            let across = band.point_at(DVec2::new(a, v)) - band.point_at(DVec2::new(b, v));
            let most = 2.0 * pieces[0].deviation;
            assert!(most < 2e-5 && (across.length() - 0.2).abs() < most, "{v}");
            assert!(across.dot(curve.derivatives(v).first.normalize()).abs() < most);
        }
        assert_eq!(
            ribbon(&curve, &RibbonStyle::default()).unwrap_err().to_string(),
            "width 0: it must be positive and finite"
        );
        assert_eq!(
            tube(&curve, &TubeStyle::default()).unwrap_err().to_string(),
            "tube: radius 0: it must be positive and finite"
        );
    }

    #[test]
    fn a_control_point_four_times_is_a_corner() {
        let points = [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0], [2.0, 0.0], [2.0, 0.0], [2.0, 0.0]];
        let points = points.into_iter().chain([[3.0, 2.0], [4.0, 0.0]]);
        let points = points.map(|[x, y]| DVec3::new(x, y, 0.0)).collect();
        let knots = KnotVector::clamped_uniform(3, 8).unwrap();
        let curve = NurbsCurve::new(knots, points, None).unwrap();
        let style = TubeStyle { radius: 0.1, ..TubeStyle::default() };
        assert_eq!(counts(&tube(&curve, &style).unwrap()), [2, 1, 2]);
        let style = RibbonStyle { width: 0.1, ..RibbonStyle::default() };
        assert_eq!(ribbon(&curve, &style).unwrap().len(), 2);
    }

    /// A tube made slightly thinner than the radius that the message shows does not fail at another
    /// bend.
    #[test]
    fn a_tube_thinner_than_the_tightest_bend_is_made() {
        let bezier = |points: &[[f64; 3]]| {
            NurbsCurve::bezier(&points.iter().copied().map(DVec3::from).collect::<Vec<_>>())
        };
        // P′ = (1, 0, 0) and P″ = (0, −8, −4) in the middle: the radius there is 1 / √80.
        let bend = bezier(&[[0.0, 0.0, 0.0], [0.5, 2.0, 1.0], [1.0, 0.0, 0.0]]).unwrap();
        // Two parts, of which the second is tighter, at places that are not sampled.
        let points = [[0.0, 0.0], [1.0, 1.7], [2.0, 0.0], [2.9, -4.1], [4.0, 0.3]];
        let points = points.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let knots = KnotVector::with_multiplicities(2, &[(0.0, 3), (1.0, 2), (2.0, 3)]).unwrap();
        let two = NurbsCurve::new(knots, points, None).unwrap();
        let hook = bezier(&[[0.0; 3], [3.0, 0.1, 0.0], [-1.9, 0.3, 1.0], [1.0, 1.0, 0.0]]).unwrap();
        for (name, curve) in [("bend", &bend), ("two parts", &two), ("hook", &hook)] {
            let made = |radius| tube(curve, &TubeStyle { radius, ..TubeStyle::default() });
            let told = |radius| match made(radius).unwrap_err() {
                ConstructError::Fold { radius, .. } => radius,
                error => panic!("{name}: {error}"),
            };
            let thick = told(10.0);
            let message = made(10.0).unwrap_err().to_string();
            let shown = message.split("bends with radius ").nth(1).unwrap();
            let shown: f64 = shown.split(' ').next().unwrap().parse().unwrap();
            assert!(shown <= thick && thick - shown < 1e-5 * thick, "{name}: {thick} as {shown}");
            for radius in [1.002 * thick, 1.2 * thick] {
                assert!((told(radius) / thick - 1.0).abs() < 1e-12, "{name}: {radius}");
            }
            assert!(made(shown.next_down()).is_ok(), "{name}: {shown}");

            // No place of the curve has a smaller radius of curvature, except that the 64 places
            // around the tube are off the direction of the centre: cos(π / 64) is 1 - 1.2e-3.
            let [start, end] = curve.domain();
            for k in 1..100_000 {
                let at = curve.derivatives(start + (end - start) * f64::from(k) / 1e5);
                let radius = at.first.length().powi(3) / at.first.cross(at.second).length();
                assert!(radius > thick * (1.0 - 1.3e-3), "{name}: {radius} < {thick}");
            }
        }
        let radius = 80_f64.sqrt().recip();
        let fold = tube(&bend, &TubeStyle { radius: 1.0, ..TubeStyle::default() }).unwrap_err();
        let ConstructError::Fold { radius: told, .. } = fold else { panic!("{fold}") };
        assert!((told - radius).abs() < 1e-12, "{told}");
    }

    #[test]
    fn errors_say_curve_where_a_curve_was_written() {
        let bend = [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let bend = NurbsCurve::bezier(&bend).unwrap();
        let thick = TubeStyle { radius: 2.0, ..TubeStyle::default() };
        let error = tube(&bend, &thick).unwrap_err().to_string();
        // P = (2 t, 4 t (1 − t)): in the middle P′ = (2, 0), P″ = (0, −8).
        assert_eq!(
            error,
            "the tube folds, most of all at t = 0.5 of the curve, (1, 1, 0): the curve bends with \
             radius 0.5 there, and the tube reaches 2 towards the centre"
        );
        let wide = RibbonStyle { width: 4.0, up: Some(DVec3::Z), ..RibbonStyle::default() };
        let error = ribbon(&bend, &wide).unwrap_err().to_string();
        assert!(error.starts_with("the ribbon folds, most of all at t = "), "{error}");
        let along = RibbonStyle { up: Some(DVec3::new(1.0, 2.0, 0.0)), width: 0.1, ..wide };
        let error = ribbon(&bend, &along).unwrap_err().to_string();
        assert!(error.starts_with("up (1, 2, 0) runs along the curve, whose"), "{error}");
        let nowhere = NurbsCurve::bezier(&[DVec3::X; 3]).unwrap();
        assert_eq!(
            tube(&nowhere, &TubeStyle { radius: 0.1, ..thick }).unwrap_err().to_string(),
            "the curve stands still at t = 0, (1, 0, 0): it has no direction there"
        );
    }
}
