//! Packets: up to sixty-four rays, traced together.
//!
//! In reading order: `read_ahead` brings rays into the caches in time. `outline` sees from bounds
//! shared by rays that most packets of a background meet nothing; `load` puts the others into the
//! lanes of a packet (`rays`, with `starts` and `hits`). `traverse` takes it through the tree:
//! sixteen boxes are tested at once against all its rays (`shared_bounds`) and, where boxes are
//! small compared with how far apart the rays are, against each ray by itself (`apart`). `leaf`
//! searches a leaf (`target`) for sixteen rays at a time. Those that meet its box (`box_passage`),
//! and for which its certificate holds, get a start in f32, which may prove enough (`screening`),
//! else an end in f64 (`finish`, on `one_leaf`). Those for which it does not hold are put aside
//! until there are sixteen (`doubts`), and then examined (`settle`). A ray that starts on a leaf
//! may be done with it (`departures`). What is kept between packets, and found, is their `work`;
//! `answers` reads what rays have met.

mod answers;
mod apart;
mod box_passage;
mod departures;
mod doubts;
mod finish;
pub(super) mod hits;
mod leaf;
mod load;
mod one_leaf;
mod outline;
pub(super) mod rays;
pub(super) mod read_ahead;
mod screening;
mod settle;
mod shared_bounds;
mod starts;
mod target;
pub(super) mod traverse;
pub(super) mod work;
