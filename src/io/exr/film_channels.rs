//! A film as the writer of EXR files reads it: block by block, so that no second copy of the
//! picture is held.

use exr::block::BlockIndex;
use exr::image::write::channels::{ChannelsWriter, WritableChannels};
use exr::math::RoundingMode;
use exr::meta::attribute::{ChannelDescription, ChannelList, LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::{SmallVec, f16};

use super::ExrPrecision;
use crate::render::{Channel, Film};

/// The channels of a film.
#[derive(Clone, Debug)]
pub(super) struct FilmChannels<'f> {
    film: &'f Film,
    precision: ExrPrecision,
    /// By name, as they lie in a file.
    channels: Vec<Channel>,
}

impl<'f> FilmChannels<'f> {
    pub(super) fn new(film: &'f Film, precision: ExrPrecision) -> Self {
        let mut channels: Vec<Channel> = film.channels().collect();
        channels.sort_by_key(|channel| channel.name());
        Self { film, precision, channels }
    }

    fn sample_type(&self, channel: Channel) -> SampleType {
        match self.precision {
            ExrPrecision::Half if channel.is_color() => SampleType::F16,
            ExrPrecision::Half | ExrPrecision::Float => SampleType::F32,
        }
    }
}

impl<'s> WritableChannels<'s> for FilmChannels<'_> {
    type Writer = Self;

    fn infer_channel_list(&self) -> ChannelList {
        let described = |&channel: &Channel| {
            ChannelDescription::named(channel.name(), self.sample_type(channel))
        };
        ChannelList::new(self.channels.iter().map(described).collect::<SmallVec<_>>())
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_writer(&'s self, _: &Header) -> Self {
        self.clone()
    }
}

impl ChannelsWriter for FilmChannels<'_> {
    /// The samples of a block: row by row, of each row channel by channel.
    fn extract_uncompressed_block(&self, header: &Header, block: BlockIndex) -> Vec<u8> {
        let top = self.film.window().min()[1];
        let (from, size) = (block.pixel_position, block.pixel_size);
        let mut bytes = Vec::with_capacity(size.area() * header.channels.bytes_per_pixel);
        for y in from.1..from.1 + size.1 {
            for &channel in &self.channels {
                let row = self.film.row(channel, top + y as u32); // below 2^16
                let values = row.into_iter().flatten().skip(from.0).take(size.0);
                match self.sample_type(channel) {
                    SampleType::F16 => bytes.extend(values.flat_map(|x| half(x).to_ne_bytes())),
                    _ => bytes.extend(values.flat_map(f32::to_ne_bytes)),
                }
            }
        }
        bytes
    }
}

/// The nearest half-precision number that is finite.
fn half(x: f32) -> f16 {
    let largest = f16::MAX.to_f32();
    f16::from_f32(x.clamp(-largest, largest))
}
