//! Many flights are the same flights on any number of threads.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use navbound_assess::flights::{COLUMNS, Flights};
use navbound_simulate::Outlook;

fn outlook() -> Outlook {
    Outlook::new(serde_json::from_str(include_str!("../../simulate/tests/scenario.json")).unwrap()).unwrap()
}

fn on(threads: usize, first: u64, count: u64) -> Flights {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| Flights::fly(&outlook(), 3, first, count).unwrap())
}

#[test]
fn results_do_not_depend_on_threads() {
    assert_eq!(on(1, 0, 5), on(2, 0, 5));
}

#[test]
fn a_flight_does_not_depend_on_the_others() {
    let (all, last) = (on(2, 0, 5), on(2, 4, 1));
    for column in &COLUMNS {
        // Bits: a column that a flight does not have is NaN.
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&all.column(column)[4 * 900..]), bits(&last.column(column)), "{}", column.0);
    }
    assert_eq!(last.number(), vec![4; 900]);
    assert_eq!(all.time_ns()[4 * 900..], last.time_ns());
}

#[test]
fn column_names_are_unique() {
    let mut names: Vec<&str> = COLUMNS.iter().map(|c| c.0).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), COLUMNS.len());
}
