//! How curves and nets are made visible: thick or thin, open or closed.

use glam::DVec3;

/// How a tube ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Caps {
    /// Open.
    Open,
    /// With a disk.
    Flat,
    /// With half a sphere.
    #[default]
    Round,
}

/// The style of a tube: its radius, its ends and its accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TubeStyle {
    /// Its radius.
    pub radius: f64,
    /// How it ends.
    pub caps: Caps,
    /// The largest allowed distance from the true tube, in scene units, where the curve is neither
    /// straight nor round. The default is that of [`SweepOptions`](super::SweepOptions), for each
    /// smooth part.
    pub tolerance: Option<f64>,
}

/// The style of a ribbon: its width, its orientation and its accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RibbonStyle {
    /// Its width.
    pub width: f64,
    /// The direction that the ribbon faces at the start of each smooth part, as nearly as possible.
    /// The default is z, or y where the curve begins steeply.
    pub up: Option<DVec3>,
    /// The angle in degrees by which each smooth part is twisted, evenly in its parameter.
    pub twist: f64,
    /// The largest allowed distance from the true ribbon, in scene units. The default is that of
    /// [`SweepOptions`](super::SweepOptions), for each smooth part.
    pub tolerance: Option<f64>,
}

/// How thick a net is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetStyle {
    /// The radius of the lines between control points.
    pub radius: f64,
    /// The radius of the balls at the control points; larger than that of the lines, or the
    /// two touch along a circle.
    pub joints: f64,
}

impl NetStyle {
    /// The most control points of a net that is drawn: each becomes a ball of 45 control points and
    /// two lines of 18, hundreds of leaves in all; more points than this cannot be told apart.
    pub const MAX_POINTS: usize = 1 << 16;

    /// The style of the lines as tubes.
    pub fn lines(&self) -> TubeStyle {
        TubeStyle { radius: self.radius, caps: Caps::Open, tolerance: None }
    }
}
