//! Trims against closed forms, winding angles and dense polylines.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::{Coverage, Kept, Side, TrimCurve, TrimDomain, TrimLoop, Trims, UvBox};
use crate::geometry::shapes::{self, QuadraticArc, QuarticArc};
use crate::geometry::{Direction, KnotVector, NurbsCurve};
use crate::math::SplitMix;

/// Numbers in [0, 1) that are the same in every run.
pub(super) struct Random(SplitMix);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(SplitMix::new(seed))
    }

    pub(super) fn next(&mut self) -> f64 {
        self.0.unit()
    }

    fn in_box(&mut self, bounds: UvBox) -> DVec2 {
        bounds.min + bounds.size() * DVec2::new(self.next(), self.next())
    }
}

/// A domain that holds everything the tests cut.
pub(super) fn wide() -> TrimDomain {
    TrimDomain::new([-1e12, 1e12], [-1e12, 1e12]).unwrap()
}

pub(super) fn trims(loops: &[TrimLoop]) -> Trims {
    Trims::new(wide(), Kept::Odd, loops).unwrap()
}

fn points(list: &[(f64, f64)]) -> Vec<DVec2> {
    list.iter().map(|&(u, v)| DVec2::new(u, v)).collect()
}

fn polygon(list: &[(f64, f64)]) -> TrimLoop {
    TrimLoop::polygon(&points(list)).unwrap()
}

fn inside(side: Side) -> bool {
    match side {
        Side::Inside => true,
        Side::Outside => false,
        Side::Edge { inside, .. } => inside,
    }
}

fn is_edge(side: Side) -> bool {
    matches!(side, Side::Edge { .. })
}

/// The winding number by summing angles, independently of counting crossings.
fn turns_around(outline: &[DVec2], point: DVec2) -> i64 {
    let angles = outline.windows(2).map(|ends| (ends[0] - point).angle_to(ends[1] - point));
    (angles.sum::<f64>() / TAU).round() as i64
}

/// The distance of a point from a polyline.
fn away(outline: &[DVec2], point: DVec2) -> f64 {
    let to_line = |ends: &[DVec2]| {
        let along = ends[1] - ends[0];
        let part = ((point - ends[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (point - ends[0] - part * along).length()
    };
    outline.windows(2).map(to_line).fold(f64::INFINITY, f64::min)
}

#[test]
fn circles_are_where_pythagoras_puts_them() {
    let mut random = Random::new(1);
    for size in [1e-8, 1e-3, 1.0, 1e3, 1e8] {
        for shift in [0.0, 1.0, -1e3] {
            let center = size * DVec2::new(shift, 0.3 * shift);
            let radius = 0.7 * size;
            let circle = trims(&[TrimLoop::circle(center, radius).unwrap()]);
            // The distance within which a point may be an edge: the reach of degree 2, in both
            // directions.
            let reach = 48.0 * f64::EPSILON / 2.0 * (center.abs().max_element() + radius);
            for k in 0..3000 {
                let angle = TAU * random.next();
                let near = 10f64.powf(-16.0 * random.next());
                let off = if k % 2 == 0 { 1.0 + near } else { 1.0 - near };
                let point = center + radius * off * DVec2::from_angle(angle);
                let distance = (point - center).length() - radius;
                let side = circle.side_of(point);
                if distance.abs() > 2.0 * reach {
                    assert_eq!(side == Side::Inside, distance < 0.0, "{point} of {center}");
                    assert!(!is_edge(side), "{distance:e} from an edge of {radius}");
                } else if distance.abs() < 0.25 * reach {
                    assert!(is_edge(side), "{distance:e} from an edge of {radius}");
                }
            }
        }
    }
}

#[test]
fn all_circles_of_the_source_note_cut_the_same() {
    let mut random = Random::new(2);
    let arc = |curve: &NurbsCurve| TrimCurve::nurbs(curve).unwrap();
    let to_center = |from: (f64, f64), to: (f64, f64)| {
        TrimCurve::polyline(&points(&[from, (0.0, 0.0), to])).unwrap()
    };
    let quarters = [
        shapes::quarter_circle_quadratic(QuadraticArc::Rational),
        shapes::quarter_circle_quadratic(QuadraticArc::Symmetric),
        shapes::quarter_circle_quartic(QuarticArc::First),
        shapes::quarter_circle_quartic(QuarticArc::Second),
    ];
    let quarter = quarters.map(|q| TrimLoop::new(&[arc(&q), to_center((0.0, 1.0), (1.0, 0.0))]));
    let half = [arc(&shapes::half_circle_cubic()), to_center((0.0, -1.0), (0.0, 1.0))];
    let whole = TrimLoop::new(&[arc(&shapes::circle_cubic())]);
    let turned = TrimCurve::arc(DVec2::ZERO, 1.0, 0.3, 0.3 - TAU).unwrap();
    let whole = [whole.unwrap(), TrimLoop::new(&[turned]).unwrap()].map(|l| trims(&[l]));
    let half = trims(&[TrimLoop::new(&half).unwrap()]);
    let quarter = quarter.map(|l| trims(&[l.unwrap()]));
    for _ in 0..5000 {
        let point = random.in_box(UvBox::new([-1.2, 1.2], [-1.2, 1.2]));
        let round = point.length() < 1.0;
        assert!(whole.iter().all(|t| inside(t.side_of(point)) == round), "{point}");
        assert_eq!(inside(half.side_of(point)), round && point.x > 0.0, "{point}");
        let right = round && point.min_element() > 0.0;
        assert!(quarter.iter().all(|t| inside(t.side_of(point)) == right), "{point}");
    }
}

/// A letter B on a grid: outline, two counters, and an island in the upper one.
pub(super) fn letter() -> Vec<TrimLoop> {
    vec![
        polygon(&[
            (0., 0.),
            (5., 0.),
            (6., 1.),
            (6., 3.),
            (5., 4.),
            (6., 5.),
            (6., 7.),
            (5., 8.),
            (0., 8.),
        ]),
        polygon(&[(1., 1.), (1., 3.), (5., 3.), (5., 1.)]),
        polygon(&[(1., 5.), (5., 5.), (5., 7.), (1., 7.)]),
        polygon(&[(2., 5.5), (2., 6.5), (4., 6.5), (4., 5.5)]),
    ]
}

fn in_letter(p: DVec2) -> bool {
    let within = |u: [f64; 2], v: [f64; 2]| UvBox::new(u, v).holds(p);
    // The corners cut at 45° at the top and the bottom.
    let right = 6.0 - ((p.y - 4.0).abs() - 3.0).max(0.0);
    // The waist: 45° notches to (5, 4).
    let notch = if (3.0..=5.0).contains(&p.y) { 5.0 + (p.y - 4.0).abs() } else { right };
    let outline = p.x >= 0.0 && (0.0..=8.0).contains(&p.y) && p.x <= notch.min(right);
    let lower = within([1.0, 5.0], [1.0, 3.0]);
    let upper = within([1.0, 5.0], [5.0, 7.0]) && !within([2.0, 4.0], [5.5, 6.5]);
    outline && !lower && !upper
}

#[test]
fn a_letter_with_counters_and_an_island() {
    let letter = trims(&letter());
    // On a grid that holds every height of a corner, and points of horizontal edges, but of no
    // others.
    for j in -1..=17 {
        for i in -2..=26 {
            let point = DVec2::new(0.25 * f64::from(i) + 0.0625, 0.5 * f64::from(j));
            let on_edge = letter.meets(&UvBox::about(point, DVec2::ZERO));
            assert_eq!(is_edge(letter.side_of(point)), on_edge);
            if !on_edge {
                assert_eq!(inside(letter.side_of(point)), in_letter(point), "{point}");
            }
        }
    }
    let mut random = Random::new(3);
    for _ in 0..5000 {
        let point = random.in_box(UvBox::new([-1.0, 7.0], [-1.0, 9.0]));
        assert_eq!(inside(letter.side_of(point)), in_letter(point), "{point}");
    }
}

#[test]
fn what_is_kept_can_be_turned_inside_out() {
    let domain = TrimDomain::new([-1.0, 7.0], [-1.0, 9.0]).unwrap();
    let odd = Trims::new(domain, Kept::Odd, &letter()).unwrap();
    let even = Trims::new(domain, Kept::Even, &letter()).unwrap();
    let mut framed = vec![TrimLoop::rectangle(domain.bounds()).unwrap()];
    framed.extend(letter());
    let framed = Trims::new(domain, Kept::Odd, &framed).unwrap();
    let mut random = Random::new(4);
    for _ in 0..2000 {
        let point = random.in_box(domain.bounds());
        assert_ne!(odd.side_of(point), even.side_of(point));
        assert_eq!(even.side_of(point), framed.side_of(point));
    }
}

#[test]
fn corners_and_pieces_of_every_direction_are_edges() {
    // Horizontal, vertical and slanted pieces, reflex corners, at several magnitudes.
    let shape =
        [(0., 0.), (4., 0.), (4., 3.), (3., 3.), (3., 1.), (2., 2.), (1., 1.), (1., 3.), (0., 3.)];
    for scale in [1e-8, 1.0, 3e7] {
        let corners: Vec<(f64, f64)> = shape.iter().map(|&(u, v)| (u * scale, v * scale)).collect();
        let trims = trims(&[polygon(&corners)]);
        for k in 0..corners.len() {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            for part in [0.0, 0.25, 0.5, 1.0] {
                let point = DVec2::new(a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1));
                assert!(is_edge(trims.side_of(point)), "{point}");
                assert!(trims.meets(&UvBox::about(point, DVec2::ZERO)));
            }
        }
        // Level with corners, between and beside them.
        for (u, v, expected) in [
            (0.5, 3.0, None),
            (2.0, 3.0, Some(false)),
            (3.5, 2.0, Some(true)),
            (0.5, 1.0, Some(true)),
            (1.5, 1.0, Some(true)),
            (2.5, 2.0, Some(false)),
            (5.0, 0.0, Some(false)),
            (-1.0, 0.0, Some(false)),
            (-1.0, 1.0, Some(false)),
            (-1.0, 2.0, Some(false)),
            (-1.0, 3.0, Some(false)),
            (2.0, 1.5, Some(true)),
        ] {
            let side = trims.side_of(scale * DVec2::new(u, v));
            assert_eq!(is_edge(side), expected.is_none(), "({u}, {v})");
            assert!(expected.is_none_or(|expected| inside(side) == expected), "({u}, {v})");
        }
    }
}

#[test]
fn star_polygons_wind_as_their_angles_say() {
    let mut random = Random::new(5);
    for _ in 0..40 {
        let count = 3 + (20.0 * random.next()) as usize;
        let center = DVec2::new(random.next(), random.next());
        let mut corners: Vec<DVec2> = (0..count)
            .map(|k| {
                let angle = TAU * (k as f64 + 0.4 * random.next()) / count as f64;
                center + (0.2 + random.next()) * DVec2::from_angle(angle)
            })
            .collect();
        let star = trims(&[TrimLoop::polygon(&corners).unwrap()]);
        corners.push(corners[0]);
        for _ in 0..300 {
            let point = random.in_box(UvBox::new([-1.5, 2.5], [-1.5, 2.5]));
            let expected = turns_around(&corners, point) != 0;
            assert_eq!(inside(star.side_of(point)), expected, "{point} in {corners:?}");
        }
    }
}

/// A closed, clamped spline around the origin: a circle of `count` control points at random radii.
pub(super) fn smooth(random: &mut Random, degree: usize, count: usize) -> NurbsCurve {
    let mut points: Vec<DVec3> = (0..count)
        .map(|k| {
            let turn = DVec2::from_angle(TAU * k as f64 / count as f64);
            ((0.5 + random.next()) * turn).extend(0.0)
        })
        .collect();
    points.push(points[0]);
    let weights = (0..=count).map(|_| 0.3 + 2.0 * random.next()).collect();
    let knots = KnotVector::clamped_uniform(degree, count + 1).unwrap();
    NurbsCurve::new(knots, points, Some(weights)).unwrap()
}

#[test]
fn smooth_loops_agree_with_dense_polylines() {
    let mut random = Random::new(6);
    for degree in [1, 2, 3, 4, 5, 7] {
        for _ in 0..4 {
            let curve = smooth(&mut random, degree, 9 + degree);
            let samples = 4000;
            let outline: Vec<DVec2> = (0..=samples)
                .map(|k| curve.point_at(f64::from(k) / f64::from(samples)).truncate())
                .collect();
            let cut = trims(&[TrimLoop::new(&[TrimCurve::nurbs(&curve).unwrap()]).unwrap()]);
            for k in 0..400 {
                let mut point = random.in_box(UvBox::new([-1.6, 1.6], [-1.6, 1.6]));
                if k % 2 == 0 {
                    // Near the curve, where the segments' rectangles do not decide.
                    let on = outline[(random.next() * 4000.0) as usize];
                    point = on + 0.02 * (point - on);
                }
                if away(&outline, point) > 1e-4 {
                    let expected = turns_around(&outline, point) % 2 != 0;
                    assert_eq!(inside(cut.side_of(point)), expected, "{point}, degree {degree}");
                    assert!(!is_edge(cut.side_of(point)));
                }
            }
        }
    }
}

#[test]
fn points_of_the_curve_are_edges_and_their_surroundings_are_not() {
    let mut random = Random::new(7);
    for degree in 1..=9 {
        for (scale, shift) in [(1.0, 0.0), (1e-8, 0.0), (1e8, 0.0), (1.0, 1e6)] {
            let unit = smooth(&mut random, degree, 8 + degree);
            let place = |c: DVec3| scale * c + DVec3::new(shift, -0.5 * shift, 0.0);
            let count = unit.knots().point_count();
            let moved = (0..count).map(|k| place(unit.vertex(k))).collect();
            let weights = (0..count).map(|k| unit.control()[k].w).collect();
            let curve = NurbsCurve::new(unit.knots().clone(), moved, Some(weights)).unwrap();
            let cut = trims(&[TrimLoop::new(&[TrimCurve::nurbs(&curve).unwrap()]).unwrap()]);
            let magnitude = 2.0 * scale + shift;
            let reach = 16.0 * (degree + 1) as f64 * f64::EPSILON / 2.0 * magnitude;
            for k in 0..=300 {
                let t = f64::from(k) / 300.0;
                let on = curve.derivatives(t);
                assert!(is_edge(cut.side_of(on.point.truncate())), "{degree} {scale} {shift} {t}");
                let normal = on.first.truncate().perp().normalize();
                let corner = |knot: &f64| degree == 1 && (t - knot).abs() < 1e-9;
                let smooth = !curve.knots().values().iter().any(corner);
                if k % 300 > 0 && smooth {
                    // Across the curve and off it: the two sides differ and are certain.
                    let off = 40.0 * reach * normal;
                    let (a, b) = (on.point.truncate() + off, on.point.truncate() - off);
                    let sides = [cut.side_of(a), cut.side_of(b)];
                    assert!(!sides.iter().any(|s| is_edge(*s)), "{degree} {scale} {shift} {t}");
                    assert!(inside(sides[0]) != inside(sides[1]), "{degree} {t}");
                }
            }
        }
    }
}

#[test]
fn direction_does_not_matter_bit_for_bit() {
    let mut random = Random::new(8);
    for degree in 1..=6 {
        let curve = smooth(&mut random, degree, 12);
        let forth = TrimLoop::new(&[TrimCurve::nurbs(&curve).unwrap()]).unwrap();
        let there = trims(std::slice::from_ref(&forth));
        let back = trims(&[forth.reversed()]);
        for k in 0..2000 {
            let on = curve.point_at(random.next()).truncate();
            let spread = 10f64.powi(-(k % 17));
            let point = on + spread * (DVec2::new(random.next(), random.next()) - 0.5);
            assert_eq!(there.side_of(point), back.side_of(point));
        }
    }
}

#[test]
fn loops_across_a_seam_are_loops_moved_by_the_period() {
    let domain = TrimDomain::new([0.0, TAU], [0.0, 1.0]).unwrap().periodic_in(Direction::U);
    let hole = |u: f64| TrimLoop::circle(DVec2::new(u, 0.5), 0.3).unwrap();
    let at = |u: f64| Trims::new(domain, Kept::Even, &[hole(u)]).unwrap();
    let seams = [at(0.0), at(TAU), at(-3.0 * TAU)];
    let both = Trims::new(
        TrimDomain::new([0.0, TAU], [0.0, 1.0]).unwrap(),
        Kept::Even,
        &[hole(0.0), hole(TAU)],
    )
    .unwrap();
    let mut random = Random::new(9);
    for _ in 0..3000 {
        let point = random.in_box(domain.bounds());
        let expected = both.side_of(point);
        assert!(seams.iter().all(|t| t.side_of(point) == expected), "{point}");
        let u = point.x.min(TAU - point.x);
        assert_eq!(inside(expected), DVec2::new(u, point.y - 0.5).length() > 0.3, "{point}");
    }
    assert_eq!(seams[0].loop_count(), 2);
    assert_eq!(at(PI).loop_count(), 1);

    // A torus: a loop at the corner comes four times.
    let torus = domain.periodic_in(Direction::V);
    let corner = TrimLoop::circle(DVec2::new(0.0, 1.0), 0.25).unwrap();
    let corner = Trims::new(torus, Kept::Even, &[corner]).unwrap();
    assert_eq!(corner.loop_count(), 4);
    for (u, v) in [(0.1, 0.1), (6.2, 0.1), (0.1, 0.9), (6.2, 0.9)] {
        assert_eq!(corner.side_of(DVec2::new(u, v)), Side::Outside);
    }
    assert_eq!(corner.side_of(DVec2::new(0.2, 0.2)), Side::Inside);
}

#[test]
fn a_cylinder_cut_by_a_wave_is_a_sheet_unrolled() {
    // v below 1 + ½ sin u, over the whole turn: the wave's loop runs along the seam.
    let domain = TrimDomain::new([0.0, TAU], [0.0, 2.0]).unwrap().periodic_in(Direction::U);
    let wave = |k: i32| {
        let u = TAU * f64::from(k) / 500.0;
        DVec2::new(u, 1.0 + 0.5 * u.sin())
    };
    let mut corners = points(&[(0.0, 0.0), (TAU, 0.0)]);
    corners.extend((0..=500).rev().map(wave));
    let trims = Trims::new(domain, Kept::Odd, &[TrimLoop::polygon(&corners).unwrap()]).unwrap();
    assert_eq!(trims.loop_count(), 1, "touching the border is not crossing it");
    let mut random = Random::new(10);
    for _ in 0..2000 {
        let point = random.in_box(domain.bounds());
        let height = 1.0 + 0.5 * point.x.sin();
        if (point.y - height).abs() > 1e-4 {
            assert_eq!(inside(trims.side_of(point)), point.y < height, "{point}");
        }
    }
}

#[test]
fn rectangles_are_classified_without_error() {
    let mut random = Random::new(11);
    let curve = smooth(&mut random, 3, 11);
    let island = TrimLoop::circle(DVec2::new(0.01, 0.02), 0.05).unwrap();
    let cut = trims(&[TrimLoop::new(&[TrimCurve::nurbs(&curve).unwrap()]).unwrap(), island]);
    let outlines = cut.outlines(1e-9).unwrap();
    let mut counts = [0; 3];
    for _ in 0..4000 {
        let center = random.in_box(UvBox::new([-1.6, 1.6], [-1.6, 1.6]));
        let size = 0.4 * DVec2::new(random.next().powi(3), random.next().powi(3));
        let rect = UvBox::about(center, size);
        let coverage = cut.classify(&rect);
        let corners = (0..25)
            .map(|k| rect.min + rect.size() * DVec2::new(f64::from(k % 5), f64::from(k / 5)) / 4.0);
        match coverage {
            Coverage::Inside => corners.for_each(|p| assert_eq!(cut.side_of(p), Side::Inside)),
            Coverage::Outside => corners.for_each(|p| assert_eq!(cut.side_of(p), Side::Outside)),
            // Mixed is returned only if a curve does pass through.
            Coverage::Mixed => {
                let near = outlines.iter().map(|o| away(o, center)).fold(f64::INFINITY, f64::min);
                assert!(near <= size.length() * 1.001 + 1e-9, "{rect:?}");
            }
        }
        counts[coverage as usize] += 1;
    }
    assert!(counts.iter().all(|count| *count > 300), "{counts:?}");
}

#[test]
fn what_is_kept_of_a_rectangle_is_within_a_close_one() {
    let mut random = Random::new(16);
    for degree in [1, 2, 3, 5] {
        let curve = smooth(&mut random, degree, 9 + degree);
        let cut = trims(&[TrimLoop::new(&[TrimCurve::nurbs(&curve).unwrap()]).unwrap()]);
        let (mut nothing, mut smaller, mut close) = (0, 0, 0);
        for _ in 0..1000 {
            let center = random.in_box(UvBox::new([-1.6, 1.6], [-1.6, 1.6]));
            let size = 0.5 * DVec2::new(random.next().powi(3), random.next().powi(3));
            let rect = UvBox::about(center, size);
            let kept = cut.kept_within(&rect);
            let mut seen = UvBox::EMPTY;
            let steps = 40;
            for k in 0..=steps * steps {
                let place = DVec2::new(f64::from(k % steps), f64::from(k / steps));
                let point = (rect.min + rect.size() * place / f64::from(steps)).min(rect.max);
                if cut.side_of(point) != Side::Outside {
                    assert!(kept.is_some_and(|kept| kept.holds(point)), "{point} of {rect:?}");
                    seen = seen.union(UvBox { min: point, max: point });
                }
            }
            nothing += u32::from(kept.is_none());
            // Corners of the curve may reach between the points.
            let spare = 4.0 * rect.size() / f64::from(steps);
            if let Some(kept) = kept.filter(|kept| *kept != rect && seen != UvBox::EMPTY) {
                let about = seen.grown(spare);
                close += u32::from(about.holds(kept.min) && about.holds(kept.max));
                smaller += 1;
            }
        }
        assert!(nothing > 100 && smaller > 100, "{degree}: {nothing} {smaller}");
        assert!(f64::from(close) > 0.9 * f64::from(smaller), "{degree}: {close} of {smaller}");
    }
}

#[test]
fn what_runs_along_the_border_cuts_nothing() {
    let domain = TrimDomain::new([-1.0, 3.0], [0.0, 0.3]).unwrap();
    let bounds = domain.bounds();
    let border = TrimLoop::rectangle(bounds).unwrap();
    // The left half is cut off, and so is a notch at the upper border.
    let half = polygon(&[(-1.0, 0.0), (1.0, 0.0), (1.0, 0.3), (-1.0, 0.3)]);
    let notch = polygon(&[(1.5, 0.3), (2.5, 0.3), (2.5, 0.2), (1.5, 0.2)]);
    for turned in [false, true] {
        let classify = |loops: &[TrimLoop], u: [f64; 2], v: [f64; 2]| {
            let trims = Trims::new(domain, Kept::Odd, loops).unwrap();
            let (trims, u) = if turned {
                (trims.reversed_u([5.0, 9.0]), [8.0 - u[1], 8.0 - u[0]])
            } else {
                (trims, u)
            };
            trims.classify(&UvBox::new(u, v))
        };
        let whole = [border.clone()];
        let cut = [border.clone(), half.clone(), notch.clone()];
        assert_eq!(classify(&whole, [-1.0, 3.0], [0.0, 0.3]), Coverage::Inside);
        assert_eq!(classify(&cut, [-1.0, 0.9], [0.0, 0.3]), Coverage::Outside);
        assert_eq!(classify(&cut, [-1.0, 1.1], [0.0, 0.3]), Coverage::Mixed);
        assert_eq!(classify(&cut, [1.1, 1.4], [0.0, 0.3]), Coverage::Inside);
        assert_eq!(classify(&cut, [1.6, 2.4], [0.21, 0.3]), Coverage::Outside);
        assert_eq!(classify(&cut, [1.1, 3.0], [0.0, 0.19]), Coverage::Inside);
        assert_eq!(classify(&cut, [1.1, 3.0], [0.0, 0.3]), Coverage::Mixed);
        // What runs beside the border cuts, if only by a few roundings.
        let expected =
            [(1e-10, Coverage::Mixed), (1e-14, Coverage::Mixed), (2e-16, Coverage::Inside)];
        for (off, expected) in expected {
            let beside = TrimLoop::rectangle(UvBox::new([-1.0, 3.0 - off], [off, 0.3])).unwrap();
            assert_eq!(classify(&[beside], [-1.0, 3.0], [0.0, 0.3]), expected, "{off:e}");
        }
    }
}

#[test]
fn nearness_of_a_circle_is_its_distance() {
    let circle = trims(&[TrimLoop::circle(DVec2::new(3.0, 2.0), 1.0).unwrap()]);
    let mut random = Random::new(12);
    for _ in 0..5000 {
        let point = random.in_box(UvBox::new([1.5, 4.5], [0.5, 3.5]));
        let reach = 0.3 * DVec2::new(random.next(), random.next());
        // The rectangle meets the circle if it has points inside and points outside.
        let offset = (point - DVec2::new(3.0, 2.0)).abs();
        let farthest = (offset + reach).length();
        let nearest = (offset - reach).max(DVec2::ZERO).length();
        if (farthest - 1.0).abs().min((nearest - 1.0).abs()) > 1e-12 {
            assert_eq!(circle.meets(&UvBox::about(point, reach)), nearest < 1.0 && 1.0 < farthest);
        }
    }
    assert!(circle.meets(&UvBox::about(DVec2::new(50.0, 2.0), DVec2::new(f64::INFINITY, 0.5))));
    assert!(!circle.meets(&UvBox::about(DVec2::new(f64::NAN, 2.0), DVec2::ONE)));
    assert_eq!(circle.side_of(DVec2::new(3.0, f64::NAN)), Side::Outside);
}

#[test]
fn outlines_keep_their_tolerance() {
    let circle = TrimLoop::circle(DVec2::new(1.0, -1.0), 2.0).unwrap();
    for tolerance in [1e-1, 1e-4, 1e-8] {
        let outlines = trims(std::slice::from_ref(&circle)).outlines(tolerance).unwrap();
        let outline = &outlines[0];
        assert_eq!(outline[0], outline[outline.len() - 1]);
        assert_eq!(outline[0], DVec2::new(3.0, -1.0));
        for ends in outline.windows(2) {
            let middle = 0.5 * (ends[0] + ends[1]) - DVec2::new(1.0, -1.0);
            assert!(2.0 - middle.length() <= tolerance, "{middle}");
            assert!(middle.perp_dot(ends[1] - DVec2::new(1.0, -1.0)) > 0.0, "it runs as given");
        }
        // Control points are farther off than the curve, and parts are halved: fewer than four
        // times as many chords as are needed, and a few.
        let needed = PI / (tolerance / 2.0).sqrt() / 2f64.sqrt();
        assert!((outline.len() as f64) < 4.0 * needed + 8.0, "{} points", outline.len());
    }
    assert!(trims(std::slice::from_ref(&circle)).outlines(0.0).is_err());
    assert!(trims(&[circle]).outlines(1e-30).is_err());
}
