//! Lists of points in JSON.

use std::fmt;

use glam::DVec3;
use serde::Deserialize;
use serde::de::{Deserializer, SeqAccess, Visitor};

/// A list of points, read without a list for each point.
#[derive(Debug, Default)]
pub(super) struct Points {
    /// The points; missing coordinates are 0.
    pub(super) points: Vec<DVec3>,
    /// The number of coordinates of the first point, if there is one.
    pub(super) dimension: Option<usize>,
    /// The first point, if any, with another number of coordinates, and that number.
    pub(super) odd: Option<(usize, usize)>,
}

impl Points {
    /// The number of coordinates of the first point, if any, that has others than `needed`.
    pub(super) fn unlike(&self, needed: usize) -> Option<usize> {
        let odd = self.odd.map(|(_, dimension)| dimension);
        [self.dimension, odd].into_iter().flatten().find(|&dimension| dimension != needed)
    }
}

impl<'de> Deserialize<'de> for Points {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visit;
        impl<'de> Visitor<'de> for Visit {
            type Value = Points;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of points")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Points, A::Error> {
                let mut read = Points::default();
                while let Some(Point { point, dimension }) = list.next_element()? {
                    let first = *read.dimension.get_or_insert(dimension);
                    if dimension != first && read.odd.is_none() {
                        read.odd = Some((read.points.len(), dimension));
                    }
                    read.points.push(point);
                }
                Ok(read)
            }
        }
        deserializer.deserialize_seq(Visit)
    }
}

/// One point of any number of coordinates; the first three are kept.
struct Point {
    point: DVec3,
    dimension: usize,
}

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visit;
        impl<'de> Visitor<'de> for Visit {
            type Value = Point;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a point, [x, y, z]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Point, A::Error> {
                let mut read = Point { point: DVec3::ZERO, dimension: 0 };
                while let Some(coordinate) = list.next_element::<f64>()? {
                    if read.dimension < 3 {
                        read.point[read.dimension] = coordinate;
                    }
                    read.dimension += 1;
                }
                Ok(read)
            }
        }
        deserializer.deserialize_seq(Visit)
    }
}
