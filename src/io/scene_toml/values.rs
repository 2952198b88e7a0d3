//! Values that can be written in more than one way.

use std::fmt;
use std::marker::PhantomData;

use glam::{DVec2, DVec3};
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Unexpected, Visitor};

use crate::geometry::MAX_DEGREE;
use crate::math::{Counted, Shown};
use crate::scene::{MAX_INTENSITY, MAX_LIGHT, Rgb};

/// A finite number, whole or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number(pub(super) f64);

/// Three numbers, `[x, y, z]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector(pub(super) DVec3);

/// A point of a curve or a cage: `[x, y, z]`, or `[x, y]` in the plane `z = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point(pub(super) DVec3);

/// A [`Point`] of a control net, in one of its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NetPoint(pub(super) DVec3);

/// A [`Point`] of a triangular patch, whose rows are not lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TrianglePoint(pub(super) DVec3);

/// A place in the plane of (u, v): two numbers, `[u, v]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair(pub(super) DVec2);

/// One number for all three axes, or `[x, y, z]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Factors(pub(super) DVec3);

/// `"x"`, `"y"`, `"z"`, or `[x, y, z]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis(pub(super) DVec3);

/// The color of a thing, in linear light: `[r, g, b]`, one number for grey, or `"#rrggbb"` as a
/// screen shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Color(pub(super) Rgb);

/// The light of a lamp, written as a [`Color`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Emission(pub(super) Rgb);

/// The light of a lamp that fades with distance, and so may be brighter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Intensity(pub(super) Rgb);

/// A whole number, which messages call one from `LEAST` to `MOST`. Others from 0 on are read, too:
/// the code that uses them says more about these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Whole<const LEAST: u32, const MOST: u32>(pub(super) u32);

/// How many of something, at least one.
pub(super) type Count = Whole<1, { u32::MAX }>;

/// The degree of a curve, or of a surface in one direction.
pub(super) type Degree = Whole<1, { MAX_DEGREE as u32 }>;

/// The degree of basis functions.
pub(super) type BasisDegree = Whole<0, { MAX_DEGREE as u32 }>;

/// One whole number for u and v, or `[u, v]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PerDirection(pub(super) [u32; 2]);

/// One [`Degree`] for u and v, or `[u, v]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Degrees(pub(super) [u32; 2]);

/// Values that come in lists of a given length.
pub(super) trait Listed {
    /// The name of several such values.
    const PLURAL: &'static str;
}

impl Listed for Number {
    const PLURAL: &'static str = "numbers";
}

impl Listed for Count {
    /// Sizes are the only counts that are lists.
    const PLURAL: &'static str = "whole numbers, [width, height]";
}

impl Listed for Color {
    const PLURAL: &'static str = "colors";
}

impl Listed for Exactly<Number, 4> {
    const PLURAL: &'static str = "rows of 4 numbers";
}

impl Listed for Exactly<Number, 2> {
    /// Domains are the only lists of pairs.
    const PLURAL: &'static str = "pairs of numbers, [[u0, u1], [v0, v1]]";
}

/// A list of exactly `N` values. (A Rust array is read from longer lists, too, and the rest is
/// dropped.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Exactly<T, const N: usize>(pub(super) [T; N]);

impl<'de, T: Listed + Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visit<T, const N: usize>(PhantomData<T>);

        impl<'de, T: Listed + Deserialize<'de>, const N: usize> Visitor<'de> for Visit<T, N> {
            type Value = Exactly<T, N>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a list of {N} {}", T::PLURAL)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
                let mut read = Vec::with_capacity(N);
                while let Some(value) = list.next_element()? {
                    read.push(value);
                }
                <[T; N]>::try_from(read).map(Exactly).map_err(|read| {
                    let (found, plural) = (read.len(), T::PLURAL);
                    let message = format!("found a list of {found}, needed a list of {N} {plural}");
                    A::Error::custom(message)
                })
            }
        }
        deserializer.deserialize_any(Visit(PhantomData))
    }
}

impl<'de, const LEAST: u32, const MOST: u32> Deserialize<'de> for Whole<LEAST, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visit<const LEAST: u32, const MOST: u32>;

        impl<const LEAST: u32, const MOST: u32> Visitor<'_> for Visit<LEAST, MOST> {
            type Value = Whole<LEAST, MOST>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a whole number from {LEAST} to {MOST}")
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
                let usable = u32::try_from(number).map(Whole);
                usable.map_err(|_| E::invalid_value(Unexpected::Signed(number), &self))
            }

            /// 3.0 is a whole number, too.
            fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
                let usable = whole(number).map(Whole);
                usable.ok_or_else(|| E::invalid_type(Unexpected::Float(number), &self))
            }
        }
        deserializer.deserialize_u32(Visit)
    }
}

/// Returns a number that is whole, from 0 on.
fn whole(x: f64) -> Option<u32> {
    let usable = x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&x);
    usable.then_some(x as u32)
}

/// The ways to write a value: a finite number, text, or a list of numbers; a list with lists among
/// its entries is no value, but has messages of its own.
#[derive(Debug)]
pub(super) enum Loose {
    Number(f64),
    Text(String),
    List(Vec<f64>),
    Lists,
}

/// An entry of a list: a number, or a list.
enum Entry {
    Number(f64),
    List,
}

/// Longer lists are cut to this length: no value has this many numbers.
const LONGEST: usize = 8;

/// Reads a value written in any way of [`Loose`]. The value is made within the visitor, so
/// that the parser adds the place of this very value to an error.
pub(super) fn loosely<'de, T, D>(deserializer: D) -> Result<T, D::Error>
where
    T: TryFrom<Loose, Error = String>,
    D: Deserializer<'de>,
{
    struct Visit<T>(PhantomData<T>);

    impl<'de, T: TryFrom<Loose, Error = String>> Visitor<'de> for Visit<T> {
        type Value = T;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a number, or a list of numbers")
        }

        fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
            self.visit_f64(number as f64)
        }

        fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
            if number.is_finite() {
                T::try_from(Loose::Number(number)).map_err(E::custom)
            } else {
                Err(E::custom(format!("found {}, needed a finite number", Shown(number))))
            }
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
            T::try_from(Loose::Text(text.to_owned())).map_err(E::custom)
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<T, A::Error> {
            let mut read = Vec::new();
            let mut nested = false;
            while let Some(entry) = list.next_element()? {
                match entry {
                    Entry::Number(number) if read.len() < LONGEST => read.push(number),
                    Entry::Number(_) => {}
                    Entry::List => nested = true,
                }
            }
            let value = if nested { Loose::Lists } else { Loose::List(read) };
            T::try_from(value).map_err(A::Error::custom)
        }
    }
    deserializer.deserialize_any(Visit(PhantomData))
}

macro_rules! read_loosely {
    ($($value:ty),*) => {$(
        impl<'de> Deserialize<'de> for $value {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                loosely(deserializer)
            }
        }
    )*};
}

read_loosely!(Number, Vector, Point, NetPoint, TrianglePoint, Pair, Factors, Axis, Color, Emission);
read_loosely!(Entry, PerDirection, Degrees, Intensity);

impl Loose {
    /// The message that this was found instead of what is needed.
    pub(super) fn but_needed(&self, needed: &str) -> String {
        match self {
            Self::Number(number) => format!("found {}, needed {needed}", Shown(*number)),
            Self::Text(text) => format!("found \"{}\", needed {needed}", text.escape_debug()),
            Self::List(list) if list.len() >= LONGEST => {
                format!("found a list of {LONGEST} numbers or more, needed {needed}")
            }
            Self::List(list) => {
                format!("found a list of {}, needed {needed}", Counted(list.len(), "number"))
            }
            Self::Lists => format!("found a list of lists, needed {needed}"),
        }
    }

    /// Returns a point in space, or in the plane `z = 0`. Four numbers are taken for homogeneous
    /// coordinates.
    fn point(&self) -> Result<DVec3, String> {
        let Self::List(list) = self else { return Err(self.but_needed("[x, y, z], or [x, y]")) };
        match *list.as_slice() {
            [x, y] => Ok(DVec3::new(x, y, 0.0)),
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            [_, _, _, _] => Err(self.but_needed(
                "[x, y, z], or [x, y]: a weight stands in weights = …, and does not multiply x, y, z",
            )),
            _ => Err(self.but_needed("[x, y, z], or [x, y]")),
        }
    }

    /// Returns whole numbers from 0 on for u and v.
    fn per_direction(&self) -> Option<[u32; 2]> {
        let [u, v] = match self {
            Self::Number(both) => [*both; 2],
            Self::List(list) => <[f64; 2]>::try_from(list.as_slice()).ok()?,
            Self::Text(_) | Self::Lists => return None,
        };
        Some([whole(u)?, whole(v)?])
    }

    /// Returns linear light, no share of it below zero or above `most`; messages name what it is by
    /// `needed`.
    fn light(&self, needed: &str, most: f64) -> Result<Rgb, String> {
        let light = match self {
            Self::Number(grey) => Some([*grey; 3]),
            Self::Text(hex) => from_hex(hex),
            Self::List(_) | Self::Lists => self.vector().map(|rgb| rgb.to_array()),
        };
        let light = light.ok_or_else(|| self.but_needed("a number, [r, g, b] or \"#rrggbb\""))?;
        match light.into_iter().find(|share| !(0.0..=most).contains(share)) {
            None => Ok(light),
            Some(share) if share < 0.0 => Err(format!("found {}, needed {needed}", Shown(share))),
            Some(share) => Err(format!(
                "found {}, needed at most {}: pictures hold no brighter light",
                Shown(share),
                Shown(most)
            )),
        }
    }

    fn vector(&self) -> Option<DVec3> {
        match self {
            Self::List(list) => <[f64; 3]>::try_from(list.as_slice()).ok().map(DVec3::from_array),
            _ => None,
        }
    }
}

impl TryFrom<Loose> for Number {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        match value {
            Loose::Number(number) => Ok(Self(number)),
            _ => Err(value.but_needed("a number")),
        }
    }
}

impl TryFrom<Loose> for Vector {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        value.vector().map(Self).ok_or_else(|| value.but_needed("three numbers, [x, y, z]"))
    }
}

impl TryFrom<Loose> for Entry {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        match value {
            Loose::Number(number) => Ok(Self::Number(number)),
            Loose::List(_) | Loose::Lists => Ok(Self::List),
            Loose::Text(_) => Err(value.but_needed("a number")),
        }
    }
}

impl TryFrom<Loose> for Point {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        value.point().map(Self)
    }
}

impl TryFrom<Loose> for NetPoint {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        match value {
            Loose::Number(_) => {
                Err(value.but_needed("a row of points: a net is [[[x, y, z], …], …]"))
            }
            _ => value.point().map(Self),
        }
    }
}

impl TryFrom<Loose> for TrianglePoint {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        match value {
            Loose::Lists => {
                Err("found a row in brackets, needed one list of all points: those from \
                                 the corner w = 1 to v = 1, then the row beside them, up to u = 1"
                    .to_owned())
            }
            _ => value.point().map(Self),
        }
    }
}

impl TryFrom<Loose> for Pair {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        let pair = match &value {
            Loose::List(list) => <[f64; 2]>::try_from(list.as_slice()).ok(),
            _ => None,
        };
        let pair = pair.map(DVec2::from_array).map(Self);
        pair.ok_or_else(|| value.but_needed("two numbers, [u, v]"))
    }
}

impl TryFrom<Loose> for Factors {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        match value {
            Loose::Number(number) => Ok(Self(DVec3::splat(number))),
            _ => value.vector().map(Self).ok_or_else(|| value.but_needed("a number or [x, y, z]")),
        }
    }
}

impl TryFrom<Loose> for Axis {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        let axis = match &value {
            Loose::Text(name) if name == "x" => Some(DVec3::X),
            Loose::Text(name) if name == "y" => Some(DVec3::Y),
            Loose::Text(name) if name == "z" => Some(DVec3::Z),
            other => other.vector(),
        };
        axis.map(Self).ok_or_else(|| value.but_needed("\"x\", \"y\", \"z\" or [x, y, z]"))
    }
}

impl TryFrom<Loose> for Color {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        value.light("a color, made of numbers from 0 on", MAX_LIGHT).map(Self)
    }
}

impl TryFrom<Loose> for Emission {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        value.light("an amount of light from 0 on", MAX_LIGHT).map(Self)
    }
}

impl TryFrom<Loose> for Intensity {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        value.light("an amount of light from 0 on", MAX_INTENSITY).map(Self)
    }
}

/// `#rrggbb`, sRGB as screens and web pages have it, as linear light.
fn from_hex(hex: &str) -> Option<Rgb> {
    let digits = hex.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    let digits = digits.bytes().all(|byte| byte.is_ascii_hexdigit()).then_some(digits)?;
    let bits = u32::from_str_radix(digits, 16).ok()?;
    Some([bits >> 16, bits >> 8, bits].map(|channel| linear(channel & 0xff)))
}

/// IEC 61966-2-1: the light that a channel of sRGB, 0 to 255, stands for.
fn linear(channel: u32) -> f64 {
    let c = f64::from(channel) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

impl TryFrom<Loose> for PerDirection {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        let needed = "a whole number from 0 on, or two as [u, v]";
        value.per_direction().map(Self).ok_or_else(|| value.but_needed(needed))
    }
}

impl TryFrom<Loose> for Degrees {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        let needed = format!("a whole number from 1 to {MAX_DEGREE}, or two as [u, v]");
        value.per_direction().map(Self).ok_or_else(|| value.but_needed(&needed))
    }
}

/// The measures that are written: their names in errors, and their offsets.
pub(super) type Measures = Vec<(&'static str, usize)>;
