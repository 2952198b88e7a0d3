//! What hits on leaves with trim curves are compared with.

use rayon::prelude::*;

use crate::geometry::trim::WindowCurve;
use crate::patch::{Leaf, Piece};

/// The windows ([`Trims::window`](crate::geometry::trim::Trims::window)) of all leaves that trim
/// curves pass through.
#[derive(Clone, Debug, Default)]
pub(crate) struct TrimWindows {
    curves: Vec<WindowCurve>,
    /// Where the curves of each leaf begin, and at last their number; empty if there are none.
    first: Vec<u32>,
}

impl TrimWindows {
    pub(crate) fn new(leaves: &[Leaf], pieces: &[Piece]) -> Self {
        if !leaves.iter().any(Leaf::is_trimmed) {
            return Self::default();
        }
        let windows = leaves.par_iter().map(|leaf| {
            let piece = &pieces[leaf.piece as usize];
            if leaf.is_trimmed() { piece.trim_window(leaf.rect()) } else { Vec::new() }
        });
        let windows: Vec<Vec<WindowCurve>> = windows.collect();
        let mut first = vec![0];
        first.extend(windows.iter().scan(0, |count, window| {
            *count += window.len() as u32;
            Some(*count)
        }));
        Self { curves: windows.concat(), first }
    }

    /// The window of a leaf, in its box coordinates; empty if the trims themselves must be asked.
    #[inline(always)]
    pub(crate) fn of(&self, leaf: u32) -> &[WindowCurve] {
        let leaf = leaf as usize;
        match self.first.get(leaf..leaf + 2) {
            Some(&[from, to]) => &self.curves[from as usize..to as usize],
            _ => &[],
        }
    }

    /// The memory taken, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.curves[..]) + size_of_val(&self.first[..])
    }
}
