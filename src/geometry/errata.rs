//! Misprints in documents that parts of this module follow.
//!
//! Who compares this code with these documents may need them; nobody else does. Each entry says
//! what is printed, what is right, and where it is implemented.
//!
//! # Eberly
//! David Eberly, *Representing a Circle or a Sphere with NURBS*, Geometric Tools, 2003–2015.
//!
//! - (2): the half-open spans of the basis functions of degree 0 let all functions vanish at the
//!   end of the domain. The last span is closed: [`KnotVector::span_index`].
//! - 2.1.2, "2 possibilities" for `w₁ = 1`: the equations (11) have two more solutions, `(y₁, x₂,
//!   w₂) = (−√2/4, 1 + √2/8, −2√2/3)` and `(−1 − √2, −(44√2 + 1)/79, (16 + 7√2)/6)`, which leave
//!   the quadrant. The equations and the two printed solutions are right:
//!   [`QuarticArc`](shapes::QuarticArc).
//! - 2.2, the first control point of the half circle is `(1, 0)`: a circle needs `(0, 1)`.
//!   [`shapes::half_circle_cubic`].
//! - 2.3, the first and the last control point of the circle are `(1, 0)` in the list, the last is
//!   `(0, −1)` in table 1: all are `(0, 1)`. [`shapes::circle_cubic`].
//! - 2.3, before (15), `N₂,₂ = 0`: it is `N₀,₂` that vanishes, as `N₂,₂` in (15) does not.
//!   [`KnotVector::basis`].
//! - 3.1.1, the domain of the octant of degree 2 is the triangle `u + v ≤ 1`: that covers 75.3 % of
//!   the octant only, as `(1/2, 1/2)` is `(9/25, 12/25, 4/5)`, inside. The domain is the unit
//!   square, and the patch is not triangular, of degree 4, but a tensor product of degrees 2 and 2
//!   whose side `u = 1` is the pole. [`shapes::octant_biquadratic`].
//! - 3.1.2, the constants of the quartic octant, after Farin 1990, are right as printed:
//!   [`shapes::octant_quartic`].
//! - 3.2, the list of control points lacks `(−2, 0, ±1)` and `(−2, 4, ±1)`; table 2 is right.
//!   [`shapes::hemisphere_inward`], and [`shapes::hemisphere`] with u and v exchanged.
//! - 3.3, "wrap the surface around the u-axis": the z axis is meant. For the knots `u_i = 1` the
//!   indices are `4 ≤ i ≤ 7`; "4 <= 7" is printed. Tables 3 and 4 have u at the rows and v at the
//!   columns, table 2 has them the other way round, so that the normals of the hemisphere point
//!   inward and those of the sphere outward. [`shapes::sphere`]. In scenes, `swap_uv = true` gives
//!   `hemisphere` and `octant` the u and v of the note.
//!
//! # Zhang
//! Hongxin Zhang, *Computer Graphics 2016, 10. Spline and Surfaces*, State Key Lab of CAD&CG,
//! Zhejiang University, slides of 5 December 2016.
//!
//! - Bézier curves: two slides have `Σ x_i B_{i,t}(t)`. The second index is the degree n:
//!   [`bernstein`].
//! - De Casteljau's algorithm: `P_i^0(u)` occurs once where all else depends on t; in the pyramid
//!   of a cubic, `3t(1 − t)² P_0^1` means the control point `P_1`. [`de_casteljau`].
//! - Knots: the last one for control points 0 to n is printed as `u_{n+k+1}`. With the degree p it
//!   is `u_{n+p+1}`; elsewhere k is the order `p + 1`. The domain is not all of `[u_0, u_{n+p+1}]`
//!   but `[u_p, u_{n+1}]`. [`KnotVector`], where there are n points, not n + 1.
//! - Basis functions: the pieces of `N_{i,p}` are said to have degrees `< p`; they have degrees up
//!   to p. `N_{i,p} > 0` is printed from `u_i` on: at `u_i` itself the function is 0 for `p ≥ 1`,
//!   unless all knots up to `u_{i+p}` are the same. The functions add up to 1 on the domain only,
//!   not everywhere. [`KnotVector::basis`].
//! - De Boor's algorithm: the second denominator is printed as `u_{i+k−r} − u_{i−1}`; both are
//!   `u_{i+k−r} − u_i`. [`NurbsCurve::point_at`].
//! - Normals: `N = S_u × S_v` is printed with the derivatives of a polynomial patch only. Those of
//!   a rational surface follow the quotient rule: [`NurbsSurface::normal`].
//! - OpenGL: a scan's letters `glMapI`, `GL_MAPI_VERTEX_3` have an I for a 1 (`glMap1f`), and the
//!   `4 × 4 × 3` array lacks opening braces. Called as usual, with strides of 3 and 12, u runs
//!   along the inner index and v over the rows: the transpose of `S(u, v) = Σ P_ij B_i(u) B_j(v)`,
//!   which is used in [`shapes::red_book_patch`].
//! - Subdivision of curves: Chaikin's rule is called Doo–Sabin's and the cubic one Catmull–Clark's,
//!   after their surfaces. [`CornerCutting`].
//!
//! # Lecture 24
//! *Lecture 24: Bicubic Surfaces & Splines*, slides of 5 December 2019, without an author's name.
//!
//! - The polynomial for z of the first patch is right. Its matrices of coordinates `G_x`, `G_y`,
//!   `G_z` stand there as one block of twelve rows: four rows each. [`shapes::bicubic_graph`].
//! - `S M G M Tᵀ` for surfaces is right for the Bézier matrix, which is symmetric; B-splines need
//!   `S M G Mᵀ Tᵀ`. Likewise `Q_j(t) = G_j B(t)` needs `B = Mᵀ Tᵀ`. [`MatrixForm`] and
//!   [`matrix_patch`].
//! - The blending functions are B₀ to B₃ on one slide and B₄ to B₁ on the next: [`MatrixForm`] has
//!   B₀ to B₃.
//! - "Every control point must have a corresponding t-value", and the knot vector lists these:
//!   there are `p + 1` more knots than control points. "Uniform" means that knots are evenly
//!   spaced, not control points. Knots without space between them make a jump only if `p + 1` of
//!   them coincide; p of them make a corner. [`KnotVector`].
//! - The standard knot vector of five points is printed as `0, 0, 0, 0, 1, 2, 3, 4, 5, 5, 5, 5`:
//!   these twelve knots are those of eight points. Five get `0, 0, 0, 0, 1, 2, 2, 2, 2`.
//!   [`KnotVector::standard`].
//! - The slide with threefold ends has coordinates a hundred times those of the slide that defines
//!   the points. [`with_repeated_ends`].

#[cfg(doc)]
use super::{
    CornerCutting, KnotVector, MatrixForm, NurbsCurve, NurbsSurface, bernstein, de_casteljau,
    matrix_patch, shapes, with_repeated_ends,
};
