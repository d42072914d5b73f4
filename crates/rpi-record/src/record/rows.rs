//! Writes samples as rows: comma-separated, or one JSON object per line.

use std::io::{self, Write};

use serde_json::json;

use rpi_runtime::run::{Channel, Sink, Source};

/// Format of the rows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// `cycle,flow,value` with a header line. Values that contain commas are quoted (RFC 4180).
    Csv,
    /// `{"cycle":0,"flow":"..","value":..}` per line. Numbers and Booleans are JSON values.
    JsonLines,
}

impl Form {
    /// Returns the format for a file name: JSON lines for `.jsonl` and `.ndjson`, otherwise comma-separated.
    #[must_use]
    pub fn of(name: &str) -> Form {
        match name.rsplit_once('.') {
            Some((_, "jsonl" | "ndjson")) => Form::JsonLines,
            _ => Form::Csv,
        }
    }
}

/// Sink that writes each sample as a row.
pub struct Rows<W: Write> {
    out: W,
    form: Form,
    channels: Vec<Channel>,
    /// First error of the writer. Nothing is written after it.
    failed: Option<io::Error>,
}

impl<W: Write> Rows<W> {
    /// Creates a sink and writes the header.
    pub fn new(out: W, form: Form) -> Rows<W> {
        let mut rows = Rows {
            out,
            form,
            channels: Vec::new(),
            failed: None,
        };
        if form == Form::Csv {
            rows.write("cycle,flow,value\n");
        }
        rows
    }

    /// Flushes the writer.
    ///
    /// # Errors
    /// Returns the first error of the writer.
    pub fn finish(mut self) -> io::Result<()> {
        match self.failed {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }

    fn write(&mut self, text: &str) {
        if self.failed.is_none() {
            self.failed = self.out.write_all(text.as_bytes()).err();
        }
    }
}

impl<W: Write> Sink for Rows<W> {
    fn channels(&mut self, channels: &[Channel]) {
        self.channels = channels.to_vec();
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let channel = &self.channels[channel];
        if channel.source == Source::Claim {
            return;
        }
        let text = value.map_or("null".to_owned(), |cells| {
            rpi_literal::write(cells, channel.ty)
        });
        let row = match self.form {
            Form::Csv => format!("{tick},{},{}\n", quoted(&channel.name), quoted(&text)),
            Form::JsonLines => {
                let value = serde_json::from_str(&text).unwrap_or(json!(text));
                let row = json!({ "cycle": tick, "flow": channel.name, "value": value });
                format!("{row}\n")
            }
        };
        self.write(&row);
    }
}

/// Quotes a field if necessary.
fn quoted(field: &str) -> String {
    match field.contains([',', '"', '\n']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use rpi_image::Scalar;

    use super::*;

    fn recorded(form: Form) -> String {
        let mut out = Vec::new();
        let mut rows = Rows::new(&mut out, form);
        let channel = |name: &str, scalar: Scalar| Channel {
            name: name.into(),
            ty: scalar.into(),
            source: Source::Command,
        };
        rows.channels(&[channel("a.x", Scalar::Real), channel("v", Scalar::Vector)]);
        rows.sample(0, 3, Some(&[1.5f64.to_bits()]));
        rows.sample(0, 4, None);
        rows.sample(1, 4, Some(&[0, 0, 1f64.to_bits()]));
        rows.finish().unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn rows_are_comma_separated() {
        let text = "cycle,flow,value\n3,a.x,1.5\n4,a.x,null\n4,v,\"{x:0.0,y:0.0,z:1.0}\"\n";
        assert_eq!(recorded(Form::Csv), text);
    }

    #[test]
    fn lines_are_json_objects() {
        let text = recorded(Form::JsonLines);
        let first: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
        assert_eq!(first, json!({ "cycle": 3, "flow": "a.x", "value": 1.5 }));
        assert!(text.lines().nth(1).unwrap().contains("null"));
    }

    #[test]
    fn the_name_tells_the_form() {
        assert_eq!(Form::of("a.jsonl"), Form::JsonLines);
        assert_eq!(Form::of("a.csv"), Form::Csv);
        assert_eq!(Form::of("a"), Form::Csv);
    }
}
