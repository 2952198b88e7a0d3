//! Normals beside a collapsed side, as exact as the control points.
//!
//! Where the side `t = 0` is collapsed to a point `P`, the tangent along it vanishes. At a distance
//! `ρ` from there that tangent, and so the normal, is known only to `error / ρ`. But `X − P W` has
//! a first column of zeros. So it is `t A`, and `A`, of one degree less, is as exact as the control
//! points. With `Q = A / W` the surface is `P + t Q` and has the tangents `t Q_s` and `Q + t Q_t`:
//! the normal has the direction of `Q_s × (Q + t Q_t)`, in which nothing vanishes.
//!
//! Where more columns are that point, `m` in all, `X − P W` is `tᵐ A`. Then the normal has the
//! direction of `Q_s × (m Q + t Q_t)`. Columns that are that point but for rounding may be left out
//! or not: whichever turns the normal less, as far as is known.

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use super::field::{Field, Net};
use super::tensor::derivative_table;
use crate::geometry::{Direction, RectSide};
use crate::math::bernstein::binomial;
use crate::patch::TensorPatch;

/// The unit normal of a patch at a place, from the pole at one of its sides, and the angle, in
/// radians, by which the rounding of tangents may have turned it; `None` where the pole tells
/// nothing about it, for example where the tangents away from the pole do not turn along the side.
pub(super) fn normal_by_pole(
    patch: &TensorPatch,
    (side, pole): (RectSide, DVec3),
    st: DVec2,
) -> Option<(DVec3, f64)> {
    let (control, noise) = (patch.control_net(), patch.noise());
    let net = |degree, control| Net { degree, control, noise, rational: true, spacing: [0.0; 2] };
    let (degree @ [p, q], control) = net(patch.degree(), &control).with_collapsed_first(side);
    let field = net(degree, &control).recentered(pole);
    let column = |j: usize| field.values.iter().skip(j).step_by(q + 1);
    let is_point =
        |j: &usize| column(*j).all(|c| c.xyz().abs().max_element() <= patch.one_point() * c.w);
    let most = 1 + (1..q).take_while(is_point).count();

    let t = RectSide::distances(st)[side].max(0.0);
    let in_s = derivative_table(p, st[side.along()]);
    let in_t = derivative_table(q, t);
    let sum = |field: &Field, order_s: usize, in_t: &[f64]| -> DVec4 {
        let rows = field.values.chunks_exact(field.degree[1] + 1).zip(&in_s[order_s]);
        rows.map(|(row, s)| row.iter().zip(in_t).map(|(&c, t)| *s * t * c).sum::<DVec4>()).sum()
    };
    let weight = |order_s: usize, order_t: usize| sum(&field, order_s, &in_t[order_t]).w;
    let w = weight(0, 0);

    let mut quotient = field.over_t();
    let mut best: Option<(DVec3, f64)> = None;
    // What is left out of columns that are only nearly the point, as a part of `A`.
    let mut left_out = 0.0;
    for times in 1..=most {
        if times > 1 {
            let longest = column(times - 1).map(|c| c.xyz().length()).fold(0.0, f64::max);
            quotient = quotient.over_t();
            left_out += binomial(q, times - 1) * longest / w;
            left_out = if left_out > 0.0 { left_out / t } else { 0.0 }; // at the pole t is 0
        }
        let lowered = derivative_table(q - times, t);
        let value =
            |order_s: usize, order_t: usize| sum(&quotient, order_s, &lowered[order_t]).xyz();
        let here = value(0, 0) / w;
        let by_s = (value(1, 0) - here * weight(1, 0)) / w;
        let by_t = (value(0, 1) - here * weight(0, 1)) / w;
        let across = times as f64 * here + t * by_t;
        let cross = by_s.cross(across);
        // The error of coefficients is `C(q, m)` times that of points, the error of derivatives
        // `2 p` times as much again.
        let off = 2.0 * (binomial(q, times) * noise + times as f64 * left_out);
        let turned = off * (by_s.length() + 2.0 * p as f64 * across.length()) / cross.length();
        let Some(normal) = cross.try_normalize() else { continue };
        if best.is_none_or(|(_, least)| turned < least) {
            best = Some((normal, turned));
        }
    }
    // Undoes the mirroring and swapping of the net.
    let backwards = side.is_last() != (side.fixed() == Direction::U);
    best.map(|(normal, turned)| (if backwards { -normal } else { normal }, turned))
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DMat3};

    use super::*;
    use crate::geometry::shapes;
    use crate::patch::PatchSet;

    /// On a sphere the normal is the radius, as near to a pole as can be told.
    #[test]
    fn normals_of_a_sphere_are_right_beside_its_poles() {
        let offset = DVec3::new(3.0, 4.0, 10.0);
        let turn = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_y(1.1);
        for (offset, most) in [(DVec3::ZERO, 4e-15), (offset, 4e-14)] {
            let place = DAffine3::from_mat3_translation(turn, offset);
            let sphere = shapes::sphere(1.0).unwrap().transformed(&place).unwrap();
            for sphere in
                [sphere.clone(), sphere.swapped(), sphere.reversed_u(), sphere.reversed_v()]
            {
                let (set, _) = PatchSet::new(std::slice::from_ref(&sphere)).unwrap();
                let mut asked = 0;
                for piece in set.pieces() {
                    for (side, pole) in piece.collapsed_sides() {
                        for (distance, along) in [1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 0.0]
                            .into_iter()
                            .flat_map(|distance| [0.0, 0.3, 1.0].map(|along| (distance, along)))
                        {
                            let mut st = DVec2::splat(along);
                            st[side.fixed()] = (side.value() - distance).abs();
                            let (normal, turned) =
                                normal_by_pole(&piece.patch, (side, pole), st).unwrap();
                            assert!(turned <= 1e-9, "{turned}");
                            let radius = piece.patch.point(st) - offset;
                            let outward = piece.patch.jet(DVec2::splat(0.5));
                            let outward = outward.ds.cross(outward.dt).dot(outward.point - offset);
                            let off = normal.distance(radius.normalize() * outward.signum());
                            assert!(off < most, "{side:?} {st}: {off:e}");
                            asked += 1;
                        }
                    }
                }
                assert_eq!(asked, 4 * 6 * 3, "four sides at poles");
            }
        }
    }
}
