//! Where a function rises so far above the rest of it that no plot shows both.

/// A function is sampled this often a piece, as for the extent of a plot; a sample is a "look".
const LOOKS: usize = 64;

/// A peak more than this many times as high as everything that is not beside it would leave
/// nothing of the rest to be seen.
const FAR: f64 = 4.0;

/// The largest share of a peak that may be missed between two looks.
const MISSED: f64 = 0.01;

/// A look no more than this share above its neighbours is not a peak: rounding alone makes such.
const RIPPLE: f64 = 1e-4;

/// Peaks of neighbouring looks are one if they are no farther apart than this share of their piece.
const ONE: f64 = 1e-6;

/// How often the search for a highest place removes a third of its interval: 1e-7 of it is left.
const THIRDS: usize = 40;

/// The part to be shown of a function that is not negative.
pub(super) struct Shown {
    /// The pieces, parted at peaks that might be missed.
    pub(super) pieces: Vec<[f64; 2]>,
    /// Where the function is cut off, if it is.
    pub(super) cut: Option<Cut>,
}

/// How a function is cut off.
pub(super) struct Cut {
    /// The highest value shown.
    pub(super) limit: f64,
    /// The parameters of the peaks above.
    pub(super) peaks: Vec<f64>,
}

/// A highest place of a function, and the look it was found at.
struct Peak {
    piece: usize,
    look: usize,
    t: f64,
    height: f64,
}

/// Finds the peaks of a function on its pieces, and whether to cut it off. It may be NaN where it
/// has no bound.
pub(super) fn shown(value: &dyn Fn(f64) -> f64, pieces: &[[f64; 2]]) -> Shown {
    // NaN counts as higher than everything else, so that the search follows a rise towards it.
    let high = |t: f64| Some(value(t)).filter(|v| !v.is_nan()).unwrap_or(f64::INFINITY);
    let looks: Vec<Vec<f64>> = pieces
        .iter()
        .map(|&piece| (0..=LOOKS).map(|look| high(parameter(piece, look))).collect())
        .collect();
    let peaks = found(&high, pieces, &looks);
    let spikes: Vec<&Peak> = peaks.iter().filter(|peak| is_spike(&looks, peak)).collect();
    let rest = rest(&looks, &spikes);
    let far = |peak: &&Peak| rest > 0.0 && peak.height > FAR * rest && is_spike(&looks, peak);
    let cut: Vec<f64> = peaks.iter().filter(far).map(|peak| peak.t).collect();
    let whole = peaks.iter().filter(|peak| !far(peak)).map(|peak| peak.height);
    let limit = rounded_up(whole.fold(rest, f64::max));

    let missed = |peak: &&Peak| {
        far(peak) || peak.height > (1.0 + MISSED) * finite(looks[peak.piece][peak.look])
    };
    let parted = pieces.iter().enumerate().flat_map(|(piece, &[start, end])| {
        let inside = peaks.iter().filter(missed).filter(|peak| peak.piece == piece);
        let inside = inside.map(|peak| peak.t).filter(|&t| start < t && t < end.next_down());
        let mut places: Vec<f64> = [start, end].into_iter().chain(inside).collect();
        places.sort_by(f64::total_cmp);
        places.windows(2).map(|ends| [ends[0], ends[1]]).collect::<Vec<_>>()
    });
    let cut = (!cut.is_empty()).then_some(Cut { limit, peaks: cut });
    Shown { pieces: parted.collect(), cut }
}

/// The peaks among the looks, each with its highest place.
fn found(high: &dyn Fn(f64) -> f64, pieces: &[[f64; 2]], looks: &[Vec<f64>]) -> Vec<Peak> {
    let all = (0..pieces.len())
        .flat_map(|piece| (0..=LOOKS).map(move |look| (piece, look)))
        .filter(|&(piece, look)| is_peak(&looks[piece], look))
        .map(|(piece, look)| {
            let ends = [look.saturating_sub(1), (look + 1).min(LOOKS)];
            let [t, height] = highest(high, ends.map(|look| parameter(pieces[piece], look)));
            Peak { piece, look, t, height: height.max(finite(looks[piece][look])) }
        });
    let mut peaks: Vec<Peak> = all.collect();
    // A peak in the middle between two looks is found from both.
    peaks.dedup_by(|next, peak| {
        let [start, end] = pieces[peak.piece];
        next.piece == peak.piece && (next.t - peak.t).abs() <= ONE * (end - start)
    });
    peaks
}

/// Whether a peak is far above the looks two places beside it.
fn is_spike(looks: &[Vec<f64>], peak: &Peak) -> bool {
    let beside = [peak.look.checked_sub(2), Some(peak.look + 2)].into_iter().flatten();
    let beside = beside.filter_map(|look| looks[peak.piece].get(look));
    peak.height > FAR * beside.map(|&value| finite(value)).fold(0.0, f64::max)
}

/// The highest look that is not at a spike or next to one: it must be seen.
fn rest(looks: &[Vec<f64>], spikes: &[&Peak]) -> f64 {
    let rest = looks.iter().enumerate().flat_map(|(piece, values)| {
        values.iter().enumerate().filter_map(move |(look, &value)| {
            let beside = |peak: &&Peak| peak.piece == piece && peak.look.abs_diff(look) < 2;
            (!spikes.iter().any(beside)).then_some(finite(value))
        })
    });
    rest.fold(0.0, f64::max)
}

/// The parameter of a look at a piece; the last look is just before the piece's end, where the
/// next piece begins.
fn parameter([start, end]: [f64; 2], look: usize) -> f64 {
    (start + look as f64 / LOOKS as f64 * (end - start)).min(end.next_down())
}

/// Whether a look is higher than its neighbours, or as high as one of them.
fn is_peak(looks: &[f64], look: usize) -> bool {
    let beside = [look.checked_sub(1), Some(look + 1)].into_iter().flatten();
    let beside: Vec<f64> = beside.filter_map(|look| looks.get(look).copied()).collect();
    let lowest = beside.iter().copied().fold(f64::INFINITY, f64::min);
    beside.iter().all(|&other| looks[look] >= other) && looks[look] > (1.0 + RIPPLE) * lowest
}

/// The highest place of a function between two parameters, and the largest finite value found.
fn highest(high: &dyn Fn(f64) -> f64, [mut start, mut end]: [f64; 2]) -> [f64; 2] {
    let mut best = 0.0_f64;
    for _ in 0..THIRDS {
        let third = (end - start) / 3.0;
        let places = [start + third, end - third];
        let heights = places.map(high);
        best = heights.into_iter().map(finite).fold(best, f64::max);
        if heights[0] < heights[1] {
            start = places[0];
        } else {
            end = places[1];
        }
    }
    [0.5 * (start + end), best]
}

/// The value, or 0 if it is not finite.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// The value rounded up to two digits.
fn rounded_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let last = 10_f64.powf(value.log10().floor() - 1.0);
    (value / last).ceil() * last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_bound_is_cut_off_beside_it() {
        // A pole between two looks, on one, and at an end: two looks off it the value is 64 / 2,
        // one look off 64.
        for pole in [0.3001, 0.5, 0.5 + 1.0 / 128.0, 0.0] {
            let value = |t: f64| if t == pole { f64::NAN } else { 1.0 / (t - pole).abs() };
            let shown = shown(&value, &[[0.0, 1.0]]);
            let cut = shown.cut.unwrap();
            assert!((cut.peaks[0] - pole).abs() < 1e-7 && cut.peaks.len() == 1, "{:?}", cut.peaks);
            assert!((32.0..=64.0).contains(&cut.limit), "{pole}: {}", cut.limit);
            assert_eq!(shown.pieces.len(), 2, "parted at the pole, or next to it");
        }
        // As is the curvature of (t², t³), √(4 + 9t²)⁻³ · 6 / |t|.
        let cusp = |t: f64| 6.0 / t.abs() / (4.0 + 9.0 * t * t).powf(1.5);
        let cut = shown(&cusp, &[[-1.0, 0.0], [0.0, 1.0]]).cut.unwrap();
        assert!(cut.peaks.iter().all(|t| t.abs() < 1e-7), "{:?}", cut.peaks);
    }

    #[test]
    fn finite_peaks_are_shown_whole_unless_nothing_else_would_be_seen() {
        // 1 / (w² + x²) is 1 / w² high, and w wide.
        let lorentzian =
            |width: f64| move |t: f64| 1.0 / (width * width + (t - 0.3001) * (t - 0.3001));
        let wide = shown(&lorentzian(0.02), &[[0.0, 1.0]]);
        assert!(wide.cut.is_none());
        let narrow = shown(&lorentzian(1e-3), &[[0.0, 1.0]]);
        let cut = narrow.cut.unwrap();
        assert!((cut.peaks[0] - 0.3001).abs() < 1e-6 && cut.limit < 1e4, "{}", cut.limit);
        // Between two looks a peak is not missed: its top is where two pieces meet.
        let tent = |t: f64| (1.0 - 40.0 * (t - 0.3047).abs()).max(0.4);
        let parted = shown(&tent, &[[0.0, 1.0]]);
        assert!(parted.cut.is_none() && parted.pieces.len() == 2);
        assert!((parted.pieces[0][1] - 0.3047).abs() < 1e-6, "{:?}", parted.pieces);
        // Constants, with rounding and without, have none.
        for noise in [0.0, 1e-15] {
            let flat = |t: f64| 2.0 + noise * (1e6 * t).sin();
            assert_eq!(shown(&flat, &[[0.0, 1.0]]).pieces, [[0.0, 1.0]]);
        }
        assert!(shown(&|_| 0.0, &[[0.0, 1.0]]).cut.is_none());
        assert!(shown(&|_| f64::NAN, &[[0.0, 1.0]]).cut.is_none());
    }

    #[test]
    fn limits_have_two_digits() {
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(close(rounded_up(22.6), 23.0) && close(rounded_up(0.001234), 0.0013));
        assert_eq!(rounded_up(0.0), 0.0);
    }
}
