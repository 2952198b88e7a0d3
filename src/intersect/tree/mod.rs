//! The hierarchy of boxes that all kernels traverse.
//!
//! In reading order: `nodes` is the tree, nodes of up to sixteen children over blocks of up to
//! sixteen leaves. To make it, `hierarchy` has obvhs build a binary tree over the leaves' boxes,
//! `collapse` turns that into nodes, and `regions` does so for the scene and, in coordinates of
//! their own, for things that are small compared with it.

mod collapse;
mod hierarchy;
pub(super) mod nodes;
pub(super) mod regions;
