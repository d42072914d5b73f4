//! Fragment inputs that may depend on the fragment's own outputs. To its surroundings a fragment is one vertex: each
//! output depends on all inputs (M6).
//!
//! An outer flow may be an alias of a flow computed in the fragment: `y = F(y)`, where `F` delays its input. Read
//! inside, such a flow would not be a link across the border. A copy node is therefore inserted beside the fragment. It
//! depends on the fragment, and the fragment depends on it, so that the dependency cycle is found.

use crate::elab::scope::{Scope, State};
use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::{Elab, Mode};
use crate::typed::BlockId;
use rpi_diag::Span;
use rpi_net::FragmentId;

impl<'u> Elab<'u> {
    /// Passes the inputs of a called fragment through entry aliases.
    pub(in crate::elab) fn ports_enter(&mut self, scope: &mut Scope<'u>, fragment: FragmentId) {
        for port in &scope.unit.inputs {
            if let State::Known(wire) = scope.state(*port).clone() {
                let wire = self.entering(&wire, fragment);
                *scope.state(*port) = State::Known(wire);
            }
        }
    }

    /// Returns a flow of an enclosing block as read in a block in place.
    pub(in crate::elab) fn read_inside(
        &mut self,
        scope: &Scope<'u>,
        block: BlockId,
        wire: Wire,
        reader: FragmentId,
    ) -> Wire {
        if self.in_place.is_empty() || self.mode == Mode::Constant {
            return wire;
        }
        let Some(around) = scope.fragment(block).filter(|around| *around != reader) else {
            return wire;
        };
        // A flow shared by states lies beside its reader, not around it.
        if !self.net.enclosing(reader).any(|f| f == around) {
            return wire;
        }
        let between = self.net.enclosing(reader).take_while(|f| *f != around);
        match between.filter(|f| self.in_place.contains(f)).last() {
            Some(fragment) => self.entering(&wire, fragment),
            None => wire,
        }
    }

    fn entering(&mut self, wire: &Wire, fragment: FragmentId) -> Wire {
        let mut leaf = |signal: &Signal| match signal {
            Signal::Port(port) => match alias_of(*port) {
                Some(known) => self.entry(known, signal, fragment),
                None => signal.clone(),
            },
            other => other.clone(),
        };
        wire.iter().map(&mut leaf).collect()
    }

    /// Creates an entry alias for an alias that may turn out to refer to an output of the fragment.
    fn entry(&mut self, known: usize, signal: &Signal, fragment: FragmentId) -> Signal {
        let port = self.new_alias(self.alias_types[known]);
        if let Some(alias) = alias_of(port) {
            self.aliases[alias] = Some(signal.clone());
            self.entries.insert(alias, fragment);
        }
        Signal::Port(port)
    }

    /// Returns the signal of a resolved entry alias: a copy node outside the fragment if the fragment itself computes
    /// the signal.
    pub(in crate::elab) fn before_entry(&mut self, alias: usize, signal: Signal) -> Signal {
        let Some(&fragment) = self.entries.get(&alias) else {
            return signal;
        };
        match (signal, self.net.fragment(fragment).parent) {
            (Signal::Port(port), Some(around)) if self.is_made_in(port, fragment) => {
                self.passing_on(port, self.alias_types[alias], around, Span::NONE)
            }
            (other, _) => other,
        }
    }
}
