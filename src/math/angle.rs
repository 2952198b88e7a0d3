//! Angles in degrees, exact where degrees are: at quarter turns.

/// Sine and cosine of an angle in degrees; exact at multiples of 90°, where radians are not.
pub(crate) fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turns = degrees % 360.0; // exact
    let quarter = (turns / 90.0).round();
    let (sin, cos) = (turns - 90.0 * quarter).to_radians().sin_cos();
    match quarter.rem_euclid(4.0) {
        1.0 => (cos, -sin),
        2.0 => (-sin, -cos),
        3.0 => (-cos, sin),
        _ => (sin, cos),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_the_rest_is_as_in_radians() {
        let exact = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for turn in -9_i32..=9 {
            let expected = exact[turn.rem_euclid(4) as usize];
            assert_eq!(sin_cos_degrees(90.0 * f64::from(turn)), expected, "{turn} quarter turns");
        }
        for k in -72..=72 {
            let degrees = 5.0 * f64::from(k) + 0.125;
            let (sin, cos) = sin_cos_degrees(degrees);
            let (s, c) = degrees.to_radians().sin_cos();
            assert!((sin - s).abs() < 1e-15 && (cos - c).abs() < 1e-15, "{degrees}");
        }
    }
}
