//! Which column holds what.

use crate::refusal::Unreadable;
use crate::time::Scale;

/// The coordinates a file gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// Latitude and longitude in degrees, height.
    Degrees,
    /// Latitude and longitude in degrees, minutes and seconds, height.
    Sexagesimal,
    /// Earth-centred Cartesian coordinates.
    Ecef,
    /// East, north, up from the base station, whose latitude \[rad\], longitude \[rad\] and height \[m\] the header gives.
    Baseline([f64; 3]),
}

/// The columns of a file. Positions count the fields of a row; date and time of day (or week and time of week) are the first two.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Scale of the time columns.
    pub scale: Scale,
    /// The coordinates.
    pub form: Form,
    /// Fields in a row.
    pub n_fields: usize,
    /// First field of the position.
    pub position: usize,
    /// The six signed roots of the covariance: three of the diagonal, then first-second, second-third, third-first, in the order of
    /// the file.
    pub roots: Option<[usize; 6]>,
    /// Quality flag.
    pub quality: Option<usize>,
    /// Number of satellites.
    pub n_sv: Option<usize>,
    /// North and east velocity.
    pub velocity: Option<[usize; 2]>,
    /// Horizontal and vertical protection level, which a kin of the program writes.
    pub levels: Option<[usize; 2]>,
}

/// Fields are separated by blanks, tabs, commas or semicolons, whatever the settings of the writer; none of them occurs inside a field.
pub(super) fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', ',', ';']).filter(|f| !f.is_empty())
}

/// The layout that the last comment line before the data states.
pub(super) fn layout(text: &str) -> Result<Layout, Unreadable> {
    let comments = || text.lines().enumerate().filter(|(_, l)| l.trim_start().starts_with('%'));
    let mut named = comments().filter_map(|(i, l)| {
        // A unit alone belongs to the name before it: 'hpl (m)' is one column.
        let names: Vec<&str> = fields(l.trim_start().trim_start_matches('%')).filter(|name| !name.starts_with('(')).collect();
        Some((i + 1, scale(names.first()?)?, names))
    });
    let (line, scale, names) = named.next().ok_or_else(|| {
        Unreadable::whole("no comment line names the columns (an RTKLIB solution file has one such as '%  GPST  latitude(deg) ...')")
    })?;
    // Files that are joined may have the same header again; another one would give the rows below it another time or other columns.
    if let Some((other, ..)) = named.find(|(_, _, others)| *others != names) {
        return Err(Unreadable::at(other, "another header in the middle of the file: split it there"));
    }
    let base = comments().find_map(|(_, l)| base(l));
    columns(&names, scale, base).map_err(|reason| Unreadable::at(line, reason))
}

fn scale(name: &str) -> Option<Scale> {
    match name {
        "GPST" => Some(Scale::Gps),
        "UTC" => Some(Scale::Utc),
        "JST" => Some(Scale::Jst),
        _ => None,
    }
}

/// Base station of `% ref pos   : 35.1 136.9 104.7`: latitude \[rad\], longitude \[rad\], height \[m\].
fn base(comment: &str) -> Option<[f64; 3]> {
    let (key, value) = comment.split_once(':')?;
    if !key.contains("ref pos") {
        return None;
    }
    let mut numbers = fields(value).map(|f| f.parse::<f64>().ok());
    let (lat, lon, h) = (numbers.next()??, numbers.next()??, numbers.next()??);
    Some([lat.to_radians(), lon.to_radians(), h])
}

fn columns(names: &[&str], scale: Scale, base: Option<[f64; 3]>) -> Result<Layout, String> {
    let form = match names.get(1).copied() {
        Some("latitude(deg)") => Form::Degrees,
        Some("latitude(d'\")") => Form::Sexagesimal,
        Some("x-ecef(m)") => Form::Ecef,
        Some("e-baseline(m)") => {
            Form::Baseline(base.ok_or("coordinates are relative to a base station, but no line '% ref pos : lat lon height' gives it")?)
        }
        other => return Err(format!("the column after the time is '{}', not a known position", other.unwrap_or(""))),
    };
    let rest: [&str; 2] = match form {
        Form::Degrees => ["longitude(deg)", "height(m)"],
        Form::Sexagesimal => ["longitude(d'\")", "height(m)"],
        Form::Ecef => ["y-ecef(m)", "z-ecef(m)"],
        Form::Baseline(_) => ["n-baseline(m)", "u-baseline(m)"],
    };
    if names.get(2..4) != Some(&rest[..]) {
        return Err(format!("the columns after '{}' are not '{}' and '{}'", names[1], rest[0], rest[1]));
    }
    // Date and time of day stand under one name; so do degrees, minutes and seconds.
    let extra = 1 + if form == Form::Sexagesimal { 4 } else { 0 };
    let find = |name: &str| names.iter().position(|n| *n == name).map(|i| i + extra);
    let all = |titles: [&str; 6]| -> Option<[usize; 6]> {
        let mut columns = [0; 6];
        for (slot, name) in columns.iter_mut().zip(titles) {
            *slot = find(name)?;
        }
        Some(columns)
    };
    let roots = match form {
        Form::Degrees | Form::Sexagesimal => all(["sdn(m)", "sde(m)", "sdu(m)", "sdne(m)", "sdeu(m)", "sdun(m)"]),
        Form::Ecef => all(["sdx(m)", "sdy(m)", "sdz(m)", "sdxy(m)", "sdyz(m)", "sdzx(m)"]),
        Form::Baseline(_) => all(["sde(m)", "sdn(m)", "sdu(m)", "sden(m)", "sdnu(m)", "sdue(m)"]),
    };
    Ok(Layout {
        scale,
        form,
        n_fields: names.len() + extra,
        position: 2,
        roots,
        quality: find("Q"),
        n_sv: find("ns"),
        velocity: find("vn(m/s)").zip(find("ve(m/s)")).map(|(n, e)| [n, e]),
        levels: find("hpl").zip(find("vpl")).map(|(h, v)| [h, v]),
    })
}
