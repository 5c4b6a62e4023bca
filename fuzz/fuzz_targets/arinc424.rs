//! Navigation databases: no panic in reader, geometry and checks; every refusal has a line of the file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::arinc424::{Route, read};

fuzz_target!(|bytes: &[u8]| {
    let Ok(database) = read(bytes) else { return };
    for refusal in &database.refused {
        assert!((1..=database.n_lines).contains(&refusal.line));
    }
    for procedure in database.procedures() {
        let routes: Vec<&Route> = procedure.routes.iter().collect();
        let built = database.path_of(procedure, &routes, true);
        assert_eq!(built.legs.len(), built.path.legs().len());
    }
    let _ = database.contradictions();
});
