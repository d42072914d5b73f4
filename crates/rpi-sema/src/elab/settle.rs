//! End of an elaboration: resolves the aliases.

use crate::elab::signal::{Signal, alias_of};
use crate::elab::{At, Elab};
use rpi_diag::Span;
use rpi_image::Value;
use rpi_net::{Activation, Driver, FragmentId, Input, PortRef, Restart};
use smallvec::{SmallVec, smallvec};

impl Elab<'_> {
    /// Replaces all aliases by the signals to which they are bound.
    pub(in crate::elab) fn settle(&mut self) {
        self.begin("constant");
        for alias in 0..self.aliases.len() {
            self.settle_alias(alias);
        }
        self.keep_promises();
        for node in 0..self.net.nodes.len() {
            self.settle_node(node);
        }
        for fragment in 0..self.net.fragments.len() {
            self.settle_fragment(fragment);
        }
        for export in 0..self.net.exports.len() {
            let source = self.net.exports[export].source;
            let (at, span) = (At::ROOT, self.net.exports[export].origin.span);
            self.net.exports[export].source = self.settled_port(source, at, span);
        }
        for watched in 0..self.watched.len() {
            let (source, span) = (
                self.watched[watched].source,
                self.watched[watched].origin.span,
            );
            self.watched[watched].source = self.settled_port(source, At::ROOT, span);
        }
        self.settle_driver();
        self.settle_landmarks();
    }

    /// Follows a chain of aliases to its end. Aliases bound to each other are a dependency cycle without any node. A
    /// copy node is inserted so that the net shows the cycle.
    fn settle_alias(&mut self, alias: usize) {
        let mut chain: SmallVec<[usize; 4]> = smallvec![alias];
        self.settling[alias] = true;
        let end = loop {
            let last = chain[chain.len() - 1];
            match &self.aliases[last] {
                Some(Signal::Port(port)) => match alias_of(*port) {
                    Some(next) if self.settling[next] => break self.knot(last, *port),
                    Some(next) => {
                        self.settling[next] = true;
                        chain.push(next);
                    }
                    None => break Signal::Port(*port),
                },
                Some(other) => break other.clone(),
                None => break self.loose(last),
            }
        };
        let mut seen = end;
        for alias in chain.into_iter().rev() {
            self.settling[alias] = false;
            seen = self.behind_gate(alias, seen);
            seen = self.before_entry(alias, seen);
            self.aliases[alias] = Some(seen.clone());
        }
    }

    /// Adds a copy node that reads itself through the aliases.
    fn knot(&mut self, alias: usize, port: PortRef) -> Signal {
        let scalar = self.alias_types[alias];
        match self.passing_on(port, scalar, FragmentId::ROOT, Span::NONE) {
            Signal::Port(port) if alias_of(port).is_some() => {
                Signal::Const(Value::neutral(scalar.into()))
            }
            knot => knot,
        }
    }

    /// Returns a neutral value for a flow that is never defined, which has been reported.
    fn loose(&mut self, alias: usize) -> Signal {
        Signal::Const(Value::neutral(self.alias_types[alias].into()))
    }

    fn settle_node(&mut self, node: usize) {
        for k in 0..self.net.nodes[node].inputs.len() {
            let Input::Port(port) = self.net.nodes[node].inputs[k] else {
                continue;
            };
            let at = At::fragment(self.net.nodes[node].fragment);
            let span = self.net.nodes[node].origin.span;
            if let Some(input) = self.settled_input(port, at, span) {
                self.net.nodes[node].inputs[k] = input;
            }
        }
    }

    /// Returns the input that replaces an alias; none if the port is not an alias.
    fn settled_input(&mut self, port: PortRef, at: At, span: Span) -> Option<Input> {
        let alias = alias_of(port)?;
        let signal = self.aliases[alias].clone().unwrap_or(Signal::Absent);
        Some(self.one_input(&signal, self.alias_types[alias], at, span))
    }

    fn settle_landmarks(&mut self) {
        let mut all = std::mem::take(&mut self.net.landmarks);
        let exits = all.exits.iter_mut().flat_map(|exits| {
            let conditions = exits.transitions.iter_mut().map(|exit| &mut exit.condition);
            conditions.chain([&mut exits.here])
        });
        let choices = all.choices.iter_mut().map(|choice| &mut choice.condition);
        for input in exits.chain(choices) {
            if let Input::Port(port) = *input
                && let Some(settled) = self.settled_input(port, At::ROOT, Span::NONE)
            {
                *input = settled;
            }
        }
        self.net.landmarks = all;
    }

    fn settled_port(&mut self, port: PortRef, at: At, span: Span) -> PortRef {
        let Some(alias) = alias_of(port) else {
            return port;
        };
        let signal = self.aliases[alias].clone().unwrap_or(Signal::Absent);
        self.port_of(&signal, self.alias_types[alias], at, span)
            .unwrap_or(port)
    }

    fn settle_fragment(&mut self, fragment: usize) {
        let parent = self.net.fragments[fragment]
            .parent
            .unwrap_or(FragmentId::ROOT);
        let (at, span) = (
            At::fragment(parent),
            self.net.fragments[fragment].origin.span,
        );
        if let Activation::When { condition, absent } = self.net.fragments[fragment].activation {
            let condition = self.settled_port(condition, at, span);
            self.net.fragments[fragment].activation = Activation::When { condition, absent };
        }
        if let Restart::Every(condition) = self.net.fragments[fragment].restart {
            let condition = self.settled_port(condition, at, span);
            self.net.fragments[fragment].restart = Restart::Every(condition);
        }
    }

    fn settle_driver(&mut self) {
        let Driver::Results(results) = &mut self.net.driver else {
            return;
        };
        let mut results = std::mem::take(results);
        for result in &mut results {
            if let Input::Port(port) = result.condition {
                let port = self.settled_port(port, At::ROOT, result.origin.span);
                result.condition = Input::Port(port);
            }
        }
        self.net.driver = Driver::Results(results);
    }
}
