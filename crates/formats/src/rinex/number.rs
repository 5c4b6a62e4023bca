//! Numbers in fixed columns.

/// What a column range holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Field {
    /// Nothing but blanks, or beyond the end of the line.
    Blank,
    /// A finite number.
    Number(f64),
    /// Something else.
    Bad,
}

impl Field {
    /// The number, blank counting as zero; `None` for anything else.
    pub(crate) fn or_zero(self) -> Option<f64> {
        match self {
            Self::Blank => Some(0.0),
            Self::Number(v) => Some(v),
            Self::Bad => None,
        }
    }
}

/// Columns `from..to` of a line, cut where the line ends.
pub(crate) fn columns(line: &[u8], from: usize, to: usize) -> &[u8] {
    line.get(from.min(line.len())..to.min(line.len())).unwrap_or_default()
}

/// The number in columns `from..to`; one within which the line ends has lost its last digits and is none.
pub(crate) fn fixed(line: &[u8], from: usize, to: usize) -> Field {
    match decimal(columns(line, from, to)) {
        Field::Number(_) if line.len() < to => Field::Bad,
        field => field,
    }
}

/// Columns as text without blanks at the ends, foreign characters replaced.
pub(crate) fn text(line: &[u8], from: usize, to: usize) -> String {
    String::from_utf8_lossy(columns(line, from, to).trim_ascii()).into_owned()
}

/// An unsigned or signed whole number; blanks around it are allowed, blank alone is `None`.
pub(crate) fn whole(field: &[u8]) -> Option<i64> {
    let field = field.trim_ascii();
    // Two or three digits, as nearly always: no way through text.
    if (1..=4).contains(&field.len()) && field.iter().all(u8::is_ascii_digit) {
        return Some(field.iter().fold(0, |n, b| 10 * n + i64::from(b - b'0')));
    }
    std::str::from_utf8(field).ok()?.parse().ok()
}

/// Powers of ten that are exact in double precision.
const TENS: [f64; 23] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22];

/// A decimal number, exponents by D, d, E or e; correctly rounded.
pub(crate) fn decimal(field: &[u8]) -> Field {
    let field = field.trim_ascii();
    let (negative, digits) = match field {
        [] => return Field::Blank,
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        rest => (false, rest),
    };
    match mantissa(digits) {
        // An integer below 2^53 times or over an exact power of ten is rounded once: correctly.
        Some((m, e)) if m < 1 << 53 && e.unsigned_abs() < 23 => {
            let tens = TENS[e.unsigned_abs() as usize];
            let value = if e < 0 { m as f64 / tens } else { m as f64 * tens };
            Field::Number(if negative { -value } else { value })
        }
        _ => slow(field),
    }
}

/// Digits without the point as a whole number, and the power of ten to multiply it by; `None` for anything out of the ordinary.
fn mantissa(digits: &[u8]) -> Option<(u64, i32)> {
    let (mut m, mut n, mut point) = (0_u64, 0, None);
    for (i, &b) in digits.iter().enumerate() {
        match b {
            b'0'..=b'9' => {
                n += 1;
                m = m.wrapping_mul(10).wrapping_add(u64::from(b - b'0'));
            }
            b'.' if point.is_none() => point = Some(n),
            b'D' | b'd' | b'E' | b'e' => {
                let exponent: i32 = std::str::from_utf8(&digits[i + 1..]).ok()?.trim().parse().ok()?;
                return (n > 0 && n < 19).then(|| (m, exponent.saturating_sub(n - point.unwrap_or(n))));
            }
            _ => return None,
        }
    }
    (n > 0 && n < 19).then(|| (m, point.unwrap_or(n) - n))
}

fn slow(field: &[u8]) -> Field {
    let replaced: Vec<u8> = field.iter().map(|b| if matches!(b, b'D' | b'd') { b'e' } else { *b }).collect();
    // Words such as "inf" and "nan" are numbers to the standard library, not to RINEX.
    let ordinary = replaced.iter().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E'));
    match std::str::from_utf8(&replaced).ok().filter(|_| ordinary).and_then(|t| t.parse::<f64>().ok()) {
        Some(value) if value.is_finite() => Field::Number(value),
        _ => Field::Bad,
    }
}

/// Seconds with a fraction as whole nanoseconds; digits beyond the ninth decimal are cut. `None` unless a number below 100 s.
pub(crate) fn seconds_ns(field: &[u8]) -> Option<i64> {
    let field = field.trim_ascii();
    let (mut value, mut decimals, mut point) = (0_i64, 0, false);
    for &b in field {
        match b {
            b'0'..=b'9' if decimals == 9 => {}
            b'0'..=b'9' => {
                value = value * 10 + i64::from(b - b'0');
                decimals += usize::from(point);
                if value >= 100_000_000_000 {
                    return None;
                }
            }
            b'.' if !point => point = true,
            _ => return None,
        }
    }
    let value = value.checked_mul(10_i64.pow(9 - u32::try_from(decimals).ok()?))?;
    (!field.is_empty() && value < 100_000_000_000).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_as_fortran_writes_them() {
        for (field, value) in [
            ("  .745058D-08", 0.745058e-8),
            ("-8.526512829121D-12", -8.526512829121e-12),
            ("5153.657373428", 5153.657373428),
            (" 1.0e+00", 1.0),
            ("-.5", -0.5),
            ("12", 12.0),
            ("9.999999999999e+99", 9.999999999999e99),
        ] {
            assert_eq!(decimal(field.as_bytes()), Field::Number(value), "{field}");
        }
        assert_eq!(decimal(b"    "), Field::Blank);
        for bad in ["nan", "inf", "1.2.3", "--1", "1e", "12a", ".", "-", "1 2", "1e999"] {
            assert_eq!(decimal(bad.as_bytes()), Field::Bad, "{bad}");
        }
    }

    #[test]
    fn seconds_are_whole_nanoseconds() {
        assert_eq!(seconds_ns(b" 33.9970000"), Some(33_997_000_000));
        assert_eq!(seconds_ns(b"0.1"), Some(100_000_000));
        assert_eq!(seconds_ns(b" 5.12345678912"), Some(5_123_456_789));
        for bad in [&b""[..], b"-1.0", b"1e5", b"100.0", b"99999999999999999999.0", b"1.0.0"] {
            assert_eq!(seconds_ns(bad), None);
        }
    }

    proptest! {
        // The standard library rounds correctly; so must we.
        #[test]
        fn decimals_are_correctly_rounded(m in -9_999_999_999_999_i64..9_999_999_999_999, point in 0_usize..13, e in -30_i32..30) {
            let digits = format!("{:013}", m.unsigned_abs());
            let sign = if m < 0 { "-" } else { "" };
            let written = format!("{sign}{}.{}e{e:+03}", &digits[..13 - point], &digits[13 - point..]);
            prop_assert_eq!(decimal(written.as_bytes()), Field::Number(written.parse().unwrap()));
        }
    }
}
