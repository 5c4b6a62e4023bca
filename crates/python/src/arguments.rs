//! Arguments that need no conversion: plain numbers, and whole arrays of doubles of one leading shape.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyTuple};

/// Axes of an array argument, as `navbound.table.arrays` has them.
const MOST_AXES: usize = 32;
/// Doubles of an array argument, as `navbound.table.arrays` has them in bytes.
const MOST_NUMBERS: usize = 2 << 30;
/// Beyond, not every whole number is a double.
const EXACT_INTEGER: i64 = 1 << 53;

/// An argument as it came.
enum Plain<'py> {
    /// A number, for every item the same.
    Number(f64),
    /// An array of doubles, in order and aligned.
    Array(Bound<'py, PyArrayDyn<f64>>),
}

fn plain<'py>(value: &Bound<'py, PyAny>) -> Option<Plain<'py>> {
    if let Ok(number) = value.cast::<PyFloat>() {
        return Some(Plain::Number(number.value()));
    }
    if let Ok(number) = value.cast_exact::<PyInt>() {
        let whole = number.extract::<i64>().ok()?;
        return (-EXACT_INTEGER..=EXACT_INTEGER).contains(&whole).then_some(Plain::Number(whole as f64));
    }
    // A subclass may hold a mask.
    if !value.is_exact_instance_of::<PyUntypedArray>() {
        return None;
    }
    let array = value.cast::<PyArrayDyn<f64>>().ok()?;
    let fits = array.ndim() <= MOST_AXES && array.len() <= MOST_NUMBERS;
    (fits && array.is_c_contiguous() && array.is_aligned()).then(|| Plain::Array(array.clone()))
}

/// The leading shape, and every argument as one value an item.
type Flat<'py> = (Bound<'py, PyTuple>, Vec<Bound<'py, PyAny>>);

/// What `navbound.table.arrays.flatten` gives, where every argument is a plain number or an array of one common leading shape. None for
/// everything else: what has to be converted, broadcast or refused is the caller's.
#[pyfunction]
fn flatten_plain<'py>(py: Python<'py>, arguments: &Bound<'py, PyDict>) -> PyResult<Option<Flat<'py>>> {
    let mut leading: Option<Vec<usize>> = None;
    let mut seen = Vec::with_capacity(arguments.len());
    for (_, pair) in arguments.iter() {
        let (value, item): (Bound<'py, PyAny>, Bound<'py, PyTuple>) = pair.extract()?;
        let Some(value) = plain(&value) else { return Ok(None) };
        let item: Vec<usize> = if item.is_empty() { Vec::new() } else { item.extract::<Vec<usize>>()? };
        match &value {
            Plain::Number(_) if item.is_empty() => (),
            Plain::Number(_) => return Ok(None),
            Plain::Array(array) => {
                let shape = array.shape();
                let Some(split) = shape.len().checked_sub(item.len()) else { return Ok(None) };
                let (before, own) = shape.split_at(split);
                if own != item || leading.as_deref().is_some_and(|known| known != before) {
                    return Ok(None);
                }
                leading.get_or_insert_with(|| before.to_vec());
            }
        }
        seen.push((value, item));
    }
    let leading = leading.unwrap_or_default();
    let n: usize = leading.iter().product();
    let mut flat = Vec::with_capacity(seen.len());
    for (value, item) in seen {
        flat.push(match value {
            Plain::Number(number) => PyArray1::from_vec(py, vec![number; n]).into_any(),
            Plain::Array(array) if leading.len() == 1 => array.into_any(),
            Plain::Array(array) => array.reshape([&[n], item.as_slice()].concat())?.into_any(),
        });
    }
    Ok(Some((PyTuple::new(py, leading)?, flat)))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(flatten_plain, m)?)
}
