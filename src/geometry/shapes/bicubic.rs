//! Bicubic Bézier patches: three of a lecture on bicubic surfaces, and the one of the OpenGL books
//! ([errata](crate::geometry::errata) cites the documents).
//!
//! `u` runs over the rows of the nets as printed, `v` along the columns, both in `[0, 1]`.

use glam::DVec3;

use crate::geometry::NurbsSurface;
use crate::geometry::knots::unit_knots;

/// The points of a 4 × 4 net, row by row.
type Net = [[(f64, f64, f64); 4]; 4];

fn bicubic(net: &Net) -> NurbsSurface {
    let control = net.as_flattened().iter().map(|&(x, y, z)| DVec3::new(x, y, z).extend(1.0));
    NurbsSurface::assembled([unit_knots(3), unit_knots(3)], control.collect())
}

/// A graph over the square `[0, 3]²`, as `x = 3v` and `y = 3u`, so that each vertical line over it
/// meets it exactly once. Its normals point down.
pub fn bicubic_graph() -> NurbsSurface {
    let heights =
        [[5.0, 6.0, 3.0, 5.0], [3.0, 5.0, 6.0, 3.0], [4.0, 3.0, 5.0, 6.0], [5.0, 4.0, 3.0, 5.0]];
    let mut net: Net = [[(0.0, 0.0, 0.0); 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            net[i][j] = (j as f64, i as f64, heights[i][j]);
        }
    }
    bicubic(&net)
}

/// A hood whose rim bulges.
pub fn bicubic_hood() -> NurbsSurface {
    bicubic(&[
        [(2.0, 2.0, 0.0), (1.0, 1.0, 1.0), (4.0, 1.0, 1.0), (3.0, 2.0, 0.0)],
        [(2.0, 2.0, 1.0), (1.0, 1.0, 2.0), (4.0, 1.0, 2.0), (3.0, 2.0, 1.0)],
        [(2.0, 3.0, 1.0), (1.0, 4.0, 2.0), (4.0, 4.0, 2.0), (3.0, 3.0, 1.0)],
        [(2.0, 3.0, 0.0), (1.0, 4.0, 1.0), (4.0, 4.0, 1.0), (3.0, 3.0, 0.0)],
    ])
}

/// The hood with its four corners drawn into one point.
pub fn bicubic_hood_pinched() -> NurbsSurface {
    bicubic(&[
        [(2.5, 2.5, 0.0), (1.0, 1.0, 1.0), (4.0, 1.0, 1.0), (2.5, 2.5, 0.0)],
        [(2.0, 2.0, 1.0), (1.0, 1.0, 2.0), (4.0, 1.0, 2.0), (3.0, 2.0, 1.0)],
        [(2.0, 3.0, 1.0), (1.0, 4.0, 2.0), (4.0, 4.0, 2.0), (3.0, 3.0, 1.0)],
        [(2.5, 2.5, 0.0), (1.0, 4.0, 1.0), (4.0, 4.0, 1.0), (2.5, 2.5, 0.0)],
    ])
}

/// The net of the OpenGL Programming Guide (the "Red Book"): a graph over the square
/// `[−1.5, 1.5]²`, as `x = 3v − 1.5` and `y = 3u − 1.5`. Its normals point down. The guide calls u
/// what runs along the inner index of its array; here that is v.
pub fn red_book_patch() -> NurbsSurface {
    let heights = [
        [4.0, 2.0, -1.0, 2.0],
        [1.0, 3.0, 0.0, -1.0],
        [4.0, 0.0, 3.0, 4.0],
        [-2.0, -2.0, 0.0, -1.0],
    ];
    let mut net: Net = [[(0.0, 0.0, 0.0); 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            net[i][j] = (j as f64 - 1.5, i as f64 - 1.5, heights[i][j]);
        }
    }
    bicubic(&net)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// The parameters `(u, v)`, the point, `Sᵤ` and `Sᵥ`.
    type Fact = ((f64, f64), [f64; 3], [f64; 3], [f64; 3]);

    fn close(a: DVec3, b: [f64; 3]) {
        let off = (a - DVec3::from(b)).length();
        assert!(off <= 1e-14 * a.length().max(1.0), "{a} is not {b:?}");
    }

    fn has_values(patch: &NurbsSurface, facts: &[Fact], products: &[[f64; 3]]) {
        for &((u, v), point, du, dv) in facts {
            let s = patch.derivatives(DVec2::new(u, v));
            close(patch.point_at(DVec2::new(u, v)), point);
            close(s.point, point);
            close(s.du, du);
            close(s.dv, dv);
        }
        for (&((u, v), ..), &product) in facts.iter().zip(products) {
            let s = patch.derivatives(DVec2::new(u, v));
            close(s.du.cross(s.dv), product);
            close(patch.normal(DVec2::new(u, v)).unwrap(), DVec3::from(product).normalize().into());
        }
    }

    #[test]
    fn bicubic_graph_has_its_exact_values() {
        let facts = [
            ((0., 0.), [0., 0., 5.], [0., 3., -6.], [3., 0., 3.]),
            ((0., 1.), [3., 0., 5.], [0., 3., -6.], [3., 0., 6.]),
            ((1., 0.), [0., 3., 5.], [0., 3., 3.], [3., 0., -3.]),
            ((1., 1.), [3., 3., 5.], [0., 3., -3.], [3., 0., 6.]),
            (
                (1. / 2., 1. / 2.),
                [3. / 2., 3. / 2., 287. / 64.],
                [0., 3., -33. / 32.],
                [3., 0., 33. / 32.],
            ),
            (
                (1. / 4., 3. / 4.),
                [9. / 4., 3. / 4., 18491. / 4096.],
                [0., 3., 885. / 1024.],
                [3., 0., -885. / 1024.],
            ),
            ((1. / 3., 2. / 3.), [2., 1., 1123. / 243.], [0., 3., 1. / 3.], [3., 0., -1. / 3.]),
        ];
        let products = [];
        has_values(&bicubic_graph(), &facts, &products);
    }

    #[test]
    fn bicubic_hood_has_its_exact_values() {
        let facts = [
            ((0., 0.), [2., 2., 0.], [0., 0., 3.], [-3., -3., 3.]),
            ((0., 1. / 2.), [5. / 2., 5. / 4., 3. / 4.], [0., 0., 3.], [3., 0., 0.]),
            ((1. / 2., 0.), [2., 5. / 2., 3. / 4.], [0., 3. / 2., 0.], [-3., 0., 3.]),
            ((1. / 2., 1. / 2.), [5. / 2., 5. / 2., 3. / 2.], [0., 15. / 4., 0.], [3., 0., 0.]),
            (
                (1. / 4., 3. / 4.),
                [25. / 8., 453. / 256., 9. / 8.],
                [0., 153. / 64., 3. / 2.],
                [3. / 2., 33. / 32., -3. / 2.],
            ),
            ((1., 1.), [3., 3., 0.], [0., 0., -3.], [-3., -3., -3.]),
            (
                (1. / 3., 2. / 3.),
                [80. / 27., 157. / 81., 4. / 3.],
                [0., 28. / 9., 1.],
                [7. / 3., 13. / 27., -1.],
            ),
        ];
        let products = [
            [9., -9., 0.],
            [0., 9., 0.],
            [9. / 2., 0., 9. / 2.],
            [0., 0., -45. / 4.],
            [-657. / 128., 9. / 4., -459. / 128.],
            [-9., 9., 0.],
            [-97. / 27., 7. / 3., -196. / 27.],
        ];
        has_values(&bicubic_hood(), &facts, &products);
    }

    #[test]
    fn bicubic_hood_pinched_has_its_exact_values() {
        let facts = [
            ((0., 0.), [5. / 2., 5. / 2., 0.], [-3. / 2., -3. / 2., 3.], [-9. / 2., -9. / 2., 3.]),
            ((0., 1. / 2.), [5. / 2., 11. / 8., 3. / 4.], [0., -3. / 8., 3.], [9. / 4., 0., 0.]),
            ((1. / 2., 0.), [17. / 8., 5. / 2., 3. / 4.], [0., 3. / 4., 0.], [-27. / 8., 0., 3.]),
            (
                (1. / 2., 1. / 2.),
                [5. / 2., 5. / 2., 3. / 2.],
                [0., 57. / 16., 0.],
                [45. / 16., 0., 0.],
            ),
            (
                (1. / 4., 3. / 4.),
                [3109. / 1024., 1903. / 1024., 9. / 8.],
                [39. / 128., 507. / 256., 3. / 2.],
                [279. / 256., 171. / 128., -3. / 2.],
            ),
            (
                (1., 1.),
                [5. / 2., 5. / 2., 0.],
                [-3. / 2., -3. / 2., -3.],
                [-9. / 2., -9. / 2., -3.],
            ),
            (
                (1. / 3., 2. / 3.),
                [473. / 162., 107. / 54., 4. / 3.],
                [7. / 54., 17. / 6., 1.],
                [37. / 18., 11. / 18., -1.],
            ),
        ];
        let products = [
            [9., -9., 0.],
            [0., 27. / 4., 27. / 32.],
            [9. / 4., 0., 81. / 32.],
            [0., 0., -2565. / 256.],
            [-2547. / 512., 1071. / 512., -114777. / 65536.],
            [-9., 9., 0.],
            [-31. / 9., 59. / 27., -1396. / 243.],
        ];
        has_values(&bicubic_hood_pinched(), &facts, &products);
    }

    #[test]
    fn red_book_patch_has_its_exact_values() {
        let facts = [
            ((0., 0.), [-3. / 2., -3. / 2., 4.], [0., 3., -9.], [3., 0., -6.]),
            ((0., 1. / 2.), [0., -3. / 2., 9. / 8.], [0., 3., 0.], [3., 0., -15. / 4.]),
            ((1. / 2., 0.), [-3. / 2., 0., 17. / 8.], [0., 3., -9. / 4.], [3., 0., -3.]),
            ((1. / 2., 1. / 2.), [0., 0., 39. / 32.], [0., 3., -15. / 16.], [3., 0., -3. / 4.]),
            (
                (1. / 4., 3. / 4.),
                [3. / 4., -3. / 4., 95. / 128.],
                [0., 3., 45. / 32.],
                [3., 0., -207. / 256.],
            ),
            ((1., 1.), [3. / 2., 3. / 2., -1.], [0., 3., -15.], [3., 0., -3.]),
            (
                (1. / 3., 2. / 3.),
                [1. / 2., -1. / 2., 26. / 27.],
                [0., 3., 38. / 27.],
                [3., 0., -4. / 3.],
            ),
        ];
        let products = [
            [-18., -27., -9.],
            [-45. / 4., 0., -9.],
            [-9., -27. / 4., -9.],
            [-9. / 4., -45. / 16., -9.],
            [-621. / 256., 135. / 32., -9.],
            [-9., -45., -9.],
            [-4., 38. / 9., -9.],
        ];
        has_values(&red_book_patch(), &facts, &products);
    }

    /// The lecture's polynomial: z = s³ a(t) + s² b(t) + s c(t) + d(t), with s = u, t = v.
    #[test]
    fn heights_of_the_graph_are_a_polynomial_with_two_derivatives() {
        let cubic = |c: [f64; 4], t: f64| {
            let value = ((c[0] * t + c[1]) * t + c[2]) * t + c[3];
            let first = (3. * c[0] * t + 2. * c[1]) * t + c[2];
            [value, first, 6. * c[0] * t + 2. * c[1]]
        };
        let patch = bicubic_graph();
        for i in 0..=12 {
            for j in 0..=12 {
                let (s, t) = (f64::from(i) / 12.0, f64::from(j) / 12.0);
                let a = cubic([-3., -24., 21., -3.], t);
                let b = cubic([33., 9., -36., 9.], t);
                let c = cubic([-36., 27., 9., -6.], t);
                let d = cubic([9., -12., 3., 5.], t);
                let along = |k: usize| cubic([a[k], b[k], c[k], d[k]], s);
                let z = patch.derivatives(DVec2::new(s, t));
                close(z.point, [3. * t, 3. * s, along(0)[0]]);
                close(z.du, [0., 3., along(0)[1]]);
                close(z.dv, [3., 0., along(1)[0]]);
                close(z.duu / 10., [0., 0., along(0)[2] / 10.]);
                close(z.duv / 10., [0., 0., along(1)[1] / 10.]);
                close(z.dvv / 10., [0., 0., along(2)[0] / 10.]);
            }
        }
    }
}
