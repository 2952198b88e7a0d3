//! A race: all competitors trace the same rays in the same run, and report what these met.
//!
//! `bench` prints the speeds, `compare` also what a rival's tessellation gets wrong.

mod clock;
mod measure;
mod model;
mod ours;
mod outcome;
mod pixels;
mod ray_set;
mod rays;
mod rival;
mod steps;

pub(crate) use clock::Speed;
pub(crate) use measure::{KernelResult, Measurement, RivalResult};
pub(crate) use model::Model;
pub(crate) use pixels::tiled_pixels;
pub(crate) use ray_set::{Question, RaySet};
pub(crate) use rays::{REACH, Rays};
pub(crate) use rival::{Entry, Rival};
pub(crate) use steps::{Preparation, Steps};

/// The longest side of a picture in pixels: its 64 million rays and their packets take about 20 GB.
pub(crate) const MAX_SIDE: u32 = 8192;
