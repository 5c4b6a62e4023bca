//! One record into the database: which kind it is, and its fields.

use super::field::{Fault, Record, Text, rnp_m};
use super::record::{Airport, Fix, FixName, Gap, Kind, Leg, LevelOfService, PathPoint, Procedure, ProcedureName, Route, Runway};
use super::{Database, FixKey};
use navbound_core::frame::LatLon;

type Done = Result<(), Fault>;

/// The file record number has five digits: 1 comes after 99,999, never 0 (as in the national file of cycle 2604) \[1\].
const RECORD_NUMBERS: u32 = 99_999;
/// A greater step is another place of the numbering and says nothing of lost lines (ours) \[1\].
const MOST_MISSING: u32 = 1000;

/// The procedure, route type and transition that a record belongs to.
type RouteName = (ProcedureName, u8, Text<5>);

/// The record numbers of successive records of procedures.
#[derive(Debug, Clone, Default)]
pub(super) struct Numbering {
    before: Option<(u32, RouteName)>,
    n_consecutive: usize,
    n_gaps: usize,
}

impl Numbering {
    /// What was between the next record and the last one is not known.
    pub(super) fn forget(&mut self) {
        self.before = None;
    }
}

impl Database {
    pub(super) fn insert(&mut self, line: usize, r: Record<'_>) -> Done {
        let (section, column6) = (r.byte(5), r.byte(6));
        let subsection = if matches!(section, b'P' | b'H') && column6 == b' ' { r.byte(13) } else { column6 };
        let airport = r.text::<4>(7);
        let counts = &mut self.counts;
        let count = match (section, subsection) {
            (b'P', b'A') => &mut counts.airports,
            (b'P', b'C') => &mut counts.terminal_waypoints,
            (b'P', b'G') => &mut counts.runways,
            (b'P', b'D') => &mut counts.sids,
            (b'P', b'E') => &mut counts.stars,
            (b'P', b'F') => &mut counts.approaches,
            (b'P', b'P') => &mut counts.path_points,
            (b'E', b'A') => &mut counts.enroute_waypoints,
            (b'D', b' ') => &mut counts.vhf_navaids,
            (b'D', b'B') | (b'P', b'N') => &mut counts.ndbs,
            _ => &mut counts.others,
        };
        *count += 1;
        match (section, subsection) {
            (b'P', b'D' | b'E' | b'F') => self.insert_leg(line, r),
            (b'P', b'P') => self.insert_path_point(line, r),
            _ if !matches!(r.byte(22), b'0' | b'1' | b' ') => Ok(()),
            (b'P', b'A') => self.insert_airport(line, r, airport),
            (b'P', b'C') => self.insert_fix(line, key(*b"PC", airport, r.text(14)), r.place(33, 2)?, None),
            (b'P', b'G') => self.insert_runway(line, r, airport),
            (b'E', b'A') => self.insert_fix(line, key(*b"EA", region(r), r.text(14)), r.place(33, 2)?, None),
            (b'D', b' ') => {
                let place = r.place(33, 2)?.map_or_else(|| r.place(56, 2), |p| Ok(Some(p)))?;
                self.insert_fix(line, key(*b"D ", region(r), four(r)), place, r.variation(75)?)
            }
            (b'D', b'B') => self.insert_fix(line, key(*b"DB", region(r), four(r)), r.place(33, 2)?, r.variation(75)?),
            (b'P', b'N') => self.insert_fix(line, key(*b"PN", airport, four(r)), r.place(33, 2)?, r.variation(75)?),
            _ => Ok(()),
        }
    }

    fn insert_airport(&mut self, line: usize, r: Record<'_>, ident: Text<4>) -> Done {
        let place = r.place(33, 2)?.ok_or_else(no_position)?;
        let record = Airport { line, place, variation_rad: r.variation(52)?, elevation_m: r.feet("elevation", 57, 61)? };
        if self.airports.contains_key(&ident) {
            return Err(twice("airport", ident.as_str()));
        }
        self.airports.insert(ident, record);
        Ok(())
    }

    fn insert_fix(&mut self, line: usize, key: FixKey, place: Option<LatLon>, variation_rad: Option<f64>) -> Done {
        let place = place.ok_or_else(no_position)?;
        if let Some(first) = self.fixes.get_mut(&key) {
            if first.place == place {
                return Ok(());
            }
            first.ambiguous = true;
            return Err(Fault {
                field: "identifier",
                reason: "a second fix of this name has another position",
                text: key.ident.to_string(),
            });
        }
        self.fixes.insert(key, Fix { line, place, variation_rad, ambiguous: false });
        Ok(())
    }

    fn insert_runway(&mut self, line: usize, r: Record<'_>, airport: Text<4>) -> Done {
        let ident = r.text::<5>(14);
        let runway = Runway {
            line,
            length_m: r.feet("runway length", 23, 27)?,
            bearing: r.course("runway bearing", 28)?,
            ellipsoid_height_m: r.metres("ellipsoid height", (61, 66), 10.0)?,
            elevation_m: r.feet("threshold elevation", 67, 71)?,
            displaced_m: r.feet("displaced threshold", 72, 75)?,
            crossing_height_m: r.feet("threshold crossing height", 76, 77)?,
        };
        self.insert_fix(line, key(*b"PG", airport, ident), r.place(33, 2)?, None)?;
        self.runways.entry((airport, ident)).or_insert(runway);
        Ok(())
    }

    fn insert_leg(&mut self, line: usize, r: Record<'_>) -> Done {
        let (name, route_type, transition) = route_of(r).ok_or(Fault { field: "subsection", reason: "none", text: String::new() })?;
        if !matches!(r.byte(39), b'0' | b'1') {
            if r.byte(40) == b'W' {
                let levels = levels(line, r)?;
                self.procedure_mut(line, name).levels.extend(levels);
            }
            return Ok(());
        }
        let leg = leg(line, r)?;
        let route = self.route_mut(line, name, route_type, transition);
        if route.legs.last().is_some_and(|last| last.sequence >= leg.sequence) {
            return Err(Fault { field: "sequence number", reason: "not above that of the leg before", text: leg.sequence.to_string() });
        }
        route.legs.push(leg);
        Ok(())
    }

    /// The route that a refused line belongs to is not whole; a line that names none is counted.
    pub(super) fn mark_route(&mut self, line: usize, r: Record<'_>) {
        if r.byte(5) != b'P' || r.byte(6) != b' ' || !matches!(r.byte(13), b'D' | b'E' | b'F') {
            // A line too short for its subsection may have been a leg.
            self.n_unattributed += usize::from(r.0.len() < 13 && !matches!(r.byte(5), b'D' | b'E'));
            return;
        }
        match route_of(r) {
            Some((name, route_type, transition)) if r.0.len() >= 25 => {
                self.route_mut(line, name, route_type, transition).refused.push(line);
            }
            _ => self.n_unattributed += 1,
        }
    }

    /// Compare the record number with that of the line before, where both are of one procedure: they are consecutive in a whole file.
    pub(super) fn number(&mut self, line: usize, r: Record<'_>) {
        let is_procedure = r.byte(5) == b'P' && r.byte(6) == b' ';
        let number = r.whole("file record number", 124, 128).ok().flatten().and_then(|n| u32::try_from(n).ok());
        let here = number.zip(if is_procedure { route_of(r) } else { None });
        let before = std::mem::replace(&mut self.numbering.before, here);
        let (Some((number, (name, route_type, transition))), Some((number_before, route_before))) = (here, before) else { return };
        if name != route_before.0 {
            return;
        }
        let step = (number + RECORD_NUMBERS - number_before) % RECORD_NUMBERS;
        if step == 1 {
            self.numbering.n_consecutive += 1;
        } else if (2..=MOST_MISSING).contains(&step) {
            self.numbering.n_gaps += 1;
            let inside = route_before == (name, route_type, transition);
            self.route_mut(line, name, route_type, transition).gaps.push(Gap { line, n_missing: step - 1, inside });
        }
    }

    /// Record numbers that are not consecutive in most places number something else.
    pub(super) fn settle_numbering(&mut self) {
        if self.numbering.n_gaps > self.numbering.n_consecutive {
            self.procedures.iter_mut().flat_map(|p| &mut p.routes).for_each(|route| route.gaps.clear());
        }
    }

    fn procedure_mut(&mut self, line: usize, name: ProcedureName) -> &mut Procedure {
        let last = self.procedures.len().checked_sub(1).filter(|i| self.procedures[*i].name == name);
        let index = last.unwrap_or_else(|| *self.by_name.entry(name).or_insert(self.procedures.len()));
        if index == self.procedures.len() {
            self.procedures.push(Procedure { name, line, routes: Vec::new(), levels: Vec::new() });
        }
        &mut self.procedures[index]
    }

    fn route_mut(&mut self, line: usize, name: ProcedureName, route_type: u8, transition: Text<5>) -> &mut Route {
        let routes = &mut self.procedure_mut(line, name).routes;
        let same = |r: &Route| r.route_type == route_type && r.transition == transition;
        let index = routes.iter().rposition(same).unwrap_or(routes.len());
        if index == routes.len() {
            routes.push(Route { route_type, transition, legs: Vec::new(), refused: Vec::new(), gaps: Vec::new() });
        }
        &mut routes[index]
    }

    fn insert_path_point(&mut self, line: usize, r: Record<'_>) -> Done {
        let (airport, approach, runway) = (r.text(7), r.text(14), r.text(20));
        if !matches!(r.byte(27), b'0' | b'1') {
            let height = r.metres("orthometric height", (41, 46), 10.0)?;
            let first = self.path_points.last_mut().filter(|p| p.airport == airport && p.approach == approach);
            let first =
                first.ok_or(Fault { field: "approach", reason: "continuation without its path point", text: approach.to_string() })?;
            (first.orthometric_height_m, first.continuation_line) = (height, Some(line));
            return Ok(());
        }
        self.path_points.push(PathPoint {
            line,
            airport,
            approach,
            runway,
            threshold: r.place(38, 4)?.ok_or_else(no_position)?,
            ellipsoid_height_m: r.metres("ellipsoid height", (61, 66), 10.0)?,
            orthometric_height_m: None,
            continuation_line: None,
            alignment: r.place(71, 4)?,
            glide_angle_rad: r.degrees("glide path angle", (67, 70), 100.0)?,
            course_width_m: r.metres("course width", (94, 98), 100.0)?,
            alert_limits_m: [r.metres("horizontal alert limit", (110, 112), 10.0)?, r.metres("vertical alert limit", (113, 115), 10.0)?],
        });
        Ok(())
    }
}

fn key(section: [u8; 2], scope: Text<4>, ident: Text<5>) -> FixKey {
    FixKey { section: Text::new(core::str::from_utf8(&section).unwrap_or("")), scope, ident }
}

fn region(r: Record<'_>) -> Text<4> {
    Text::new(r.text::<2>(20).as_str())
}

/// An identifier of four characters.
fn four(r: Record<'_>) -> Text<5> {
    Text::new(r.text::<4>(14).as_str())
}

fn no_position() -> Fault {
    Fault { field: "position", reason: "blank", text: String::new() }
}

fn twice(field: &'static str, ident: &str) -> Fault {
    Fault { field, reason: "stands twice in the file", text: ident.to_owned() }
}

fn route_of(r: Record<'_>) -> Option<RouteName> {
    let kind = match r.byte(13) {
        b'D' => Kind::Sid,
        b'E' => Kind::Star,
        b'F' => Kind::Approach,
        _ => return None,
    };
    Some((ProcedureName { airport: r.text(7), kind, ident: r.text(14) }, r.byte(20), r.text(21)))
}

fn name(r: Record<'_>, ident: usize, region: usize, section: usize) -> FixName {
    FixName { ident: r.text(ident), region: r.text(region), section: r.text(section) }
}

/// Four characters a line of minima: `A` and an RNP.
fn levels(line: usize, r: Record<'_>) -> Result<Vec<LevelOfService>, Fault> {
    let mut levels = Vec::new();
    for first in (89..=113).step_by(4) {
        let bytes = r.bytes(first, first + 3);
        if bytes == b"    " {
            break;
        }
        let rnp_m = match bytes {
            [b'A', digits @ ..] => rnp_m(digits),
            _ => None,
        };
        let fault = || Fault { field: "level of service", reason: "not A and an RNP", text: String::from_utf8_lossy(bytes).into_owned() };
        levels.push(LevelOfService { line, rnp_m: rnp_m.ok_or_else(fault)? });
    }
    Ok(levels)
}

fn leg(line: usize, r: Record<'_>) -> Result<Leg, Fault> {
    let sequence = r.whole("sequence number", 27, 29)?;
    let altitude = |first| {
        // A flight level is in hundreds of feet.
        if r.bytes(first, first + 1) == b"FL" {
            return Ok(r.feet("altitude", first + 2, first + 4)?.map(|m| 100.0 * m));
        }
        if r.bytes(first, first + 4).starts_with(b"UNK") {
            return Ok(None);
        }
        r.feet("altitude", first, first + 4)
    };
    Ok(Leg {
        line,
        sequence: sequence.ok_or(Fault { field: "sequence number", reason: "blank", text: String::new() })?,
        fix: name(r, 30, 35, 37),
        description: r.text(40),
        turn: r.byte(44),
        rnp_m: r.rnp(45)?,
        terminator: terminator(r)?,
        navaid: FixName { ident: Text::new(r.text::<4>(51).as_str()), ..name(r, 51, 55, 79) },
        radius_m: r.miles("arc radius", (57, 62), 1000.0)?,
        theta_rad: r.degrees("theta", (63, 66), 10.0)?,
        rho_m: r.miles("rho", (67, 70), 10.0)?,
        course: r.course("course", 71)?,
        course_text: r.text(71),
        extent: r.extent("distance or time", 75)?,
        extent_text: r.text(75),
        altitude_description: r.byte(83),
        altitude_text: [r.text(85), r.text(90)],
        altitude_m: [altitude(85)?, altitude(90)?],
        transition_altitude_text: r.text(95),
        speed_kt: r.whole("speed", 100, 102)?.map(f64::from),
        speed_description: r.byte(118),
        vertical_angle_rad: r.degrees("vertical angle", (103, 106), 100.0)?,
        centre: name(r, 107, 113, 115),
        qualifiers: r.text(119),
    })
}

fn terminator(r: Record<'_>) -> Result<Text<2>, Fault> {
    let text: Text<2> = r.text(48);
    let known = matches!(
        text.as_str(),
        "" | "IF"
            | "TF"
            | "RF"
            | "CF"
            | "DF"
            | "AF"
            | "CA"
            | "CD"
            | "CI"
            | "CR"
            | "FA"
            | "FC"
            | "FD"
            | "FM"
            | "HA"
            | "HF"
            | "HM"
            | "PI"
            | "VA"
            | "VD"
            | "VI"
            | "VM"
            | "VR"
    );
    if known { Ok(text) } else { Err(Fault { field: "path terminator", reason: "none of the 23 of ARINC 424", text: text.to_string() }) }
}
