//! Nets as programs: what was recorded as `.rpinet` becomes text that can be read, changed and compiled again.
//!
//! Every primitive becomes one equation and keeps its name where that is one in the language. Plain constants stand
//! where they are used, and operators are written as such where the compiler makes the same primitive of them; so the
//! compiled program is the net again, node by node. This module must not know how a program is checked.

mod ends;
mod names;
mod nodes;
mod operators;
mod order;
mod values;

use rpi_net::{Absent, Activation, FragmentId, Net, NodeId, Restart};
use rpi_syntax::Mode;

use names::Names;

/// A net as a program.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Imported {
    /// The program, one command.
    pub text: String,
    /// For each node that the program names, its path in the net and its path in the compiled program.
    pub names: Vec<(String, String)>,
}

/// Writes a net as a program of one command.
#[must_use]
pub fn to_program(net: &Net) -> String {
    import(net).text
}

/// Writes a net as a program of one command, and tells what became of the names.
#[must_use]
pub fn import(net: &Net) -> Imported {
    let writer = Writer::new(net);
    let text = writer.command();
    Imported {
        text: rpi_syntax::format(&text, Mode::Rpi).unwrap_or(text),
        names: writer.renamed(),
    }
}

/// Writes the parts of one net.
struct Writer<'n> {
    net: &'n Net,
    names: Names,
}

impl<'n> Writer<'n> {
    fn new(net: &'n Net) -> Self {
        Writer {
            net,
            names: Names::new(net),
        }
    }

    fn command(&self) -> String {
        let body = self.body(FragmentId::ROOT);
        let ends = self.ends();
        format!("command {} ()\n{body}{ends}tel\n", self.names.command)
    }

    /// Declarations, `let` and the equations of a fragment.
    fn body(&self, fragment: FragmentId) -> String {
        let mut declared = String::new();
        let mut equations = String::new();
        for node in order::sources_first(self.net, fragment) {
            if !self.is_inlined(node) {
                declared.extend(self.declaration(node));
                equations.push_str(&self.equation(node));
            }
        }
        for child in self.children(fragment) {
            equations.push_str(&self.fragment(child));
        }
        let var = if declared.is_empty() { "" } else { "var\n" };
        format!("{var}{declared}let\n{equations}")
    }

    fn children(&self, fragment: FragmentId) -> impl Iterator<Item = FragmentId> + '_ {
        let is_child = move |id: &FragmentId| self.net.fragment(*id).parent == Some(fragment);
        self.net.fragment_ids().filter(is_child)
    }

    fn fragment(&self, id: FragmentId) -> String {
        let fragment = self.net.fragment(id);
        let around = fragment.parent.unwrap_or(FragmentId::ROOT);
        let restart = match fragment.restart {
            Restart::OnActivation => " restart",
            Restart::Never | Restart::Every(_) => "",
        };
        let when = match &fragment.activation {
            Activation::Always => String::new(),
            Activation::When { condition, absent } => {
                let condition = self.flow(*condition, around);
                let otherwise = *absent == Absent::Active;
                format!("when ({condition} ?? {otherwise}){restart}")
            }
        };
        let (name, body) = (self.names.fragment(id), self.body(id));
        format!("\nfragment {name} {when}\n{body}tel\n")
    }

    /// What became of the names of nodes.
    fn renamed(&self) -> Vec<(String, String)> {
        let named = self.net.node_ids().filter(|id| !self.is_inlined(*id));
        named
            .map(|id| (self.old_path(id), self.new_path(id)))
            .collect()
    }

    fn old_path(&self, id: NodeId) -> String {
        let node = self.net.node(id);
        self.net.path(node.fragment, &node.name)
    }

    fn new_path(&self, id: NodeId) -> String {
        let mut parts = self.fragment_path(self.net.node(id).fragment);
        parts.push(self.names.node(id));
        parts.join("/")
    }

    /// The names of a fragment and those around it, outermost first.
    fn fragment_path(&self, id: FragmentId) -> Vec<&str> {
        let mut parts: Vec<&str> = self
            .net
            .enclosing(id)
            .filter(|id| *id != FragmentId::ROOT)
            .map(|id| self.names.fragment(id))
            .collect();
        parts.reverse();
        parts
    }
}
