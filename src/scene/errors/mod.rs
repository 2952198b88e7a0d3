//! Why a scene cannot be shown, an object not be drawn, a plot not be made: each error says what
//! was found and where it was written. They know what was written by its names, its places and its
//! limits, and nothing of how it is made into surfaces.

mod draw_error;
mod plot_error;
mod scene_error;

pub use draw_error::DrawError;
pub use plot_error::PlotError;
pub use scene_error::{SceneError, SceneFault, TrimCurveFault};
