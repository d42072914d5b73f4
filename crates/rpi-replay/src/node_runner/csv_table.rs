//! Tables of samples as comma-separated text (RFC 4180): a header of flow names, a row per cycle.

use std::fmt;

use rpi_net::Column;

/// Byte order mark that some programs write at the start of a UTF-8 file.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Error: a table of samples cannot be read.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TableError {
    /// Line number, from 1.
    pub line: usize,
    /// Description of the error.
    pub message: String,
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.line, self.message)
    }
}

impl std::error::Error for TableError {}

/// Reader of a table of samples, which assigns the fields of its rows to the in-ports of a node.
#[derive(Clone, Debug)]
pub struct TableReader<'c> {
    columns: &'c [Column],
    /// For each column that the node needs, the index of its field in a row of the table.
    fields: Vec<usize>,
    width: usize,
}

impl<'c> TableReader<'c> {
    /// Creates a reader of a table with this header line. `columns` are the columns that the node needs; other fields
    /// are ignored.
    ///
    /// # Errors
    /// Returns an error if an in-port has no field in the header or more than one.
    pub fn new(columns: &'c [Column], header: &str) -> Result<TableReader<'c>, TableError> {
        let names = split_fields(header.trim_start_matches(BYTE_ORDER_MARK));
        let all = |is: &dyn Fn(&str) -> bool| -> Vec<usize> {
            (0..names.len()).filter(|k| is(&names[*k])).collect()
        };
        let field = |column: &Column| {
            let mut found = all(&|name| name == column.key);
            if found.is_empty() {
                let is_key = |name: &str| columns.iter().any(|other| other.key == name);
                let flat = flattened_key(&column.key);
                found = all(&|name| name == flat && !is_key(name));
            }
            match found[..] {
                [k] => Ok(k),
                [] => Err(missing_column_message(&column.key, &names)),
                _ => Err(format!("duplicate column `{}`", column.key)),
            }
        };
        let fields: Result<Vec<usize>, String> = columns.iter().map(field).collect();
        Ok(TableReader {
            columns,
            fields: fields.map_err(|message| TableError { line: 1, message })?,
            width: names.len(),
        })
    }

    /// Returns true if an empty line is a row: the node has a single in-port and its flow may be absent.
    #[must_use]
    pub fn accepts_empty_lines(&self) -> bool {
        self.width == 1 && matches!(self.columns, [column] if column.optional)
    }

    /// Returns the memory words of every column in one row, in the order of the columns; `None` for an absent flow.
    /// `number` is the number of the line, from 1.
    ///
    /// # Errors
    /// Returns an error if a field is missing or is not a valid value of its flow.
    pub fn row(&self, number: usize, text: &str) -> Result<super::ColumnValues, TableError> {
        let bad = |message: String| TableError {
            line: number,
            message,
        };
        let fields = split_fields(text);
        if fields.len() != self.width && !self.columns.is_empty() {
            let (found, width) = (fields.len(), self.width);
            return Err(bad(format!(
                "{}, but the header has {width}",
                rpi_diag::with_noun(found, "field")
            )));
        }
        let cells = |(column, field): (&Column, &usize)| {
            let text = fields.get(*field).map_or("", |field| field.as_str());
            if text.is_empty() && column.optional {
                return Ok(None);
            }
            if text.is_empty() {
                let message = "the field is empty, but this flow is never absent";
                return Err(bad(format!("{}: {message}", column.key)));
            }
            let value = column.parse(text).map(Some);
            value.map_err(|message| bad(format!("{}: {message}", column.key)))
        };
        let row: super::ColumnValues = self
            .columns
            .iter()
            .zip(&self.fields)
            .map(cells)
            .collect::<Result<_, _>>()?;
        match self.partly_present_flow(&row) {
            Some(flow) => Err(bad(format!("flow `{flow}` is only partly present"))),
            None => Ok(row),
        }
    }

    /// Returns the name of a flow of which some columns of the row are present and some absent; `None` if there is
    /// none.
    fn partly_present_flow(&self, row: &super::ColumnValues) -> Option<&'c str> {
        let flows = self.columns.iter().map(|column| flow_of(&column.key));
        let flows = flows.zip(row.iter().map(Option::is_some));
        let beside = flows.clone().zip(flows.skip(1));
        let mut half =
            beside.filter(|((flow, given), (next, other))| flow == next && given != other);
        half.next().map(|((flow, _), _)| flow)
    }
}

/// Returns the name of the flow to which the column with this key belongs: `x` for `x[2].f`.
fn flow_of(key: &str) -> &str {
    key.split(['.', '[']).next().unwrap_or(key)
}

fn missing_column_message(key: &str, names: &[String]) -> String {
    match rpi_diag::suggest(key, names.iter().map(String::as_str)) {
        Some(meant) => format!("no column is called `{key}`; did you mean `{meant}`?"),
        None => format!("no column is called `{key}`"),
    }
}

/// Returns the alternative spelling of a column key: `x[2].f` becomes `x_2_f`, as in Lustre V6.
///
/// [`TableReader::new`] accepts it unless another flow has that name.
fn flattened_key(key: &str) -> String {
    let kept = key.chars().filter(|c| *c != ']');
    let plain = kept.map(|c| if matches!(c, '.' | '[') { '_' } else { c });
    plain.collect()
}

/// Splits a line of comma-separated text into fields. A field in double quotes may contain commas, and `""` for a
/// double quote.
fn split_fields(line: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut quoted = false;
    let mut chars = line.trim_end_matches(['\r', '\n']).chars().peekable();
    while let Some(c) = chars.next() {
        let doubled = quoted && c == '"' && chars.peek() == Some(&'"');
        match (c, quoted, all.last_mut()) {
            ('"', true, Some(field)) if doubled => {
                chars.next();
                field.push('"');
            }
            ('"', ..) => quoted = !quoted,
            (',', false, _) => all.push(String::new()),
            (c, _, Some(field)) => field.push(c),
            _ => {}
        }
    }
    all.iter().map(|field| field.trim().to_owned()).collect()
}

/// Returns the header line of a table with these columns.
pub fn header_line<'c>(columns: impl Iterator<Item = &'c Column>) -> String {
    columns
        .map(|column| quote_field(&column.key))
        .collect::<Vec<_>>()
        .join(",")
}

/// Returns one row of a table as text. The field of an absent flow is empty.
#[must_use]
pub fn row_line(columns: &[&Column], row: &super::ColumnValues) -> String {
    let text = |(column, cells): (&&Column, &Option<Vec<u64>>)| {
        let cells = cells.as_ref();
        cells.map_or_else(String::new, |cells| quote_field(&column.format(cells)))
    };
    let fields: Vec<String> = columns.iter().zip(row).map(text).collect();
    fields.join(",")
}

fn quote_field(field: &str) -> String {
    match field.contains([',', '"']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_image::Scalar;

    fn column(key: &str, ty: Scalar) -> Column {
        Column {
            key: key.to_owned(),
            scalar: ty,
            enum_values: Vec::new(),
            optional: false,
            range: None,
        }
    }

    #[test]
    fn columns_are_found_in_any_order_and_in_both_spellings() {
        let columns = [column("n", Scalar::Int), column("x[0].on", Scalar::Bool)];
        for header in [
            "x[0].on, n, other",
            "x_0_on,n,other",
            "\u{feff}x_0_on,n,other",
        ] {
            let reader = TableReader::new(&columns, header).unwrap();
            assert_eq!(
                reader.row(2, "true,-3,?").unwrap(),
                [Some(vec![(-3i64).cast_unsigned()]), Some(vec![1])]
            );
        }
    }

    #[test]
    fn a_flow_with_the_other_spelling_of_a_part_has_its_own_column() {
        let columns = [column("p.x", Scalar::Int), column("p_x", Scalar::Int)];
        let reader = TableReader::new(&columns, "p_x,p.x").unwrap();
        let wanted = [2, 1].map(|n: i64| Some(vec![n.cast_unsigned()]));
        assert_eq!(reader.row(2, "1,2").unwrap(), wanted);
        let error = TableReader::new(&columns, "p_x").unwrap_err();
        assert!(error.message.contains("no column is called `p.x`"));
    }

    #[test]
    fn a_bad_field_is_told_with_its_line_and_column() {
        let columns = [column("n", Scalar::Int)];
        let reader = TableReader::new(&columns, "n").unwrap();
        let error = reader.row(7, "1.5").unwrap_err().to_string();
        assert_eq!(error, "7: n: `1.5` is not an integer of 64 bits");
        assert!(
            reader
                .row(7, "1,2")
                .unwrap_err()
                .message
                .contains("2 fields")
        );
        let error = TableReader::new(&columns, "m").unwrap_err();
        assert!(error.message.contains("no column is called `n`"));
    }

    #[test]
    fn only_what_may_be_absent_is_left_empty_and_as_a_whole() {
        let optional = |key| Column {
            optional: true,
            ..column(key, Scalar::Int)
        };
        let columns = [optional("p.a"), optional("p.b"), optional("q")];
        let reader = TableReader::new(&columns, "p.a,p.b,q").unwrap();
        let seven = Some(vec![7]);
        assert_eq!(reader.row(2, ",,7").unwrap(), [None, None, seven.clone()]);
        assert_eq!(reader.row(2, "7,7,").unwrap(), [seven.clone(), seven, None]);
        let error = reader.row(2, "7,,7").unwrap_err().to_string();
        assert_eq!(error, "2: flow `p` is only partly present");
        let columns = [column("n", Scalar::Int)];
        let reader = TableReader::new(&columns, "n").unwrap();
        let error = reader.row(3, "").unwrap_err().to_string();
        assert_eq!(
            error,
            "3: n: the field is empty, but this flow is never absent"
        );
    }

    #[test]
    fn fields_with_commas_stand_in_quotes() {
        assert_eq!(split_fields("a,\"b,\"\"c\"\"\""), ["a", "b,\"c\""]);
        assert_eq!(quote_field("b,\"c\""), "\"b,\"\"c\"\"\"");
    }
}
