//! Which of a file's times are out of order.

/// Positions of the most values that rise, in their order; `strict` where no two may be equal. One value that runs ahead is at fault
/// itself, not all those after it.
pub(crate) fn most_rising<T: Ord>(values: &[T], strict: bool) -> Vec<usize> {
    // The last of the best chain of each length, and the one before each.
    let (mut last, mut before): (Vec<usize>, Vec<Option<usize>>) = (Vec::new(), Vec::with_capacity(values.len()));
    for (k, value) in values.iter().enumerate() {
        let length = last.partition_point(|i| if strict { values[*i] < *value } else { values[*i] <= *value });
        before.push(length.checked_sub(1).map(|l| last[l]));
        if length == last.len() {
            last.push(k);
        } else {
            last[length] = k;
        }
    }
    let mut chain: Vec<usize> = std::iter::successors(last.last().copied(), |k| before[*k]).collect();
    chain.reverse();
    chain
}

#[cfg(test)]
mod tests {
    use super::most_rising;

    #[test]
    fn one_that_runs_ahead_or_behind_is_left_out_alone() {
        assert_eq!(most_rising(&[1, 2, 90, 3, 4], true), [0, 1, 3, 4]);
        assert_eq!(most_rising(&[5, 6, 1, 7], true), [0, 1, 3]);
        assert_eq!(most_rising(&[1, 2, 2, 3], true).len(), 3);
        assert_eq!(most_rising(&[1, 2, 2, 3], false), [0, 1, 2, 3]);
        assert!(most_rising::<i64>(&[], true).is_empty());
    }
}
