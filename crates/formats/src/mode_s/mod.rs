//! Extended squitters of Mode S: what an aircraft broadcasts of its position and claims of it.
//!
//! Read are messages of 112 bits whose parity is right. No bit is repaired: a repaired message must not carry a claim of integrity.
//! Source: ICAO Doc 9871 and RTCA DO-260B as the specification of surveillance restates them (neither document was read); standard.

mod cpr;
mod parity;
mod radius;

pub use cpr::{Cpr, Fix};
use navbound_core::quantity::{KNOT_MPS, Metres};
pub use radius::{Containment, Supplements, containment};

/// Bytes of an extended squitter.
pub const LONG: usize = 14;
/// Feet of a step of barometric altitude, and of a step of geometric less barometric height.
const STEP_FT: f64 = 25.0;
/// Altitude of the code zero \[ft\].
const LEAST_FT: f64 = -1000.0;

/// Whose word a squitter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sender {
    /// The aircraft itself, by the address that the International Civil Aviation Organization gave it.
    Own,
    /// The aircraft or vehicle itself, by another address.
    OwnOtherAddress,
    /// A ground station: traffic information, or a report that it repeats.
    Ground,
}

/// An extended squitter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Squitter {
    /// Address, 24 bits.
    pub address: u32,
    /// Whose word it is.
    pub sender: Sender,
    /// What it says.
    pub content: Content,
}

/// What a squitter says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Content {
    /// A position in the air.
    Airborne {
        /// Type code, which states the containment.
        code: u8,
        /// Supplement B of NIC, where the version is 2.
        supplement_b: bool,
        /// Barometric altitude \[m\].
        pressure_altitude_m: Option<f64>,
        /// Encoded position.
        cpr: Cpr,
    },
    /// A position on the surface: only a place within 45 NM tells where.
    Surface,
    /// The source of the position has none.
    Without,
    /// Velocity.
    Velocity {
        /// Speed over the ground \[m/s\].
        ground_speed_mps: Option<f64>,
        /// Track over the ground from true north; none of an aircraft that stands \[rad\].
        ground_track_rad: Option<f64>,
        /// Geometric less barometric height \[m\].
        geometric_less_pressure_m: Option<f64>,
    },
    /// Target state of version 2: categories alone.
    Target(Categories),
    /// Operational status.
    Operational {
        /// Version of the definitions by which the aircraft speaks.
        version: u8,
        /// Supplement A of NIC.
        supplement_a: bool,
        /// Categories; none of version 0.
        categories: Option<Categories>,
    },
    /// Something else.
    Other,
}

/// What an aircraft claims of its positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Categories {
    /// Navigation accuracy category for position.
    pub nac_p: u8,
    /// Source integrity level.
    pub sil: u8,
}

/// A squitter whose parity is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WrongParity;

/// The extended squitter of a message of 14 bytes; `None` for every other message.
///
/// # Errors
/// [`WrongParity`]
pub fn squitter(message: &[u8]) -> Result<Option<Squitter>, WrongParity> {
    let Ok(message) = <&[u8; LONG]>::try_from(message) else { return Ok(None) };
    let (format, capability) = (message[0] >> 3, message[0] & 7);
    let sender = match (format, capability) {
        (17, _) | (18, 0) => Sender::Own,
        (18, 1) => Sender::OwnOtherAddress,
        (18, _) => Sender::Ground,
        _ => return Ok(None),
    };
    if parity::remainder(message) != 0 {
        return Err(WrongParity);
    }
    let address = u32::from_be_bytes([0, message[1], message[2], message[3]]);
    let field = u64::from_be_bytes([0, message[4], message[5], message[6], message[7], message[8], message[9], message[10]]);
    Ok(Some(Squitter { address, sender, content: content(Field(field)) }))
}

/// Writes the parity of a message over its last three bytes.
pub fn with_parity(message: &mut [u8; LONG]) {
    message[LONG - 3..].fill(0);
    let [_, parity @ ..] = parity::remainder(message).to_be_bytes();
    message[LONG - 3..].copy_from_slice(&parity);
}

/// The 56 bits that a squitter says something in; its bits are numbered from 1, as in the documents.
#[derive(Clone, Copy)]
struct Field(u64);

impl Field {
    const fn bits(self, first: u32, last: u32) -> u64 {
        self.0 >> (56 - last) & ((1 << (last - first + 1)) - 1)
    }

    const fn flag(self, bit: u32) -> bool {
        self.bits(bit, bit) == 1
    }
}

fn content(field: Field) -> Content {
    let (code, subtype) = (field.bits(1, 5) as u8, field.bits(6, 8));
    match (code, subtype) {
        (0, _) => Content::Without,
        (5..=8, _) => Content::Surface,
        (9..=18 | 20..=22, _) => Content::Airborne {
            code,
            supplement_b: field.flag(8),
            // Whether the height of the codes 20 to 22 is in feet or in metres is said in two ways: it is left out.
            pressure_altitude_m: (code < 19).then(|| pressure_altitude_ft(field.bits(9, 20))).flatten().map(metres),
            cpr: Cpr { odd: field.flag(22), lat: field.bits(23, 39) as u32, lon: field.bits(40, 56) as u32 },
        },
        (19, 1..=4) => velocity(field, subtype),
        // Subtype 1, of version 2; bits 6 and 7 alone are the subtype.
        (29, _) if field.bits(6, 7) == 1 => Content::Target(Categories { nac_p: field.bits(40, 43) as u8, sil: field.bits(45, 46) as u8 }),
        (31, 0 | 1) => {
            let version = field.bits(41, 43) as u8;
            let categories = Categories { nac_p: field.bits(45, 48) as u8, sil: field.bits(51, 52) as u8 };
            Content::Operational { version, supplement_a: field.flag(44), categories: (version > 0).then_some(categories) }
        }
        _ => Content::Other,
    }
}

/// Altitude of 12 bits \[ft\]: in steps of 25 ft; the older code of 100 ft, above 50,175 ft, is not read.
fn pressure_altitude_ft(code: u64) -> Option<f64> {
    let steps = code >> 5 << 4 | code & 0xf;
    (code & 0x10 != 0).then_some(LEAST_FT + STEP_FT * steps as f64)
}

fn metres(feet: f64) -> f64 {
    Metres::feet(feet).m()
}

fn velocity(field: Field, subtype: u64) -> Content {
    // A part of zero is none, one means standing.
    let part = |first: u32| {
        let length = field.bits(first, first + 9).checked_sub(1).map(|knots| knots as f64);
        // Before each stands whether it leads to the west, to the south.
        length.map(|knots| if field.flag(first - 1) { -knots } else { knots })
    };
    let parts = if matches!(subtype, 1 | 2) { part(15).zip(part(26)) } else { None };
    let knots = parts.map(|(east, north)| libm::hypot(east, north));
    let ground_track_rad = parts.filter(|parts| *parts != (0.0, 0.0)).map(|(east, north)| libm::atan2(east, north));
    // Above the speed of sound a step is four knots.
    let step = if subtype == 2 { 4.0 } else { 1.0 };
    let sign = if field.flag(49) { -1.0 } else { 1.0 };
    let difference_ft = field.bits(50, 56).checked_sub(1).map(|steps| sign * STEP_FT * steps as f64);
    Content::Velocity {
        ground_speed_mps: knots.map(|knots| knots * step * KNOT_MPS),
        ground_track_rad,
        geometric_less_pressure_m: difference_ft.map(metres),
    }
}

/// The message of a line as receivers print them: `*8D4840D6202CC371C32CE0576098;`, with the counter of the receiver behind `@` instead.
pub fn of_line(line: &[u8]) -> Option<([u8; LONG], usize)> {
    let digits = match line.trim_ascii().strip_suffix(b";")? {
        [b'*', digits @ ..] => digits,
        // Twelve digits of a counter.
        [b'@', rest @ ..] => rest.get(12..)?,
        _ => return None,
    };
    let (mut message, n) = ([0; LONG], digits.len() / 2);
    if !digits.len().is_multiple_of(2) || ![2, 7, LONG].contains(&n) {
        return None;
    }
    let digit = |byte: u8| char::from(byte).to_digit(16).map(|value| value as u8);
    for (byte, pair) in message.iter_mut().zip(digits.chunks_exact(2)) {
        let &[high, low] = pair else { return None };
        *byte = digit(high)? << 4 | digit(low)?;
    }
    Some((message, n))
}

#[cfg(test)]
mod tests;
