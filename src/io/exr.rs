//! OpenEXR pictures: the film as it is, linear and with all data.

mod film_channels;
mod sorted_header;

use std::io::{self, Seek, Write};
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use exr::error::Error as ExrError;
use exr::meta::attribute::{Chromaticities, Matrix4x4};
use exr::prelude::{
    AttributeValue, Blocks, Compression, Encoding, Image, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, LineOrder, SmallVec, Text, Vec2, WritableImage,
};
use glam::{DVec2, DVec3};

use self::film_channels::FilmChannels;
use self::sorted_header::SortedHeader;
use super::{StagedFile, WriteError, stage};
use crate::render::Film;
use crate::scene::{Camera, Projection, Rgb};

/// How precisely colour is stored. Data channels are 32 bits always: 16 would lose
/// positions and mix up ids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExrPrecision {
    /// 32-bit floats.
    #[default]
    Float,
    /// 16-bit floats for colour, coverage and albedo; colour beyond 65,504, their largest
    /// value, is clipped to it.
    Half,
}

/// Entries of an EXR header that the film itself does not know.
#[derive(Clone, Debug)]
pub struct ExrNotes<'a> {
    /// The command that made the picture.
    pub command: &'a str,
    /// When it was made.
    pub time: SystemTime,
    /// How long rendering took; `None` to leave it out, so that the file is the same next time.
    pub duration: Option<Duration>,
    /// Where it was taken from.
    pub camera: &'a Camera,
    /// The background behind everything, noted so that it can be removed again: black (all zero)
    /// for pictures of integrators that show none, as all but `direct`.
    pub background: Rgb,
}

/// Writes all channels of a film as one layer of an OpenEXR file, ZIP-compressed.
///
/// Values are linear, primaries Rec. 709. The display window is the whole picture, the data window
/// the crop. The header holds `software` (with version), `capDate` (UTC), `worldToCamera` (row
/// vectors, `p_camera = p_world M`; x to the right, y up, z forward: left-handed; of 32 bits, so
/// that far from the origin only `nurbray:camera` is exact), `screenWindowWidth`, and as text
/// `nurbray:command`, `nurbray:version`, `nurbray:seed`, `nurbray:spp`, `nurbray:samples`,
/// `nurbray:integrator`, `nurbray:seconds`, `nurbray:camera`, `nurbray:background`,
/// `nurbray:rays`, `nurbray:hits`, `nurbray:doubtful`, all in the order of their names. The same
/// film with the same notes gives the same bytes.
///
/// # Errors
/// When the file cannot be written; an older one then stays as it was.
pub fn write_exr(
    path: &Path,
    film: &Film,
    precision: ExrPrecision,
    notes: &ExrNotes<'_>,
) -> Result<(), WriteError> {
    stage_exr(path, film, precision, notes)?.put_in_place()
}

/// Writes an EXR as [`write_exr`] does, but does not put the file in its place yet.
///
/// # Errors
/// When the file cannot be written.
pub fn stage_exr(
    path: &Path,
    film: &Film,
    precision: ExrPrecision,
    notes: &ExrNotes<'_>,
) -> Result<StagedFile, WriteError> {
    stage(path, |file| write_exr_to(file, film, precision, notes))
}

/// Writes the EXR that [`write_exr`] writes to memory or the like; for a file or a socket, give it
/// a buffer. The writer must be at its beginning, since an EXR counts its places from there.
///
/// ```
/// use std::io::Cursor;
/// use std::time::{Duration, SystemTime};
///
/// use glam::DVec3;
/// use nurbray::io::{ExrNotes, ExrPrecision, write_exr_to};
/// use nurbray::render::{Film, RenderSettings};
/// use nurbray::scene::{Camera, Projection, View};
///
/// let view = View { look_from: DVec3::X, look_at: DVec3::ZERO, up: DVec3::Z };
/// let notes = ExrNotes {
///     command: "",
///     time: SystemTime::now(),
///     duration: Some(Duration::ZERO),
///     camera: &Camera::new(view, Projection::Perspective { fov: 30.0 })?,
///     background: [0.0; 3],
/// };
/// let film = Film::new(&RenderSettings { size: [2, 2], ..Default::default() })?;
/// let mut bytes = Cursor::new(Vec::new());
/// write_exr_to(&mut bytes, &film, ExrPrecision::Float, &notes)?;
/// assert!(bytes.into_inner().starts_with(b"\x76\x2f\x31\x01"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the writer is not at its beginning, or fails; part of the picture may then be written.
pub fn write_exr_to(
    mut writer: impl Write + Seek,
    film: &Film,
    precision: ExrPrecision,
    notes: &ExrNotes<'_>,
) -> io::Result<()> {
    let at = writer.stream_position()?;
    if at != 0 {
        let message = format!("an EXR must begin where its writer does, not at byte {at}");
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    let image = image(film, precision, notes);
    image.write().to_buffered(SortedHeader::new(&mut writer)).map_err(|error| match error {
        ExrError::Io(error) => error,
        other => io::Error::other(other),
    })?;
    writer.flush()
}

fn image<'f>(
    film: &'f Film,
    precision: ExrPrecision,
    notes: &ExrNotes<'_>,
) -> Image<Layer<FilmChannels<'f>>> {
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let window = film.window();
    let size = Vec2(window.width() as usize, window.height() as usize);
    let channels = FilmChannels::new(film, precision);
    let layer = Layer::new(size, layer_attributes(film, notes), encoding, channels);

    let [width, height] = film.settings().size;
    let display_window = IntegerBounds::from_dimensions((width as usize, height as usize));
    let mut attributes = ImageAttributes::new(display_window);
    attributes.chromaticities = Some(REC_709);
    Image { attributes, layer_data: layer }
}

/// The primaries and white point of ITU-R BT.709, which sRGB shares.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

fn layer_attributes(film: &Film, notes: &ExrNotes<'_>) -> LayerAttributes {
    let (settings, counters) = (film.settings(), film.counters());
    let corner = film.window().min().map(|pixel| pixel as i32); // below 2^16
    let mut attributes = LayerAttributes::default().with_position(Vec2(corner[0], corner[1]));
    let version = env!("CARGO_PKG_VERSION");
    attributes.software_name = Some(text(&format!("nurbray {version}")));
    attributes.capture_date = Some(text(&date(notes.time)));
    attributes.utc_offset = Some(0.0);

    let [width, height] = settings.size;
    let aspect = f64::from(width) / f64::from(height);
    attributes.world_to_camera = Some(world_to_camera(notes.camera));
    attributes.screen_window_width = sides(notes.camera, aspect)[0].length() as f32;

    let samples = &settings.samples;
    let told = [
        ("command", notes.command.to_owned()),
        ("version", version.to_owned()),
        ("seed", settings.seed.to_string()),
        ("spp", samples.len().to_string()),
        ("samples", format!("{}..{}", samples.start, samples.end)),
        ("integrator", settings.integrator.to_string()),
        ("camera", camera_words(notes.camera)),
        ("background", notes.background.map(|x| x.to_string()).join(",")),
        ("rays", counters.rays.to_string()),
        ("hits", counters.hits.to_string()),
        ("doubtful", counters.doubtful.to_string()),
    ];
    let seconds = notes.duration.map(|took| ("seconds", format!("{:.3}", took.as_secs_f64())));
    for (name, value) in told.into_iter().chain(seconds) {
        let value = AttributeValue::Text(text(&value));
        attributes.other.insert(text(&format!("nurbray:{name}")), value);
    }
    attributes
}

/// Text as bytes of UTF-8, as other programs write and expect it.
fn text(words: &str) -> Text {
    Text::from_bytes_unchecked(SmallVec::from_slice(words.as_bytes()))
}

/// The camera in the words of the command line.
fn camera_words(camera: &Camera) -> String {
    let view = camera.view();
    let list = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    let view = format!(
        "look_from {} look_at {} up {}",
        list(view.look_from),
        list(view.look_at),
        list(view.up)
    );
    match camera.projection() {
        Projection::Perspective { fov } => format!("perspective fov {fov} {view}"),
        Projection::Orthographic { height } => format!("orthographic height {height} {view}"),
    }
}

/// The vectors from the left side of the picture to the right, and from its bottom to its top, at
/// distance 1 from the eye (perspective) or anywhere (orthographic).
fn sides(camera: &Camera, aspect: f64) -> [DVec3; 2] {
    let across = |from: DVec2, to: DVec2| {
        let (from, to) = (camera.ray(from, aspect), camera.ray(to, aspect));
        (to.origin() - from.origin()) + (to.direction() - from.direction())
    };
    let (left, right) = (DVec2::new(0.0, 0.5), DVec2::new(1.0, 0.5));
    let (bottom, top) = (DVec2::new(0.5, 1.0), DVec2::new(0.5, 0.0));
    [across(left, right), across(bottom, top)]
}

/// The matrix of the OpenEXR standard: row vectors, `p_camera = p_world M`, a left-handed
/// system with x to the right, y up and z forward.
fn world_to_camera(camera: &Camera) -> Matrix4x4 {
    let [right, up] = sides(camera, 1.0).map(DVec3::normalize_or_zero);
    let columns = [right, up, camera.forward()];
    let origin = camera.view().look_from;
    let mut matrix = [0.0; 16];
    for (column, axis) in columns.into_iter().enumerate() {
        for (row, value) in [axis.x, axis.y, axis.z, -axis.dot(origin)].into_iter().enumerate() {
            matrix[4 * row + column] = value as f32;
        }
    }
    matrix[15] = 1.0;
    matrix
}

/// A time as `YYYY:MM:DD hh:mm:ss`, in UTC. Times before 1970 count as the start of 1970.
fn date(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);

    // Years begin in March here, so that the leap day comes last, and a cycle of 400 years
    // has 146,097 days (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms").
    let days = days + 719_468; // 1 March of year 0 to 1 January 1970
    let (cycle, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, carry) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let year = 400 * cycle + year + carry;

    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}:{month:02}:{day:02} {hour:02}:{minute:02}:{second:02}")
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Cursor;

    use exr::prelude::{AnyChannels, FlatSamples, ReadChannels, ReadLayers, read};

    use super::*;
    use crate::render::{AovSet, Channel, PixelRect, RenderSettings};
    use crate::scene::View;

    fn camera() -> Camera {
        let view = View { look_from: DVec3::new(0.0, -4.0, 1.0), look_at: DVec3::Z, up: DVec3::Z };
        Camera::new(view, Projection::Perspective { fov: 90.0 }).unwrap()
    }

    fn notes<'a>(camera: &'a Camera, command: &'a str) -> ExrNotes<'a> {
        let time = UNIX_EPOCH + Duration::from_secs(1_700_000_000);
        ExrNotes {
            command,
            time,
            duration: Some(Duration::from_millis(1250)),
            camera,
            background: [0.0, 0.25, 1.0],
        }
    }

    fn film(crop: Option<PixelRect>) -> Film {
        let aovs = AovSet::all();
        let size = [37, 21]; // more than one block of 16 lines, and a rest
        Film::made_up(&RenderSettings {
            size,
            crop,
            aovs,
            samples: 2..5,
            seed: 9,
            ..Default::default()
        })
    }

    type Read = Image<Layer<AnyChannels<FlatSamples>>>;

    fn written(film: &Film, precision: ExrPrecision) -> Read {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let camera = camera();
        write_exr(&path, film, precision, &notes(&camera, "nurbray render löwe.toml")).unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        read_back(&fs::read(&path).unwrap())
    }

    fn read_back(bytes: &[u8]) -> Read {
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap()
    }

    fn samples_of<'a>(image: &'a Read, channel: &Channel) -> &'a FlatSamples {
        let list = &image.layer_data.channel_data.list;
        let found = list.iter().find(|c| c.name.to_string() == channel.name());
        &found.unwrap_or_else(|| panic!("no channel {}", channel.name())).sample_data
    }

    fn assert_same(film: &Film, image: &Read) {
        for channel in film.channels() {
            let FlatSamples::F32(read) = samples_of(image, &channel) else { panic!() };
            let bits = |plane: &[f32]| plane.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(read), bits(&film.plane(channel).unwrap()), "{channel:?}");
        }
    }

    #[test]
    fn every_channel_comes_back_bit_for_bit() {
        let film = film(None);
        let image = written(&film, ExrPrecision::Float);
        assert_eq!(image.layer_data.channel_data.list.len(), film.channels().count());
        assert_same(&film, &image);
        assert_eq!(image.layer_data.encoding.compression, Compression::ZIP16);
        assert_eq!(image.layer_data.attributes.layer_name, None);
    }

    #[test]
    fn half_precision_is_for_colour_only() {
        let film = film(None);
        let image = written(&film, ExrPrecision::Half);
        for channel in film.channels() {
            match samples_of(&image, &channel) {
                FlatSamples::F16(read) => {
                    assert!(channel.is_color());
                    for (read, held) in read.iter().zip(film.plane(channel).unwrap()) {
                        // 11 bits; the made-up green goes up to 1e8, beyond the largest half.
                        let error = (read.to_f32() - held.min(65_504.0)).abs();
                        assert!(error <= held * 2.0_f32.powi(-11) + 6e-8, "{channel:?}: {held}");
                    }
                }
                _ => assert!(!channel.is_color(), "{channel:?}"),
            }
        }
    }

    #[test]
    fn crops_keep_the_display_window() {
        let crop = PixelRect::new([5, 3], [20, 19]).unwrap();
        let image = written(&film(Some(crop)), ExrPrecision::Float);
        let bounds = image.layer_data.absolute_bounds();
        assert_eq!((bounds.position, bounds.size), (Vec2(5, 3), Vec2(15, 16)));
        assert_same(&film(Some(crop)), &image);
        let display = image.attributes.display_window;
        assert_eq!((display.position, display.size), (Vec2(0, 0), Vec2(37, 21)));
    }

    #[test]
    fn the_header_tells_how_the_picture_was_made() {
        let image = written(&film(None), ExrPrecision::Float);
        assert_eq!(image.attributes.chromaticities, Some(REC_709));
        let attributes = &image.layer_data.attributes;
        let told = |name: &str| match &attributes.other[&text(&format!("nurbray:{name}"))] {
            AttributeValue::Text(words) => String::from_utf8(words.as_slice().to_vec()).unwrap(),
            other => panic!("{other:?}"),
        };
        assert_eq!(told("command"), "nurbray render löwe.toml");
        assert_eq!(told("version"), env!("CARGO_PKG_VERSION"));
        assert_eq!([told("seed"), told("spp"), told("samples")], ["9", "3", "2..5"]);
        assert_eq!([told("integrator"), told("seconds")], ["direct", "1.250"]);
        assert_eq!(told("camera"), "perspective fov 90 look_from 0,-4,1 look_at 0,0,1 up 0,0,1");
        assert_eq!(told("background"), "0,0.25,1");
        assert_eq!(attributes.capture_date, Some(text("2023:11:14 22:13:20")));
        let software = attributes.software_name.as_ref().unwrap().to_string();
        assert!(software.starts_with("nurbray "));
    }

    #[test]
    fn the_same_film_and_notes_are_the_same_bytes() {
        let (camera, film) = (camera(), film(None));
        let bytes = |duration| {
            let mut memory = Cursor::new(Vec::new());
            let notes = ExrNotes { duration, ..notes(&camera, "") };
            write_exr_to(&mut memory, &film, ExrPrecision::Float, &notes).unwrap();
            memory.into_inner()
        };
        assert_eq!(bytes(None), bytes(None));
        let tells_seconds = |duration| {
            let attributes = read_back(&bytes(duration)).layer_data.attributes.other;
            attributes.contains_key(&text("nurbray:seconds"))
        };
        assert!(tells_seconds(Some(Duration::ZERO)) && !tells_seconds(None));
    }

    #[test]
    fn the_camera_matrix_takes_the_eye_to_the_origin() {
        let image = written(&film(None), ExrPrecision::Float);
        let attributes = &image.layer_data.attributes;
        let m = attributes.world_to_camera.unwrap();
        let camera_from_world = |p: [f32; 3]| -> [f32; 3] {
            std::array::from_fn(|j| p[0] * m[j] + p[1] * m[4 + j] + p[2] * m[8 + j] + m[12 + j])
        };
        assert_eq!(camera_from_world([0.0, -4.0, 1.0]), [0.0; 3]);
        // One to the right, two ahead, three up.
        assert_eq!(camera_from_world([1.0, -2.0, 4.0]), [1.0, 3.0, 2.0]);
        // A right angle from bottom to top: 2 high at distance 1, and wider.
        let width = attributes.screen_window_width;
        assert!((width - 2.0 * 37.0 / 21.0).abs() < 1e-6, "{width}");
    }

    #[test]
    fn a_file_that_cannot_be_written_is_an_error() {
        let camera = camera();
        let path = Path::new("/nowhere/at/all.exr");
        let error = write_exr(path, &film(None), ExrPrecision::Float, &notes(&camera, ""));
        assert_eq!(
            error.unwrap_err().to_string(),
            "cannot write \"/nowhere/at/all.exr\": there is no folder \"/nowhere/at\""
        );
    }

    #[test]
    fn memory_holds_what_the_file_does() {
        let camera = camera();
        let notes = notes(&camera, "nurbray render löwe.toml");
        for precision in [ExrPrecision::Float, ExrPrecision::Half] {
            let mut memory = Cursor::new(Vec::new());
            write_exr_to(&mut memory, &film(None), precision, &notes).unwrap();
            let (held, file) = (read_back(memory.get_ref()), written(&film(None), precision));
            assert_eq!(held.layer_data.attributes, file.layer_data.attributes);
            assert_eq!(held.layer_data.channel_data, file.layer_data.channel_data);
        }

        let mut used = Cursor::new(vec![0; 9]);
        used.set_position(7);
        let refused = write_exr_to(&mut used, &film(None), ExrPrecision::Float, &notes);
        assert_eq!(
            refused.unwrap_err().to_string(),
            "an EXR must begin where its writer does, not at byte 7"
        );
        assert_eq!(used.into_inner(), [0; 9]);
        let mut room = [0_u8; 100];
        let full =
            write_exr_to(Cursor::new(&mut room[..]), &film(None), ExrPrecision::Float, &notes);
        assert!(full.is_err());
    }

    #[test]
    fn dates() {
        let at = |seconds| date(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970:01:01 00:00:00");
        assert_eq!(at(951_782_399), "2000:02:28 23:59:59");
        assert_eq!(at(951_868_800), "2000:03:01 00:00:00");
        assert_eq!(at(1_709_164_800), "2024:02:29 00:00:00");
        assert_eq!(at(4_107_542_400), "2100:03:01 00:00:00");
        assert_eq!(date(UNIX_EPOCH - Duration::from_secs(5)), "1970:01:01 00:00:00");
    }
}
