//! A place in a text: points of WKT, ISO 6709, degrees with minutes and hemispheres, and two numbers.

/// A place as it is written; of two numbers whose order nobody states either may be the latitude \[deg\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Written {
    /// Two numbers.
    pub deg: [f64; 2],
    /// The first of them is the latitude.
    pub ordered: bool,
    /// The form says that it is a place; two bare numbers may be anything.
    pub by_itself: bool,
}

impl Written {
    /// Latitude and longitude in each order that may be meant, of places on the Earth \[rad\].
    pub fn places_rad(self) -> impl Iterator<Item = [f64; 2]> {
        let [first, second] = self.deg;
        let orders = [Some([first, second]), (!self.ordered).then_some([second, first])];
        orders.into_iter().flatten().filter(|[lat, lon]| lat.abs() <= 90.0 && lon.abs() <= 360.0).map(|place| place.map(f64::to_radians))
    }
}

/// Longest text that is looked at: a place is short \[1\].
const LONGEST: usize = 1000;

/// The place that a text is; `None` for any other text.
#[must_use]
pub fn of_text(text: &str) -> Option<Written> {
    let text = text.trim();
    if text.is_empty() || text.len() > LONGEST {
        return None;
    }
    of_wkt(text).or_else(|| of_iso_6709(text)).or_else(|| of_hemispheres(text)).or_else(|| of_pair(text))
}

/// Digits of a geohash, and least of them that say where a vehicle is to a kilometre \[1\].
const GEOHASH: (&[u8; 32], usize) = (b"0123456789bcdefghjkmnpqrstuvwxyz", 6);

/// The middle of the cell of a geohash; any short word may be one, so that a name must say it.
#[must_use]
pub fn of_geohash(text: &str) -> Option<Written> {
    let text = text.trim();
    if !(GEOHASH.1..=12).contains(&text.len()) {
        return None;
    }
    // Longitude and latitude in turns, half of what is left by each bit.
    let (mut halves, mut size, mut axis) = ([0.0, 0.0], [360.0, 180.0], 0);
    for digit in text.bytes() {
        let value = GEOHASH.0.iter().position(|each| *each == digit.to_ascii_lowercase())?;
        for bit in [16, 8, 4, 2, 1] {
            size[axis] *= 0.5;
            halves[axis] += if value & bit != 0 { size[axis] } else { 0.0 };
            axis = 1 - axis;
        }
    }
    let [lon, lat] = [halves[0] + 0.5 * size[0] - 180.0, halves[1] + 0.5 * size[1] - 90.0];
    Some(Written { deg: [lat, lon], ordered: true, by_itself: false })
}

/// `POINT(2.3 48.9)`, and the same behind its reference system, with further axes.
fn of_wkt(text: &str) -> Option<Written> {
    let upper = text.to_ascii_uppercase();
    let rest = match upper.strip_prefix("SRID=") {
        Some(behind) => behind.split_once(';')?.1.trim_start(),
        None => upper.as_str(),
    };
    let rest = rest.strip_prefix("POINT")?.trim_start();
    let rest = rest.trim_start_matches(['Z', 'M']).trim_start();
    let inside = rest.strip_prefix('(')?.trim_end().strip_suffix(')')?;
    let numbers: Option<Vec<f64>> = inside.split([' ', ',', '\t']).filter(|each| !each.is_empty()).map(number).collect();
    match *numbers? {
        [x, y] | [x, y, _] | [x, y, _, _] => Some(Written { deg: [x, y], ordered: false, by_itself: true }),
        _ => None,
    }
}

/// `+48.8577+002.295/`, `+4851.4+00217.7/`, `+485124+0021742+35/`.
fn of_iso_6709(text: &str) -> Option<Written> {
    let body = text.strip_suffix('/').unwrap_or(text);
    let (body, _) = body.split_once("CRS").unwrap_or((body, ""));
    let mut parts = signed(body)?;
    let (lat, lon) = (parts.next()?, parts.next()?);
    let rest = parts.count();
    let deg = [sexagesimal(lat, 2)?, sexagesimal(lon, 3)?];
    (rest <= 1).then_some(Written { deg, ordered: true, by_itself: true })
}

/// Parts that each begin with a sign and have digits and a point behind it.
fn signed(text: &str) -> Option<impl Iterator<Item = &str>> {
    let plain = text.starts_with(['+', '-']) && text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'));
    plain.then(|| {
        let mut begins: Vec<usize> = text.match_indices(['+', '-']).map(|(at, _)| at).collect();
        begins.push(text.len());
        let ends = begins.clone().into_iter().skip(1);
        begins.into_iter().zip(ends).filter_map(|(begin, end)| text.get(begin..end))
    })
}

/// Degrees of so many digits, minutes and seconds of two each, in one number with its sign.
fn sexagesimal(text: &str, digits: usize) -> Option<f64> {
    let (sign, body) = text.split_at_checked(1)?;
    let whole = body.split('.').next()?.len();
    let value = packed(number(body)?, whole.checked_sub(digits)?)?;
    Some(if sign == "-" { -value } else { value })
}

/// Degrees of a number with minutes in its last two whole digits, or with minutes and seconds in its last four.
fn packed(number: f64, beyond_degrees: usize) -> Option<f64> {
    let split = |number: f64| ((number / 100.0).trunc(), number % 100.0);
    match beyond_degrees {
        0 => Some(number),
        2 => {
            let (degrees, minutes) = split(number);
            (minutes < 60.0).then_some(degrees + minutes / 60.0)
        }
        4 => {
            let (rest, seconds) = split(number);
            let (degrees, minutes) = split(rest);
            (minutes < 60.0 && seconds < 60.0).then_some(degrees + minutes / 60.0 + seconds / 3600.0)
        }
        _ => None,
    }
}

/// A part of a text with hemispheres.
#[derive(Clone, Copy)]
enum Token {
    /// A number, and the digits before its point.
    Number(f64, usize),
    Letter(char),
}

/// `48 51.4 N 2 17.7 E`, `N48°51'24" E2°17'42"`, `4851.4N 00217.7E`.
fn of_hemispheres(text: &str) -> Option<Written> {
    let tokens = tokens(text)?;
    let letters: Vec<usize> = (0..tokens.len()).filter(|at| matches!(tokens.get(*at), Some(Token::Letter(_)))).collect();
    let [first, second] = *letters else { return None };
    let leads = first == 0;
    let cut = if leads { second } else { first + 1 };
    let (one, other) = tokens.split_at_checked(cut)?;
    let (one, other) = (of_half(one, leads)?, of_half(other, leads)?);
    let deg = match (one, other) {
        ((true, lat), (false, lon)) | ((false, lon), (true, lat)) => [lat, lon],
        _ => return None,
    };
    Some(Written { deg, ordered: true, by_itself: true })
}

/// One coordinate, whether it has the letter of a latitude or a longitude, where it has a letter: `48.857° N`, `N48 51.4`, `48°51'24"`; a bare
/// number is one too \[deg\].
#[must_use]
pub fn of_coordinate(text: &str) -> Option<f64> {
    let text = text.trim();
    let text = UNITS.iter().find_map(|unit| text.strip_suffix(unit)).unwrap_or(text).trim_end();
    if let Some(plain) = number(text).or_else(|| with_comma(text)) {
        return Some(plain);
    }
    let (body, sign) = text.strip_prefix('-').map_or((text, 1.0), |body| (body, -1.0));
    let tokens = if text.len() <= LONGEST { tokens(body)? } else { return None };
    let letter = |at: Option<&Token>| matches!(at, Some(Token::Letter(_)));
    let deg = match (letter(tokens.first()), letter(tokens.last())) {
        (leads, trails) if leads != trails => of_half(&tokens, leads)?.1,
        (false, false) if body.contains(['°', 'º']) => {
            let northern: Vec<Token> = tokens.into_iter().chain([Token::Letter('N')]).collect();
            of_half(&northern, false)?.1
        }
        _ => return None,
    };
    Some(sign * deg)
}

/// Words of a unit behind a coordinate, the longer ones first.
const UNITS: [&str; 4] = ["degrees", "degree", "degs", "deg"];

/// A number with a comma in the place of its point, and two digits behind it at least: one with fewer may be two numbers.
fn with_comma(text: &str) -> Option<f64> {
    let (whole, part) = text.split_once(',')?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let plain = digits(whole.strip_prefix('-').unwrap_or(whole)) && digits(part) && part.len() > 1;
    plain.then(|| number(&format!("{whole}.{part}"))).flatten()
}

fn tokens(text: &str) -> Option<Vec<Token>> {
    let (mut tokens, mut rest) = (Vec::new(), text);
    while let Some(c) = rest.chars().next() {
        if c.is_ascii_digit() {
            let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
            let (digits, behind) = rest.split_at_checked(end)?;
            tokens.push(Token::Number(number(digits)?, digits.split('.').next()?.len()));
            rest = behind;
            continue;
        }
        match c.to_ascii_uppercase() {
            letter @ ('N' | 'S' | 'E' | 'W') => tokens.push(Token::Letter(letter)),
            ' ' | '\t' | ',' | ';' | '/' | ':' | '_' | '°' | 'º' | '\'' | '’' | '′' | '"' | '”' | '″' => {}
            _ => return None,
        }
        rest = rest.get(c.len_utf8()..)?;
    }
    (tokens.len() <= 8).then_some(tokens)
}

/// Whether a coordinate is a latitude, and its degrees; its letter stands before or behind its numbers.
fn of_half(tokens: &[Token], leads: bool) -> Option<(bool, f64)> {
    let (letter, numbers) = if leads { tokens.split_first()? } else { tokens.split_last()? };
    let Token::Letter(letter) = *letter else { return None };
    let is_latitude = matches!(letter, 'N' | 'S');
    let value = match *numbers {
        [Token::Number(one, digits)] => packed(one, if digits > 5 { 4 } else { 2 * usize::from(digits > 3) })?,
        [Token::Number(degrees, _), Token::Number(minutes, _)] if minutes < 60.0 => degrees + minutes / 60.0,
        [Token::Number(degrees, _), Token::Number(minutes, _), Token::Number(seconds, _)] if minutes < 60.0 && seconds < 60.0 => {
            degrees + minutes / 60.0 + seconds / 3600.0
        }
        _ => return None,
    };
    Some((is_latitude, if matches!(letter, 'S' | 'W') { -value } else { value }))
}

/// Two numbers with a point, in brackets or without, and a height at most.
fn of_pair(text: &str) -> Option<Written> {
    let inside = text.trim_start_matches(['[', '(', ' ']).trim_end_matches([']', ')', ' ']);
    let words: Vec<&str> = inside.split([' ', '\t', ',', ';']).filter(|each| !each.is_empty()).collect();
    let ([first, second] | [first, second, _]) = *words else { return None };
    let both = [first, second].into_iter().all(|each| each.contains('.'));
    let height = words.get(2).is_none_or(|each| number(each).is_some());
    (both && height).then_some(Written { deg: [number(first)?, number(second)?], ordered: false, by_itself: false })
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(text: &str, [lat, lon]: [f64; 2]) -> bool {
        let Some(written) = of_text(text) else { return false };
        written.places_rad().any(|place| (place[0].to_degrees() - lat).abs() < 1e-3 && (place[1].to_degrees() - lon).abs() < 1e-3)
    }

    #[test]
    fn a_place_is_read_in_every_form() {
        // 51.4 minutes are 0.85667 degrees, 17.7 are 0.295.
        let paris = [48.856_67, 2.295];
        for text in [
            "+48.85667+002.295/",
            "+4851.4+00217.7/",
            "+485124+0021742+35.0/",
            "+48.85667+002.295+35CRSWGS_84/",
            "48 51.4 N 2 17.7 E",
            "N48°51.4' E002°17.7'",
            "48°51'24\"N, 2°17'42\"E",
            "2 17.7 E 48 51.4 N",
            "4851.400N 00217.700E",
            "485124N 0021742E",
            "48.85667N 2.295E",
            "POINT(2.295 48.85667)",
            "SRID=4326;POINT(2.295 48.85667)",
            "srid=4326; Point Z (2.295 48.85667 35)",
        ] {
            assert!(near(text, paris) && of_text(text).unwrap().by_itself, "{text}");
        }
        for text in ["48.85667,2.295", "[2.295, 48.85667]", "(48.85667; 2.295; 35)"] {
            assert!(near(text, paris) && !of_text(text).unwrap().by_itself, "{text}");
        }
        assert!(near("+48.85667-002.295/", [48.856_67, -2.295]) && near("33 51.4 S 151 12.0 E", [-33.856_67, 151.2]));
    }

    #[test]
    fn one_coordinate_is_read_in_every_form() {
        for (text, deg) in [
            ("48.85667", 48.856_67),
            (" -48.5 ", -48.5),
            ("48.85667 N", 48.856_67),
            ("48.85667° N", 48.856_67),
            ("N48.85667", 48.856_67),
            ("S 48 51.4", -48.856_67),
            ("48°51'24\"", 48.856_67),
            ("-48°51.4'", -48.856_67),
            ("4851.400N", 48.856_67),
            ("00217.700W", -2.295),
            ("48.85667 deg", 48.856_67),
            ("-48.5 degrees", -48.5),
            ("48,85667", 48.856_67),
            ("-48,50", -48.5),
        ] {
            assert!(of_coordinate(text).is_some_and(|read| (read - deg).abs() < 1e-4), "{text}: {:?}", of_coordinate(text));
        }
        for text in ["", "N", "48 51", "12:30:15", "48 N 2 E", "N 48 S", "48°72'", "north", "48,5"] {
            assert!(of_coordinate(text).is_none(), "{text}: {:?}", of_coordinate(text));
        }
    }

    /// The example of the description of geohashes: 57.64911 N, 10.40744 E.
    #[test]
    fn a_geohash_is_the_middle_of_its_cell() {
        let [lat, lon] = of_geohash("u4pruydqqvj").unwrap().deg;
        assert!((lat - 57.64911).abs() < 1e-5 && (lon - 10.40744).abs() < 1e-5, "{lat} {lon}");
        let [lat, lon] = of_geohash("U4PRUY").unwrap().deg;
        assert!((lat - 57.64911).abs() < 0.003 && (lon - 10.40744).abs() < 0.006, "{lat} {lon}");
        for text in ["", "u4pru", "u4pruyaaa", "u4pruydqqvj00", "\u{e9}\u{e9}\u{e9}"] {
            assert!(of_geohash(text).is_none(), "{text}");
        }
    }

    #[test]
    fn another_text_is_no_place() {
        for text in [
            "",
            "N",
            "3C6444",
            "+33 1 42 68 53 00",
            "12:30:15",
            "2024-11-28T20:00:00Z",
            "48.9",
            "1,2",
            "NEWS 1 2",
            "W 12 E",
            "N12 N13",
            "POINT EMPTY",
            "LINESTRING(1 2, 3 4)",
            "POINT(1)",
            "+48.9",
            "+48.9+2.3",
            "48 61.0 N 2 17.7 E",
            "1.5 2.5 x",
            "POINT(\u{e9}",
            "°N°E",
            "+é+é/",
        ] {
            assert!(of_text(text).is_none(), "{text}");
        }
    }
}
