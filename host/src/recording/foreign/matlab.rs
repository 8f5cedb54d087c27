//! MATLAB files of versions 5 to 7: every vector is a column of its name, every matrix has its columns numbered.

use super::{refused, text_of};
use crate::recording::error::Fault;
use matfile::{Array, MatFile, NumericData};

/// A matrix with more columns is a picture, not a table.
const MOST_COLUMNS: usize = 64;

pub(super) fn table(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let what = "MATLAB file";
    // The parser panics on some damaged files.
    let parsed = std::panic::catch_unwind(|| MatFile::parse(bytes));
    let parsed =
        parsed.map_err(|_| refused(what, "it is damaged; save it anew: save('swing.mat', 't', 'theta', '-v7')"))?;
    let file = parsed.map_err(|error| {
        refused(what, &format!("it can't be read ({error}); save it anew: save('swing.mat', 't', 'theta', '-v7')"))
    })?;
    let (mut names, mut columns) = (Vec::new(), Vec::new());
    for array in file.arrays().iter().filter(|array| is_table(array)) {
        let numbers = numbers(array.data());
        let n_rows = array.size().iter().copied().max().filter(|_| is_vector(array)).unwrap_or(array.size()[0]).max(1);
        let parts: Vec<&[f64]> = numbers.chunks(n_rows).collect();
        for (idx, part) in parts.iter().enumerate() {
            let number = if parts.len() > 1 { format!(" {}", idx + 1) } else { String::new() };
            names.push(format!("{}{number}", array.name()));
            columns.push(part.to_vec());
        }
    }
    if columns.is_empty() {
        return Err(refused(
            what,
            "it holds no vectors or matrices of numbers; structures, tables and timeseries are not read: save the \
             vectors themselves, save('swing.mat', 't', 'theta', '-v7')",
        ));
    }
    Ok(text_of(&names, &columns))
}

fn is_vector(array: &Array) -> bool {
    array.size().len() == 2 && array.size().contains(&1)
}

/// Scalars are settings, not measurements.
fn is_table(array: &Array) -> bool {
    let size = array.size();
    size.len() == 2 && size.iter().product::<usize>() > 1 && (is_vector(array) || size[1] <= MOST_COLUMNS)
}

/// Numbers of whatever precision; the imaginary part of complex ones is left alone.
fn numbers(data: &NumericData) -> Vec<f64> {
    match data {
        NumericData::Double { real, .. } => real.clone(),
        NumericData::Single { real, .. } => {
            real.iter().map(|x| x.to_string().parse().unwrap_or(f64::from(*x))).collect()
        }
        NumericData::Int8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
        NumericData::UInt64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
    }
}
