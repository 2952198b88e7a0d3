//! Curves and patches in matrix form and in powers of their parameters, and the errors about them.

use glam::{DVec2, DVec3};

use super::tests::{error, scene};
use crate::geometry::Surface;
use crate::scene::World;

fn surface(shape: &str) -> Surface {
    let scene = scene(&format!("[[object]]\nshape = {{ {shape} }}"));
    World::new(&scene).unwrap().surfaces.remove(0).surface
}

/// The point of a curve, by an extrusion whose u runs along it.
fn on_curve(curve: &str, t: f64) -> DVec3 {
    let extrusion = surface(&format!("extrusion = {{ profile = {{ {curve} }}, by = [0, 0, 1] }}"));
    extrusion.point_at(DVec2::new(t, 0.0))
}

/// The first geometry matrix of the lecture, in each form; the values follow from the matrices.
#[test]
fn segments_are_written_by_their_geometry() {
    let geometry = "geometry = [[2, 1], [5, 2], [6, 5], [8, 6]]";
    for (form, t, x, y) in [
        ("bspline", 0.0, 28.0 / 6.0, 14.0 / 6.0),
        ("bspline", 0.5, 263.0 / 48.0, 3.5),
        ("bspline", 1.0, 37.0 / 6.0, 28.0 / 6.0),
        ("bezier", 0.5, 43.0 / 8.0, 28.0 / 8.0),
        ("catmull_rom", 0.0, 5.0, 2.0),
        ("catmull_rom", 0.5, 89.0 / 16.0, 3.5),
        ("hermite", 0.5, 3.25, 1.375),
        ("hermite", 1.0, 5.0, 2.0),
    ] {
        let point = on_curve(&format!("matrix_form = {{ form = '{form}', {geometry} }}"), t);
        assert!(point.distance(DVec3::new(x, y, 0.0)) < 2e-15, "{form} at {t}: {point}");
    }
    let quadratic = "matrix_form = { form = 'bspline', geometry = [[0, 0], [1, 2], [2, 0]] }";
    assert_eq!(on_curve(quadratic, 0.0), DVec3::new(0.5, 1.0, 0.0));
    assert_eq!(on_curve(quadratic, 0.5), DVec3::new(1.0, 1.5, 0.0));
    let linear = "matrix_form = { form = 'bezier', geometry = [[0, 0], [1, 2]] }, reverse = true";
    assert_eq!(on_curve(linear, 0.25), DVec3::new(0.75, 1.5, 0.0));
}

/// `S M G Mᵀ Tᵀ` of the lecture, which is right for B-splines, too.
#[test]
fn patches_are_written_by_their_geometry() {
    let graph = "geometry = [
        [[0, 0, 5], [1, 0, 6], [2, 0, 3], [3, 0, 5]],
        [[0, 1, 3], [1, 1, 5], [2, 1, 6], [3, 1, 3]],
        [[0, 2, 4], [1, 2, 3], [2, 2, 5], [3, 2, 6]],
        [[0, 3, 5], [1, 3, 4], [2, 3, 3], [3, 3, 5]],
    ]";
    let patch = |form: &str| surface(&format!("matrix_form = {{ form = '{form}', {graph} }}"));
    assert_eq!(patch("bezier"), surface("lecture_patch_1 = {}"));
    let z = |form: &str, u: f64, v: f64| patch(form).point_at(DVec2::new(u, v)).z;
    // (1 4 1 0)/6 along both: [5+24+3, 3+20+6, 4+12+5] = [32, 29, 21] for the rows.
    assert!((z("bspline", 0.0, 0.0) - (32.0 + 4.0 * 29.0 + 21.0) / 36.0).abs() < 1e-15);
    assert_eq!(z("catmull_rom", 0.0, 1.0), 6.0);
    assert_eq!(z("hermite", 1.0, 0.0), 3.0);
    let flat = "form = 'bspline', geometry = [[[0, 0], [2, 0], [4, 0]], [[0, 1], [2, 1], [4, 1]]]";
    let strip = surface(&format!("matrix_form = {{ {flat} }}"));
    assert_eq!(strip.degree(), [1, 2]);
    assert_eq!(strip.point_at(DVec2::new(1.0, 0.0)), DVec3::new(1.0, 1.0, 0.0));
}

#[test]
fn what_is_no_matrix_form_is_told_where_it_is_written() {
    let patch = |keys: &str| error(&format!("[[object]]\n[object.shape.matrix_form]\n{keys}"));
    let square = "[[[0, 0], [0, 1]], [[1, 0], [1, 1]]]";
    for (keys, message) in [
        (
            format!("form = 'hermite'\ngeometry = {square}"),
            "4:12: surface \"matrix_form\": the geometry matrix has 2 vectors along v: the form \
             hermite takes 4",
        ),
        (
            "form = 'bezier'\ngeometry = [[[0, 0], [0, 1]], [[1, 0]]]".into(),
            "4:12: surface \"matrix_form\": row 1 of the geometry matrix has 1 vector, but row 0 \
             has 2",
        ),
        (
            "form = 'bezier'\ngeometry = [[[0, 0], [0, 1]], [[0, 2], [0, 3]]]".into(),
            "4:12: surface \"matrix_form\": all control points lie on the line from (0, 0, 0) to \
             (0, 3, 0), to within rounding: the surface has no area",
        ),
        (
            format!("form = 'b_spline'\ngeometry = {square}"),
            "3:8: unknown name \"b_spline\"; did you mean \"bspline\"?",
        ),
        (
            format!("form = 3\ngeometry = {square}"),
            "3:8: found integer 3, needed a name in quotes, as in form = \"hermite\"",
        ),
        ("form = 'bezier'".into(), "2:1: missing key \"geometry\""),
        (format!("geometry = {square}"), "2:1: missing key \"form\""),
    ] {
        assert_eq!(patch(&keys), format!("s.toml:{message}"), "{keys}");
    }
    let curve = |keys: &str| {
        let profile = format!("profile = {{ matrix_form = {keys} }}");
        error(&format!("[[object]]\nshape.extrusion = {{ by = [0, 0, 1], {profile} }}"))
    };
    assert_eq!(
        curve("{ form = 'catmull_rom', geometry = [[0, 0], [1, 1], [2, 0]] }"),
        "s.toml:2:98: surface \"extrusion\": profile: 3 vectors in the geometry of a segment: the \
         form catmull_rom takes 4"
    );
    assert_eq!(
        curve("[[0, 0], [1, 1]]"),
        "s.toml:2:63: found a list, needed a table, as in matrix_form = { form = \"hermite\", \
         geometry = […] }"
    );
}

/// `y = x² + 5x + 3` and `(1 − t², 2t) / (1 + t²)`, which documents print, on several domains.
#[test]
fn curves_are_written_by_powers() {
    let graph = "power = { coefficients = [[0, 3], [1, 5], [0, 1]], domain = [-6, 1] }";
    for x in [-6.0, -2.5, 0.5, 1.0] {
        let expected = DVec3::new(x, x * x + 5.0 * x + 3.0, 0.0);
        assert!(on_curve(graph, x).distance(expected) < 1e-14, "{x}");
    }
    let circle = "coefficients = [[1, 0], [0, 2], [-1, 0]], denominator = [1, 0, 1]";
    for (domain, t) in [("", 0.25), (", domain = [-0.5, 1.5]", 1.25)] {
        let point = on_curve(&format!("power = {{ {circle}{domain} }}"), t);
        let expected = DVec3::new(1.0 - t * t, 2.0 * t, 0.0) / (1.0 + t * t);
        assert!(point.distance(expected) < 1e-15, "{domain}: {point}");
    }
}

/// Eberly's octant by the formula of his note, and the lecture's polynomial `z(s, t)`.
#[test]
fn patches_are_written_by_powers() {
    let octant = "coefficients = [[[1, 0], [0, 2], [-1, 0]], [[0, 0, 2], [0, 0], [0, 0, 2]], \
                  [[-1, 0], [0, -2], [1, 0]]], denominator = [[1, 0, 1], [], [1, 0, 1]]";
    let made = surface(&format!("power = {{ {octant} }}"));
    let known = World::new(&scene("[[object]]\nshape = 'octant'\nswap_uv = true")).unwrap();
    assert_eq!(made, known.surfaces[0].surface);
    let lecture = surface(
        "power = { coefficients = [
            [[0, 0, 5], [3, 0, 3], [0, 0, -12], [0, 0, 9]],
            [[0, 3, -6], [0, 0, 9], [0, 0, 27], [0, 0, -36]],
            [[0, 0, 9], [0, 0, -36], [0, 0, 9], [0, 0, 33]],
            [[0, 0, -3], [0, 0, 21], [0, 0, -24], [0, 0, -3]],
        ] }",
    );
    let known = surface("lecture_patch_1 = {}");
    for k in 0..=24 {
        let st = DVec2::new(f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0);
        assert!(lecture.point_at(st).distance(known.point_at(st)) < 2e-15, "{st}");
    }
    // A saddle, x = u, y = v, z = u v: rows may end early.
    let saddle = "coefficients = [[[0, 0], [0, 1]], [[1, 0], [0, 0, 1]], []]";
    let saddle = surface(&format!("power = {{ {saddle}, domain = [[-1, 1], [0, 4]] }}"));
    assert_eq!((saddle.degree(), saddle.domain()), ([2, 1], [[-1.0, 1.0], [0.0, 4.0]]));
    assert_eq!(saddle.point_at(DVec2::new(0.5, 3.0)), DVec3::new(0.5, 3.0, 1.5));
}

#[test]
fn powers_that_make_no_surface_are_told_where_they_are_written() {
    let patch = |keys: &str| error(&format!("[[object]]\n[object.shape.power]\n{keys}"));
    let flat = "coefficients = [[[0, 0], [0, 1]], [[1, 0]]]";
    for (keys, message) in [
        (
            format!("{flat}\ndenominator = [[1], [-3], [3]]"),
            "4:15: surface \"power\": the denominator's Bézier coefficient (1, 0) is -0.5: all must \
             be positive, or all negative; they may be so on a smaller domain",
        ),
        (
            format!("{flat}\ndenominator = [[1e300]]"),
            "4:15: surface \"power\": the weight of control point (0, 0) is 1e300",
        ),
        (
            format!("{flat}\nswap_uv = true"),
            "4:1: unknown key \"swap_uv\"; write it under [[object]], above the tables of its shape",
        ),
        (
            "coefficients = [[[0, 0], [0, 1]]]".into(),
            "3:16: surface \"power\", direction u: degree 0: degrees from 1 to 32 are supported",
        ),
        (format!("{flat}\ndomain = [[0, 1], [1, 0]]"), "4:10: surface \"power\", direction v: "),
        (format!("{flat}\ndomain = [0, 1]"), "4:11: found integer 0, needed a list of 2 numbers"),
        (
            format!("{flat}\ndomain = [[0, 1]]"),
            "4:10: found a list of 1, needed a list of 2 pairs of numbers, [[u0, u1], [v0, v1]]",
        ),
        ("denominator = [[1]]".into(), "2:1: missing key \"coefficients\""),
        (format!("{flat}\nnumerator = [[1]]"), "4:1: unknown key \"numerator\"; known: "),
    ] {
        let found = patch(&keys);
        assert!(found.starts_with(&format!("s.toml:{message}")), "{keys}: {found}");
    }
    let curve = |keys: &str| {
        error(&format!(
            "[[object]]\n[object.shape.extrusion]\nby = [0, 0, 1]\nprofile.power = {{\n{keys} }}"
        ))
    };
    let line = "coefficients = [[0, 0], [1, 0]]";
    for (keys, message) in [
        (
            format!("{line},\ndenominator = [1, -3, 3]"),
            "6:15: surface \"extrusion\": profile: the denominator's Bézier coefficient 1 is -0.5: \
             all must be positive, or all negative; they may be so on a shorter domain",
        ),
        (
            format!("{line},\ndenominator = [1e300]"),
            "6:15: surface \"extrusion\": profile: the weight of control point 0 is 1e300",
        ),
        (
            format!("{line},\ndenominator = {:?}", [1.0; 34]),
            "6:15: surface \"extrusion\": profile: degree 33: degrees from 1 to 32 are supported",
        ),
        (
            "coefficients = [[0, 0]]".into(),
            "5:16: surface \"extrusion\": profile: degree 0: degrees from 1 to 32 are supported",
        ),
        (format!("{line},\ndomain = [1, 0]"), "6:10: surface \"extrusion\": profile: "),
        (format!("{line},\ndomain = [0, inf]"), "6:14: found inf, needed a finite number"),
        (
            "coefficients = [[0, 0], [1e80, 0]]".into(),
            "5:16: surface \"extrusion\": profile: control point 1 is (1e80, 0, 0): coordinates \
             must be finite (up to 1e70)",
        ),
    ] {
        let found = curve(&keys);
        assert!(found.starts_with(&format!("s.toml:{message}")), "{keys}: {found}");
    }
}
