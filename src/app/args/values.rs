//! Parsers of values made of several numbers, and of single numbers within a range.

use glam::DVec3;
use nurbray::render::PixelRect;
use nurbray::scene::{Projection, RenderDefaults};

use super::count::whole;

/// Width and height of a picture in pixels, both at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    /// Pixels from left to right.
    pub(crate) width: u32,
    /// Pixels from top to bottom.
    pub(crate) height: u32,
}

/// The samples `first ≤ i < end` of each pixel: at least one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SampleRange {
    /// The first to take.
    pub(crate) first: u32,
    /// The first not to take.
    pub(crate) end: u32,
}

/// Parses `1024x768`.
pub(crate) fn size(text: &str) -> Result<Size, String> {
    const NEED: &str = "a size is WIDTHxHEIGHT in pixels, both at least 1, such as 1024x768";
    let (width, height) = text.split_once(['x', 'X']).ok_or(NEED)?;
    let side = |text| whole(text).filter(|&side| side > 0);
    let (Some(width), Some(height)) = (side(width), side(height)) else { return Err(NEED.into()) };
    let most = RenderDefaults::MAX_SIDE;
    let too_large = |_| format!("a side of a picture has at most {most} pixels");
    let [width, height] = [width, height].map(|side| u32::try_from(side).map_err(too_large));
    Ok(Size { width: width?, height: height? })
}

/// Parses `X0,Y0,X1,Y1`.
pub(crate) fn crop(text: &str) -> Result<PixelRect, String> {
    const NEED: &str = "a crop is X0,Y0,X1,Y1 in pixels from the top left, such as 0,0,512,384";
    let pixel = |text: &str| u32::try_from(whole(text)?).ok();
    let [x0, y0, x1, y1] = list(text, pixel).ok_or(NEED)?;
    PixelRect::new([x0, y0], [x1, y1])
        .map_err(|_| "there are no pixels in it: a crop needs X0 < X1 and Y0 < Y1".into())
}

/// Parses `A..B`.
pub(crate) fn samples(text: &str) -> Result<SampleRange, String> {
    const NEED: &str = "a range of samples is A..B, B not included, such as 0..16";
    let (first, end) = text.split_once("..").ok_or(NEED)?;
    let sample = |text| u32::try_from(whole(text)?).ok();
    match (sample(first), sample(end)) {
        (Some(first), Some(end)) if first < end => Ok(SampleRange { first, end }),
        (Some(_), Some(_)) => Err("there are no samples in it: A must be smaller than B".into()),
        _ => Err(NEED.into()),
    }
}

/// Parses `X,Y,Z`.
pub(crate) fn point(text: &str) -> Result<DVec3, String> {
    const NEED: &str = "three finite numbers X,Y,Z are needed, such as 1,-2.5,4";
    let point = DVec3::from_array(list(text, |x| x.parse().ok()).ok_or(NEED)?);
    if point.is_finite() { Ok(point) } else { Err(NEED.into()) }
}

/// Parses a vertical field of view in degrees.
pub(crate) fn field_of_view(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if (Projection::MIN_FOV..180.0).contains(&degrees) => Ok(degrees),
        _ => Err(format!(
            "an angle from {:e} degrees up to, not including, 180 is needed, such as 35",
            Projection::MIN_FOV
        )),
    }
}

/// Parses a finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("a finite number is needed, such as -1.5".into()),
    }
}

/// Parses a tolerance, less than 1: a larger one would allow any triangle in the box.
pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(fraction) if fraction > 0.0 && fraction < 1.0 => Ok(fraction),
        _ => Err("a fraction between 0 and 1 is needed, such as 1e-3".into()),
    }
}

/// Parses a time in seconds, at most a day, which is too long for anyone to wait for.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    const DAY: f64 = 86_400.0;
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= DAY => Ok(seconds),
        _ => Err(format!("a positive number of seconds up to {DAY} is needed, such as 0.5")),
    }
}

/// The items in order, each once.
pub(super) fn once_each<T: Copy + PartialEq>(list: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    for &item in list {
        if !once.contains(&item) {
            once.push(item);
        }
    }
    once
}

/// Exactly `N` values between commas.
fn list<T, const N: usize>(text: &str, value: impl Fn(&str) -> Option<T>) -> Option<[T; N]> {
    let values: Vec<T> = text.split(',').map(|part| value(part.trim())).collect::<Option<_>>()?;
    values.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x480"), Ok(Size { width: 640, height: 480 }));
        assert_eq!(size("1e3x1_000"), Ok(Size { width: 1000, height: 1000 }));
        for wrong in [
            "640",
            "640x",
            "x480",
            "0x0",
            "0x480",
            "640x0",
            "640x-1",
            "-640x1",
            "640x480x3",
            "1.5x2",
        ] {
            let needed = "a size is WIDTHxHEIGHT in pixels, both at least 1, such as 1024x768";
            assert_eq!(size(wrong), Err(needed.to_owned()), "{wrong}");
        }
        let large = "a side of a picture has at most 65536 pixels";
        assert_eq!(size("99999999999x1"), Err(large.to_owned()));
    }

    #[test]
    fn crops() {
        let rect = crop("0, 1,2,1e3").unwrap();
        assert_eq!((rect.min(), rect.max()), ([0, 1], [2, 1000]));
        for wrong in [
            "",
            "0,1,2",
            "0,1,2,3,4",
            "2,1,2,3",
            "0,3,2,3",
            "-1,0,2,3",
            "a,0,2,3",
            "0,0,99999999999,2",
        ] {
            assert!(crop(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn ranges_of_samples() {
        assert_eq!(samples("4..8"), Ok(SampleRange { first: 4, end: 8 }));
        for wrong in ["4", "8..4", "4..4", "..4", "4..", "-1..4", "4..=8"] {
            assert!(samples(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn points() {
        assert_eq!(point("1,-2.5, 4e-3"), Ok(DVec3::new(1.0, -2.5, 4e-3)));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,nan", "1,inf,3", "1;2;3"] {
            assert!(point(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn angles_and_stops() {
        assert_eq!(field_of_view("35"), Ok(35.0));
        for wrong in ["0", "1e-9", "180", "-5", "nan", "wide"] {
            assert!(field_of_view(wrong).is_err(), "{wrong}");
        }
        assert_eq!(finite("-1.5"), Ok(-1.5));
        assert!(finite("inf").is_err() && finite("nan").is_err());
    }

    #[test]
    fn tolerances_and_times() {
        assert_eq!(tolerance("1e-3"), Ok(1e-3));
        for wrong in ["", "0", "1", "-1e-3", "nan", "fine"] {
            assert!(tolerance(wrong).is_err(), "{wrong}");
        }
        assert_eq!(seconds("0.5"), Ok(0.5));
        let needed = "a positive number of seconds up to 86400 is needed, such as 0.5";
        for wrong in ["", "0", "-1", "nan", "inf", "1e9"] {
            assert_eq!(seconds(wrong), Err(needed.to_owned()), "{wrong}");
        }
    }

    #[test]
    fn what_is_named_twice_is_measured_once() {
        assert_eq!(once_each(&[2, 1, 2]), [2, 1]);
    }
}
