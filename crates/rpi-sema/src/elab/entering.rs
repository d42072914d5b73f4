//! What enters a fragment: for what is around it the fragment is one vertex, of which each output depends on all that is read
//! inside (M6).
//!
//! A flow from around a fragment may be another name for a flow that is made in it: `y = F(y)`, where `F` delays its
//! in-port. Read inside it is no link across the border. So it becomes a node beside the fragment, which waits for the
//! fragment and which the fragment waits for.

use super::scope::{Scope, State};
use super::signal::{Signal, Wire, alias_of};
use super::{Elab, Mode};
use crate::typed::BlockId;
use rpi_diag::Span;
use rpi_net::FragmentId;

impl<'u> Elab<'u> {
    /// Lets the in-ports of a called fragment enter it.
    pub(super) fn ports_enter(&mut self, scope: &mut Scope<'u>, fragment: FragmentId) {
        for port in &scope.unit.inputs {
            if let State::Known(wire) = scope.state(*port).clone() {
                let wire = self.entering(&wire, fragment);
                *scope.state(*port) = State::Known(wire);
            }
        }
    }

    /// A flow of a block as it is read in a fragment that is written in place in that block.
    pub(super) fn read_inside(
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
        // A flow that states share stands beside its reader, not around it.
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

    /// An alias for one that may turn out to stand for what is made in the fragment.
    fn entry(&mut self, known: usize, signal: &Signal, fragment: FragmentId) -> Signal {
        let port = self.new_alias(self.alias_types[known]);
        if let Some(alias) = alias_of(port) {
            self.aliases[alias] = Some(signal.clone());
            self.entries.insert(alias, fragment);
        }
        Signal::Port(port)
    }

    /// What a settled alias stands for inside of the fragment that it leads into.
    pub(super) fn before_entry(&mut self, alias: usize, signal: Signal) -> Signal {
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
