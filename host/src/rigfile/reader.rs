//! A model file while it is read: its tables, keys and numbers, with line and key in every message.

use super::error::RigFileError;
use std::ops::Range;
use toml_edit::{Item, TableLike};

pub(super) type Result<T> = std::result::Result<T, RigFileError>;

pub(super) struct Reader<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Reader<'_> {
    /// A key that means nothing is a typing error more often than not.
    pub(super) fn check_keys(&self, table: &str, keys: &dyn TableLike, known: &[&str]) -> Result<()> {
        match keys.iter().find(|(key, _)| !known.contains(key)) {
            None => Ok(()),
            Some((key, item)) => {
                let span = keys.key(key).and_then(toml_edit::Key::span).or(item.span());
                Err(self.bad(span, &joined(table, key), format!("unknown; known are {}", known.join(", "))))
            }
        }
    }

    pub(super) fn number(&self, item: &Item, name: &str) -> Result<f64> {
        let value = item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
        match value.filter(|value| value.is_finite()) {
            Some(value) => Ok(value),
            None => Err(self.bad(item.span(), name, format!("{} is not a finite number", item.to_string().trim()))),
        }
    }

    pub(super) fn flag(&self, table: &dyn TableLike, table_name: &str, key: &str) -> Result<bool> {
        let Some(item) = table.get(key) else { return Ok(false) };
        item.as_bool().ok_or_else(|| self.bad(item.span(), &joined(table_name, key), "expected true or false".into()))
    }

    pub(super) fn table<'t>(
        &self,
        parent: &'t dyn TableLike,
        parent_name: &str,
        key: &str,
    ) -> Result<&'t dyn TableLike> {
        let name = joined(parent_name, key);
        let item = parent.get(key).ok_or_else(|| self.missing(&format!("[{name}]"), format!("a table [{name}]")))?;
        self.as_table(item, &name)
    }

    pub(super) fn as_table<'t>(&self, item: &'t Item, name: &str) -> Result<&'t dyn TableLike> {
        item.as_table_like().ok_or_else(|| self.bad(item.span(), name, format!("expected a table [{name}]")))
    }

    pub(super) fn bad(&self, span: Option<Range<usize>>, key: &str, problem: String) -> RigFileError {
        RigFileError::Key { file: self.file.to_owned(), line: self.line(span), key: key.to_owned(), problem }
    }

    pub(super) fn missing(&self, key: &str, expected: String) -> RigFileError {
        RigFileError::Missing { file: self.file.to_owned(), key: key.to_owned(), expected }
    }

    pub(super) fn syntax(&self, error: &toml_edit::TomlError) -> RigFileError {
        let line = self.line(error.span());
        RigFileError::Syntax { file: self.file.to_owned(), line, problem: error.message().to_owned() }
    }

    fn line(&self, span: Option<Range<usize>>) -> usize {
        let start = span.map_or(0, |span| span.start.min(self.text.len()));
        1 + self.text.as_bytes()[..start].iter().filter(|byte| **byte == b'\n').count()
    }
}

pub(super) fn joined(table: &str, key: &str) -> String {
    if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") }
}
