//! Fields of a record as entries of a dictionary: the key is the field's name.

/// `fields!(d, record: a, b)` enters `a` and `b` of the record in the dictionary.
macro_rules! fields {
    ($d:expr, $record:ident: $($field:ident),+ $(,)?) => {
        $($d.set_item(stringify!($field), $record.$field)?;)+
    };
}
pub(crate) use fields;
