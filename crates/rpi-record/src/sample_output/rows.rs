//! Writes samples as rows: comma-separated, or one JSON object per line.

use std::io::{self, Write};

use serde_json::json;

use rpi_runtime::run::{Channel, Sink, Source};

/// Format in which sampled values are written as a table.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SampleFormat {
    /// Comma-separated rows `cycle,flow,value` with a header line. Values that contain commas are quoted (RFC 4180).
    Csv,
    /// One JSON object `{"cycle":0,"flow":"..","value":..}` per line. Numbers and Booleans are JSON values.
    JsonLines,
}

impl SampleFormat {
    /// Returns the format for a file name: JSON lines for `.jsonl` and `.ndjson`, otherwise comma-separated.
    #[must_use]
    pub fn from_file_name(name: &str) -> SampleFormat {
        match name.rsplit_once('.') {
            Some((_, "jsonl" | "ndjson")) => SampleFormat::JsonLines,
            _ => SampleFormat::Csv,
        }
    }
}

/// Sink of samples that writes each sample as a row of a table.
pub struct SampleWriter<W: Write> {
    out: W,
    form: SampleFormat,
    channels: Vec<Channel>,
    /// First error of the output; `None` without an error. Nothing is written after it.
    error: Option<io::Error>,
}

impl<W: Write> SampleWriter<W> {
    /// Creates a sink that writes to `out`, and writes the header if the format has one.
    pub fn new(out: W, form: SampleFormat) -> SampleWriter<W> {
        let mut rows = SampleWriter {
            out,
            form,
            channels: Vec::new(),
            error: None,
        };
        if form == SampleFormat::Csv {
            rows.write("cycle,flow,value\n");
        }
        rows
    }

    /// Flushes the output.
    ///
    /// # Errors
    /// Returns the first error of the output.
    pub fn finish(mut self) -> io::Result<()> {
        match self.error {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }

    fn write(&mut self, text: &str) {
        if self.error.is_none() {
            self.error = self.out.write_all(text.as_bytes()).err();
        }
    }
}

impl<W: Write> Sink for SampleWriter<W> {
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
            SampleFormat::Csv => format!(
                "{tick},{},{}\n",
                quote_field(&channel.name),
                quote_field(&text)
            ),
            SampleFormat::JsonLines => {
                let value = serde_json::from_str(&text).unwrap_or(json!(text));
                let row = json!({ "cycle": tick, "flow": channel.name, "value": value });
                format!("{row}\n")
            }
        };
        self.write(&row);
    }
}

/// Returns a field of a comma-separated row, in quotation marks if it contains a comma, a quotation mark or a line
/// break.
fn quote_field(field: &str) -> String {
    match field.contains([',', '"', '\n']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use rpi_image::Scalar;

    use super::*;

    fn recorded(form: SampleFormat) -> String {
        let mut out = Vec::new();
        let mut rows = SampleWriter::new(&mut out, form);
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
        assert_eq!(recorded(SampleFormat::Csv), text);
    }

    #[test]
    fn lines_are_json_objects() {
        let text = recorded(SampleFormat::JsonLines);
        let first: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
        assert_eq!(first, json!({ "cycle": 3, "flow": "a.x", "value": 1.5 }));
        assert!(text.lines().nth(1).unwrap().contains("null"));
    }

    #[test]
    fn the_name_tells_the_form() {
        assert_eq!(
            SampleFormat::from_file_name("a.jsonl"),
            SampleFormat::JsonLines
        );
        assert_eq!(SampleFormat::from_file_name("a.csv"), SampleFormat::Csv);
        assert_eq!(SampleFormat::from_file_name("a"), SampleFormat::Csv);
    }
}
