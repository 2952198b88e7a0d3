//! Panels of things in space.

use nurbray::scene::Plane;

use super::box_axes::box_axes;
use super::panel::{Item, Key, Panel, Scale};
use super::projection::Projection;

impl Projection {
    /// A panel of things in this projection.
    pub(super) fn panel(
        self,
        title: String,
        mut items: Vec<Item>,
        legend: Vec<(Key, String)>,
    ) -> Panel {
        let axes = match self.plane {
            Plane::Xy => ["x", "y"],
            Plane::Xz => ["x", "z"],
            Plane::Yz => ["y", "z"],
            Plane::Across(_) => {
                items.splice(0..0, box_axes(self.bounds, self));
                return Panel {
                    title,
                    axes: Default::default(),
                    scale: Scale::View,
                    items,
                    legend,
                };
            }
        };
        Panel { title, axes: axes.map(str::to_owned), scale: Scale::Space, items, legend }
    }
}
