//! One observation: fourteen columns of a number with three decimals, one of loss of lock, one of strength.
//!
//! A day holds two million of them, so the ordinary form is read eight digits at a time; anything else goes through
//! [`super::number::decimal`].

use super::number::{Field, decimal};

const ZEROS: u64 = 0x3030_3030_3030_3030;
const BLANKS: u64 = 0x2020_2020_2020_2020;

/// The number of an observation; NaN for a blank. `None` for something else.
#[inline]
pub(super) fn observation(field: &[u8; 14]) -> Option<f64> {
    let first = u64::from_le_bytes([field[0], field[1], field[2], field[3], field[4], field[5], field[6], field[7]]);
    let last = u64::from_le_bytes([field[6], field[7], field[8], field[9], field[10], field[11], field[12], field[13]]);
    if first == BLANKS && last == BLANKS {
        return Some(f64::NAN);
    }
    ordinary(field[10], first, last).or_else(|| slow(field))
}

/// Thirteen digits with the point before the last three, blanks and one minus sign before them; `None` for any other form.
#[inline]
fn ordinary(point: u8, first: u64, last: u64) -> Option<f64> {
    // Columns 0-4 as the last five of eight digits; columns 5-9 and 11-13 as eight digits. The first column is the lowest byte.
    let high = (first << 24) | 0x20_2020;
    let low = (last & 0xffff_ff00_0000_0000) | ((last & 0xffff_ffff) << 8) | (first >> 40 & 0xff);
    let (high, minus_high) = blanks_to_zeros(high)?;
    let (low, minus_low) = if high == ZEROS && !minus_high { blanks_to_zeros(low)? } else { (low, false) };
    let value = (eight(high)? * 100_000_000 + eight(low)?) as f64 / 1000.0;
    (point == b'.').then_some(if minus_high || minus_low { -value } else { value })
}

/// Leading blanks, and a minus sign behind them, replaced by zeros.
#[inline]
fn blanks_to_zeros(digits: u64) -> Option<(u64, bool)> {
    // Bytes that differ from a digit's upper half, as full bytes, counted from the first column.
    let lead = (digits ^ ZEROS) & 0xf0f0_f0f0_f0f0_f0f0;
    let n = 8 - (lead.leading_zeros() / 8);
    if n == 0 {
        return Some((digits, false));
    }
    let mask = if n == 8 { u64::MAX } else { (1_u64 << (8 * n)) - 1 };
    let shift = 8 * (n - 1);
    let sign = (digits >> shift & 0xff) as u8;
    // All before the sign's place are blanks.
    let before = mask >> 8;
    if digits & before != BLANKS & before || !matches!(sign, b' ' | b'-') {
        return None;
    }
    Some(((digits & !mask) | (ZEROS & mask), sign == b'-'))
}

/// Eight ASCII digits as a number, by three multiplications.
#[inline]
fn eight(digits: u64) -> Option<u64> {
    let x = digits ^ ZEROS;
    if (x | x.wrapping_add(0x0606_0606_0606_0606)) & 0xf0f0_f0f0_f0f0_f0f0 != 0 {
        return None;
    }
    let x = x.wrapping_mul(10).wrapping_add(x >> 8) & 0x00ff_00ff_00ff_00ff;
    let x = x.wrapping_mul(100).wrapping_add(x >> 16) & 0x0000_ffff_0000_ffff;
    Some(x.wrapping_mul(10_000).wrapping_add(x >> 32) & 0xffff_ffff)
}

#[cold]
fn slow(field: &[u8]) -> Option<f64> {
    match decimal(field) {
        Field::Blank => Some(f64::NAN),
        Field::Number(value) => Some(value),
        Field::Bad => None,
    }
}

/// Loss of lock in the upper, strength in the lower four bits, blank as 0; `None` unless both are digits or blank.
#[inline]
pub(super) fn indicators(lock: u8, strength: u8) -> Option<u8> {
    let digit = |b: u8| match b {
        b' ' => Some(0),
        b'0'..=b'9' => Some(b - b'0'),
        _ => None,
    };
    Some(digit(lock)? << 4 | digit(strength)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Option<f64> {
        observation(text.as_bytes().try_into().unwrap())
    }

    #[test]
    fn forms_seen_in_files() {
        for (text, value) in [
            ("  21600712.022", 21_600_712.022),
            (" 113512506.876", 113_512_506.876),
            ("      -811.224", -811.224),
            (" -20304412.007", -20_304_412.007),
            ("-120304412.007", -120_304_412.007),
            ("         0.000", 0.0),
            ("          .500", 0.5),
            ("         -.500", -0.5),
            ("9999999999.999", 9_999_999_999.999),
            ("27.000        ", 27.0),
            ("      27.00   ", 27.0),
        ] {
            assert_eq!(read(text), Some(value), "{text}");
        }
        assert!(read("              ").unwrap().is_nan());
        for bad in
            ["  216 0712.022", "  21600712.0x2", "  -      1.000", "#####12345.678", "  21600712022 ", "  1.600712.022", "  /1600712.022"]
        {
            let parsed = read(bad);
            assert_eq!(parsed, slow(bad.as_bytes()), "{bad}");
        }
        assert_eq!(read("#####12345.678"), None);
        assert_eq!(read("  216 0712.022"), None);
    }

    proptest! {
        #[test]
        fn every_number_of_three_decimals_is_read_exactly(thousandths in -999_999_999_999_i64..9_999_999_999_999) {
            let text = format!("{}{}.{:03}", if thousandths < 0 { "-" } else { "" }, thousandths.abs() / 1000, thousandths.abs() % 1000);
            prop_assert_eq!(read(&format!("{text:>14}")), Some(text.parse().unwrap()));
        }

        // Any fourteen bytes of those that occur: the same answer as the slow way, digits and all.
        #[test]
        fn the_fast_way_agrees_with_the_slow(bytes in proptest::collection::vec(proptest::sample::select(b" -.0123456789#/:x".to_vec()), 14)) {
            let field: [u8; 14] = bytes.try_into().unwrap();
            let (fast, slow) = (observation(&field), slow(&field));
            prop_assert!(fast == slow || (fast.is_some_and(f64::is_nan) && slow.is_some_and(f64::is_nan)), "{:?} {:?}", fast, slow);
        }

        #[test]
        fn the_fast_way_agrees_near_ordinary_forms(number in 0_u64..9_999_999_999_999, at in 0_usize..14, byte in any::<u8>()) {
            let mut field: [u8; 14] = format!("{:>14}", format!("{}.{:03}", number / 1000, number % 1000)).into_bytes().try_into().unwrap();
            field[at] = byte;
            let (fast, slow) = (observation(&field), slow(&field));
            prop_assert!(fast == slow || (fast.is_some_and(f64::is_nan) && slow.is_some_and(f64::is_nan)), "{:?} {:?} {:?}", field, fast, slow);
        }
    }
}
