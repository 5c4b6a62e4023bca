//! Fields of fixed columns to values in SI units. Columns are counted from 1 and inclusive, as the standard prints them.

use core::f64::consts::PI;
use core::fmt;
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, Radians};

/// Metres in a nautical mile (standard: International Hydrographic Conference 1929).
pub(super) const NAUTICAL_MILE_M: f64 = Metres::nautical_miles(1.0).m();
/// Metres in a foot (standard: 1959 agreement).
const FOOT_M: f64 = Metres::feet(1.0).m();

/// Characters of a field, blanks at its end left out when it is shown.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Text<const N: usize>([u8; N]);

impl<const N: usize> Text<N> {
    /// The text from these characters; longer ones are cut, shorter ones filled with blanks.
    pub fn new(characters: &str) -> Self {
        Self::from_bytes(characters.as_bytes())
    }
    fn from_bytes(bytes: &[u8]) -> Self {
        let mut text = [b' '; N];
        for (to, from) in text.iter_mut().zip(bytes) {
            *to = *from;
        }
        Self(text)
    }
    /// The characters without blanks at the end.
    pub fn as_str(&self) -> &str {
        core::str::from_utf8(self.0.trim_ascii_end()).unwrap_or("")
    }
    /// Whether there is nothing but blanks.
    pub fn is_blank(&self) -> bool {
        self.0.iter().all(|b| *b == b' ')
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl<const N: usize> fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

/// A field that has another content than its kind allows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) field: &'static str,
    pub(super) reason: &'static str,
    pub(super) text: String,
}

/// A course as the file has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// Angle, clockwise from the north that `true_north` names \[rad\].
    pub rad: f64,
    /// Whether it counts from true north; else from magnetic.
    pub true_north: bool,
}

/// How long a leg is, in the measure that the file uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// Distance \[m\].
    Metres(f64),
    /// Time \[s\].
    Seconds(f64),
}

/// One line of exactly [`super::WIDTH`] ASCII characters.
#[derive(Clone, Copy)]
pub(super) struct Record<'a>(pub(super) &'a [u8]);

impl<'a> Record<'a> {
    pub(super) fn bytes(self, first: usize, last: usize) -> &'a [u8] {
        self.0.get(first - 1..last).unwrap_or(&[])
    }
    pub(super) fn byte(self, column: usize) -> u8 {
        self.0.get(column - 1).copied().unwrap_or(b' ')
    }
    pub(super) fn text<const N: usize>(self, first: usize) -> Text<N> {
        Text::from_bytes(self.bytes(first, first + N - 1))
    }
    fn fault(self, field: &'static str, first: usize, last: usize, reason: &'static str) -> Fault {
        Fault { field, reason, text: String::from_utf8_lossy(self.bytes(first, last)).into_owned() }
    }
    fn blank(self, first: usize, last: usize) -> bool {
        self.bytes(first, last).iter().all(|b| *b == b' ')
    }

    /// A whole number with an optional sign; None where the field is blank.
    pub(super) fn whole(self, field: &'static str, first: usize, last: usize) -> Result<Option<i32>, Fault> {
        let bytes = self.bytes(first, last).trim_ascii();
        if bytes.is_empty() {
            return Ok(None);
        }
        let (sign, digits) = match bytes {
            [b'-', rest @ ..] => (-1, rest),
            [b'+', rest @ ..] => (1, rest),
            _ => (1, bytes),
        };
        digits_of(digits).map(|v| Some(sign * v)).ok_or_else(|| self.fault(field, first, last, "not a whole number"))
    }

    fn scaled(self, field: &'static str, (first, last): (usize, usize), unit: f64) -> Result<Option<f64>, Fault> {
        Ok(self.whole(field, first, last)?.map(|v| f64::from(v) * unit))
    }
    /// Tenths of a nautical mile, or thousandths, to metres.
    pub(super) fn miles(self, field: &'static str, columns: (usize, usize), parts: f64) -> Result<Option<f64>, Fault> {
        Ok(self.scaled(field, columns, 1.0)?.map(|v| v / parts * NAUTICAL_MILE_M))
    }
    /// Feet to metres.
    pub(super) fn feet(self, field: &'static str, first: usize, last: usize) -> Result<Option<f64>, Fault> {
        self.scaled(field, (first, last), FOOT_M)
    }
    /// Parts of a metre to metres.
    pub(super) fn metres(self, field: &'static str, columns: (usize, usize), parts: f64) -> Result<Option<f64>, Fault> {
        Ok(self.scaled(field, columns, 1.0)?.map(|v| v / parts))
    }
    /// Parts of a degree to radians.
    pub(super) fn degrees(self, field: &'static str, columns: (usize, usize), parts: f64) -> Result<Option<f64>, Fault> {
        Ok(self.scaled(field, columns, 1.0)?.map(|v| (v / parts).to_radians()))
    }

    /// Variation such as `E0110`, positive east \[rad\]. `T` declares true north: no variation; blank or `D`: none stated.
    pub(super) fn variation(self, first: usize) -> Result<Option<f64>, Fault> {
        let sign = match self.byte(first) {
            b'E' => 1.0,
            b'W' => -1.0,
            b'T' => return Ok(Some(0.0)),
            _ => return Ok(None),
        };
        Ok(self.degrees("magnetic variation", (first + 1, first + 4), 10.0)?.map(|v| sign * v))
    }

    /// Course such as `2626`, tenths of a degree, or `262T` with true north \[rad\].
    pub(super) fn course(self, field: &'static str, first: usize) -> Result<Option<Course>, Fault> {
        if self.blank(first, first + 3) {
            return Ok(None);
        }
        let true_north = self.byte(first + 3) == b'T';
        let (last, parts) = if true_north { (first + 2, 1.0) } else { (first + 3, 10.0) };
        let rad = self.degrees(field, (first, last), parts)?.filter(|v| (0.0..=2.0 * PI).contains(v));
        let rad = rad.ok_or_else(|| self.fault(field, first, first + 3, "not a course of 0 to 360 degrees"))?;
        Ok(Some(Course { rad, true_north }))
    }

    /// Tenths of a nautical mile, or `T` and tenths of a minute.
    pub(super) fn extent(self, field: &'static str, first: usize) -> Result<Option<Extent>, Fault> {
        if self.byte(first) == b'T' {
            return Ok(self.scaled(field, (first + 1, first + 3), 6.0)?.map(Extent::Seconds));
        }
        Ok(self.miles(field, (first, first + 3), 10.0)?.map(Extent::Metres))
    }

    /// RNP `mme`: mm times ten to the power -e \[NM\], here in metres.
    pub(super) fn rnp(self, first: usize) -> Result<Option<f64>, Fault> {
        if self.blank(first, first + 2) {
            return Ok(None);
        }
        let refuse = || self.fault("RNP", first, first + 2, "not three digits with a value above 0");
        rnp_m(self.bytes(first, first + 2)).map(Some).ok_or_else(refuse)
    }

    /// Latitude and longitude with `decimals` digits behind the second; None where both are blank.
    pub(super) fn place(self, first: usize, decimals: usize) -> Result<Option<LatLon>, Fault> {
        let (lat_last, lon_last) = (first + 6 + decimals, first + 14 + 2 * decimals);
        if self.blank(first, lon_last) {
            return Ok(None);
        }
        let lat = angle(self.bytes(first, lat_last), 2, (b'N', b'S'), 90.0);
        let lat = lat.ok_or_else(|| self.fault("latitude", first, lat_last, "not a latitude of 0 to 90 degrees"))?;
        let lon = angle(self.bytes(lat_last + 1, lon_last), 3, (b'E', b'W'), 180.0);
        let lon = lon.ok_or_else(|| self.fault("longitude", lat_last + 1, lon_last, "not a longitude of 0 to 180 degrees"))?;
        let place = LatLon::new(Radians::new(lat.to_radians()), Radians::new(lon.to_radians()));
        place.map(Some).map_err(|_| self.fault("position", first, lon_last, "not on the Earth"))
    }
}

fn digits_of(bytes: &[u8]) -> Option<i32> {
    if bytes.is_empty() || bytes.len() > 9 || !bytes.iter().all(u8::is_ascii_digit) {
        return None;
    }
    Some(bytes.iter().fold(0, |v, b| v * 10 + i32::from(b - b'0')))
}

/// RNP of three digits `mme` \[m\]; None where it is none, or 0.
pub(super) fn rnp_m(bytes: &[u8]) -> Option<f64> {
    let (value, exponent) = (digits_of(bytes.get(..2)?)?, digits_of(bytes.get(2..3)?)?);
    (value > 0).then(|| f64::from(value) / 10f64.powi(exponent) * NAUTICAL_MILE_M)
}

/// Hemisphere, degrees, minutes, seconds with decimals \[deg\].
fn angle(bytes: &[u8], degree_digits: usize, (positive, negative): (u8, u8), most: f64) -> Option<f64> {
    let (hemisphere, digits) = bytes.split_first()?;
    let sign = if *hemisphere == positive {
        1.0
    } else if *hemisphere == negative {
        -1.0
    } else {
        return None;
    };
    let degrees = f64::from(digits_of(digits.get(..degree_digits)?)?);
    let minutes = f64::from(digits_of(digits.get(degree_digits..degree_digits + 2)?)?);
    let seconds = digits.get(degree_digits + 2..)?;
    let decimals = i32::try_from(seconds.len()).ok()? - 2;
    let seconds = f64::from(digits_of(seconds)?) / 10f64.powi(decimals);
    let value = degrees + minutes / 60.0 + seconds / 3600.0;
    (minutes < 60.0 && seconds < 60.0 && value <= most).then_some(sign * value)
}
