//! Why a scene cannot be shown, another object's lines cannot be drawn, or a plot cannot be made.
//! An error tells what was found and, where that is known, the place it was written at. What is
//! written is known here by its names, places and limits, and `look` by its own errors; how
//! surfaces are made is not known.

mod draw_error;
mod plot_error;
mod scene_error;

pub use draw_error::DrawError;
pub use plot_error::PlotError;
pub use scene_error::{SceneError, SceneFault, TrimCurveFault};
