//! The module `navbound._core`: arrays in, arrays out. Conversion only, no mathematics.
//!
//! One file a subject, each with a `register`; every refusal of the Rust side becomes a Python error in `error.rs` and nowhere else.

mod algorithms;
mod anp;
mod araim;
mod arguments;
mod batch;
mod dme;
mod ee;
mod error;
mod evaluation;
mod fields;
mod gbas;
mod gnss;
mod ground;
mod ins_consistency;
mod ins_fuse;
mod ins_simulate;
mod judge;
mod kpi;
mod live;
mod live_outputs;
mod methods;
mod orbits;
mod path;
mod positions;
mod procedures;
mod radionav;
mod raim;
mod read;
mod receiver_files;
mod receivers;
mod rnp;
mod rraim;
mod sbas;
mod sbas_fields;
mod sbas_positions;
mod simulate;
mod states;
mod station;
mod status;
mod subsets;
mod surface;
mod tse;
mod vertical;

use pyo3::prelude::*;

#[pymodule]
fn _core(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    // What a panic becomes; the Python package turns it into its own class, which says that it is our bug.
    m.add("PanicException", m.py().get_type::<pyo3::panic::PanicException>())?;
    methods::register(m)?;
    algorithms::register(m)?;
    status::register(m)?;
    tse::register(m)?;
    vertical::register(m)?;
    anp::register(m)?;
    araim::register(m)?;
    arguments::register(m)?;
    raim::register(m)?;
    rnp::register(m)?;
    sbas::register(m)?;
    sbas_positions::register(m)?;
    ee::register(m)?;
    states::register(m)?;
    judge::register(m)?;
    evaluation::register(m)?;
    gnss::register(m)?;
    ground::register(m)?;
    gbas::register(m)?;
    rraim::register(m)?;
    surface::register(m)?;
    ins_fuse::register(m)?;
    ins_consistency::register(m)?;
    kpi::register(m)?;
    live::register(m)?;
    live_outputs::register(m)?;
    dme::register(m)?;
    radionav::register(m)?;
    orbits::register(m)?;
    path::register(m)?;
    receiver_files::register(m)?;
    positions::register(m)?;
    procedures::register(m)?;
    simulate::register(m)?;
    station::register(m)?;
    ins_simulate::register(m)?;
    subsets::register(m)?;
    read::register(m)?;
    receivers::register(m)
}
