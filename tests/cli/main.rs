//! The program as its users meet it: every subcommand, every exit code, every message.
#![cfg(test)]

mod audit;
mod bench;
mod cast;
mod compare;
mod info;
mod plot;
mod render;
mod sandbox;
mod usage;
