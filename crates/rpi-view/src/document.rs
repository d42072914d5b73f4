//! Document that the page reads: a head in JSON, then blocks of numbers.
//!
//! ```text
//! "RPIVIEW1", length of the head (u32), head, padding to a multiple of 8, blocks
//! ```
//! All numbers are little-endian. A column of the head names its block by offset from the end of the head. Columns with
//! the same values share a block: set-points and commanded positions are often equal.

use std::collections::BTreeMap;
use std::ops::Range;

use rpi_graph::NetGraph;
use rpi_image::hash::Fnv1a;
use rpi_record::mcap::{ArmGeometry, Column, ColumnKind, FragmentActivity, RunData, TopicColumns};
use serde_json::{Value, json};

use crate::block::{Block, encode};
use crate::net_head::net_head;

/// First bytes of a document.
const MAGIC: &[u8; 8] = b"RPIVIEW1";

/// Precision of the values in a document.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Precision {
    /// The recorded values.
    Exact,
    /// Real values rounded to 2⁻³¹ of the largest magnitude in their column. The document is then small after
    /// compression.
    Rounded,
}

/// What a page shows: a recorded run with the nets of its commands.
#[derive(Clone, Copy, Debug)]
pub struct ViewContent<'a> {
    /// The run.
    pub run: &'a RunData,
    /// Graphs of the nets, or the reason why there are none.
    pub nets: Result<&'a [NetGraph], &'a str>,
    /// Whether the run goes on.
    pub is_live: bool,
}

/// Returns the document of a recorded run.
#[must_use]
pub fn document(content: ViewContent<'_>, precision: Precision) -> Vec<u8> {
    let run = content.run;
    let mut blocks = Blocks::default();
    let topics: Vec<Value> = run
        .topics
        .iter()
        .map(|topic| topic_head(topic, precision, &mut blocks))
        .collect();
    let events: Vec<Value> = run
        .events
        .iter()
        .filter_map(|event| serde_json::from_str(event).ok())
        .collect();
    let head = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "exact": precision == Precision::Exact,
        "tickNs": run.tick_ns,
        "ticks": span(&run.ticks),
        "program": run.program,
        "source": run.source,
        "cell": run.cell,
        "arms": run.arms.iter().map(arm_head).collect::<Vec<_>>(),
        "topics": topics,
        "activity": run.activity.iter().map(activity_head).collect::<Vec<_>>(),
        "events": events,
        "lost": run.lost,
        "cut": run.cut,
        "nets": content.nets.unwrap_or_default().iter().map(net_head).collect::<Vec<_>>(),
        "netsNote": content.nets.err(),
        "live": content.is_live,
    });
    let head = head.to_string();
    let mut out = MAGIC.to_vec();
    out.extend(u32::try_from(head.len()).unwrap_or(0).to_le_bytes());
    out.extend(head.as_bytes());
    pad(&mut out);
    out.extend(blocks.bytes);
    out
}

/// Blocks of a document, each stored once.
#[derive(Default)]
struct Blocks {
    bytes: Vec<u8>,
    /// Offsets of the blocks, by a hash of their bytes.
    offsets: BTreeMap<u64, Vec<Range<usize>>>,
}

impl Blocks {
    /// Returns the offset of a block with these bytes, which is added if there is none.
    fn add(&mut self, bytes: &[u8]) -> usize {
        let same = self
            .offsets
            .entry(Fnv1a::new().with_bytes(bytes).finish())
            .or_default();
        if let Some(known) = same
            .iter()
            .find(|at| self.bytes.get((*at).clone()) == Some(bytes))
        {
            return known.start;
        }
        pad(&mut self.bytes);
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        same.push(start..self.bytes.len());
        start
    }
}

/// Appends zeros up to a multiple of 8, so that the page can read the numbers in place.
fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(8), 0);
}

fn topic_head(topic: &TopicColumns, precision: Precision, blocks: &mut Blocks) -> Value {
    let columns = topic.columns.iter();
    let columns = columns.map(|column| column_head(column, precision, blocks));
    json!({
        "name": topic.name,
        "ticks": topic.ticks.iter().map(span).collect::<Vec<_>>(),
        "columns": columns.collect::<Vec<_>>(),
    })
}

fn column_head(column: &Column, precision: Precision, blocks: &mut Blocks) -> Value {
    let Block {
        form,
        exponent,
        order,
        bytes,
    } = encode(column, precision);
    json!({
        "name": column.name,
        "kind": match column.kind {
            ColumnKind::Bool => "bool",
            ColumnKind::Int => "int",
            ColumnKind::Real => "real",
        },
        "unit": column.unit,
        "absent": column.absent.iter().map(|rows| [rows.start, rows.end]).collect::<Vec<_>>(),
        "rows": column.values.len(),
        "form": form,
        "exponent": exponent,
        "order": order,
        "offset": blocks.add(&bytes),
    })
}

fn span(ticks: &Range<u64>) -> [u64; 2] {
    [ticks.start, ticks.end]
}

fn activity_head(activity: &FragmentActivity) -> Value {
    json!({
        "command": activity.command,
        "id": activity.id,
        "path": activity.path,
        "devices": activity.devices,
        "spans": activity.spans.iter().map(span).collect::<Vec<_>>(),
    })
}

/// Returns the geometry of an arm. A limit that is infinite is `null`.
fn arm_head(arm: &ArmGeometry) -> Value {
    let joints = arm.joints.iter().map(|joint| {
        json!({
            "prismatic": joint.prismatic,
            "point": joint.point,
            "direction": joint.direction,
            "range": joint.range,
            "limits": joint.limits,
        })
    });
    json!({
        "name": arm.name,
        "model": arm.model,
        "base": arm.base,
        "joints": joints.collect::<Vec<_>>(),
        "flange": arm.flange,
        "tool": arm.tool,
        "toolLimits": arm.tool_limits,
    })
}
