//! Pictures of errors: a colour for each order of magnitude.

use std::path::Path;

use nurbray::io::{StagedFile, WriteError, stage_png_bytes};

/// Red, green, blue.
pub(super) type Color = [u8; 3];

/// From small to large errors, at equal steps: colours of the map "inferno" of matplotlib
/// (Smith and van der Walt 2015), which grow lighter evenly.
const STOPS: [Color; 6] = [
    [0x00, 0x00, 0x04],
    [0x42, 0x0a, 0x68],
    [0x93, 0x26, 0x67],
    [0xdd, 0x51, 0x3a],
    [0xfc, 0xa5, 0x0a],
    [0xfc, 0xff, 0xa4],
];

/// Neither side sees anything.
pub(super) const NOTHING: Color = [0xe6, 0xe6, 0xe6];
/// The rival lacks what is there: sky blue of Okabe and Ito (2008).
pub(super) const LOST: Color = [86, 180, 233];
/// The rival shows what is not there: their bluish green.
pub(super) const INVENTED: Color = [0, 158, 115];

/// We could not tell what is there: their reddish purple.
pub(super) const DOUBTFUL: Color = [204, 121, 167];

/// The labels of these colours in a legend.
pub(super) const WORDS: [(Color, &str); 4] =
    [(LOST, "lost"), (INVENTED, "invented"), (NOTHING, "nothing"), (DOUBTFUL, "doubtful")];

/// Which errors the colours span, on a logarithmic scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// What the scale counts, with its unit.
    pub(super) quantity: &'static str,
    /// The power of ten of the darkest colour.
    pub(super) low: i32,
    /// The power of ten of the lightest.
    pub(super) high: i32,
}

impl Scale {
    /// The colour of an error; grey for NaN.
    pub(super) fn color(self, error: f64) -> Color {
        if error.is_nan() {
            return NOTHING;
        }
        let span = f64::from(self.high - self.low);
        let share = ((error.log10() - f64::from(self.low)) / span).clamp(0.0, 1.0);
        let place = share * (STOPS.len() - 1) as f64;
        let below = (place.floor() as usize).min(STOPS.len() - 2);
        let part = place - below as f64;
        let mix = |k: usize| {
            let [from, to] = [below, below + 1].map(|stop| f64::from(STOPS[stop][k]));
            (from + part * (to - from)).round() as u8
        };
        [0, 1, 2].map(mix)
    }
}

/// Writes a picture, its pixels row by row from the top, but does not put it in its place yet.
///
/// # Errors
/// When the file cannot be written.
pub(super) fn stage(
    path: &Path,
    size: [u32; 2],
    pixels: &[Color],
) -> Result<StagedFile, WriteError> {
    stage_png_bytes(path, size, pixels.as_flattened())
}

/// What the colours of some scales mean, as a drawing.
pub(super) fn legend(scales: &[Scale], words: &[(Color, &str)]) -> String {
    const ROW: i32 = 52;
    const COLUMN: i32 = 150;
    let height = ROW * scales.len() as i32 + 36;
    let beside = scales.iter().map(|scale| 340 + text_width(scale.quantity));
    let below = (0..).zip(words).map(|(place, (_, word))| 42 + COLUMN * place + text_width(word));
    let width = beside.chain(below).fold(340, i32::max) + 20;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<defs><linearGradient id=\"heat\">\n"
    );
    for (index, stop) in STOPS.iter().enumerate() {
        let offset = index as f64 / (STOPS.len() - 1) as f64;
        svg += &format!("<stop offset=\"{offset}\" stop-color=\"{}\"/>\n", hex(*stop));
    }
    svg += "</linearGradient></defs>\n";
    for (row, scale) in (0..).zip(scales) {
        let y = ROW * row + 8;
        svg += &format!(
            "<rect x=\"20\" y=\"{y}\" width=\"300\" height=\"16\" fill=\"url(#heat)\"/>\n\
             <text x=\"340\" y=\"{}\">{}</text>\n",
            y + 13,
            scale.quantity
        );
        for power in scale.low..=scale.high {
            let x = 20 + 300 * (power - scale.low) / (scale.high - scale.low);
            svg += &format!(
                "<text x=\"{x}\" y=\"{}\" text-anchor=\"middle\" font-size=\"11\">{}</text>\n",
                y + 31,
                power_of_ten(power)
            );
        }
    }
    let y = ROW * scales.len() as i32 + 8;
    for (place, (color, word)) in (0..).zip(words) {
        let x = 20 + COLUMN * place;
        svg += &format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"16\" height=\"16\" fill=\"{}\"/>\n\
             <text x=\"{}\" y=\"{}\">{word}</text>\n",
            hex(*color),
            x + 22,
            y + 13
        );
    }
    svg + "</svg>\n"
}

/// The width of a text 13 pixels high, with a little to spare: in DejaVu Sans, the widest of the
/// usual fonts, a letter takes about 0.6 of its height.
fn text_width(text: &str) -> i32 {
    8 * text.chars().count() as i32
}

fn hex([red, green, blue]: Color) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn power_of_ten(power: i32) -> String {
    match power {
        -2..=3 => format!("{}", 10_f64.powi(power)),
        _ => format!("1e{power}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALE: Scale = Scale { quantity: "degrees", low: -4, high: 1 };

    #[test]
    fn colours_span_the_scale_and_end_there() {
        assert_eq!(SCALE.color(1e-4), STOPS[0]);
        assert_eq!(SCALE.color(0.0), STOPS[0]);
        assert_eq!(SCALE.color(1e-2), STOPS[2]);
        assert_eq!([SCALE.color(10.0), SCALE.color(f64::INFINITY)], [STOPS[5]; 2]);
        assert_eq!(SCALE.color(10_f64.powf(-3.5)), [0x21, 0x05, 0x36]);
        assert_eq!(SCALE.color(f64::NAN), NOTHING);
    }

    #[test]
    fn the_legend_names_every_power_and_colour() {
        let svg = legend(&[SCALE], &[(LOST, "lost")]);
        for text in ["1e-4", "0.01", ">10<", "degrees", "lost", "#56b4e9"] {
            assert!(svg.contains(text), "{text}");
        }
        assert_eq!(svg.matches("<text").count(), 1 + 6 + 1);
        assert!(svg.contains("width=\"416\""), "{svg}"); // 340 + 7 letters + 20
        let long = Scale { quantity: "brightness, as the cosine between ray and normal", ..SCALE };
        assert!(legend(&[long], &WORDS).contains("width=\"744\""));
        assert!(legend(&[], &WORDS).contains("width=\"576\""));
    }
}
