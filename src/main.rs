//! The program `nurbray`.

fn main() {}
