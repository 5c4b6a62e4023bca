use super::*;

fn message(digits: &str) -> [u8; LONG] {
    of_line(format!("*{digits};").as_bytes()).unwrap().0
}

/// Frames of the reference numbers, whose encoder knows nothing of this decoder: even, odd, and the place that the two give \[deg\].
const PLACES: [(&str, &str, f64, f64); 12] = [
    ("8d4b100058b500ac528d53a98812", "8d4b100058b50420ea89b38a211c", 49.0096893, 2.5479126),
    ("8d4b100158b5015e89275f2cbdaf", "8d4b100158b505bf18505dc70c37", -33.946106, 151.1772),
    ("8d4b100258b5003622059982c1b5", "8d4b100258b5078a93e218acd2b2", 60.3171844, 24.9633052),
    ("8d4b100358b50001b401aecd382d", "8d4b100358b50401ae01a6692de3", 0.0099792, 0.0200175),
    ("8d4b100458b501aaaa000083bb77", "8d4b100458b504b4a0aaab4c3478", 86.4999847, -120.0),
    ("8d4b100558b503aaaaff95021651", "8d4b100558b507ac17ff962fc148", -0.5000153, 179.9950189),
    ("8d4b100658b501444471c7685280", "8d4b100658b504e989091adffc42", 31.8999939, -106.4000061),
    ("8d4b100758b5007ae35fa1940ad4", "8d4b100758b507df3d463bfe0517", 54.7200165, 17.8599728),
    ("8d4b100858b5011d050ffcdc9107", "8d4b100858b5048fbaede2a0c6e6", 49.6700134, 23.979974),
    ("8d4b100958b503777919515a5922", "8d4b100958b50413597a74686dd1", -54.7999878, -68.2999824),
    ("8d4b100a58b503a4a5e65b012b61", "8d4b100a58b5071da3da32ff30b2", 47.4646912, 8.5492172),
    ("8d4b100b58b502faf22b85d57460", "8d4b100b58b506dd2a8a3d96df30", 10.4703827, -66.6000056),
];

fn half(digits: &str) -> Cpr {
    match squitter(&message(digits)).unwrap().unwrap().content {
        Content::Airborne { cpr, code: 11, .. } => cpr,
        other => panic!("{other:?}"),
    }
}

#[test]
fn two_halves_are_a_place() {
    for (even, odd, lat_deg, lon_deg) in PLACES {
        let fix = half(even).with(half(odd)).unwrap();
        // The reference rounds to seven decimals.
        assert!((fix.lat_deg - lat_deg).abs() < 1e-7 && (fix.lon_deg - lon_deg).abs() < 1e-7, "{even}: {fix:?}");
        // The other half is of the same place, to the steps of the code: 360/60/2^17 degrees of latitude.
        let other = half(odd).with(half(even)).unwrap();
        assert!((other.lat_deg - lat_deg).abs() < 5e-5, "{other:?}");
        assert_eq!(half(even).with(half(even)), None, "two halves of one format");
    }
}

#[test]
fn an_aircraft_that_moves_between_its_halves_may_be_anywhere() {
    // Cases of the reference: the even and the odd half are of places some kilometres apart, and the last half's own place comes out.
    for (even, odd, lat_deg, lon_deg) in [
        ([21_845, 35_499], [4_005, 35_157], 49.000_001, 2.541_094_3),
        ([21_845, 35_499], [4_005, 36_011], 49.000_001, 2.602_820_1),
        ([0, 1_820], [109_271, 123_790], 60.002_063_8, 24.999_978_2),
    ] {
        let of = |odd: bool, [lat, lon]: [u32; 2]| Cpr { odd, lat, lon };
        let fix = of(true, odd).with(of(false, even)).unwrap();
        assert!((fix.lat_deg - lat_deg).abs() < 1e-6 && (fix.lon_deg - lon_deg).abs() < 1e-6, "{fix:?}");
    }
}

#[test]
fn parity_is_that_of_published_messages() {
    // Messages that every introduction to Mode S decodes.
    for digits in ["8D4840D6202CC371C32CE0576098", "8D40621D58C382D690C8AC2863A7", "8D485020994409940838175B284F"] {
        let known = squitter(&message(digits)).unwrap().unwrap();
        assert_eq!(format!("{:06X}", known.address), digits[2..8]);
        for bit in 0..112 {
            let mut turned = message(digits);
            turned[bit / 8] ^= 0x80 >> (bit % 8);
            // A turned bit of the first byte may make another format of it, which has no such parity.
            assert!(bit < 8 || squitter(&turned) == Err(WrongParity), "bit {bit}");
        }
    }
}

#[test]
fn altitude_and_speed_are_those_of_published_messages() {
    let Content::Airborne { pressure_altitude_m, .. } = squitter(&message("8D40621D58C382D690C8AC2863A7")).unwrap().unwrap().content else {
        panic!("no position")
    };
    assert!((pressure_altitude_m.unwrap() - 38_000.0 * 0.3048).abs() < 1e-9);
    let Content::Velocity { ground_speed_mps, ground_track_rad, geometric_less_pressure_m } =
        squitter(&message("8D485020994409940838175B284F")).unwrap().unwrap().content
    else {
        panic!("no velocity")
    };
    // By the texts 159.20 kt, of 8 kt and 159 kt; geometric height 550 ft above the barometric.
    assert!((ground_speed_mps.unwrap() - 8.0_f64.hypot(159.0) * 1852.0 / 3600.0).abs() < 1e-9);
    // By the texts 182.88 degrees: 8 kt to the west, 159 kt to the south.
    assert!((ground_track_rad.unwrap().to_degrees().rem_euclid(360.0) - 182.880_4).abs() < 1e-3);
    assert!((geometric_less_pressure_m.unwrap() - 550.0 * 0.3048).abs() < 1e-9);
}

#[test]
fn the_radius_is_that_of_the_tables() {
    let of = |code, version, a: Option<u8>, b: Option<u8>| {
        let flag = |bit: Option<u8>| bit.map(|bit| bit == 1);
        let contained = containment(code, version, Supplements { a: flag(a), b: flag(b) });
        (contained.category, contained.radius_m.map(|radius| (10.0 * radius).round() / 10.0))
    };
    // Rows of the reference numbers in which decoders differ, or that no table holds.
    assert_eq!(of(13, 2, Some(0), Some(1)), (6, Some(555.6)));
    assert_eq!(of(13, 2, Some(0), Some(0)), (6, Some(926.0)));
    assert_eq!(of(13, 2, Some(1), Some(1)), (6, Some(1111.2)));
    assert_eq!(of(13, 2, Some(1), Some(0)), (6, Some(1111.2)), "in no table: the largest of its code");
    assert_eq!(of(13, 1, None, None), (6, Some(1111.2)), "not heard: the largest that may be meant");
    assert_eq!(of(11, 2, Some(1), Some(0)), (8, Some(185.2)));
    assert_eq!(of(11, 2, Some(1), Some(1)), (9, Some(75.0)));
    assert_eq!(of(16, 2, None, Some(1)), (2, Some(14_816.0)));
    assert_eq!(of(16, 0, None, None), (2, Some(18_520.0)));
    assert_eq!((of(18, 2, None, None), of(22, 2, None, None)), ((0, None), (0, None)));
}

#[test]
fn a_line_is_a_message_or_none() {
    for line in ["*8D4840D6202CC371C32CE0576098;", "@0123456789AB8D4840D6202CC371C32CE0576098;\r", "  *8d4840d6202cc371c32ce0576098; "] {
        assert_eq!(of_line(line.as_bytes()).unwrap().0, message("8D4840D6202CC371C32CE0576098"));
    }
    assert_eq!(of_line(b"*5D4840D6F8DC4E;").unwrap().1, 7);
    for line in [
        "",
        "*;",
        "8D4840D6202CC371C32CE0576098;",
        "*8D4840D6202CC371C32CE05760;",
        "*8D4840D6202CC371C32CE057609G;",
        "*8D4840D6202CC371C32CE0576098",
    ] {
        assert_eq!(of_line(line.as_bytes()), None, "{line}");
    }
}

#[test]
fn no_message_is_a_panic() {
    let mut message = message("8D40621D58C382D690C8AC2863A7");
    for first in 0..=255_u8 {
        for code in 0..=255_u8 {
            (message[0], message[4]) = (first, code);
            // So that the content is read.
            with_parity(&mut message);
            assert!(squitter(&message).is_ok());
        }
    }
    for n in 0..LONG {
        assert_eq!(squitter(&message[..n]), Ok(None));
    }
}
