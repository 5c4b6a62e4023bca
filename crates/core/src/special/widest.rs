//! Loops over many numbers in the widest instructions that the processor has.

/// Does the work, compiled once for each width. No multiplication is joined with an addition, so the results are the same bits on every
/// processor. What the work calls is compiled for the least width unless it is inlined.
#[inline(always)]
pub(crate) fn widest<T>(work: impl FnOnce() -> T) -> T {
    #[cfg(feature = "std")]
    return pulp::Arch::new().dispatch(work);
    #[cfg(not(feature = "std"))]
    return work();
}
