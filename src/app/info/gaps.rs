//! How the borders of a model fit together: gaps between them let rays through.

use std::collections::BTreeSet;

use glam::DVec3;
use nurbray::geometry::{Chart, Charts, Surface};

use super::edges::{Edge, Edges};
use super::nearest::Crowd;
use super::nearness::Nearness;
use super::neighbours::{Beside, Widest, side_by_side};
use super::turns::Turns;

/// Two borders that run side by side without meeting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    /// The borders, in the order of the surfaces.
    pub(crate) edges: [Edge; 2],
    /// The largest distance found between them, where they run side by side.
    pub(crate) width: f64,
    /// Where that is.
    pub(crate) at: DVec3,
}

/// A border that no other one runs beside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FreeBorder {
    pub(crate) edge: Edge,
    /// The length of what trims keep of it.
    pub(crate) length: f64,
    /// A point about in the middle of that.
    pub(crate) at: DVec3,
}

/// How the borders of a model fit together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fit {
    /// Borders in total, trim edges included: four a surface, three a triangle, and two at each
    /// knot where it may jump, except those that trims have cut off.
    pub(crate) borders: usize,
    /// Of these, trim edges, counted from corner to corner.
    pub(crate) trim_edges: usize,
    /// Of these, collapsed to a point.
    pub(crate) collapsed: usize,
    /// Of the others, those that meet another to within rounding.
    pub(crate) meeting: usize,
    /// Those that run beside another and only nearly meet it.
    pub(crate) nearly: usize,
    /// Those with no other beside them, the longest first.
    pub(crate) free: Vec<FreeBorder>,
    /// The gaps, the widest first.
    pub(crate) gaps: Vec<Gap>,
    /// How the surfaces are turned where two borders meet, or nearly.
    pub(crate) turns: Turns,
}

/// Compares every border and trim edge with the others beside it, as far as no third one lies
/// between: see [`nearest`](super::nearest).
///
/// `drawings` gives the drawing (a tube, a net) that each surface belongs to, if any. Tubes and
/// joints of one drawing run into each other, so borders that nearly meet there have no gap, and
/// those that meet are not judged.
/// `sizes` are the sizes of the objects that the surfaces belong to.
pub(crate) fn fit(surfaces: &[Surface], drawings: &[Option<[usize; 2]>], sizes: &[f64]) -> Fit {
    let charts: Vec<Vec<Chart<'_>>> = surfaces.iter().map(Charts::charts).collect();
    let edges = Edges::of(surfaces, &charts);
    let nearness = Nearness::new(&edges, sizes);
    let crowd = Crowd::new(&edges, &nearness);
    let is_drawn = |two: [Edge; 2]| {
        let [a, b] = two.map(|edge| drawings.get(edge.surface).copied().flatten());
        a.is_some() && a == b
    };
    let mut meeting = BTreeSet::new();
    let mut beside = BTreeSet::new();
    let mut gaps = Vec::new();
    for (pair, Beside { met, open }) in side_by_side(&crowd) {
        let two = pair.map(|k| edges.curves[k].0);
        if met {
            meeting.extend(pair);
        } else if let Some(Widest { distance: width, at }) = open.filter(|_| !is_drawn(two)) {
            beside.extend(pair);
            gaps.push(Gap { edges: two, width, at });
        }
    }
    gaps.sort_by(|a, b| b.width.total_cmp(&a.width)); // stable: equal ones keep their order
    let turns = Turns::of(&crowd, |pair| !is_drawn(pair));
    let nearly = beside.difference(&meeting).count();
    let alone = |k: &usize| !meeting.contains(k) && !beside.contains(k);
    let mut free: Vec<FreeBorder> = (0..edges.curves.len())
        .filter(alone)
        .map(|k| {
            let (edge, curve) = &edges.curves[k];
            FreeBorder { edge: *edge, length: curve.kept_arc_length(), at: curve.kept_middle() }
        })
        .collect();
    free.sort_by(|a, b| b.length.total_cmp(&a.length)); // stable
    let Edges { curves, collapsed, trim_edges, .. } = edges;
    Fit {
        borders: curves.len() + collapsed,
        trim_edges,
        collapsed,
        meeting: meeting.len(),
        nearly,
        free,
        gaps,
        turns,
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat, DVec2};
    use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
    use nurbray::geometry::{KnotVector, NurbsSurface, TrimmedSurface, shapes};

    use super::super::nearest::KEPT;
    use super::super::which::Which;
    use super::*;

    /// [`super::fit`] of whole surfaces.
    fn fit(surfaces: &[NurbsSurface], size: f64) -> Fit {
        let surfaces: Vec<Surface> = surfaces.iter().cloned().map(Surface::from).collect();
        super::fit(&surfaces, &[], &vec![size; surfaces.len()])
    }

    #[test]
    fn the_parts_of_one_drawing_have_no_gaps() {
        let sheets = [plane_at(0.0, 0.0, 0.0), plane_at(1.0 + 1e-6, 0.0, 0.0)].map(Surface::from);
        let gaps = |drawings: [Option<[usize; 2]>; 2]| {
            super::fit(&sheets, &drawings, &[2.0; 2]).gaps.len()
        };
        assert_eq!(gaps([Some([3, 0]); 2]), 0);
        assert_eq!(gaps([Some([3, 0]), Some([4, 0])]), 1);
        assert_eq!(gaps([Some([3, 0]), None]), 1);
    }

    fn plane_at(x: f64, y: f64, z: f64) -> NurbsSurface {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        plane.transformed(&DAffine3::from_translation(DVec3::new(x, y, z))).unwrap()
    }

    /// Of gaps one behind another, those between neighbours are listed and few others; copies of
    /// one plate have none.
    #[test]
    fn stacks_have_gaps_between_neighbours() {
        let askew = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.6);
        for turn in [DQuat::IDENTITY, askew] {
            // Two stacks of 15, ten times as far apart as their plates.
            let height = |k: usize| 1e-5 * (k + if k < 15 { 0 } else { 9 }) as f64;
            let plates: Vec<NurbsSurface> = (0..30)
                .map(|k| {
                    let turned = DAffine3::from_rotation_translation(turn, DVec3::ZERO);
                    plane_at(0.0, 0.0, height(k)).transformed(&turned).unwrap()
                })
                .collect();
            let stack = fit(&plates, 2.0);
            assert_eq!((stack.borders, stack.nearly, stack.free.len()), (120, 120, 0));
            assert!(stack.gaps.len() < 4 * 30 * KEPT, "{}", stack.gaps.len());
            for k in 1..30 {
                let width = height(k) - height(k - 1);
                let between = |gap: &&Gap| gap.edges.map(|edge| edge.surface) == [k - 1, k];
                let found: Vec<f64> =
                    stack.gaps.iter().filter(between).map(|gap| gap.width).collect();
                assert_eq!(found.len(), 4, "{k}");
                assert!(found.iter().all(|it| (it - width).abs() < 1e-14), "{k}: {found:?}");
            }
        }
        let copies = fit(&vec![plane_at(0.0, 0.0, 0.0); 30], 2.0);
        assert_eq!((copies.meeting, copies.nearly, copies.gaps.len()), (120, 0, 0));
    }

    #[test]
    fn a_gap_is_as_wide_as_it_was_made_at_every_size() {
        for scale in [1e-8, 1.0, 1e8] {
            for width in [1e-4, 1e-7, 1e-10] {
                let sheets = [plane_at(0.0, 0.0, 0.0), plane_at(1.0 + width, 0.0, 0.0)];
                let enlarge = DAffine3::from_scale(DVec3::splat(scale));
                let sheets = sheets.map(|sheet| sheet.transformed(&enlarge).unwrap());
                let fit = fit(&sheets, 2.0 * scale);
                assert_eq!((fit.borders, fit.nearly, fit.free.len()), (8, 2, 6), "{scale} {width}");
                assert_eq!(fit.gaps.len(), 1);
                let found = fit.gaps[0].width / scale;
                assert!((found - width).abs() < 1e-14, "{scale}: {found} for {width}");
            }
        }
    }

    #[test]
    fn sheets_that_meet_or_are_apart_have_no_gap() {
        let meet = fit(&[plane_at(0.0, 0.0, 0.0), plane_at(1.0, 0.0, 0.0)], 2.0);
        assert_eq!((meet.meeting, meet.free.len(), meet.gaps.len()), (2, 6, 0));
        let apart = fit(&[plane_at(0.0, 0.0, 0.0), plane_at(1.1, 0.0, 0.0)], 2.0);
        assert_eq!((apart.meeting, apart.free.len(), apart.gaps.len()), (0, 8, 0));
    }

    /// Two sheets of objects of these sizes.
    #[test]
    fn what_is_near_depends_on_both_objects() {
        let sheets = |apart: f64| [plane_at(0.0, 0.0, 0.0), plane_at(1.0 + apart, 0.0, 0.0)];
        let gaps = |apart: f64, sizes: [f64; 2]| {
            super::fit(&sheets(apart).map(Surface::from), &[], &sizes).gaps.len()
        };
        for (apart, sizes, expected) in [
            (1e-3, [2.0, 2.0], 1),
            (3e-3, [2.0, 2.0], 0),
            (3e-3, [2.0, 2e4], 1),
            (3e-2, [2.0, 2e4], 0),
            (3e-2, [2e4, 2e4], 1),
            (1e-3, [0.5, 2.0], 1),
            (1e-3, [0.05, 2.0], 0),
        ] {
            assert_eq!(gaps(apart, sizes), expected, "{apart} apart, {sizes:?} large");
        }
    }

    #[test]
    fn a_short_border_may_lie_along_a_part_of_a_long_one() {
        let halved = plane_at(0.0, 0.0, 0.0).split_v(0.5).unwrap();
        let beside = plane_at(1.0 + 1e-6, 0.0, 0.0);
        let fit = fit(&[halved.0, halved.1, beside], 2.0);
        let gaps: Vec<f64> = fit.gaps.iter().map(|gap| gap.width).collect();
        assert_eq!(gaps.len(), 2, "{:?}", fit.gaps);
        assert!(gaps.iter().all(|width| (width - 1e-6).abs() < 1e-14), "{gaps:?}");
        assert_eq!(fit.meeting, 2); // the halves along their cut
    }

    /// A patch of degree 1 between lines from `y` = 0 to 1, with these inner knots in v.
    fn uneven(lines: &[[DVec3; 2]], inner: &[f64]) -> NurbsSurface {
        let vs = [&[0.0], inner, &[1.0]].concat();
        let us: Vec<f64> = (0..lines.len()).map(|k| (k / 2 + k % 2) as f64).collect();
        let knots = |values: &[f64]| {
            let ends = [&values[..1], values, &values[values.len() - 1..]].concat();
            KnotVector::new(1, ends).unwrap()
        };
        let points = lines.iter().flat_map(|&[from, to]| vs.iter().map(move |&v| from.lerp(to, v)));
        NurbsSurface::new(knots(&us), knots(&vs), points.collect(), None).unwrap()
    }

    fn sheet(x: [f64; 2], inner: &[f64]) -> NurbsSurface {
        uneven(&x.map(|x| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0)]), inner)
    }

    /// Distances between knots say nothing about lengths in space.
    #[test]
    fn knots_may_be_uneven() {
        let early = [0.002, 0.004, 0.006, 0.008];
        let late = [0.992, 0.994, 0.996, 0.998];
        let torn = fit(&[sheet([0.0, 1.0], &early), sheet([1.0 + 1e-4, 2.0], &late)], 2.0);
        assert_eq!((torn.nearly, torn.free.len(), torn.gaps.len()), (2, 6, 1));
        assert!((torn.gaps[0].width - 1e-4).abs() < 1e-14, "{}", torn.gaps[0].width);
        // Borders that meet at a corner are not beside each other, however many knots are there.
        let tiny: Vec<f64> = (1..40).map(|k| 1e-5 * f64::from(k)).collect();
        for inner in [&[1e-4][..], &[1.0 - 1e-4], &early, &tiny] {
            let whole = fit(&[sheet([0.0, 1.0], inner)], 2.0);
            assert_eq!((whole.free.len(), whole.gaps.len()), (4, 0), "{inner:?}");
        }
    }

    /// With such weights a border runs through most of its length near one end.
    #[test]
    fn weights_may_be_uneven() {
        for ratio in [1.0, 1e2, 1e3] {
            let knots = |degree| KnotVector::bezier(degree).unwrap();
            let net = [[-1.0, 0.0], [0.0, 8.0], [1.0, 0.0]]
                .map(|[x, y]| [0.0, 1.0].map(|z| DVec3::new(x, y, z)));
            let weights = [1.0, ratio, ratio * ratio].map(|weight| [weight; 2]).concat();
            let bent = NurbsSurface::new(knots(2), knots(1), net.concat(), Some(weights)).unwrap();
            let fit = fit(&[bent], 8.0);
            assert_eq!((fit.borders, fit.free.len()), (4, 4), "{ratio}");
        }
    }

    #[test]
    fn what_is_closed_by_another_border_is_no_gap() {
        let corner = |k: usize| {
            let on = |bit: usize| f64::from(u8::from(k & bit != 0));
            DVec3::new(on(1), on(2), 5e-4 * on(4))
        };
        let faces =
            [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 3, 6, 7], [0, 2, 4, 6], [1, 3, 5, 7]];
        let faces = faces
            .map(|[a, b, c, d]| uneven(&[[corner(a), corner(b)], [corner(c), corner(d)]], &[]));
        let closed = fit(&faces, 1.5);
        assert_eq!((closed.meeting, closed.free.len(), closed.gaps.len()), (24, 0, 0));
        // Without a narrow side there is one.
        let open = fit(&faces[..5], 1.5);
        assert_eq!((open.nearly, open.free.len(), open.gaps.len()), (2, 2, 1), "{:?}", open.gaps);
        assert!((open.gaps[0].width - 5e-4).abs() < 1e-14, "{}", open.gaps[0].width);
    }

    /// The widest place is where the borders of a sheet meet each other, at its corner.
    #[test]
    fn gaps_may_be_widest_at_a_corner() {
        let turned = [[1.0, 1.0 + 1e-4], [2.0, 2.0]];
        let turned = turned.map(|xs| [0, 1].map(|k| DVec3::new(xs[k], k as f64, 0.0)));
        let many: Vec<f64> = (1..40).map(|k| f64::from(k) / 40.0).collect();
        let straight = sheet([1.0, 2.0], &many);
        let mut points: Vec<DVec3> = straight.control().iter().map(|c| c.truncate()).collect();
        points[40].x += 1e-4;
        let [u, v] = [straight.knots_u(), straight.knots_v()].map(KnotVector::clone);
        let moved = NurbsSurface::new(u, v, points, None).unwrap();
        for other in [uneven(&turned, &[]), moved] {
            let torn = fit(&[sheet([0.0, 1.0], &[]), other], 2.0);
            assert_eq!((torn.nearly, torn.gaps.len()), (2, 1), "{:?}", torn.gaps);
            let gap = &torn.gaps[0];
            assert!((gap.width / 1e-4 - 1.0).abs() < 1e-4, "{}", gap.width);
            assert!(gap.at.distance(DVec3::new(1.0, 1.0, 0.0)) < 2e-4, "{}", gap.at);
        }
    }

    #[test]
    fn surfaces_may_be_torn_at_a_knot() {
        let line = |x: f64| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0)];
        for (apart, (meeting, nearly)) in [(0.0, (2, 0)), (1e-4, (0, 2))] {
            let torn = uneven(&[line(0.0), line(1.0), line(1.0 + apart), line(2.0)], &[]);
            let torn = fit(&[torn], 2.0);
            assert_eq!((torn.borders, torn.meeting, torn.nearly), (6, meeting, nearly), "{apart}");
            assert_eq!((torn.free.len(), torn.gaps.len()), (4, nearly / 2), "{apart}");
            for gap in &torn.gaps {
                assert!((gap.width - apart).abs() < 1e-14, "{}", gap.width);
                let names = gap.edges.map(|edge| edge.which.to_string());
                assert_eq!(names, ["just before u = 1", "u = 1"]);
            }
        }
    }

    /// A side of a loop along a border cuts nothing: it is the border.
    #[test]
    fn trims_may_run_along_borders() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from);
        let square = TrimLoop::polygon(&square).unwrap();
        let disc = TrimLoop::circle(DVec2::splat(0.5), 0.5).unwrap();
        let plate = |x: f64, one: &TrimLoop| {
            let plane = plane_at(x, 0.0, 0.0);
            let domain = TrimDomain::of(&plane).unwrap();
            let trims = Trims::new(domain, Kept::Odd, std::slice::from_ref(one)).unwrap();
            Surface::from(TrimmedSurface::new(plane, trims).unwrap())
        };
        let counts = |surfaces: &[Surface]| {
            let sizes = vec![2.0; surfaces.len()];
            let Fit { borders, trim_edges, meeting, nearly, free, gaps, .. } =
                super::fit(surfaces, &[], &sizes);
            ([borders, trim_edges, meeting, nearly, free.len()], gaps.len())
        };
        assert_eq!(counts(&[plate(0.0, &square)]), ([4, 0, 0, 0, 4], 0), "its borders");
        assert_eq!(counts(&[plate(0.0, &disc)]), ([1, 1, 0, 0, 1], 0));
        let two = |apart: f64| [plate(0.0, &square), plate(1.0 + apart, &square)];
        assert_eq!(counts(&two(0.0)), ([8, 0, 2, 0, 6], 0));
        assert_eq!(counts(&two(1e-4)), ([8, 0, 0, 2, 6], 1));
        // Half of a plate: three borders are left in part, and a new edge.
        let half = TrimLoop::rectangle(UvBox::new([0.0, 0.5], [-0.5, 1.5])).unwrap();
        let ([borders, trim_edges, ..], _) = counts(&[plate(0.0, &half)]);
        assert_eq!((borders, trim_edges), (4, 1), "none along u = 0");
    }

    /// A circle on a surface of degrees 9 and 9 has degree 36, which no NURBS curve here may have.
    #[test]
    fn edges_of_any_degree_are_known() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from);
        let square = TrimLoop::polygon(&square).unwrap();
        let hole = TrimLoop::circle(DVec2::splat(0.5), 0.2).unwrap();
        let plane = plane_at(0.0, 0.0, 0.0).elevated_u(8).unwrap().elevated_v(8).unwrap();
        let domain = TrimDomain::of(&plane).unwrap();
        let trims = Trims::new(domain, Kept::Odd, &[square, hole]).unwrap();
        let plate = TrimmedSurface::new(plane, trims).unwrap();
        assert!(plate.edge_curves().is_err());
        let fit = super::fit(&[plate.into()], &[], &[2.0]);
        assert_eq!((fit.borders, fit.trim_edges, fit.free.len()), (5, 1, 5));
    }

    /// An octant has three sides and a pole; a loop along all of them adds no edge.
    #[test]
    fn loops_along_borders_and_poles_are_no_edges() {
        let octant = shapes::octant_biquadratic(1.0).unwrap();
        let [[u0, u1], [v0, v1]] = octant.domain();
        let whole = TrimLoop::rectangle(UvBox::new([u0, u1], [v0, v1])).unwrap();
        let domain = TrimDomain::of(&octant).unwrap();
        let trims = Trims::new(domain, Kept::Odd, &[whole]).unwrap();
        let octant = TrimmedSurface::new(octant, trims).unwrap().into();
        let fit = super::fit(&[octant], &[], &[2.0]);
        assert_eq!((fit.trim_edges, fit.collapsed, fit.free.len(), fit.gaps.len()), (0, 1, 3, 0));
    }

    /// Across a narrow surface, and in a sharp tip of one, there is no gap, but there is where a
    /// surface nearly closes.
    #[test]
    fn the_width_of_a_surface_is_no_gap() {
        let strip = shapes::plane(1.0, 1e-3).unwrap();
        let fit_of = |strip: &NurbsSurface| fit(std::slice::from_ref(strip), 2.0);
        assert_eq!((fit_of(&strip).free.len(), fit_of(&strip).gaps.len()), (4, 0));

        let domain = TrimDomain::of(&strip).unwrap();
        let tip = [(0.1, 0.1), (0.9, 0.1), (0.5, 0.8)].map(DVec2::from);
        let tip = TrimLoop::polygon(&tip).unwrap();
        let trims = Trims::new(domain, Kept::Odd, &[tip]).unwrap();
        let tip = TrimmedSurface::new(strip, trims).unwrap().into();
        let fit = super::fit(&[tip], &[], &[2.0]);
        // Two of its sides are nearly in line.
        assert_eq!((fit.trim_edges, fit.free.len(), fit.gaps.len()), (2, 2, 0));

        // A strip bent into a tube that stays open.
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 1e-3]];
        let net = corners.iter().flat_map(|&[x, y]| [0.0, 1.0].map(|z| DVec3::new(x, y, z)));
        let [around, up] = [5, 2].map(|count| KnotVector::clamped_uniform(1, count).unwrap());
        let open = fit_of(&NurbsSurface::new(around, up, net.collect(), None).unwrap());
        assert_eq!((open.nearly, open.gaps.len()), (2, 1));
        assert!((open.gaps[0].width - 1e-3).abs() < 1e-14, "{}", open.gaps[0].width);
        // One that overlaps itself, 1e-3 farther out.
        let corners =
            [[0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, -1e-3], [0.5005, -1e-3]];
        let net = corners.iter().flat_map(|&[x, y]| [0.0, 1.0].map(|z| DVec3::new(x, y, z)));
        let [around, up] = [6, 2].map(|count| KnotVector::clamped_uniform(1, count).unwrap());
        let open = fit_of(&NurbsSurface::new(around, up, net.collect(), None).unwrap());
        assert_eq!((open.nearly, open.gaps.len()), (2, 1));
    }

    #[test]
    fn seams_and_poles_of_closed_shapes_fit() {
        let sphere = fit(&[shapes::sphere(1.0).unwrap()], 2.0);
        assert_eq!((sphere.collapsed, sphere.meeting, sphere.free.len()), (2, 2, 0));
        let torus = fit(&[shapes::torus(3.0, 1.0).unwrap()], 8.0);
        assert_eq!((torus.collapsed, torus.meeting, torus.free.len()), (0, 4, 0));
        assert!(sphere.gaps.is_empty() && torus.gaps.is_empty());
    }

    #[test]
    fn parts_cut_by_one_loop_meet_and_moved_ones_have_a_gap() {
        let sphere = shapes::sphere(2.0).unwrap();
        let [[u0, u1], [v0, v1]] = sphere.domain();
        let center = DVec2::new(0.5 * (u0 + u1), 0.3 * v0 + 0.7 * v1);
        let circle = TrimLoop::circle(center, 0.2).unwrap();
        let domain = TrimDomain::with_seams_of(&sphere).unwrap();
        let part = |kept, moved: f64| {
            let trims = Trims::new(domain, kept, std::slice::from_ref(&circle)).unwrap();
            let part = TrimmedSurface::new(sphere.clone(), trims).unwrap();
            let map = DAffine3::from_scale(DVec3::splat(1.0 + moved));
            Surface::from(part.transformed(&map).unwrap())
        };
        let whole = super::fit(&[part(Kept::Odd, 0.0), part(Kept::Even, 0.0)], &[], &[4.0; 2]);
        assert_eq!((whole.trim_edges, whole.gaps.len()), (2, 0));
        assert_eq!((whole.collapsed, whole.meeting, whole.free.len()), (2, 4, 0));
        // Larger by 1e-5, a part is 2e-5 off all along its edge.
        let torn = super::fit(&[part(Kept::Odd, 1e-5), part(Kept::Even, 0.0)], &[], &[4.0; 2]);
        assert_eq!((torn.meeting, torn.nearly, torn.gaps.len()), (2, 2, 1));
        assert!((torn.gaps[0].width - 2e-5).abs() < 1e-13, "{}", torn.gaps[0].width);
        assert_eq!(torn.gaps[0].edges.map(|edge| edge.which), [Which::Trim(0); 2]);
    }
}
