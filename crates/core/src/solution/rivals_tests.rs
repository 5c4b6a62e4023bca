use super::*;
use crate::quantity::Metres;
use crate::solution::declared::{Declarations, Doubt};
use crate::solution::surroundings::tests::fix;

fn at(seconds: i64) -> GpsTime {
    GpsTime::from_nanoseconds(seconds * 1_000_000_000)
}

/// Of one constellation, at a height; a metre of standard deviation in each axis.
fn alone(height_m: f64) -> Fix {
    let mut fix = fix(1.0, &[]);
    fix.position.height = Metres::new(height_m);
    fix.used[0] = 0b1_1111_1110;
    fix
}

/// The same with four satellites of another constellation.
fn of_two(height_m: f64) -> Fix {
    let mut fix = alone(height_m);
    fix.used[2] = 0b1_1110;
    fix
}

/// Chi-square of three at 1e-3 is 16.27: sqrt(2 x 16.27) = 5.70 m between two positions of 1 m.
#[test]
fn two_positions_that_contradict_each_other_are_rivals() {
    assert_eq!(alone(10.0).rival(&alone(15.6)), None);
    let way = alone(10.0).rival(&alone(15.8)).unwrap();
    assert!((way - Vector3::new(0.0, 0.0, 5.8)).norm() < 1e-6, "{way}");
    // What does not fit itself is no rival, what cannot be tested is one.
    assert_eq!(alone(10.0).rival(&Fix { consistent: false, ..alone(500.0) }), None);
    assert!(alone(10.0).rival(&Fix { consistent: false, redundancy: 0, ..alone(500.0) }).is_some());
    assert_eq!(alone(10.0).rival(&Fix { consistent: false, redundancy: 0, n_excluded: 2, ..alone(500.0) }), None);
    // Two that agree do not outvote a third.
    assert!(of_two(10.0).rival(&alone(500.0)).is_some());
}

#[test]
fn a_contradiction_stays_until_constellations_agree_or_an_hour_is_over() {
    let way = Some((Constellation::Galileo, Vector3::new(0.0, 0.0, 300.0)));
    // Others that agree say nothing of the one that contradicts them.
    let others = Some((Constellation::BeiDou, Vector3::new(0.0, 0.0, 300.0)));
    let judged = |times: &[(i64, Fix, Option<Rival>)]| {
        let mut declarations = Declarations::default();
        let doubts: Vec<_> = times.iter().map(|(t, f, rival)| declarations.declare(at(*t), &mut f.clone(), None, *rival)).collect();
        doubts
    };
    let (open, none) = (Some(Doubt::ConstellationsContradict), None);
    assert_eq!(judged(&[(0, alone(10.0), way), (1, alone(10.0), None), (3600, alone(10.0), None)]), [open, open, open]);
    assert_eq!(judged(&[(0, alone(10.0), way), (3601, alone(10.0), None)]), [open, none]);
    assert_eq!(judged(&[(0, alone(10.0), way), (1, of_two(10.0), None), (2, alone(10.0), None)]), [open, none, none]);
    assert_eq!(judged(&[(0, of_two(10.0), others), (1, of_two(10.0), None), (2, of_two(10.0), None)]), [open, open, open]);
    // A clock that was set back begins anew.
    assert_eq!(judged(&[(10, alone(10.0), way), (5, alone(10.0), None)]), [open, none]);
}

#[test]
fn the_declared_covariance_reaches_the_rival() {
    let mut fix = alone(10.0);
    let _ = Declarations::default().declare(at(0), &mut fix, None, Some((Constellation::Galileo, Vector3::new(30.0, 40.0, 0.0))));
    let v = fix.covariance.matrix();
    assert_eq!([v[(0, 0)], v[(0, 1)], v[(1, 1)], v[(2, 2)]], [901.0, 1200.0, 1601.0, 1.0]);
}
