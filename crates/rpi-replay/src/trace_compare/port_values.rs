//! Computed and recorded values at the ports of the net.

use rpi_net::{Input, PortRef};

use super::angles::AngleKind;
use super::comparison_plan::OutPort;
use super::engine::Replay;
use super::relation::ComparisonKind;
use super::trace_view::RecordedValue;

impl Replay<'_> {
    /// Returns the recorded value of an out-port of the net in this cycle.
    pub(super) fn recorded(&self, port: PortRef) -> RecordedValue {
        let OutPort {
            recorded, signal, ..
        } = self.plan.out_port(port);
        self.view.out_port(*recorded, signal.ty)
    }

    /// Returns the computed value of an out-port in this cycle; `None` if it is absent or its fragment is inactive.
    pub(super) fn computed(&self, port: PortRef) -> Option<&[u64]> {
        let out = self.plan.out_port(port);
        let active = self.machine.is_active(out.fragment);
        self.machine.value(out.signal).filter(|_| active)
    }

    /// Returns the recorded value of an out-port in the previous cycle as text, for the report.
    pub(super) fn previous_value_text(&self, port: PortRef) -> String {
        let recorded = self.plan.out_port(port).recorded;
        let text = recorded.and_then(|p| self.view.previous_text(p));
        format!("{} in the previous cycle", text.unwrap_or("null"))
    }

    /// Returns the memory words of the value that an input reads in this cycle; `None` if it is absent.
    pub(super) fn input_value<'s>(&'s self, input: &'s Input) -> Option<&'s [u64]> {
        match input {
            Input::Unconnected => None,
            Input::Const(value) => Some(value.slots()),
            Input::Port(port) => self.computed(*port),
        }
    }

    /// Returns the full name of an out-port, `path.port`.
    pub(super) fn port_name(&self, port: PortRef) -> String {
        let path = &self.plan.nodes[port.node.index()].path;
        let outs = self.net.node(port.node).desc().outputs;
        format!("{path}.{}", outs[usize::from(port.port)].name)
    }

    pub(super) fn comparison(&self, port: PortRef) -> ComparisonKind {
        match self.plan.out_port(port).measure {
            AngleKind::Plain => ComparisonKind::Plain,
            AngleKind::Angle => ComparisonKind::Angle,
            AngleKind::Euler(middle) => {
                let middle = PortRef {
                    port: middle as u8,
                    ..port
                };
                match self.recorded(middle) {
                    RecordedValue::Value(cells) => ComparisonKind::Euler(f64::from_bits(cells[0])),
                    _ => ComparisonKind::Angle,
                }
            }
        }
    }

    /// Returns how the values of a port that only shows the value of `source` are compared. Euler angles need no
    /// special case, because the source was already replaced by the recorded angle.
    pub(super) fn alias_comparison(&self, source: &Input) -> ComparisonKind {
        match source {
            Input::Port(port) if self.plan.out_port(*port).measure != AngleKind::Plain => {
                ComparisonKind::Angle
            }
            _ => ComparisonKind::Plain,
        }
    }
}
