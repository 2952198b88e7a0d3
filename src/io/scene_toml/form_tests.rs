//! Curves and patches in matrix form, and the errors about them.

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
