//! Rational Bézier pieces, and their places on surfaces.
//!
//! In reading order: a `piece` is a patch (`tensor`) in its place on a chart of its surface
//! (`chart_net`), whose pieces lie in rows (`chart_grid`). `keeping` chooses which control points
//! are kept as they are (`piece_net`), and which are made on demand from those of the spline
//! (`spline_net`); `powers` brings them into power form, and `power_nets` keeps that. Sides may be
//! collapsed to a point, where `apexes` differ from poles, and where normals take more care
//! (`pole_normal`). Over a rectangle (`rect`) of a piece there are Bernstein coefficients of it and
//! its tangents (`field`), and points (`grid`).

pub(super) mod apexes;
pub(super) mod chart_grid;
pub(super) mod chart_net;
pub(super) mod field;
pub(super) mod grid;
pub(super) mod keeping;
pub(super) mod piece;
pub(super) mod piece_net;
mod pole_normal;
mod power_nets;
pub(super) mod powers;
pub(super) mod rect;
pub(super) mod spline_net;
pub(super) mod tensor;
