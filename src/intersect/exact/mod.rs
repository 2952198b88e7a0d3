//! The exact solver: all roots of a ray on a leaf, by subdivision and proof.
//!
//! # The problem
//! Over a leaf's rectangle the surface, seen in ray coordinates, is a net of homogeneous points
//! `(w x, w y, w z, w)`. The ray meets it where the polynomials `f = (w x, w y)` vanish together.
//! These are taken to be known to within `ε`: half the error bound of a point, times the largest
//! weight. (Like the promise for points, this does not bound the worst case of all roundings: the
//! most pessimistic count for cutting the net down twice, `12 (p + q)` units of the largest
//! coefficient, is more than the `2 (p + q + 4)` units taken. Errors of random sign stay well below:
//! of random nets of degree 1 to 12, compared with exact fractions, none was off by half of that.)
//! The solver keeps a list of parameter boxes that may hold roots, and asks of each:
//!
//! 1. *Can it be discarded?* A polynomial lies between the smallest and the largest of its
//!    Bernstein coefficients. Where `w x` or `w y` keeps its sign by more than `ε`, or a component
//!    of `g = A f` (with `A` the inverse of the mean Jacobian) by more than `ε_g`, the largest row
//!    sum of `|A|` times `ε`, or where `z` stays out of range, there is no root.
//! 2. *Is a root proved?* Let `κ` bound the row sums of `|I − g'|` over the box. Where `κ`, plus
//!    what rounding of the coefficients adds to derivatives (`2 (p + q) ε_g`), is below 1, the box
//!    holds at most one root, and it lies in `m − g(m) ± (κ/2 + ε_g)` (Krawczyk 1969; `m` is the
//!    middle, sides are 1). Where that range lies inside the box, the root exists. It is then
//!    refined on the surface itself, and must stay in the box.
//! 3. *Can it shrink?* The box is cut down to where the hulls of the coefficients meet
//!    zero (Bézier clipping: Sederberg & Nishita 1990; Efremov, Havran & Seidel 2005),
//!    else halved across its longer image. Parts overlap a little, so that a root on the
//!    line between two boxes is inside one of them; a root found twice is recognised by its box.
//! 4. *Does rounding decide?* Where all of `f` is within `2ε` of zero, the ray passes the
//!    whole box within rounding; a box of a few last digits of parameters cannot be halved. Either
//!    is reported as one contact, flagged doubtful. At a side that is collapsed to a point the
//!    contact is the pole, and doubtful only where the ray may touch the surface there.
//!
//! The box's net is always cut anew from the leaf's, so its error is the same at every
//! depth. Work is bounded: when the budget is used up, or the ray is seen to run inside
//! the surface, only the first and the last place where it may meet what is left are
//! searched for and reported, flagged.

mod contact;
mod parameter_box;
mod problem;
mod solver;

pub(super) use problem::{End, Evidence, Found, Problem, Solution};
pub(super) use solver::{AT_CONTACT, AT_POLE, END, ExactSolver, STRETCH};
