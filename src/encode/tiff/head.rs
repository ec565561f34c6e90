//! The head of a TIFF: header, directory, palette, and where the strips are.
//!
//! ```text
//!   classic   II 42 | 8         fields of 12 bytes, values that are longer than 4 bytes, zeros up to the length
//!   BigTIFF   II 43 | 8 | 16    fields of 20 bytes, values that are longer than 8 bytes
//! ```
//!
//! Its length is that of the BigTIFF whatever form it has, so that strips begin at the same byte before it is known how long they are together.
//!
//! Source: TIFF Revision 6.0, sections 2 and 8; BigTIFF as libtiff 4 has it.

use super::Packing;
use super::pixels::Pixels;
use crate::run::Header;

/// What the head says of a raster, but for its strips.
pub struct Head {
    fields: Vec<Field>,
    strips: u32,
    /// The longest file in the classic form.
    classic: u64,
}

/// An entry of the directory.
struct Field {
    tag: u16,
    kind: Kind,
    values: Vec<u64>,
}

/// Kinds of values, with their numbers; a rational's value has its numerator in the low half.
#[derive(Clone, Copy)]
enum Kind {
    Short = 3,
    Long = 4,
    Rational = 5,
    Long8 = 16,
}

impl Kind {
    fn bytes(self) -> usize {
        match self {
            Kind::Short => 2,
            Kind::Long => 4,
            Kind::Rational | Kind::Long8 => 8,
        }
    }
}

/// What differs between the two forms: bytes before the directory, of its count, of an entry, of an entry's value, of an offset.
struct Form {
    start: usize,
    count: usize,
    entry: usize,
    offset: usize,
}

const TIFF: Form = Form { start: 8, count: 2, entry: 12, offset: 4 };
const BIG: Form = Form { start: 16, count: 8, entry: 20, offset: 8 };

impl Head {
    /// Of a raster in strips of so many rows.
    pub fn new(header: &Header, pixels: Pixels, packing: Packing, rows: u32, classic: u64) -> Head {
        let (bits, samples, meaning): (&[u64], _, _) = match pixels {
            // White is 0.
            Pixels::Bilevel => (&[1], 1, 0),
            // Black is 0.
            Pixels::Gray => (&[8], 1, 1),
            Pixels::Palette { depth: 4 } => (&[4], 1, 3),
            Pixels::Palette { .. } => (&[8], 1, 3),
            Pixels::Rgb => (&[8; 3], 3, 2),
        };
        let compression = match packing {
            Packing::None => 1,
            Packing::G4 => 4,
            Packing::Deflate => 8,
            Packing::PackBits => 32_773,
        };
        let short = |tag, value| Field { tag, kind: Kind::Short, values: vec![value] };
        let long = |tag, value: u32| Field { tag, kind: Kind::Long, values: vec![value.into()] };
        let mut fields = vec![
            long(256, header.width),
            long(257, header.height()),
            Field { tag: 258, kind: Kind::Short, values: bits.to_vec() },
            short(259, compression),
            short(262, meaning),
            short(277, samples),
            long(278, rows.min(header.height())),
        ];
        if let Some(resolution) = header.dpi.and_then(rational) {
            fields.extend([282, 283].map(|tag| Field { tag, kind: Kind::Rational, values: vec![resolution] }));
            // Inches.
            fields.push(short(296, 2));
        }
        if packing == Packing::Deflate && pixels == Pixels::Rgb {
            // Differences to the pixel before.
            fields.push(short(317, 2));
        }
        if let Pixels::Palette { depth } = pixels {
            let used = header.inks.end() + 1;
            let colours: Vec<_> = (0..1 << depth).map(|pixel| if pixel < used { header.inks.pixel(pixel) } else { [0; 3] }).collect();
            // All reds, all greens, all blues, of 16 bits.
            let values = (0..3).flat_map(|channel| colours.iter().map(move |colour| u64::from(colour[channel]) * 257)).collect();
            fields.push(Field { tag: 320, kind: Kind::Short, values });
        }
        Head { fields, strips: header.height().div_ceil(rows), classic }
    }

    /// How many strips there are.
    pub fn strips(&self) -> u32 {
        self.strips
    }

    /// Its length in bytes.
    pub fn length(&self) -> usize {
        let values = self.fields.iter().map(|field| (field.kind.bytes(), field.values.len()));
        let strips = [Kind::Long8, Kind::Long].map(|kind| (kind.bytes(), self.strips as usize));
        let long: usize = values.chain(strips).map(|(bytes, n)| bytes * n).filter(|bytes| *bytes > BIG.offset).sum();
        (BIG.start + BIG.count + (self.fields.len() + 2) * BIG.entry + BIG.offset + long).next_multiple_of(8)
    }

    /// Its bytes, of strips that are so long.
    pub fn bytes(&self, strips: &[u64]) -> Vec<u8> {
        let mut at = self.length() as u64;
        let offsets = strips.iter().map(|bytes| {
            at += bytes;
            at - bytes
        });
        let offsets = offsets.collect();
        let big = at > self.classic;
        let form = if big { BIG } else { TIFF };
        let places = Field { tag: 273, kind: if big { Kind::Long8 } else { Kind::Long }, values: offsets };
        let lengths = Field { tag: 279, kind: Kind::Long, values: strips.to_vec() };
        let mut fields: Vec<&Field> = self.fields.iter().chain([&places, &lengths]).collect();
        fields.sort_by_key(|field| field.tag);

        let mut out = b"II".to_vec();
        let put = |out: &mut Vec<u8>, value: u64, bytes: usize| out.extend(&value.to_le_bytes()[..bytes]);
        if big {
            [43, 8, 0].into_iter().for_each(|value| put(&mut out, value, 2));
        } else {
            put(&mut out, 42, 2);
        }
        put(&mut out, form.start as u64, form.offset);
        put(&mut out, fields.len() as u64, form.count);
        let mut behind = form.start + form.count + fields.len() * form.entry + form.offset;
        let mut long = Vec::new();
        for field in &fields {
            put(&mut out, field.tag.into(), 2);
            put(&mut out, field.kind as u64, 2);
            put(&mut out, field.values.len() as u64, form.offset);
            let mut values = Vec::with_capacity(field.values.len() * field.kind.bytes());
            field.values.iter().for_each(|value| put(&mut values, *value, field.kind.bytes()));
            if values.len() <= form.offset {
                values.resize(form.offset, 0);
                out.extend(values);
            } else {
                put(&mut out, behind as u64, form.offset);
                behind += values.len();
                long.push(values);
            }
        }
        // No further directory.
        put(&mut out, 0, form.offset);
        long.iter().for_each(|values| out.extend(values));
        out.resize(self.length(), 0);
        out
    }
}

/// A number of dots an inch as a fraction of two 32-bit numbers, the numerator in the low half; none if it does not fit.
fn rational(dpi: f64) -> Option<u64> {
    let fits = |denominator: &f64| (1.0..=f64::from(u32::MAX)).contains(&(dpi * denominator).round());
    // Whole numbers stay whole; others get as many decimals as there is room for.
    let denominator = if dpi.fract() == 0.0 { 1.0 } else { [1e6, 1e4, 1e2, 1.0].into_iter().find(fits)? };
    fits(&denominator).then(|| (dpi * denominator).round() as u64 | (denominator as u64) << 32)
}
