//! The grid that everything is exact on: pixels, their centres, and 1/256 of a pixel.
//!
//! ```text
//!      0     1     2  px          centre of pixel (i, j):  (256 i + 128, 256 j + 128) in 1/256 px
//!    0 +-----+-----+
//!      |  .  |  .  |              a pixel belongs to what its centre lies in; a centre exactly on a
//!    1 +-----+-----+              left or top boundary is inside, on a right or bottom one outside
//! ```

/// Grid steps to a pixel.
pub const SUB: i64 = 256;

/// Widest page, in pixels.
pub const MAX_WIDTH: u32 = 1 << 20;

/// Longest page, in pixels.
pub const MAX_HEIGHT: u32 = 1 << 23;

/// A point whose coordinates are at most this many pixels from the origin is *near*: lines between near points are stepped in
/// 64-bit integers. Lines with a far end are reduced to near ones, exactly, when the edges are built.
pub const NEAR: f64 = (1 << 24) as f64;

/// A point in pixels.
pub type Point = [f64; 2];

/// The number below 1/2: adding 1/2 itself to it would give 1.
const HALF: f64 = 0.5 - f64::EPSILON / 4.0;

/// Rounds a coordinate in pixels, below 2^44 in size, to the nearest 1/256, ties away from zero; in 1/256 px.
#[inline]
pub fn steps(x: f64) -> i64 {
    let x = x * SUB as f64;
    (x + HALF.copysign(x)) as i64
}

/// [`first_centre`] of a coordinate in pixels of any size, once that is rounded to 1/256; within `0..=end`, at most a page's scanlines.
///
/// Rounded, `x` is behind the centre of pixel i, `i + 1/2`, from `i + 1/2 + 1/512` on, so the pixel is `floor(x - 257/512) + 1`. The difference is exact
/// where it is not negative and could matter: with doubles past 2^44 the page has ended. Without a branch, so that many are worked out at once.
#[inline]
pub fn first_within(x: f64, end: f64) -> u32 {
    const PAST: f64 = 0.5 + 1.0 / 512.0;
    // Pushes the fraction out of a double, and the integer into the lowest bits.
    const PUSH: f64 = (3_u64 << 51) as f64;
    let x = x - PAST;
    let x = if x > -1.0 { x } else { -1.0 };
    let x = if x < end - 1.0 { x } else { end - 1.0 };
    let pushed = x + PUSH;
    (pushed.to_bits() as u32).wrapping_add(1).wrapping_sub(u32::from(pushed - PUSH > x))
}

/// Rounds a finite coordinate in pixels to the nearest 1/256, ties away from zero. The result is a multiple of 1/256, exactly
/// (a double past 2^44 already is one).
pub fn snap(x: f64) -> f64 {
    if x.abs() < (1u64 << 44) as f64 { steps(x) as f64 / SUB as f64 } else { x }
}

/// Rounds both coordinates of a point.
pub fn snap_point(p: Point) -> Point {
    [snap(p[0]), snap(p[1])]
}

/// Whether a point is near (see [`NEAR`]).
pub fn is_near(p: Point) -> bool {
    p[0].abs() <= NEAR && p[1].abs() <= NEAR
}

/// The first pixel whose centre is not before `x`, which is in 1/256 px: the column of a vertical edge, or the first scanline of
/// an edge that begins there.
#[inline]
pub fn first_centre(x: i64) -> i64 {
    (x + SUB / 2 - 1) >> SUB.trailing_zeros()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_to_the_nearest_with_ties_away_from_zero() {
        assert_eq!(snap(1.0 / 512.0), 1.0 / 256.0);
        assert_eq!(snap(-1.0 / 512.0), -1.0 / 256.0);
        assert_eq!(snap(0.49 / 256.0), 0.0);
        assert_eq!(snap(1e300), 1e300);
        assert_eq!(snap((1u64 << 43) as f64 + 1.0 / 512.0), (1u64 << 43) as f64 + 1.0 / 256.0);
        let mut seed = 1u64;
        for _ in 0..100_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // Whole and half steps, and the doubles next to them, of all sizes that are rounded.
            let half = ((seed >> 40) as f64 - 8_000_000.0) / 512.0 * 2f64.powi((seed >> 33 & 15) as i32 - 8);
            for x in [half, half.next_up(), half.next_down()] {
                assert_eq!(steps(x), (x * 256.0).round() as i64, "{x}");
                for end in [1, 1000, 1 << 23] {
                    let centre = first_centre(steps(x)).clamp(0, end);
                    assert_eq!(i64::from(first_within(x, end as f64)), centre, "{x}");
                }
            }
        }
    }

    #[test]
    fn the_first_centre_is_half_open() {
        for x in -2000..2000 {
            let brute = (-100..100).find(|i| i * SUB + SUB / 2 >= x).unwrap();
            assert_eq!(first_centre(x), brute, "{x}");
        }
    }
}
