//! The RNP-state classifier over many epochs.

use crate::parallel;
use navbound_core::monitor::state::{PerState, StateTable, decide};
use navbound_core::quantity::{Metres, OutOfDomain};

/// Epochs in one task of the pool: enough work to be worth the hand-over.
const EPOCHS_PER_TASK: usize = 4096;

/// One row of states per epoch, row after row, from a formula of one epoch.
pub fn rows(n: usize, table: &StateTable, formula: impl Fn(usize) -> PerState + Sync) -> Vec<f64> {
    let n_states = table.n_states();
    let mut out = vec![0.0; n * n_states];
    parallel::fill(&mut out, EPOCHS_PER_TASK * n_states, |first, some| {
        for (row, slot) in (first / n_states..).zip(some.chunks_mut(n_states)) {
            slot.copy_from_slice(&formula(row)[..n_states]);
        }
    });
    out
}

/// The same for a formula that may refuse; the first refusal and its row.
///
/// # Errors
/// The formula's own, with the row.
pub fn try_rows(
    n: usize,
    table: &StateTable,
    formula: impl Fn(usize) -> Result<PerState, OutOfDomain>,
) -> Result<Vec<f64>, (usize, OutOfDomain)> {
    let mut out = Vec::with_capacity(n * table.n_states());
    for row in 0..n {
        out.extend_from_slice(&formula(row).map_err(|e| (row, e))?[..table.n_states()]);
    }
    Ok(out)
}

/// Decisions: the most likely guarded state where the table is ordered, otherwise the threshold rule.
pub fn classes(table: &StateTable, ordered: bool, nse_m: &[f64], prior: &PerState) -> Vec<i64> {
    let class = |row: usize| {
        let nse = Metres::new(nse_m[row]);
        let class = if ordered { decide(table, &table.ln_posterior(nse, prior), nse) } else { table.threshold_class(nse) };
        class as i64
    };
    parallel::map(nse_m.len(), EPOCHS_PER_TASK, class)
}

/// Probabilities epoch by epoch, each remembering the one before.
///
/// # Errors
/// [`OutOfDomain`] unless `0 <= stay <= 1`.
pub fn remembered(table: &StateTable, nse_m: &[f64], stay: f64, prior: &PerState) -> Result<Vec<f64>, OutOfDomain> {
    let mut state = *prior;
    let mut out = Vec::with_capacity(nse_m.len() * table.n_states());
    for x in nse_m {
        let after = table.remember(&state, stay, Metres::new(*x))?;
        out.extend_from_slice(&after[..table.n_states()]);
        // A lost error says nothing: its row is NaN, and what was known before it stands.
        if !after[0].is_nan() {
            state = after;
        }
    }
    Ok(out)
}
