use super::*;
use proptest::prelude::*;

const YUMA: &str = "******** Week 866 almanac for PRN-01 ********
ID:                         01
Health:                     000
Eccentricity:               0.5221366882E-002
Time of Applicability(s):  589824.0000
Orbital Inclination(rad):   0.9637857480
Rate of Right Ascen(r/s):  -0.7897471819E-008
SQRT(A)  (m 1/2):           5153.602051
Right Ascen at Week(rad):  -0.1159458779E+001
Argument of Perigee(rad):   0.451712027
Mean Anom(rad):            -0.2105941778E+001
Af0(s):                     0.1621246338E-004
Af1(s/s):                   0.0000000000E+000
week:                        866

";
const SEM: &str = " 1  CURRENT.ALM
 866 589824

1
63
0
 5.221366882E-03  6.78253175144E-03 -2.51384335585E-09
 5.153602051E+03 -3.69067191978E-01  1.43784403902E-01
-6.70342087665E-01  1.621246338E-05  0.0
0
11
";

#[test]
fn yuma_and_sem_say_the_same() {
    let [y] = read(YUMA.as_bytes()).unwrap()[..] else { panic!("one satellite") };
    let [s] = read(SEM.as_bytes()).unwrap()[..] else { panic!("one satellite") };
    assert_eq!((y.satellite, y.health, y.week, y.time_of_week_s), (s.satellite, s.health, s.week, s.time_of_week_s));
    // The SEM text above is the YUMA one divided by pi to twelve digits: angles agree to some 1e-11 rad.
    let pairs = [
        (y.elements.node.rad(), s.elements.node.rad()),
        (y.elements.perigee.rad(), s.elements.perigee.rad()),
        (y.elements.mean_anomaly.rad(), s.elements.mean_anomaly.rad()),
        (y.elements.node_rate_radps * 1e6, s.elements.node_rate_radps * 1e6),
    ];
    for (a, b) in pairs {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
    assert!((y.elements.inclination.rad() - 0.963_785_748).abs() < 1e-15);
    // 0.3 semicircles and the offset.
    assert!((s.elements.inclination.rad() - 0.963_785_748).abs() < 1e-10);
}

/// IS-GPS-200: the week counter has ten bits and began anew on 1999-08-22 and 2019-04-07 (weeks 1024 and 2048).
#[test]
fn a_rolled_over_week_is_the_one_nearest_to_a_known_time() {
    let week = |full: i64| GpsTime::from_nanoseconds(full * 604_800_000_000_000);
    // 2019-01-06 is the first day of week 2035, which is sent as 1011; 2019-04-07 of week 2048, sent as 0.
    assert_eq!(reference(1011, 0.0, Some(week(2035))), Some(week(2035)));
    assert_eq!(reference(1011, 0.0, Some(week(2050))), Some(week(2035)));
    assert_eq!(reference(0, 0.0, Some(week(2047))), Some(week(2048)));
    assert_eq!(reference(1023, 0.0, Some(week(2048))), Some(week(2047)));
    // The files at hand: 377 in 2006 (1401), 866 in 2016 (1890).
    assert_eq!(reference(377, 0.0, Some(week(1400))), Some(week(1401)));
    assert_eq!(reference(866, 589_824.0, Some(week(1891))).map(|t| t.nanoseconds() / 604_800_000_000_000), Some(1890));
    assert_eq!(reference(866, 0.0, None), None);
    assert_eq!(reference(2035, 0.0, None), Some(week(2035)));
    assert_eq!(reference(2035, 0.0, Some(week(100))), Some(week(2035)));
}

/// A week's end may lie between two times of one almanac; a week that is wrong by one, or by the ten bits' turn less one, may not.
#[test]
fn entries_of_another_week_than_most_are_put_aside() {
    let of = |number: u32, week: i64, time_s: f64| {
        let text = YUMA.replace("ID:                         01", &format!("ID: {number:02}"));
        text.replace("week:                        866", &format!("week: {week}")).replace("589824.0000", &format!("{time_s:.4}"))
    };
    let split = |rows: &[(u32, i64, f64)]| {
        let text: String = rows.iter().map(|(number, week, time_s)| of(*number, *week, *time_s)).collect();
        let (kept, aside) = of_one_time(read(text.as_bytes()).unwrap());
        let numbers = |entries: Vec<Entry>| entries.iter().map(|entry| entry.satellite.number).collect::<Vec<_>>();
        (numbers(kept), numbers(aside))
    };
    assert_eq!(split(&[(1, 866, 589_824.0), (2, 866, 589_824.0), (3, 867, 589_824.0)]), (vec![1, 2], vec![3]));
    assert_eq!(split(&[(1, 866, 589_824.0), (2, 867, 4096.0), (3, 866, 503_808.0)]), (vec![1, 2, 3], vec![]));
    assert_eq!(split(&[(1, 1023, 589_824.0), (2, 0, 4096.0), (3, 866, 4096.0)]), (vec![1, 2], vec![3]));
    assert_eq!(split(&[(1, 866, 0.0), (2, 900, 0.0)]), (vec![1], vec![2]));
    assert_eq!(split(&[(1, 866, 589_824.0), (2, 866, 147_456.0), (3, 866, 589_824.0)]), (vec![1, 3], vec![2]));
}

#[test]
fn damage_is_refused_with_line_and_field() {
    for (from, to, line, field) in [
        ("5153.602051", "51x3.602051", 8, "sqrt(a)"),
        ("5153.602051", "51.602051", 2, "sqrt(A)"),
        ("Mean Anom", "Meal Anom", 11, "mean anom"),
        ("589824.0000", "689824.0000", 2, "time of applicability"),
        ("0.5221366882E-002", "0.5221366882E+002", 2, "eccentricity"),
    ] {
        let e = read(YUMA.replace(from, to).as_bytes()).unwrap_err();
        assert_eq!((e.line, e.field.as_deref()), (Some(line), Some(field)), "{e}");
    }
    assert!(read(&YUMA.as_bytes()[..YUMA.find("Mean").unwrap()]).unwrap_err().reason.contains("ends early"));
    assert!(read(format!("{YUMA}{YUMA}").as_bytes()).unwrap_err().reason.contains("twice"));
    assert!(read(SEM.replacen(" 1 ", " 2 ", 1).as_bytes()).unwrap_err().reason.contains("announces 2"));
    assert!(read(b"%PDF-1.4").is_err() && read(b"").is_err() && read(b"******").is_err());
}

proptest! {
    #[test]
    fn any_bytes_get_an_answer(tail in proptest::collection::vec(any::<u8>(), 0..300), cut in 0..700_usize) {
        for text in [YUMA, SEM] {
            let _ = read(&[&text.as_bytes()[..cut.min(text.len())], &tail].concat());
        }
        let _ = read(&tail);
    }
}
