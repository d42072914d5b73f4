//! XML view of a net: fragments, modules, parameters and the source of each port.

use rpi_net::rpinet::value_text;
use rpi_net::{FragmentId, FragmentTree, Input, Item, Net, NodeId};

use super::xml::XmlWriter;

/// Returns the XML page of a net: fragments, modules (primitives), parameters, and the source of each port by its full
/// path.
pub(crate) fn page(net: &Net) -> String {
    let mut xml = XmlWriter::new("rpinet");
    let mut writer = Writer {
        net,
        tree: FragmentTree::new(net),
        xml: &mut xml,
    };
    writer.fragment(FragmentId::ROOT);
    xml.finish()
}

struct Writer<'a> {
    net: &'a Net,
    tree: FragmentTree,
    xml: &'a mut XmlWriter,
}

impl Writer<'_> {
    /// Writes a fragment with its contents, including nested fragments. The recursion is bounded, as the compiler
    /// limits the nesting of fragments.
    fn fragment(&mut self, id: FragmentId) {
        let own = self.net.fragment(id);
        self.xml.begin("fragment", &[("id", &own.name)]);
        for port in &own.inputs {
            self.link("inport", &port.name, &port.source);
        }
        for item in self.tree.items(id) {
            match item {
                Item::Node(id) => self.module(id),
                Item::Fragment(id) => self.fragment(id),
            }
        }
        for port in &own.outputs {
            self.link("outport", &port.name, &port.source);
        }
        self.xml.end();
    }

    fn module(&mut self, id: NodeId) {
        let node = self.net.node(id);
        let desc = node.desc();
        self.xml
            .begin("module", &[("id", &node.name), ("type", desc.name)]);
        for (param, value) in desc.params.iter().zip(&node.params) {
            let about = [("name", param.name), ("value", &value_text(value))];
            self.xml.leaf("parameter", &about, "");
        }
        for (port, source) in desc.inputs.iter().zip(&node.inputs) {
            self.link("port", port.name, source);
        }
        self.xml.end();
    }

    /// Writes a port and its source: another port or a constant. An unconnected port is left out.
    fn link(&mut self, kind: &'static str, name: &str, source: &Input) {
        let (key, value) = match source {
            Input::Unconnected => return,
            Input::Const(value) => ("value", value_text(value)),
            Input::Port(port) => {
                let node = self.net.node(port.node);
                let output = node.desc().outputs[usize::from(port.port)].name;
                let path = self.net.path(node.fragment, &node.name);
                ("from", format!("{path}.{output}"))
            }
        };
        self.xml.leaf(kind, &[("name", name), (key, &value)], "");
    }
}
