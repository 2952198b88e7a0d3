//! The errors about values written as another kind of value, in another order, or too large.

use super::tests::error;
use super::value_tests::with_sphere;

#[test]
fn what_is_often_written_otherwise_is_shown() {
    for (lines, message) in [
        (
            "[camera]\nperspective = 35",
            "4:15: found integer 35, needed a table, as in perspective = { fov = 30 }",
        ),
        (
            "[[light]]\nambient = 0.5",
            "4:11: found the number 0.5, needed a table, as in ambient = { radiance = 0.1 }",
        ),
        (
            "[[light]]\ndirection = [0, 0, -1]",
            "4:1: unknown light \"direction\"; write directional = { from = [x, y, z], irradiance = … }: \
             from where the light comes",
        ),
        (
            "[[light]]\ndirectional = { direction = [0, 0, -1], irradiance = 1 }",
            "4:17: unknown key \"direction\"; write from = [x, y, z], where the light comes from: \
             the opposite of its direction of travel",
        ),
        (
            "[[object]]\nshape = { doo_sabin = { creases = [[0, 1]] } }",
            "4:36: found a list, needed a table, as in creases = [{ vertices = [0, 1], sharpness = \
             2.5 }]",
        ),
        (
            "[[object]]\nshape = { revolution = { profile = [[1, 0], [1, 2]] } }",
            "4:36: found a list, needed a table, as in profile = { polyline = […] }",
        ),
        ("swap_vu = true", "3:1: unknown key \"swap_vu\"; did you mean \"swap_uv\"?"),
        ("swapuv = true", "3:1: unknown key \"swapuv\"; did you mean \"swap_uv\"?"),
        ("transpose = true", "3:1: unknown key \"transpose\"; write swap_uv = true"),
        (
            "[[object]]\n[object.shape.nurbs]\ndegree = 1\nswap_uv = true",
            "6:1: unknown key \"swap_uv\"; write it under [[object]], above the tables of its shape",
        ),
        (
            "[camera]\nzoom = 2\nangle = 30",
            "4:1: unknown key \"zoom\"; known: look_from, look_at, up, perspective, orthographic",
        ),
        (
            "[camera]\nlook_at = [0, 0, 0];",
            "4:20: found ;, needed the end of the line: nothing follows a value",
        ),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
}

#[test]
fn light_beyond_what_pictures_hold_is_refused() {
    for (lines, message) in [
        (
            "[[light]]\nambient = { radiance = [1, 1e39, 1] }",
            "4:24: found 1e39, needed at most 3.4e38: pictures hold no brighter light",
        ),
        (
            "[[light]]\npoint = { position = [0, 0, 0], intensity = 1e300 }",
            "4:45: found 1e300, needed at most 3.4e178: pictures hold no brighter light",
        ),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
}
