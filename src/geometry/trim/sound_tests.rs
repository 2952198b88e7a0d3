//! Valid loops that are close to invalid ones.

use std::f64::consts::PI;

use glam::DVec2;

use super::{Kept, Side, TrimCurve, TrimDomain, TrimLoop, Trims, UvBox};

/// A loop and points, in fractions of a domain.
struct Case {
    name: String,
    /// Corners of a polygon.
    corners: Vec<[f64; 2]>,
    /// Points that the loop encloses, and points that it does not.
    inside: Vec<[f64; 2]>,
    outside: Vec<[f64; 2]>,
}

fn case(
    name: impl Into<String>,
    corners: &[[f64; 2]],
    inside: &[[f64; 2]],
    outside: &[[f64; 2]],
) -> Case {
    let [corners, inside, outside] = [corners, inside, outside].map(<[_]>::to_vec);
    Case { name: name.into(), corners, inside, outside }
}

fn cases() -> Vec<Case> {
    let middle = [[0.5, 0.5]];
    let mut cases = vec![
        case("the domain", &[[0., 0.], [1., 0.], [1., 1.], [0., 1.]], &middle, &[]),
        case(
            "from corner to corner",
            &[[0., 0.], [1., 0.], [1., 1.]],
            &[[0.6, 0.5]],
            &[[0.4, 0.5]],
        ),
        case(
            "corners on the border",
            &[[0.5, 0.], [1., 0.5], [0.5, 1.], [0., 0.5]],
            &middle,
            &[[0.1, 0.1]],
        ),
        case(
            "beyond the border",
            &[[-1., 0.4], [2., 0.4], [2., 0.6], [-1., 0.6]],
            &middle,
            &[[0.5, 0.3]],
        ),
        case(
            "along a pole",
            &[[0.3, 0.], [0.7, 0.], [0.7, 0.2], [0.3, 0.2]],
            &[[0.5, 0.1]],
            &middle,
        ),
        case(
            "a keyhole",
            &[
                [0.1, 0.1],
                [0.9, 0.1],
                [0.9, 0.5],
                [0.7, 0.5],
                [0.7, 0.3],
                [0.3, 0.3],
                [0.3, 0.7],
                [0.7, 0.7],
                [0.7, 0.5],
                [0.9, 0.5],
                [0.9, 0.9],
                [0.1, 0.9],
            ],
            &[[0.2, 0.5], [0.8, 0.4], [0.8, 0.6]],
            &middle,
        ),
    ];
    // Down to the narrowest slit that rounding resolves: parameters are about 10⁻¹⁶ apart.
    for width in [1e-3, 1e-6, 1e-9, 1e-12] {
        let slit = |from: f64, to: f64| [[from, 0.1], [to, 0.1], [to, 0.9], [from, 0.9]];
        let name = format!("a slit, {width:e}");
        cases.push(case(
            name,
            &slit(0.5, 0.5 + width),
            &[[0.5 + width / 2., 0.5]],
            &[[0.499, 0.5]],
        ));
        let name = format!("a slit across, {width:e}");
        let across = slit(0.5, 0.5 + width).map(|[u, v]| [v, u]);
        cases.push(case(name, &across, &[[0.5, 0.5 + width / 2.]], &[[0.5, 0.499]]));
        let name = format!("a wedge, {width:e}");
        let wedge = [[0.5, 0.1], [0.5 + width, 0.9], [0.5, 0.9]];
        cases.push(case(name, &wedge, &[[0.5 + width / 4., 0.6]], &[[0.499, 0.6]]));
    }
    for width in [1e-3, 1e-6, 1e-9] {
        let comb = |tip: [f64; 2]| {
            [[0.1, 0.1], [0.5, 0.1], tip, [0.5 + width, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]]
        };
        let name = format!("a notch, {width:e}");
        let (low, high) = ([0.5 + width / 2., 0.2], [0.5 + width / 2., 0.05]);
        cases.push(case(name, &comb([0.5, 0.8]), &[[0.3, 0.2]], &[low]));
        let name = format!("a thorn, {width:e}");
        cases.push(case(name, &comb([0.5, 0.0]), &[[0.3, 0.2], low], &[[0.3, 0.05], high]));
    }
    cases
}

/// Domains of all sizes, and with very different sizes in u and in v.
#[test]
fn polygons() {
    let domains = [
        ([0.0, 1.0], [0.0, 1.0]),
        ([-2.0, 6.0], [1.0, 2.0]),
        ([0.0, 1e-6], [0.0, 1e6]),
        ([0.0, 1e8], [0.0, 1e-8]),
    ];
    let mut faults = Vec::new();
    for (u, v) in domains {
        let domain = TrimDomain::new(u, v).unwrap();
        let at =
            |&[x, y]: &[f64; 2]| DVec2::new(u[0] + x * (u[1] - u[0]), v[0] + y * (v[1] - v[0]));
        // A slit of 10⁻¹² is only a few rounding errors wide where parameters do not begin at 0.
        for Case { name, corners, inside, outside } in cases() {
            let corners: Vec<DVec2> = corners.iter().map(at).collect();
            for turned in 0..corners.len() {
                let mut corners = corners.clone();
                corners.rotate_left(turned);
                let one = TrimLoop::polygon(&corners).unwrap();
                for one in [one.reversed(), one] {
                    let trims = match Trims::new(domain, Kept::Odd, &[one]) {
                        Ok(trims) => trims,
                        Err(error) => {
                            faults.push(format!("{name}, {u:?} {v:?}, {turned}: {error}"));
                            continue;
                        }
                    };
                    let wrong = |at: &DVec2, unlike: Side| trims.side_of(*at) == unlike;
                    let wrongly_out = inside.iter().map(at).any(|at| wrong(&at, Side::Outside));
                    let wrongly_in = outside.iter().map(at).any(|at| wrong(&at, Side::Inside));
                    if wrongly_in || wrongly_out {
                        faults.push(format!("{name}, {u:?} {v:?}: {wrongly_out} {wrongly_in}"));
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn curved_loops() {
    let unit = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
    let circle = |u: f64, v: f64, radius: f64| TrimLoop::circle(DVec2::new(u, v), radius).unwrap();
    let whole = TrimLoop::rectangle(UvBox::new([0.0, 1.0], [0.0, 1.0])).unwrap();
    // A crescent: around the outer circle, and back around one inside of it that touches it.
    let crescent = |ratio: f64| {
        let (outer, inner) = (0.4, 0.4 * ratio);
        let arc = |radius: f64, from: f64, to: f64| {
            TrimCurve::arc(DVec2::new(0.9 - radius, 0.5), radius, from, to).unwrap()
        };
        TrimLoop::new(&[arc(outer, 0.0, 2.0 * PI), arc(inner, 2.0 * PI, 0.0)]).unwrap()
    };
    let cases = [
        ("touches the border", vec![circle(0.5, 0.5, 0.5)]),
        ("touches the border and the loop along it", vec![whole.clone(), circle(0.5, 0.5, 0.5)]),
        ("around a pole", vec![circle(0.5, 0.0, 0.2)]),
        ("around a corner", vec![circle(0.0, 0.0, 0.2)]),
        ("tangent to a pole", vec![circle(0.5, 0.2, 0.2)]),
        ("small", vec![circle(0.5, 0.5, 1e-9)]),
        ("touching each other", vec![circle(0.3, 0.5, 0.2), circle(0.7, 0.5, 0.2)]),
        ("one in the other, touching", vec![circle(0.5, 0.5, 0.4), circle(0.7, 0.5, 0.2)]),
        ("crescent", vec![crescent(0.5)]),
        ("narrow crescent", vec![crescent(1.0 - 1e-3)]),
        ("narrower crescent", vec![crescent(1.0 - 1e-6)]),
    ];
    for (name, loops) in cases {
        for loops in [loops.clone(), loops.iter().map(TrimLoop::reversed).collect()] {
            let made = Trims::new(unit, Kept::Odd, &loops);
            assert!(made.is_ok(), "{name}: {}", made.unwrap_err());
        }
    }
}
