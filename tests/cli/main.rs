//! The program as its users meet it: every subcommand, every exit code, every message.
#![cfg(test)]

mod audit;
mod bench;
mod cast;
mod compare;
mod figure;
mod info;
mod plot;
mod plot_constructions;
mod plot_curves;
mod plot_functions;
mod plot_surfaces;
mod render;
mod sandbox;
mod usage;
