//! Drawings of surfaces: nothing is drawn twice, so that no ray is doubtful; errors name the line
//! at fault.

use glam::{DVec2, DVec3};

use super::drawn::{control_nets, iso_curves, iso_lines, trim_curves};
use crate::geometry::construct::{
    Axis, Caps, Component, ComponentKind, ControlNet, NetStyle, TubeStyle, extrude, revolve, tube,
};
use crate::geometry::shapes;
use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
use crate::geometry::{
    Cage, CageParts, KnotVector, NurbsCurve, NurbsSurface, Surface, TrianglePatch, TrimmedSurface,
};
use crate::intersect::{Query, SurfaceBvh};
use crate::math::Ray;

const ENOUGH: usize = usize::MAX;

fn thin(radius: f64) -> TubeStyle {
    TubeStyle { radius, ..TubeStyle::default() }
}

fn lines(surfaces: &[Surface], values: [&[f64]; 3], radius: f64) -> Vec<Component> {
    iso_curves(surfaces, &iso_lines(values), &thin(radius), ENOUGH).unwrap()
}

/// Of 20000 rays from around some surfaces through the box around them: how many are doubtful, and
/// how many hit something.
fn doubtful(surfaces: &[NurbsSurface]) -> (usize, usize) {
    let bvh = SurfaceBvh::build(surfaces).unwrap();
    let (low, high) = bvh.bounds().unwrap();
    let (middle, size) = (0.5 * (low + high), (high - low).max_element());
    let mut tracer = bvh.tracer();
    let (mut doubt, mut met) = (0, 0);
    for k in 0..20_000 {
        // Powers of the root of x⁶ = x + 1 fill five dimensions evenly (Roberts 2018).
        let share =
            |power: i32| (0.5 + f64::from(k) * 1.134_724_138_401_519_f64.powi(-power)).fract();
        let target = low + (high - low) * DVec3::new(share(1), share(2), share(3));
        let (turn, z) = (std::f64::consts::TAU * share(4), 2.0 * share(5) - 1.0);
        let from = DVec2::from_angle(turn) * (1.0 - z * z).sqrt();
        let origin = middle + 3.0 * size * from.extend(z);
        let answer = tracer.first_hit(&Query::primary(Ray::new(origin, target - origin).unwrap()));
        doubt += usize::from(answer.doubtful);
        met += usize::from(answer.hit.is_some());
    }
    (doubt, met)
}

fn expect_no_doubt(name: &str, pieces: Vec<Component>) {
    let surfaces: Vec<NurbsSurface> = pieces.into_iter().map(|piece| piece.surface).collect();
    let (doubt, met) = doubtful(&surfaces);
    assert!(doubt == 0 && met > 500, "{name}: {doubt} in doubt, {met} hits");
}

fn net(degree: usize, size: usize, point: impl Fn(f64, f64) -> DVec3) -> Surface {
    let knots = KnotVector::clamped_uniform(degree, size).unwrap();
    let points = (0..size * size).map(|k| point((k / size) as f64, (k % size) as f64));
    NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap().into()
}

fn cube() -> Surface {
    let positions = (0..8).map(|k| {
        let sign = |bit: i32| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
        DVec3::new(sign(0), sign(1), sign(2))
    });
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = faces.map(|face| face.to_vec()).to_vec();
    let cage = CageParts { positions: positions.collect(), faces, ..CageParts::default() };
    let cage = Cage::new(cage).unwrap();
    cage.catmull_clark(cage.default_tolerance()).unwrap().into()
}

/// Borders meet at corners, cross and touch in the middle, and are shared by neighbours.
#[test]
fn lines_of_constant_parameters_are_met_without_doubt() {
    let sheet = [net(2, 3, |i, j| DVec3::new(i - 1.0, j - 1.0, i * (2.0 - i) * j * 0.4))];
    let all = [0.0, 0.5, 1.0];
    expect_no_doubt("borders", lines(&sheet, [&[0.0, 1.0], &[0.0, 1.0], &[]], 0.06));
    expect_no_doubt("a grid", lines(&sheet, [&all, &all, &[]], 0.03));
    let flat = net(1, 2, |i, j| DVec3::new(i, j, 0.0));
    expect_no_doubt("a square", lines(&[flat], [&all, &all, &[]], 0.03));

    let points = [[0.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 1.0]];
    let points = points.into_iter().chain([[1.0, 1.0, 1.0], [2.0, 0.0, 0.0]]).map(DVec3::from);
    let sail = TrianglePatch::new(2, points.collect(), None).unwrap();
    let ends = [0.0, 0.5];
    expect_no_doubt("a triangle", lines(&[sail.into()], [&ends, &ends, &ends], 0.03));

    let corners = [[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let corners = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
    let steps = extrude(&NurbsCurve::polyline(&corners).unwrap(), DVec3::Z).unwrap();
    let at_corners = [0.0, 1.0, 2.0, 3.0];
    expect_no_doubt("steps", lines(&[steps.into()], [&at_corners, &all, &[]], 0.05));

    let units = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let pieces = lines(&[cube()], [&units, &[0.0, 1.0], &[]], 0.02);
    let count = |kind| pieces.iter().filter(|piece| piece.kind == kind).count();
    assert_eq!(
        [ComponentKind::Tube, ComponentKind::Joint, ComponentKind::Cap].map(count),
        [12, 8, 0],
        "a cube's edges"
    );
    expect_no_doubt("a cube", pieces);
}

#[test]
fn nets_are_met_without_doubt() {
    let patch = |offset: f64| {
        net(3, 4, move |i, j| DVec3::new(i + offset, j, 0.2 * (i + offset) * (3.0 - j)))
    };
    let style = NetStyle { radius: 0.03, joints: 0.06 };
    let nets = [0.0, 3.0].map(|offset| patch(offset).control_net());
    let pieces = control_nets(&nets, &style, ENOUGH).unwrap();
    let count = |kind| pieces.iter().filter(|piece| piece.kind == kind).count();
    assert_eq!([ComponentKind::Line, ComponentKind::Point].map(count), [24 + 24 - 3, 16 + 16 - 4]);
    expect_no_doubt("two patches", pieces);

    let way = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
    let way = NurbsCurve::polyline(&way.map(|[x, y]| DVec3::new(x, y, 0.0))).unwrap();
    let surfaces = tube(&way, &thin(0.1)).unwrap();
    let nets: Vec<ControlNet> = surfaces.iter().map(|piece| (&piece.surface).into()).collect();
    let style = NetStyle { radius: 0.02, joints: 0.04 };
    expect_no_doubt("a tube's net", control_nets(&nets, &style, ENOUGH).unwrap());
}

/// A line through the axis makes two cones tip to tip, a parabola a surface pinched on the axis.
#[test]
fn profiles_through_the_axis_are_met_without_doubt() {
    let cone = [[-1.0, 0.0, 0.0], [1.0, 0.0, 1.0]];
    let curved = [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.2], [1.0, 0.0, 1.0]];
    for points in [&cone[..], &curved[..]] {
        let points: Vec<DVec3> = points.iter().copied().map(DVec3::from).collect();
        let profile = NurbsCurve::bezier(&points).unwrap();
        let surface = revolve(&profile, &Axis::Z, 360.0).unwrap();
        let (doubt, met) = doubtful(&[surface]);
        assert!(doubt == 0 && met > 5000, "{points:?}: {doubt} in doubt, {met} hits");
    }
}

/// The second of three sheets is bent the most, along its own line u = 0.5; the first is bent too
/// much already.
#[test]
fn the_tightest_line_of_all_is_told() {
    let sheet = |height: f64| {
        let lift = move |j: f64| height * j * (2.0 - j);
        net(2, 3, move |i, j| DVec3::new(2.0 * i, j - 1.0, lift(j)))
    };
    let sheets = [sheet(1.0), sheet(2.0), sheet(0.1)];
    let made = |sheets: &[Surface], radius| {
        iso_curves(sheets, &iso_lines([&[0.5], &[0.5], &[]]), &thin(radius), ENOUGH)
    };
    // z = 2 h t (1 − t), y = 2 t − 1: in the middle, z″ = −h as a function of y.
    let told = "u = 0.5: the tube folds, most of all at t = 0.5 of the curve, (2, 0, 1): the curve \
                bends with radius 0.5 there, and the tube reaches 3 towards the centre";
    assert_eq!(made(&sheets, 3.0).unwrap_err().to_string(), format!("surface 1, {told}"));
    assert_eq!(made(&sheets[1..2], 3.0).unwrap_err().to_string(), told);
    assert!(made(&sheets, 0.5001).is_err());
    assert!(made(&sheets, 0.4999).is_ok());
    let open = TubeStyle { caps: Caps::Open, ..thin(3.0) };
    assert!(iso_curves(&sheets, &iso_lines([&[], &[0.5], &[]]), &open, ENOUGH).is_ok());
}

#[test]
fn nets_that_cannot_be_drawn_are_named() {
    let good = net(1, 2, |i, j| DVec3::new(i, j, 0.0)).control_net();
    let bad = ControlNet { lines: vec![[0, 9]], ..good.clone() };
    let style = NetStyle { radius: 0.1, joints: 0.2 };
    let message = |nets: &[ControlNet]| control_nets(nets, &style, ENOUGH).unwrap_err().to_string();
    let told = "line 0 ends at vertex 9, but the net has 4 control points; lines and vertices count \
                from 0";
    assert_eq!(message(&[good, bad.clone()]), format!("surface 1: {told}"));
    assert_eq!(message(&[bad]), told);
}

/// The lowest and highest places of a hole are met at a joint of its circle and, a tiny way off, at
/// a knot of the surface: the piece between the two is neither a bend nor a corner.
#[test]
fn a_trim_edge_has_a_joint_beside_a_knot() {
    for aside in [1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6] {
        let pipe = shapes::cylinder(1.0, 1.0).unwrap();
        let domain = TrimDomain::with_seams_of(&pipe).unwrap();
        let hole = TrimLoop::circle(DVec2::new(0.25 + aside, 0.5), 0.1).unwrap();
        let trims = Trims::new(domain, Kept::Even, &[hole]).unwrap();
        let pipe = Surface::from(TrimmedSurface::new(pipe, trims).unwrap());
        let made = trim_curves(&[pipe], &thin(0.01), ENOUGH);
        let made = made.unwrap_or_else(|error| panic!("{aside:e}: {error}"));
        let kinds: Vec<ComponentKind> = made.iter().map(|piece| piece.kind).collect();
        assert_eq!(kinds, [ComponentKind::Tube], "{aside:e}");
    }
}
