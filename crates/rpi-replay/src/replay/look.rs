//! Computed and recorded values at the ports of the net.

use rpi_net::{Input, PortRef};

use super::angles::Measure;
use super::engine::Replay;
use super::plan::Out;
use super::recorded::Recorded;
use super::relation::Nature;

impl Replay<'_> {
    /// Returns the recorded value of an out-port in this cycle.
    pub(super) fn recorded(&self, port: PortRef) -> Recorded {
        let Out {
            recorded, signal, ..
        } = self.plan.out(port);
        self.view.out_port(*recorded, signal.ty)
    }

    /// Returns the computed value of an out-port in this cycle; `None` if it is absent or its fragment is inactive.
    pub(super) fn computed(&self, port: PortRef) -> Option<&[u64]> {
        let out = self.plan.out(port);
        let active = self.machine.is_active(out.fragment);
        self.machine.value(out.signal).filter(|_| active)
    }

    /// Returns the recorded value of an out-port in the previous cycle as text.
    pub(super) fn before(&self, port: PortRef) -> String {
        let recorded = self.plan.out(port).recorded;
        let text = recorded.and_then(|p| self.view.before(p));
        format!("{} in the previous cycle", text.unwrap_or("null"))
    }

    /// Returns the value at an input.
    pub(super) fn input<'s>(&'s self, input: &'s Input) -> Option<&'s [u64]> {
        match input {
            Input::Open => None,
            Input::Const(value) => Some(value.cells()),
            Input::Port(port) => self.computed(*port),
        }
    }

    /// Returns the name of an out-port, `path.port`.
    pub(super) fn name(&self, port: PortRef) -> String {
        let path = &self.plan.nodes[port.node.index()].path;
        let outs = self.net.node(port.node).desc().outputs;
        format!("{path}.{}", outs[usize::from(port.port)].name)
    }

    pub(super) fn nature(&self, port: PortRef) -> Nature {
        match self.plan.out(port).measure {
            Measure::Plain => Nature::Plain,
            Measure::Angle => Nature::Angle,
            Measure::Euler(middle) => {
                let middle = PortRef {
                    port: middle as u8,
                    ..port
                };
                match self.recorded(middle) {
                    Recorded::Value(cells) => Nature::Euler(f64::from_bits(cells[0])),
                    _ => Nature::Angle,
                }
            }
        }
    }

    /// Returns how an alias is compared. Euler angles need no special case, because the source was already replaced by
    /// the recorded angle.
    pub(super) fn alias_nature(&self, source: &Input) -> Nature {
        match source {
            Input::Port(port) if self.plan.out(*port).measure != Measure::Plain => Nature::Angle,
            _ => Nature::Plain,
        }
    }
}
